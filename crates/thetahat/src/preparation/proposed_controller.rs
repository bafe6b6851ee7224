//! The controller that is simulated where none is described: a guess, of which IV needs no more than that the loop follows the
//! motion.

use super::{filtered::FilteredRecording, settings::Case, settings::Settings};
use thetahat_estimation::{
    control::ControllerDescription,
    identification::{DesignMatrix, Method, Needs},
};
use thetahat_ground::{
    linear_algebra::{Matrix, PivotedQr},
    series::Series,
};

/// Bandwidth if nothing shows one.
const USUAL_HZ: f64 = 10.0;
/// Lowest bandwidth that is proposed: a slower loop loses the motion.
const LOWEST_HZ: f64 = 3.0;
/// Bandwidth from which on a lag is too short to show one: the reference is followed with feed-forward.
const HIGHEST_HZ: f64 = 40.0;
/// Part of a joint's deviation from its reference that a lag must explain.
const EXPLAINED: f64 = 0.5;

/// A controller to simulate, and that it is a guess.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ProposedController {
    pub(crate) description: ControllerDescription,
    /// What is reported of it.
    pub(crate) what: String,
}

impl Settings {
    /// Whether IV is asked for without a controller to simulate.
    pub(crate) fn lacks_controller(&self) -> bool {
        let asked = |case: &Case| case.methods.clone().unwrap_or_else(|| self.estimation.methods.clone());
        self.controller.is_none() && self.all_cases().iter().any(|case| asked(case).iter().any(is_iv))
    }
}

/// Whether a method needs no more of a simulated loop than that it follows the motion.
pub(crate) fn is_iv(method: &Method) -> bool {
    method.needs() == Needs::Instruments && method.design() == DesignMatrix::Measured
}

/// A PD loop around each motor: one that lags as the recorded motion lags after its recorded reference, else one of 10 Hz with
/// feed-forward.
pub(crate) fn propose_controller(recordings: &[&FilteredRecording]) -> ProposedController {
    match bandwidth_hz(recordings) {
        Some(hz) => {
            let followed = ControllerDescription::pd(hz);
            ProposedController {
                description: ControllerDescription {
                    velocity_feed_forward: 0.0,
                    acceleration_feed_forward: 0.0,
                    ..followed
                },
                what: format!(
                    "the simulated controller is a guess, a PD loop of {hz:.1} Hz for each motor without feed-forward, from how the motion \
                     lags behind its reference"
                ),
            }
        }
        None => ProposedController {
            description: ControllerDescription::pd(USUAL_HZ),
            what: format!("the simulated controller is a guess, a PD loop of {USUAL_HZ} Hz for each motor"),
        },
    }
}

/// The median bandwidth over joints and recordings; none if no joint lags after a recorded reference as a critically
/// damped second order does.
fn bandwidth_hz(recordings: &[&FilteredRecording]) -> Option<f64> {
    let of_recording = |f: &&FilteredRecording| {
        let reference = f.recording.reference.as_ref()?.window(f.window.clone());
        Some((0..reference.channels()).filter_map(|j| lag_of_joint(f, &reference, j)).collect::<Vec<f64>>())
    };
    let mut found: Vec<f64> = recordings.iter().filter_map(of_recording).flatten().collect();
    found.sort_by(f64::total_cmp);
    let median = *found.get(found.len() / 2)?;
    (median < HIGHEST_HZ).then(|| median.max(LOWEST_HZ))
}

/// The bandwidth in Hz of `r - q = 2/w dq + 1/w^2 ddq`, critically damped, from the velocity's coefficient by least squares
/// in addition to the acceleration, friction and a constant.
fn lag_of_joint(filtered: &FilteredRecording, reference: &Series, j: usize) -> Option<f64> {
    let at = |series: &Series, k: usize| series.sample(k)[j];
    let motion = &filtered.motion;
    let samples = motion.q.len().min(reference.len());
    let regressors = Matrix::from_fn(samples, 4, |k, column| match column {
        0 => at(&motion.dq, k),
        1 => at(&motion.ddq, k),
        2 => at(&motion.dq, k).signum(),
        _ => 1.0,
    });
    let error: Vec<f64> = (0..samples).map(|k| at(reference, k) - at(&motion.q, k)).collect();
    let lag_s = *PivotedQr::with_equal_columns(&regressors).solve(&error).first()?;
    let square = |values: &mut dyn Iterator<Item = f64>| values.map(|v| v * v).sum::<f64>();
    let explained = square(&mut (0..samples).map(|k| lag_s * at(&motion.dq, k)));
    let mean = error.iter().sum::<f64>() / samples.max(1) as f64;
    let whole = square(&mut error.iter().map(|e| e - mean));
    (lag_s > 0.0 && lag_s.is_finite() && explained > EXPLAINED * whole).then(|| 1.0 / (std::f64::consts::PI * lag_s))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preparation::Recording;
    use thetahat_estimation::signal::Motion;

    /// A motion after `sin(omega t)` as a critically damped loop of `hz` leaves it: its answer is exact.
    fn lagging(hz: f64) -> FilteredRecording {
        let (omega, w, rate) = (3.0_f64, std::f64::consts::TAU * hz, 200.0);
        let (size, late) = (w * w / (w * w + omega * omega), 2.0 * (omega / w).atan());
        let series = |f: &dyn Fn(f64) -> f64| Series::shaped(1, (0..1000).map(|k| f(f64::from(k) / rate)).collect());
        let q = series(&|t| size * (omega * t - late).sin());
        let dq = series(&|t| size * omega * (omega * t - late).cos());
        let ddq = series(&|t| -size * omega * omega * (omega * t - late).sin());
        let recording = Recording::new(rate, q.clone(), q.clone()).with_reference(series(&|t| (omega * t).sin()));
        FilteredRecording {
            recording,
            motion: Motion { q, dq, ddq },
            payload_torque: None,
            fixed_torque: None,
            window: 0..1000,
            near_rest: None,
            unused: None,
            left_out: Vec::new(),
            channels: None,
        }
    }

    #[test]
    fn a_lag_gives_the_bandwidth_and_none_gives_the_usual_one() {
        let proposed = propose_controller(&[&lagging(8.0)]);
        assert!((proposed.description.bandwidth_hz[0] - 8.0).abs() < 1e-6, "{:?}", proposed.description);
        assert_eq!(proposed.description.velocity_feed_forward, 0.0);
        for none in [propose_controller(&[&lagging(100.0)]), propose_controller(&[])] {
            assert_eq!(none.description, ControllerDescription::pd(USUAL_HZ));
            assert!(none.what.contains("guess"));
        }
    }
}
