//! The torques that identified parameters predict for another motion.

use crate::{
    dynamics::Sign,
    identification::{Assembly, Method},
    preparation::{Basis, Case, FilteredRecording, PreparationError, Recording, Setup},
    regression::{Regression, RowLayout, relative_error_percent},
    regressor::Regressor,
    results::Prediction,
    series::Series,
    signal::{Decimator, Motion},
};

/// Base parameters of a case by name, and the method that gave them.
pub(crate) struct Identified<'a> {
    pub(crate) case: &'a Case,
    pub(crate) method: Method,
    pub(crate) parameters: Vec<(String, f64)>,
}

/// Predicts the torques of the moving part of a recording; none where a parameter is not of the robot.
///
/// # Errors
/// [`PreparationError`] where the recording cannot be filtered.
pub(crate) fn predict_torques(
    setup: Setup<'_>,
    identified: &Identified<'_>,
    recording: Recording,
    has_torque: bool,
) -> Result<Option<Prediction>, PreparationError> {
    let basis = setup.basis(identified.case)?;
    let column = |name: &String| basis.base.parameters().iter().find(|p| p.name == *name).map(|p| p.kept);
    let columns: Option<Vec<usize>> = identified.parameters.iter().map(|(name, _)| column(name)).collect();
    let Some(columns) = columns else { return Ok(None) };
    let filtered = setup.filter_moving_part(recording)?;
    let theta = identified.parameters.iter().map(|(_, value)| *value).collect();
    let predictor = Predictor { setup, basis, columns, theta };
    let torque = predictor.torques(&filtered)?;
    let (rows, prediction) = predictor.rows(&filtered)?;
    let rms = |p: &Vec<f64>| (p.iter().map(|v| v * v).sum::<f64>() / p.len() as f64).sqrt();
    Ok(Some(Prediction {
        method: identified.method,
        case: identified.case.name.clone(),
        sample_rate_hz: filtered.recording.sample_rate_hz,
        torque,
        relative_error_percent: has_torque.then(|| relative_error_percent(&rows.y, &prediction)),
        joint_relative_error_percent: if has_torque {
            rows.joint_relative_errors_percent(&prediction)
        } else {
            Vec::new()
        },
        measured: filtered.recording.torque.clone(),
        rms: rows.layout.by_joint(&prediction).iter().map(rms).collect(),
        window_s: filtered.window_s(),
        joints: setup.robot.coordinates().map(|j| j.name.clone()).collect(),
    }))
}

struct Predictor<'a> {
    setup: Setup<'a>,
    basis: Basis,
    columns: Vec<usize>,
    theta: Vec<f64>,
}

impl Predictor<'_> {
    /// The decimated rows of the window, and their prediction.
    fn rows(&self, filtered: &FilteredRecording) -> Result<(Regression, Vec<f64>), PreparationError> {
        let decimator = Decimator::new(self.setup.settings.signal.decimation, filtered.window.len())?;
        let layout = RowLayout::new(self.basis.model.coordinate_count(), &[decimator.rows()]);
        let assembly = Assembly::new(&self.basis.model, &self.columns, decimator);
        let x = filtered.observation_matrix(&assembly)?;
        let y = assembly.measurement_vector(&filtered.torque())?;
        let prediction = x.times(&self.theta);
        Ok((Regression::new(x, y, layout), prediction))
    }

    /// `phi(q, dq, ddq) theta` at every sample of the whole recording.
    fn torques(&self, filtered: &FilteredRecording) -> Result<Series, PreparationError> {
        let recording = &filtered.recording;
        let Motion { q, dq, ddq } = self.setup.band_pass(&recording.position, recording.sample_rate_hz)?;
        let regressor = Regressor::new(&self.basis.model, &self.columns).with_channels(filtered.channels.clone());
        let phi = regressor.evaluate_series(&self.basis.model, &q, &dq, &ddq, Sign::Exact);
        let mut torque = Series::zeros(q.len(), q.channels());
        for k in 0..q.len() {
            let tau = torque.sample_mut(k);
            for (entry, value) in regressor.entries().iter().zip(phi.sample(k)) {
                tau[entry.joint] += value * self.theta[entry.column];
            }
        }
        Ok(torque)
    }
}
