//! Corrections of the channels of a signal, as values of its keys.

use toml::Value;

use thetahat_data::recording::{ChannelSource, Side, Unit};
use thetahat_ground::one_or_each::OneOrEach;
use thetahat_model::robot::Robot;

/// Relative difference of factors that are the same unit.
const SAME: f64 = 1e-9;

/// A key of a signal with its new value; none removes it.
pub(super) type Entry = (&'static str, Option<Value>);

/// Channels of a signal, and the robot whose joints they are of.
pub(super) struct Channels<'a> {
    pub(super) source: &'a ChannelSource,
    pub(super) robot: &'a Robot,
    pub(super) is_position: bool,
}

impl Channels<'_> {
    fn count(&self) -> usize {
        self.robot.coordinate_count()
    }

    /// Whether a motor turns a joint alone, so that a factor of its channel is one of the joint's.
    fn is_alone(&self, joint: usize) -> bool {
        let matrix = self.robot.transmission.matrix();
        (0..self.count()).all(|i| i == joint || (matrix.at(i, joint) == 0.0 && matrix.at(joint, i) == 0.0))
    }

    /// Whether factors of the joint's values are factors of the channel's.
    fn is_direct(&self, joint: usize) -> bool {
        let has_offset = self.is_position && self.robot.transmission.offset()[joint] != 0.0;
        self.source.side == Side::Joint || (self.is_alone(joint) && !has_offset)
    }

    /// The channels times a factor each: another unit where there is one, or else other gains.
    pub(super) fn scaled(&self, factors: &[f64]) -> Option<Vec<Entry>> {
        let changed = || (0..factors.len()).filter(|&j| factors[j] != 1.0);
        if factors.len() != self.count() || !changed().all(|j| self.is_direct(j)) {
            return None;
        }
        if !self.source.unit.fits(self.count()) {
            return None;
        }
        self.in_other_units(factors).map_or_else(|| self.with_gains(factors), |units| Some(vec![units]))
    }

    /// The units that have these factors in addition to the present ones.
    fn in_other_units(&self, factors: &[f64]) -> Option<Entry> {
        let units = self.source.unit.to_list(factors.len());
        if units.iter().any(|unit| unit.dimension() != units[0].dimension()) || self.is_mixed() {
            return None;
        }
        let other = |(unit, factor): (&Unit, &f64)| {
            let wanted = unit.to_si() * factor;
            let same = |u: &Unit| u.dimension() == unit.dimension() && (u.to_si() / wanted - 1.0).abs() < SAME;
            if *factor == 1.0 { Some(*unit) } else { Unit::ALL.into_iter().find(same) }
        };
        let found: Vec<Unit> = units.iter().zip(factors).map(other).collect::<Option<_>>()?;
        Some(("unit", Some(one_or_list(found.iter().map(|unit| Value::from(unit.symbol())).collect()))))
    }

    /// Whether some joints turn and others slide: their one unit is then that of SI.
    fn is_mixed(&self) -> bool {
        let mut kinds = self.robot.coordinates().map(|joint| joint.kind);
        let first = kinds.next();
        kinds.any(|kind| Some(kind) != first)
    }

    fn with_gains(&self, factors: &[f64]) -> Option<Vec<Entry>> {
        let given = self.source.gain.clone().unwrap_or(OneOrEach::One(1.0));
        if given.given().is_empty() || !given.fits(factors.len()) {
            return None;
        }
        let gains: Vec<f64> = given.to_list(factors.len()).iter().zip(factors).map(|(g, f)| rounded(g * f)).collect();
        if gains.iter().all(|gain| *gain == 1.0) {
            return Some(vec![("gain", None)]);
        }
        Some(vec![("gain", Some(one_or_list(gains.into_iter().map(Value::from).collect())))])
    }

    /// The channels in another order, with their units and gains: joint j has that of joint `order[j]`.
    pub(super) fn in_order(&self, order: &[usize]) -> Option<Vec<Entry>> {
        let columns = self.columns()?;
        if order.len() != columns.len() || order.iter().any(|&j| j >= columns.len()) {
            return None;
        }
        let texts = order.iter().map(|&j| Value::from(columns[j].clone())).collect();
        let mut entries: Vec<Entry> = vec![("columns", Some(Value::Array(texts)))];
        if let OneOrEach::Each(units) = &self.source.unit {
            entries.push(("unit", Some(one_or_list(order.iter().map(|&j| Value::from(units[j].symbol())).collect()))));
        }
        if let Some(OneOrEach::Each(gains)) = &self.source.gain
            && gains.len() == self.count()
        {
            entries.push(("gain", Some(one_or_list(order.iter().map(|&j| Value::from(gains[j])).collect()))));
        }
        Some(entries)
    }

    /// The channels without that of a joint.
    pub(super) fn without(&self, joint: usize) -> Option<Vec<Entry>> {
        let rest = |values: Vec<Value>| -> Vec<Value> {
            values.into_iter().enumerate().filter(|(j, _)| *j != joint).map(|(_, value)| value).collect()
        };
        let names = self.columns()?.into_iter().map(Value::from).collect();
        let mut entries: Vec<Entry> = vec![("columns", Some(Value::Array(rest(names))))];
        if let OneOrEach::Each(units) = &self.source.unit {
            let units = units.iter().map(|unit| Value::from(unit.symbol())).collect();
            entries.push(("unit", Some(Value::Array(rest(units)))));
        }
        if let Some(OneOrEach::Each(gains)) = &self.source.gain {
            let gains = gains.iter().map(|gain| Value::from(*gain)).collect();
            entries.push(("gain", Some(Value::Array(rest(gains)))));
        }
        Some(entries)
    }

    /// A name for each channel: those of the file, or the columns of its matrix.
    fn columns(&self) -> Option<Vec<String>> {
        let source = self.source;
        let n = self.count();
        let has_names = source.interleaved.is_none() && source.channel_column.is_none() && !source.channels_in_rows;
        match &source.columns[..] {
            columns if columns.len() == n && has_names && source.unit.fits(n) => Some(columns.to_vec()),
            [matrix] if n > 1 && has_names && source.unit.fits(n) => {
                Some((1..=n).map(|number| format!("{matrix}[{number}]")).collect())
            }
            _ => None,
        }
    }

    /// The other side of the gears.
    pub(super) fn at_side(&self, at_motor: bool) -> Option<Vec<Entry>> {
        let (side, name) = if at_motor { (Side::Motor, "motor") } else { (Side::Joint, "joint") };
        let gains = self.robot.transmission.drive_gain();
        let is_alone = self.is_position || gains.iter().all(|gain| *gain == 1.0);
        (self.source.side != side && is_alone).then(|| vec![("side", Some(Value::from(name)))])
    }
}

/// One value where all are the same, or else the list.
pub(super) fn one_or_list(values: Vec<Value>) -> Value {
    match values.first() {
        Some(first) if values.iter().all(|value| value == first) => first.clone(),
        Some(_) | None => Value::Array(values),
    }
}

/// A factor with six digits, as a user would write it.
fn rounded(factor: f64) -> f64 {
    format!("{factor:.5e}").parse().unwrap_or(factor)
}
