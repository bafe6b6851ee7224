use std::collections::BTreeMap;

use super::{file::Driver, pattern::Pattern};
use crate::experiment::column_names::{Reading, Signal, number, words};

const SIGNALS: [Signal; 5] = [Signal::Time, Signal::Position, Signal::Velocity, Signal::Torque, Signal::Reference];

/// What the columns of a log hold, as a driver has it.
#[derive(Debug, Clone, Default)]
pub(in crate::experiment) struct DriverColumns {
    readings: BTreeMap<String, Reading>,
}

impl DriverColumns {
    /// Of each signal the columns of the first name that the log has.
    pub(in crate::experiment) fn of(driver: &Driver, columns: &[&str], joints: &[String]) -> Self {
        let joints: Vec<Vec<String>> = joints.iter().map(|joint| words(joint)).collect();
        let found = |name: &String| {
            let pattern = Pattern::of(name)?;
            let found: Vec<&str> = columns.iter().copied().filter(|column| pattern.matches(column, &joints)).collect();
            (!found.is_empty()).then_some(found)
        };
        let mut readings = BTreeMap::new();
        for signal in SIGNALS {
            let found = driver.columns(signal).iter().find_map(found).unwrap_or_default();
            let reading = |column: &str| Reading { signal, number: number(column) };
            readings.extend(found.into_iter().map(|column| (column.to_owned(), reading(column))));
        }
        Self { readings }
    }

    /// What a column holds; `None` if it is not the driver's.
    pub(in crate::experiment) fn reading(&self, column: &str) -> Option<&Reading> {
        self.readings.get(column)
    }

    /// Whether the log has the driver's columns of a signal.
    pub(in crate::experiment) fn has(&self, signal: Signal) -> bool {
        self.readings.values().any(|reading| reading.signal == signal)
    }

    /// How many columns are the driver's.
    pub(in crate::experiment) fn len(&self) -> usize {
        self.readings.len()
    }

    /// The least number in the names of a signal's columns.
    pub(in crate::experiment) fn least_number(&self, signal: Signal) -> Option<usize> {
        self.readings.values().filter(|reading| reading.signal == signal).filter_map(|reading| reading.number).min()
    }
}

impl Driver {
    /// The place among `joints` of the one that a joint of the robot is; `None` if it is none of them.
    pub(in crate::experiment) fn place_of(&self, joint: &str) -> Option<usize> {
        self.joints.iter().position(|known| match known.strip_prefix('*') {
            Some(end) => joint.ends_with(end),
            None => joint == known,
        })
    }
}
