//! The torque for a unit of each term's parameter, defined only here.

use super::{
    geometry::BASE,
    model::Model,
    parameters::DynamicParameters,
    sign::Sign,
    state::{JointCoordinate, State},
    term_columns::{Body, ModelTerm},
};
use crate::robot::{Cylinder, Expression, LinkPoint, Shape, Stribeck, StribeckLaw, TwoPoints, Variable};
use thetahat_ground::{
    real::{Dual, Parameter, Real, absolute, exp, function_of, power, square_root},
    vector::{Vec3, add, dot, in_lanes},
};

/// Smallest fraction of the gas that a cylinder leaves: beyond it the force no longer grows.
#[doc(hidden)]
pub const LEAST_GAS: f64 = 0.05;

/// Bodies that move with a joint: their mass, and their first moments in its frame.
#[derive(Clone, Copy)]
struct Carried<T> {
    joint: usize,
    mass: f64,
    moments: Vec3<T>,
}

impl Model {
    /// Adds the torques of the terms.
    pub(super) fn add_term_torques<T: Real, P: Parameter<T>>(
        &self,
        parameters: &DynamicParameters<P>,
        state: State<'_, T>,
        ddq: &[T],
        sign: Sign,
        tau: &mut [T],
    ) {
        for (term, value) in self.terms.iter().zip(&parameters.terms) {
            for &c in &term.coordinates {
                let column = self.term_torque(term, c, state, ddq, sign);
                tau[c] += column * value.in_lanes(column);
            }
        }
    }

    /// The torque of a term on one of its coordinates for a unit of its parameter.
    pub(crate) fn term_torque<T: Real>(
        &self,
        term: &ModelTerm,
        coordinate: usize,
        state: State<'_, T>,
        ddq: &[T],
        sign: Sign,
    ) -> T {
        let JointCoordinate { ratio, kind, .. } = term.moved_by;
        let (q, dq) = (term.moved_by.position(state.q), term.moved_by.rate(state.dq));
        let one = dq.like(1.0);
        let on_joint = match &term.shape {
            Shape::Constant => one,
            Shape::Deflection { rest } => q - q.like(*rest),
            Shape::Velocity => dq,
            Shape::AbsoluteVelocity => dq * sign.of_each(dq, kind),
            Shape::VelocityPower { exponent } => (2..*exponent).fold(dq * absolute(dq), |p, _| p * absolute(dq)),
            Shape::Sign => sign.of_each(dq, kind),
            Shape::Stribeck(stribeck) => sign.of_each(dq, kind) * falling(*stribeck, dq),
            Shape::Load => {
                sign.of_each(dq, kind) * absolute(self.weight(&term.bodies, coordinate, state.q)) / one.like(ratio)
            }
            Shape::Expression(expression) => self.expression(expression, term, state, ddq, sign),
            Shape::Harmonic { angle, torque, multiple, sine } => {
                let weight = torque.iter().find(|(c, _)| *c == coordinate).map_or(0.0, |(_, w)| *w);
                let angle = angle.iter().fold(dq.like(0.0), |sum, (c, w)| sum + state.q[*c] * (w * multiple));
                let (s, c) = angle.sin_cos();
                return term.times_channel(if *sine { s } else { c } * weight, state);
            }
            Shape::BetweenPoints(points) => return self.force(points, coordinate, state.q),
        };
        term.times_channel(on_joint, state) * ratio
    }

    /// The torque of gravity on a coordinate, by virtual work.
    fn weight<T: Real>(&self, bodies: &[Body], coordinate: usize, q: &[T]) -> T {
        let varied = varied(q, coordinate);
        let nothing = Carried { joint: BASE, mass: 0.0, moments: in_lanes(varied[0], [0.0; 3]) };
        let (mut carried, mut in_base) = (nothing, nothing.moments);
        for body in bodies.iter().rev().filter(|b| self.support(b.joint).coordinates.contains(&coordinate)) {
            carried = self.brought(carried, Some(body.joint), &varied);
            if carried.joint != body.joint {
                in_base = add(in_base, self.brought(carried, None, &varied).moments);
                carried = Carried { joint: body.joint, ..nothing };
            }
            carried.mass += body.mass;
            carried.moments = add(carried.moments, in_lanes(varied[0], body.moments));
        }
        in_base = add(in_base, self.brought(carried, None, &varied).moments);
        let slopes = in_base.map(|moment| moment.derivative);
        -dot(slopes, in_lanes(slopes[0], self.gravity))
    }

    /// The same bodies in the frame of an earlier joint that carries them, else of the last before it; of none in the base's.
    fn brought<T: Real>(&self, mut bodies: Carried<T>, to: Option<usize>, q: &[T]) -> Carried<T> {
        while let Some(joint) = self.joints.get(bodies.joint).filter(|_| to.is_none_or(|to| bodies.joint > to)) {
            let (r, p) = joint.placement(q);
            let moments = add(r.times(bodies.moments), p.map(|p| p * bodies.mass));
            bodies.moments = joint.turn.as_ref().map_or(moments, |turn| turn.times(moments));
            bodies.joint = joint.parent;
        }
        bodies
    }

    /// The torque of a force between two points, by virtual work: the tension times the derivative of the distance.
    fn force<T: Real>(&self, points: &TwoPoints, coordinate: usize, q: &[T]) -> T {
        let varied = varied(q, coordinate);
        let end = |point: &LinkPoint| self.point_in_base(point.joint, in_lanes(varied[0], point.position), &varied);
        let (from, to) = (end(&points.from), end(&points.to));
        let distance = [0, 1, 2].map(|i| to[i].value - from[i].value);
        let rate = [0, 1, 2].map(|i| to[i].derivative - from[i].derivative);
        let length = square_root(dot(distance, distance));
        tension(points.tension, length) * (dot(distance, rate) / length)
    }

    /// A point of a link in the base frame.
    fn point_in_base<T: Real>(&self, joint: Option<usize>, mut point: Vec3<T>, q: &[T]) -> Vec3<T> {
        let mut next = joint.unwrap_or(BASE);
        while let Some(joint) = self.joints.get(next) {
            let (r, p) = joint.placement(q);
            point = add(r.times(point), p);
            if let Some(turn) = &joint.turn {
                point = turn.times(point);
            }
            next = joint.parent;
        }
        point
    }

    fn expression<T: Real>(
        &self,
        expression: &Expression,
        term: &ModelTerm,
        state: State<'_, T>,
        ddq: &[T],
        sign: Sign,
    ) -> T {
        let joint = |j: &usize| &self.joints[*j];
        let value = |(variable, channel): (&Variable, &usize)| match variable {
            Variable::Position(j) => joint(j).position(state.q),
            Variable::Velocity(j) => joint(j).rate(state.dq),
            Variable::Acceleration(j) => joint(j).rate(ddq),
            Variable::Sign(j) => sign.of_each(joint(j).rate(state.dq), joint(j).moved_by.kind),
            Variable::Channel(_) => state.channels[*channel],
        };
        let values: Vec<T> = expression.variables().iter().zip(&term.channels).map(value).collect();
        match values.first() {
            None => state.q[0].like(expression.value(&[])),
            Some(_) => function_of(&values, |values| expression.value(values)),
        }
    }
}

impl ModelTerm {
    fn times_channel<T: Real>(&self, torque: T, state: State<'_, T>) -> T {
        match self.factor {
            None => torque,
            Some((place, reference)) => torque * (state.channels[place] - torque.like(reference)),
        }
    }
}

/// Positions as dual numbers that vary with one coordinate.
fn varied<T: Real>(q: &[T], coordinate: usize) -> Vec<Dual<T>> {
    let derivative = |c: usize, value: &T| value.like(if c == coordinate { 1.0 } else { 0.0 });
    q.iter().enumerate().map(|(c, value)| Dual { value: *value, derivative: derivative(c, value) }).collect()
}

/// The remaining fraction of Stribeck friction at a velocity.
fn falling<T: Real>(Stribeck { law, velocity, exponent }: Stribeck, dq: T) -> T {
    let power = power(absolute(dq) * (1.0 / velocity), exponent);
    match law {
        StribeckLaw::Exponential => exp(-power),
        StribeckLaw::Rational => dq.like(1.0) / (power + dq.like(1.0)),
    }
}

/// The tension for a unit of the parameter, at a distance between the points.
fn tension<T: Real>(cylinder: Cylinder, distance: T) -> T {
    match cylinder {
        Cylinder::Constant(tension) => distance.like(tension),
        Cylinder::Linear { length } => distance - distance.like(length),
        Cylinder::Gas { sign, length, gas_length, exponent } => {
            let left = distance.like(1.0) - (distance - distance.like(length)) * (sign / gas_length);
            let least = distance.like(LEAST_GAS);
            let left = left.select_less(least, least, left);
            power(distance.like(1.0) / left, exponent) * sign
        }
    }
}
