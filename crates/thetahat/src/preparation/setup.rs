use super::{
    error::PreparationError,
    recording::Recording,
    settings::{Case, PositionFilter, Settings, SignalOptions, Start},
};
use thetahat_estimation::signal::{self, Motion, SignalError, SmoothedMotion};
use thetahat_ground::{number::significant, series::Series};
use thetahat_model::{
    base_parameters::BaseParameters,
    dynamics::Model,
    robot::{ParameterTable, Robot},
};

/// A robot and how it is identified: what every step from recordings to results knows.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Setup<'a> {
    pub(crate) robot: &'a Robot,
    pub(crate) settings: &'a Settings,
}

/// The model of one friction model with its base parameters: what the problems of all recordings share.
#[derive(Debug, Clone)]
pub(crate) struct Basis {
    pub(crate) model: Model,
    pub(crate) base: BaseParameters,
}

impl Setup<'_> {
    /// The robot with a case's friction model.
    pub(crate) fn robot_for(&self, case: &Case) -> Robot {
        Robot { friction: case.friction.unwrap_or(self.robot.friction), ..self.robot.clone() }
    }

    /// The model and base parameters of the robot with a case's friction model.
    pub(crate) fn basis(&self, case: &Case) -> Result<Basis, PreparationError> {
        let model = Model::new(&self.robot_for(case));
        let base =
            BaseParameters::with_fixed(&model, &self.settings.parameters.exclude, &self.settings.parameters.fix)?;
        Ok(Basis { model, base })
    }

    /// Position, velocity and acceleration of recorded positions (III-A).
    pub(crate) fn band_pass(&self, position: &Series, sample_rate_hz: f64) -> Result<Motion, SignalError> {
        let options = &self.settings.signal;
        signal::band_pass(position, sample_rate_hz, options.filter_order, options.cutoff_hz, options.derivative)
    }

    /// Position, velocity and acceleration of a recording, as the settings ask for them.
    pub(crate) fn measured_motion(&self, recording: &Recording) -> Result<Motion, SignalError> {
        self.measured_motion_with_notes(recording).map(|(motion, _)| motion)
    }

    /// The same, and what the smoother found.
    pub(super) fn measured_motion_with_notes(
        &self,
        recording: &Recording,
    ) -> Result<(Motion, Option<String>), SignalError> {
        let SignalOptions { position, filter_order, .. } = self.settings.signal;
        match position {
            PositionFilter::Butterworth => Ok((self.band_pass(&recording.position, recording.sample_rate_hz)?, None)),
            PositionFilter::Smoother => {
                let found = smoothed(recording, filter_order)?;
                let note = self.note_of_smoother(&found);
                Ok((found.motion, Some(note)))
            }
        }
    }

    /// The cut-off and noise of each joint, and those without white noise.
    fn note_of_smoother(&self, found: &SmoothedMotion) -> String {
        let of_joint = |(hz, noise): (&f64, &f64)| format!("{} Hz, {}", significant(*hz, 3), significant(*noise, 2));
        let all: Vec<String> = found.cutoffs_hz.iter().zip(&found.noise).map(of_joint).collect();
        let joints = self.robot.coordinates().zip(&found.is_at_limit);
        let limited: Vec<&str> = joints.filter(|(_, is)| **is).map(|(joint, _)| joint.name.as_str()).collect();
        let no_noise = format!(
            "; the positions of {} have no white noise, as where they were filtered before: state a cutoff_hz instead",
            limited.join(", ")
        );
        format!(
            "positions by the smoother; cut-off and noise (rad or m) of each joint: {}{}",
            all.join("; "),
            if limited.is_empty() { "" } else { &no_noise }
        )
    }

    /// Standard parameters with which the iterations start.
    pub(crate) fn start(&self, table: &ParameterTable) -> Vec<f64> {
        let mut theta = self.robot.a_priori_parameters_for(table);
        match self.settings.estimation.start {
            Start::Cad => {}
            Start::MotorInertias => {
                let parameters = theta.iter_mut().zip(table.iter());
                parameters.filter(|(_, p)| !p.quantity.is_motor_inertia()).for_each(|(t, _)| *t = 0.0);
            }
        }
        theta
    }
}

impl Settings {
    /// The same with the cut-off of the smoother, if that is used: the highest of all joints and recordings.
    ///
    /// # Errors
    /// [`PreparationError::Signal`] for a recording that is too short.
    pub(crate) fn with_cutoff_of(mut self, recordings: &[Recording]) -> Result<Self, PreparationError> {
        match self.signal.position {
            PositionFilter::Butterworth => {}
            PositionFilter::Smoother => {
                for recording in recordings {
                    let cutoffs = smoothed(recording, self.signal.filter_order)?.cutoffs_hz;
                    self.signal.cutoff_hz = cutoffs.into_iter().fold(self.signal.cutoff_hz, f64::max);
                }
            }
        }
        Ok(self)
    }
}

fn smoothed(recording: &Recording, order: usize) -> Result<SmoothedMotion, SignalError> {
    signal::smooth_motion(&recording.position, &recording.gaps, recording.sample_rate_hz, order)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preparation::near_rest;

    const RATE_HZ: f64 = 200.0;

    fn smoother() -> Settings {
        let mut settings = Settings::new(0.0, 10);
        settings.signal.position = PositionFilter::Smoother;
        settings
    }

    /// Two joints: one with steps of its encoder, one without noise.
    fn recording() -> Recording {
        let motion = |k: usize, hz: f64| (std::f64::consts::TAU * hz * k as f64 / RATE_HZ).sin();
        let stepped = (0..2000).map(|k| (1e3 * motion(k, 0.5)).round() / 1e3).collect();
        let clean = (0..2000).map(|k| motion(k, 0.3)).collect();
        Recording::new(RATE_HZ, Series::side_by_side(&[stepped, clean]), Series::zeros(2000, 2))
    }

    #[test]
    fn the_cut_off_is_the_highest_of_the_joints() {
        let found = smoothed(&recording(), 4).unwrap();
        assert_eq!(found.is_at_limit, [false, true]);
        let settings = smoother().with_cutoff_of(&[recording()]).unwrap();
        assert_eq!(settings.signal.cutoff_hz, found.cutoffs_hz[1]);
        assert!(found.cutoffs_hz[0] < 20.0 && found.cutoffs_hz[1] > 0.39 * RATE_HZ, "{:?}", found.cutoffs_hz);
        // Steps of 1e-3 have a deviation of 1e-3 / sqrt(12).
        assert!((found.noise[0] / (1e-3 / 12_f64.sqrt()) - 1.0).abs() < 0.1, "{:?}", found.noise);
    }

    /// A mask is widened by a period of 20 Hz, 2.5 times the parallel filter's 8 Hz, and not of 80 Hz.
    #[test]
    fn a_mask_is_no_narrower_than_with_a_usual_filter() {
        let settings = smoother().with_cutoff_of(&[recording()]).unwrap();
        let position = recording().position;
        let rule = near_rest(&settings.signal, 0.01, [&position, &position], RATE_HZ).unwrap();
        assert_eq!(rule.widened, 10);
    }
}
