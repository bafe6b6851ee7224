//! Bases that float: six joints that nothing drives, between the world and the root body.

use super::body::RigidBody;
use super::{Doubt, INERTIAL, Joint, JointKind, Limits, Loop, LoopFrame, Mimic, Placement, Robot, Share, Transmission};
use thetahat_ground::{
    linear_algebra::Matrix,
    vector::{IDENTITY, Mat3, product, times, transpose, with_z},
};

/// Joints of a base that floats.
pub(super) const BASE_JOINTS: usize = 6;

/// Name, kind and axis of each: along the world's axes, then about yaw, pitch and roll.
const JOINTS: [(&str, JointKind, [f64; 3]); BASE_JOINTS] = [
    ("base x", JointKind::Prismatic, [1.0, 0.0, 0.0]),
    ("base y", JointKind::Prismatic, [0.0, 1.0, 0.0]),
    ("base z", JointKind::Prismatic, [0.0, 0.0, 1.0]),
    ("base yaw", JointKind::Revolute, [0.0, 0.0, 1.0]),
    ("base pitch", JointKind::Revolute, [0.0, 1.0, 0.0]),
    ("base roll", JointKind::Revolute, [1.0, 0.0, 0.0]),
];

/// Whether the root body of a description is fixed to the world.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Base {
    /// It does not move.
    Fixed,
    /// It moves freely.
    Floating,
}

impl Base {
    /// Of the key `floating_base`.
    pub(super) fn of(is_floating: bool) -> Self {
        if is_floating { Self::Floating } else { Self::Fixed }
    }
}

impl Robot {
    /// Number of coordinates of a base that floats, which come first: six, or none of a base that is fixed.
    #[doc(hidden)]
    #[must_use]
    pub fn base_coordinates(&self) -> usize {
        self.joints.iter().filter(|joint| joint.of_base).count()
    }

    /// The joint of the root body of a base that floats.
    #[doc(hidden)]
    #[must_use]
    pub fn root_joint(&self) -> Option<usize> {
        self.joints.iter().rposition(|joint| joint.of_base)
    }

    /// The robot with its base free to move, whose body is `root`. The joints of the base come first; what was on the base is on the
    /// root body.
    pub(super) fn on_floating_base(self, root: &RigidBody) -> Self {
        let shifted = |joint: usize| joint + BASE_JOINTS;
        let on_root = transpose(&with_z(JOINTS[BASE_JOINTS - 1].2));
        let own = self.joints.into_iter().map(|joint| shifted_joint(joint, &on_root));
        let joints: Vec<Joint> = base_joints().into_iter().chain(own).collect();
        let values = self.a_priori.into_iter().map(|(name, value)| (shifted_name(&name), value));
        let of_root = INERTIAL.iter().map(|quantity| quantity.name()).zip(root.parameters());
        let of_root = of_root.filter(|(_, value)| *value != 0.0).map(|(q, value)| (format!("{q}{BASE_JOINTS}"), value));
        let doubt = |doubt: Doubt| Doubt { carrier: doubt.carrier.map(shifted), ..doubt };
        Self {
            a_priori: values.chain(of_root).collect(),
            transmission: self.transmission.after_base(BASE_JOINTS),
            loops: self.loops.into_iter().map(shifted_loop).collect(),
            doubts: self.doubts.into_iter().map(doubt).collect(),
            joints,
            ..self
        }
    }
}

impl Transmission {
    /// The same after coordinates that nothing drives.
    pub(super) fn after_base(&self, base: usize) -> Self {
        let size = base + self.joints();
        let entry = |i: usize, j: usize| match (i.checked_sub(base), j.checked_sub(base)) {
            (Some(i), Some(j)) => self.matrix().at(i, j),
            (None, None) if i == j => 1.0,
            (None | Some(_), None | Some(_)) => 0.0,
        };
        let after = |first: f64, values: &[f64]| [vec![first; base], values.to_vec()].concat();
        let (offset, gain) = (after(0.0, self.offset()), after(1.0, self.drive_gain()));
        Self::new(Matrix::from_fn(size, size, entry), offset, gain).unwrap_or_else(|| Self::direct(size))
    }

    /// The same without the coordinates of a base.
    pub(super) fn without_base(&self, base: usize) -> Self {
        let own: Vec<usize> = (base..self.joints()).collect();
        self.part(&own, &own).unwrap_or_else(|| Self::direct(own.len()))
    }
}

/// The six joints, each frame turned so that z is its axis; the link's own axes of the last are those of the root body.
fn base_joints() -> Vec<Joint> {
    let mut before = IDENTITY;
    let mut joints = Vec::new();
    for (j, (name, kind, axis)) in JOINTS.into_iter().enumerate() {
        let axes = with_z(axis);
        let placement = Placement::new(&product(&transpose(&before), &axes), [0.0; 3]);
        joints.push(Joint {
            name: name.to_owned(),
            kind,
            parent: j.checked_sub(1),
            placement,
            link_axes: Some(transpose(&axes)),
            mimic: None,
            also_follows: Vec::new(),
            passive: false,
            of_base: true,
            limits: Limits::default(),
        });
        before = axes;
    }
    joints
}

/// A joint by its new number, whose carrier is the root body if it was on the base.
fn shifted_joint(joint: Joint, on_root: &Mat3) -> Joint {
    let Placement { origin, .. } = joint.placement;
    let placement = match joint.parent {
        Some(_) => joint.placement,
        None => Placement::new(&product(on_root, &joint.placement.rotation()), times(on_root, origin)),
    };
    let share = |share: Share| Share { of: share.of + BASE_JOINTS, ..share };
    Joint {
        parent: Some(joint.parent.map_or(BASE_JOINTS - 1, |parent| parent + BASE_JOINTS)),
        placement,
        mimic: joint.mimic.map(|mimic| Mimic { of: mimic.of + BASE_JOINTS, ..mimic }),
        also_follows: joint.also_follows.into_iter().map(share).collect(),
        ..joint
    }
}

/// A loop by the new numbers of its joints; a frame on the base is one of the root body.
fn shifted_loop(of_loop: Loop) -> Loop {
    let frame = |frame: LoopFrame| {
        let joint = frame.joint.map_or(BASE_JOINTS - 1, |joint| joint + BASE_JOINTS);
        LoopFrame { joint: Some(joint), ..frame }
    };
    let near = of_loop.near.into_iter().map(|(joint, position)| (joint + BASE_JOINTS, position)).collect();
    Loop { from: frame(of_loop.from), to: frame(of_loop.to), near, ..of_loop }
}

/// The name of a parameter by the new number of its joint, such as `zz7` of `zz1`.
fn shifted_name(name: &str) -> String {
    let quantity = name.trim_end_matches(|c: char| c.is_ascii_digit());
    match name[quantity.len()..].parse::<usize>() {
        Ok(number) => format!("{quantity}{}", number + BASE_JOINTS),
        Err(_) => name.to_owned(),
    }
}
