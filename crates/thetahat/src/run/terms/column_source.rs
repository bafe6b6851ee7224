//! Columns of torque terms that the robot does not have yet, in the rows of a problem.

use crate::preparation::{FilteredRecording, PreparationError, Problem, Setup};
use thetahat_estimation::signal::Motion;
use thetahat_ground::linear_algebra::Matrix;
use thetahat_model::{
    dynamics::{Model, Sign},
    robot::{Quantity, Robot, TermColumn},
};

/// A problem with what its rows were made of.
#[derive(Clone, Copy)]
pub(in crate::run) struct ColumnSource<'a> {
    pub(in crate::run) setup: Setup<'a>,
    pub(in crate::run) recordings: &'a [&'a FilteredRecording],
    pub(in crate::run) problem: &'a Problem,
}

impl ColumnSource<'_> {
    /// The robot.
    pub(in crate::run) fn robot(&self) -> &Robot {
        self.setup.robot
    }

    /// The observation matrix of columns that stand after the robot's terms.
    pub(in crate::run) fn columns(&self, columns: Vec<TermColumn>) -> Result<Matrix, PreparationError> {
        let before = self.robot().terms.len();
        let mut robot = self.robot().clone();
        robot.terms.extend(columns);
        let model = Model::new(&robot);
        let is_new = |quantity| matches!(quantity, Quantity::Term(term) if term.column >= before);
        let parameters = model.parameter_table().iter().enumerate();
        let indices: Vec<usize> = parameters.filter(|(_, p)| is_new(p.quantity)).map(|(i, _)| i).collect();
        let names = robot.channels();
        let mut matrices = Vec::new();
        for (number, filtered) in self.recordings.iter().enumerate() {
            let recorded = filtered.recording.channels_named(&names, robot.coordinate_count())?;
            let rate = filtered.recording.sample_rate_hz;
            let recorded = recorded.map(|c| self.setup.band_pass(&c, rate)).transpose()?;
            let channels = recorded.map(|motion| motion.q.window(filtered.window.clone()));
            let assembly = self.problem.assembly_of(number, &model, &indices).with_channels(channels);
            let Motion { q, dq, ddq } = &filtered.motion;
            matrices.push(assembly.observation_matrix(q, dq, ddq, Sign::Exact)?);
        }
        Ok(self.problem.regression.layout.stack_matrices(matrices))
    }

    /// The largest velocity of a coordinate in the windows.
    pub(in crate::run) fn peak_velocity(&self, coordinate: usize) -> f64 {
        let velocities = self.recordings.iter().map(|r| &r.motion.dq);
        let peak = velocities.flat_map(|dq| (0..dq.len()).map(move |k| dq.sample(k)[coordinate].abs()));
        peak.fold(0.0, f64::max)
    }
}
