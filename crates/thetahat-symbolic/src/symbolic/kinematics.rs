//! The poses of a robot's tips, and their derivatives with respect to the coordinates.

use super::{
    expression::{Expression, Matrix, Vector, add, cross, times},
    joints::{Chain, transpose},
};

/// A frame relative to the base, lengths in the unit of the [`Chain`].
#[derive(Debug, Clone, Copy)]
pub(super) struct Pose<'g> {
    pub(super) rotation: Matrix<'g>,
    pub(super) origin: Vector<'g>,
}

/// The frames of all joints.
pub(super) fn poses<'g>(chain: &Chain<'g>) -> Vec<Pose<'g>> {
    let unit = |i: usize| [0, 1, 2].map(|j| if i == j { 1.0 } else { 0.0 });
    let base = Pose { rotation: [0, 1, 2].map(|i| chain.builder.constants(unit(i))), origin: chain.none() };
    let mut poses: Vec<Pose<'g>> = Vec::with_capacity(chain.joints.len());
    for joint in &chain.joints {
        let before = joint.parent.map_or(base, |parent| poses[parent]);
        let foot = times(&before.rotation, joint.foot);
        // Each row of the rotation is an axis of the base, seen in the frame.
        let rotation = before.rotation.map(|row| joint.seen(row));
        let along = rotation.map(|row| row[2] * joint.along);
        poses.push(Pose { rotation, origin: add(before.origin, add(foot, along)) });
    }
    poses
}

/// The geometric Jacobian of a link's frame in the frame of the base: for each coordinate the angular velocity, then that of
/// the origin, for a unit of the coordinate's velocity, rad and m.
pub(super) fn jacobian<'g>(chain: &Chain<'g>, poses: &[Pose<'g>], link: usize) -> Vec<[Vector<'g>; 2]> {
    let mut columns = vec![[chain.none(); 2]; chain.coordinates];
    for j in chain.way_to_base(link) {
        let joint = &chain.joints[j];
        let axis = transpose(&poses[j].rotation)[2].map(|entry| entry * joint.ratio);
        let arm = [0, 1, 2].map(|i| (poses[link].origin[i] - poses[j].origin[i]) * chain.unit);
        let own = if joint.is_revolute { [axis, cross(axis, arm)] } else { [chain.none(), axis] };
        let column = &mut columns[joint.coordinate];
        *column = [add(column[0], own[0]), add(column[1], own[1])];
    }
    columns
}

/// The entries of a pose: three rows of rotation and origin, m.
pub(super) fn entries<'g>(chain: &Chain<'g>, pose: &Pose<'g>) -> Vec<Expression<'g>> {
    let row = |i: usize| [pose.rotation[i][0], pose.rotation[i][1], pose.rotation[i][2], pose.origin[i] * chain.unit];
    [0, 1, 2].into_iter().flat_map(row).collect()
}
