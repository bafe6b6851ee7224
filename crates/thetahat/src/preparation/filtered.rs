//! The band-passed motion of a recording, and the window in which it is used.

use std::{ops::Range, sync::Arc};

use super::{
    error::PreparationError, near_rest::near_rest, payload::Payload, recording::Recording, settings::SignalOptions,
    setup::Setup,
};
use thetahat_estimation::{
    identification::{Assembly, NearRest, Response, RowMask},
    signal::{Decimator, Motion, SignalError, centred_hold, moving_samples, peaks, spectrum_end_hz},
};
use thetahat_ground::{linear_algebra::Matrix, number::significant, series::Series};
use thetahat_model::{
    dynamics::{DynamicsError, Jump, Model, Sign},
    regressor::Regressor,
};

/// Part of its peak velocity above which a joint counts as moving.
pub(crate) const MOVING: f64 = 0.01;
/// Peak velocity in rad/s or m/s below which a joint counts as still.
pub(crate) const STILL: f64 = 1e-3;
/// Periods of the position filter's cut-off that are cut at both ends of a recording: the reach of its transient, where a
/// recording starts or ends in motion.
const EDGE_PERIODS: f64 = 5.0;
/// Periods of the cut-off at the ends of a recording in which the filtered accelerations are wrong, if they are not zero there:
/// with a window up to the end of a clean simulated recording, least squares leave 10.4 % of the torques unexplained, with one
/// period less 0.78, with two 0.413, with five 0.410.
const DISTORTED_PERIODS: f64 = 2.0;
/// Part of its largest acceleration from which a joint counts as accelerating.
const ACCELERATING: f64 = 0.05;
/// Longest gap that is bridged, in periods of the cut-off: the motion lies a factor of five below.
const SHORT_PERIODS: f64 = 0.5;
/// Fewest periods of the position filter's cut-off in a recording: with fewer, the ends are all that is left of it.
const FEWEST_PERIODS: f64 = 10.0;

/// A recording with its band-passed motion in the window.
#[derive(Debug, Clone)]
pub(crate) struct FilteredRecording {
    pub(crate) recording: Recording,
    /// The motion in the window.
    pub(crate) motion: Motion,
    /// The torques of a known payload in the whole recording, which are taken off its torques.
    pub(crate) payload_torque: Option<Series>,
    /// The same of the parameters at a value.
    pub(crate) fixed_torque: Option<Series>,
    /// Samples of the recording.
    pub(crate) window: Range<usize>,
    /// Samples, counted in the window, that make no rows: gaps, and what the position filter made of them.
    pub(crate) left_out: Vec<Range<usize>>,
    /// The samples of the window whose rows have no known right-hand side; none if all have one.
    pub(crate) unused: Option<Arc<RowMask>>,
    /// What counts as near rest; none if every sample makes rows.
    pub(crate) near_rest: Option<NearRest>,
    /// The channels that torque terms take, over the whole recording, filtered as the positions are.
    pub(crate) channels: Option<Series>,
}

impl Setup<'_> {
    /// Filters and differentiates the whole recording, then cuts it to its window: its own, or else that of the settings.
    pub(crate) fn filter(&self, recording: Recording) -> Result<FilteredRecording, PreparationError> {
        let options = self.settings.signal.in_window(recording.window_s);
        let rate = recording.sample_rate_hz;
        self.require_periods(recording.position.len(), rate)?;
        let (whole, notes) = self.measured_motion_with_notes(&recording)?;
        let channels = recording.channels_named(&self.robot.channels(), self.robot.coordinate_count())?;
        let channels = channels.map(|c| self.band_pass(&c, rate)).transpose()?.map(|filtered| filtered.q);
        let payload_torque = self.payload_torque(&recording, &whole)?;
        let fixed_torque = self.fixed_torque(&whole, channels.clone());
        let known = payload_torque.iter().chain(&fixed_torque);
        let recording = known.fold(recording, Recording::less_torque);
        let UsedWindow { samples: window, cut_at } = self.window(&recording, &whole)?;
        let Motion { q, dq, ddq } = whole;
        let mut recording = with_note_of_ends(recording, options.cutoff_hz, cut_at);
        recording.notes.extend(notes);
        let cut = |series: &Series| series.window(window.clone());
        let scale = self.settings.simulation.sign_velocity_scale;
        let recorded = [&recording.position, &q].map(cut);
        let near_rest = near_rest(&options, scale, recorded.each_ref(), rate);
        let motion = Motion { q: cut(&q), dq: cut(&dq), ddq: cut(&ddq) };
        self.require_closed_loops(&recording, &motion.q, window.start)?;
        let mut unpowered = self.unpowered(&recording, &window);
        unpowered.retain(|at| !recording.gaps.contains(at));
        recording.notes.extend(unpowered.iter().map(|at| {
            let [start, end] = [at.start, at.end].map(|k| k as f64 / rate);
            format!(
                "from {start:.3} to {end:.3} s the robot stands and all torques are zero, as with brakes or motors off: left out"
            )
        }));
        recording.gaps.extend(unpowered);
        recording.gaps.sort_unstable_by_key(|gap| gap.start);
        let left_out = left_out(&recording.gaps, &window, rate, options.cutoff_hz);
        let unused = unused_rows(&recording, &window).map(Arc::new);
        require_force(&recording, &window, unused.as_deref())?;
        Ok(FilteredRecording {
            motion,
            payload_torque,
            fixed_torque,
            recording,
            window,
            left_out,
            unused,
            near_rest,
            channels,
        })
    }

    /// The loops of links must be closed at every position; `first` is the sample of the recording at which they start.
    fn require_closed_loops(&self, recording: &Recording, q: &Series, first: usize) -> Result<(), PreparationError> {
        if self.robot.loops.is_empty() {
            return Ok(());
        }
        let open = |(sample, source): (usize, DynamicsError)| PreparationError::OpenLoop {
            recording: recording.name.clone(),
            sample: first + sample,
            position: q.sample(sample).to_vec(),
            source,
        };
        Model::new(self.robot).check_positions(q).map_err(open)
    }

    /// The window of a recording with this motion. One without motion is refused with a stated window as well.
    pub(crate) fn window(&self, recording: &Recording, motion: &Motion) -> Result<UsedWindow, PreparationError> {
        let options = self.settings.signal.in_window(recording.window_s);
        let (samples, rate) = (motion.dq.len(), recording.sample_rate_hz);
        let moving = moving_samples(&motion.dq, MOVING, STILL)?;
        let fits_torques = self.settings.all_methods().iter().any(|m| m.response() == Response::Torque);
        let window = |moving: &Range<usize>, accelerates_at| {
            window_of(MotionOfRecording { moving: moving.clone(), accelerates_at, samples }, rate, &options)
        };
        let stated = window(&moving, [false; 2])?;
        let largest = peaks(&motion.ddq.window(stated.clone()));
        let of_end = |range: Range<usize>| accelerates(&motion.ddq.window(range), &largest);
        let accelerates_at = near_ends(samples, rate, options.cutoff_hz).map(|range| fits_torques && of_end(range));
        let samples = window(&moving, accelerates_at)?;
        Ok(UsedWindow { cut_at: [stated.start < samples.start, samples.end < stated.end], samples })
    }

    /// The torques of the known payload that a recording carries: `phi(q, dq, ddq)` times what it adds to the parameters.
    fn payload_torque(&self, recording: &Recording, motion: &Motion) -> Result<Option<Series>, PreparationError> {
        let Some(payload) = self.payload_of(recording)?.filter(|p| p.is_known()) else { return Ok(None) };
        let model = Model::new(self.robot);
        let theta = payload.standard_parameters(self.robot, model.parameter_table())?;
        Ok(Some(torques(&model, &theta, motion, None)))
    }

    /// The torques of the parameters at a value; none if there are none.
    pub(crate) fn fixed_torque(&self, motion: &Motion, channels: Option<Series>) -> Option<Series> {
        let fix = &self.settings.parameters.fix;
        if fix.is_empty() {
            return None;
        }
        let model = Model::new(self.robot);
        let theta = model.parameter_table().iter().map(|p| fix.get(&p.name()).copied().unwrap_or(0.0));
        Some(torques(&model, &theta.collect::<Vec<_>>(), motion, channels))
    }

    /// The payload that a recording carries.
    ///
    /// # Errors
    /// [`PreparationError::Value`] for a name that no payload has.
    pub(crate) fn payload_of(&self, recording: &Recording) -> Result<Option<&Payload>, PreparationError> {
        let Some(name) = &recording.payload else { return Ok(None) };
        let all = &self.settings.payloads;
        let names = || all.iter().map(|p| p.name.as_str()).collect::<Vec<_>>().join(", ");
        let found = all.iter().find(|p| p.name == *name);
        let refuse = || {
            let names = if all.is_empty() { "none".to_owned() } else { names() };
            let key = format!("recording {}: payload", recording.name);
            PreparationError::value(&key, &format!("one of [[payload]]: {names}"), name)
        };
        found.map(Some).ok_or_else(refuse)
    }

    /// A recording must be long compared with the period of the position filter.
    pub(crate) fn require_periods(&self, samples: usize, sample_rate_hz: f64) -> Result<(), PreparationError> {
        let cutoff_hz = self.settings.signal.cutoff_hz;
        let duration_s = samples as f64 / sample_rate_hz;
        let slowest = FEWEST_PERIODS / duration_s;
        let expected = format!(
            "at least {slowest:.3}, of which {FEWEST_PERIODS} periods fit into the {} s that are used, or a longer recording",
            significant(duration_s, 3)
        );
        PreparationError::require(cutoff_hz >= slowest, "[signal] cutoff_hz", &expected, cutoff_hz)
    }
}

/// The torques of standard parameters, of which few are not zero: `phi(q, dq, ddq) theta` in every sample.
pub(crate) fn torques(model: &Model, theta: &[f64], motion: &Motion, channels: Option<Series>) -> Series {
    let columns: Vec<usize> = (0..theta.len()).filter(|&i| theta[i] != 0.0).collect();
    let given: Vec<f64> = columns.iter().map(|&i| theta[i]).collect();
    let Motion { q, dq, ddq } = motion;
    Regressor::new(model, &columns).with_channels(channels).torques(model, [q, dq, ddq], Sign::Exact, &given)
}

/// The window of a recording.
pub(crate) struct UsedWindow {
    pub(crate) samples: Range<usize>,
    /// Whether the stated window lost samples at its start and at its end.
    pub(crate) cut_at: [bool; 2],
}

/// When a recording moves.
pub(crate) struct MotionOfRecording {
    /// From the first sample that moves to the last.
    pub(crate) moving: Range<usize>,
    /// Whether it starts and whether it ends with an acceleration, which the position filter takes for zero there.
    pub(crate) accelerates_at: [bool; 2],
    pub(crate) samples: usize,
}

/// Samples of so many periods of the cut-off.
fn samples_of_periods(periods: f64, sample_rate_hz: f64, cutoff_hz: f64) -> usize {
    (periods * sample_rate_hz / cutoff_hz).ceil() as usize
}

/// Samples at both ends of a recording in which the position filter distorts accelerations.
pub(crate) fn distorted_samples(sample_rate_hz: f64, cutoff_hz: f64) -> usize {
    samples_of_periods(DISTORTED_PERIODS, sample_rate_hz, cutoff_hz)
}

/// The samples next to those that are distorted, as many at the start and at the end of a recording.
pub(crate) fn near_ends(samples: usize, sample_rate_hz: f64, cutoff_hz: f64) -> [Range<usize>; 2] {
    let distorted = distorted_samples(sample_rate_hz, cutoff_hz).min(samples / 4);
    [distorted..2 * distorted, samples - 2 * distorted..samples - distorted]
}

/// Whether a joint accelerates in some samples, compared with its largest acceleration in the window.
pub(crate) fn accelerates(ddq: &Series, largest: &[f64]) -> bool {
    peaks(ddq).iter().zip(largest).any(|(found, largest)| *found > ACCELERATING * largest)
}

/// The window of a recording: the stated one, without what the filter distorts where the recording starts or ends with an
/// acceleration; or the moving part without the edges of the filter.
pub(crate) fn window_of(
    motion: MotionOfRecording,
    sample_rate_hz: f64,
    options: &SignalOptions,
) -> Result<Range<usize>, PreparationError> {
    let MotionOfRecording { moving, accelerates_at: [starts, ends], samples } = motion;
    let sample = |t: f64| (t * sample_rate_hz).round() as usize;
    let edge = samples_of_periods(EDGE_PERIODS, sample_rate_hz, options.cutoff_hz);
    let distorted = distorted_samples(sample_rate_hz, options.cutoff_hz);
    let stated_end = match (options.window_start_s, options.window_end_s) {
        (_, Some(end)) => Some(sample(end)),
        (Some(_), None) => Some(samples),
        (None, None) => None,
    };
    if stated_end.is_some_and(|end| end > samples) {
        let found = format!("{} s", options.window_end_s.unwrap_or_default());
        let record = format!("at most the recording's {:.4} s", samples as f64 / sample_rate_hz);
        return Err(PreparationError::value("[signal] window_end_s", &record, found));
    }
    let first = if starts { distorted } else { 0 };
    let last = if ends { samples.saturating_sub(distorted) } else { samples };
    let start = options.window_start_s.map_or(moving.start.max(edge), |start| sample(start).max(first));
    let end = stated_end.map_or(moving.end.min(samples.saturating_sub(edge)), |end| end.min(last));
    if start >= end {
        let found = format!("{start} to {end}");
        return Err(PreparationError::value("[signal] the window, in samples,", "a start before its end", found));
    }
    Ok(start..end)
}

/// The same with a note where its stated window became shorter.
fn with_note_of_ends(mut recording: Recording, cutoff_hz: f64, [starts, ends]: [bool; 2]) -> Recording {
    let rate = recording.sample_rate_hz;
    let ends_s = significant(distorted_samples(rate, cutoff_hz) as f64 / rate, 2);
    let note = |how: &str, which: &str| {
        format!(
            "the recording {how} in motion: its {which} {ends_s} s, where the position filter distorts accelerations, are not in the window"
        )
    };
    recording.notes.extend(starts.then(|| note("starts", "first")));
    recording.notes.extend(ends.then(|| note("ends", "last")));
    recording
}

/// The rows of a window that are not used.
fn unused_rows(recording: &Recording, window: &Range<usize>) -> Option<RowMask> {
    let in_window = |k: usize| k.clamp(window.start, window.end) - window.start;
    let parts = recording.unused_rows.iter();
    let parts = parts.map(|(of, at)| (of.clone(), in_window(at.start)..in_window(at.end))).collect::<Vec<_>>();
    RowMask::leaving_out(recording.position.channels(), window.len(), &parts)
}

/// Where rows are left out, a force or a torque must be in the others: without one any scale of the parameters fits.
fn require_force(
    recording: &Recording,
    window: &Range<usize>,
    unused: Option<&RowMask>,
) -> Result<(), PreparationError> {
    let (Some(torque), Some(unused)) = (&recording.torque, unused) else { return Ok(()) };
    let used = unused.applied_to(&torque.window(window.clone()));
    let place = format!("recording {}", recording.name);
    let expected = "torques, or forces of contacts that were measured: without either the scale of all masses is free";
    let is_known = used.values().iter().any(|value| *value != 0.0);
    PreparationError::require(is_known, &place, expected, "rows without any force")
}

/// The samples of a window that make no rows. A gap of at most half a period of the cut-off is bridged well: it is left out
/// with as much on each side. Across a longer one the motion is not known: there the filter's transients are cut as at the ends
/// of a recording.
fn left_out(gaps: &[Range<usize>], window: &Range<usize>, rate_hz: f64, cutoff_hz: f64) -> Vec<Range<usize>> {
    let edge = samples_of_periods(EDGE_PERIODS, rate_hz, cutoff_hz);
    let mut left_out: Vec<Range<usize>> = Vec::new();
    for gap in gaps {
        let is_short = gap.len() as f64 <= SHORT_PERIODS * rate_hz / cutoff_hz;
        let reach = if is_short { gap.len() } else { edge };
        let start = gap.start.saturating_sub(reach).max(window.start);
        let end = (gap.end + reach).min(window.end);
        if start >= end {
            continue;
        }
        match left_out.last_mut().filter(|last| last.end + window.start >= start) {
            Some(last) => last.end = last.end.max(end - window.start),
            None => left_out.push(start - window.start..end - window.start),
        }
    }
    left_out
}

impl FilteredRecording {
    /// The decimation of its window.
    pub(crate) fn decimator(&self, signal: &SignalOptions) -> Result<Decimator, SignalError> {
        Ok(signal.decimator(self.window.len())?.leaving_out(&self.left_out))
    }

    /// The same for the model's rows.
    pub(crate) fn model_decimator(&self, signal: &SignalOptions) -> Result<Decimator, SignalError> {
        Ok(signal.model_decimator(self.window.len())?.leaving_out(&self.left_out))
    }

    /// The samples of its window that are near rest, of a model with these parameters; none if all make rows.
    pub(crate) fn mask(&self, model: &Model, parameters: &[usize]) -> Option<Arc<RowMask>> {
        let Some(rule) = &self.near_rest else { return self.unused.clone() };
        let jumps = Jump::among(model, parameters);
        RowMask::near_rest_among(&jumps, &self.motion.dq, rule, self.unused.as_deref()).map(Arc::new)
    }

    /// The samples of the window that make rows, counted in the window.
    pub(crate) fn used_samples(&self) -> impl Iterator<Item = usize> + '_ {
        let starts = [0].into_iter().chain(self.left_out.iter().map(|gap| gap.end));
        let ends = self.left_out.iter().map(|gap| gap.start).chain([self.window.len()]);
        starts.zip(ends).flat_map(|(start, end)| start..end)
    }

    /// X of the measured motion.
    pub(crate) fn observation_matrix(&self, assembly: &Assembly<'_>) -> Result<Matrix, SignalError> {
        self.observation_matrix_of(assembly, Sign::Exact)
    }

    /// The same with a sign of the velocity.
    pub(crate) fn observation_matrix_of(&self, assembly: &Assembly<'_>, sign: Sign) -> Result<Matrix, SignalError> {
        let Motion { q, dq, ddq } = &self.motion;
        let assembly = assembly.clone().with_channels(self.channels_in_window());
        assembly.observation_matrix(q, dq, ddq, sign)
    }

    /// The channels that torque terms take, in the window.
    pub(crate) fn channels_in_window(&self) -> Option<Series> {
        self.channels.as_ref().map(|channels| channels.window(self.window.clone()))
    }

    /// The torques in the window; zeros where they were not recorded.
    pub(crate) fn torque(&self) -> Series {
        let zeros = || Series::zeros(self.window.len(), self.recording.position.channels());
        self.recording.torque.as_ref().map_or_else(zeros, |torque| torque.window(self.window.clone()))
    }

    /// The torques that act around each sample of the window: the mean over the step, where recorded torques hold.
    pub(crate) fn centred_torque(&self) -> Series {
        let part = self.recording.held_part_of_step();
        let centred = |torque: &Series| centred_hold(torque, part).window(self.window.clone());
        match &self.recording.torque {
            Some(torque) if part > 0.0 => centred(torque),
            Some(_) | None => self.torque(),
        }
    }

    /// Where the torques end, if they were low-passed before they were recorded, Hz.
    pub(crate) fn torque_ends_hz(&self) -> Option<f64> {
        let torque = self.recording.torque.as_ref()?.window(self.window.clone());
        spectrum_end_hz(&torque, self.recording.sample_rate_hz)
    }

    /// The recorded positions in the window, as they are.
    pub(crate) fn position(&self) -> Series {
        self.recording.position.window(self.window.clone())
    }

    /// Time of the first sample of the window, s.
    pub(crate) fn start_s(&self) -> f64 {
        self.window.start as f64 / self.recording.sample_rate_hz
    }

    /// Start and end of the window, s.
    pub(crate) fn window_s(&self) -> [f64; 2] {
        [self.start_s(), self.window.end as f64 / self.recording.sample_rate_hz]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preparation::{Mask, PositionFilter};
    use thetahat_estimation::signal::Derivative;
    use thetahat_model::robot::Robot;

    /// At 1 kHz and 50 Hz a gap of 10 samples is short, and 100 samples are an edge.
    #[test]
    fn short_gaps_are_left_out_with_as_much_on_each_side_and_long_ones_with_edges() {
        let at = |gaps: &[Range<usize>]| left_out(gaps, &(1000..5000), 1000.0, 50.0);
        assert_eq!(at(&[2000..2003, 2004..2005, 3000..3011]), [997..1006, 1900..2111]);
        assert_eq!(at(&[100..300, 990..1000, 4999..5000, 6000..6001]), [0..10, 3998..4000]);
    }

    /// At 100 Hz and 10 Hz two periods are 20 samples.
    #[test]
    fn a_stated_window_has_no_distorted_ends_of_a_recording_that_starts_or_ends_in_motion() {
        let options = SignalOptions {
            position: PositionFilter::Butterworth,
            filter_order: 4,
            cutoff_hz: 10.0,
            decimation: 1,
            window_start_s: Some(0.1),
            window_end_s: Some(9.9),
            derivative: Derivative::default(),
            mask: Mask::default(),
        };
        let window = |options: &SignalOptions, accelerates_at| {
            window_of(MotionOfRecording { moving: 0..1000, accelerates_at, samples: 1000 }, 100.0, options).unwrap()
        };
        assert_eq!(window(&options, [false; 2]), 10..990);
        assert_eq!(window(&options, [true, false]), 20..990);
        assert_eq!(window(&options, [false, true]), 10..980);
        let inside = SignalOptions { window_start_s: Some(0.6), window_end_s: Some(9.0), ..options };
        assert_eq!(window(&inside, [true; 2]), 60..900);
        let open = SignalOptions { window_end_s: None, ..options };
        assert_eq!(window(&open, [false, true]), 10..980);
        let moving = SignalOptions { window_start_s: None, window_end_s: None, ..options };
        assert_eq!(window(&moving, [false; 2]), 50..950);
        let recording = Recording::new(100.0, Series::zeros(1000, 1), Series::zeros(1000, 1));
        let notes = |cut_at| with_note_of_ends(recording.clone(), 10.0, cut_at).notes.len();
        assert_eq!([notes([false, false]), notes([true, false]), notes([true, true])], [0, 1, 2]);
    }

    #[test]
    fn values_that_are_all_zero_have_no_torque() {
        let robot = Robot::parse(include_str!("../../demo/tx40.toml"), std::path::Path::new("tx40.toml")).unwrap();
        let model = Model::new(&robot);
        let [q, dq, ddq] = [0, 1, 2].map(|_| Series::zeros(3, 6));
        let theta = vec![0.0; model.parameter_table().len()];
        assert_eq!(torques(&model, &theta, &Motion { q, dq, ddq }, None), Series::zeros(3, 6));
    }
}
