//! Links as pseudo-inertias, with as few nonzero parameters as possible.
//!
//! The pseudo-inertia of a link about its frame's origin is `L = int r r^T dm`, `l = int r dm` and `m`; its inertia is
//! `tr(L) 1 - L`. Mass on a revolute joint's axis can equally be assigned to the link before: `Lzz`, `lz` and `m` are moved
//! there, from the tips to the base, and a link keeps seven parameters. The link of a prismatic joint does not turn relative to
//! the link before, which receives its whole `L`.

use super::{
    expression::{Expression, Matrix, Vector, add},
    joints::{Chain, Joint, transpose},
};
use thetahat_ground::vector::Mat3;
use thetahat_model::robot::{INERTIAL, ParameterTable, Quantity, Robot};

/// A pseudo-inertia.
#[derive(Debug, Clone, Copy)]
pub(super) struct PseudoInertia<'g> {
    /// Second moments.
    pub(super) second: Matrix<'g>,
    /// First moments.
    pub(super) first: Vector<'g>,
    pub(super) mass: Expression<'g>,
}

impl<'g> PseudoInertia<'g> {
    pub(super) fn none(chain: &Chain<'g>) -> Self {
        Self { second: [chain.none(); 3], first: chain.none(), mass: chain.builder.zero() }
    }

    /// From the parameters in the order of [`INERTIAL`], about the same origin.
    fn from_parameters([xx, xy, xz, yy, yz, zz, mx, my, mz, m]: [Expression<'g>; 10]) -> Self {
        let half = |a: Expression<'g>, b: Expression<'g>, c: Expression<'g>| (a + b - c) * 0.5;
        let second = [[half(yy, zz, xx), -xy, -xz], [-xy, half(xx, zz, yy), -yz], [-xz, -yz, half(xx, yy, zz)]];
        Self { second, first: [mx, my, mz], mass: m }
    }

    pub(super) fn plus(&self, other: &Self) -> Self {
        let second = [0, 1, 2].map(|i| add(self.second[i], other.second[i]));
        Self { second, first: add(self.first, other.first), mass: self.mass + other.mass }
    }

    /// Converts to units of length; torques keep their values.
    fn in_units(&self, unit: f64) -> Self {
        Self { second: self.second, first: self.first.map(|l| l * unit), mass: self.mass * (unit * unit) }
    }

    /// Transforms from the link's own axes to its joint's frame, if they differ.
    fn in_joint_axes(&self, axes: Option<&Mat3>) -> Self {
        let Some(axes) = axes else { return *self };
        let turned = |x: Vector<'g>| axes.map(|row| x[0] * row[0] + x[1] * row[1] + x[2] * row[2]);
        let half = transpose(&self.second.map(turned));
        Self { second: half.map(turned), first: turned(self.first), mass: self.mass }
    }

    /// Transforms from the tilted frame of a joint to the frame before, about its origin.
    fn out_of_tilted(&self, joint: &Joint<'g>) -> Self {
        let half = transpose(&self.second.map(|row| joint.tilted_back(row)));
        let second = half.map(|column| joint.tilted_back(column));
        Self { second, first: joint.tilted_back(self.first), mass: self.mass }.shifted(joint.foot)
    }

    /// The pseudo-inertia about a point of the z axis, from which its origin is at `length` along it.
    fn shifted_along(&self, length: Expression<'g>) -> Self {
        let mut moved = *self;
        let [x, y, z] = self.first;
        moved.first[2] = z + self.mass * length;
        for (i, first) in [(0, x), (1, y)] {
            moved.second[i][2] = self.second[i][2] + first * length;
            moved.second[2][i] = moved.second[i][2];
        }
        moved.second[2][2] = self.second[2][2] + (z + moved.first[2]) * length;
        moved
    }

    /// The pseudo-inertia about a point from which its origin is at `p`.
    fn shifted(&self, p: Vector<'g>) -> Self {
        let (l, m) = (self.first, self.mass);
        // p l^T + l p^T + m p p^T with l + m p computed once.
        let moved = add(l, p.map(|entry| m * entry));
        let entry = |i: usize, j: usize| self.second[i][j] + p[i] * l[j] + moved[i] * p[j];
        let second = [0, 1, 2].map(|i| [0, 1, 2].map(|j| if j < i { entry(j, i) } else { entry(i, j) }));
        Self { second, first: moved, mass: m }
    }

    /// Transforms from a joint's frame to the frame before.
    pub(super) fn moved_to_parent(&self, joint: &Joint<'g>) -> Self {
        let here = self.shifted_along(joint.along);
        let [xx, yy, xy] = turned_in_plane(joint, here.second);
        let z = joint.turned_back(transpose(&here.second)[2]);
        let second = [[xx, xy, z[0]], [xy, yy, z[1]], z];
        Self { second, first: joint.turned_back(here.first), mass: self.mass }.out_of_tilted(joint)
    }

    /// Splits a link's pseudo-inertia into the part that it keeps and the part that moves to the link before, in the joint's
    /// tilted frame.
    fn split(&self, joint: &Joint<'g>, chain: &Chain<'g>) -> (Self, Self) {
        let none = Self::none(chain);
        let (mut own, mut given) = (*self, none);
        if joint.is_revolute {
            own.second[2][2] = none.mass;
            given.second[2][2] = self.second[2][2];
            own.first[2] = none.mass;
            given.first[2] = self.first[2];
            (own.mass, given.mass) = (none.mass, self.mass);
            return (own, given);
        }
        own.second = none.second;
        given.second = transpose(&self.second.map(|row| joint.turned_back(row))).map(|c| joint.turned_back(c));
        (own, given)
    }
}

/// `xx`, `yy` and `xy` of second moments, rotated back about z.
fn turned_in_plane<'g>(joint: &Joint<'g>, [[xx, xy, _], [_, yy, _], _]: Matrix<'g>) -> [Expression<'g>; 3] {
    let (s, c) = joint.sine_and_cosine();
    let difference = xx - yy;
    let (along, across) = (c * xy, s * xy);
    let mixed = s * difference + along;
    // With s (s d + 2 c xy) = s^2 d + 2 c s xy, and the trace in the plane unchanged.
    let shift = s * (mixed + along);
    [xx - shift, yy + shift, c * mixed - s * across]
}

/// The links of a robot with transferred parameters, in the frames of their joints, from its standard parameters `theta`.
pub(super) fn links<'g>(chain: &Chain<'g>, robot: &Robot, theta: &[Expression<'g>]) -> Vec<PseudoInertia<'g>> {
    let table = robot.parameter_table();
    let link = |k: usize| {
        let standard = PseudoInertia::from_parameters(inertial(&table, theta, k));
        standard.in_joint_axes(robot.joints[k].link_axes.as_ref()).in_units(chain.unit)
    };
    let mut links: Vec<PseudoInertia<'g>> = (0..chain.joints.len()).map(link).collect();
    for (j, joint) in chain.inwards() {
        let (own, given) = links[j].split(joint, chain);
        links[j] = own;
        if let Some(parent) = joint.parent {
            let moved = if joint.is_revolute {
                given.shifted_along(joint.along).out_of_tilted(joint)
            } else {
                turned_only(&given, joint)
            };
            links[parent] = links[parent].plus(&moved);
        }
    }
    links
}

/// Only second moments, which no displacement of the joint changes.
fn turned_only<'g>(given: &PseudoInertia<'g>, joint: &Joint<'g>) -> PseudoInertia<'g> {
    let half = transpose(&given.second.map(|row| joint.tilted_back(row)));
    PseudoInertia { second: half.map(|column| joint.tilted_back(column)), ..*given }
}

fn inertial<'g>(table: &ParameterTable, theta: &[Expression<'g>], link: usize) -> [Expression<'g>; 10] {
    let zero = theta[0].builder().zero();
    INERTIAL.map(|quantity| table.index(Quantity::Link(quantity), link).map_or(zero, |index| theta[index]))
}
