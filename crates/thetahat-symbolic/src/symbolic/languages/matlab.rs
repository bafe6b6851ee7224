//! MATLAB and Octave: a file of one function, over any number of states at once.

use super::{
    super::{graph::Array, model::Function},
    documentation::{array_name, lines, output_name},
    functions::in_matlab,
    statements::{Call, Parts, Syntax},
};
use thetahat_model::robot::MathFunction;

struct Matlab {
    friction_transition: Option<f64>,
}

impl Syntax for Matlab {
    fn number(&self, value: f64) -> String {
        format!("{value:?}")
    }

    fn input(&self, array: Array, index: usize) -> String {
        let place = index + 1;
        match array {
            Array::Parameter => format!("theta({place})"),
            Array::Position | Array::Velocity | Array::Acceleration | Array::Torque => {
                format!("{}(:, {place})", array_name(array))
            }
        }
    }

    /// All statements are in one function; no constants are separate.
    fn constant(&self, place: usize) -> String {
        format!("constants({})", place + 1)
    }

    fn call(&self, function: Call, argument: &str) -> String {
        let name = match function {
            Call::Sine => "sin",
            Call::Cosine => "cos",
            Call::Sign => match self.friction_transition {
                Some(v) => return format!("tanh(({argument}) / {v:?})"),
                None => "sign",
            },
        };
        format!("{name}({argument})")
    }

    fn function(&self, function: MathFunction, arguments: &[String]) -> String {
        in_matlab(function, arguments)
    }

    fn operators(&self) -> [&'static str; 2] {
        [" .* ", " ./ "]
    }

    fn define(&self, name: &str, value: &str) -> String {
        format!("    {name} = {value};")
    }
}

pub(super) fn code(function: &Function, prefix: &str) -> String {
    let (parts, output) = (Parts::new(&function.program), output_name(function.model));
    let syntax = Matlab { friction_transition: function.friction_transition };
    let ([rows, columns], name) = (function.shape, format!("{prefix}_{}", function.model.identifier()));
    let inputs = function.model.inputs().iter().map(|array| array_name(*array));
    let theta = (!parts.constants.is_empty()).then_some("theta");
    let arguments: Vec<&str> = inputs.chain(theta).collect();
    let mut text = format!("function {output} = {name}({})\n", arguments.join(", "));
    for line in lines(function) {
        text += &format!("    % {line}").trim_end().replace('\n', " ");
        text.push('\n');
    }
    text += &format!("    % A row for each state; the file is {name}.m. {}\n", shape(function));
    parts.all(&syntax).iter().for_each(|line| text += &format!("{line}\n"));
    let single = function.model.is_vector();
    let states = format!("size({}, 1)", arguments[0]);
    text += &if single {
        format!("    {output} = zeros({states}, {rows});\n")
    } else {
        format!("    {output} = zeros({rows}, {columns}, {states});\n")
    };
    for (place, value) in parts.outputs_of_all(&syntax).iter().enumerate() {
        let (row, column) = (place / columns + 1, place % columns + 1);
        let entry = if single { format!("(:, {row})") } else { format!("({row}, {column}, :)") };
        text += &format!("    {output}{entry} = {value};\n");
    }
    text + "end\n"
}

fn shape(function: &Function) -> String {
    let [rows, columns] = function.shape;
    if function.model.is_vector() {
        "The output has a row for each state.".to_owned()
    } else {
        format!("The output is {rows} by {columns} by the number of states.")
    }
}
