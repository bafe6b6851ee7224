//! Physically impossible values in a URDF: negative masses, inertias and friction, inertias that no body can have, bodies
//! without mass or inertia. And notes of what a file leaves out.

use super::{
    UrdfError,
    assembly::Assembly,
    element::Element,
    joints::JointElement,
    links,
    structure::{ImpliedBase, Structure},
};
use crate::robot::{
    Doubt, DoubtGrade, JointKind,
    body::RigidBody,
    physical::{are_of_a_body, principal_inertias},
};

/// Fraction of the largest inertia that truncated digits may cause, for files with three digits.
const ROUNDING: f64 = 0.01;
/// Radius of gyration, m, below which an inertia counts as zero: no link is a hundred times smaller than a grain of sand.
const LEAST_RADIUS: f64 = 1e-5;
/// Radius of gyration, m, above which inertias are in another unit than masses: no link is so large.
const LARGEST_RADIUS: f64 = 10.0;
/// Distance between joints, m, and the same over the middle one of the file, above which it may be in mm.
const LARGEST_LENGTH: f64 = 10.0;
const LARGEST_OVER_MIDDLE: f64 = 100.0;

/// The doubts about the links and joints of a file, in its order.
pub(super) fn of(structure: &Structure<'_>, assembly: &Assembly<'_, '_>) -> Result<Vec<Doubt>, UrdfError> {
    let mut doubts: Vec<Doubt> = structure.implied.iter().map(of_implied_base).collect();
    let bodies = assembly.moved_bodies();
    for ((link, body), place) in structure.links.iter().zip(bodies).zip(&assembly.places) {
        let carrier = place.and_then(|place| place.carrier);
        let whole = carrier.map(|joint| assembly.body(joint));
        doubts.extend(of_link(*link, body.as_ref(), whole)?.map(|doubt| doubt.carried_by(carrier)));
    }
    for joint in &structure.joints {
        let number = assembly.joints.iter().position(|moving| moving.name == joint.name);
        doubts.extend(of_joint(joint).into_iter().map(|doubt| doubt.carried_by(number)));
    }
    doubts.extend(of_lengths(&structure.joints));
    Ok(doubts)
}

/// The joints that are far more distant from the ones before them than those of the rest: their origins may be in mm.
fn of_lengths(joints: &[JointElement<'_>]) -> Vec<Doubt> {
    let length = |joint: &JointElement<'_>| joint.frame.origin.iter().map(|x| x * x).sum::<f64>().sqrt();
    let mut all: Vec<f64> = joints.iter().map(length).filter(|length| *length > 0.0).collect();
    all.sort_by(f64::total_cmp);
    let Some(&middle) = all.get(all.len().saturating_sub(1) / 2) else { return Vec::new() };
    let is_far = |joint: &&JointElement<'_>| length(joint) > LARGEST_LENGTH.max(LARGEST_OVER_MIDDLE * middle);
    let doubt = |joint: &JointElement<'_>| {
        let what = format!(
            "joint `{}` lies {} m from the one before it, and half of the joints at most {middle} m: is its <origin> in mm?",
            joint.name,
            length(joint)
        );
        Doubt::note(joint.element.place().to_string(), what, "write the lengths of <origin> in m")
    };
    joints.iter().filter(is_far).map(doubt).collect()
}

fn of_implied_base(base: &ImpliedBase<'_>) -> Doubt {
    let what =
        format!("the file has no link `{}`; it was added as the base, since every other link has a parent", base.name);
    Doubt::note(base.element.place().to_string(), what, "add <link name=\"...\"/> of this name")
}

/// The doubt about a link; `moved` is its body with everything fixed to it if a joint moves it, `whole` that of which it is a part.
fn of_link(
    link: Element<'_>,
    moved: Option<&RigidBody>,
    whole: Option<&RigidBody>,
) -> Result<Option<Doubt>, UrdfError> {
    let Some((inertial, body)) = links::inertial_of(link)? else { return Ok(None) };
    let place = inertial.place().to_string();
    let inertia = || of_inertia(&place, &body, moved.is_some());
    // The inertia of a part, such as a foot of a shank, is in equations with that of the whole.
    let is_part = moved.is_none() && whole.is_some_and(is_possible);
    let of_part = |doubt: Doubt| if is_part { doubt.into_note() } else { doubt };
    Ok(of_mass(&place, &body, moved).or_else(|| inertia().map(of_part)))
}

/// Why the mass of a link is in doubt.
fn of_mass(place: &str, body: &RigidBody, moved: Option<&RigidBody>) -> Option<Doubt> {
    let impossible = |what: String, value, remedy| {
        Some(Doubt {
            grade: DoubtGrade::Impossible,
            place: place.to_owned(),
            what,
            value,
            unit: "kg",
            carrier: None,
            remedy,
        })
    };
    if body.m < 0.0 {
        let remedy = "give the mass of the link; it is the start of iterations and what estimates are compared with";
        return impossible(format!("a mass of {} kg, below zero", body.m), body.m, remedy);
    }
    if body.m == 0.0 && largest_inertia(body) > 0.0 {
        return impossible("inertia without a mass".to_owned(), 0.0, "give the mass, or leave out the <inertial>");
    }
    if body.m == 0.0 && moved.is_some_and(|moved| moved.m == 0.0) {
        let what = "a mass of 0 kg for a link that a joint moves, with all that is fixed to it".to_owned();
        let remedy = "give the mass, or leave out the <inertial> of a link whose mass is unknown";
        return Some(Doubt::note(place.to_owned(), what, remedy));
    }
    None
}

fn is_possible(body: &RigidBody) -> bool {
    body.m > 0.0 && are_of_a_body(principal_inertias(body.parameters()), ROUNDING)
}

/// Why the inertia of a link is in doubt. A point mass that is fixed to another link is how loads are given.
fn of_inertia(place: &str, body: &RigidBody, is_moved: bool) -> Option<Doubt> {
    let principal = if body.m > 0.0 { principal_inertias(body.parameters()) } else { [0.0; 3] };
    if !are_of_a_body(principal, ROUNDING) {
        let [a, b, c] = principal;
        let what = format!(
            "principal inertias {a:.3e}, {b:.3e} and {c:.3e} kg m^2, which no body has: one is below zero, or the largest is \
             above the sum of the others"
        );
        let remedy = "give the inertia about the centre of mass, in the axes of the <origin> of the <inertial>";
        let (grade, place) = (DoubtGrade::Impossible, place.to_owned());
        return Some(Doubt { grade, place, what, value: a, unit: "kg m^2", carrier: None, remedy });
    }
    let largest = largest_inertia(body);
    if body.m > 0.0 && largest > LARGEST_RADIUS * LARGEST_RADIUS * body.m {
        let what = format!(
            "a mass of {} kg with an inertia of {largest} kg m^2, as of a body with a radius of {:.0} m: are masses in g, or inertias in \
             g mm^2 or kg mm^2?",
            body.m,
            (largest / body.m).sqrt()
        );
        return Some(Doubt::note(place.to_owned(), what, "give masses in kg and inertias in kg m^2"));
    }
    let is_a_point = is_moved && body.m > 0.0 && largest < LEAST_RADIUS * LEAST_RADIUS * body.m;
    let note = || {
        let what = format!("a mass of {} kg with an inertia of {largest:?} kg m^2: all of it in one point", body.m);
        let remedy = "give the inertia about the centre of mass, for example of a box of the link's size";
        Doubt::note(place.to_owned(), what, remedy)
    };
    is_a_point.then(note)
}

fn largest_inertia(body: &RigidBody) -> f64 {
    body.inertia.as_flattened().iter().fold(0.0, |m: f64, v| m.max(v.abs()))
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
        grade: DoubtGrade::Impossible,
        place: joint.element.place().to_string(),
        what: format!("a {word} of {value} {unit}, below zero: friction that drives"),
        value,
        unit,
        carrier: None,
        remedy: "give zero or more, or leave out <dynamics>",
    };
    below.map(doubt).chain(of_limits(joint)).collect()
}

/// Limits of velocity and effort that no joint can move under.
fn of_limits(joint: &JointElement<'_>) -> Vec<Doubt> {
    let Some((moving, limit)) = joint.moving.as_ref().zip(joint.element.child("limit")) else { return Vec::new() };
    let stated = [("velocity", moving.limits.velocity), ("effort", moving.limits.effort)];
    let unusable = stated.into_iter().filter_map(|(word, value)| Some((word, value.filter(|value| *value <= 0.0)?)));
    let note = |(word, value): (&str, f64)| {
        let what =
            format!("the limit of {word} is {value}, under which the joint cannot move: it is taken as not stated");
        Doubt::note(limit.place().to_string(), what, "give the limit of the data sheet, or leave out the attribute")
    };
    let position = moving.limits.lower.filter(|lower| Some(*lower) == moving.limits.upper);
    let fixed = |position: f64| {
        let what = format!("the limits of position are both {position}: the joint cannot move between them");
        Doubt::note(limit.place().to_string(), what, "give the range of the data sheet, or leave out lower and upper")
    };
    unusable.map(note).chain(position.map(fixed)).collect()
}
