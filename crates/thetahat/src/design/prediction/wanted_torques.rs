//! The torques that a design is for: those of the user's own motion.

use crate::design::{
    error::DesignError,
    motions::sums::Derivatives,
    prediction::{prior_data::inverse, recording_time::recording_time},
    search::{criterion::product_trace, information::Information, optimiser::Problem},
    text::description::Design,
};
use crate::preparation::{PreparationError, Recording, Setup};
use thetahat_data::recording::{Dimension, read_channels};
use thetahat_ground::{
    linear_algebra::{Matrix, dot},
    series::Series,
};
use thetahat_model::{
    base_parameters::BaseParameters,
    dynamics::{Model, Sign},
    robot::JointKind,
};
use thetahat_report::results::PredictedTorques;

/// A motion's mean squares of torques by base parameters.
pub(in crate::design) struct WantedTorques {
    /// The mean of `Phi^T Phi` over its samples.
    pub(in crate::design) squares: Matrix,
    /// Root mean square of the a-priori torques, all joints together.
    rms: f64,
    file: String,
}

impl Design {
    /// The motion of `[wanted] motion`.
    pub(in crate::design) fn wanted_torques(
        &self,
        model: &Model,
        base: &BaseParameters,
    ) -> Result<Option<WantedTorques>, DesignError> {
        let Some(source) = &self.file.wanted.motion else { return Ok(None) };
        let refuse = |source| DesignError::WantedMotion { path: self.path.clone(), source: Box::new(source) };
        let dimensions: Vec<(&str, Dimension)> = self
            .robot
            .coordinates()
            .map(|joint| match joint.kind {
                JointKind::Revolute => (joint.name.as_str(), Dimension::Angle),
                JointKind::Prismatic => (joint.name.as_str(), Dimension::Length),
            })
            .collect();
        source.require_dimensions("motion", &dimensions).map_err(refuse)?;
        let position = read_channels(source, self.path.parent().unwrap_or("".as_ref())).map_err(refuse)?;
        let joints = self.robot.coordinate_count();
        let expected = format!("{joints} columns, one for each joint that moves");
        self.require(position.channels() == joints, "[wanted] motion", &expected, position.channels())?;
        let torque = Series::zeros(position.len(), joints);
        let recording = Recording::new(self.file.sample_rate_hz, position, torque);
        let setup = Setup { robot: &self.robot, settings: &self.settings };
        let motion = setup.measured_motion(&recording).map_err(|source| self.refuse(PreparationError::from(source)))?;
        let ones = vec![1.0; joints];
        let information = Information::new(model, &base.columns(), &ones);
        let squares = information.of([&motion.q, &motion.dq, &motion.ddq], 1.0 / motion.q.len() as f64, Sign::Exact);
        let theta = base.from_standard(&self.robot.a_priori_parameters());
        let rms = dot(&theta, &squares.times(&theta)).sqrt();
        let expected = "a motion along which the a-priori robot has torques";
        self.require(rms > 0.0 && rms.is_finite(), "[wanted] motion", expected, rms)?;
        Ok(Some(WantedTorques { squares, rms, file: source.file.display().to_string() }))
    }

    /// The error of the wanted torques after the recording of a motion, and how long it takes until it is as small as wanted.
    pub(in crate::design) fn predicted_torques(
        &self,
        wanted: &WantedTorques,
        problem: &Problem,
        motion: &Derivatives,
    ) -> Option<PredictedTorques> {
        let prior = problem.information.prior();
        let percent = |information: &Matrix| -> Option<f64> {
            Some(100.0 * product_trace(&wanted.squares, &inverse(information)?).sqrt() / wanted.rms)
        };
        let own = problem.information.of_motion_alone(motion);
        let after = prior.map_or_else(|| own.clone(), |prior| prior.plus(&own, 1.0));
        let wanted_percent = self.file.wanted.torque_percent;
        Some(PredictedTorques {
            file: wanted.file.clone(),
            before_percent: prior.and_then(percent),
            percent: percent(&after)?,
            wanted_percent,
            seconds: recording_time(self.file.duration_s, prior, &own, |information| {
                percent(information).is_some_and(|percent| percent <= wanted_percent)
            }),
        })
    }
}
