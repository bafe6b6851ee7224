//! LaTeX: equations for a paper; expressions that are used once are written in place.

use std::collections::HashMap;

use thetahat_model::robot::MathFunction;

use super::{
    super::{
        graph::Array,
        model::Function,
        program::{Kind, Operand, Program, Value},
        request::ModelKind,
    },
    documentation::lines,
    functions::in_latex,
};

/// Longest expression that is written in place, in characters.
const LONGEST: usize = 160;

/// Binding strength of an expression.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Strength {
    Sum,
    Product,
    Atom,
}

/// A text with its strength.
#[derive(Debug, Clone)]
struct Text {
    text: String,
    strength: Strength,
}

impl Text {
    fn atom(text: String) -> Self {
        Self { text, strength: Strength::Atom }
    }

    /// In parentheses if it binds less than required.
    fn at_least(&self, strength: Strength) -> String {
        if self.strength < strength { format!("\\left({}\\right)", self.text) } else { self.text.clone() }
    }
}

pub(super) fn code(function: &Function) -> String {
    let comment: String = lines(function).iter().map(|line| format!("% {line}").trim_end().to_owned() + "\n").collect();
    let mut writer = Writer::new(function);
    writer.operations();
    let mut equations = writer.equations;
    for (place, output) in function.program.outputs.iter().enumerate() {
        if output.value != Value::Constant(0.0) {
            let value = signed(&writer.texts, function, *output);
            equations.push(format!("{} &= {value}", output_symbol(function, place)));
        }
    }
    if equations.is_empty() {
        equations.push("&\\text{All entries are zero.}".to_owned());
    }
    let body = equations.join(" \\\\\n");
    format!(
        "{comment}% Needs \\usepackage{{amsmath}}. Entries of the output that are not here are zero.\n\\begingroup\n\\allowdisplaybreaks\n\\begin{{align*}}\n{body}\n\\end{{align*}}\n\\endgroup\n"
    )
}

fn signed(texts: &HashMap<usize, Text>, function: &Function, operand: Operand) -> String {
    let text = written(texts, function, operand.value);
    if operand.negative { format!("-{}", text.at_least(Strength::Product)) } else { text.text }
}

/// Writes the operations and decides which get a name.
struct Writer<'a> {
    function: &'a Function,
    uses: Vec<usize>,
    texts: HashMap<usize, Text>,
    equations: Vec<String>,
}

impl<'a> Writer<'a> {
    fn new(function: &'a Function) -> Self {
        Self { function, uses: uses(&function.program), texts: HashMap::new(), equations: Vec::new() }
    }

    fn operations(&mut self) {
        for (place, operation) in self.function.program.operations.iter().enumerate() {
            let text = self.operation(operation.kind);
            let is_sine = matches!(operation.kind, Kind::Sine(_) | Kind::Cosine(_));
            let short = self.uses[place] <= 1 && text.text.len() <= LONGEST;
            let kept = if is_sine || short { text } else { self.named(&text) };
            self.texts.insert(place, kept);
        }
    }

    fn named(&mut self, text: &Text) -> Text {
        let symbol = format!("x_{{{}}}", self.equations.len() + 1);
        self.equations.push(format!("{symbol} &= {}", text.text));
        Text::atom(symbol)
    }

    fn operation(&self, kind: Kind) -> Text {
        let of = |value: Value| written(&self.texts, self.function, value);
        let call = |name: &str, a: Value| Text::atom(format!("{name}\\left({}\\right)", of(a).text));
        let product = |a: Value, b: Value| {
            format!("{} \\, {}", of(a).at_least(Strength::Product), of(b).at_least(Strength::Product))
        };
        match kind {
            Kind::Sine(a) => call("\\sin", a),
            Kind::Cosine(a) => call("\\cos", a),
            Kind::Sign(a) => match self.function.friction_transition {
                Some(v) => Text::atom(format!("\\tanh\\left(\\left({}\\right) / {v}\\right)", of(a).text)),
                None => call("\\operatorname{sign}", a),
            },
            Kind::Sum(a, b) => Text { text: format!("{} + {}", of(a).text, of(b).text), strength: Strength::Sum },
            Kind::Difference(a, b) => Text {
                text: format!("{} - {}", of(a).text, of(b).at_least(Strength::Product)),
                strength: Strength::Sum,
            },
            Kind::Product(a, b) => Text { text: product(a, b), strength: Strength::Product },
            Kind::Quotient(a, b) => Text::atom(format!("\\frac{{{}}}{{{}}}", of(a).text, of(b).text)),
            Kind::Function(function, a, b) => {
                let argument = |operand: Operand| signed(&self.texts, self.function, operand);
                let arguments: Vec<String> = std::iter::once(a).chain(b).map(argument).collect();
                Text::atom(called(function, &arguments))
            }
        }
    }
}

/// Roots and powers in their usual notation, any other function by its name.
fn called(function: MathFunction, arguments: &[String]) -> String {
    match (function, arguments) {
        (MathFunction::SquareRoot, [argument]) => format!("\\sqrt{{{argument}}}"),
        (MathFunction::Power, [base, exponent]) => format!("\\left({base}\\right)^{{{exponent}}}"),
        _ => format!("{}\\left({}\\right)", in_latex(function), arguments.join(", ")),
    }
}

/// How often the result of each operation is used.
fn uses(program: &Program) -> Vec<usize> {
    let mut uses = vec![0; program.operations.len()];
    let operands = program.operations.iter().flat_map(|operation| operation.kind.operands());
    for value in operands.chain(program.outputs.iter().map(|output| output.value)) {
        if let Value::Result(place) = value {
            uses[place] += 1;
        }
    }
    uses
}

fn written(texts: &HashMap<usize, Text>, function: &Function, value: Value) -> Text {
    match value {
        Value::Constant(number) => Text::atom(number_text(number)),
        Value::Result(place) => texts.get(&place).cloned().unwrap_or_else(|| Text::atom(String::new())),
        Value::Input(array, index) => {
            let n = index + 1;
            Text::atom(match array {
                Array::Position => format!("q_{{{n}}}"),
                Array::Velocity => format!("\\dot{{q}}_{{{n}}}"),
                Array::Acceleration => format!("\\ddot{{q}}_{{{n}}}"),
                Array::Torque => format!("\\tau_{{{n}}}"),
                Array::Parameter => parameter_symbol(&function.parameters[index].name),
            })
        }
    }
}

fn number_text(number: f64) -> String {
    let text = format!("{number:?}");
    match text.split_once('e') {
        None => text.trim_end_matches(".0").to_owned(),
        Some((mantissa, exponent)) => format!("{mantissa} \\cdot 10^{{{exponent}}}"),
    }
}

/// `zz1r` as `zz_{1r}`, upright.
fn parameter_symbol(name: &str) -> String {
    let split = name.find(|c: char| c.is_ascii_digit()).unwrap_or(name.len());
    let (letters, number) = name.split_at(split);
    let upright = |text: &str| format!("\\mathrm{{{}}}", text.replace('_', "\\_"));
    if number.is_empty() { upright(letters) } else { format!("{}_{{{}}}", upright(letters), upright(number)) }
}

fn output_symbol(function: &Function, place: usize) -> String {
    let columns = function.shape[1];
    let (row, column) = (place / columns + 1, place % columns + 1);
    match function.model {
        ModelKind::InverseDynamics => format!("\\tau_{{{row}}}"),
        ModelKind::InverseDynamicsDerivatives => format!("D_{{{row},{column}}}"),
        ModelKind::ForwardDynamics => format!("\\ddot{{q}}_{{{row}}}"),
        ModelKind::Gravity => format!("g_{{{row}}}"),
        ModelKind::Coriolis => format!("c_{{{row}}}"),
        ModelKind::MassMatrix => format!("M_{{{row},{column}}}"),
        ModelKind::Regressor => format!("\\varphi_{{{row},{column}}}"),
        ModelKind::ForwardKinematics => format!("T_{{{row},{column}}}"),
        ModelKind::Jacobian => format!("J_{{{row},{column}}}"),
    }
}
