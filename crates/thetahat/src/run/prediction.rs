//! The torques that identified parameters predict for another motion.

use std::{f64::consts::TAU, sync::Arc};

use super::{
    continued::continued,
    model::{kinds, largest},
};
use crate::preparation::{
    Basis, Case, FilteredRecording, Mask, NamedMask, PreparationError, Recording, Settings, Setup, SignalOptions,
};
use thetahat_estimation::{
    identification::{Assembly, RowMask},
    regression::{Regression, RowLayout, relative_error_percent},
    signal::{Motion, noise_densities},
};
use thetahat_ground::series::Series;
use thetahat_model::{
    dynamics::{Model, Sign},
    regressor::Regressor,
    robot::JointKind,
};
use thetahat_report::results::{EstimateSource, ModelResult, Prediction, Verdict, VerdictReason};

/// Base parameters of a case by name, the method that gave them, and the verdict on them.
pub(crate) struct Identified<'a> {
    pub(crate) case: &'a Case,
    pub(crate) source: EstimateSource,
    /// The model that gave them; without it the sign of friction is exact.
    pub(crate) model: Option<&'a ModelResult>,
    pub(crate) parameters: Vec<(String, f64)>,
    /// The verdict on them, and why it is not good.
    pub(crate) verdict: (Verdict, Vec<VerdictReason>),
}

/// Predicts the torques of a recording in its window; parameters that are not of the robot count for nothing.
///
/// # Errors
/// [`PreparationError`] where the recording cannot be filtered.
pub(crate) fn predict_torques(
    setup: Setup<'_>,
    identified: &Identified<'_>,
    recording: Recording,
) -> Result<Prediction, PreparationError> {
    let settings = setup.settings.clone().with_cutoff_of(std::slice::from_ref(&recording))?;
    let setup = Setup { settings: &settings, ..setup };
    let basis = setup.basis(identified.case)?;
    let column = |name: &String| basis.base.parameters().iter().find(|p| p.name == *name).map(|p| p.kept);
    let known = identified.parameters.iter().filter_map(|(name, value)| Some((column(name)?, *value)));
    let (columns, theta) = known.unzip();
    if let Some(payload) = setup.payload_of(&recording)?.filter(|p| !p.is_known()) {
        let key = format!("[[payload]] {}: mass_kg", payload.name);
        return Err(PreparationError::value(&key, "given, to predict the torques of a recording with it", "missing"));
    }
    let has_torque = recording.torque.is_some();
    let filtered = setup.filter(recording)?;
    let sign = identified.model.map_or(Sign::Exact, |model| Sign::Smooth(model.transition()));
    let cutoff_hz = identified.model.map_or(setup.settings.signal.cutoff_hz, |m| widest_cutoff(setup, m, &filtered));
    let predictor = Predictor { setup, basis, columns, theta, sign };
    let torque = with_known(predictor.torques(&filtered, cutoff_hz)?, &filtered);
    let mask = filtered.mask(&predictor.basis.model, &predictor.columns);
    let near_rest = mask.as_ref().map_or_else(|| vec![0.0; filtered.recording.position.channels()], |m| m.left_out());
    let signal = &setup.settings.signal;
    let every_sample = SignalOptions { mask: Mask::Named(NamedMask::None), ..*signal };
    let (rows, prediction) = predictor.rows(&filtered, signal, mask)?;
    let (all_rows, all_predicted) = predictor.rows(&filtered, &every_sample, None)?;
    let rms = |p: &Vec<f64>| (p.iter().map(|v| v * v).sum::<f64>() / p.len() as f64).sqrt();
    Ok(Prediction {
        source: identified.source,
        case: identified.case.name.clone(),
        sample_rate_hz: filtered.recording.sample_rate_hz,
        torque,
        relative_error_percent: has_torque.then(|| relative_error_percent(&rows.y, &prediction)),
        joint_relative_error_percent: joint_errors(has_torque, &rows, &prediction),
        all_samples_error_percent: has_torque.then(|| relative_error_percent(&all_rows.y, &all_predicted)),
        joint_all_samples_error_percent: joint_errors(has_torque, &all_rows, &all_predicted),
        near_rest,
        measured: filtered.recording.torque.clone().map(|measured| with_known(measured, &filtered)),
        left_open_percent: identified.model.map(|m| left_open(m, &all_rows, &all_predicted)).unwrap_or_default(),
        beyond: identified.model.map(|m| beyond(m, &filtered.motion, &kinds(setup))).unwrap_or_default(),
        rms: rows.layout.by_joint(&prediction).iter().map(rms).collect(),
        window_s: filtered.window_s(),
        joints: setup.robot.coordinates().map(|j| j.name.clone()).collect(),
        verdict: identified.verdict.0,
        verdict_reasons: identified.verdict.1.clone(),
    })
}

/// The deviation of each joint's torque, percent of its rms, that the covariance of the model's parameters leaves:
/// `100 sqrt(sum_k x_k C x_k^T / sum_k tau_k^2)` over the joint's rows `x_k`.
fn left_open(model: &ModelResult, rows: &Regression, prediction: &[f64]) -> Vec<f64> {
    let covariance = model.open_covariance();
    let spread = rows.x.times_matrix(&covariance);
    let variance = |k: usize| (0..rows.x.columns()).map(|c| spread.at(k, c) * rows.x.at(k, c)).sum::<f64>();
    let of_joint = |j: usize| {
        let sums =
            rows.layout.rows_of_joint(j).fold([0.0; 2], |[v, s], k| [v + variance(k), s + prediction[k].powi(2)]);
        100.0 * (sums[0] / sums[1].max(f64::MIN_POSITIVE)).sqrt()
    };
    (0..rows.layout.joints()).map(of_joint).collect()
}

/// How many times a motion exceeds the recordings' largest speed and acceleration, joint by joint; zero for a speed at which friction
/// still changes its sign, and for an acceleration whose torque is below the model's error.
fn beyond(model: &ModelResult, motion: &Motion, kinds: &[JointKind]) -> Vec<[f64; 2]> {
    let [speeds, accelerations] = [&motion.dq, &motion.ddq].map(|series| largest([series].into_iter()));
    let times = |j: usize| {
        let (joint, error) = (model.joints.get(j)?, model.judged_error().joints.get(j)?);
        let counts = [speeds[j] > model.transition().of(kinds[j]), joint.inertia * accelerations[j] > error.rms];
        let times = [speeds[j] / joint.speed?, accelerations[j] / joint.acceleration?];
        Some([0, 1].map(|k| if counts[k] { times[k] } else { 0.0 }))
    };
    (0..speeds.len()).map(times).collect::<Option<Vec<_>>>().unwrap_or_default()
}

fn joint_errors(has_torque: bool, rows: &Regression, prediction: &[f64]) -> Vec<Option<f64>> {
    if has_torque { rows.joint_relative_errors_percent(prediction) } else { Vec::new() }
}

/// Periods of the identification's cut-off by which a motion is continued at its ends: the filter has settled where it begins.
const PERIODS: f64 = 3.0;
/// Cut-offs that a prediction tries, over that of the identification, the widest first.
const WIDER: [f64; 3] = [8.0, 4.0, 2.0];
/// Part of the sample rate below which cut-offs are tried.
const BELOW_NYQUIST: f64 = 0.4;
/// Part of the model's error on unseen motion that the noise of the accelerations may add.
const NOISE_PART: f64 = 0.3;

/// The widest cut-off with which noise of the positions adds next to nothing to predicted torques: an identification needs
/// accelerations without noise, a prediction the reversals of the motion as well.
///
/// White noise of density S above the cut-off f_c is acceleration of variance `(2 pi)^4 S f_c^5 / 5`, and torque by the
/// inertia of the joint.
fn widest_cutoff(setup: Setup<'_>, model: &ModelResult, filtered: &FilteredRecording) -> f64 {
    let (recording, own) = (&filtered.recording, setup.settings.signal.cutoff_hz);
    let rate = recording.sample_rate_hz;
    let errors = model.judged_error();
    let Some(inertias) = joint_inertias(setup, model, filtered) else { return own };
    let is_quiet = |cutoff_hz: &f64| {
        let settings = with_cutoff(setup.settings, *cutoff_hz);
        let Ok(motion) = (Setup { settings: &settings, ..setup }).band_pass(&recording.position, rate) else {
            return false;
        };
        let densities = noise_densities(&recording.position, &motion.q, &filtered.window, rate, *cutoff_hz);
        let acceleration = |density: &f64| (TAU.powi(4) * density * cutoff_hz.powi(5) / 5.0).sqrt();
        let torques = densities.iter().map(acceleration).zip(&inertias).map(|(a, inertia)| a * inertia);
        torques.zip(&errors.joints).all(|(noise, error)| noise <= NOISE_PART * error.rms)
    };
    let tried = WIDER.map(|factor| (factor * own).min(BELOW_NYQUIST * rate)).into_iter().filter(|hz| *hz > own);
    tried.into_iter().find(is_quiet).unwrap_or(own)
}

fn with_cutoff(settings: &Settings, cutoff_hz: f64) -> Settings {
    Settings { signal: SignalOptions { cutoff_hz, ..settings.signal }, ..settings.clone() }
}

/// The diagonal of the model's mass matrix at the mean position.
fn joint_inertias(setup: Setup<'_>, model: &ModelResult, filtered: &FilteredRecording) -> Option<Vec<f64>> {
    let dynamics = Model::new(setup.robot);
    let standard: Vec<f64> =
        dynamics.parameter_table().iter().map(|p| model.standard_value(&p.name()).unwrap_or(0.0)).collect();
    dynamics.joint_inertias(&standard, &filtered.motion.q.means()).ok()
}

/// The torques of what is estimated with those of what is known: a payload, and parameters at a value.
fn with_known(mut torque: Series, filtered: &FilteredRecording) -> Series {
    for known in filtered.payload_torque.iter().chain(&filtered.fixed_torque) {
        for k in 0..torque.len() {
            torque.sample_mut(k).iter_mut().zip(known.sample(k)).for_each(|(tau, part)| *tau += part);
        }
    }
    torque
}

struct Predictor<'a> {
    setup: Setup<'a>,
    basis: Basis,
    columns: Vec<usize>,
    theta: Vec<f64>,
    sign: Sign,
}

impl Predictor<'_> {
    /// The decimated rows of the window, without the samples that the mask leaves out, and their prediction.
    fn rows(
        &self,
        filtered: &FilteredRecording,
        signal: &SignalOptions,
        mask: Option<Arc<RowMask>>,
    ) -> Result<(Regression, Vec<f64>), PreparationError> {
        let decimator = filtered.decimator(signal)?;
        let layout = RowLayout::new(self.basis.model.coordinate_count(), &[decimator.rows()]);
        let assembly = Assembly::new(&self.basis.model, &self.columns, decimator).masked(mask);
        let x = filtered.observation_matrix_of(&assembly, self.sign)?;
        let y = assembly.measurement_vector(&filtered.centred_torque())?;
        let prediction = x.times(&self.theta);
        Ok((Regression::new(x, y, layout), prediction))
    }

    /// `phi(q, dq, ddq) theta` at every sample of the whole recording, of its motion below a cut-off.
    fn torques(&self, filtered: &FilteredRecording, cutoff_hz: f64) -> Result<Series, PreparationError> {
        let recording = &filtered.recording;
        let settings = with_cutoff(self.setup.settings, cutoff_hz);
        let setup = Setup { settings: &settings, ..self.setup };
        let rate_hz = recording.sample_rate_hz;
        let samples = (PERIODS * rate_hz / self.setup.settings.signal.cutoff_hz) as usize;
        let longer = continued(&recording.position, samples);
        let Motion { q, dq, ddq } = setup.band_pass(&longer, rate_hz)?;
        let more = (longer.len() - recording.position.len()) / 2;
        let [q, dq, ddq] = [q, dq, ddq].map(|series| series.window(more..longer.len() - more));
        let regressor = Regressor::new(&self.basis.model, &self.columns).with_channels(filtered.channels.clone());
        Ok(regressor.torques(&self.basis.model, [&q, &dq, &ddq], self.sign, &self.theta))
    }
}
