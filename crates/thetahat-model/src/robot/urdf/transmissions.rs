use super::{UrdfError, element::Element, structure};

/// The reduction of each joint named, one if none is given. Transmissions whose joints are all locked are ignored.
pub(super) fn reductions(
    robot: Element<'_>,
    joints: &[&str],
    is_locked: &dyn Fn(&str) -> bool,
) -> Result<Vec<f64>, UrdfError> {
    let mut found: Vec<Option<f64>> = vec![None; joints.len()];
    for transmission in robot.elements().filter(|e| e.tag() == "transmission") {
        if refuse_coupling_with_locked(transmission, is_locked)? {
            continue;
        }
        let Some((joint, element)) = joint_of(transmission)? else { continue };
        let place = joints.iter().position(|name| *name == joint);
        let place = place.ok_or_else(|| structure::unknown(element, "joint", joint, joints.iter()))?;
        let Some(reduction) = reduction(transmission)? else { continue };
        if found[place].replace(reduction).is_some_and(|other| other != reduction) {
            let problem = format!("gives joint `{joint}` a second, different reduction");
            return Err(UrdfError::Transmission { place: transmission.place(), problem });
        }
    }
    Ok(found.into_iter().map(|reduction| reduction.unwrap_or(1.0)).collect())
}

/// Whether all joints of a transmission are locked.
fn refuse_coupling_with_locked(transmission: Element<'_>, is_locked: &dyn Fn(&str) -> bool) -> Result<bool, UrdfError> {
    let names = || transmission.elements().filter(|e| e.tag() == "joint").filter_map(|e| e.attribute("name"));
    match (names().find(|name| is_locked(name)), names().find(|name| !is_locked(name))) {
        (Some(locked), Some(moving)) => Err(UrdfError::Transmission {
            place: transmission.place(),
            problem: format!("couples `{locked}`, which is locked, with `{moving}`, which moves: lock both or none"),
        }),
        (locked, _) => Ok(locked.is_some()),
    }
}

/// The one joint of a transmission; transmissions of old files that drive no joint are skipped.
fn joint_of(transmission: Element<'_>) -> Result<Option<(&str, Element<'_>)>, UrdfError> {
    let count = |tag: &str| transmission.elements().filter(|e| e.tag() == tag).count();
    if count("joint") > 1 || count("actuator") > 1 {
        let problem = "couples several joints or motors".to_owned();
        return Err(UrdfError::Transmission { place: transmission.place(), problem });
    }
    let Some(joint) = transmission.child("joint") else { return Ok(None) };
    Ok(Some((joint.required("name", "name the joint of the transmission")?, joint)))
}

/// `<mechanicalReduction>` of the actuator, or, as in older files, of the joint or the transmission itself.
fn reduction(transmission: Element<'_>) -> Result<Option<f64>, UrdfError> {
    let owners = [transmission.child("actuator"), transmission.child("joint"), Some(transmission)];
    let element = owners.into_iter().flatten().find_map(|owner| owner.child("mechanicalReduction"));
    let Some(element) = element else { return Ok(None) };
    match element.text_number()? {
        0.0 => Err(element.value("the text", "a ratio other than zero", "0")),
        reduction => Ok(Some(reduction)),
    }
}
