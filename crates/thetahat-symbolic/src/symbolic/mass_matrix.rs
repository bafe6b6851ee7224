//! The mass matrix by composite bodies.
//!
//! A composite body is carried like its links: mass on a joint's axis is not turned with the joint. The wrench of a joint's
//! unit acceleration is a part of the composite body, so that its first step inwards costs nothing.

use super::{
    drives::Drives,
    expression::Expression,
    inertia::PseudoInertia,
    joints::{Chain, Joint},
    newton_euler::Wrench,
};

/// The lower triangle of the mass matrix of the coordinates, row by row.
pub(super) fn mass_matrix<'g>(drives: &Drives<'_, 'g>, links: &[PseudoInertia<'g>]) -> Vec<Expression<'g>> {
    let chain = drives.chain;
    let mut m = vec![chain.builder.zero(); chain.coordinates * (chain.coordinates + 1) / 2];
    for (j, k, entry) in joint_entries(chain, links, drives) {
        let (first, second) = (&chain.joints[j], &chain.joints[k]);
        let both = if j != k && first.coordinate == second.coordinate { 2.0 } else { 1.0 };
        let place = place(first.coordinate, second.coordinate);
        m[place] = m[place] + entry * (first.ratio * second.ratio * both);
    }
    for (i, j, inertia) in drives.coupled_inertias().filter(|(i, j, _)| i > j) {
        m[place(i, j)] = m[place(i, j)] + inertia;
    }
    m
}

/// Index in a lower triangle, row by row.
pub(super) fn place(i: usize, j: usize) -> usize {
    let (row, column) = (i.max(j), i.min(j));
    row * (row + 1) / 2 + column
}

/// Inertia between each joint and itself and the previous joints.
fn joint_entries<'g>(
    chain: &Chain<'g>,
    links: &[PseudoInertia<'g>],
    drives: &Drives<'_, 'g>,
) -> Vec<(usize, usize, Expression<'g>)> {
    let mut composite = links.to_vec();
    let mut entries = Vec::new();
    for (j, joint) in chain.inwards() {
        let mut wrench = unit_wrench(chain, joint, &composite[j]);
        entries.push((j, j, wrench.along(joint) + drives.motor_inertia(j)));
        let mut outer = joint;
        for i in chain.way_to_base(j).skip(1) {
            wrench = wrench.moved_to_parent(outer);
            outer = &chain.joints[i];
            entries.push((j, i, wrench.along(outer)));
        }
        if let Some(parent) = joint.parent {
            composite[parent] = composite[parent].plus(&composite[j].moved_to_parent(joint));
        }
    }
    entries
}

/// The wrench of a unit acceleration of a joint.
fn unit_wrench<'g>(chain: &Chain<'g>, joint: &Joint<'g>, body: &PseudoInertia<'g>) -> Wrench<'g> {
    let ([x, y, _], second, zero) = (body.first, &body.second, chain.builder.zero());
    if joint.is_revolute {
        let moment = [-second[0][2], -second[1][2], second[0][0] + second[1][1]];
        return Wrench { force: [-y, x, zero], moment };
    }
    Wrench { force: [zero, zero, body.mass], moment: [y, -x, zero] }
}
