use std::ops::Range;

use crate::{control::ControllerDescription, signal::centred_hold};
use thetahat_ground::series::Series;
use thetahat_model::{
    base_parameters::{BaseParameter, BaseParameters},
    dynamics::Model,
    robot::{Joint, Robot},
};

/// How the recording is filtered, decimated and cut for the estimate.
#[derive(Debug, Clone, PartialEq)]
pub struct SignalSettings {
    /// Order of the Butterworth filter of the positions.
    pub filter_order: usize,
    /// Cut-off of that filter, Hz.
    pub cutoff_hz: f64,
    /// One of this many samples is kept.
    pub decimation: usize,
    /// The samples that are used, of the whole recording.
    pub window: Range<usize>,
}

/// One recording on the joint side, with the robot that it belongs to.
///
/// All series have one channel for each coordinate, the same number of samples, and finite values.
#[derive(Debug, Clone)]
pub struct Subject<'a> {
    /// The robot.
    pub robot: &'a Robot,
    /// Its model.
    pub model: &'a Model,
    /// The parameters that are to be estimated.
    pub base: &'a BaseParameters,
    /// All base parameters: the checks of the fit must not see the residual of a smaller set.
    pub all: &'a BaseParameters,
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Time stamps as recorded, s, before any resampling.
    pub time_s: Option<&'a [f64]>,
    /// Positions as recorded, rad or m.
    pub position: &'a Series,
    /// Whether positions or torques were recorded on the motor side and converted by the transmission.
    pub geared: bool,
    /// Recorded velocities, if any, rad/s or m/s.
    pub velocity: Option<&'a Series>,
    /// Torques as recorded, if any, N m or N; without them there is no fit to check.
    pub torque: Option<&'a Series>,
    /// Part of a sample period for which a torque is stated to be held.
    pub held_part_of_step: f64,
    /// The recorded reference, if any, rad or m.
    pub reference: Option<&'a Series>,
    /// Rms deviation of the motion from the reconstructed reference, if there is one, per coordinate, rad
    /// or m.
    pub reconstructed_deviation: Option<&'a [f64]>,
    /// Whether a signal was added to the controller's output.
    pub added_signal: bool,
    /// Samples, counted in the window, that make no rows: gaps and the samples that the filter affects. Ascending ranges.
    pub left_out: &'a [Range<usize>],
    /// Whether samples near rest are left out as well.
    pub rests_left_out: bool,
    /// The column of times and its rate, Hz, if another rate is stated.
    pub contradicting_times: Option<(&'a str, f64)>,
    /// Filters, decimation and window.
    pub signal: SignalSettings,
    /// The controller that is simulated, if any.
    pub controller: Option<&'a ControllerDescription>,
}

impl Subject<'_> {
    /// The recorded torques in the window.
    pub(super) fn torque_in_window(&self) -> Option<Series> {
        self.torque.map(|torque| torque.window(self.signal.window.clone()))
    }

    /// The torques centred on the samples of the window: as recorded, or means of torques that are held.
    pub(super) fn centred_torque_in_window(&self) -> Option<Series> {
        let centred = |torque: &Series| centred_hold(torque, self.held_part_of_step);
        self.torque.map(|torque| centred(torque).window(self.signal.window.clone()))
    }

    /// The joint of a coordinate, both from zero.
    pub(super) fn joint(&self, coordinate: usize) -> &Joint {
        &self.robot.joints[self.robot.joint_of(coordinate)]
    }

    /// The number, from one, of a coordinate's joint among all joints, as in the names of parameters.
    pub(super) fn joint_number(&self, coordinate: usize) -> usize {
        self.robot.joint_of(coordinate) + 1
    }

    /// The estimated parameters, with their columns, of the joint of a coordinate, its link and its motor, and of its mimic
    /// joints.
    pub(super) fn parameters_of(&self, coordinate: usize) -> impl Iterator<Item = (usize, &BaseParameter)> {
        let (joints, leader) = (&self.robot.joints, self.robot.joint_of(coordinate));
        let is_own = move |joint: usize| joint == leader || joints[joint].follows().any(|share| share.of == leader);
        let table = self.model.parameter_table();
        let columns = self.base.parameters().iter().enumerate();
        columns.filter(move |(_, parameter)| is_own(table.get(parameter.kept).number - 1))
    }

    /// Names of [`Self::parameters_of`].
    pub(super) fn parameter_names_of(&self, coordinate: usize) -> Vec<String> {
        self.parameters_of(coordinate).map(|(_, parameter)| parameter.name.clone()).collect()
    }
}
