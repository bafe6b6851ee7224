//! Torque terms of a robot with locked joints.

use super::places::{Place, Renumbering, frame_in_carrier};
use crate::robot::{Robot, TermDescription};
use thetahat_ground::vector::{add, times};

/// The terms that act on remaining joints; points on the links of locked joints become points of their carriers.
pub(super) fn remaining_terms(whole: &Robot, renumbering: &Renumbering) -> Vec<TermDescription> {
    let is_gone = |name: &str| {
        let place = whole.joints.iter().position(|joint| joint.name == name);
        place.is_some_and(|j| renumbering.joints[j].is_none())
    };
    let carried = |term: TermDescription| moved_to_carriers(term.without_joints(&is_gone)?, whole, &renumbering.places);
    whole.term_descriptions.iter().cloned().filter_map(carried).collect()
}

/// A term with its points on the carriers of their links; none if both points are on one link.
fn moved_to_carriers(mut term: TermDescription, whole: &Robot, places: &[Place]) -> Option<TermDescription> {
    let Some(points) = term.points_mut() else { return Some(term) };
    let mut carriers = [None; 2];
    for (point, carrier) in points.into_iter().zip(&mut carriers) {
        let joint = point.link_of.as_ref().and_then(|name| whole.joints.iter().position(|j| j.name == *name));
        let Some(joint) = joint else { continue };
        let frame = frame_in_carrier(whole, joint, &places[joint]);
        *carrier = places[joint].carrier;
        point.point_m = add(frame.origin, times(&frame.rotation, point.point_m));
        point.link_of = carrier.map(|carrier| whole.joints[carrier].name.clone());
    }
    (carriers[0] != carriers[1]).then_some(term)
}

/// The a-priori values of the terms under their new names.
pub(super) fn a_priori_of_terms<'r>(
    whole: &'r Robot,
    rest: &'r Robot,
    renumbering: &'r Renumbering,
) -> impl Iterator<Item = (String, f64)> + 'r {
    whole.terms.iter().filter_map(|column| {
        let value = *whole.a_priori.get(&column.parameter)?;
        let name = match whole.term_descriptions[column.term].has_own_name() {
            true => column.parameter.clone(),
            false => {
                let stem = column.parameter.strip_suffix(&(column.joint + 1).to_string())?;
                format!("{stem}{}", renumbering.joints[column.joint]? + 1)
            }
        };
        rest.terms.iter().any(|term| term.parameter == name).then_some((name, value))
    })
}
