use super::{error::PreparationError, filtered::FilteredRecording, recording::Recording, setup::Setup};
use thetahat_estimation::{
    control::ControllerDescription,
    simulation::{Reference, SampledReference},
};
use thetahat_ground::{
    linear_algebra::{Matrix, PivotedQr},
    series::Series,
};

/// The reference that a recording's simulations follow, and where it comes from.
#[derive(Debug, Clone)]
pub(crate) struct RecordedReference {
    pub(crate) reference: Reference,
    /// `recorded`, `planned`, `reconstructed`, `periodic` or `filtered`; `motion` in an open loop.
    pub(crate) origin: &'static str,
    /// The period found.
    pub(crate) periodic: Option<FoundPeriod>,
    /// Cut-off with which the motion was smoothed, Hz, where the reference is made of it.
    pub(crate) smoothing_cutoff_hz: Option<f64>,
    /// The recorded drive signals of the motors, which act in an open loop.
    pub(crate) drive_signals: Option<Series>,
}

/// Samples whose parabola gives position and velocity where an open loop starts.
const START_SAMPLES: usize = 20;

/// A Fourier series that was fitted to a recorded motion.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FoundPeriod {
    pub(crate) base_frequency_hz: f64,
    /// The base frequency among them.
    pub(crate) harmonics: usize,
    /// Of the polynomial; zero where the motion does not drift.
    pub(crate) degree: usize,
    /// Periods from which it was fitted.
    pub(crate) periods: f64,
    /// Start and end of the stretch in which the motion repeats, s.
    pub(crate) stretch_s: [f64; 2],
}

impl Setup<'_> {
    /// The recorded or planned reference; without one, it is found in the motion.
    pub(crate) fn reference(&self, recording: &Recording) -> Result<RecordedReference, PreparationError> {
        let rate = recording.sample_rate_hz;
        if self.settings.controller.as_ref().is_some_and(ControllerDescription::is_open_loop) {
            return self.motion_in_open_loop(recording);
        }
        if let Some(recorded) = &recording.reference {
            let reference = Reference::Sampled(SampledReference::new(recorded.clone(), rate));
            return Ok(RecordedReference::new(reference, "recorded"));
        }
        match &recording.planned {
            Some(planned) => Ok(RecordedReference::new(Reference::Moves(planned.clone()), "planned")),
            None => self.reference_of_motion(recording),
        }
    }

    /// The recorded motion, where an open loop starts, and the recorded drive signals.
    fn motion_in_open_loop(&self, recording: &Recording) -> Result<RecordedReference, PreparationError> {
        let key = format!("recording {}: torque", recording.name);
        let expected = "recorded, since it acts in the place of a controller with law = \"open-loop\"";
        let torque = recording.torque.as_ref().ok_or_else(|| PreparationError::value(&key, expected, "missing"))?;
        let rate = recording.sample_rate_hz;
        let reference = Reference::Sampled(SampledReference::new(with_start(&recording.position, rate), rate));
        let drive_signals = Some(self.robot.transmission.drive_signals(torque));
        Ok(RecordedReference { drive_signals, ..RecordedReference::new(reference, "motion") })
    }
}

/// Recorded positions whose first two samples are on the tangent, at the first, of the parabola through the first ones.
fn with_start(position: &Series, rate: f64) -> Series {
    let samples = START_SAMPLES.min(position.len());
    let powers = Matrix::from_fn(samples, 3, |k, power| (k as f64 / rate).powi(power as i32));
    let parabola = PivotedQr::with_equal_columns(&powers);
    let mut started = position.clone();
    for joint in 0..position.channels() {
        let first: Vec<f64> = (0..samples).map(|k| position.sample(k)[joint]).collect();
        let [start, velocity, ..] = parabola.solve(&first)[..] else { continue };
        started.sample_mut(0)[joint] = start;
        started.sample_mut(1)[joint] = start + velocity / rate;
    }
    started
}

impl RecordedReference {
    pub(super) fn new(reference: Reference, origin: &'static str) -> Self {
        Self { reference, origin, periodic: None, smoothing_cutoff_hz: None, drive_signals: None }
    }

    /// Rms deviation, per joint, of the recorded positions from the reference in the window, rad or m.
    pub(crate) fn rms_deviation(&self, filtered: &FilteredRecording) -> Vec<f64> {
        let recording = &filtered.recording;
        let joints = recording.position.channels();
        let [mut q, mut dq, mut ddq] = [(); 3].map(|()| vec![0.0; joints]);
        let mut squares = vec![0.0; joints];
        let used = filtered.used_samples().count() as f64;
        for k in filtered.used_samples().map(|k| k + filtered.window.start) {
            self.reference.evaluate(k as f64 / recording.sample_rate_hz, &mut q, &mut dq, &mut ddq);
            let measured = recording.position.sample(k);
            squares.iter_mut().zip(measured.iter().zip(&q)).for_each(|(s, (m, r))| *s += (m - r).powi(2));
        }
        squares.iter().map(|s| (s / used).sqrt()).collect()
    }
}
