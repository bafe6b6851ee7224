//! Drives: the gears, armatures and damping of actuators on joints.

use std::collections::HashSet;

use super::{
    classes::{Classes, MAIN, Properties},
    compiler::Settings,
    element::{Element, elements_of},
    error::MjcfError,
    joint::limits,
    world::World,
};
use crate::robot::{Joint, Transmission};
use thetahat_ground::linear_algebra::Matrix;

/// Elements of `<actuator>`. A class has one set of attributes for all of them.
const TAGS: [&str; 13] = [
    "general",
    "motor",
    "position",
    "velocity",
    "intvelocity",
    "orientation",
    "pid",
    "damper",
    "cylinder",
    "muscle",
    "adhesion",
    "dcmotor",
    "plugin",
];

/// The actuators of a model.
pub(super) struct Actuators<'a> {
    /// Those of one joint.
    pub(super) drives: Vec<Drive<'a>>,
    /// Those of tendons, sites and bodies.
    pub(super) others: Vec<Element<'a>>,
}

/// An actuator of one joint.
pub(super) struct Drive<'a> {
    pub(super) element: Element<'a>,
    /// Its joint, by index.
    pub(super) joint: usize,
    /// Its velocity per velocity of the joint.
    pub(super) gear: f64,
    /// Its force per unit of control; none for a servo, whose control is no force.
    pub(super) gain: Option<f64>,
    pub(super) armature: f64,
    /// By its velocity, the square and the cube.
    damping: [f64; 3],
    /// Its largest force.
    force: Option<f64>,
}

impl<'a> Actuators<'a> {
    pub(super) fn read(
        root: Element<'a>,
        settings: &Settings,
        classes: &Classes<'a>,
        joints: &[Joint],
        world: &World<'a>,
    ) -> Result<Self, MjcfError> {
        let parts = world.bodies.iter().flat_map(|body| &body.joints);
        let stated: HashSet<&str> = parts.filter_map(|part| part.element.text_of("name")).collect();
        let mut actuators = Self { drives: Vec::new(), others: Vec::new() };
        for element in elements_of(root, "actuator")? {
            if !TAGS.contains(&element.tag()) {
                continue;
            }
            let name = ["joint", "jointinparent"].into_iter().find_map(|key| element.text_of(key));
            let Some(name) = name else {
                actuators.others.push(element);
                continue;
            };
            let Some(joint) = joints.iter().position(|joint| joint.name == name) else {
                // A free joint is not among the joints: its actuators are left out with it.
                if stated.contains(name) { continue } else { return Err(element.unknown("joint", name)) }
            };
            let properties = classes.of(element, MAIN, &TAGS)?;
            actuators.drives.push(Drive::read(&properties, joint, settings)?);
        }
        Ok(actuators)
    }

    pub(super) fn of_joint(&self, joint: usize) -> impl Iterator<Item = &Drive<'a>> {
        self.drives.iter().filter(move |drive| drive.joint == joint)
    }

    /// The sum of the armatures of a joint's actuators, at the joint.
    pub(super) fn armature(&self, joint: usize) -> f64 {
        self.of_joint(joint).map(|drive| drive.gear * drive.gear * drive.armature).sum()
    }

    /// The sum of the damping of a joint's actuators, at the joint: by the velocity, its square and its cube. MuJoCo multiplies each
    /// by the square of the gear.
    pub(super) fn damping(&self, joint: usize) -> [f64; 3] {
        let factor = |drive: &Drive<'_>, power: usize| drive.gear * drive.gear * drive.damping[power];
        [0, 1, 2].map(|power| self.of_joint(joint).map(|drive| factor(drive, power)).sum())
    }

    /// The gear of a joint: one without actuators; none if its actuators have different gears.
    pub(super) fn gear(&self, joint: usize) -> Option<f64> {
        let mut gears = self.of_joint(joint).map(|drive| drive.gear).filter(|gear| *gear != 0.0);
        let Some(first) = gears.next() else { return Some(1.0) };
        gears.all(|gear| gear == first).then_some(first)
    }

    fn gain(&self, joint: usize) -> f64 {
        let mut drives = self.of_joint(joint);
        match (drives.next(), drives.next()) {
            (Some(only), None) => only.gain.filter(|gain| *gain != 0.0).unwrap_or(1.0),
            (Some(_), Some(_)) | (None, _) => 1.0,
        }
    }

    /// The largest torque of a joint with one actuator.
    pub(super) fn effort(&self, joint: usize) -> Option<f64> {
        let mut drives = self.of_joint(joint);
        let force = drives.next().and_then(|drive| Some(drive.force? * drive.gear.abs()));
        force.filter(|force| *force > 0.0 && drives.next().is_none())
    }

    /// The gears as a diagonal matrix, for the joints that follow no other.
    pub(super) fn transmission(&self, joints: &[Joint]) -> Transmission {
        let coordinates: Vec<usize> = (0..joints.len()).filter(|&j| joints[j].mimic.is_none()).collect();
        let n = coordinates.len();
        let gear = |i: usize| self.gear(coordinates[i]).unwrap_or(1.0);
        let matrix = Matrix::from_fn(n, n, |i, j| if i == j { gear(i) } else { 0.0 });
        let gains = coordinates.iter().map(|&joint| self.gain(joint)).collect();
        Transmission::new(matrix, vec![0.0; n], gains).unwrap_or_else(|| Transmission::direct(n))
    }
}

impl<'a> Drive<'a> {
    fn read(properties: &Properties<'a>, joint: usize, settings: &Settings) -> Result<Self, MjcfError> {
        let [gear, ..] = properties.leading("gear", [1.0, 0.0, 0.0, 0.0, 0.0, 0.0])?;
        let gain = gain(properties)?;
        let largest = |range: Option<[f64; 2]>| range.map(|[low, high]: [f64; 2]| low.abs().max(high.abs()));
        let force = largest(limits(properties, "forcerange", "forcelimited", settings)?);
        let control = largest(limits(properties, "ctrlrange", "ctrllimited", settings)?);
        let driven = control.zip(gain).map(|(control, gain)| control * gain.abs());
        Ok(Self {
            element: properties.element(),
            joint,
            gear,
            gain,
            armature: properties.number("armature")?.unwrap_or(0.0),
            damping: properties.leading("damping", [0.0; 3])?,
            force: force.into_iter().chain(driven).reduce(f64::min),
        })
    }

    pub(super) fn is_servo(&self) -> bool {
        self.gain.is_none()
    }
}

/// The force per unit of control of a motor, or of a general actuator that is like one.
fn gain(properties: &Properties<'_>) -> Result<Option<f64>, MjcfError> {
    match properties.element().tag() {
        "motor" => Ok(Some(1.0)),
        "general" => {
            let usual = |key, usual: &str| properties.text_of(key).is_none_or(|text| text == usual);
            let is_motor = usual("gaintype", "fixed") && usual("biastype", "none") && usual("dyntype", "none");
            let gain = properties.attribute("gainprm").map_or(Ok([1.0; 10]), |attribute| {
                let mut values = [0.0; 10];
                attribute.overlay(&mut values).map(|_| values)
            })?;
            Ok(is_motor.then_some(gain[0]))
        }
        _ => Ok(None),
    }
}
