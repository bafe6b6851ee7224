//! What the `<transmission>`s of a file say about the drive of each joint. They are children of `<robot>`, as in ROS 1, or
//! of a `<ros2_control>`.

use super::{UrdfError, element::Element, structure};

/// Spellings of the reduction: the first of ROS 1, the second of ROS 2.
const REDUCTION: [&str; 2] = ["mechanicalReduction", "mechanical_reduction"];
/// Spellings of the motor's inertia, kg m^2 about its own axis.
const MOTOR_INERTIA: [&str; 4] = ["motorInertia", "motor_inertia", "rotor_inertia", "rotorInertia"];
/// Drake's reduction between the rotor of a `rotor_inertia` and the joint.
const ROTOR_RATIO: [&str; 1] = ["gear_ratio"];

/// The drive of a joint as its transmissions state it.
#[derive(Clone, Copy, Default)]
pub(super) struct Drive<'a> {
    reduction: Option<f64>,
    rotor_ratio: Option<f64>,
    motor_inertia: Option<f64>,
    offset: Option<f64>,
    /// The element that states the motor's inertia.
    inertia_element: Option<Element<'a>>,
}

impl Drive<'_> {
    /// Motor positions per joint position.
    pub(super) fn reduction(&self) -> f64 {
        self.reduction.unwrap_or(1.0)
    }

    /// The joint's position at the motor's zero, rad or m.
    pub(super) fn offset(&self) -> f64 {
        self.offset.unwrap_or(0.0)
    }

    /// The inertia of the motor seen at the joint: `N^2 J`.
    pub(super) fn inertia_at_joint(&self) -> Option<f64> {
        let ratio = self.rotor_ratio.unwrap_or_else(|| self.reduction());
        self.motor_inertia.map(|inertia| ratio * ratio * inertia).filter(|inertia| inertia.is_finite())
    }

    /// The place of an inertia that is stated.
    pub(super) fn inertia_place(&self) -> Option<String> {
        self.inertia_element.map(|element| element.place().to_string())
    }
}

/// The drives of the joints of a file.
pub(super) struct Drives<'a> {
    /// That of each joint named, in their order.
    pub(super) of_joints: Vec<Drive<'a>>,
    /// Pairs of joints that two motors drive together.
    pub(super) couplings: Vec<Coupling<'a>>,
}

/// The drives of the joints named. Transmissions whose joints are all locked are ignored.
pub(super) fn drives<'a>(
    robot: Element<'a>,
    joints: &[&str],
    is_locked: &dyn Fn(&str) -> bool,
) -> Result<Drives<'a>, UrdfError> {
    let mut drives = Drives { of_joints: vec![Drive::default(); joints.len()], couplings: Vec::new() };
    for transmission in transmissions(robot) {
        if refuse_coupling_with_locked(transmission.element, is_locked)? {
            continue;
        }
        if transmission.is_only_an_interface() {
            continue;
        }
        if let Some(kind) = transmission.coupling_kind() {
            drives.add_coupling(Coupling::of(transmission.element, kind)?, joints)?;
            continue;
        }
        let Some((joint, element)) = joint_of(transmission.element)? else { continue };
        let place = joints.iter().position(|name| *name == joint);
        let place = place.ok_or_else(|| structure::unknown(element, "joint", joint, joints.iter()))?;
        let found = transmission.drive()?;
        merge(&mut drives.of_joints[place], found).map_err(|quantity| UrdfError::Transmission {
            place: transmission.element.place(),
            problem: format!("gives joint `{joint}` a second, different {quantity}"),
        })?;
    }
    Ok(drives)
}

impl<'a> Drives<'a> {
    fn add_coupling(&mut self, coupling: Coupling<'a>, joints: &[&str]) -> Result<(), UrdfError> {
        for joint in coupling.joints {
            if !joints.contains(&joint) {
                return Err(structure::unknown(coupling.element, "joint", joint, joints.iter()));
            }
            if self.couplings.iter().any(|other| other.joints.contains(&joint)) {
                let problem = format!("couples joint `{joint}`, which another transmission couples too");
                return Err(UrdfError::Transmission { place: coupling.element.place(), problem });
            }
        }
        self.couplings.push(coupling);
        Ok(())
    }
}

/// How two motors drive two joints, by the classes of ROS' `transmission_interface`.
#[derive(Clone, Copy)]
enum CouplingKind {
    /// Sum and difference of the joints.
    Differential,
    /// The second motor turns with both joints.
    FourBarLinkage,
}

/// Two joints that two motors drive together.
pub(super) struct Coupling<'a> {
    pub(super) element: Element<'a>,
    pub(super) joints: [&'a str; 2],
    /// Motor positions per joint position: one row for each motor.
    pub(super) matrix: [[f64; 2]; 2],
    /// The joints' positions at the zeros of the motors.
    pub(super) offset: [f64; 2],
}

impl<'a> Coupling<'a> {
    /// With the reductions a of the motors and j of the joints (ros2_control, `transmission_interface`): differential
    /// `a1 (j1 q1 + j2 q2)` and `a2 (j1 q1 - j2 q2)`, four-bar linkage `a1 j1 q1` and `a2 (q1 + j2 q2)`.
    fn of(element: Element<'a>, kind: CouplingKind) -> Result<Self, UrdfError> {
        let [joints, motors] = ["joint", "actuator"].map(|tag| two_by_role(element, tag));
        let (joints, motors) = (joints?, motors?);
        let [j1, j2] = reductions(joints)?;
        let [a1, a2] = reductions(motors)?;
        let matrix = match kind {
            CouplingKind::Differential => [[a1 * j1, a1 * j2], [a2 * j1, -a2 * j2]],
            CouplingKind::FourBarLinkage => [[a1 * j1, 0.0], [a2, a2 * j2]],
        };
        let offset = |joint: Element<'_>| joint.child("offset").map_or(Ok(0.0), Element::bounded_content);
        let name = |joint: Element<'a>| joint.required("name", "name the joint of the transmission");
        let [first, second] = joints;
        Ok(Self { element, joints: [name(first)?, name(second)?], matrix, offset: [offset(first)?, offset(second)?] })
    }

    /// The elements that state the inertias of its motors.
    pub(super) fn motor_inertias(&self) -> impl Iterator<Item = Element<'a>> + use<'a> {
        self.element.descendants().filter(|element| MOTOR_INERTIA.contains(&element.tag()))
    }
}

/// The two joints or motors of a coupling in the order of their roles, or of the file where they have none.
fn two_by_role<'a>(transmission: Element<'a>, tag: &str) -> Result<[Element<'a>; 2], UrdfError> {
    let mut found: Vec<Element<'a>> = transmission.children(tag).collect();
    found.sort_by_key(|e| role(*e).and_then(|role| role.strip_prefix(tag)?.parse::<u8>().ok()));
    found.try_into().map_err(|found: Vec<_>| UrdfError::Transmission {
        place: transmission.place(),
        problem: format!("couples two joints by two motors, and states {} <{tag}>", found.len()),
    })
}

fn role(element: Element<'_>) -> Option<&str> {
    element.attribute("role").or_else(|| Some(element.child("role")?.text()))
}

fn reductions(pair: [Element<'_>; 2]) -> Result<[f64; 2], UrdfError> {
    let of = |owner: Element<'_>| REDUCTION.iter().find_map(|tag| owner.child(tag)).map_or(Ok(1.0), ratio);
    let [first, second] = pair.map(of);
    Ok([first?, second?])
}

/// The elements that state a motor's inertia.
pub(super) fn motor_inertias(robot: Element<'_>) -> Vec<Element<'_>> {
    transmissions(robot).filter_map(|transmission| transmission.find(&MOTOR_INERTIA)).collect()
}

/// A `<transmission>`, and whether a `<ros2_control>` holds it.
#[derive(Clone, Copy)]
struct TransmissionElement<'a> {
    element: Element<'a>,
    of_ros2_control: bool,
}

fn transmissions(robot: Element<'_>) -> impl Iterator<Item = TransmissionElement<'_>> {
    let blocks = robot.elements().filter(|e| e.tag() == "ros2_control");
    children_of(robot, false).chain(blocks.flat_map(|block| children_of(block, true)))
}

fn children_of(parent: Element<'_>, of_ros2_control: bool) -> impl Iterator<Item = TransmissionElement<'_>> {
    let own = parent.elements().filter(|e| e.tag() == "transmission");
    own.map(move |element| TransmissionElement { element, of_ros2_control })
}

impl<'a> TransmissionElement<'a> {
    /// Whether it names several joints without a coupling, as those of hardware interfaces do: it has no reduction, and no
    /// type that couples joints.
    fn is_only_an_interface(&self) -> bool {
        let several = self.element.children("joint").count() > 1;
        let states = |e: Element<'_>| REDUCTION.contains(&e.tag()) || ROTOR_RATIO.contains(&e.tag());
        several && self.coupling_kind().is_none() && !self.element.descendants().any(states)
    }

    /// How it couples two joints, by its `<type>` of ROS 1 or `<plugin>` of ROS 2.
    fn coupling_kind(&self) -> Option<CouplingKind> {
        let kind = ["type", "plugin"].iter().find_map(|tag| self.element.child(tag))?.text();
        let known = [("Differential", CouplingKind::Differential), ("FourBar", CouplingKind::FourBarLinkage)];
        known.into_iter().find_map(|(word, coupling)| kind.contains(word).then_some(coupling))
    }

    fn drive(&self) -> Result<Drive<'a>, UrdfError> {
        let inertia_element = self.find(&MOTOR_INERTIA);
        let offset = self.element.child("joint").and_then(|joint| joint.child("offset"));
        Ok(Drive {
            reduction: self.find(&REDUCTION).map(ratio).transpose()?,
            rotor_ratio: self.find(&ROTOR_RATIO).map(ratio).transpose()?,
            motor_inertia: inertia_element.map(inertia).transpose()?,
            offset: offset.map(Element::bounded_content).transpose()?,
            inertia_element,
        })
    }

    /// The first child of one of these names: of the actuator, or of the joint or the transmission itself, as in older files.
    /// ROS 2 reads the reduction of the joint.
    fn find(&self, names: &[&str]) -> Option<Element<'a>> {
        let (actuator, joint) = (self.element.child("actuator"), self.element.child("joint"));
        let first = if self.of_ros2_control { [joint, actuator] } else { [actuator, joint] };
        let owners = first.into_iter().chain([Some(self.element)]).flatten();
        owners.flat_map(|owner| names.iter().filter_map(move |name| owner.child(name))).next()
    }
}

fn ratio(element: Element<'_>) -> Result<f64, UrdfError> {
    match element.bounded_content()? {
        0.0 => Err(element.value("the text", "a ratio other than zero", "0")),
        ratio => Ok(ratio),
    }
}

fn inertia(element: Element<'_>) -> Result<f64, UrdfError> {
    let inertia = element.bounded_content()?;
    if inertia >= 0.0 {
        return Ok(inertia);
    }
    Err(element.value("the text", "the inertia of a motor in kg m^2, zero or more", &inertia.to_string()))
}

/// Adds what another transmission says about the joint.
///
/// # Errors
/// The quantity in which the two differ.
fn merge<'a>(drive: &mut Drive<'a>, found: Drive<'a>) -> Result<(), &'static str> {
    let merged = |before: &mut Option<f64>, now: Option<f64>, quantity| match (*before, now) {
        (Some(a), Some(b)) if a != b => Err(quantity),
        (None, Some(_)) => {
            *before = now;
            Ok(())
        }
        (Some(_), _) | (None, None) => Ok(()),
    };
    merged(&mut drive.reduction, found.reduction, "reduction")?;
    merged(&mut drive.rotor_ratio, found.rotor_ratio, "gear ratio")?;
    merged(&mut drive.motor_inertia, found.motor_inertia, "motor inertia")?;
    merged(&mut drive.offset, found.offset, "offset")?;
    drive.inertia_element = drive.inertia_element.or(found.inertia_element);
    Ok(())
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
