//! The joints' axes, propagated outwards to the links that they move.

use super::{
    expression::{Expression, Vector, add, cross},
    joints::{Chain, Joint},
    newton_euler::{Motion, Turn},
};
use thetahat_ground::vector::Mat3;

/// A coordinate's torque for a unit of each inertial parameter of a link, in the order of [`thetahat_model::robot::INERTIAL`].
pub(super) type Entries<'g> = [Expression<'g>; 10];

/// Angular and linear velocity at a point of a link for a unit velocity of a coordinate.
#[derive(Debug, Clone, Copy)]
pub(super) struct Twist<'g> {
    pub(super) z: Vector<'g>,
    pub(super) v: Vector<'g>,
}

/// The twist of a coordinate at a link: that of the origin in the link's frame, and its intermediate values.
#[derive(Debug, Clone, Copy)]
pub(super) struct Carried<'g> {
    pub(super) coordinate: usize,
    /// The coordinate to whose twist this one is relative.
    pub(super) relative_to: Option<usize>,
    pub(super) here: Twist<'g>,
    /// Velocity of the foot of the joint's axis, in the link's frame.
    pub(super) v_at_foot: Vector<'g>,
    /// The twist of the foot, in the joint's tilted frame.
    pub(super) tilted: Twist<'g>,
    /// `z` in the tilted frame of the first of the parallel joints of which the link's is the last.
    pub(super) level: Vector<'g>,
    /// Whether its axis is parallel to gravity, which then gives it no torque.
    pub(super) is_along_gravity: bool,
}

impl<'g> Twist<'g> {
    fn plus(&self, other: &Self) -> Self {
        Self { z: add(self.z, other.z), v: add(self.v, other.v) }
    }

    pub(super) fn in_axes(&self, axes: &Mat3) -> Self {
        Self { z: turned_back(axes, self.z), v: turned_back(axes, self.v) }
    }
}

impl<'g> Carried<'g> {
    /// The twist of a joint's own coordinate.
    fn of_joint(chain: &Chain<'g>, joint: &Joint<'g>) -> Self {
        let (axis, none) = (chain.builder.constants([0.0, 0.0, joint.ratio]), chain.none());
        let [z, v] = if joint.is_revolute { [axis, none] } else { [none, axis] };
        let here = Twist { z, v };
        let gravity = cross(joint.axis(chain.builder), chain.builder.constants(chain.gravity));
        let is_along_gravity = joint.parent.is_none() && gravity.iter().all(|entry| entry.is_zero());
        let coordinate = joint.coordinate;
        Self { coordinate, relative_to: None, here, v_at_foot: v, tilted: here, level: z, is_along_gravity }
    }

    /// The twist at the link of the next joint.
    fn at_next(&self, next: &Joint<'g>) -> Self {
        let Twist { z, v } = self.here;
        let tilted = Twist { z: next.tilted(z), v: next.tilted(add(v, cross(z, next.foot))) };
        let level = if next.is_parallel() { self.level } else { tilted.z };
        let z = next.turned(tilted.z);
        let v_at_foot = next.turned(tilted.v);
        let v = [v_at_foot[0] + z[1] * next.along, v_at_foot[1] - z[0] * next.along, v_at_foot[2]];
        Self { here: Twist { z, v }, v_at_foot, tilted, level, ..*self }
    }

    /// The entry of `zz`, `z (wy wz, -wx wz, dwz)`, which a turn about z does not change.
    pub(super) fn zz_before_turn(&self, motion: &Motion<'g>, turn: &Turn<'g>) -> Expression<'g> {
        let ([x, y, _], [wx, wy, _], wz) = (self.level, turn.level.w, motion.w[2]);
        x * (wy * wz) - y * (wx * wz) + self.here.z[2] * motion.dw[2]
    }

    fn plus(&self, other: &Self) -> Self {
        Self {
            here: self.here.plus(&other.here),
            v_at_foot: add(self.v_at_foot, other.v_at_foot),
            tilted: self.tilted.plus(&other.tilted),
            level: add(self.level, other.level),
            is_along_gravity: self.is_along_gravity && other.is_along_gravity,
            ..*self
        }
    }

    /// The twist relative to that of a joint that turns in the same way.
    fn relative_to(&self, joint: &Joint<'g>) -> Self {
        let none = self.here.z.map(|z| z.builder().zero());
        let still = |twist: Twist<'g>| Twist { z: none, ..twist };
        let relative_to = Some(joint.coordinate);
        Self { relative_to, here: still(self.here), tilted: still(self.tilted), level: none, ..*self }
    }
}

/// The twists of the coordinates that move each link.
pub(super) fn twists<'g>(chain: &Chain<'g>) -> Vec<Vec<Carried<'g>>> {
    let mut twists: Vec<Vec<Carried<'g>>> = Vec::with_capacity(chain.joints.len());
    for joint in &chain.joints {
        let before = joint.parent.map_or(&[][..], |parent| &twists[parent]);
        let here = at_link(chain, joint, before);
        twists.push(here);
    }
    twists
}

/// The twists at a joint's link, from those before it, with its own at the end.
///
/// For a coordinate that turns the link as the joint does, the joint provides the moments, and only velocities remain.
fn at_link<'g>(chain: &Chain<'g>, joint: &Joint<'g>, before: &[Carried<'g>]) -> Vec<Carried<'g>> {
    let own = Carried::of_joint(chain, joint);
    let mut here: Vec<_> = before.iter().map(|twist| twist.at_next(joint)).collect();
    if let Some(twist) = here.iter_mut().find(|twist| twist.coordinate == own.coordinate) {
        *twist = twist.plus(&own);
        return here;
    }
    for twist in &mut here {
        let alike =
            twist.here.z.iter().zip(own.here.z).all(|(z, own)| z.number().is_some() && z.number() == own.number());
        if joint.is_revolute && alike {
            *twist = twist.relative_to(joint);
        }
    }
    here.push(own);
    here
}

/// `axes^T x`.
pub(super) fn turned_back<'g>(axes: &Mat3, x: Vector<'g>) -> Vector<'g> {
    [0, 1, 2].map(|j| x[0] * axes[0][j] + x[1] * axes[1][j] + x[2] * axes[2][j])
}

/// Number of nonzero components.
pub(super) fn components(x: Vector<'_>) -> usize {
    x.iter().filter(|entry: &&Expression<'_>| !entry.is_zero()).count()
}
