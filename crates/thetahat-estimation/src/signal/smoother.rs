//! Positions, velocities and accelerations by a fixed-interval smoother whose variances are estimated by likelihood.

use std::{f64::consts::TAU, ops::Range};

use super::{
    band_pass::Motion,
    error::SignalError,
    random_walk::{Gain, RandomWalk, Square, dot},
};
use thetahat_ground::{linear_algebra::Matrix, series::Series};

/// Highest and lowest frequency of a random walk in steps, `w0 h`: 0.4 of the sample rate, and a step that is a 60,000th of a period.
const STEPS: [f64; 2] = [0.4 * TAU, 1e-4];
/// Fewest periods of the walk's frequency in a recording.
const FEWEST_PERIODS: f64 = 4.0;
/// Frequencies per octave of the first search.
const PER_OCTAVE: f64 = 2.0;
/// Relative width at which the search ends.
const PRECISION: f64 = 0.01;
/// What is left of the start's effect when it counts as gone.
const FORGOTTEN: f64 = 1e-13;
/// Longest gap that is left to the smoother, in scaled time: across a longer one the walk goes anywhere.
const LONGEST_GAP: f64 = 10.0;
/// Relative difference from the steady covariance at which the filter has settled after a gap.
const SETTLED: f64 = 1e-10;

/// A smoothed motion.
#[derive(Debug, Clone, PartialEq)]
pub struct SmoothedMotion {
    /// Positions, velocities and accelerations.
    pub motion: Motion,
    /// Frequency w0 of each channel, Hz: its positions are halved there, as by a filter of that cut-off forward and backward.
    pub cutoffs_hz: Vec<f64>,
    /// Standard deviation of each channel's measurement noise, rad or m.
    pub noise: Vec<f64>,
    /// Whether each channel's likelihood is the largest at 0.4 of the sample rate: then it has no white noise to be smoothed.
    pub is_at_limit: Vec<bool>,
}

/// Positions, velocities and accelerations as states of an integrated random walk, by a Kalman filter and a fixed-interval smoother.
///
/// The derivative of `order` P of each channel is white noise of density q, and its positions have white noise of variance r. The
/// frequency `w0 = (q / (r h))^(1 / 2P)`, at the step h, maximises the likelihood of the innovations, in which r is concentrated out
/// and the first state is diffuse. Inside, the smoother has the gain `1 / (1 + (w / w0)^2P)` without delay; at the ends and across
/// gaps it is that of the walk. Positions in a gap of at most `10 / w0` are not used.
///
/// # Errors
/// [`SignalError::SmootherOrder`] for an order that is not 3, 4 or 5; [`SignalError::RecordTooShort`] below 8 P samples.
pub fn smooth_motion(
    position: &Series,
    gaps: &[Range<usize>],
    sample_rate_hz: f64,
    order: usize,
) -> Result<SmoothedMotion, SignalError> {
    match order {
        3 => smoothed::<3>(position, gaps, sample_rate_hz),
        4 => smoothed::<4>(position, gaps, sample_rate_hz),
        5 => smoothed::<5>(position, gaps, sample_rate_hz),
        other => Err(SignalError::SmootherOrder { found: other }),
    }
}

fn smoothed<const P: usize>(
    position: &Series,
    gaps: &[Range<usize>],
    rate: f64,
) -> Result<SmoothedMotion, SignalError> {
    let (samples, needed) = (position.len(), 8 * P);
    if samples < needed {
        return Err(SignalError::RecordTooShort { needed, found: samples });
    }
    let mut channels = Vec::new();
    let (mut cutoffs_hz, mut noise, mut is_at_limit) = (Vec::new(), Vec::new(), Vec::new());
    for j in 0..position.channels() {
        let measured = Measured { values: position.channel(j), gaps };
        let step = most_likely_step::<P>(&measured);
        let filter = Filter::<P>::new(step, &measured);
        let (states, variance) = filter.smoothed(&measured);
        let frequency = step * rate;
        channels.push([0, 1, 2].map(|i| {
            let unit = frequency.powi(i as i32);
            states.iter().map(|state| state[i] * unit).collect::<Vec<f64>>()
        }));
        cutoffs_hz.push(frequency / TAU);
        is_at_limit.push(step > (1.0 - 2.0 * PRECISION) * STEPS[0]);
        noise.push(variance.sqrt());
    }
    let [q, dq, ddq] =
        [0, 1, 2].map(|i| Series::side_by_side(&channels.iter().map(|c| c[i].clone()).collect::<Vec<_>>()));
    Ok(SmoothedMotion { motion: Motion { q, dq, ddq }, cutoffs_hz, noise, is_at_limit })
}

/// One channel and the samples that are not measured.
struct Measured<'a> {
    values: Vec<f64>,
    gaps: &'a [Range<usize>],
}

/// The step of scaled time with the largest likelihood.
fn most_likely_step<const P: usize>(measured: &Measured<'_>) -> f64 {
    let cost = |log_step: f64| Filter::<P>::new(log_step.exp(), measured).cost(measured);
    let lowest = STEPS[1].max(TAU * FEWEST_PERIODS / measured.values.len() as f64).min(STEPS[0]);
    let (low, high) = (lowest.ln(), STEPS[0].ln());
    let count = ((high - low) / std::f64::consts::LN_2 * PER_OCTAVE).ceil().max(1.0);
    let width = (high - low) / count;
    let grid = (0..=count as usize).map(|k| low + width * k as f64);
    let (best, _) = grid.map(|x| (x, cost(x))).fold((high, f64::INFINITY), |a, b| if b.1 < a.1 { b } else { a });
    golden_section([(best - width).max(low), (best + width).min(high)], cost).exp()
}

/// The least of a function with one minimum in a range.
fn golden_section([mut low, mut high]: [f64; 2], cost: impl Fn(f64) -> f64) -> f64 {
    const PART: f64 = 0.618_033_988_749_894_8;
    let (mut left, mut right) = (high - PART * (high - low), low + PART * (high - low));
    let (mut of_left, mut of_right) = (cost(left), cost(right));
    while high - low > PRECISION {
        if of_left < of_right {
            (high, right, of_right) = (right, left, of_left);
            left = high - PART * (high - low);
            of_left = cost(left);
        } else {
            (low, left, of_left) = (left, right, of_right);
            right = low + PART * (high - low);
            of_right = cost(right);
        }
    }
    0.5 * (low + high)
}

/// The Kalman filter of a channel: its gains, steady but after gaps, and its first state.
struct Filter<const P: usize> {
    step: f64,
    walk: RandomWalk<P>,
    /// The steady gain, and those of the samples in and after gaps.
    gains: Vec<Gain<P>>,
    /// The first sample and the gains of stretches that are not steady, in the order of time.
    unsteady: Vec<(usize, Range<usize>)>,
    /// The first state, by generalised least squares.
    start: [f64; P],
    /// Logarithm of the determinant of the start's information.
    log_information: f64,
}

impl<const P: usize> Filter<P> {
    /// The steady filter from a diffuse start: diffuse is what any covariance adds to a diffuse state, so that the gain is steady from the
    /// first sample on.
    fn new(step: f64, measured: &Measured<'_>) -> Self {
        let walk = RandomWalk::new(step);
        let steady = walk.steady(step);
        let mut filter =
            Self { step, walk, gains: vec![steady], unsteady: Vec::new(), start: [0.0; P], log_information: 0.0 };
        filter.cross(measured);
        filter.begin(measured);
        filter
    }

    /// The gains in and after each gap that is short enough.
    fn cross(&mut self, measured: &Measured<'_>) {
        let samples = measured.values.len();
        let is_short = |gap: &Range<usize>| gap.len() as f64 * self.step <= LONGEST_GAP;
        let missing: Vec<usize> = measured.gaps.iter().filter(|g| is_short(g)).flat_map(Clone::clone).collect();
        let mut at = 0;
        while at < missing.len() {
            let (first, start) = (missing[at], self.gains.len());
            let mut covariance = self.gains[0].covariance;
            for k in first..samples {
                let is_missing = missing.get(at) == Some(&k);
                at += usize::from(is_missing);
                let gain = self.walk.gain(covariance, !is_missing);
                covariance = self.walk.next_covariance(&gain);
                self.gains.push(gain);
                if !is_missing && self.is_settled(&covariance) {
                    break;
                }
            }
            self.unsteady.push((first, start..self.gains.len()));
        }
    }

    fn is_settled(&self, covariance: &Square<P>) -> bool {
        let steady = &self.gains[0].covariance;
        let scale = |i: usize, j: usize| (steady[i][i] * steady[j][j]).sqrt();
        (0..P).all(|i| (0..P).all(|j| (covariance[i][j] - steady[i][j]).abs() <= SETTLED * scale(i, j)))
    }

    /// The index of each sample's gain.
    fn gain_of_samples(&self, samples: usize) -> Vec<u32> {
        let mut of_samples = vec![0; samples];
        for (first, gains) in &self.unsteady {
            of_samples[*first..].iter_mut().zip(gains.clone()).for_each(|(of, gain)| *of = gain as u32);
        }
        of_samples
    }

    /// Finds the first state from the innovations of a filter that starts at zero, which depend on it as `H Phi_k`.
    fn begin(&mut self, measured: &Measured<'_>) {
        let of_samples = self.gain_of_samples(measured.values.len());
        let mut sensitivity: Square<P> = std::array::from_fn(|i| std::array::from_fn(|j| f64::from(i == j)));
        let mut information = Matrix::zeros(P, P);
        let mut score = vec![0.0; P];
        let mut state = [0.0; P];
        for (value, &of) in measured.values.iter().zip(&of_samples) {
            let gain = &self.gains[of as usize];
            let innovation = value - measured.values[0] - state[0];
            let row = sensitivity[0];
            if gain.is_measured {
                for i in 0..P {
                    score[i] += row[i] * innovation / gain.innovation;
                    (0..P).for_each(|j| *information.at_mut(i, j) += row[i] * row[j] / gain.innovation);
                }
            }
            let columns: Square<P> =
                std::array::from_fn(|j| self.walk.next(&std::array::from_fn(|i| sensitivity[i][j])));
            sensitivity = std::array::from_fn(|i| std::array::from_fn(|j| columns[j][i] - gain.gain[i] * row[j]));
            state = advanced(&self.walk, gain, &state, innovation);
            if sensitivity.iter().flatten().all(|value| value.abs() < FORGOTTEN) {
                break;
            }
        }
        if let Some(factor) = information.cholesky() {
            let found = factor.solve(&score);
            self.start = std::array::from_fn(|i| found[i]);
            let lower = factor.lower();
            self.log_information = (0..P).map(|i| 2.0 * lower.at(i, i).ln()).sum();
        }
    }

    /// Calls `with` for each sample in turn: its gain, predicted state and innovation.
    fn run(&self, measured: &Measured<'_>, of_samples: &[u32], mut with: impl FnMut(&Gain<P>, &[f64; P], f64)) {
        let mut state = self.start;
        for (value, &of) in measured.values.iter().zip(of_samples) {
            let gain = &self.gains[of as usize];
            let innovation = value - measured.values[0] - state[0];
            with(gain, &state, innovation);
            state = advanced(&self.walk, gain, &state, innovation);
        }
    }

    /// Minus twice the logarithm of the likelihood, without a constant; the variance of the measurement is concentrated out.
    fn cost(&self, measured: &Measured<'_>) -> f64 {
        let (squares, count, logarithms) = self.innovations(measured);
        let free = count as f64 - P as f64;
        let of_scale = (P * (P - 1)) as f64 * self.step.ln();
        free * (squares / free).max(f64::MIN_POSITIVE).ln() + logarithms + self.log_information - of_scale
    }

    /// Sum of the normalised squares of the innovations, their number, and the sum of the logarithms of their variances.
    fn innovations(&self, measured: &Measured<'_>) -> (f64, usize, f64) {
        let of_samples = self.gain_of_samples(measured.values.len());
        let (mut squares, mut count) = (0.0, 0);
        self.run(measured, &of_samples, |gain, _, innovation| {
            if gain.is_measured {
                squares += innovation * innovation / gain.innovation;
                count += 1;
            }
        });
        let unsteady = self.unsteady.iter().flat_map(|(_, gains)| gains.clone()).map(|i| &self.gains[i]);
        let of_unsteady: Vec<f64> = unsteady.filter(|g| g.is_measured).map(|g| g.innovation.ln()).collect();
        let steady = (count - of_unsteady.len()) as f64 * self.gains[0].innovation.ln();
        (squares, count, steady + of_unsteady.iter().sum::<f64>())
    }

    /// The states in every sample, in scaled time, and the variance of the measurement.
    fn smoothed(&self, measured: &Measured<'_>) -> (Vec<[f64; P]>, f64) {
        let of_samples = self.gain_of_samples(measured.values.len());
        let mut states = Vec::with_capacity(measured.values.len());
        let mut innovations = Vec::with_capacity(measured.values.len());
        let (mut squares, mut count) = (0.0, 0.0);
        self.run(measured, &of_samples, |gain, state, innovation| {
            states.push(*state);
            innovations.push(innovation / gain.innovation);
            if gain.is_measured {
                squares += innovation * innovation / gain.innovation;
                count += 1.0;
            }
        });
        let mut adjoint = [0.0; P];
        for k in (0..states.len()).rev() {
            let gain = &self.gains[of_samples[k] as usize];
            adjoint = self.walk.back(gain, &adjoint);
            if gain.is_measured {
                adjoint[0] += innovations[k];
            }
            let state = &mut states[k];
            gain.covariance.iter().zip(state.iter_mut()).for_each(|(row, value)| *value += dot(row, &adjoint));
            state[0] += measured.values[0];
        }
        (states, squares / (count - P as f64))
    }
}

/// The predicted state a step later.
fn advanced<const P: usize>(walk: &RandomWalk<P>, gain: &Gain<P>, state: &[f64; P], innovation: f64) -> [f64; P] {
    let next = walk.next(state);
    std::array::from_fn(|i| next[i] + gain.gain[i] * innovation)
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE_HZ: f64 = 100.0;
    /// Samples without a measurement.
    const GAP: Range<usize> = 150..165;

    /// Two waves with uniform noise of a standard deviation of 1e-3.
    fn wave(samples: usize) -> Vec<f64> {
        let mut state = 1_u64;
        let mut noise = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            1e-3 * 12_f64.sqrt() * ((state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5)
        };
        let motion = |t: f64| 2.0 + (6.0 * t).sin() + 0.1 * (TAU * 3.0 * t).cos();
        (0..samples).map(|k| motion(k as f64 / RATE_HZ) + noise()).collect()
    }

    /// States of a walk of 6 Hz: of an order, without or with the gap, and q, dq and ddq of samples.
    type States = (bool, [(usize, [f64; 3]); 4]);

    fn assert_states<const P: usize>(expected: &[States]) {
        for (with_gap, samples) in expected {
            let gaps = if *with_gap { &[GAP][..] } else { &[] };
            let measured = Measured { values: wave(400), gaps };
            let frequency = TAU * 6.0;
            let states = Filter::<P>::new(frequency / RATE_HZ, &measured).smoothed(&measured).0;
            for (k, expected) in samples {
                for (i, expected) in expected.iter().enumerate() {
                    let found = states[*k][i] * frequency.powi(i as i32);
                    let off = (found - expected).abs() / frequency.powi(i as i32);
                    assert!(off < 1e-9, "order {P}, sample {k}, state {i}: {found}, not {expected}");
                }
            }
        }
    }

    /// By statsmodels 0.15, `KalmanSmoother` with an exact diffuse start and `tolerance=0`: measurement noise of variance 1e-6, and the transition and
    /// noise of the walk.
    #[test]
    fn states_are_those_of_statsmodels() {
        assert_states::<3>(&[(
            false,
            [
                (0, [2.104_806_176_091_468, 5.688_485_223_584_234, -30.575_714_734_694_227]),
                (5, [2.351_432_033_126_024, 4.202_536_739_438_11, -27.112_496_202_553_16]),
                (200, [1.562_245_644_221_683_9, 5.057_013_972_607_510_5, -15.783_646_238_315_868]),
                (399, [1.176_292_587_964_241, 3.261_563_621_389_357_5, 21.457_355_936_535_375]),
            ],
        )]);
        assert_states::<4>(&[
            (
                false,
                [
                    (0, [2.099_020_141_771_318_6, 6.246_075_543_953_189, -53.197_367_281_383_01]),
                    (5, [2.354_232_455_996_199_6, 4.150_755_000_776_221, -30.587_988_154_531_67]),
                    (157, [1.979_718_989_462_630_6, -4.186_867_905_668_246_5, 8.672_284_610_852_37]),
                    (399, [1.168_359_953_904_424_5, 2.471_215_269_723_425_3, -11.539_200_708_673_83]),
                ],
            ),
            (
                true,
                [
                    (0, [2.099_020_141_771_167_6, 6.246_075_543_922_681, -53.197_367_278_661_53]),
                    (157, [1.983_079_097_684_237_8, -4.193_161_040_863_383, 7.570_121_082_941_136]),
                    (200, [1.563_396_119_733_440_3, 5.057_561_556_762_281, -16.202_153_675_940_938]),
                    (399, [1.168_359_953_904_424_5, 2.471_215_269_723_422, -11.539_200_708_673_938]),
                ],
            ),
        ]);
        assert_states::<5>(&[(
            true,
            [
                (0, [2.098_218_508_989_488_5, 6.310_768_002_904_804, -55.374_919_405_635_346]),
                (157, [1.982_009_648_616_298, -4.175_638_863_519_699_5, 7.914_484_543_474_678_4]),
                (200, [1.563_691_611_382_066, 5.057_989_363_235_05, -16.307_087_003_358_706]),
                (399, [1.166_262_396_371_759_5, 2.230_989_845_736_942, -23.465_090_680_728_18]),
            ],
        )]);
    }

    /// By statsmodels, with the likelihood maximised over both variances. The search here ends within 1 % of the frequency, and of the deviation of the noise.
    #[test]
    fn the_most_likely_variances_are_those_of_statsmodels() {
        let expected = [
            (3, false, 15.716_39, 9.824_501e-4),
            (4, false, 10.675_80, 9.952_146e-4),
            (5, false, 8.452_52, 9.969_118e-4),
            (3, true, 15.744_29, 9.893_067e-4),
            (4, true, 10.683_44, 1.002_157e-3),
            (5, true, 8.455_47, 1.003_490e-3),
        ];
        for (order, with_gap, frequency_hz, deviation) in expected {
            let gaps = if with_gap { &[GAP][..] } else { &[] };
            let found = smooth_motion(&Series::shaped(1, wave(400)), gaps, RATE_HZ, order).unwrap();
            let [cutoff, noise] = [found.cutoffs_hz[0] / frequency_hz, found.noise[0] / deviation];
            assert!((cutoff - 1.0).abs() < 0.01 && (noise - 1.0).abs() < 0.01, "order {order}: {cutoff} {noise}");
        }
    }

    /// By statsmodels: the logarithm of the likelihood at 5 Hz less that at 8 Hz, with the best variance of the noise for each, and
    /// with a diffuse start in units that do not depend on the frequency.
    #[test]
    fn differences_of_likelihoods_are_those_of_statsmodels() {
        let measured = Measured { values: wave(400), gaps: &[] };
        let cost = |hz: f64| Filter::<4>::new(TAU * hz / RATE_HZ, &measured).cost(&measured);
        assert!((0.5 * (cost(8.0) - cost(5.0)) + 575.405_337_726_1).abs() < 1e-6);
        let with_gap = Measured { values: wave(400), gaps: &[GAP] };
        let cost = |hz: f64| Filter::<5>::new(TAU * hz / RATE_HZ, &with_gap).cost(&with_gap);
        assert!((0.5 * (cost(8.0) - cost(5.0)) + 510.047_299_286_2).abs() < 1e-6);
    }

    /// Inside, a wave passes with the gain `1 / (1 + (f / f0)^2P)`; sampling 50 times per period adds less than 1e-6.
    #[test]
    fn a_wave_passes_with_the_gain_in_closed_form() {
        let wave = |hz: f64| (0..4000).map(|k| (TAU * hz * f64::from(k) / 1000.0).sin()).collect();
        for hz in [10.0, 20.0, 30.0] {
            let measured = Measured { values: wave(hz), gaps: &[] };
            let states = Filter::<4>::new(TAU * 20.0 / 1000.0, &measured).smoothed(&measured).0;
            let gain = 1.0 / (1.0 + (hz / 20.0).powi(8));
            for i in 0..3 {
                let amplitude = states[1000..3000].iter().map(|s| s[i] * s[i]).sum::<f64>() / 1000.0;
                let expected = gain * (hz / 20.0).powi(i as i32);
                assert!((amplitude.sqrt() / expected - 1.0).abs() < 1e-5, "{hz} Hz: {}", amplitude.sqrt());
            }
        }
    }

    #[test]
    fn polynomials_below_the_order_pass_with_their_derivatives_up_to_the_ends() {
        let cubic = |t: f64| 1.0 + t - 2.0 * t * t + 0.5 * t * t * t;
        let measured = Measured { values: (0..300).map(|k| cubic(f64::from(k) / RATE_HZ)).collect(), gaps: &[GAP] };
        let frequency = TAU * 5.0;
        let states = Filter::<4>::new(frequency / RATE_HZ, &measured).smoothed(&measured).0;
        for k in [0, 1, 157, 299] {
            let t = k as f64 / RATE_HZ;
            let ddq = states[k][2] * frequency * frequency;
            assert!((states[k][0] - cubic(t)).abs() < 1e-10 && (ddq - (3.0 * t - 4.0)).abs() < 1e-6, "{k}: {ddq}");
        }
    }

    /// A wave without noise, which one smooths no more than the search allows, and one with noise.
    #[test]
    fn a_channel_without_noise_is_at_the_limit() {
        let clean = (0..400).map(|k| (0.06 * f64::from(k)).sin()).collect();
        let found = smooth_motion(&Series::side_by_side(&[clean, wave(400)]), &[], RATE_HZ, 4).unwrap();
        assert_eq!(found.is_at_limit, [true, false]);
    }

    #[test]
    fn other_orders_and_short_recordings_are_refused() {
        let position = Series::shaped(1, wave(31));
        assert_eq!(smooth_motion(&position, &[], RATE_HZ, 2), Err(SignalError::SmootherOrder { found: 2 }));
        let short = SignalError::RecordTooShort { needed: 32, found: 31 };
        assert_eq!(smooth_motion(&position, &[], RATE_HZ, 4), Err(short));
    }
}
