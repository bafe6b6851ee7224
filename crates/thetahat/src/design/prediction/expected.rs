//! Predicted intervals of the parameters, from the identification of noisy recordings of the motion.

use rand_chacha::ChaCha8Rng;

use crate::design::error::DesignError;
use crate::{
    preparation::{PreparationError, Recording, Settings},
    run::Identification,
};
use thetahat_estimation::{
    identification::{Fit, Method, Needs, Uncertainty, uncertainty},
    regression::Regression,
    signal::Spectrum,
    simulation::{NoisySignals, RecordingNoise, SignalNoise, random_numbers},
};
use thetahat_ground::{linear_algebra::norm, pool::in_parallel, series::Series};
use thetahat_model::{base_parameters::BaseParameter, robot::Robot};
use thetahat_report::results::PredictedRows;

/// The true motion of a robot and its torques, and how they will be recorded.
#[derive(Debug, Clone)]
pub struct ExpectedRecording<'a> {
    /// The robot.
    pub robot: &'a Robot,
    /// How the recording will be identified.
    pub settings: &'a Settings,
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// True positions.
    pub q: &'a Series,
    /// True torques of the joints: with the payload of the settings, which the robot then carries.
    pub tau: &'a Series,
    /// Standard deviation of the white noise on each torque.
    pub torque_noise: &'a [f64],
    /// The densities of the noise on each torque instead, where it is not white.
    pub torque_spectrum: Option<&'a Spectrum>,
    /// Standard deviation of the white noise on each position.
    pub position_noise: &'a [f64],
}

/// The expected uncertainty of each parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Expected {
    /// The parameters.
    pub parameters: Vec<BaseParameter>,
    /// Standard deviation: the root of the mean of the variances.
    pub standard_deviation: Vec<f64>,
    /// Mean half width of the 95 % intervals.
    pub half_width_95: Vec<f64>,
    /// The rows of one of the recordings: those of the others differ by their noise alone.
    pub rows: PredictedRows,
}

/// The estimate from one noisy recording.
#[derive(Debug, Clone)]
pub struct NoisyEstimate {
    /// The parameters.
    pub parameters: Vec<BaseParameter>,
    /// The estimate.
    pub fit: Fit,
    /// Its uncertainty.
    pub uncertainty: Uncertainty,
    /// The rows that it is estimated from.
    pub rows: PredictedRows,
}

/// Noisy recordings that the prediction averages: the uncertainty from each scatters by a few percent.
pub(in crate::design) const RECORDINGS: usize = 12;

impl ExpectedRecording<'_> {
    /// The method that is predicted: the first without a simulation that the settings list, or else least squares.
    #[must_use]
    pub fn method(&self) -> Method {
        predicted_method(self.settings)
    }

    /// The mean uncertainty over twelve noisy recordings.
    ///
    /// # Errors
    /// [`DesignError`] if a recording gives no estimate; `path` is the design file.
    pub fn predict(&self, path: &std::path::Path, seed: u64, threads: usize) -> Result<Expected, DesignError> {
        let estimated = in_parallel(RECORDINGS, threads, |number| self.estimate(path, seed, number as u64))
            .into_iter()
            .collect::<Result<Vec<_>, _>>()?;
        let count = estimated.len() as f64;
        let parameters = estimated.first().map_or_else(Vec::new, |e| e.parameters.clone());
        let mean = |of: &dyn Fn(&NoisyEstimate, usize) -> f64| -> Vec<f64> {
            (0..parameters.len()).map(|i| estimated.iter().map(|e| of(e, i)).sum::<f64>() / count).collect()
        };
        let variance = mean(&|e, i| e.uncertainty.standard_deviation[i].powi(2));
        let half =
            |e: &NoisyEstimate, i: usize| 0.5 * (e.uncertainty.interval_95[i][1] - e.uncertainty.interval_95[i][0]);
        Ok(Expected {
            standard_deviation: variance.into_iter().map(f64::sqrt).collect(),
            half_width_95: mean(&half),
            rows: estimated.first().map_or_else(PredictedRows::default, |e| e.rows.clone()),
            parameters,
        })
    }

    /// The estimate from one noisy recording: as `thetahat identify` makes it.
    ///
    /// # Errors
    /// [`DesignError`] where there is none.
    pub fn estimate(&self, path: &std::path::Path, seed: u64, number: u64) -> Result<NoisyEstimate, DesignError> {
        let refuse = |source: PreparationError| DesignError::Preparation { path: path.to_owned(), source };
        let method = self.method();
        let recording = self.recording(&mut random_numbers(seed, number));
        let identification = self.identification(vec![recording]).map_err(refuse)?;
        let problems = identification.problems(&mut |_| {}).map_err(refuse)?;
        let problem = &problems[0];
        let weights = problem.weights(self.settings, method, &[1.0]);
        let regression = problem.problem.regression.with_weights(weights);
        let no_estimate = |source| DesignError::NoEstimate { path: path.to_owned(), source };
        let fit = thetahat_estimation::identification::idim_ls(&regression, self.settings.estimation.variance)
            .map_err(no_estimate)?;
        let uncertainty = uncertainty(method, &regression, None, &fit).map_err(no_estimate)?;
        let rows = predicted_rows(&regression, &fit.prediction);
        Ok(NoisyEstimate { parameters: problem.problem.estimated.parameters().to_vec(), fit, uncertainty, rows })
    }
}

fn predicted_rows(regression: &Regression, prediction: &[f64]) -> PredictedRows {
    let rms = |rows: &Vec<f64>| norm(rows) / (rows.len().max(1) as f64).sqrt();
    let of_joints = |rows: &[f64]| regression.layout.by_joint(rows).iter().map(rms).collect();
    PredictedRows {
        count: regression.y.len(),
        residual_rms: of_joints(&regression.residual(prediction)),
        torque_rms: of_joints(&regression.y),
    }
}

impl ExpectedRecording<'_> {
    /// One noisy recording.
    pub(in crate::design) fn recording(&self, rng: &mut ChaCha8Rng) -> Recording {
        let white = SignalNoise::White(self.torque_noise);
        let coloured = |spectrum| SignalNoise::Coloured { spectrum, sample_rate_hz: self.sample_rate_hz };
        let torque = self.torque_spectrum.map_or(white, coloured);
        let noise = RecordingNoise { position: SignalNoise::White(self.position_noise), torque };
        let NoisySignals { position, torque } = noise.record(self.q.clone(), self.tau.clone(), rng);
        let payload = self.settings.payloads.first().map(|payload| payload.name.clone());
        let recording = Recording::new(self.sample_rate_hz, position, torque).with_reference(self.q.clone());
        Recording { payload, ..recording }
    }

    /// The identification of recordings by the predicted method.
    pub(in crate::design) fn identification(
        &self,
        recordings: Vec<Recording>,
    ) -> Result<Identification, PreparationError> {
        let settings = Settings { controller: None, cases: Vec::new(), ..self.settings.clone() };
        Identification::new(self.robot, recordings, settings.with_methods([self.method()]))
    }
}

/// The first method without a simulation that settings list, or else least squares.
pub(in crate::design) fn predicted_method(settings: &Settings) -> Method {
    let without = |m: &Method| m.needs() == Needs::Measurement;
    settings.estimation.methods.iter().copied().find(without).unwrap_or(Method::IDIM_LS)
}
