use super::{
    Move, Moves, TimeLaw, TrajectoryError,
    detect::{Detection, detect, first_law},
    fit::{Fit, Samples, fit},
};
use thetahat_ground::series::Series;

/// The fit uses every n-th sample, with n such that about this rate remains: more samples of the same move take time and add no
/// information. They are not filtered first, because a filter would distort the reference.
const FIT_RATE_HZ: f64 = 1000.0;
/// Fewest samples to fit in a move: six times the number of unknowns of its time law.
const LEAST_SAMPLES: usize = 24;
/// Fewest samples of rest that give the start point; with fewer it is fitted.
const LEAST_REST_SAMPLES: usize = 10;
/// Largest ratio of a joint's weight to the smallest.
const LARGEST_WEIGHT: f64 = 1e3;

/// The reference found in a recording.
#[derive(Debug, Clone, PartialEq)]
pub struct Reconstruction {
    /// The trajectory.
    pub moves: Moves,
    /// Root mean square of position minus reference of each joint, from the first move's start to the last one's end.
    pub rms_deviation: Vec<f64>,
    /// Largest absolute deviation of each joint over the same time.
    pub largest_deviation: Vec<f64>,
}

/// Finds the noise-free reference of a recorded motion made of synchronised point-to-point moves.
///
/// `position` holds the joint positions as recorded; `velocity` is its central difference, low-passed with zero phase,
/// and is used only to find the moves and their first time laws. Time zero is the first sample.
///
/// The moves are the stretches between which the robot (nearly) stands still. Each is fitted separately; then all time
/// laws and end points are refined together, once with equal weights and once with each joint weighted by one over its
/// deviation. The result is the reference as the joints followed it: a constant lag of the control is included in the starts.
///
/// # Errors
/// If the two series do not belong together, a sample is not finite, no move is found, or one is too short to fit.
pub fn reconstruct(
    position: &Series,
    velocity: &Series,
    sample_rate_hz: f64,
) -> Result<Reconstruction, TrajectoryError> {
    check(position, velocity, sample_rate_hz)?;
    let detection = detect(position, velocity, sample_rate_hz)?;
    let record = Record { position, velocity, rate: sample_rate_hz };
    let laws = record.fit_each_move(&detection)?;
    let equal = record.refine(&detection, &vec![1.0; position.channels()], laws)?;
    let laws = equal.moves.moves().iter().map(|m| m.law).collect();
    record.refine(&detection, &weights(&equal.rms_deviation), laws)
}

/// A recording, its sample rate and fit settings.
struct Record<'a> {
    position: &'a Series,
    velocity: &'a Series,
    rate: f64,
}

impl Record<'_> {
    /// The time law of each move, fitted separately.
    fn fit_each_move(&self, detection: &Detection) -> Result<Vec<TimeLaw>, TrajectoryError> {
        let equal = vec![1.0; self.position.channels()];
        let mut laws = Vec::new();
        for (k, bounds) in detection.boundaries.windows(2).enumerate() {
            let samples = self.samples(bounds[0], bounds[1]);
            enough(format!("move {} of the recording, at the rate of the fit,", k + 1), samples.len())?;
            let window = bounds[0]..bounds[1] + 1;
            let first = first_law(self.position, self.velocity, &detection.joint_weights, window, self.rate);
            laws.extend(fit(&samples, &equal, vec![first]).laws);
        }
        Ok(laws)
    }

    /// All time laws and end points together.
    fn refine(
        &self,
        detection: &Detection,
        weights: &[f64],
        laws: Vec<TimeLaw>,
    ) -> Result<Reconstruction, TrajectoryError> {
        let bounds = &detection.boundaries;
        let mut samples = self.samples(bounds[0], bounds[bounds.len() - 1]);
        if let Some(start) = laws.first().and_then(|first| self.rest(bounds[0], first.start_s)) {
            samples = samples.with_known_start(start);
        }
        Ok(self.compare(moves(&fit(&samples, weights, laws))?))
    }

    /// The mean position from sample `first` to `time_s`, if the recording has a rest before the first move. A fitted start would absorb a
    /// part of the lag with which the joints follow that move.
    fn rest(&self, first: usize, time_s: f64) -> Option<Vec<f64>> {
        let rest = first..(time_s * self.rate) as usize;
        let mean = |j: usize| rest.clone().map(|k| self.position.sample(k)[j]).sum::<f64>() / rest.len() as f64;
        (rest.len() >= LEAST_REST_SAMPLES).then(|| (0..self.position.channels()).map(mean).collect())
    }

    fn samples(&self, first: usize, last: usize) -> Samples {
        let stride = (self.rate / FIT_RATE_HZ).round().max(1.0) as usize;
        Samples::new(self.position, first..last + 1, stride, self.rate)
    }

    /// The deviations of the recording from `moves`.
    fn compare(&self, moves: Moves) -> Reconstruction {
        let joints = moves.joints();
        let last = ((moves.end_s() * self.rate) as usize).min(self.position.len() - 1);
        let first = ((moves.start_s() * self.rate).ceil() as usize).min(last);
        let (mut squares, mut largest) = (vec![0.0; joints], vec![0.0_f64; joints]);
        let (mut q, mut dq, mut ddq) = (vec![0.0; joints], vec![0.0; joints], vec![0.0; joints]);
        for k in first..=last {
            moves.evaluate(k as f64 / self.rate, &mut q, &mut dq, &mut ddq);
            for (j, (measured, reference)) in self.position.sample(k).iter().zip(&q).enumerate() {
                let deviation = measured - reference;
                squares[j] += deviation * deviation;
                largest[j] = largest[j].max(deviation.abs());
            }
        }
        let rms_deviation = squares.iter().map(|s: &f64| (s / (last - first + 1) as f64).sqrt()).collect();
        Reconstruction { moves, rms_deviation, largest_deviation: largest }
    }
}

fn moves(found: &Fit) -> Result<Moves, TrajectoryError> {
    let ends = found.end_points().into_iter();
    Moves::new(found.start.clone(), found.laws.iter().zip(ends).map(|(&law, end)| Move { law, end }).collect())
}

/// One over the deviation of each joint, within bounds: a joint that stands still or fits exactly must not dominate.
fn weights(rms: &[f64]) -> Vec<f64> {
    let largest = rms.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    rms.iter().map(|r| largest / r.max(largest / LARGEST_WEIGHT)).collect()
}

fn check(position: &Series, velocity: &Series, rate: f64) -> Result<(), TrajectoryError> {
    let (expected, found) = (position.channels(), velocity.channels());
    if found != expected {
        return Err(TrajectoryError::JointCount { what: "the velocity".to_owned(), expected, found });
    }
    if position.len() != velocity.len() {
        return Err(TrajectoryError::SampleCount { position: position.len(), velocity: velocity.len() });
    }
    if !(rate > 0.0 && rate.is_finite()) {
        let what = "the sample rate in Hz".to_owned();
        return Err(TrajectoryError::Value { what, expected: "a finite number above zero", found: rate });
    }
    enough("the recording".to_owned(), position.len())?;
    check_finite("position", position)?;
    check_finite("velocity", velocity)
}

fn enough(what: String, found: usize) -> Result<(), TrajectoryError> {
    if found >= LEAST_SAMPLES {
        Ok(())
    } else {
        Err(TrajectoryError::TooFewSamples { what, found, needed: LEAST_SAMPLES })
    }
}

fn check_finite(what: &'static str, series: &Series) -> Result<(), TrajectoryError> {
    match series.values().iter().position(|v| !v.is_finite()) {
        Some(i) => {
            Err(TrajectoryError::NotFinite { what, joint: i % series.channels() + 1, sample: i / series.channels() })
        }
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, Normal};

    use super::*;
    use crate::signal::Motion;

    const RATE_HZ: f64 = 5000.0;
    const NOISE_RAD: f64 = 1e-4;
    /// Uncertainty of starts, T1 and T2 under noise of that size, with some room; T3 shows less in the position.
    const TIME_S: f64 = 0.3e-3;
    const SMOOTHING_TIME_S: f64 = 1e-3;
    const POINT_RAD: f64 = 5e-5;

    /// Five moves of three joints: cruising and not, smoothed little and much, with rests and with overlaps.
    fn truth() -> Moves {
        let motion = |start_s, t1_s, t2_s, t3_s, end: [f64; 3]| Move {
            law: TimeLaw { start_s, t1_s, t2_s, t3_s },
            end: end.to_vec(),
        };
        let moves = vec![
            motion(0.2, 0.3, 0.15, 0.04, [1.0, -0.5, 0.8]),
            motion(0.688, 0.4, 0.2, 0.06, [-0.2, 0.9, 0.8]),
            motion(1.4, 0.25, 0.2, 0.05, [-0.9, 0.2, -0.7]),
            motion(1.898, 0.5, 0.18, 0.03, [0.8, 1.2, 0.1]),
            motion(2.8, 0.22, 0.12, 0.08, [0.1, 0.2, 0.4]),
        ];
        Moves::new(vec![0.1, 0.2, -0.3], moves).unwrap()
    }

    fn noisy(moves: &Moves, samples: usize) -> Series {
        let mut q = moves.sample(RATE_HZ, samples).q;
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        let noise = Normal::new(0.0, NOISE_RAD).unwrap();
        q.values_mut().iter_mut().for_each(|q| *q += noise.sample(&mut rng));
        q
    }

    /// The mean over 51 samples about each, once; at the ends over those there are.
    fn smoothed(x: &[f64]) -> Vec<f64> {
        let mean = |s: &[f64]| s.iter().sum::<f64>() / s.len() as f64;
        (0..x.len()).map(|k| mean(&x[k.saturating_sub(25)..(k + 26).min(x.len())])).collect()
    }

    fn velocity(position: &Series) -> Series {
        let channel = |j: usize| {
            let x = smoothed(&smoothed(&position.channel(j)));
            let last = x.len() - 1;
            (0..x.len()).map(|k| (x[(k + 1).min(last)] - x[k.saturating_sub(1)]) * RATE_HZ / 2.0).collect()
        };
        Series::side_by_side(&(0..position.channels()).map(channel).collect::<Vec<_>>())
    }

    /// Asserts that `found` is `truth`, `delay` seconds earlier.
    fn assert_found(found: &Moves, truth: &Moves, delay: f64) {
        let near = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < POINT_RAD);
        assert!(near(found.start(), truth.start()));
        assert_eq!(found.moves().len(), truth.moves().len());
        for (a, b) in found.moves().iter().zip(truth.moves()) {
            assert!((a.law.start_s + delay - b.law.start_s).abs() < TIME_S, "{a:?} against {b:?}");
            assert!((a.law.t1_s - b.law.t1_s).abs() < TIME_S, "{a:?} against {b:?}");
            assert!((a.law.t2_s - b.law.t2_s).abs() < TIME_S, "{a:?} against {b:?}");
            assert!((a.law.t3_s - b.law.t3_s).abs() < SMOOTHING_TIME_S, "{a:?} against {b:?}");
            assert!(near(&a.end, &b.end), "{a:?} against {b:?}");
        }
    }

    #[test]
    fn known_moves_are_found_again_from_a_noisy_recording() {
        let truth = truth();
        let q = noisy(&truth, 18_000);
        let found = reconstruct(&q, &velocity(&q), RATE_HZ).unwrap();
        assert_found(&found.moves, &truth, 0.0);
        assert!(found.rms_deviation.iter().all(|r| (r / NOISE_RAD - 1.0).abs() < 0.05));
        assert!(found.largest_deviation.iter().all(|d| *d > 3.0 * NOISE_RAD && *d < 8.0 * NOISE_RAD));
    }

    #[test]
    fn without_rest_at_the_beginning_the_start_point_is_fitted() {
        let truth = truth();
        let q = noisy(&truth, 18_000).window(995..18_000);
        let found = reconstruct(&q, &velocity(&q), RATE_HZ).unwrap();
        assert_found(&found.moves, &truth, 0.199);
    }

    /// A joint that only carries noise must neither hide the moves of the others nor make moves of its own.
    #[test]
    fn a_joint_at_rest_does_not_disturb() {
        let truth = truth();
        let moves: Vec<Move> =
            truth.moves().iter().map(|m| Move { end: vec![m.end[0], 0.2, m.end[2]], ..m.clone() }).collect();
        let truth = Moves::new(truth.start().to_vec(), moves).unwrap();
        let q = noisy(&truth, 18_000);
        assert_found(&reconstruct(&q, &velocity(&q), RATE_HZ).unwrap().moves, &truth, 0.0);
    }

    #[test]
    fn each_defect_is_refused() {
        use TrajectoryError::{JointCount, NotFinite, SampleCount, TooFewSamples, Value};
        let Motion { q, dq, .. } = truth().sample(RATE_HZ, 18_000);
        let error = |q: &Series, dq: &Series, rate: f64| reconstruct(q, dq, rate).unwrap_err();
        let two = Series::zeros(18_000, 2);
        assert!(matches!(error(&q, &two, RATE_HZ), JointCount { expected: 3, found: 2, .. }));
        assert!(matches!(error(&q, &dq.window(0..9_000), RATE_HZ), SampleCount { velocity: 9_000, .. }));
        assert!(matches!(error(&q, &dq, 0.0), Value { .. }));
        assert!(matches!(error(&q.window(0..9), &dq.window(0..9), RATE_HZ), TooFewSamples { found: 9, .. }));
        let mut broken = q.clone();
        broken.sample_mut(17)[1] = f64::NAN;
        assert!(matches!(error(&broken, &dq, RATE_HZ), NotFinite { joint: 2, sample: 17, .. }));
    }

    #[test]
    fn a_robot_at_rest_has_no_moves() {
        let still = Moves::new(vec![0.1, 0.2], Vec::new()).unwrap();
        let Motion { q, dq, .. } = still.sample(RATE_HZ, 9_000);
        assert!(matches!(reconstruct(&q, &dq, RATE_HZ), Err(TrajectoryError::NoMotion { .. })));
        let q = noisy(&still, 9_000);
        assert!(matches!(reconstruct(&q, &velocity(&q), RATE_HZ), Err(TrajectoryError::NoMotion { .. })));
    }

    #[test]
    fn a_recording_too_coarse_for_its_moves_is_refused() {
        let Motion { q, dq, .. } = truth().sample(30.0, 110);
        assert!(matches!(reconstruct(&q, &dq, 30.0), Err(TrajectoryError::TooFewSamples { .. })));
    }
}
