//! Physically impossible values in a URDF: negative masses, inertias and friction, and inertias that no body can have.

use super::{UrdfError, element::Element, joints::JointElement, links};
use crate::robot::{
    Doubt, JointKind,
    physical::{are_of_a_body, principal_inertias},
};

/// Fraction of the largest inertia that truncated digits may cause, for files with three digits.
const ROUNDING: f64 = 0.01;

/// The doubts about the links and joints of a file, in its order.
pub(super) fn of(links: &[Element<'_>], joints: &[JointElement<'_>]) -> Result<Vec<Doubt>, UrdfError> {
    let mut doubts = Vec::new();
    for link in links {
        doubts.extend(of_link(*link)?);
    }
    doubts.extend(joints.iter().flat_map(of_joint));
    Ok(doubts)
}

fn of_link(link: Element<'_>) -> Result<Option<Doubt>, UrdfError> {
    let Some((inertial, body)) = links::inertial_of(link)? else { return Ok(None) };
    let doubt = |what: String, value, unit, remedy| {
        Some(Doubt { place: inertial.place().to_string(), what, value, unit, remedy })
    };
    if body.m < 0.0 {
        let remedy = "give the mass of the link; it is the start of iterations and what estimates are compared with";
        return Ok(doubt(format!("a mass of {} kg, below zero", body.m), body.m, "kg", remedy));
    }
    let parameters = body.parameters();
    let largest = parameters.iter().take(6).fold(0.0, |m: f64, v| m.max(v.abs()));
    if body.m == 0.0 && largest > 0.0 {
        return Ok(doubt("inertia without a mass".to_owned(), 0.0, "kg", "give the mass, or leave out the <inertial>"));
    }
    let principal = if body.m > 0.0 { principal_inertias(parameters) } else { [0.0; 3] };
    if are_of_a_body(principal, ROUNDING) {
        return Ok(None);
    }
    let [a, b, c] = principal;
    let what = format!(
        "principal inertias {a:.3e}, {b:.3e} and {c:.3e} kg m^2, which no body has: one is below zero, or the largest is \
         above the sum of the others"
    );
    Ok(doubt(
        what,
        a,
        "kg m^2",
        "give the inertia about the centre of mass, in the axes of the <origin> of the <inertial>",
    ))
}

fn of_joint(joint: &JointElement<'_>) -> Vec<Doubt> {
    let Some(moving) = &joint.moving else { return Vec::new() };
    let [damping, friction] = match moving.kind {
        JointKind::Revolute => ["N m s/rad", "N m"],
        JointKind::Prismatic => ["N s/m", "N"],
    };
    let given = [("damping", damping), ("friction", friction)].into_iter().zip(moving.friction);
    let below = given.filter(|(_, value)| *value < 0.0);
    let doubt = |((word, unit), value): ((&str, &'static str), f64)| Doubt {
        place: joint.element.place().to_string(),
        what: format!("a {word} of {value} {unit}, below zero: friction that drives"),
        value,
        unit,
        remedy: "give zero or more, or leave out <dynamics>",
    };
    below.map(doubt).collect()
}
