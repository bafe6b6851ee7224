//! A list of operations: the common source of all languages, operation counts and values.

use std::fmt;

use super::graph::{Array, Graph, Level, Node, NodeId, Signed};
use thetahat_model::robot::MathFunction;

/// A function as a list of operations, each after its operands.
#[derive(Debug, Clone)]
pub struct Program {
    pub(super) operations: Vec<Operation>,
    pub(super) outputs: Vec<Operand>,
}

/// An operation, and whether its result depends only on the parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Operation {
    pub(super) kind: Kind,
    /// Whether its result depends only on the parameters.
    pub(super) is_fixed: bool,
}

/// What an operation computes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Kind {
    Sine(Value),
    Cosine(Value),
    Sign(Value),
    Sum(Value, Value),
    Difference(Value, Value),
    Product(Value, Value),
    Quotient(Value, Value),
    Function(MathFunction, Operand, Option<Operand>),
}

/// An operand of an operation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Value {
    Constant(f64),
    Input(Array, usize),
    /// The result of the operation at this index.
    Result(usize),
}

/// A value with its sign.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Operand {
    pub(super) value: Value,
    pub(super) negative: bool,
}

/// Operations in each state. Values that depend only on the parameters are computed once and not counted, nor are signs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct OperationCount {
    /// Multiplications.
    pub multiplications: usize,
    /// Additions and subtractions.
    pub additions: usize,
    /// Divisions.
    pub divisions: usize,
    /// Sines and cosines.
    pub sines: usize,
    /// Signs of velocities.
    pub signs: usize,
    /// Other functions, such as exponentials of friction laws.
    pub functions: usize,
}

/// The inputs of a function.
#[derive(Debug, Clone, Copy, Default)]
pub struct Inputs<'a> {
    /// Positions, rad or m.
    pub q: &'a [f64],
    /// Velocities.
    pub dq: &'a [f64],
    /// Accelerations.
    pub ddq: &'a [f64],
    /// Torques, N m or N.
    pub tau: &'a [f64],
    /// Parameters.
    pub theta: &'a [f64],
}

impl fmt::Display for OperationCount {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { multiplications, additions, divisions, sines, signs, functions } = self;
        write!(f, "{multiplications} multiplications, {additions} additions")?;
        let others =
            [(divisions, "divisions"), (sines, "sines and cosines"), (signs, "signs"), (functions, "other functions")];
        for (number, what) in others {
            if *number > 0 {
                write!(f, ", {number} {what}")?;
            }
        }
        write!(f, " in each state")
    }
}

impl Kind {
    /// The operands.
    pub(super) fn operands(self) -> impl Iterator<Item = Value> {
        let (first, second) = match self {
            Self::Sine(a) | Self::Cosine(a) | Self::Sign(a) => (a, None),
            Self::Sum(a, b) | Self::Difference(a, b) | Self::Product(a, b) | Self::Quotient(a, b) => (a, Some(b)),
            Self::Function(_, a, b) => (a.value, b.map(|b| b.value)),
        };
        std::iter::once(first).chain(second)
    }
}

impl Program {
    /// The operations that outputs need, in the order in which the outputs need them.
    pub(super) fn new(graph: &Graph, outputs: &[Signed]) -> Self {
        let mut places = vec![None; graph.len()];
        let mut operations = Vec::new();
        for output in outputs {
            schedule(graph, output.node, &mut places, &mut operations);
        }
        let operand = |of: &Signed| Operand { value: value(graph, of.node, &places), negative: of.negative };
        Self { operations, outputs: outputs.iter().map(operand).collect() }
    }

    /// The number of operations in each state.
    #[must_use]
    pub fn count(&self) -> OperationCount {
        let mut count = OperationCount::default();
        for operation in self.operations.iter().filter(|operation| !operation.is_fixed) {
            let of_kind = match operation.kind {
                Kind::Sine(_) | Kind::Cosine(_) => &mut count.sines,
                Kind::Sign(_) => &mut count.signs,
                Kind::Sum(..) | Kind::Difference(..) => &mut count.additions,
                Kind::Product(..) => &mut count.multiplications,
                Kind::Quotient(..) => &mut count.divisions,
                Kind::Function(..) => &mut count.functions,
            };
            *of_kind += 1;
        }
        count
    }

    /// Whether it calls functions other than sine and cosine, in any part.
    pub(super) fn calls_functions(&self) -> bool {
        self.operations.iter().any(|operation| matches!(operation.kind, Kind::Function(..)))
    }

    /// The outputs in a state.
    ///
    /// # Panics
    /// If an array is shorter than the function needs.
    #[must_use]
    pub fn evaluate(&self, inputs: &Inputs<'_>) -> Vec<f64> {
        let mut results = Vec::with_capacity(self.operations.len());
        for operation in &self.operations {
            let of = |value: Value| evaluated(value, inputs, &results);
            let signed = |operand: Operand| if operand.negative { -of(operand.value) } else { of(operand.value) };
            results.push(match operation.kind {
                Kind::Sine(a) => of(a).sin(),
                Kind::Cosine(a) => of(a).cos(),
                Kind::Sign(a) if of(a) == 0.0 => 0.0,
                Kind::Sign(a) => of(a).signum(),
                Kind::Sum(a, b) => of(a) + of(b),
                Kind::Difference(a, b) => of(a) - of(b),
                Kind::Product(a, b) => of(a) * of(b),
                Kind::Quotient(a, b) => of(a) / of(b),
                Kind::Function(function, a, b) => function.value(signed(a), b.map_or(0.0, signed)),
            });
        }
        let output = |operand: &Operand| {
            let value = evaluated(operand.value, inputs, &results);
            if operand.negative { -value } else { value }
        };
        self.outputs.iter().map(output).collect()
    }

    /// One more than the largest index that it uses of an array.
    pub(super) fn length_of(&self, array: Array) -> usize {
        let operands = self.operations.iter().flat_map(|operation| operation.kind.operands());
        let values = operands.chain(self.outputs.iter().map(|output| output.value));
        let index = |value| if let Value::Input(of, index) = value { Some((of, index)) } else { None };
        values.filter_map(index).filter(|(of, _)| *of == array).map(|(_, index)| index + 1).max().unwrap_or(0)
    }
}

fn evaluated(value: Value, inputs: &Inputs<'_>, results: &[f64]) -> f64 {
    match value {
        Value::Constant(number) => number,
        Value::Result(place) => results[place],
        Value::Input(Array::Position, index) => inputs.q[index],
        Value::Input(Array::Velocity, index) => inputs.dq[index],
        Value::Input(Array::Acceleration, index) => inputs.ddq[index],
        Value::Input(Array::Torque, index) => inputs.tau[index],
        Value::Input(Array::Parameter, index) => inputs.theta[index],
    }
}

/// Appends a node's operation after those of its operands.
fn schedule(graph: &Graph, id: NodeId, places: &mut [Option<usize>], operations: &mut Vec<Operation>) {
    let node = graph.node(id);
    if places[id.index()].is_some() || node.operands().next().is_none() {
        return;
    }
    for operand in node.operands() {
        schedule(graph, operand, places, operations);
    }
    let of = |id: NodeId| value(graph, id, places);
    let signed = |a: Signed| Operand { value: of(a.node), negative: a.negative };
    let kind = match node {
        Node::Constant(_) | Node::Input(..) => return,
        Node::Sine(a) => Kind::Sine(of(a)),
        Node::Cosine(a) => Kind::Cosine(of(a)),
        Node::Sign(a) => Kind::Sign(of(a)),
        Node::Sum(a, b) => Kind::Sum(of(a), of(b)),
        Node::Difference(a, b) => Kind::Difference(of(a), of(b)),
        Node::Product(a, b) => Kind::Product(of(a), of(b)),
        Node::Quotient(a, b) => Kind::Quotient(of(a), of(b)),
        Node::Function(function, a, b) => Kind::Function(function, signed(a), b.map(signed)),
    };
    places[id.index()] = Some(operations.len());
    operations.push(Operation { kind, is_fixed: graph.level(id) < Level::State });
}

fn value(graph: &Graph, id: NodeId, places: &[Option<usize>]) -> Value {
    match (graph.node(id), places[id.index()]) {
        (Node::Constant(bits), _) => Value::Constant(f64::from_bits(bits)),
        (Node::Input(array, index), _) => Value::Input(array, index),
        (_, Some(place)) => Value::Result(place),
        (_, None) => unreachable!("operands are scheduled before what takes them"),
    }
}
