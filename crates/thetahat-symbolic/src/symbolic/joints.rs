//! The joints of a robot in the form the recursions need.

use super::{
    expression::{Builder, Expression, Matrix, Vector, times},
    graph::Array,
    snapping::exact_sin_cos,
};
use thetahat_model::robot::{Joint as RobotJoint, JointKind, Robot};

/// Fraction of a length below which a remainder is rounding.
const ROUNDING: f64 = 1e-14;

/// A joint, with its frame in the frame before. All lengths are in the unit of length of the [`Chain`].
#[derive(Debug)]
pub(super) struct Joint<'g> {
    pub(super) is_revolute: bool,
    pub(super) parent: Option<usize>,
    /// The coordinate that moves it: its position is `ratio q + offset`.
    pub(super) coordinate: usize,
    pub(super) ratio: f64,
    /// Factor on its velocity in the sign of friction.
    in_sign: f64,
    /// `Rot(z, gamma)` and `Rot(x, alpha)` by sine and cosine: the constant part of its rotation.
    gamma: (f64, f64),
    alpha: (f64, f64),
    /// `Rot(z, theta)`, which a revolute joint turns.
    theta: (Expression<'g>, Expression<'g>),
    /// The turn of this joint and all previous joints with parallel axes, if the joint before is one of them.
    together: Option<(Expression<'g>, Expression<'g>)>,
    /// The point of its axis nearest to the origin of the frame before, in that frame.
    pub(super) foot: Vector<'g>,
    /// From that point to its own origin, along its axis.
    pub(super) along: Expression<'g>,
}

/// The joints of a robot in a unit of length.
#[derive(Debug)]
pub(super) struct Chain<'g> {
    pub(super) builder: &'g Builder,
    pub(super) joints: Vec<Joint<'g>>,
    pub(super) coordinates: usize,
    /// The unit of length, m: 1 if a joint is prismatic.
    pub(super) unit: f64,
    /// Acceleration of gravity, units of length per s^2.
    pub(super) gravity: [f64; 3],
}

impl<'g> Chain<'g> {
    /// The joints of a snapped robot, with lengths in multiples of `unit`; velocities of joints that slide are multiplied by `sliding` in the
    /// sign of friction.
    pub(super) fn new(builder: &'g Builder, robot: &Robot, unit: f64, sliding: f64) -> Self {
        let coordinates = robot.coordinate_joints();
        let joint = |(j, joint): (usize, &RobotJoint)| {
            let leader = joint.mimic.map_or(j, |mimic| mimic.of);
            // A leader follows no joint.
            let coordinate = coordinates.partition_point(|&own| own < leader);
            let made = Joint::new(builder, joint, coordinate, unit);
            match joint.kind {
                JointKind::Revolute => made,
                JointKind::Prismatic => Joint { in_sign: sliding, ..made },
            }
        };
        let mut joints: Vec<Joint<'g>> = Vec::with_capacity(robot.joints.len());
        for made in robot.joints.iter().enumerate().map(joint) {
            let together = made.parent.and_then(|parent| made.turned_with(&joints[parent]));
            joints.push(Joint { together, ..made });
        }
        let gravity = robot.gravity.map(|g| g / unit);
        Self { builder, joints, coordinates: coordinates.len(), unit, gravity }
    }

    /// The links, each before its parent.
    pub(super) fn inwards(&self) -> impl Iterator<Item = (usize, &Joint<'g>)> {
        self.joints.iter().enumerate().rev()
    }

    pub(super) fn none(&self) -> Vector<'g> {
        self.builder.constants([0.0; 3])
    }

    /// The joints from one inwards to the base.
    pub(super) fn way_to_base(&self, joint: usize) -> impl Iterator<Item = usize> + '_ {
        std::iter::successors(Some(joint), |&j| self.joints[j].parent)
    }
}

impl<'g> Joint<'g> {
    fn new(builder: &'g Builder, joint: &RobotJoint, coordinate: usize, unit: f64) -> Self {
        let (ratio, offset) = joint.mimic.map_or((1.0, 0.0), |mimic| (mimic.ratio, mimic.offset));
        let q = builder.input(Array::Position, coordinate) * ratio + builder.constant(offset);
        let is_revolute = match joint.kind {
            JointKind::Revolute => true,
            JointKind::Prismatic => false,
        };
        let theta = exact_sin_cos(joint.placement.theta + if is_revolute { offset } else { 0.0 });
        let fixed = (builder.constant(theta.0), builder.constant(theta.1));
        let (foot, along) = split(joint.placement.origin, joint.placement.gamma, joint.placement.alpha);
        let mut made = Self {
            is_revolute,
            parent: joint.parent,
            coordinate,
            ratio,
            in_sign: 1.0,
            gamma: exact_sin_cos(joint.placement.gamma),
            alpha: exact_sin_cos(joint.placement.alpha),
            theta: fixed,
            together: None,
            foot: builder.constants(foot.map(|length| length / unit)),
            along: builder.constant(along / unit),
        };
        if is_revolute {
            let angle = builder.input(Array::Position, coordinate) * ratio;
            made.theta = turned_by((angle.sine(), angle.cosine()), fixed);
        } else {
            made.along = made.along + q;
        }
        made
    }

    /// The turn of both joints, if the axis of the one before is parallel.
    fn turned_with(&self, before: &Self) -> Option<(Expression<'g>, Expression<'g>)> {
        let both_turn = self.is_revolute && before.is_revolute;
        let parallel = self.alpha == (0.0, 1.0) && self.gamma == (0.0, 1.0);
        (both_turn && parallel).then(|| turned_by(before.together.unwrap_or(before.theta), self.theta))
    }

    /// Whether it and the joint before turn about parallel axes.
    pub(super) fn is_parallel(&self) -> bool {
        self.together.is_some()
    }

    /// Its axis in the frame before.
    pub(super) fn axis(&self, builder: &'g Builder) -> Vector<'g> {
        self.tilted_back(builder.constants([0.0, 0.0, 1.0]))
    }

    /// Its own velocity or acceleration, given the rates of the coordinates.
    pub(super) fn rate(&self, rates: &[Expression<'g>]) -> Expression<'g> {
        rates[self.coordinate] * self.ratio
    }

    /// The sign of its velocity in friction.
    pub(super) fn sign(&self, velocity: Expression<'g>) -> Expression<'g> {
        (velocity * self.in_sign).sign()
    }

    /// Transforms a vector of the frame before to the tilted one, whose z axis is the joint's.
    pub(super) fn tilted(&self, x: Vector<'g>) -> Vector<'g> {
        let [x, y, z] = x;
        let (s, c) = self.gamma;
        let (x, y) = (x * c + y * s, y * c - x * s);
        let (s, c) = self.alpha;
        [x, y * c + z * s, z * c - y * s]
    }

    /// The reverse of [`Joint::tilted`].
    pub(super) fn tilted_back(&self, x: Vector<'g>) -> Vector<'g> {
        let [x, y, z] = x;
        let (s, c) = self.alpha;
        let (y, z) = (y * c - z * s, y * s + z * c);
        let (s, c) = self.gamma;
        [x * c - y * s, x * s + y * c, z]
    }

    /// Transforms a vector of the tilted frame to the joint's own.
    pub(super) fn turned(&self, x: Vector<'g>) -> Vector<'g> {
        let (s, c) = self.theta;
        [c * x[0] + s * x[1], c * x[1] - s * x[0], x[2]]
    }

    /// Transforms a vector of the tilted frame to the joint's own, by one turn for all parallel joints.
    ///
    /// `level` is the vector in the tilted frame of the first of them.
    pub(super) fn turned_at_once(&self, tilted: Vector<'g>, level: Vector<'g>) -> Vector<'g> {
        let (s, c) = self.together.unwrap_or(self.theta);
        [c * level[0] + s * level[1], c * level[1] - s * level[0], tilted[2]]
    }

    /// The reverse of [`Joint::turned`].
    pub(super) fn turned_back(&self, x: Vector<'g>) -> Vector<'g> {
        let (s, c) = self.theta;
        [c * x[0] - s * x[1], s * x[0] + c * x[1], x[2]]
    }

    /// Transforms a vector of the frame before to the joint's own.
    pub(super) fn seen(&self, x: Vector<'g>) -> Vector<'g> {
        self.turned(self.tilted(x))
    }

    /// The reverse of [`Joint::seen`].
    pub(super) fn seen_back(&self, x: Vector<'g>) -> Vector<'g> {
        self.tilted_back(self.turned_back(x))
    }

    /// `R^T A R`: transforms a matrix of the frame before to the joint's own.
    pub(super) fn seen_matrix(&self, a: &Matrix<'g>) -> Matrix<'g> {
        transpose(&transpose(&a.map(|row| self.seen(row))).map(|column| self.seen(column)))
    }

    /// `R^T A C z`: the product of `A` and the joint's axis, in the tilted frame.
    pub(super) fn axis_column(&self, a: &Matrix<'g>, builder: &'g Builder) -> Vector<'g> {
        self.tilted(times(a, self.axis(builder)))
    }

    pub(super) fn sine_and_cosine(&self) -> (Expression<'g>, Expression<'g>) {
        self.theta
    }
}

/// Splits an origin into a point of the axis and the length along it, with as few nonzero lengths as possible.
fn split(origin: [f64; 3], gamma: f64, alpha: f64) -> ([f64; 3], f64) {
    let ((sin_gamma, cos_gamma), (sin_alpha, cos_alpha)) = (exact_sin_cos(gamma), exact_sin_cos(alpha));
    let axis = [sin_gamma * sin_alpha, -cos_gamma * sin_alpha, cos_alpha];
    let along: f64 = axis.iter().zip(origin).map(|(a, p)| a * p).sum();
    let rest = |i: usize| {
        let length = origin[i] - along * axis[i];
        if length.abs() <= ROUNDING * origin[i].abs() { 0.0 } else { length }
    };
    let foot = [0, 1, 2].map(rest);
    let lengths = |of: &[f64]| of.iter().filter(|length| **length != 0.0).count();
    // For an axis skew to the frame before, the split would only add lengths.
    if lengths(&foot) + lengths(&[along]) > lengths(&origin) { (origin, 0.0) } else { (foot, along) }
}

pub(super) fn transpose<'g>(a: &Matrix<'g>) -> Matrix<'g> {
    [0, 1, 2].map(|j| [a[0][j], a[1][j], a[2][j]])
}

/// Sine and cosine of the sum of two angles: a fixed right angle only swaps them and changes signs.
fn turned_by<'g>(
    (s, c): (Expression<'g>, Expression<'g>),
    by: (Expression<'g>, Expression<'g>),
) -> (Expression<'g>, Expression<'g>) {
    (s * by.1 + c * by.0, c * by.1 - s * by.0)
}
