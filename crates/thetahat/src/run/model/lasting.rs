//! Errors that last: what a model leaves of the torques and noise does not explain, at the rate of the samples.

use std::f64::consts::TAU;

use super::{
    candidates::kinds,
    choice::Choice,
    factors::{SETTLED, near_rest_limits},
    variant::Variant,
};
use crate::{filter_choice::residual_of, run::prepared::PreparedRecording};
use thetahat_estimation::signal::Motion;
use thetahat_ground::series::Series;
use thetahat_model::{
    dynamics::{FrictionTransition, Sign},
    robot::JointKind,
};

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
pub(super) fn lasting_percent(variant: &Variant<'_>, choice: &Choice, transition: FrictionTransition) -> Option<f64> {
    let Variant { identification, problem, .. } = variant;
    let setup = identification.setup();
    if !problem.model.channels().is_empty() {
        return None;
    }
    let kinds = kinds(setup);
    let (mut lasting, mut torque) = (0.0, 0.0);
    for prepared in identification.main.iter() {
        let lag = lag(prepared, setup.settings.signal.cutoff_hz);
        let Middle { tau, motion, is_used } = middle(prepared);
        let left = residual_of(&tau, &motion, &problem.model, &choice.standard, Sign::Smooth(transition));
        let products = products((&left, &is_used), &motion.dq, &moving_from(prepared, (transition, &kinds)), lag);
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

/// The samples in the middle of the window.
struct Middle {
    tau: Series,
    motion: Motion,
    /// Whether each sample is in no gap.
    is_used: Vec<bool>,
}

fn middle(prepared: &PreparedRecording) -> Middle {
    let filtered = &prepared.filtered;
    let Motion { q, dq, ddq } = &filtered.motion;
    let kept = q.len().min(MOST_SAMPLES);
    let start = (q.len() - kept) / 2;
    let cut = |series: &Series| series.window(start..start + kept);
    let is_used = |k: usize| !filtered.left_out.iter().any(|gap| gap.contains(&k));
    Middle {
        tau: cut(&filtered.centred_torque()),
        motion: Motion { q: cut(q), dq: cut(dq), ddq: cut(ddq) },
        is_used: (start..start + kept).map(is_used).collect(),
    }
}

/// The velocity from which each joint moves.
fn moving_from(prepared: &PreparedRecording, (transition, kinds): (FrictionTransition, &[JointKind])) -> Vec<f64> {
    let joints = prepared.filtered.motion.dq.channels();
    let limits = near_rest_limits(prepared.filtered.near_rest.as_ref(), joints);
    limits.into_iter().zip(kinds).map(|(limit, kind)| limit.max(SETTLED * transition.of(*kind))).collect()
}

fn products((left, is_used): (&Series, &[bool]), dq: &Series, moving_from: &[f64], lag: usize) -> Vec<Products> {
    let mut products = vec![Products::default(); left.channels()];
    for k in (0..left.len().saturating_sub(lag)).filter(|&k| is_used[k] && is_used[k + lag]) {
        for (j, of_joint) in products.iter_mut().enumerate() {
            if [k, k + lag].iter().any(|&k| dq.sample(k)[j].abs() <= moving_from[j]) {
                continue;
            }
            let [now, later] = [k, k + lag].map(|k| left.sample(k)[j]);
            of_joint.apart += now * later;
            of_joint.squares += now * now;
            of_joint.pairs += 1;
        }
    }
    products
}
