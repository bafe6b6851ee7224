//! The columns of inertial parameters, with the axes of the joints carried outwards.
//!
//! With a joint's unit velocity a point `r` of a link moves by `v + z x r`. The joint gives the power of the link's forces:
//! the sum of `B_ij L_ij` with `B = [z]x^T A` for the second moments, `[z]x^T dv + A^T v` for the first.

use super::{
    expression::{Expression, Vector, add, cross, dot},
    joints::{Chain, Joint, transpose},
    newton_euler::Motion,
};
use crate::vector::Mat3;

/// Angular and linear velocity at the origin of a link's frame, in that frame, for a unit velocity of a coordinate.
#[derive(Debug, Clone, Copy)]
struct Twist<'g> {
    z: Vector<'g>,
    v: Vector<'g>,
}

impl<'g> Twist<'g> {
    fn of_joint(chain: &Chain<'g>, joint: &Joint<'g>) -> Self {
        let (axis, none) = (chain.builder.constants([0.0, 0.0, joint.ratio]), chain.none());
        if joint.is_revolute { Self { z: axis, v: none } } else { Self { z: none, v: axis } }
    }

    fn seen_from(&self, next: &Joint<'g>) -> Self {
        let z = next.seen(self.z);
        let at_foot = next.seen(add(self.v, cross(self.z, next.foot)));
        Self { z, v: [at_foot[0] + z[1] * next.along, at_foot[1] - z[0] * next.along, at_foot[2]] }
    }

    fn plus(&self, other: &Self) -> Self {
        Self { z: add(self.z, other.z), v: add(self.v, other.v) }
    }

    fn in_axes(&self, axes: &Mat3) -> Self {
        Self { z: turned_back(axes, self.z), v: turned_back(axes, self.v) }
    }
}

/// What a coordinate's torque is for a unit of each inertial parameter of a link, in the order of
/// [`crate::robot::INERTIAL`].
#[derive(Debug, Clone)]
pub(super) struct LinkColumns<'g> {
    pub(super) link: usize,
    pub(super) coordinate: usize,
    pub(super) entries: [Expression<'g>; 10],
}

/// The columns of all links, for each coordinate that moves them.
pub(super) fn link_columns<'g>(
    chain: &Chain<'g>,
    motions: &[Motion<'g>],
    link_axes: &[Option<Mat3>],
) -> Vec<LinkColumns<'g>> {
    let mut twists: Vec<Vec<(usize, Twist<'g>)>> = Vec::with_capacity(chain.joints.len());
    let mut columns = Vec::new();
    for (link, joint) in chain.joints.iter().enumerate() {
        let before = joint.parent.map_or(&[][..], |parent| &twists[parent]);
        let here = twists_behind(chain, joint, before);
        let motion = link_axes[link].map_or(motions[link], |axes| in_axes(&motions[link], &axes));
        for (coordinate, twist) in &here {
            let twist = link_axes[link].map_or(*twist, |axes| twist.in_axes(&axes));
            columns.push(LinkColumns { link, coordinate: *coordinate, entries: entries(&twist, &motion, chain.unit) });
        }
        twists.push(here);
    }
    columns
}

/// The twists of the coordinates that move a link, with those of the link before.
fn twists_behind<'g>(chain: &Chain<'g>, joint: &Joint<'g>, before: &[(usize, Twist<'g>)]) -> Vec<(usize, Twist<'g>)> {
    let mut here: Vec<_> = before.iter().map(|(c, twist)| (*c, twist.seen_from(joint))).collect();
    let own = Twist::of_joint(chain, joint);
    match here.iter_mut().find(|(c, _)| *c == joint.coordinate) {
        Some((_, twist)) => *twist = twist.plus(&own),
        None => here.push((joint.coordinate, own)),
    }
    here
}

/// With `xx + zz = B_yy` and `xx + yy = B_zz`, in terms of the inertia.
fn entries<'g>(twist: &Twist<'g>, motion: &Motion<'g>, unit: f64) -> [Expression<'g>; 10] {
    let Twist { z, v } = *twist;
    let Motion { dw, a, differences, products, dv, .. } = motion;
    let xx = z[0] * dw[0] + (z[1] * products[1] - z[2] * products[2]);
    let diagonal = |i: usize, j: usize, k: usize| z[k] * a[j][i] - z[j] * a[k][i];
    // -(B_jk + B_kj), of the two axes behind axis i.
    let off_diagonal = |i: usize| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        z[k] * a[i][k] - z[j] * a[i][j] - z[i] * differences[i]
    };
    let columns = transpose(a);
    let first = add(cross(*dv, z), [0, 1, 2].map(|i| dot(columns[i], v)));
    let [mx, my, mz] = first.map(|entry| entry * unit);
    let (yy, zz) = (diagonal(2, 0, 1) - xx, diagonal(1, 2, 0) - xx);
    let mass = dot(v, *dv) * (unit * unit);
    [xx, off_diagonal(2), off_diagonal(1), yy, off_diagonal(0), zz, mx, my, mz, mass]
}

/// `axes^T x`.
fn turned_back<'g>(axes: &Mat3, x: Vector<'g>) -> Vector<'g> {
    [0, 1, 2].map(|j| x[0] * axes[0][j] + x[1] * axes[1][j] + x[2] * axes[2][j])
}

/// The motion in a link's own axes, `x_joint = axes x_link`.
fn in_axes<'g>(motion: &Motion<'g>, axes: &Mat3) -> Motion<'g> {
    let back = |x: Vector<'g>| turned_back(axes, x);
    let a = transpose(&transpose(&motion.a.map(back)).map(back));
    Motion::new([back(motion.w), back(motion.dw)], a, back(motion.dv))
}
