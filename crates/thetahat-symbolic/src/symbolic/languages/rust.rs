//! Rust without the standard library: a module with single calls and batches. `core` has no sine, so callers pass one.

use super::{
    super::{graph::Array, model::Function},
    documentation::{array_name, lines, output_name},
    functions::in_rust,
    statements::{Call, Parts, Syntax},
};
use thetahat_model::robot::MathFunction;

/// The sign of a velocity.
const SIGN: &str = "\
/// -1, 0 or 1.
fn sign(x: Real) -> Real {
    if x > 0.0 {
        1.0
    } else if x < 0.0 {
        -1.0
    } else {
        0.0
    }
}

";

/// The sign of a velocity, or its smooth form, which needs the standard library.
fn sign(friction_transition: Option<f64>) -> String {
    friction_transition.map_or_else(
        || SIGN.to_owned(),
        |v| format!("/// `tanh(x / {v:?})`, of the standard library.\nfn sign(x: Real) -> Real {{\n    (x / {v:?}).tanh()\n}}\n\n"),
    )
}

struct Rust;

impl Syntax for Rust {
    fn number(&self, value: f64) -> String {
        format!("{value:?}")
    }

    fn input(&self, array: Array, index: usize) -> String {
        format!("{}[{index}]", array_name(array))
    }

    fn constant(&self, place: usize) -> String {
        format!("constants[{place}]")
    }

    fn call(&self, function: Call, argument: &str) -> String {
        match function {
            Call::Sine => format!("sin_cos({argument}).0"),
            Call::Cosine => format!("sin_cos({argument}).1"),
            Call::Sign => format!("sign({argument})"),
        }
    }

    fn function(&self, function: MathFunction, arguments: &[String]) -> String {
        format!("Real::{}({})", in_rust(function), arguments.join(", "))
    }

    fn define(&self, name: &str, value: &str) -> String {
        format!("    let {name} = {value};")
    }

    fn define_both(&self, [sine, cosine]: [&str; 2], angle: &str) -> Vec<String> {
        vec![format!("    let ({sine}, {cosine}) = sin_cos({angle});")]
    }
}

pub(super) fn code(function: &Function, prefix: &str) -> String {
    let file = File {
        function,
        name: format!("{prefix}_{}", function.model.identifier()),
        parts: Parts::new(&function.program),
    };
    let comment: String =
        lines(function).iter().map(|line| format!("// {line}").trim_end().to_owned() + "\n").collect();
    let mut text = format!("{comment}\n/// The numbers: `f64`, or `f32`.\npub type Real = f64;\n\n");
    if function.program.calls_functions() {
        text = text.replacen(
            "\n/// The numbers",
            "// The torque terms take functions of the standard library.\n\n/// The numbers",
            1,
        );
    }
    if function.program.count().signs > 0 {
        text += &sign(function.friction_transition);
    }
    text += &file.prepare();
    text + &file.single() + &file.batch()
}

struct File<'a> {
    function: &'a Function,
    name: String,
    parts: Parts<'a>,
}

impl File<'_> {
    fn takes_constants(&self) -> bool {
        !self.parts.constants.is_empty()
    }

    fn inputs(&self) -> impl Iterator<Item = &'static str> {
        self.function.model.inputs().iter().map(|array| array_name(*array))
    }

    fn entries(&self) -> usize {
        self.function.program.outputs.len()
    }

    fn constants_name(&self) -> String {
        format!("{}_CONSTANTS", self.name.to_uppercase())
    }

    /// The argument after the inputs in both calls.
    fn constants_argument(&self) -> String {
        if self.takes_constants() { format!(", constants: &[Real; {}]", self.constants_name()) } else { String::new() }
    }

    fn prepare(&self) -> String {
        if !self.takes_constants() {
            return String::new();
        }
        let (count, name) = (self.constants_name(), &self.name);
        let mut text = format!(
            "/// Number of values that the parameters decide.\npub const {count}: usize = {};\n\n",
            self.parts.constants.len()
        );
        text += "/// What the parameters decide, once for all states.\n#[must_use]\n";
        text += &format!(
            "pub fn {name}_prepare(theta: &[Real; {}]) -> [Real; {count}] {{\n",
            self.function.parameters.len()
        );
        self.parts.prepare(&Rust).iter().for_each(|line| text += &format!("{line}\n"));
        text + &format!("    [\n{}    ]\n}}\n\n", listed(&self.parts.prepared(&Rust)))
    }

    fn single(&self) -> String {
        let n = self.function.coordinates.len();
        let declared: String = self.inputs().map(|name| format!(", {name}: &[Real; {n}]")).collect();
        let mut text = "/// One state; `sin_cos` gives sine and cosine of an angle, such as `f64::sin_cos` or that of libm.\n#[must_use]\n#[allow(clippy::all)]\n".to_owned();
        text += &format!(
            "pub fn {}(sin_cos: impl Fn(Real) -> (Real, Real){declared}{}) -> [Real; {}] {{\n",
            self.name,
            self.constants_argument(),
            self.entries()
        );
        let unused = self.function.model.inputs().iter().filter(|array| self.function.program.length_of(**array) == 0);
        unused.for_each(|array| text += &format!("    let _ = {};\n", array_name(*array)));
        if self.function.program.count().sines == 0 {
            text += "    let _ = sin_cos;\n";
        }
        self.parts.run(&Rust).iter().for_each(|line| text += &format!("{line}\n"));
        text + &format!("    [\n{}    ]\n}}\n\n", listed(&self.parts.outputs(&Rust)))
    }

    fn batch(&self) -> String {
        let (name, output, n) = (&self.name, output_name(self.function.model), self.function.coordinates.len());
        let declared: String = self.inputs().map(|name| format!(", {name}: &[Real]")).collect();
        let gathered: String = self.inputs().map(|name| format!(", &at({name}, k)")).collect();
        let constants = if self.takes_constants() { ", constants" } else { "" };
        let argument = self.constants_argument();
        format!(
            "/// `count` states: entry j of state k is at `j * count + k` of its slice.\n///\n/// # Panics\n\
             /// Where a slice is too short.\n#[allow(clippy::all)]\n\
             pub fn {name}_batch(sin_cos: impl Fn(Real) -> (Real, Real), count: usize{declared}{argument}, {output}: &mut [Real]) {{\n    \
             let at = |array: &[Real], k: usize| -> [Real; {n}] {{ core::array::from_fn(|j| array[j * count + k]) }};\n    \
             for k in 0..count {{\n        let entries = {name}(&sin_cos{gathered}{constants});\n        \
             for (j, entry) in entries.iter().enumerate() {{\n            {output}[j * count + k] = *entry;\n        }}\n    }}\n}}\n"
        )
    }
}

fn listed(values: &[String]) -> String {
    values.iter().map(|value| format!("        {value},\n")).collect()
}
