//! User-defined torque terms: springs, friction laws, motor harmonics, expressions.
//!
//! The expressions of the formulas in `dynamics/term_torques.rs`.

use super::{
    error::SymbolicError,
    expression::{Expression, Vector, add, dot, times},
    graph::Array,
    inertia::links,
    joints::Chain,
    kinematics::{Pose, poses},
    newton_euler::{Rates, link_torques},
};
use thetahat_ground::vector;
use thetahat_model::{
    dynamics::LEAST_GAS,
    robot::{
        Cylinder, Expression as UserExpression, Formula, LinkPoint, MathFunction, Robot, Shape, Stribeck, StribeckLaw,
        TermColumn, TwoPoints, Variable,
    },
};

/// The torques of a term for a unit of its parameter: coordinate by coordinate.
pub(super) type TermTorques<'g> = Vec<(usize, Expression<'g>)>;

/// The torques of all terms of a robot, in order.
pub(super) fn term_torques<'g>(
    chain: &Chain<'g>,
    robot: &Robot,
    rates: Rates<'_, 'g>,
) -> Result<Vec<TermTorques<'g>>, SymbolicError> {
    if robot.terms.is_empty() {
        return Ok(Vec::new());
    }
    let terms = Terms { chain, robot, rates, poses: poses(chain) };
    robot.terms.iter().map(|term| terms.torques(term)).collect()
}

struct Terms<'a, 'g> {
    chain: &'a Chain<'g>,
    robot: &'a Robot,
    rates: Rates<'a, 'g>,
    poses: Vec<Pose<'g>>,
}

impl<'g> Terms<'_, 'g> {
    fn torques(&self, term: &TermColumn) -> Result<TermTorques<'g>, SymbolicError> {
        if let Some(factor) = &term.factor {
            let (parameter, channel) = (term.parameter.clone(), factor.channel.clone());
            return Err(SymbolicError::Channel { parameter, channel });
        }
        let (dq, one) = (self.velocity(term.joint), self.chain.builder.constant(1.0));
        let sign = self.chain.joints[term.joint].sign(dq);
        let on_joint = match &term.shape {
            Shape::Constant => one,
            Shape::Deflection { rest } => self.position(term.joint) - self.chain.builder.constant(*rest),
            Shape::Velocity => dq,
            Shape::AbsoluteVelocity => dq * sign,
            Shape::VelocityPower { exponent } => (1..*exponent).fold(dq, |power, _| power * dq.magnitude()),
            Shape::Sign => sign,
            Shape::Stribeck(stribeck) => sign * self.falling(*stribeck, dq),
            Shape::Load => sign * self.load(term.joint),
            Shape::Expression(expression) => self.expression(term, expression)?,
            Shape::Harmonic { angle, torque, multiple, sine } => {
                let zero = self.chain.builder.zero();
                let angle = angle.iter().fold(zero, |sum, &(c, w)| sum + self.coordinate(c) * (w * multiple));
                let turned = if *sine { angle.sine() } else { angle.cosine() };
                return Ok(torque.iter().map(|&(c, weight)| (c, turned * weight)).collect());
            }
            Shape::BetweenPoints(points) => return Ok(self.between(points)),
        };
        let joint = &self.chain.joints[term.joint];
        Ok(vec![(joint.coordinate, on_joint * joint.ratio)])
    }

    fn coordinate(&self, coordinate: usize) -> Expression<'g> {
        self.chain.builder.input(Array::Position, coordinate)
    }

    fn position(&self, joint: usize) -> Expression<'g> {
        let offset = self.robot.joints[joint].mimic.map_or(0.0, |mimic| mimic.offset);
        let moved = &self.chain.joints[joint];
        self.coordinate(moved.coordinate) * moved.ratio + self.chain.builder.constant(offset)
    }

    fn velocity(&self, joint: usize) -> Expression<'g> {
        self.chain.joints[joint].rate(self.rates.dq)
    }

    /// The remaining fraction of Stribeck friction at a velocity.
    fn falling(&self, Stribeck { law, velocity, exponent }: Stribeck, dq: Expression<'g>) -> Expression<'g> {
        let one = self.chain.builder.constant(1.0);
        let exponent = self.chain.builder.constant(exponent);
        let power = (dq.magnitude() * (1.0 / velocity)).function_with(MathFunction::Power, exponent);
        match law {
            StribeckLaw::Exponential => (-power).function(MathFunction::Exponential),
            StribeckLaw::Rational => one / (power + one),
        }
    }

    /// The magnitude of a joint's torque of gravity at the a-priori parameters.
    fn load(&self, joint: usize) -> Expression<'g> {
        let builder = self.chain.builder;
        let theta: Vec<_> = self.robot.a_priori_parameters().iter().map(|value| builder.constant(*value)).collect();
        let rest = vec![builder.zero(); self.chain.coordinates];
        let rates = Rates { dq: &rest, ddq: &rest, with_gravity: true };
        let torques = link_torques(self.chain, &links(self.chain, self.robot, &theta), rates);
        let joint = &self.chain.joints[joint];
        torques[joint.coordinate].magnitude() * (1.0 / joint.ratio)
    }

    /// The tension times the derivatives of the distance.
    fn between(&self, points: &TwoPoints) -> TermTorques<'g> {
        let [from, to] = [&points.from, &points.to].map(|point| self.point(point));
        let way = [0, 1, 2].map(|i| to[i] - from[i]);
        let length = dot(way, way).function(MathFunction::SquareRoot);
        let tension = self.tension(points.tension, length);
        let derivative = |c: usize| Expression::derivatives(&[length], Array::Position, c)[0];
        let torques = (0..self.chain.coordinates).map(|c| (c, tension * derivative(c)));
        torques.filter(|(_, torque)| torque.number() != Some(0.0)).collect()
    }

    /// A point of a link in the frame of the base, m.
    fn point(&self, point: &LinkPoint) -> Vector<'g> {
        let builder = self.chain.builder;
        let Some(joint) = point.joint else { return builder.constants(point.position) };
        let axes = self.robot.joints[joint].link_axes.as_ref();
        let position = axes.map_or(point.position, |axes| vector::times(axes, point.position));
        let Pose { rotation, origin } = &self.poses[joint];
        add(times(rotation, builder.constants(position)), origin.map(|entry| entry * self.chain.unit))
    }

    /// The tension for a unit of the parameter.
    fn tension(&self, cylinder: Cylinder, distance: Expression<'g>) -> Expression<'g> {
        let constant = |value| self.chain.builder.constant(value);
        match cylinder {
            Cylinder::Constant(tension) => constant(tension),
            Cylinder::Linear { length } => distance - constant(length),
            Cylinder::Gas { sign, length, gas_length, exponent } => {
                let left = constant(1.0) - (distance - constant(length)) * (sign / gas_length);
                let left = left.function_with(MathFunction::Larger, constant(LEAST_GAS));
                (constant(1.0) / left).function_with(MathFunction::Power, constant(exponent)) * sign
            }
        }
    }

    fn expression(&self, term: &TermColumn, expression: &UserExpression) -> Result<Expression<'g>, SymbolicError> {
        let parameter = || term.parameter.clone();
        let formula =
            expression.formula().map_err(|problem| SymbolicError::Expression { parameter: parameter(), problem })?;
        let value = |variable: &Variable| match variable {
            Variable::Position(joint) => Ok(self.position(*joint)),
            Variable::Velocity(joint) => Ok(self.velocity(*joint)),
            Variable::Acceleration(joint) => Ok(self.chain.joints[*joint].rate(self.rates.ddq)),
            Variable::Sign(joint) => Ok(self.chain.joints[*joint].sign(self.velocity(*joint))),
            Variable::Channel(channel) => {
                Err(SymbolicError::Channel { parameter: parameter(), channel: channel.clone() })
            }
        };
        let variables = expression.variables().iter().map(value).collect::<Result<Vec<_>, _>>()?;
        Ok(self.traced(&formula, &variables))
    }

    /// A formula of at most some hundred characters.
    fn traced(&self, formula: &Formula, variables: &[Expression<'g>]) -> Expression<'g> {
        let of = |formula: &Formula| self.traced(formula, variables);
        match formula {
            Formula::Number(number) => self.chain.builder.constant(*number),
            Formula::Variable(place) => variables[*place],
            Formula::Negative(a) => -of(a),
            Formula::Absolute(a) => of(a).magnitude(),
            Formula::Sine(a) => of(a).sine(),
            Formula::Cosine(a) => of(a).cosine(),
            Formula::Sum(both) => of(&both[0]) + of(&both[1]),
            Formula::Difference(both) => of(&both[0]) - of(&both[1]),
            Formula::Product(both) => of(&both[0]) * of(&both[1]),
            Formula::Quotient(both) => of(&both[0]) / of(&both[1]),
            Formula::Function(function, arguments) => match arguments.as_slice() {
                [a, b] => of(a).function_with(*function, of(b)),
                other => other.first().map_or_else(|| self.chain.builder.zero(), |a| of(a).function(*function)),
            },
        }
    }
}
