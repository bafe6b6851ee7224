use serde::Deserialize;

use crate::experiment::column_names::Signal;
use thetahat_data::recording::{Side, Unit};
use thetahat_ground::one_or_each::{self, OneOrEach};

/// What a driver writes into a log. It is a prior for the proposal: what the user states, and what the names of columns say
/// themselves, has priority.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Driver {
    /// The name by which it was asked for.
    #[serde(skip)]
    pub name: String,
    /// The robots and the interface.
    pub title: String,
    /// What it means by torque or effort.
    pub effort: String,
    /// Where this is documented, shown with what was assumed.
    #[serde(default)]
    pub source: Vec<String>,
    /// What the user should know, a sentence each.
    #[serde(default)]
    pub note: Vec<String>,
    /// The joints of numbered columns, in their order. A `*` at the start stands for any prefix. None means that the order is the
    /// robot's.
    #[serde(default)]
    pub joints: Vec<String>,
    /// The number of the first joint in the names of columns; none means 0 where a column has that number, and 1 otherwise.
    pub first_number: Option<usize>,
    /// Samples per second, where the driver has one rate: for a log without times.
    pub rate_hz: Option<f64>,
    /// The time.
    pub time: Option<DriverTime>,
    /// The positions.
    pub position: DriverSignal,
    /// The velocities.
    pub velocity: Option<DriverSignal>,
    /// The torques or drive signals.
    pub torque: Option<DriverSignal>,
    /// The reference of the positions.
    pub reference: Option<DriverSignal>,
    /// The controller, for a log without torques.
    pub controller: Option<DriverController>,
}

/// The columns of the time.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DriverTime {
    /// Their names; the first that a log has is taken.
    pub columns: Vec<String>,
}

/// The columns of a signal, and what they are.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DriverSignal {
    /// Their names, with `*` for the number or the name of a joint. Of several, the first that a log has is taken.
    pub columns: Vec<String>,
    /// The unit of the values times `scale`; `1` for positions in counts, whose angle the user fills in.
    pub unit: Unit,
    /// The factor from the values to the unit: steps of a device, or -1 for a torque of the opposite sign.
    #[serde(default = "one")]
    pub scale: f64,
    /// Torque at the joint per unit, where the unit is a drive's: one for all, or one for each of `joints`. None is for the user to
    /// fill in.
    #[serde(default)]
    pub gain: Option<OneOrEach<f64>>,
    /// The side of the gears.
    #[serde(default)]
    pub side: Side,
}

/// A position controller: a PD law at the joints.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DriverController {
    /// One for all joints or one for each, N m/rad.
    #[serde(deserialize_with = "one_or_each::list")]
    pub position_gain: Vec<f64>,
    /// Likewise, N m s/rad.
    #[serde(deserialize_with = "one_or_each::list")]
    pub velocity_gain: Vec<f64>,
}

fn one() -> f64 {
    1.0
}

impl Driver {
    /// What it has of a signal; times have names alone.
    pub(in crate::experiment) fn signal(&self, signal: Signal) -> Option<&DriverSignal> {
        match signal {
            Signal::Position => Some(&self.position),
            Signal::Velocity => self.velocity.as_ref(),
            Signal::Torque => self.torque.as_ref(),
            Signal::Reference => self.reference.as_ref(),
            Signal::Time => None,
        }
    }

    /// The names of the columns of a signal.
    pub(in crate::experiment) fn columns(&self, signal: Signal) -> &[String] {
        match signal {
            Signal::Time => self.time.as_ref().map_or(&[], |time| &time.columns),
            Signal::Position | Signal::Velocity | Signal::Torque | Signal::Reference => {
                self.signal(signal).map_or(&[], |of| &of.columns)
            }
        }
    }
}
