//! Operations as statements of a language with infix operators.

use std::collections::BTreeMap;

use super::super::{
    graph::Array,
    program::{Kind, Operand, Operation, Program, Value},
};
use thetahat_model::robot::MathFunction;

/// How a language writes the parts of statements.
pub(super) trait Syntax {
    /// A number, not negative.
    fn number(&self, value: f64) -> String;
    /// An entry of an input.
    fn input(&self, array: Array, index: usize) -> String;
    /// A value that depends only on the parameters, by its index among those used in a state.
    fn constant(&self, place: usize) -> String;
    /// A sine, cosine or sign.
    fn call(&self, function: Call, argument: &str) -> String;
    /// Another function, of one or two arguments.
    fn function(&self, function: MathFunction, arguments: &[String]) -> String;
    /// Product and quotient.
    fn operators(&self) -> [&'static str; 2] {
        [" * ", " / "]
    }
    /// Defines a name.
    fn define(&self, name: &str, value: &str) -> String;
    /// Defines sine and cosine of one angle.
    fn define_both(&self, [sine, cosine]: [&str; 2], angle: &str) -> Vec<String> {
        [(sine, Call::Sine), (cosine, Call::Cosine)]
            .into_iter()
            .map(|(name, call)| self.define(name, &self.call(call, angle)))
            .collect()
    }
}

/// A function of one number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Call {
    Sine,
    Cosine,
    Sign,
}

/// A program in two parts: values that depend only on the parameters, and operations for each state.
#[derive(Debug)]
pub(super) struct Parts<'a> {
    program: &'a Program,
    /// The values that depend only on the parameters and that states use, without duplicates.
    pub(super) constants: Vec<Value>,
}

impl<'a> Parts<'a> {
    pub(super) fn new(program: &'a Program) -> Self {
        let of_states = program.operations.iter().filter(|operation| !operation.is_fixed);
        let operands = of_states.flat_map(|operation| operation.kind.operands());
        let mut constants: Vec<Value> = Vec::new();
        for value in operands.chain(program.outputs.iter().map(|output| output.value)) {
            if is_fixed(program, value) && !constants.contains(&value) {
                constants.push(value);
            }
        }
        Self { program, constants }
    }

    /// The statements that compute values from the parameters.
    pub(super) fn prepare(&self, syntax: &impl Syntax) -> Vec<String> {
        let scope = Scope { parts: self, syntax, in_state: false };
        self.statements(&scope, |operation| operation.is_fixed, |_| Vec::new())
    }

    /// The names of those constants after [`Parts::prepare`].
    pub(super) fn prepared(&self, syntax: &impl Syntax) -> Vec<String> {
        let scope = Scope { parts: self, syntax, in_state: false };
        self.constants.iter().map(|value| scope.value(*value)).collect()
    }

    /// The statements of each state.
    pub(super) fn run(&self, syntax: &impl Syntax) -> Vec<String> {
        let scope = Scope { parts: self, syntax, in_state: true };
        self.statements(&scope, |operation| !operation.is_fixed, |_| Vec::new())
    }

    /// The statements of each state, with each output stored as soon as it is known: a compiler then keeps fewer values.
    pub(super) fn run_and_store(&self, syntax: &impl Syntax, store: impl Fn(usize, &str) -> String) -> Vec<String> {
        let outputs = self.outputs(syntax);
        let stored = |wanted: Option<usize>| -> Vec<String> {
            let places = self.program.outputs.iter().map(|output| self.place_in_state(output.value)).enumerate();
            places.filter(|(_, place)| *place == wanted).map(|(entry, _)| store(entry, &outputs[entry])).collect()
        };
        let scope = Scope { parts: self, syntax, in_state: true };
        let mut lines = stored(None);
        lines.extend(self.statements(&scope, |operation| !operation.is_fixed, |place| stored(Some(place))));
        lines
    }

    /// The index of a value among the operations of each state, if it is one of them.
    fn place_in_state(&self, value: Value) -> Option<usize> {
        match value {
            Value::Result(place) => Some(place).filter(|_| !is_fixed(self.program, value)),
            Value::Constant(_) | Value::Input(..) => None,
        }
    }

    /// All statements, without separate constants.
    pub(super) fn all(&self, syntax: &impl Syntax) -> Vec<String> {
        self.statements(&Scope { parts: self, syntax, in_state: false }, |_| true, |_| Vec::new())
    }

    /// The outputs of [`Parts::run`].
    pub(super) fn outputs(&self, syntax: &impl Syntax) -> Vec<String> {
        let scope = Scope { parts: self, syntax, in_state: true };
        self.program.outputs.iter().map(|output| scope.operand(*output)).collect()
    }

    /// The outputs of [`Parts::all`].
    pub(super) fn outputs_of_all(&self, syntax: &impl Syntax) -> Vec<String> {
        let scope = Scope { parts: self, syntax, in_state: false };
        self.program.outputs.iter().map(|output| scope.operand(*output)).collect()
    }

    /// The statements of selected operations, each followed by the lines of `after`.
    fn statements<S: Syntax>(
        &self,
        scope: &Scope<'_, S>,
        is_wanted: impl Fn(&Operation) -> bool,
        after: impl Fn(usize) -> Vec<String>,
    ) -> Vec<String> {
        let syntax = scope.syntax;
        let pairs = pairs(self.program);
        let mut lines = Vec::new();
        for (place, operation) in self.program.operations.iter().enumerate().filter(|(_, o)| is_wanted(o)) {
            match pairs.get(&place) {
                None => lines.push(syntax.define(&name(place), &scope.operation(operation.kind))),
                Some(&(sine, cosine, angle)) if place == sine.min(cosine) => {
                    let names = [name(sine), name(cosine)];
                    lines.extend(syntax.define_both([&names[0], &names[1]], &scope.value(angle)));
                }
                Some(_) => {}
            }
            lines.extend(after(place));
        }
        lines
    }
}

/// Indices of sine and cosine of one angle, by either index.
fn pairs(program: &Program) -> BTreeMap<usize, (usize, usize, Value)> {
    let mut pairs = BTreeMap::new();
    let operations = || program.operations.iter().enumerate();
    for (sine, operation) in operations() {
        let Kind::Sine(angle) = operation.kind else { continue };
        let cosine = operations().find(|(_, other)| other.kind == Kind::Cosine(angle));
        if let Some((cosine, _)) = cosine {
            pairs.insert(sine, (sine, cosine, angle));
            pairs.insert(cosine, (sine, cosine, angle));
        }
    }
    pairs
}

fn is_fixed(program: &Program, value: Value) -> bool {
    match value {
        Value::Constant(_) => false,
        Value::Input(array, _) => array == Array::Parameter,
        Value::Result(place) => program.operations[place].is_fixed,
    }
}

fn name(place: usize) -> String {
    format!("t{place}")
}

struct Scope<'a, S> {
    parts: &'a Parts<'a>,
    syntax: &'a S,
    /// Whether values that depend only on the parameters are available as constants.
    in_state: bool,
}

impl<S: Syntax> Scope<'_, S> {
    fn value(&self, value: Value) -> String {
        let kept = self.parts.constants.iter().position(|constant| *constant == value).filter(|_| self.in_state);
        match (kept, value) {
            (Some(place), _) => self.syntax.constant(place),
            (None, Value::Constant(number)) => self.syntax.number(number),
            (None, Value::Input(array, index)) => self.syntax.input(array, index),
            (None, Value::Result(place)) => name(place),
        }
    }

    fn operand(&self, operand: Operand) -> String {
        let value = self.value(operand.value);
        if operand.negative { format!("-{value}") } else { value }
    }

    fn operation(&self, kind: Kind) -> String {
        let [times, over] = self.syntax.operators();
        let two = |a: Value, operator: &str, b: Value| format!("{}{operator}{}", self.value(a), self.value(b));
        let call = |function: Call, a: Value| self.syntax.call(function, &self.value(a));
        match kind {
            Kind::Sine(a) => call(Call::Sine, a),
            Kind::Cosine(a) => call(Call::Cosine, a),
            Kind::Sign(a) => call(Call::Sign, a),
            Kind::Sum(a, b) => two(a, " + ", b),
            Kind::Difference(a, b) => two(a, " - ", b),
            Kind::Product(a, b) => two(a, times, b),
            Kind::Quotient(a, b) => two(a, over, b),
            Kind::Function(function, a, b) => {
                let arguments: Vec<String> = std::iter::once(a).chain(b).map(|a| self.operand(a)).collect();
                self.syntax.function(function, &arguments)
            }
        }
    }
}
