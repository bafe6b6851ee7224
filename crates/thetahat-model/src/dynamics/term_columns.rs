//! The columns of torque terms, prepared for the kernels.

use std::sync::Arc;

use super::{
    geometry::{BASE, JointGeometry},
    state::JointCoordinate,
};
use crate::robot::{INERTIAL, LinkPoint, LinkQuantity, Quantity, Robot, Shape, TermColumn, TwoPoints, Variable};
use thetahat_ground::vector::{Vec3, times};

/// A column of a term, prepared for the kernels.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ModelTerm {
    /// The coordinates on which it acts.
    pub(crate) coordinates: Vec<usize>,
    pub(super) moved_by: JointCoordinate,
    pub(super) shape: Shape,
    /// Index of the values of the channel that multiplies it, and its reference.
    pub(super) factor: Option<(usize, f64)>,
    /// Indices of the channels of an expression's variables.
    pub(super) channels: Vec<usize>,
    /// The bodies whose weight is its load: the link's joint, mass, first moments in the joint's frame.
    pub(super) bodies: Arc<Vec<Body>>,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Body {
    pub(super) joint: usize,
    pub(super) mass: f64,
    pub(super) moments: Vec3,
}

/// The terms of a robot, whose joints are `joints`.
pub(super) fn terms_of(robot: &Robot, joints: &[JointGeometry]) -> Vec<ModelTerm> {
    let names = robot.channels();
    let place = |name: &String| names.iter().position(|n| n == name).unwrap_or(0) * robot.coordinate_count();
    let bodies = Arc::new(bodies(robot));
    let term = |column: &TermColumn| {
        let moved_by = joints[column.joint].moved_by;
        let channel = |v: &Variable| if let Variable::Channel(name) = v { place(name) } else { 0 };
        let channels = match &column.shape {
            Shape::Expression(expression) => expression.variables().iter().map(channel).collect(),
            Shape::Constant
            | Shape::Deflection { .. }
            | Shape::Velocity
            | Shape::AbsoluteVelocity
            | Shape::VelocityPower { .. }
            | Shape::Sign
            | Shape::Stribeck(_)
            | Shape::Load
            | Shape::Harmonic { .. }
            | Shape::BetweenPoints(_) => Vec::new(),
        };
        ModelTerm {
            coordinates: coordinates(&column.shape, moved_by, joints),
            moved_by,
            shape: in_joint_axes(robot, &column.shape),
            factor: column.factor.as_ref().map(|f| (place(&f.channel) + moved_by.coordinate, f.reference)),
            channels: channels.into_iter().map(|start| start + moved_by.coordinate).collect(),
            bodies: bodies.clone(),
        }
    };
    robot.terms.iter().map(term).collect()
}

/// The a-priori masses and first moments that gravity acts on.
fn bodies(robot: &Robot) -> Vec<Body> {
    let (table, theta) = (robot.parameter_table(), robot.a_priori_parameters());
    let body = |(joint, of): (usize, &crate::robot::Joint)| {
        let value = |quantity| table.index(Quantity::Link(quantity), joint).map_or(0.0, |i| theta[i]);
        let moments = [LinkQuantity::Mx, LinkQuantity::My, LinkQuantity::Mz].map(value);
        let moments = of.link_axes.as_ref().map_or(moments, |axes| times(axes, moments));
        Body { joint, mass: value(INERTIAL[9]), moments }
    };
    let weighs = |b: &Body| b.mass != 0.0 || b.moments != [0.0; 3];
    robot.joints.iter().enumerate().map(body).filter(weighs).collect()
}

/// Points in the axes of their joints' frames.
fn in_joint_axes(robot: &Robot, shape: &Shape) -> Shape {
    let Shape::BetweenPoints(TwoPoints { from, to, tension }) = shape else { return shape.clone() };
    let turned = |point: &LinkPoint| {
        let axes = point.joint.and_then(|j| robot.joints[j].link_axes.as_ref());
        LinkPoint { position: axes.map_or(point.position, |axes| times(axes, point.position)), ..*point }
    };
    Shape::BetweenPoints(TwoPoints { from: turned(from), to: turned(to), tension: *tension })
}

/// The coordinates on which a column acts, rising.
fn coordinates(shape: &Shape, own: JointCoordinate, joints: &[JointGeometry]) -> Vec<usize> {
    let mut all = match shape {
        Shape::Harmonic { torque, .. } => torque.iter().map(|(c, _)| *c).collect(),
        Shape::BetweenPoints(TwoPoints { from, to, .. }) => {
            let [from, to] = [from, to].map(|end| joints_before(end.joint, joints));
            let moves_one = |j: &&usize| from.contains(*j) != to.contains(*j);
            from.iter().chain(&to).filter(moves_one).flat_map(|j| joints[*j].shares().map(|(c, _)| c)).collect()
        }
        Shape::Constant
        | Shape::Deflection { .. }
        | Shape::Velocity
        | Shape::AbsoluteVelocity
        | Shape::VelocityPower { .. }
        | Shape::Sign
        | Shape::Stribeck(_)
        | Shape::Load
        | Shape::Expression(_) => vec![own.coordinate],
    };
    all.sort_unstable();
    all.dedup();
    all
}

/// The joints between a link and the base.
fn joints_before(joint: Option<usize>, joints: &[JointGeometry]) -> Vec<usize> {
    std::iter::successors(joint, |&j| Some(joints[j].parent).filter(|parent| *parent != BASE)).collect()
}

impl ModelTerm {
    /// Whether it uses a recorded channel.
    pub(crate) fn takes_channel(&self) -> bool {
        let is_channel = |v: &Variable| matches!(v, Variable::Channel(_));
        let in_expression = match &self.shape {
            Shape::Expression(expression) => expression.variables().iter().any(is_channel),
            Shape::Constant
            | Shape::Deflection { .. }
            | Shape::Velocity
            | Shape::AbsoluteVelocity
            | Shape::VelocityPower { .. }
            | Shape::Sign
            | Shape::Stribeck(_)
            | Shape::Load
            | Shape::Harmonic { .. }
            | Shape::BetweenPoints(_) => false,
        };
        in_expression || self.factor.is_some()
    }
}
