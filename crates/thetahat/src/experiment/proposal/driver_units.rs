//! Units, signs and gains as the driver has them, and what in the log contradicts it.

use super::{
    super::{
        column_names::Signal,
        driver::{Driver, DriverSignal},
    },
    gains::{gain_of_position, gain_of_torque},
    source::SelectedColumn,
    unit_names::matching,
    units::{LARGEST_ANGLE, Measured, Units},
    written::{Written, dimensions, spelt_out},
};
use std::f64::consts::TAU;
use thetahat_data::recording::{Dimension, Side, Unit};
use thetahat_ground::{one_or_each::OneOrEach, series::Series};
use thetahat_model::robot::{Joint, JointKind};

/// By how much a position may exceed a limit of its joint before it is said, rad or m.
const BEYOND: f64 = 0.1;

impl Units<'_, '_> {
    /// What the driver has of a signal; `None` if the columns are not the driver's, or their names spell another unit out.
    pub(super) fn of_driver(&self, signal: Signal, columns: &[SelectedColumn<'_>]) -> Option<Measured> {
        let (driver, of) = self.driver_signal(signal, columns)?;
        if spelt_unit(signal, columns).is_some_and(|unit| unit != of.unit) {
            return None;
        }
        let is_counted = signal != Signal::Torque && of.unit.dimension() == Dimension::Dimensionless;
        let unit = if is_counted { Unit::Radian } else { of.unit };
        let kinds = self.joints.iter().map(|joint| joint.kind);
        let measured = Measured {
            units: kinds.map(|kind| matching(unit, kind)).collect(),
            side: self.request.side.unwrap_or(of.side),
            why: format!("as the driver has it ({})", driver.name),
            gain: is_counted.then(|| gain_of_position("counts")),
            factor: (of.scale != 1.0).then_some(OneOrEach::One(of.scale)),
            unit_guessed: false,
        };
        Some(if signal == Signal::Torque { self.with_gain_of_driver(measured, of, columns) } else { measured })
    }

    /// The driver and what it has of a signal, where all columns are its own.
    fn driver_signal(&self, signal: Signal, columns: &[SelectedColumn<'_>]) -> Option<(&Driver, &DriverSignal)> {
        let (driver, _) = self.source.driver?;
        let is_of_driver = |c: &SelectedColumn<'_>| self.source.by_driver(&c.name).is_some_and(|r| r.signal == signal);
        columns.iter().all(is_of_driver).then_some((driver, driver.signal(signal)?))
    }

    /// The torque of a drive's unit is by the driver's gain, by the robot's drive gain, or for the user to fill in.
    fn with_gain_of_driver(&self, measured: Measured, of: &DriverSignal, columns: &[SelectedColumn<'_>]) -> Measured {
        if matches!(of.unit.dimension(), Dimension::Torque | Dimension::Force) {
            return measured;
        }
        if let Some(gain) = of.gain.as_ref().and_then(|gain| self.gain_of(gain, columns)) {
            return Measured { factor: Some(scaled(&gain, of.scale)), ..measured };
        }
        if measured.side == Side::Motor && self.has_drive_gain() {
            let why = format!("{}; the robot's drive_gain is to turn it into torque", measured.why);
            return Measured { why, ..measured };
        }
        let scale = (of.scale != 1.0).then_some(of.scale);
        Measured { gain: gain_of_torque(of.unit, None, measured.side, scale), ..measured }
    }

    /// The gains of the columns: the driver's list is in the order of its joints.
    fn gain_of(&self, gain: &OneOrEach<f64>, columns: &[SelectedColumn<'_>]) -> Option<OneOrEach<f64>> {
        let gains = match gain {
            OneOrEach::One(gain) => return Some(OneOrEach::One(*gain)),
            OneOrEach::Each(gains) => gains,
        };
        let place = |c: &SelectedColumn<'_>| {
            self.source.columns().find(|other| other.name == c.name).map(|c| self.source.place(c))
        };
        let of_column = |c: &SelectedColumn<'_>| gains.get(place(c).flatten()?).copied();
        let by_place: Option<Vec<f64>> = columns.iter().map(of_column).collect();
        let channels: usize = columns.iter().map(|c| c.channels.len()).sum();
        by_place.or_else(|| (gains.len() == channels).then(|| gains.clone())).map(OneOrEach::Each)
    }

    /// What the log says against the driver, as a sentence.
    pub(super) fn contradiction(
        &self,
        signal: Signal,
        columns: &[SelectedColumn<'_>],
        measured: &Measured,
    ) -> Option<String> {
        let (driver, of) = self.driver_signal(signal, columns)?;
        let name = &driver.name;
        match spelt_unit(signal, columns).filter(|unit| *unit != of.unit) {
            Some(unit) => {
                Some(format!("the columns are named in {unit}, the driver {name} has {}: {unit} is taken", of.unit))
            }
            None if signal == Signal::Position => self.position_out_of_range(columns, measured),
            None => None,
        }
    }

    /// Positions that no joint can have, or that lie outside of the limits of one.
    fn position_out_of_range(&self, columns: &[SelectedColumn<'_>], measured: &Measured) -> Option<String> {
        if measured.gain.is_some() {
            return None;
        }
        let channels = columns.iter().flat_map(|c| c.channels).enumerate();
        let ends = channels.map(|(n, channel)| Some([channel.min?, channel.max?].map(|end| end * measured.to_si(n))));
        let ends: Vec<[f64; 2]> = ends.collect::<Option<_>>()?;
        let ends = match measured.side {
            Side::Joint => ends,
            Side::Motor => self.after_the_gears(&ends),
        };
        let joints = ends.iter().zip(&self.joints);
        joints.into_iter().find_map(|([a, b], joint)| outside(joint, a.min(*b), a.max(*b)))
    }

    /// The ends of the joints' motions from those of the motors'; empty if a motor moves several joints.
    fn after_the_gears(&self, ends: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let transmission = &self.robot.transmission;
        if transmission.ratios().is_none() || ends.len() != transmission.joints() {
            return Vec::new();
        }
        let of_motors: Vec<f64> = [0, 1].into_iter().flat_map(|end| ends.iter().map(move |ends| ends[end])).collect();
        let joints = transmission.joint_positions(&Series::shaped(ends.len(), of_motors));
        (0..ends.len()).map(|j| [0, 1].map(|end| joints.sample(end)[j])).collect()
    }
}

/// The unit that the names of columns spell out.
fn spelt_unit(signal: Signal, columns: &[SelectedColumn<'_>]) -> Option<Unit> {
    columns.iter().find_map(|column| match spelt_out(&column.name, signal) {
        Some(Written::Unit(unit)) => Some(unit).filter(|unit| dimensions(signal).contains(&unit.dimension())),
        Some(Written::Counts(_) | Written::Unknown(_)) | None => None,
    })
}

fn scaled(gain: &OneOrEach<f64>, scale: f64) -> OneOrEach<f64> {
    match gain {
        OneOrEach::One(gain) => OneOrEach::One(scale * gain),
        OneOrEach::Each(gains) => OneOrEach::Each(gains.iter().map(|gain| scale * gain).collect()),
    }
}

/// Why a joint cannot have gone from one position to another; whole turns do not count.
fn outside(joint: &Joint, low: f64, high: f64) -> Option<String> {
    let unit = match joint.kind {
        JointKind::Revolute => "rad",
        JointKind::Prismatic => "m",
    };
    let says = |what: String| Some(format!("joint `{}` goes from {low:.2} to {high:.2} {unit}{what}", joint.name));
    let is_endless = joint.limits.lower.zip(joint.limits.upper).is_none_or(|(lower, upper)| lower >= upper);
    if joint.kind == JointKind::Revolute && high - low > 2.0 * LARGEST_ANGLE && !is_endless {
        return says(", which is too far for a joint: is the unit another one?".to_owned());
    }
    let (lower, upper) = joint.limits.lower.zip(joint.limits.upper).filter(|(lower, upper)| lower < upper)?;
    let turns = match joint.kind {
        JointKind::Revolute => (0.5 * (lower + upper - low - high) / TAU).round() * TAU,
        JointKind::Prismatic => 0.0,
    };
    if low + turns > lower - BEYOND && high + turns < upper + BEYOND {
        return None;
    }
    says(format!(", and its limits are {lower:.2} and {upper:.2}: unit, sign or zero may be others"))
}
