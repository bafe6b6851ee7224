//! Derivatives of expressions, node by node.

use super::graph::{Array, Graph, Node, NodeId, Signed};
use thetahat_model::robot::MathFunction;

/// The derivatives of values with respect to an input. The sign of a velocity and steps are treated as constant.
pub(super) fn derivatives(graph: &mut Graph, of: &[Signed], array: Array, index: usize) -> Vec<Signed> {
    let input = graph.input(array, index);
    let zero = graph.constant(0.0);
    // Operands come before the nodes that use them: no recursion is needed.
    let last = of.iter().map(|value| value.node.index() + 1).max().unwrap_or(0);
    let mut forward = Forward { graph, found: vec![zero; last] };
    let needed = forward.needed(of, last);
    for place in (0..last).filter(|place| needed[*place]) {
        let id = forward.graph.id(place);
        forward.found[place] = if id == input.node { forward.graph.constant(1.0) } else { forward.of_node(id) };
    }
    of.iter().map(|value| forward.of(*value)).collect()
}

struct Forward<'a> {
    graph: &'a mut Graph,
    /// The derivative of each node; zero for nodes that are not needed.
    found: Vec<Signed>,
}

impl Forward<'_> {
    /// Whether the values depend on each node.
    fn needed(&self, of: &[Signed], last: usize) -> Vec<bool> {
        let mut needed = vec![false; last];
        of.iter().for_each(|value| needed[value.node.index()] = true);
        for place in (0..last).rev() {
            if needed[place] {
                self.graph.node(self.graph.id(place)).operands().for_each(|operand| needed[operand.index()] = true);
            }
        }
        needed
    }

    fn of(&self, value: Signed) -> Signed {
        self.found[value.node.index()].times_sign(value.negative)
    }

    fn of_node(&mut self, id: NodeId) -> Signed {
        let own = id.positive();
        match self.graph.node(id) {
            Node::Constant(_) | Node::Input(..) | Node::Sign(_) => self.graph.constant(0.0),
            Node::Sine(a) => {
                let slope = self.graph.cosine(a.positive());
                self.chained(slope, a.positive())
            }
            Node::Cosine(a) => {
                let slope = self.graph.sine(a.positive()).times_sign(true);
                self.chained(slope, a.positive())
            }
            Node::Sum(a, b) => self.graph.add(self.found[a.index()], self.found[b.index()]),
            Node::Difference(a, b) => self.graph.add(self.found[a.index()], self.found[b.index()].times_sign(true)),
            Node::Product(a, b) => {
                let (first, second) =
                    (self.chained(b.positive(), a.positive()), self.chained(a.positive(), b.positive()));
                self.graph.add(first, second)
            }
            Node::Quotient(a, b) => {
                let change = self.chained(own, b.positive()).times_sign(true);
                let rest = self.graph.add(self.found[a.index()], change);
                self.graph.divide(rest, b.positive())
            }
            Node::Function(function, a, None) => {
                let slope = self.slope(function, own, a);
                self.chained(slope, a)
            }
            Node::Function(function, a, Some(b)) => self.of_two(function, own, [a, b]),
        }
    }

    /// `slope da`.
    fn chained(&mut self, slope: Signed, a: Signed) -> Signed {
        let change = self.of(a);
        self.graph.multiply(slope, change)
    }

    /// The derivative of a function of one argument; `own` is its value.
    fn slope(&mut self, function: MathFunction, own: Signed, a: Signed) -> Signed {
        use MathFunction as F;
        let one = self.graph.constant(1.0);
        let squared = |forward: &mut Self, x: Signed| forward.graph.multiply(x, x);
        match function {
            F::Exponential => own,
            F::Logarithm => self.graph.divide(one, a),
            F::SquareRoot => {
                let half = self.graph.constant(0.5);
                self.graph.divide(half, own)
            }
            F::CubeRoot => {
                let (third, square) = (self.graph.constant(1.0 / 3.0), squared(self, own));
                self.graph.divide(third, square)
            }
            F::Tangent => {
                let square = squared(self, own);
                self.graph.add(one, square)
            }
            F::HyperbolicTangent => {
                let square = squared(self, own);
                self.graph.add(one, square.times_sign(true))
            }
            F::HyperbolicSine => self.graph.function(F::HyperbolicCosine, a, None),
            F::HyperbolicCosine => self.graph.function(F::HyperbolicSine, a, None),
            F::ArcTangent => self.over_square(a, [1.0, 1.0], false),
            F::AreaTangent => self.over_square(a, [1.0, -1.0], false),
            F::ArcSine => self.over_square(a, [1.0, -1.0], true),
            F::ArcCosine => self.over_square(a, [1.0, -1.0], true).times_sign(true),
            F::AreaSine => self.over_square(a, [1.0, 1.0], true),
            F::AreaCosine => self.over_square(a, [-1.0, 1.0], true),
            F::Floor | F::Power | F::ArcTangentOfPoint | F::Smaller | F::Larger => self.graph.constant(0.0),
        }
    }

    /// `1 / (c + d a^2)`, or one over its square root.
    fn over_square(&mut self, a: Signed, [c, d]: [f64; 2], rooted: bool) -> Signed {
        let (c, d, one) = (self.graph.constant(c), self.graph.constant(d), self.graph.constant(1.0));
        let square = self.graph.multiply(a, a);
        let scaled = self.graph.multiply(d, square);
        let sum = self.graph.add(c, scaled);
        let below = if rooted { self.graph.function(MathFunction::SquareRoot, sum, None) } else { sum };
        self.graph.divide(one, below)
    }

    /// The derivative of a function of two arguments; `own` is its value.
    fn of_two(&mut self, function: MathFunction, own: Signed, [a, b]: [Signed; 2]) -> Signed {
        use MathFunction as F;
        match function {
            F::Power => {
                let one = self.graph.constant(1.0);
                let less = self.graph.add(b, one.times_sign(true));
                let power = self.graph.function(F::Power, a, Some(less));
                let slope = self.graph.multiply(b, power);
                let by_base = self.chained(slope, a);
                if self.graph.is_zero(self.of(b)) {
                    return by_base;
                }
                let logarithm = self.graph.function(F::Logarithm, a, None);
                let slope = self.graph.multiply(own, logarithm);
                let by_exponent = self.chained(slope, b);
                self.graph.add(by_base, by_exponent)
            }
            F::ArcTangentOfPoint => {
                let (first, second) = (self.chained(b, a), self.chained(a, b).times_sign(true));
                let (aa, bb) = (self.graph.multiply(a, a), self.graph.multiply(b, b));
                let (above, below) = (self.graph.add(first, second), self.graph.add(aa, bb));
                self.graph.divide(above, below)
            }
            F::Larger | F::Smaller => {
                let difference = self.graph.add(a, b.times_sign(true));
                // 1 if the first argument is selected, -1 if the second is.
                let side = self.graph.sign(difference).times_sign(function == F::Smaller);
                let half = self.graph.constant(0.5);
                let (da, db) = (self.of(a), self.of(b));
                let (both, change) = (self.graph.add(da, db), self.graph.add(da, db.times_sign(true)));
                let sided = self.graph.multiply(side, change);
                let sum = self.graph.add(both, sided);
                self.graph.multiply(half, sum)
            }
            F::Exponential
            | F::Logarithm
            | F::SquareRoot
            | F::CubeRoot
            | F::Tangent
            | F::ArcSine
            | F::ArcCosine
            | F::ArcTangent
            | F::HyperbolicSine
            | F::HyperbolicCosine
            | F::HyperbolicTangent
            | F::AreaSine
            | F::AreaCosine
            | F::AreaTangent
            | F::Floor => self.graph.constant(0.0),
        }
    }
}
