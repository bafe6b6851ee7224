//! The columns of inertial parameters, with the joints' axes propagated outwards.
//!
//! With a joint's unit velocity a point `r` of a link moves by `v + z x r`. The joint gives the power of the link's forces:
//! the sum of `B_ij L_ij` with `B = [z]x^T A` for the second moments, `[z]x^T dv + A^T v` for the first.

use super::{
    expression::{Vector, add, cross, dot},
    joints::{Chain, Joint, transpose},
    newton_euler::{Motion, Turn},
    tip_columns::TipColumns,
    twists::{Carried, Entries, Twist, components, turned_back, twists},
};
use thetahat_ground::vector::Mat3;

/// The entries of a coordinate and a link.
#[derive(Debug, Clone)]
pub(super) struct LinkColumns<'g> {
    pub(super) link: usize,
    pub(super) coordinate: usize,
    pub(super) entries: Entries<'g>,
}

/// The columns of all links, for each coordinate that moves them.
pub(super) fn link_columns<'g>(
    chain: &Chain<'g>,
    motions: &[Motion<'g>],
    link_axes: &[Option<Mat3>],
) -> Vec<LinkColumns<'g>> {
    let mut columns = Vec::new();
    for (link, twists) in twists(chain).iter().enumerate() {
        let is_tip = chain.joints.iter().all(|joint| joint.parent != Some(link));
        let of = Link { joint: &chain.joints[link], motion: &motions[link], is_tip };
        let rows = with_relative_rows(twists, of.rows(twists, link_axes[link].as_ref()));
        for (twist, entries) in twists.iter().zip(rows) {
            columns.push(LinkColumns { link, coordinate: twist.coordinate, entries: in_metres(entries, chain.unit) });
        }
    }
    columns
}

/// A link with its joint.
struct Link<'a, 'g> {
    joint: &'a Joint<'g>,
    motion: &'a Motion<'g>,
    is_tip: bool,
}

impl<'g> Link<'_, 'g> {
    /// The entries of each twist.
    fn rows(&self, twists: &[Carried<'g>], axes: Option<&Mat3>) -> Vec<Entries<'g>> {
        match (axes, self.motion.turn) {
            (Some(axes), _) => {
                let motion = in_axes(self.motion, axes);
                twists.iter().map(|twist| entries(&twist.here.in_axes(axes), &motion)).collect()
            }
            (None, Some(turn)) if self.is_tip => {
                let columns = TipColumns::new(self.joint, self.motion, &turn);
                twists.iter().map(|twist| columns.entries(twist, self.motion, &turn)).collect()
            }
            (None, Some(turn)) => twists.iter().map(|twist| self.turned_entries(twist, &turn)).collect(),
            (None, None) => twists.iter().map(|twist| entries(&twist.here, self.motion)).collect(),
        }
    }

    /// After a revolute joint: `zz` before the turn if the axis is known there, the first moments about the foot of the joint's
    /// axis if the velocity there has fewer components.
    fn turned_entries(&self, twist: &Carried<'g>, turn: &Turn<'g>) -> Entries<'g> {
        let mut entries = entries(&twist.here, self.motion);
        if twist.level[..2].iter().all(|entry| entry.number().is_some()) {
            entries[5] = twist.zz_before_turn(self.motion, turn);
        }
        if components(twist.v_at_foot) < components(twist.here.v) {
            let about_foot = Twist { v: twist.v_at_foot, ..twist.here };
            let has_no_moment = twist.is_along_gravity && turn.foot_rests;
            let dv = if has_no_moment { turn.dv_at_foot[1].map(|dv| dv * 0.0) } else { turn.dv_at_foot[1] };
            let [mx, my, _] = first_moments(&about_foot, self.motion, dv);
            entries[6] = mx - self.joint.along * entries[2];
            entries[7] = my - self.joint.along * entries[4];
        }
        entries
    }
}

/// Adds to each relative row the row of the coordinate that its twist is relative to, which comes later.
fn with_relative_rows<'g>(twists: &[Carried<'g>], mut rows: Vec<Entries<'g>>) -> Vec<Entries<'g>> {
    for row in (0..rows.len()).rev() {
        let is_reference = |other: &Carried<'g>| twists[row].relative_to == Some(other.coordinate);
        if let Some(other) = twists.iter().position(is_reference) {
            rows[row] = std::array::from_fn(|i| rows[row][i] + rows[other][i]);
        }
    }
    rows
}

fn in_metres<'g>(mut entries: Entries<'g>, unit: f64) -> Entries<'g> {
    for (entry, scale) in entries[6..].iter_mut().zip([unit, unit, unit, unit * unit]) {
        *entry = *entry * scale;
    }
    entries
}

/// `xx + zz = B_yy` and `xx + yy = B_zz`, solved for the inertia.
fn entries<'g>(twist: &Twist<'g>, motion: &Motion<'g>) -> Entries<'g> {
    let Twist { z, v } = *twist;
    let Motion { dw, a, differences, products, dv, .. } = motion;
    let xx = z[0] * dw[0] + (z[1] * products[1] - z[2] * products[2]);
    let diagonal = |i: usize, j: usize, k: usize| z[k] * a[j][i] - z[j] * a[k][i];
    // -(B_jk + B_kj), of the two axes that follow axis i cyclically.
    let off_diagonal = |i: usize| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        z[k] * a[i][k] - z[j] * a[i][j] - z[i] * differences[i]
    };
    let (yy, zz) = (diagonal(2, 0, 1) - xx, diagonal(1, 2, 0) - xx);
    let [mx, my, mz] = first_moments(twist, motion, *dv);
    [xx, off_diagonal(2), off_diagonal(1), yy, off_diagonal(0), zz, mx, my, mz, dot(v, *dv)]
}

/// The first moments about a point that moves by the twist and accelerates by `dv`.
fn first_moments<'g>(twist: &Twist<'g>, motion: &Motion<'g>, dv: Vector<'g>) -> Vector<'g> {
    let columns = transpose(&motion.a);
    add(cross(dv, twist.z), [0, 1, 2].map(|i| dot(columns[i], twist.v)))
}

/// The motion in a link's own axes, `x_joint = axes x_link`.
fn in_axes<'g>(motion: &Motion<'g>, axes: &Mat3) -> Motion<'g> {
    let back = |x: Vector<'g>| turned_back(axes, x);
    let a = transpose(&transpose(&motion.a.map(back)).map(back));
    Motion::new([back(motion.w), back(motion.dw)], a, back(motion.dv))
}
