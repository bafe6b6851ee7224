//! How the torques of a recording were measured, judged by an estimate: their noise, lag and low-pass.

use super::{error::FilterChoiceError, low_pass::low_pass_hz};
use crate::preparation::{FilteredRecording, Problem};
use thetahat_estimation::{
    identification::Method,
    signal::{Motion, Padding, SecondOrderSections, SignalError, central_difference, delayed, zero_phase},
};
use thetahat_ground::{linear_algebra::dot, series::Series};
use thetahat_model::dynamics::{DynamicParameters, Model, Sign, State, Workspace};

/// Significance threshold of a lag, in standard deviations of independent rows.
const SURE: f64 = 8.0;
/// Longest lag, samples.
const LONGEST: f64 = 2.0;
/// Order of the low-pass that imitates the recorder's.
const ORDER: usize = 2;

/// How torques were recorded.
pub(super) struct Recorder {
    /// The residual of the samples in rows, scaled to the power that it would have without the masked samples.
    pub(super) noise: Series,
    /// Samples by which the torques are late.
    lag: f64,
    /// Where the torques were low-passed, Hz.
    low_pass_hz: Option<f64>,
}

impl Recorder {
    /// The recorder as standard parameters show it; `columns` are those of the regression that are estimated.
    pub(super) fn of(
        problem: &Problem,
        filtered: &FilteredRecording,
        columns: &[usize],
        theta: &[f64],
    ) -> Result<Self, FilterChoiceError> {
        let torque = filtered.centred_torque();
        let left = residual_of(&torque, &filtered.motion, &problem.model, theta, Sign::Exact);
        let lag = lag(problem, columns, &torque, &left)?;
        let noise = match &problem.masks[0] {
            None => left,
            Some(mask) => as_if_unmasked(&mask.applied_to(&left), &mask.left_out()),
        };
        let low_pass_hz = low_pass_hz(&torque, filtered.recording.sample_rate_hz);
        Ok(Self { noise, lag, low_pass_hz })
    }

    /// Torques as they would have been recorded.
    pub(super) fn recorded(&self, torque: Series, rate: f64) -> Result<Series, SignalError> {
        let late = if self.lag == 0.0 { torque } else { delayed(&torque, &vec![self.lag; torque.channels()]) };
        let Some(cutoff_hz) = self.low_pass_hz else { return Ok(late) };
        zero_phase(&SecondOrderSections::butterworth_lowpass(ORDER, cutoff_hz, rate)?, &late, Padding::Matlab)
    }
}

/// Noise with zeros in a part of each channel's samples, with the power it has where it is not zero.
fn as_if_unmasked(noise: &Series, left_out: &[f64]) -> Series {
    let scales: Vec<f64> = left_out.iter().map(|part| (1.0 - part).max(f64::MIN_POSITIVE).sqrt().recip()).collect();
    let scaled = noise.values().iter().enumerate().map(|(i, value)| value * scales[i % scales.len()]);
    Series::shaped(noise.channels(), scaled.collect())
}

/// Samples by which torques are late, to first order; zero if it is not significant: `y(t) = y0(t - d)` leaves `-d dy0/dt`.
fn lag(problem: &Problem, columns: &[usize], torque: &Series, left: &Series) -> Result<f64, FilterChoiceError> {
    let regression = problem.regression.with_columns(columns);
    let influence = Method::IDIM_LS.influence(&regression, None)?;
    let predicted = torque.values().iter().zip(left.values()).map(|(y, e)| y - e).collect();
    let slope = central_difference(&Series::shaped(torque.channels(), predicted), 1.0);
    let rows_of = |series: &Series| -> Result<Vec<f64>, FilterChoiceError> {
        let rows = problem.assembly(0).measurement_vector(series)?;
        let explained = regression.x.times(&influence.transpose_times(&rows));
        Ok(rows.iter().zip(explained).map(|(row, explained)| row - explained).collect())
    };
    let (slope, left) = (rows_of(&slope)?, rows_of(left)?);
    let (mut along, mut squares) = (0.0, 0.0);
    let rows = problem.assembly(0).rows_per_joint();
    for (slope, left) in slope.chunks(rows).zip(left.chunks(rows)) {
        let variance = (dot(left, left) / rows as f64).max(f64::MIN_POSITIVE);
        along += dot(slope, left) / variance;
        squares += dot(slope, slope) / variance;
    }
    let lag = (-along / squares.max(f64::MIN_POSITIVE)).clamp(-LONGEST, LONGEST);
    Ok(if lag.abs() * squares.sqrt() > SURE { lag } else { 0.0 })
}

/// What a model leaves of torques.
pub(crate) fn residual_of(torque: &Series, motion: &Motion, model: &Model, theta: &[f64], sign: Sign) -> Series {
    let (parameters, mut workspace) = (DynamicParameters::sorted(model, theta), Workspace::new(model));
    let mut left = torque.clone();
    let mut tau = vec![0.0; torque.channels()];
    for k in 0..torque.len() {
        let state = State::new(motion.q.sample(k), motion.dq.sample(k));
        let ddq = motion.ddq.sample(k);
        model.inverse_dynamics(&parameters, state, ddq, sign, &mut workspace, &mut tau);
        left.sample_mut(k).iter_mut().zip(&tau).for_each(|(left, tau)| *left -= tau);
    }
    left
}

#[cfg(test)]
mod tests {
    use super::{super::separated::separated, *};
    use crate::preparation::{Case, ParameterChoice, Recording, Settings, Setup};
    use thetahat_ground::linear_algebra::Matrix;
    use thetahat_model::robot::Robot;

    const RATE_HZ: f64 = 500.0;

    /// Swings of a TX40 with the torques of its a-priori parameters, late by some samples.
    fn late(samples: f64) -> (Robot, Recording) {
        let robot = Robot::parse(include_str!("../../demo/tx40.toml"), std::path::Path::new("tx40.toml")).unwrap();
        let model = Model::new(&robot);
        let swing = |k: usize, j: usize| 0.6 * ((1.1 + 0.3 * j as f64) * k as f64 / RATE_HZ + j as f64).sin();
        let q = Matrix::from_fn(8000, 6, swing);
        let q = Series::side_by_side(&(0..6).map(|j| q.column(j).to_vec()).collect::<Vec<_>>());
        let dq = central_difference(&q, RATE_HZ);
        let motion = Motion { ddq: central_difference(&dq, RATE_HZ), dq, q };
        let theta = vec![0.3; model.parameter_table().len()];
        let minus = residual_of(&Series::zeros(8000, 6), &motion, &model, &theta, Sign::Exact);
        let torque = Series::shaped(6, minus.values().iter().map(|v| -v).collect());
        let torque = delayed(&torque, &[samples; 6]);
        (robot, Recording::new(RATE_HZ, motion.q, torque))
    }

    #[test]
    fn a_lag_is_found_to_a_part_of_a_sample() {
        for truth in [0.0, 0.4, -1.2] {
            let (robot, recording) = late(truth);
            let settings = Settings::new(20.0, 20);
            let setup = Setup { robot: &robot, settings: &settings };
            let filtered = setup.filter(recording).unwrap();
            let basis = setup.basis(&Case::nominal()).unwrap();
            let problem = setup.problem_on(basis, &[&filtered], &ParameterChoice::Base).unwrap();
            let (columns, theta) = separated(&problem.regression).unwrap();
            let mut base = vec![0.0; problem.base.len()];
            columns.iter().zip(theta).for_each(|(&c, value)| base[c] = value);
            let recorder = Recorder::of(&problem, &filtered, &columns, &problem.base.to_standard(&base)).unwrap();
            assert!((recorder.lag - truth).abs() < 0.02, "{} for {truth}", recorder.lag);
            assert_eq!(recorder.low_pass_hz, None);
        }
    }

    #[test]
    fn noise_has_the_power_of_the_samples_that_are_left() {
        let noise = as_if_unmasked(&Series::shaped(2, vec![0.0, 1.0, 3.0, 1.0]), &[0.75, 0.0]);
        assert_eq!(noise.values(), [0.0, 1.0, 6.0, 1.0]);
    }
}
