use super::{
    super::column_names,
    request::ProposalRequest,
    source::{Chosen, Source},
};
use crate::{
    linear_algebra::Matrix,
    recording::{Side, Unit},
    robot::{JointKind, Robot},
};

/// Joint angles beyond this, rad, are no joint angles in rad: more than two turns.
const LARGEST_ANGLE: f64 = 4.0 * std::f64::consts::PI;

/// Unit and side of a signal, and where they are known from.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Measured {
    pub(super) unit: Unit,
    pub(super) side: Side,
    pub(super) why: String,
}

/// What the units of a file's signals are told from.
pub(super) struct Units<'u, 'a> {
    pub(super) request: &'u ProposalRequest,
    pub(super) robot: &'u Robot,
    pub(super) source: Source<'a>,
}

impl Units<'_, '_> {
    pub(super) fn of_position(&self, columns: &[Chosen<'_>]) -> Measured {
        let joint = |unit, why: &str| Measured { unit, side: self.named_side(columns), why: why.to_owned() };
        let largest = largest(columns);
        match (self.request.position_unit, self.named(columns)) {
            (Some(unit), _) => self.on_a_side(unit, columns, "as stated"),
            (None, Some(unit)) => self.on_a_side(unit, columns, "from the names"),
            _ if self.is_prismatic() => joint(Unit::Metre, "a guess: linear joints"),
            _ if self.source.is_bag() => joint(Unit::Radian, "as JointState has it"),
            _ if largest > LARGEST_ANGLE && self.fits_behind_the_gears(columns) => {
                let why = "a guess: too large for rad on the joint side, not behind the robot's gears".to_owned();
                Measured { unit: Unit::Radian, side: Side::Motor, why }
            }
            _ if largest > LARGEST_ANGLE => joint(Unit::Degree, "a guess: too large for rad on the joint side"),
            _ => joint(Unit::Radian, "a guess from the range"),
        }
    }

    /// The torques are on the side that their names say, or else on that of the positions.
    pub(super) fn of_torque(&self, columns: &[Chosen<'_>], position: &Measured) -> Measured {
        let side = match (self.named_side(columns), position.side) {
            (Side::Joint, Side::Joint) => Side::Joint,
            (Side::Motor, _) | (_, Side::Motor) => Side::Motor,
        };
        let (unit, why) = match (self.request.torque_unit, self.named(columns)) {
            (Some(unit), _) => (unit, "as stated"),
            (None, Some(unit @ (Unit::Ampere | Unit::Milliampere | Unit::Volt))) => (unit, drive_unit(side)),
            (None, Some(unit)) => (unit, "from the names"),
            _ if self.source.is_bag() => (self.effort(), "as JointState has it"),
            _ => (self.effort(), "a guess: nothing says it"),
        };
        Measured { unit, side, why: why.to_owned() }
    }

    /// The unit of velocities that goes with that of the positions.
    pub(super) fn of_velocity(&self, position: &Measured) -> Measured {
        let unit = if position.unit == Unit::Degree {
            Unit::DegreePerSecond
        } else if position.unit == Unit::Millimetre {
            Unit::MillimetrePerSecond
        } else if self.is_prismatic() {
            Unit::MetrePerSecond
        } else {
            Unit::RadianPerSecond
        };
        Measured { unit, side: position.side, why: "as the positions".to_owned() }
    }

    fn effort(&self) -> Unit {
        if self.is_prismatic() { Unit::Newton } else { Unit::NewtonMetre }
    }

    fn is_prismatic(&self) -> bool {
        self.robot.coordinates().all(|j| j.kind == JointKind::Prismatic)
    }

    /// A known unit on the side that the names say, or else the motors' where angles are too large for joints.
    fn on_a_side(&self, unit: Unit, columns: &[Chosen<'_>], why: &str) -> Measured {
        let too_large = unit == Unit::Radian && largest(columns) > LARGEST_ANGLE && self.fits_behind_the_gears(columns);
        let side = if too_large { Side::Motor } else { self.named_side(columns) };
        Measured { unit, side, why: why.to_owned() }
    }

    /// The side as stated, or else the motors' where the names say so and the robot has gears.
    fn named_side(&self, columns: &[Chosen<'_>]) -> Side {
        if let Some(side) = self.request.side {
            return side;
        }
        let mut names = columns.iter().map(|c| c.name.clone()).chain([self.source.stem()]);
        if self.has_gears() && names.any(|name| column_names::says_motor(&name)) { Side::Motor } else { Side::Joint }
    }

    fn has_gears(&self) -> bool {
        let n = self.robot.coordinate_count();
        *self.robot.transmission.matrix() != Matrix::identity(n)
    }

    /// Whether angles of motors in rad are angles of joints behind the robot's gears.
    fn fits_behind_the_gears(&self, columns: &[Chosen<'_>]) -> bool {
        if let Some(side) = self.request.side {
            return side == Side::Motor;
        }
        let ends = |of: fn(&crate::recording::ChannelSummary) -> Option<f64>| {
            columns.iter().flat_map(|c| c.channels).map(of).collect::<Option<Vec<f64>>>()
        };
        let (Some(least), Some(most), true) = (ends(|c| c.min), ends(|c| c.max), self.has_gears()) else {
            return false;
        };
        let motors = crate::series::Series::from_values(least.len(), [least, most].concat());
        let joints = self.robot.transmission.joint_positions(&motors);
        joints.values().iter().all(|q| q.abs() <= LARGEST_ANGLE)
    }

    /// The unit in the name of the first column, or in the file's where the columns say nothing.
    fn named(&self, columns: &[Chosen<'_>]) -> Option<Unit> {
        let column = columns.first()?;
        let name = if column_names::is_silent(&column.name) { self.source.stem() } else { column.name.clone() };
        column_names::read(&name).and_then(|r| r.unit)
    }
}

fn drive_unit(side: Side) -> &'static str {
    match side {
        Side::Motor => "from the names; the robot's drive_gain is to turn it into torque",
        Side::Joint => "from the names; add gain = [...], torque per unit, one for each joint",
    }
}

fn largest(columns: &[Chosen<'_>]) -> f64 {
    let [least, most] = range(columns);
    least.abs().max(most.abs())
}

/// The least and the largest value of some columns.
pub(super) fn range(columns: &[Chosen<'_>]) -> [f64; 2] {
    let channels = || columns.iter().flat_map(|c| c.channels);
    let least = channels().filter_map(|c| c.min).fold(f64::INFINITY, f64::min);
    let most = channels().filter_map(|c| c.max).fold(f64::NEG_INFINITY, f64::max);
    [least, most]
}
