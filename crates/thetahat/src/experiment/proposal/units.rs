use super::{
    super::column_names::{self, Signal},
    error::ProposalError,
    gains::{gain_of_position, gain_of_torque},
    request::ProposalRequest,
    set_aside::says_external,
    source::{SelectedColumn, Source},
    unit_names::{Misfit, NamedUnits, fits, hint_of_file, matching, named_units, require_units_of_joints},
};
use thetahat_data::recording::{ChannelSummary, Dimension, Side, Unit};
use thetahat_ground::{linear_algebra::Matrix, one_or_each::OneOrEach};
use thetahat_model::robot::{Joint, JointKind, Quantity, Robot};

/// Joint angles beyond this, rad, are no joint angles in rad: more than two turns.
pub(super) const LARGEST_ANGLE: f64 = 4.0 * std::f64::consts::PI;
/// The same of joints that turn without end: in degrees it would be little motion, in rad ten turns.
const LARGEST_OF_CONTINUOUS: f64 = 20.0 * std::f64::consts::PI;

/// Times the range of a joint's limits by which no joint turns: its values are in another unit.
const RANGES: f64 = 3.0;

/// Travel beyond which, m, no joint without limits slides.
const LARGEST_TRAVEL: f64 = 20.0;

/// Joints of a pendulum.
const FEW: usize = 2;
/// By how much a position may exceed a limit of its joint, rad or m.
const BEYOND: f64 = 0.1;
/// Travel of all joints below which a recording is none of a motion, rad or m.
const HARDLY: f64 = 0.1;

/// Units and side of a signal, and where they are known from.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Measured {
    /// One for each channel.
    pub(super) units: Vec<Unit>,
    pub(super) side: Side,
    pub(super) why: String,
    /// What the gain is that the user must give, where the unit alone gives no torque or position.
    pub(super) gain: Option<String>,
    /// The gain where it is known: one for all channels, or one for each.
    pub(super) factor: Option<OneOrEach<f64>>,
    /// Whether some channels may as well be in another unit, which the verdict is to say.
    pub(super) unit_guessed: bool,
}

impl Measured {
    fn new(units: Vec<Unit>, side: Side, why: &str) -> Self {
        Self { units, side, why: why.to_owned(), gain: None, factor: None, unit_guessed: false }
    }

    /// The factor from the values of a channel to rad or m, N m or N.
    pub(super) fn to_si(&self, channel: usize) -> f64 {
        let factor = match &self.factor {
            None => 1.0,
            Some(OneOrEach::One(factor)) => *factor,
            Some(OneOrEach::Each(factors)) => factors.get(channel).copied().unwrap_or(1.0),
        };
        factor * self.units.get(channel).map_or(1.0, |unit| unit.to_si())
    }

    /// The unit of all channels, or that of each where they differ.
    pub(super) fn unit(&self) -> OneOrEach<Unit> {
        match &self.units[..] {
            [first, others @ ..] if others.iter().all(|unit| unit == first) => OneOrEach::One(*first),
            units => OneOrEach::Each(units.to_vec()),
        }
    }
}

/// Whether a joint travels too far in m, and not in mm.
fn is_in_mm(channel: &ChannelSummary, joint: &Joint) -> bool {
    let Some((least, most)) = channel.min.zip(channel.max) else { return false };
    let limits = joint.limits.lower.zip(joint.limits.upper).filter(|(lower, upper)| upper > lower);
    let allowed = limits.map_or(LARGEST_TRAVEL, |(lower, upper)| upper - lower);
    let travel = most - least;
    travel > RANGES * allowed && Unit::Millimetre.to_si() * travel < RANGES * allowed
}

/// Whether a joint turns by so little in degrees that its values may be in rad: it moves, and by less than two pi.
fn may_be_in_rad(channel: &ChannelSummary, joint: &Joint) -> bool {
    let Some((least, most)) = channel.min.zip(channel.max) else { return false };
    let largest = least.abs().max(most.abs());
    joint.kind == JointKind::Revolute
        && (HARDLY..LARGEST_ANGLE / 2.0).contains(&(most - least))
        && largest < LARGEST_ANGLE
}

/// The evidence for the units of a file's signals.
pub(super) struct Units<'u, 'a> {
    pub(super) request: &'u ProposalRequest,
    pub(super) source: Source<'a>,
    pub(super) robot: &'u Robot,
    /// The joints of the channels.
    pub(super) joints: Vec<&'u Joint>,
}

impl Units<'_, '_> {
    pub(super) fn of_position(&self, columns: &[SelectedColumn<'_>]) -> Result<Measured, ProposalError> {
        if let (None, Some(of_driver)) = (&self.request.position_unit, self.of_driver(Signal::Position, columns)) {
            return Ok(of_driver);
        }
        let named = self.named(Signal::Position, columns);
        match (&self.request.position_unit, named) {
            (Some(unit), named) => Ok(self.on_a_side(self.stated("position", unit, named)?, columns, "as stated")),
            (None, Err(misfit)) => Err(self.refused("position", misfit)),
            (None, Ok(None)) => Ok(self.with_lengths_in_mm(self.guessed_position(columns), columns)),
            (None, Ok(Some(NamedUnits { units, is_said, why, counts }))) => {
                let measured = self.on_a_side(units, columns, why);
                self.require_joints(&measured, columns)
                    .and_then(|()| self.require_range(&measured, &is_said, columns))
                    .map_err(|misfit| self.refused("position", misfit))?;
                Ok(Measured { gain: counts.map(|word| gain_of_position(&word)), ..measured })
            }
        }
    }

    /// The torques are on the side that their names say, or else on that of the positions; drive signals, which the robot's drive gains
    /// turn into torque, are on the motors' side.
    pub(super) fn of_torque(
        &self,
        columns: &[SelectedColumn<'_>],
        position: &Measured,
    ) -> Result<Measured, ProposalError> {
        if let (None, Some(of_driver)) = (&self.request.torque_unit, self.of_driver(Signal::Torque, columns)) {
            return Ok(of_driver);
        }
        let is_drive = self.has_drive_gain() && self.request.torque_unit.is_none() && !self.says_torque(columns);
        let is_of_motors = is_drive && self.request.side.is_none();
        let side = match (self.named_side(columns), position.side) {
            (Side::Joint, Side::Joint) if !is_of_motors => Side::Joint,
            (Side::Joint | Side::Motor, _) => Side::Motor,
        };
        let named = self.named(Signal::Torque, columns);
        let is_unsaid = self.request.torque_unit.is_none() && matches!(named, Ok(None)) && !is_drive;
        let (units, why, counts) = match (&self.request.torque_unit, named) {
            (Some(unit), named) => (self.stated("torque", unit, named)?, "as stated".to_owned(), None),
            (None, Err(misfit)) => return Err(self.refused("torque", misfit)),
            (None, Ok(Some(NamedUnits { units, why, counts, is_said: _ }))) => (units, why.to_owned(), counts),
            (None, Ok(None)) if is_drive => {
                let why = "a guess: the robot has a drive_gain, and the name says no torque";
                (columns.iter().flat_map(|c| c.channels).map(|_| Unit::Volt).collect(), why.to_owned(), None)
            }
            (None, Ok(None)) => (self.each(Unit::NewtonMetre), self.why_torque(columns), None),
        };
        // Without masses nothing says how large torques are.
        let unit_guessed = is_unsaid && !self.source.is_bag() && !has_masses(self.robot);
        let measured = Measured { unit_guessed, ..Measured::new(units, side, &why) };
        if self.request.torque_unit.is_none() {
            self.require_joints(&measured, columns).map_err(|misfit| self.refused("torque", misfit))?;
        }
        Ok(self.with_gain_of_torque(measured, counts.as_deref()))
    }

    /// The units of another signal: as its names say, or else those that go with the positions.
    pub(super) fn of_other(
        &self,
        signal: Signal,
        columns: &[SelectedColumn<'_>],
        position: &Measured,
    ) -> Result<Measured, Misfit> {
        if let Some(of_driver) = self.of_driver(signal, columns) {
            return Ok(of_driver);
        }
        let as_positions = || {
            position.units.iter().map(|unit| match signal {
                Signal::Velocity => velocity_unit(*unit),
                Signal::Position | Signal::Reference | Signal::Torque | Signal::Time => *unit,
            })
        };
        let measured = match self.named(signal, columns)? {
            Some(named) => Measured::new(named.units, position.side, named.why),
            None => Measured::new(as_positions().collect(), position.side, self.why_as_positions(columns)),
        };
        self.require_joints(&measured, columns).map(|()| measured)
    }

    /// Why torques are taken for torques that no name of a column says to be any.
    fn why_torque(&self, columns: &[SelectedColumn<'_>]) -> String {
        if columns.iter().any(|column| says_external(&column.name)) {
            return "a guess: the log does not say. The names say external torques, and those lack the robot's own dynamics: \
                    they identify nothing. Name measured torques with --torque if the log has any"
                .to_owned();
        }
        match hint_of_file(&self.source, Signal::Torque, columns) {
            Some(unit) if matches!(unit.dimension(), Dimension::Torque | Dimension::Force) => {
                format!(
                    "a guess: only the name of the file says {unit}; where they are in {unit}, write unit = \"{unit}\""
                )
            }
            Some(unit) => format!(
                "a guess: only the name of the file says {}; where they are in {unit}, write unit = \"{unit}\" and gain = [...], \
                 the torque per {unit} of each column",
                if unit == Unit::Volt { "a voltage" } else { "a current" }
            ),
            None if self.source.is_bag() => "as ROS has it (REP 103)".to_owned(),
            None => "a guess: the log does not say".to_owned(),
        }
    }

    fn why_as_positions(&self, columns: &[SelectedColumn<'_>]) -> &'static str {
        let stem = self.source.stem();
        let is_unnamed = |name: &str| {
            let name = if column_names::is_silent(name) { &stem } else { name };
            column_names::says_only_desired(name)
        };
        match columns.iter().any(|column| is_unnamed(&column.name)) {
            true => "as the positions, a guess: the names say desired values, but not of which signal",
            false => "as the positions",
        }
    }

    fn named(&self, signal: Signal, columns: &[SelectedColumn<'_>]) -> Result<Option<NamedUnits>, Misfit> {
        named_units(signal, columns, &self.kinds())
    }

    /// The units that the user stated for each joint; of one for all, joints of the other kind have the one of their names, or SI.
    fn stated(
        &self,
        signal: &'static str,
        unit: &OneOrEach<Unit>,
        named: Result<Option<NamedUnits>, Misfit>,
    ) -> Result<Vec<Unit>, ProposalError> {
        let joints = self.joints.len();
        let unit = match unit {
            OneOrEach::One(unit) => *unit,
            OneOrEach::Each(units) if units.len() == joints => return Ok(units.clone()),
            OneOrEach::Each(units) => return Err(ProposalError::UnitCount { signal, found: units.len(), joints }),
        };
        let named = named.ok().flatten().map(|named| named.units);
        let of_name = |channel: usize, kind| {
            named.as_ref().and_then(|units| units.get(channel).copied()).filter(|unit| fits(*unit, kind))
        };
        let of_kind = |(channel, kind): (usize, JointKind)| match fits(unit, kind) {
            true => unit,
            false => of_name(channel, kind).unwrap_or_else(|| matching(unit, kind)),
        };
        Ok(self.kinds().into_iter().enumerate().map(of_kind).collect())
    }

    fn guessed_position(&self, columns: &[SelectedColumn<'_>]) -> Measured {
        let joint = |unit, why: &str| Measured::new(self.each(unit), self.named_side(columns), why);
        let largest = self.largest_angle(columns);
        if self.kinds().iter().all(|kind| *kind == JointKind::Prismatic) {
            joint(Unit::Metre, "a guess: linear joints")
        } else if self.source.is_bag() {
            joint(Unit::Radian, "as ROS has it (REP 103)")
        } else if largest > LARGEST_ANGLE && self.fits_after_the_gears(columns) {
            let why = "a guess: too large for angles of joints in rad, but in range for angles of motors";
            Measured::new(self.each(Unit::Radian), Side::Motor, why)
        } else if self.turns_in_degrees(columns).is_some_and(|turns| turns > LARGEST_ANGLE) {
            let why = "a guess: too large for rad and for deg of joints with limits";
            Measured { gain: Some(gain_of_position("counts, or turns of motors")), ..joint(Unit::Radian, why) }
        } else if largest > LARGEST_ANGLE && !self.is_of_turns(columns) {
            let in_degrees = joint(Unit::Degree, "a guess: too large for rad on the joint side");
            match self.perhaps_in_rad(columns) {
                Some(hint) => Measured { why: format!("{}; {hint}", in_degrees.why), unit_guessed: true, ..in_degrees },
                None => in_degrees,
            }
        } else {
            let hint = hint_of_file(&self.source, Signal::Position, columns).filter(|unit| *unit != Unit::Radian);
            let why = hint.map_or_else(
                || "a guess from the range".to_owned(),
                |unit| format!("a guess from the range, though the name of the file says {unit}: where that is so, write unit = \"{unit}\""),
            );
            joint(Unit::Radian, &why)
        }
    }

    /// What to write where some joints' angles are in rad, though those of others cannot be; `None` where all turn far in degrees.
    fn perhaps_in_rad(&self, columns: &[SelectedColumn<'_>]) -> Option<String> {
        let channels = columns.iter().flat_map(|c| c.channels).zip(&self.joints);
        let is_in_rad: Vec<bool> = channels.map(|(channel, joint)| may_be_in_rad(channel, joint)).collect();
        let named = self.joints.iter().zip(&is_in_rad).filter(|(_, is_in_rad)| **is_in_rad);
        let names: Vec<&str> = named.map(|(joint, _)| joint.name.as_str()).collect();
        if names.is_empty() {
            return None;
        }
        let unit = |(kind, is_in_rad): (JointKind, &bool)| {
            format!("\"{}\"", matching(if *is_in_rad { Unit::Radian } else { Unit::Degree }, kind).symbol())
        };
        let units: Vec<String> = self.kinds().into_iter().zip(&is_in_rad).map(unit).collect();
        let turns = if names.len() == 1 { "turns" } else { "turn" };
        let (names, units) = (names.join(", "), units.join(", "));
        Some(format!("{names} hardly {turns} in deg: in rad, write unit = [{units}], else leave unit_guessed out"))
    }

    /// Checks that angles without a unit cannot be in another one than those of which the names say it.
    fn require_range(
        &self,
        measured: &Measured,
        is_said: &[bool],
        columns: &[SelectedColumn<'_>],
    ) -> Result<(), Misfit> {
        if measured.side == Side::Motor {
            return Ok(());
        }
        let channels = columns.iter().flat_map(|c| c.channels.iter().map(move |channel| (&c.name, channel)));
        let filled =
            channels.zip(&self.joints).zip(measured.units.iter().zip(is_said)).filter(|(_, (_, said))| !**said);
        for (((name, channel), joint), (unit, _)) in filled {
            let Some((least, most)) = channel.min.zip(channel.max) else { continue };
            let is_too_large = *unit == Unit::Radian && least.abs().max(most.abs()) > LARGEST_ANGLE;
            let is_unclear = is_too_large || (*unit == Unit::Degree && may_be_in_rad(channel, joint));
            if is_unclear {
                let problem = format!(
                    "without a unit, and its values, {least:.3} to {most:.3}, may be in another one than {unit}, that of the others"
                );
                return Err(Misfit { column: name.clone(), problem, is_of_a_joint: false });
            }
        }
        Ok(())
    }

    /// Joints that slide are in mm where they would travel too far in m, and not in mm.
    fn with_lengths_in_mm(&self, mut measured: Measured, columns: &[SelectedColumn<'_>]) -> Measured {
        if measured.side == Side::Motor || self.source.is_bag() {
            return measured;
        }
        let mut some = false;
        let channels = columns.iter().flat_map(|c| c.channels).zip(&self.joints);
        for (unit, (channel, joint)) in measured.units.iter_mut().zip(channels) {
            if *unit == Unit::Metre && is_in_mm(channel, joint) {
                (*unit, some) = (Unit::Millimetre, true);
            }
        }
        if some {
            measured.why += ", and too large for m where a joint slides";
        }
        measured
    }

    /// On the motors' side the robot's drive gains turn a drive's unit into torque, where it has any.
    fn with_gain_of_torque(&self, measured: Measured, counts: Option<&str>) -> Measured {
        let of_drive = |unit: &&Unit| !matches!(unit.dimension(), Dimension::Torque | Dimension::Force);
        let Some(&unit) = measured.units.iter().find(of_drive) else { return measured };
        match measured.side {
            Side::Motor if self.has_drive_gain() => {
                let why = format!("{}; the robot's drive_gain is to turn it into torque", measured.why);
                Measured { why, ..measured }
            }
            Side::Motor | Side::Joint => {
                Measured { gain: gain_of_torque(unit, counts, measured.side, None), ..measured }
            }
        }
    }

    pub(super) fn has_drive_gain(&self) -> bool {
        self.robot.transmission.drive_gain().iter().any(|gain| *gain != 1.0)
    }

    /// Whether the names of columns, or where they say nothing that of the file, say that they hold torques or forces.
    fn says_torque(&self, columns: &[SelectedColumn<'_>]) -> bool {
        columns.iter().any(|c| column_names::says_torque(&c.name)) || column_names::says_torque(&self.source.stem())
    }

    fn require_joints(&self, measured: &Measured, columns: &[SelectedColumn<'_>]) -> Result<(), Misfit> {
        match measured.side {
            Side::Motor => Ok(()),
            Side::Joint => require_units_of_joints(&measured.units, columns, self.joints.iter().copied()),
        }
    }

    fn refused(&self, signal: &'static str, misfit: Misfit) -> ProposalError {
        let Misfit { column, problem, is_of_a_joint } = misfit;
        ProposalError::UnclearUnit { file: self.source.file.to_owned(), column, problem, signal, is_of_a_joint }
    }

    /// A unit for each channel, that of SI for joints of the other kind.
    fn each(&self, unit: Unit) -> Vec<Unit> {
        self.kinds().into_iter().map(|kind| matching(unit, kind)).collect()
    }

    fn kinds(&self) -> Vec<JointKind> {
        self.joints.iter().map(|joint| joint.kind).collect()
    }

    /// The largest value of the joints that turn.
    fn largest_angle(&self, columns: &[SelectedColumn<'_>]) -> f64 {
        let turning =
            columns.iter().flat_map(|c| c.channels).zip(self.kinds()).filter(|(_, k)| *k == JointKind::Revolute);
        let ends = turning.flat_map(|(channel, _)| [channel.min, channel.max]).flatten();
        ends.fold(0.0, |largest, end| end.abs().max(largest))
    }

    /// The largest angle, rad, by which a joint turns that cannot, were its values in degrees: some times the range of its limits.
    fn turns_in_degrees(&self, columns: &[SelectedColumn<'_>]) -> Option<f64> {
        let channels = columns.iter().flat_map(|c| c.channels).zip(&self.joints);
        let turned = channels.filter(|(_, joint)| joint.kind == JointKind::Revolute).filter_map(|(channel, joint)| {
            let turned = Unit::Degree.to_si() * (channel.max? - channel.min?);
            let range = joint.limits.upper? - joint.limits.lower?;
            (range > 0.0 && turned > RANGES * range).then_some(turned)
        });
        turned.max_by(f64::total_cmp)
    }

    /// Whether these are one or two joints, of which only those without limits go beyond two turns in rad, and none beyond ten. An arm of
    /// more joints that turn so far is none.
    fn is_of_turns(&self, columns: &[SelectedColumn<'_>]) -> bool {
        let channels = columns.iter().flat_map(|c| c.channels).zip(&self.joints);
        let largest = |channel: &ChannelSummary| {
            [channel.min, channel.max].into_iter().flatten().fold(0.0, |most: f64, end| most.max(end.abs()))
        };
        self.joints.len() <= FEW
            && channels.into_iter().all(|(channel, joint)| {
                let is_endless = joint.limits.lower.zip(joint.limits.upper).is_none_or(|(lower, upper)| lower >= upper);
                largest(channel) <= if is_endless { LARGEST_OF_CONTINUOUS } else { LARGEST_ANGLE }
            })
    }

    /// Known units on the side that the names say, or else the motors' where angles are too large for joints.
    fn on_a_side(&self, units: Vec<Unit>, columns: &[SelectedColumn<'_>], why: &str) -> Measured {
        let is_in_rad = self.kinds().iter().zip(&units).all(|(k, u)| *k == JointKind::Prismatic || *u == Unit::Radian);
        let too_large = is_in_rad && self.largest_angle(columns) > LARGEST_ANGLE && self.fits_after_the_gears(columns);
        let side = if too_large { Side::Motor } else { self.named_side(columns) };
        Measured::new(units, side, why)
    }

    /// The side as stated, or else the motors' where the names say so and the robot has gears.
    fn named_side(&self, columns: &[SelectedColumn<'_>]) -> Side {
        if let Some(side) = self.request.side {
            return side;
        }
        let mut names = columns.iter().map(|c| c.name.clone()).chain([self.source.stem()]);
        let says_motor = self.has_gears() && names.any(|name| column_names::says_motor(&name));
        if says_motor && !self.moves_like_joints(columns) { Side::Motor } else { Side::Joint }
    }

    /// Whether positions lie within the joints' limits, and would hardly move the joints after the gears: then they are of joints,
    /// whatever their names say.
    fn moves_like_joints(&self, columns: &[SelectedColumn<'_>]) -> bool {
        let is_position =
            columns.iter().all(|c| column_names::read(&c.name).is_some_and(|r| r.signal == Signal::Position));
        let channels: Vec<&ChannelSummary> = columns.iter().flat_map(|c| c.channels).collect();
        let ends: Option<Vec<[f64; 2]>> = channels.iter().map(|c| Some([c.min?, c.max?])).collect();
        let Some(ends) = ends.filter(|ends| is_position && ends.len() == self.joints.len()) else { return false };
        let to_si = if self.largest_angle(columns) > LARGEST_ANGLE { Unit::Degree.to_si() } else { 1.0 };
        let inside = |([low, high], joint): (&[f64; 2], &&Joint)| {
            let [low, high] = [low * to_si, high * to_si];
            joint.limits.lower.is_none_or(|lower| low > lower - BEYOND)
                && joint.limits.upper.is_none_or(|upper| high < upper + BEYOND)
        };
        let travels = ends.iter().map(|[low, high]| (high - low) * to_si).collect();
        let after =
            self.robot.transmission.joint_velocities(&thetahat_ground::series::Series::shaped(ends.len(), travels));
        ends.iter().zip(&self.joints).all(inside) && after.values().iter().all(|travel| travel.abs() < HARDLY)
    }

    fn has_gears(&self) -> bool {
        let n = self.robot.coordinate_count();
        *self.robot.transmission.matrix() != Matrix::identity(n)
    }

    /// Whether angles of motors in rad give possible angles of joints after the robot's gears.
    fn fits_after_the_gears(&self, columns: &[SelectedColumn<'_>]) -> bool {
        if let Some(side) = self.request.side {
            return side == Side::Motor;
        }
        let ends = |of: fn(&thetahat_data::recording::ChannelSummary) -> Option<f64>| {
            columns.iter().flat_map(|c| c.channels).map(of).collect::<Option<Vec<f64>>>()
        };
        let (Some(least), Some(most), true) = (ends(|c| c.min), ends(|c| c.max), self.has_gears()) else {
            return false;
        };
        let motors = thetahat_ground::series::Series::shaped(least.len(), [least, most].concat());
        let joints = self.robot.transmission.joint_positions(&motors);
        joints.values().iter().all(|q| q.abs() <= LARGEST_ANGLE)
    }
}

/// The unit of velocities that goes with one of positions.
fn velocity_unit(position: Unit) -> Unit {
    if position == Unit::Degree {
        Unit::DegreePerSecond
    } else if position == Unit::Revolution {
        Unit::RevolutionPerSecond
    } else if position == Unit::Millimetre {
        Unit::MillimetrePerSecond
    } else if position.dimension() == Dimension::Length {
        Unit::MetrePerSecond
    } else {
        Unit::RadianPerSecond
    }
}

/// The least and the largest value of some columns.
pub(super) fn range(columns: &[SelectedColumn<'_>]) -> [f64; 2] {
    let channels = || columns.iter().flat_map(|c| c.channels);
    let least = channels().filter_map(|c| c.min).fold(f64::INFINITY, f64::min);
    let most = channels().filter_map(|c| c.max).fold(f64::NEG_INFINITY, f64::max);
    [least, most]
}
/// Whether the description has an inertial value of any link.
fn has_masses(robot: &Robot) -> bool {
    let table = robot.parameter_table();
    let values = robot.a_priori_parameters_for(&table);
    table.iter().zip(values).any(|(parameter, value)| matches!(parameter.quantity, Quantity::Link(_)) && value != 0.0)
}
