//! Python: a module with a function of NumPy arrays, over any number of states at once.

use super::{
    super::{graph::Array, model::Function},
    documentation::{array_name, lines, output_name},
    functions::in_numpy,
    statements::{Call, Parts, Syntax},
};
use thetahat_model::robot::MathFunction;

struct Python {
    friction_transition: Option<f64>,
}

impl Syntax for Python {
    fn number(&self, value: f64) -> String {
        format!("{value:?}")
    }

    fn input(&self, array: Array, index: usize) -> String {
        match array {
            Array::Parameter => format!("theta[{index}]"),
            Array::Position | Array::Velocity | Array::Acceleration | Array::Torque => {
                format!("{}[..., {index}]", array_name(array))
            }
        }
    }

    /// All statements are in one function; no constants are separate.
    fn constant(&self, place: usize) -> String {
        format!("constants[{place}]")
    }

    fn call(&self, function: Call, argument: &str) -> String {
        let name = match function {
            Call::Sine => "sin",
            Call::Cosine => "cos",
            Call::Sign => match self.friction_transition {
                Some(v) => return format!("np.tanh(({argument}) / {v:?})"),
                None => "sign",
            },
        };
        format!("np.{name}({argument})")
    }

    fn function(&self, function: MathFunction, arguments: &[String]) -> String {
        format!("np.{}({})", in_numpy(function), arguments.join(", "))
    }

    fn define(&self, name: &str, value: &str) -> String {
        format!("    {name} = {value}")
    }
}

pub(super) fn code(function: &Function, prefix: &str) -> String {
    let (parts, output) = (Parts::new(&function.program), output_name(function.model));
    let syntax = Python { friction_transition: function.friction_transition };
    let inputs: Vec<&str> = function.model.inputs().iter().map(|array| array_name(*array)).collect();
    let takes_parameters = !parts.constants.is_empty();
    let mut text = format!("\"\"\"{}\n\"\"\"\n\nimport numpy as np\n\n\n", documentation(function));
    let theta = if takes_parameters { ", theta" } else { "" };
    text += &format!("def {prefix}_{}({}{theta}):\n", function.model.identifier(), inputs.join(", "));
    text += &format!(
        "    \"\"\"Arrays of shape (..., {}) give one of shape {}.\"\"\"\n",
        function.coordinates.len(),
        shape(function)
    );
    inputs.iter().for_each(|name| text += &format!("    {name} = np.asarray({name}, dtype=float)\n"));
    if takes_parameters {
        text += "    theta = np.asarray(theta, dtype=float)\n";
    }
    let shapes: Vec<String> = inputs.iter().map(|name| format!("{name}.shape[:-1]")).collect();
    text += &format!("    states = np.broadcast_shapes({})\n", shapes.join(", "));
    parts.all(&syntax).iter().for_each(|line| text += &format!("{line}\n"));
    text += &format!("    {output} = np.empty(states + ({},))\n", parts_count(function));
    for (place, value) in parts.outputs_of_all(&syntax).iter().enumerate() {
        text += &format!("    {output}[..., {place}] = {value}\n");
    }
    text + &result(function)
}

fn parts_count(function: &Function) -> usize {
    function.program.outputs.len()
}

fn documentation(function: &Function) -> String {
    lines(function).join("\n").replace('\\', "/").replace("\"\"\"", "'''")
}

fn shape(function: &Function) -> String {
    let [rows, columns] = function.shape;
    if function.model.is_vector() { format!("(..., {rows})") } else { format!("(..., {rows}, {columns})") }
}

fn result(function: &Function) -> String {
    let ([rows, columns], output) = (function.shape, output_name(function.model));
    if function.model.is_vector() {
        format!("    return {output}\n")
    } else {
        format!("    return {output}.reshape(states + ({rows}, {columns}))\n")
    }
}
