//! The columns of a link that carries no other, before the turn of its revolute joint.
//!
//! Nothing after this link needs the joints' axes in its frame, so that its columns are turned back once instead of each axis
//! outwards. A column is the force and the moment for a unit of a parameter, about the foot of the joint's axis in the joint's
//! tilted frame.

use super::{
    expression::{Expression, Vector, add, dot},
    joints::{Joint, transpose},
    newton_euler::{Motion, Turn},
    twists::{Carried, Entries},
};

/// The columns of a tip.
#[derive(Debug)]
pub(super) struct TipColumns<'g> {
    /// Moments of `xx`, `xy`, `xz`, `yy` and `yz`, which need no force.
    inertia: [Vector<'g>; 5],
    /// Forces of the first moments about the foot.
    forces: [Vector<'g>; 3],
    /// Moments of the first moments about the foot.
    moments: [Vector<'g>; 3],
    /// Force of the mass at the foot.
    mass: Vector<'g>,
    /// From the foot to the link's origin.
    along: Expression<'g>,
}

impl<'g> TipColumns<'g> {
    pub(super) fn new(joint: &Joint<'g>, motion: &Motion<'g>, turn: &Turn<'g>) -> Self {
        let back = |column: Vector<'g>| joint.turned_back(column);
        let columns = transpose(&motion.a);
        let forces = [back(columns[0]), back(columns[1]), turn.tilted.column];
        let zero = joint.along.builder().zero();
        let [[x0, y0, _], [x, y, z]] = turn.dv_at_foot;
        let moments = [back([zero, -z, y]), back([z, zero, -x]), [-y0, x0, zero]];
        let inertia = inertia_moments(joint, motion, turn, &forces);
        Self { inertia, forces, moments, mass: turn.dv_at_foot[0], along: joint.along }
    }

    /// The entries of a twist.
    pub(super) fn entries(&self, twist: &Carried<'g>, motion: &Motion<'g>, turn: &Turn<'g>) -> Entries<'g> {
        let (z, v, along) = (twist.tilted.z, twist.tilted.v, self.along);
        let [xx, xy, xz, yy, yz] = self.inertia.map(|moment| dot(z, moment));
        let about_foot = |i: usize| dot(z, self.moments[i]) + dot(v, self.forces[i]);
        // A point of the axis has B_zz = xx + yy.
        let axial = (xx + yy) * along;
        let mass = dot(v, self.mass) + (about_foot(2) + axial) * along;
        let [mx, my, mz] = [about_foot(0) - along * xz, about_foot(1) - along * yz, about_foot(2) + axial * 2.0];
        [xx, xy, xz, yy, yz, twist.zz_before_turn(motion, turn), mx, my, mz, mass]
    }
}

/// The moments of `xx`, `xy`, `xz`, `yy` and `yz`, with the forces of the first moments.
///
/// The moments of `xx + yy` are the column on the axis, turned by a right angle; those of `xy` in the plane are those of `xx -
/// yy`, turned likewise; those of `xz` and `yz` are the forces of `mx` and `my`, turned likewise, less `zz` of `a` once.
fn inertia_moments<'g>(
    joint: &Joint<'g>,
    motion: &Motion<'g>,
    turn: &Turn<'g>,
    [[mx_x, mx_y, _], [my_x, my_y, _], _]: &[Vector<'g>; 3],
) -> [Vector<'g>; 5] {
    let ((s, c), a, products) = (joint.sine_and_cosine(), &motion.a, &motion.products);
    let [column_x, column_y, zz] = turn.tilted.column;
    let xx = joint.turned_back([motion.dw[0], products[1], -products[2]]);
    let yy = add([-column_y, column_x, zz.builder().zero()], xx.map(|entry| -entry));
    let (difference_x, difference_y) = (xx[0] - yy[0], xx[1] - yy[1]);
    // Here `zz - yy` is not needed.
    let yy_less_xx = a[1][1] - a[0][0];
    let (along_s, along_c) = (zz * s, zz * c);
    [
        xx,
        [-difference_y, difference_x, -yy_less_xx],
        [*mx_y - along_s, along_c - *mx_x, -a[1][2]],
        yy,
        [*my_y - along_c, -*my_x - along_s, a[0][2]],
    ]
}
