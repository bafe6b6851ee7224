//! A-priori inertial parameters from the geometry, for a robot without complete ones.

use super::{
    fit::LeastSquares,
    pseudo_inertia::{inertial_parameters, pseudo_inertia},
    symmetric::Symmetric,
};
use crate::robot::{INERTIAL, Joint, LinkQuantity, ParameterTable, Quantity, Robot};
use thetahat_ground::{
    linear_algebra::dot,
    vector::{Vec3, norm, transpose_times},
};

/// Mass of a robot per length of its links, kg/m: 14 kg/m for a KUKA LWR4+, 20 to 40 for industrial arms.
const MASS_PER_LENGTH: f64 = 20.0;
/// Length of a robot's links if all joints are at one point, m.
const USUAL_LENGTH: f64 = 0.3;
/// Radius of a link relative to its length or, if that is larger, to the mean length.
const SLENDERNESS: f64 = 0.25;
/// Smallest eigenvalue of a pseudo-inertia matrix, relative to the largest, with which a body is left unchanged.
const THIN: f64 = 1e-9;

/// The a-priori parameters of a robot, with pseudo-inertia matrices that are definite.
///
/// A link with a mass and physically possible moments keeps them. A link with a mass and impossible moments keeps mass and
/// centre of mass, and receives the guessed moments about that: none of the numbers that no body has is carried on. A link
/// without mass is guessed:
///
/// * its length is the mean distance of the joints that it carries from its own, for the last link half the mean length
///   of the others;
/// * its share of `total_mass` (default 20 kg per metre of all lengths) is proportional to the reach that it carries, the
///   longest path from its joint to the tip, because a motor's size grows with its load;
/// * it is a cylinder from its joint to those that it carries, the last one a sphere, with a radius of a quarter of its length,
///   but at least a quarter of the mean length.
///
/// Motor inertias and friction are unchanged.
#[must_use]
pub fn completed_a_priori(robot: &Robot, total_mass: Option<f64>) -> Vec<f64> {
    let table = robot.parameter_table();
    let mut theta = robot.a_priori_parameters_for(&table);
    for (k, guess) in guessed_links(robot, total_mass).iter().enumerate() {
        let indices = INERTIAL.map(|quantity| table.index(Quantity::Link(quantity), k).unwrap_or(usize::MAX));
        let given = indices.map(|i| theta.get(i).copied().unwrap_or(0.0));
        let completed = inertial_parameters(&completed(&pseudo_inertia(given), guess));
        for (i, value) in indices.into_iter().zip(if has_volume(&pseudo_inertia(given)) { given } else { completed }) {
            if let Some(entry) = theta.get_mut(i) {
                *entry = value;
            }
        }
    }
    theta
}

/// Whether the description states a mass of each link.
#[must_use]
pub fn stated_links(robot: &Robot) -> Vec<bool> {
    let table = robot.parameter_table();
    let theta = robot.a_priori_parameters_for(&table);
    let mass = |k: usize| table.index(Quantity::Link(LinkQuantity::M), k).map_or(0.0, |i| theta[i]);
    (0..robot.link_count()).map(|k| mass(k) > 0.0).collect()
}

/// The factor of all inertial parameters that fits the data best, with motor inertias, friction and offsets free.
///
/// It scales guessed masses to the size of the torques. None if the best factor is not positive.
#[must_use]
pub fn mass_factor(data: &LeastSquares, table: &ParameterTable, a_priori: &[f64]) -> Option<f64> {
    let inertial = |i: usize| table.get(i).quantity.is_inertial();
    let part: Vec<f64> = a_priori.iter().enumerate().map(|(i, v)| if inertial(i) { *v } else { 0.0 }).collect();
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for i in (0..table.len()).filter(|&i| !inertial(i)) {
        let column = data.matrix().column(i);
        let rest = without(&basis, column.to_vec());
        let (size, before) = (dot(&rest, &rest).sqrt(), dot(column, column).sqrt());
        if size > 1e-9 * before {
            basis.push(rest.iter().map(|v| v / size).collect());
        }
    }
    let direction = without(&basis, data.matrix().times(&part));
    let factor = dot(&direction, data.right_side()) / dot(&direction, &direction);
    (factor.is_finite() && factor > 0.0).then_some(factor)
}

/// A vector without its projection on orthonormal ones, subtracted twice because of rounding.
fn without(basis: &[Vec<f64>], mut x: Vec<f64>) -> Vec<f64> {
    for b in basis.iter().chain(basis) {
        let along = dot(b, &x);
        x.iter_mut().zip(b).for_each(|(x, b)| *x -= along * b);
    }
    x
}

fn has_volume(p: &Symmetric) -> bool {
    matches!(p.eigenvalues().as_slice(), [smallest, .., largest] if *smallest > THIN * largest)
}

/// A link's mass and centre of mass with the guessed moments about it, or the guess if there is no mass.
fn completed(given: &Symmetric, guess: &Symmetric) -> Symmetric {
    let (m, guessed) = (given.at(3, 3), guess.at(3, 3));
    if m.is_nan() || m <= 0.0 {
        return guess.clone();
    }
    let mut body = Symmetric::zeros(4);
    for i in 0..3 {
        for j in 0..=i {
            let about_centre = guess.at(i, j) - guess.at(3, i) * guess.at(3, j) / guessed;
            body.add(i, j, m / guessed * about_centre + given.at(3, i) * given.at(3, j) / m);
        }
        body.add(3, i, given.at(3, i));
    }
    body.add(3, 3, m);
    if has_volume(&body) { body } else { guess.times(m / guessed) }
}

/// The guessed pseudo-inertia matrix of each link, in its own axes.
fn guessed_links(robot: &Robot, total_mass: Option<f64>) -> Vec<Symmetric> {
    let children: Vec<Vec<&Joint>> =
        (0..robot.joints.len()).map(|k| robot.joints.iter().filter(|j| j.parent == Some(k)).collect()).collect();
    let lengths = lengths(&children);
    let mean = lengths.iter().sum::<f64>() / lengths.len().max(1) as f64;
    let reaches = reaches(robot, &lengths);
    let total = total_mass.unwrap_or(MASS_PER_LENGTH * lengths.iter().sum::<f64>());
    let all: f64 = reaches.iter().sum();
    let link = |k: usize| {
        let ends = children[k].iter().map(|joint| joint.placement.origin);
        let axes = robot.joints[k].link_axes;
        let ends: Vec<Vec3> = ends.map(|p| axes.map_or(p, |axes| transpose_times(&axes, p))).collect();
        cylinder(total * reaches[k] / all, &ends, SLENDERNESS * lengths[k].max(mean))
    };
    (0..robot.joints.len()).map(link).collect()
}

/// The length of each link: the mean distance to the joints it carries, or half the mean of the others if it carries none.
fn lengths(children: &[Vec<&Joint>]) -> Vec<f64> {
    let distance = |joints: &Vec<&Joint>| {
        joints.iter().map(|j| norm(j.placement.origin)).sum::<f64>() / joints.len().max(1) as f64
    };
    let known: Vec<f64> = children.iter().map(distance).collect();
    let positive = known.iter().filter(|l| **l > 0.0);
    let (count, sum) = positive.fold((0, 0.0), |(count, sum), l| (count + 1, sum + l));
    let usual = if count == 0 { USUAL_LENGTH } else { sum / f64::from(count) };
    known.iter().map(|&l| if l > 0.0 { l } else { 0.5 * usual }).collect()
}

/// The longest path from each joint to a tip, along the lengths of the links.
fn reaches(robot: &Robot, lengths: &[f64]) -> Vec<f64> {
    let mut reaches = lengths.to_vec();
    for k in (0..reaches.len()).rev() {
        if let Some(parent) = robot.joints[k].parent {
            reaches[parent] = reaches[parent].max(lengths[parent] + reaches[k]);
        }
    }
    reaches
}

/// The pseudo-inertia matrix of equal solid cylinders from the origin to each end; a sphere if there are no ends.
fn cylinder(mass: f64, ends: &[Vec3], radius: f64) -> Symmetric {
    let mut out = Symmetric::zeros(4);
    let count = ends.len().max(1) as f64;
    for i in 0..3 {
        out.add(i, i, mass * radius * radius * if ends.is_empty() { 0.2 } else { 0.25 });
    }
    for end in ends {
        for i in 0..3 {
            (0..=i).for_each(|j| out.add(i, j, mass / count * end[i] * end[j] / 3.0));
            out.add(3, i, 0.5 * mass / count * end[i]);
        }
    }
    out.add(3, 3, mass);
    out
}
