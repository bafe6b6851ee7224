//! Transforms standard parameters to others with the same torques.

use std::collections::BTreeMap;

use super::{
    geometry::{Joint, Matrix, Vector},
    polynomial::Polynomial,
};
use thetahat_ground::vector::Mat3;
use thetahat_model::robot::{INERTIAL, JointKind, ParameterTable, Quantity, Robot};

/// Rows and columns of the inertia in the order of [`INERTIAL`].
const INERTIA: [(usize, usize); 6] = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];
/// Fraction of a direction below which it is rounding.
const ROUNDING: f64 = 1e-9;

/// A sum of standard parameters, by their index in the table.
pub(super) type Form = BTreeMap<usize, Polynomial>;
/// The inertial parameters of a link as sums of standard ones, in the link's own axes.
pub(super) type LinkForms = [Form; 10];

/// The inertial parameters of each link after the rules.
pub(super) fn regrouped(robot: &Robot, table: &ParameterTable, joints: &[Joint]) -> Vec<LinkForms> {
    let own = |link: usize| {
        INERTIAL.map(|quantity| {
            let index = table.index(Quantity::Link(quantity), link);
            index.map(|index| (index, Polynomial::number(1.0))).into_iter().collect()
        })
    };
    let mut links: Vec<LinkForms> = (0..joints.len()).map(own).collect();
    let axes = |link: usize| robot.joints[link].link_axes.unwrap_or(thetahat_ground::vector::IDENTITY);
    for (j, joint) in joints.iter().enumerate().rev() {
        let moved = match joint.kind {
            JointKind::Revolute => transfer_axis(&mut links[j], &axes(j), joint),
            JointKind::Prismatic => transfer_inertia(&mut links[j], &axes(j), joint),
        };
        if let Some(parent) = joint.parent {
            add_in_axes(&mut links[parent], &axes(parent), &moved);
        }
    }
    links
}

/// The inertial parameters that a link transfers to the link before, each a sum of standard parameters, in the frame before a
/// joint.
#[derive(Default)]
struct TransferredInertia {
    inertia: [[Form; 3]; 3],
    first: [Form; 3],
    mass: Form,
}

/// Removes the mass on the axis of a link's revolute joint: of the parameters that it changes, the last one becomes zero.
fn transfer_axis(link: &mut LinkForms, axes: &Mat3, joint: &Joint) -> TransferredInertia {
    // The joint's z axis in the axes of the link.
    let u = axes[2];
    let turning = INERTIA.map(|(i, j)| if i == j { 1.0 - u[i] * u[j] } else { -u[i] * u[j] });
    let (second, rest) = link.split_at_mut(6);
    let (first, mass) = rest.split_at_mut(3);
    let second = eliminate_last(second, &turning);
    let first = eliminate_last(first, &u);
    let mass = std::mem::take(&mut mass[0]);
    let axis = [0, 1, 2].map(|i| joint.rotation[i][2].clone());
    on_axis(&second, &first, &mass, &axis, &joint.origin)
}

/// Subtracts the multiple of a direction that makes the last parameter zero, and returns the factor.
fn eliminate_last(parameters: &mut [Form], direction: &[f64]) -> Form {
    let last = direction.iter().rposition(|part| part.abs() > ROUNDING).unwrap_or(0);
    let amount = scaled(&parameters[last], &Polynomial::number(1.0 / direction[last]));
    for (parameter, part) in parameters.iter_mut().zip(direction).filter(|(_, part)| part.abs() > ROUNDING) {
        add(parameter, &amount, &Polynomial::number(-part));
    }
    parameters[last].clear();
    amount
}

/// Second moment, first moment and mass on an axis through `p`, about the origin: `L = s a a^T + f (p a^T + a p^T) + m p p^T`,
/// whose inertia is `tr(L) 1 - L`.
fn on_axis(second: &Form, first: &Form, mass: &Form, axis: &Vector, p: &Vector) -> TransferredInertia {
    let mut moved = TransferredInertia { mass: mass.clone(), ..TransferredInertia::default() };
    add_product(&mut moved.inertia, second, axis, axis);
    add_product(&mut moved.inertia, first, p, axis);
    add_product(&mut moved.inertia, first, axis, p);
    add_product(&mut moved.inertia, mass, p, p);
    for i in 0..3 {
        add(&mut moved.first[i], first, &axis[i]);
        add(&mut moved.first[i], mass, &p[i]);
    }
    moved
}

/// Adds the inertia of second moments `a b^T`.
fn add_product(inertia: &mut [[Form; 3]; 3], form: &Form, a: &Vector, b: &Vector) {
    let mut trace = Polynomial::default();
    a.iter().zip(b).for_each(|(a, b)| trace += &(a * b));
    for (i, row) in inertia.iter_mut().enumerate() {
        add(&mut row[i], form, &trace);
        for (entry, b) in row.iter_mut().zip(b) {
            add(entry, form, &(&a[i] * b).scaled(-1.0));
        }
    }
}

/// Removes the whole inertia of a link on a prismatic joint.
fn transfer_inertia(link: &mut LinkForms, axes: &Mat3, joint: &Joint) -> TransferredInertia {
    let mut inertia: [[Form; 3]; 3] = Default::default();
    for ((i, j), form) in INERTIA.into_iter().zip(&mut link[..6]) {
        inertia[i][j] = std::mem::take(form);
        inertia[j][i] = inertia[i][j].clone();
    }
    let axes = axes.map(|row| row.map(Polynomial::number));
    let rotation = super::geometry::product(&joint.rotation, &axes);
    TransferredInertia { inertia: turned(&rotation, &inertia), ..TransferredInertia::default() }
}

/// `R J R^T`.
fn turned(r: &Matrix, inertia: &[[Form; 3]; 3]) -> [[Form; 3]; 3] {
    let mut turned: [[Form; 3]; 3] = Default::default();
    for (i, row) in turned.iter_mut().enumerate() {
        for (j, entry) in row.iter_mut().enumerate() {
            for k in 0..3 {
                (0..3).for_each(|l| add(entry, &inertia[k][l], &(&r[i][k] * &r[j][l])));
            }
        }
    }
    turned
}

/// Adds inertial parameters given in the frame of a link's joint to the link.
fn add_in_axes(link: &mut LinkForms, axes: &Mat3, moved: &TransferredInertia) {
    let back = thetahat_ground::vector::transpose(axes).map(|row| row.map(Polynomial::number));
    let inertia = turned(&back, &moved.inertia);
    let one = Polynomial::number(1.0);
    for ((i, j), form) in INERTIA.into_iter().zip(link.iter_mut()) {
        add(form, &inertia[i][j], &one);
    }
    for i in 0..3 {
        (0..3).for_each(|k| add(&mut link[6 + i], &moved.first[k], &back[i][k]));
    }
    add(&mut link[9], &moved.mass, &one);
}

fn scaled(form: &Form, factor: &Polynomial) -> Form {
    let mut result = Form::new();
    add(&mut result, form, factor);
    result
}

/// Adds a multiple of a form.
pub(super) fn add(to: &mut Form, form: &Form, factor: &Polynomial) {
    if factor.is_zero() {
        return;
    }
    for (index, coefficient) in form {
        let sum = to.entry(*index).or_default();
        *sum += &(coefficient * factor);
        if sum.is_zero() {
            to.remove(index);
        }
    }
}
