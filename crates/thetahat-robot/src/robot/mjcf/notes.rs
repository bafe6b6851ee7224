//! What a robot cannot hold of a model, and physically impossible values.

use super::{
    actuators::Actuators,
    assembly::{Assembly, WeighedBody},
    classes::{Classes, MAIN},
    element::{Element, elements_of},
    error::MjcfError,
    world::World,
};
use crate::robot::{
    Doubt, DoubtGrade, Joint, JointKind,
    body::RigidBody,
    physical::{are_of_a_body, principal_inertias},
};

/// Fraction of the largest inertia that truncated digits may cause.
const ROUNDING: f64 = 0.01;

/// The parts of a model that notes are about.
pub(super) struct Noted<'n, 'a> {
    pub(super) root: Element<'a>,
    pub(super) classes: &'n Classes<'a>,
    pub(super) world: &'n World<'a>,
    pub(super) assembly: &'n Assembly<'a>,
    pub(super) actuators: &'n Actuators<'a>,
}

/// Most doubts about bodies: more are of one cause.
const MOST_DOUBTS: usize = 50;

/// Elements of one kind that are left out, under one note.
struct Omission {
    what: &'static str,
    remedy: &'static str,
}

impl Omission {
    fn note(&self, elements: &[Element<'_>]) -> Option<Doubt> {
        const LISTED: usize = 6;
        let first = elements.first()?;
        let mut names: Vec<String> = elements.iter().take(LISTED).map(|element| element.name()).collect();
        if elements.len() > LISTED {
            names.push(format!("{} more", elements.len() - LISTED));
        }
        let what = format!("{} ({})", self.what, names.join(", "));
        let value = elements.len() as f64;
        let grade = DoubtGrade::Note;
        Some(Doubt {
            grade,
            place: first.place().to_string(),
            what,
            value,
            unit: "",
            carrier: None,
            remedy: self.remedy,
        })
    }
}

impl<'a> Noted<'_, 'a> {
    pub(super) fn doubts(&self) -> Result<Vec<Doubt>, MjcfError> {
        let mut doubts: Vec<Doubt> = self.omissions()?.into_iter().filter_map(|(kind, of)| kind.note(&of)).collect();
        let of_bodies = self.assembly.masses.iter().filter_map(of_body);
        doubts.extend(of_bodies.take(MOST_DOUBTS));
        let joints = self.assembly.joints.iter().enumerate().zip(&self.assembly.moving);
        doubts.extend(joints.flat_map(|(joint, moving)| {
            let values = [
                ("damping", moving.damping[0]),
                ("frictionloss", moving.friction),
                ("armature", moving.armature),
                ("stiffness", moving.stiffness[0]),
            ];
            of_joint(joint, moving.element, values)
        }));
        Ok(doubts)
    }

    fn omissions(&self) -> Result<Vec<(Omission, Vec<Element<'a>>)>, MjcfError> {
        let moving = || self.assembly.moving.iter();
        let servos = self.actuators.drives.iter().filter(|drive| drive.is_servo());
        Ok(vec![
            (FREE, self.assembly.free.clone()),
            (TIME_CONSTANT, moving().filter(|joint| joint.has_time_constant).map(|joint| joint.element).collect()),
            (SPRING, moving().filter(|joint| joint.stiffness[1..] != [0.0; 2]).map(|joint| joint.element).collect()),
            (OTHER_DRIVE, self.actuators.others.clone()),
            (SERVO, servos.map(|drive| drive.element).collect()),
            (GEARS, self.with_several_gears()),
            (TENDON, self.tendons()?),
            (COMPENSATION, self.compensated()?),
            (FLUID, self.with_fluid()?),
        ])
    }

    fn with_several_gears(&self) -> Vec<Element<'a>> {
        let joints = (0..self.assembly.joints.len()).filter(|&joint| self.actuators.gear(joint).is_none());
        joints.map(|joint| self.assembly.moving[joint].element).collect()
    }

    fn tendons(&self) -> Result<Vec<Element<'a>>, MjcfError> {
        let mut found = Vec::new();
        for element in elements_of(self.root, "tendon")? {
            let tendon = self.classes.of(element, MAIN, &["tendon"])?;
            let mut acts = false;
            for key in ["stiffness", "damping", "frictionloss", "armature"] {
                acts |= tendon.leading(key, [0.0; 3])? != [0.0; 3];
            }
            found.extend(acts.then_some(element));
        }
        Ok(found)
    }

    fn compensated(&self) -> Result<Vec<Element<'a>>, MjcfError> {
        let mut found = Vec::new();
        for (body, place) in self.world.bodies.iter().zip(&self.assembly.places) {
            let Some(gravcomp) = body.element.attribute("gravcomp").filter(|_| place.carrier.is_some()) else {
                continue;
            };
            found.extend((gravcomp.number()? != 0.0).then_some(body.element));
        }
        Ok(found)
    }

    fn with_fluid(&self) -> Result<Vec<Element<'a>>, MjcfError> {
        let mut found = Vec::new();
        for option in self.root.named("option") {
            for attribute in ["density", "viscosity"].into_iter().filter_map(|key| option.attribute(key)) {
                found.extend((attribute.number()? != 0.0).then_some(option));
            }
        }
        Ok(found)
    }
}

const FREE: Omission = Omission {
    what: "a free joint, whose body is fixed where the model places it",
    remedy: "use recordings with this body at rest, or state floating_base = true in a TOML on this file",
};
const TIME_CONSTANT: Omission = Omission {
    what: "a springdamper, which is not read",
    remedy: "write stiffness and damping instead, as MuJoCo's `mj_saveLastXML` does",
};
const SPRING: Omission = Omission {
    what: "stiffness by powers of the deflection, of which only the first number is read",
    remedy: "add the other torques as a [[term]] of kind expression",
};
const OTHER_DRIVE: Omission = Omission {
    what: "actuators that do not act on one joint, which are not read",
    remedy: "give [transmission] matrix in a TOML on this model if the recording has their motors",
};
const SERVO: Omission = Omission {
    what: "actuators that are controlled by other than a force, whose gains are not read",
    remedy: "describe the controller in the experiment if a method needs it, and record their forces as torques",
};
const GEARS: Omission = Omission {
    what: "actuators of one joint with different gears, for which the gear is one",
    remedy: "give [transmission] matrix in a TOML on this model",
};
const TENDON: Omission = Omission {
    what: "tendons with stiffness, damping, friction or armature, which are not read",
    remedy: "add their torques as a [[term]], or take them out of the model",
};
const COMPENSATION: Omission = Omission {
    what: "bodies with gravcomp, which is not read",
    remedy: "add the compensating torque to the recorded one, or a counterbalance as a [[term]]",
};
const FLUID: Omission = Omission {
    what: "forces of a fluid, which are not read",
    remedy: "set density and viscosity of <option> to zero, or add their torques as a [[term]]",
};

fn of_body(WeighedBody { element, carrier, properties }: &WeighedBody<'_>) -> Option<Doubt> {
    let doubt = |what: String, value, unit, remedy| {
        let (grade, carrier) = (DoubtGrade::Impossible, Some(*carrier));
        Some(Doubt { grade, place: element.place().to_string(), what, value, unit, carrier, remedy })
    };
    let body = RigidBody { m: properties.mass, ms: [0.0; 3], inertia: properties.inertia };
    let is_heavy = properties.inertia.as_flattened().iter().any(|entry| *entry != 0.0);
    if properties.mass < 0.0 {
        let remedy = "give the mass of the body; it is the start of iterations and what estimates are compared with";
        return doubt(format!("a mass of {} kg, below zero", properties.mass), properties.mass, "kg", remedy);
    }
    if properties.mass == 0.0 {
        let remedy = "give the mass, or leave out the <inertial>";
        return is_heavy.then(|| doubt("inertia without a mass".to_owned(), 0.0, "kg", remedy)).flatten();
    }
    let principal = principal_inertias(body.parameters());
    if are_of_a_body(principal, ROUNDING) {
        return None;
    }
    let [a, b, c] = principal;
    let what = format!(
        "principal inertias {a:.3e}, {b:.3e} and {c:.3e} kg m^2, which no body has: one is below zero, or the largest is \
         above the sum of the others"
    );
    doubt(what, a, "kg m^2", "give the inertia about the centre of mass, or balanceinertia=\"true\" to <compiler>")
}

fn of_joint((number, joint): (usize, &Joint), element: Element<'_>, values: [(&'static str, f64); 4]) -> Vec<Doubt> {
    let units = match joint.kind {
        JointKind::Revolute => ["N m s/rad", "N m", "kg m^2", "N m/rad"],
        JointKind::Prismatic => ["N s/m", "N", "kg", "N/m"],
    };
    let below = values.into_iter().zip(units).filter(|((_, value), _)| *value < 0.0);
    let doubt = |((key, value), unit): ((&str, f64), &'static str)| Doubt {
        grade: DoubtGrade::Impossible,
        place: element.place().to_string(),
        what: format!("{key} of {value} {unit}, below zero"),
        value,
        unit,
        carrier: Some(number),
        remedy: "give zero or more, or leave it out",
    };
    below.map(doubt).collect()
}
