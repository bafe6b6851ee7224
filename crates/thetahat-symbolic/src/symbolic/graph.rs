//! Expressions with shared subexpressions.
//!
//! Each node exists once: constants, zeros and ones are folded, signs are stored outside the nodes, and the operands of sums
//! and products are in a fixed order, so that `a - b` and `b - a` are one node.

use std::collections::HashMap;

use thetahat_model::robot::MathFunction;

/// Fraction of the larger operand below which a sum of constants is rounding.
const CANCELLED: f64 = 4.0 * f64::EPSILON;
/// Largest power that is expanded to a product.
const MOST_FACTORS: f64 = 4.0;

/// An input of a generated function.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Array {
    /// Positions of the coordinates, rad or m.
    Position,
    /// Their velocities.
    Velocity,
    /// Their accelerations.
    Acceleration,
    /// Torques on the coordinates, N m or N.
    Torque,
    /// Dynamic parameters.
    Parameter,
}

/// A node of a [`Graph`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) struct NodeId(u32);

/// A node with its sign.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) struct Signed {
    pub(super) node: NodeId,
    pub(super) negative: bool,
}

/// What a node computes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Node {
    /// The bits of a number, zero or more.
    Constant(u64),
    Input(Array, usize),
    Sine(NodeId),
    Cosine(NodeId),
    /// -1, 0 or 1.
    Sign(NodeId),
    Sum(NodeId, NodeId),
    Difference(NodeId, NodeId),
    Product(NodeId, NodeId),
    Quotient(NodeId, NodeId),
    /// A function of one or two arguments.
    Function(MathFunction, Signed, Option<Signed>),
}

/// When a value is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Level {
    /// It is a number.
    Constant,
    /// Once the parameters are known.
    Parameters,
    /// In each state.
    State,
}

/// Nodes, operands before the nodes that use them.
#[derive(Debug, Default)]
pub(super) struct Graph {
    nodes: Vec<Node>,
    levels: Vec<Level>,
    known: HashMap<Node, NodeId>,
}

impl NodeId {
    pub(super) fn index(self) -> usize {
        self.0 as usize
    }

    pub(super) fn positive(self) -> Signed {
        Signed { node: self, negative: false }
    }
}

impl Signed {
    pub(super) fn times_sign(self, negative: bool) -> Self {
        Self { negative: self.negative != negative, ..self }
    }

    fn magnitude(self) -> Self {
        self.node.positive()
    }
}

impl Node {
    /// The operands of an operation.
    pub(super) fn operands(self) -> impl Iterator<Item = NodeId> {
        let [first, second] = match self {
            Self::Constant(_) | Self::Input(..) => [None, None],
            Self::Sine(a) | Self::Cosine(a) | Self::Sign(a) => [Some(a), None],
            Self::Sum(a, b) | Self::Difference(a, b) | Self::Product(a, b) | Self::Quotient(a, b) => [Some(a), Some(b)],
            Self::Function(_, a, b) => [Some(a.node), b.map(|b| b.node)],
        };
        first.into_iter().chain(second)
    }
}

impl Graph {
    pub(super) fn node(&self, id: NodeId) -> Node {
        self.nodes[id.index()]
    }

    /// The node at an index.
    pub(super) fn id(&self, place: usize) -> NodeId {
        debug_assert!(place < self.nodes.len());
        NodeId(place as u32)
    }

    pub(super) fn level(&self, id: NodeId) -> Level {
        self.levels[id.index()]
    }

    pub(super) fn len(&self) -> usize {
        self.nodes.len()
    }

    fn intern(&mut self, node: Node) -> Signed {
        if let Some(id) = self.known.get(&node) {
            return id.positive();
        }
        let own = match node {
            Node::Constant(_) => Level::Constant,
            Node::Input(Array::Parameter, _) => Level::Parameters,
            Node::Input(..) => Level::State,
            Node::Sine(_)
            | Node::Cosine(_)
            | Node::Sign(_)
            | Node::Sum(..)
            | Node::Difference(..)
            | Node::Product(..)
            | Node::Quotient(..)
            | Node::Function(..) => Level::Constant,
        };
        let level = node.operands().map(|id| self.level(id)).fold(own, Level::max);
        let id = NodeId(self.nodes.len() as u32);
        self.nodes.push(node);
        self.levels.push(level);
        self.known.insert(node, id);
        id.positive()
    }

    pub(super) fn constant(&mut self, value: f64) -> Signed {
        let positive = self.intern(Node::Constant((value.abs() + 0.0).to_bits()));
        positive.times_sign(value < 0.0)
    }

    pub(super) fn input(&mut self, array: Array, index: usize) -> Signed {
        self.intern(Node::Input(array, index))
    }

    /// The value, if it is a constant.
    pub(super) fn value(&self, of: Signed) -> Option<f64> {
        match self.node(of.node) {
            Node::Constant(bits) if of.negative => Some(-f64::from_bits(bits)),
            Node::Constant(bits) => Some(f64::from_bits(bits)),
            Node::Input(..)
            | Node::Sine(_)
            | Node::Cosine(_)
            | Node::Sign(_)
            | Node::Sum(..)
            | Node::Difference(..)
            | Node::Product(..)
            | Node::Quotient(..)
            | Node::Function(..) => None,
        }
    }

    pub(super) fn is_zero(&self, of: Signed) -> bool {
        self.value(of) == Some(0.0)
    }

    /// Whether it is known from the parameters alone.
    fn is_fixed(&self, id: NodeId) -> bool {
        self.level(id) < Level::State
    }

    pub(super) fn sine(&mut self, angle: Signed) -> Signed {
        match self.value(angle) {
            Some(value) => self.constant(value.sin()),
            None => self.intern(Node::Sine(angle.node)).times_sign(angle.negative),
        }
    }

    pub(super) fn cosine(&mut self, angle: Signed) -> Signed {
        match self.value(angle) {
            Some(value) => self.constant(value.cos()),
            None => self.intern(Node::Cosine(angle.node)),
        }
    }

    pub(super) fn sign(&mut self, of: Signed) -> Signed {
        match self.value(of) {
            Some(0.0) => of,
            Some(value) => self.constant(value.signum()),
            None => self.intern(Node::Sign(of.node)).times_sign(of.negative),
        }
    }

    pub(super) fn add(&mut self, a: Signed, b: Signed) -> Signed {
        if let (Some(x), Some(y)) = (self.value(a), self.value(b)) {
            let sum = x + y;
            return self.constant(if sum.abs() <= CANCELLED * x.abs().max(y.abs()) { 0.0 } else { sum });
        }
        if self.is_zero(a) {
            return b;
        }
        if self.is_zero(b) {
            return a;
        }
        if a.node == b.node {
            let factor = self.constant(if a.negative == b.negative { 2.0 } else { 0.0 });
            return self.multiply(factor, a);
        }
        let simpler = self.without_opposite(a, b).or_else(|| self.without_opposite(b, a));
        let simpler = simpler.or_else(|| self.with_common_factor(a, b)).or_else(|| self.with_fixed_part(a, b));
        if let Some(sum) = simpler {
            return sum;
        }
        let (first, second) = if a.node < b.node { (a, b) } else { (b, a) };
        let (m, n) = (first.node, second.node);
        let node = if first.negative == second.negative { Node::Sum(m, n) } else { Node::Difference(m, n) };
        self.intern(node).times_sign(first.negative)
    }

    /// `x p + x r = x (p + r)` where `p + r` is known before `x`.
    fn with_common_factor(&mut self, a: Signed, b: Signed) -> Option<Signed> {
        let (x, p) = self.earlier_factor(a);
        let (y, r) = self.earlier_factor(b);
        if x != y {
            return None;
        }
        let factor = self.add(p, r);
        Some(self.multiply(factor, x.positive()))
    }

    /// Splits a value into a factor known later and one known earlier: from the parameters, or a number.
    fn earlier_factor(&mut self, of: Signed) -> (NodeId, Signed) {
        if let Node::Product(a, b) = self.node(of.node) {
            match (self.level(a) < self.level(of.node), self.level(b) < self.level(of.node)) {
                (true, _) => return (b, a.positive().times_sign(of.negative)),
                (_, true) => return (a, b.positive().times_sign(of.negative)),
                (false, false) => {}
            }
        }
        let one = self.constant(1.0);
        (of.node, one.times_sign(of.negative))
    }

    /// `(x + p) + r = x + (p + r)` if `p` and `r` are known from the parameters alone.
    fn with_fixed_part(&mut self, a: Signed, b: Signed) -> Option<Signed> {
        let (sum, part) = match (self.is_fixed(a.node), self.is_fixed(b.node)) {
            (false, true) => (a, b),
            (true, false) => (b, a),
            (true, true) | (false, false) => return None,
        };
        let [first, second] = self.parts(sum)?;
        let (x, p) = match (self.is_fixed(first.node), self.is_fixed(second.node)) {
            (false, true) => (first, second),
            (true, false) => (second, first),
            (true, true) | (false, false) => return None,
        };
        let fixed = self.add(p, part);
        Some(self.add(x, fixed))
    }

    /// `(x + y) - y = x`.
    fn without_opposite(&self, sum: Signed, other: Signed) -> Option<Signed> {
        let [first, second] = self.parts(sum)?;
        let opposite = other.times_sign(true);
        match (first == opposite, second == opposite) {
            (true, _) => Some(second),
            (_, true) => Some(first),
            (false, false) => None,
        }
    }

    /// The signed operands of a sum or difference.
    pub(super) fn parts(&self, of: Signed) -> Option<[Signed; 2]> {
        let (a, b, negative) = match self.node(of.node) {
            Node::Sum(a, b) => (a, b, false),
            Node::Difference(a, b) => (a, b, true),
            Node::Constant(_)
            | Node::Input(..)
            | Node::Sine(_)
            | Node::Cosine(_)
            | Node::Sign(_)
            | Node::Product(..)
            | Node::Quotient(..)
            | Node::Function(..) => return None,
        };
        Some([a.positive().times_sign(of.negative), b.positive().times_sign(of.negative != negative)])
    }

    pub(super) fn multiply(&mut self, a: Signed, b: Signed) -> Signed {
        let negative = a.negative != b.negative;
        let (a, b) = (a.magnitude(), b.magnitude());
        let product = match (self.value(a), self.value(b)) {
            (Some(x), Some(y)) => self.constant(x * y),
            (Some(x), None) => self.scaled(x, b),
            (None, Some(y)) => self.scaled(y, a),
            (None, None) => self.product(a, b),
        };
        product.times_sign(negative)
    }

    fn scaled(&mut self, factor: f64, of: Signed) -> Signed {
        if factor == 0.0 {
            return self.constant(0.0);
        }
        if factor == 1.0 {
            return of;
        }
        let factor = self.constant(factor);
        self.product(factor, of)
    }

    /// The product of two values that are not both numbers: early factors are combined.
    fn product(&mut self, a: Signed, b: Signed) -> Signed {
        let (early, late) = if self.level(a.node) <= self.level(b.node) { (a, b) } else { (b, a) };
        if self.level(late.node) == Level::State && self.level(early.node) == Level::State {
            return self.ordered_product(a, b);
        }
        let (x, p) = self.earlier_factor(late);
        if x != late.node {
            let factor = self.multiply(early, p);
            return self.multiply(factor, x.positive());
        }
        match self.earlier_factor(early) {
            (y, r) if y != early.node && self.level(early.node) == self.level(late.node) => {
                let rest = self.ordered_product(y.positive(), late);
                self.multiply(r, rest)
            }
            _ => self.ordered_product(early, late),
        }
    }

    fn ordered_product(&mut self, a: Signed, b: Signed) -> Signed {
        let (first, second) = if a.node < b.node { (a.node, b.node) } else { (b.node, a.node) };
        self.intern(Node::Product(first, second))
    }

    /// A function other than sine and cosine, of one or two arguments.
    pub(super) fn function(&mut self, function: MathFunction, a: Signed, b: Option<Signed>) -> Signed {
        let numbers = [Some(a), b].map(|argument| argument.map(|argument| self.value(argument)));
        match numbers {
            [Some(Some(x)), None] => self.constant(function.value(x, 0.0)),
            [Some(Some(x)), Some(Some(y))] => self.constant(function.value(x, y)),
            [_, Some(Some(y))]
                if function == MathFunction::Power && y.fract() == 0.0 && (1.0..=MOST_FACTORS).contains(&y) =>
            {
                (1..y as usize).fold(a, |product, _| self.multiply(product, a))
            }
            [Some(None), _] | [Some(Some(_)), Some(None)] | [None, _] => self.intern(Node::Function(function, a, b)),
        }
    }

    pub(super) fn divide(&mut self, a: Signed, b: Signed) -> Signed {
        match self.value(b) {
            _ if self.is_zero(a) => a,
            Some(value) => {
                let inverse = self.constant(1.0 / value);
                self.multiply(a, inverse)
            }
            None => self.intern(Node::Quotient(a.node, b.node)).times_sign(a.negative != b.negative),
        }
    }
}
