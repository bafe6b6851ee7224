//! Errors that last: what a model leaves of the torques and noise does not explain, at the rate of the samples.

use std::f64::consts::TAU;

use super::{
    choice::Choice,
    factors::{SETTLED, near_rest_limits},
    variant::Variant,
};
use crate::run::prepared::PreparedRecording;
use thetahat_estimation::signal::Motion;
use thetahat_ground::series::Series;
use thetahat_model::dynamics::{DynamicParameters, Model, Sign, State, Workspace};

/// Part of a period of the position filter's cut-off after which noise that passed it is as often of one sign as of the other.
const OF_PERIOD: f64 = 0.25;
/// Part of a period of the motion over which its errors last, and noise of a controller does not.
const OF_MOTION: f64 = 0.025;
/// Deviations of the product of independent samples that are chance.
const CHANCE: f64 = 3.0;
/// Most samples that are looked at, in the middle of a recording.
const MOST_SAMPLES: usize = 40_000;

/// Sums over the samples at which a joint moves, now and a lag later.
#[derive(Clone, Copy, Default)]
struct Products {
    /// Of errors a lag apart.
    apart: f64,
    /// Of squared errors.
    squares: f64,
    pairs: usize,
}

impl Products {
    /// The variance that lasts over the lag, beyond chance.
    fn lasting(self, lag: usize) -> f64 {
        let pairs = self.pairs.max(1) as f64;
        let chance = CHANCE * self.squares / pairs / (pairs / lag as f64).max(1.0).sqrt();
        (self.apart / pairs - chance).max(0.0)
    }
}

/// The root mean square of the errors that last for a quarter of a period of the cut-off, while a joint moves, percent of all torques: what
/// few rows after a narrow filter would take for noise. Absent if torques take recorded channels.
pub(super) fn lasting_percent(variant: &Variant<'_>, choice: &Choice, transition: f64) -> Option<f64> {
    let Variant { identification, problem, .. } = variant;
    let setup = identification.setup();
    if !problem.model.channels().is_empty() {
        return None;
    }
    let errors = Errors { model: &problem.model, standard: &choice.standard, transition };
    let (mut lasting, mut torque) = (0.0, 0.0);
    for prepared in identification.main.iter() {
        let lag = lag(prepared, setup.settings.signal.cutoff_hz);
        let (tau, left) = errors.of(prepared);
        let products = products(prepared, &left, lag, transition);
        let samples = tau.len() as f64;
        lasting += samples * products.iter().map(|of_joint| of_joint.lasting(lag)).sum::<f64>();
        torque += tau.values().iter().map(|tau| tau * tau).sum::<f64>();
    }
    (torque > 0.0).then(|| 100.0 * (lasting / torque).sqrt())
}

/// Samples until noise that passed the position filter, was held, or is that of a controller, is independent.
fn lag(prepared: &PreparedRecording, cutoff_hz: f64) -> usize {
    let recording = &prepared.filtered.recording;
    let of_motion = OF_MOTION / motion_hz(&prepared.filtered.motion).max(f64::MIN_POSITIVE);
    let seconds = (OF_PERIOD / cutoff_hz).max(2.0 * recording.torque_hold_s).max(of_motion);
    let samples = (seconds * recording.sample_rate_hz).round().max(1.0) as usize;
    samples.min(prepared.filtered.motion.q.len())
}

/// The frequency of the joint that moves fastest: that of a sine with its root mean squares of velocity and position.
fn motion_hz(motion: &Motion) -> f64 {
    let of_joint = |j: usize| {
        let q = motion.q.channel(j);
        let mean = q.iter().sum::<f64>() / q.len().max(1) as f64;
        let squares = |values: &[f64], centre: f64| values.iter().map(|v| (v - centre).powi(2)).sum::<f64>();
        let [position, velocity] = [squares(&q, mean), squares(&motion.dq.channel(j), 0.0)];
        if position > 0.0 { (velocity / position).sqrt() / TAU } else { 0.0 }
    };
    (0..motion.q.channels()).map(of_joint).fold(0.0, f64::max)
}

/// A robot whose torques are subtracted from recorded ones.
struct Errors<'a> {
    model: &'a Model,
    standard: &'a [f64],
    transition: f64,
}

impl Errors<'_> {
    /// Torques, and what is left of them, of the middle samples of the window.
    fn of(&self, prepared: &PreparedRecording) -> (Series, Series) {
        let middle = middle(prepared);
        let tau = prepared.filtered.centred_torque().window(middle.clone());
        let motion = &prepared.filtered.motion;
        let parameters = DynamicParameters::sorted(self.model, self.standard);
        let (mut left, mut workspace) = (tau.clone(), Workspace::new(self.model));
        let mut predicted = vec![0.0; tau.channels()];
        let sign = Sign::Smooth { scale: self.transition };
        for (k, sample) in middle.enumerate() {
            let state = State::new(motion.q.sample(sample), motion.dq.sample(sample));
            let ddq = motion.ddq.sample(sample);
            self.model.inverse_dynamics(&parameters, state, ddq, sign, &mut workspace, &mut predicted);
            left.sample_mut(k).iter_mut().zip(&predicted).for_each(|(left, tau)| *left -= tau);
        }
        (tau, left)
    }
}

/// Samples of the window, from its first.
fn middle(prepared: &PreparedRecording) -> std::ops::Range<usize> {
    let samples = prepared.filtered.motion.q.len();
    let kept = samples.min(MOST_SAMPLES);
    let start = (samples - kept) / 2;
    start..start + kept
}

fn products(prepared: &PreparedRecording, left: &Series, lag: usize, transition: f64) -> Vec<Products> {
    let joints = left.channels();
    let limits = near_rest_limits(prepared.filtered.near_rest.as_ref(), joints);
    let first = middle(prepared).start;
    let moves = |k: usize, j: usize| {
        prepared.filtered.motion.dq.sample(first + k)[j].abs() > limits[j].max(SETTLED * transition)
    };
    let mut products = vec![Products::default(); joints];
    for k in 0..left.len().saturating_sub(lag) {
        for (j, of_joint) in products.iter_mut().enumerate().filter(|(j, _)| moves(k, *j) && moves(k + lag, *j)) {
            let [now, later] = [k, k + lag].map(|k| left.sample(k)[j]);
            of_joint.apart += now * later;
            of_joint.squares += now * now;
            of_joint.pairs += 1;
        }
    }
    products
}
