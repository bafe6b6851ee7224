//! Finds a Fourier series in a recorded motion.

use std::ops::Range;

use super::{
    fourier::{FourierSeries, Terms},
    period::{Thinned, candidates, periodic_stretch},
};
use thetahat_ground::linear_algebra::{Matrix, PivotedQr, dot};

/// Fewest periods in which a motion must repeat.
pub const FEWEST_PERIODS: f64 = 2.0;
/// Largest rms deviation of a joint's motion from the series, and of each period from the others, relative to the deviation from its mean.
const LARGEST_DEVIATION: f64 = 0.02;
/// Rms deviation, rad or m, that always counts as small.
const SMALL: f64 = 1e-3;
/// Fraction of the window in which the motion must repeat.
const LEAST_PART: f64 = 0.5;
/// Harmonics reach at most this fraction of the cut-off: the position filter is flat below.
const HIGHEST: f64 = 0.6;
/// Most harmonics.
const MOST_HARMONICS: usize = 60;
/// Highest degree of the polynomial.
const HIGHEST_DEGREE: usize = 5;
/// A degree is added if it reduces the rms deviation of a joint by this factor.
const WORTH_A_DEGREE: f64 = 0.9;
/// Rms, relative to a joint's motion, of harmonics that may be omitted although the periods agree on them: friction produces small ones up
/// to any frequency, where the recording is noise.
const NEGLIGIBLE: f64 = 1e-3;
/// Most steps of Gauss-Newton for the base frequency, and the relative change at which they end.
const ITERATIONS: usize = 8;
const CONVERGED: f64 = 1e-9;
/// Number of harmonics with which the base frequency is first determined.
const FIRST_HARMONICS: usize = 8;
/// Fraction of a period by which the last one may be incomplete.
const INCOMPLETE: f64 = 0.02;

/// A periodic motion found in a recording.
#[derive(Debug, Clone, PartialEq)]
pub struct Periodic {
    /// The motion in closed form; time zero is the first sample of the recording.
    pub series: FourierSeries,
    /// Start and end of the stretch in which the motion repeats, s.
    pub stretch_s: [f64; 2],
    /// Periods in that stretch.
    pub periods: f64,
}

/// How a recording was low-passed before its motion is searched: Butterworth, forward and backward.
#[derive(Debug, Clone, Copy)]
pub struct LowPass {
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Order of one pass.
    pub order: usize,
    /// Its cut-off, Hz.
    pub cutoff_hz: f64,
}

impl LowPass {
    /// `1 / (1 + (tan(pi f T) / tan(pi f_c T))^2n)`.
    fn gain(&self, frequency_hz: f64) -> f64 {
        let warped = |f: f64| (std::f64::consts::PI * f / self.sample_rate_hz).tan();
        1.0 / (1.0 + (warped(frequency_hz) / warped(self.cutoff_hz)).powi(2 * self.order as i32))
    }
}

/// The Fourier series of a motion that repeats at least twice; none if it does not.
///
/// `position` holds the low-passed positions of the whole recording, `window` the samples that are searched. Periods are the lags after
/// which the motion repeats; the shortest period whose series describes the motion is chosen. The motion must repeat in at least half of
/// the window: transients may come before and after. The base frequency is that of least squares. The number of harmonics is the smallest
/// with which the other periods predict each period best, except for 0.1 % of its motion. A degree of the polynomial is added while it
/// reduces the deviation by a tenth. The filter's gain is divided out of every harmonic.
#[must_use]
pub fn find_periodic(
    position: &thetahat_ground::series::Series,
    window: &Range<usize>,
    low_pass: LowPass,
) -> Option<Periodic> {
    let motion = Thinned::new(position, window, low_pass.sample_rate_hz, low_pass.cutoff_hz)?;
    candidates(&motion).into_iter().find_map(|lag| Search { motion: &motion, low_pass }.periodic(lag))
}

struct Search<'a> {
    motion: &'a Thinned,
    low_pass: LowPass,
}

/// Terms with their coefficients, and the remaining deviation of each joint.
struct Fitted {
    terms: Terms,
    coefficients: Matrix,
    rest: Matrix,
    design: Matrix,
    qr: PivotedQr,
}

impl Fitted {
    fn rms(&self) -> Vec<f64> {
        let of_joint = |j| dot(self.rest.column(j), self.rest.column(j)) / self.rest.rows() as f64;
        (0..self.rest.columns()).map(|j| of_joint(j).sqrt()).collect()
    }
}

impl Search<'_> {
    /// The series with approximately this period, in samples of the thinned motion; none if it does not describe the motion.
    fn periodic(&self, lag: f64) -> Option<Periodic> {
        let stretch = periodic_stretch(self.motion, lag)?;
        let periods = stretch.len() as f64 / lag;
        let part = stretch.len() as f64 / self.motion.samples() as f64;
        if periods + INCOMPLETE < FEWEST_PERIODS || part < LEAST_PART {
            return None;
        }
        let all = self.first_terms(&stretch, lag)?;
        let first = Terms { harmonics: all.harmonics.min(FIRST_HARMONICS), ..all };
        let drifting = self.with_frequency(&stretch, Terms { degree: 1, ..first })?;
        let harmonics = self.harmonics_by_periods(&stretch, &drifting, all.harmonics)?;
        let degree = self.degree(&stretch, Terms { harmonics, ..drifting.terms })?;
        let fitted = self.with_frequency(&stretch, Terms { harmonics, degree, ..drifting.terms })?;
        if !self.is_small(&fitted.rms()) {
            return None;
        }
        let time = |k: usize| self.motion.time_s(k);
        Some(Periodic {
            stretch_s: [time(stretch.start), time(stretch.end - 1)],
            periods: stretch.len() as f64 * self.motion.step_s * fitted.terms.base_frequency_hz,
            series: self.series(&fitted),
        })
    }

    /// All harmonics that the filter and the number of samples allow, with a constant.
    fn first_terms(&self, stretch: &Range<usize>, lag: f64) -> Option<Terms> {
        let base_frequency_hz = 1.0 / (lag * self.motion.step_s);
        let below_cutoff = HIGHEST * self.low_pass.cutoff_hz / base_frequency_hz;
        let harmonics = below_cutoff.min(lag / 4.0).min(MOST_HARMONICS as f64) as usize;
        let half_length_s = 0.5 * stretch.len() as f64 * self.motion.step_s;
        let centre_s = self.motion.time_s(stretch.start) + half_length_s;
        (harmonics > 0).then_some(Terms { base_frequency_hz, centre_s, half_length_s, degree: 0, harmonics })
    }

    /// The degree of the polynomial.
    fn degree(&self, stretch: &Range<usize>, terms: Terms) -> Option<usize> {
        let mut best = self.fit(stretch, Terms { degree: 0, ..terms })?;
        for degree in 1..=HIGHEST_DEGREE {
            let next = self.fit(stretch, Terms { degree, ..terms })?;
            let (was, is) = (best.rms(), next.rms());
            if (0..was.len()).any(|j| self.motion.weight(j) > 0.0 && is[j] < WORTH_A_DEGREE * was[j]) {
                best = next;
            }
        }
        Some(best.terms.degree)
    }

    /// Coefficients and base frequency by least squares: each joint is weighted by its deviation from its mean.
    fn with_frequency(&self, stretch: &Range<usize>, mut terms: Terms) -> Option<Fitted> {
        for _ in 0..ITERATIONS {
            let part = self.frequency_step(&self.fit(stretch, terms)?, stretch);
            terms.base_frequency_hz *= 1.0 + part.clamp(-0.01, 0.01);
            if part.abs() < CONVERGED {
                break;
            }
        }
        self.fit(stretch, terms)
    }

    /// Coefficients by least squares.
    fn fit(&self, stretch: &Range<usize>, terms: Terms) -> Option<Fitted> {
        let design = self.design(stretch, &terms);
        let qr = PivotedQr::new(&design);
        if stretch.len() < 2 * terms.count() || qr.rank(1e-10) < terms.count() {
            return None;
        }
        let measured = self.measured(stretch);
        let coefficients = qr.solve_matrix(&measured);
        let rest = measured.plus(&design.times_matrix(&coefficients), -1.0);
        Some(Fitted { terms, coefficients, rest, design, qr })
    }

    fn design(&self, rows: &Range<usize>, terms: &Terms) -> Matrix {
        let mut design = Matrix::zeros(rows.len(), terms.count());
        for (row, k) in rows.clone().enumerate() {
            terms.each(self.motion.time_s(k), |i, value| *design.at_mut(row, i) = value[0]);
        }
        design
    }

    fn measured(&self, rows: &Range<usize>) -> Matrix {
        Matrix::from_fn(rows.len(), self.motion.joints(), |k, j| self.motion.channels[j][rows.start + k])
    }

    /// The relative change of the base frequency in one Gauss-Newton step.
    fn frequency_step(&self, fitted: &Fitted, stretch: &Range<usize>) -> f64 {
        let joints = self.motion.joints();
        let mut slopes = Matrix::zeros(stretch.len(), joints);
        for (row, k) in stretch.clone().enumerate() {
            let time = self.motion.time_s(k);
            let u = time - fitted.terms.centre_s;
            let periodic = |i: usize| i > fitted.terms.degree;
            fitted.terms.each(time, |i, value| {
                let by_joint = 0..if periodic(i) { joints } else { 0 };
                by_joint.for_each(|j| *slopes.at_mut(row, j) += fitted.coefficients.at(i, j) * value[1] * u);
            });
        }
        let across = slopes.plus(&fitted.design.times_matrix(&fitted.qr.solve_matrix(&slopes)), -1.0);
        let sum = |other: &Matrix| -> f64 {
            (0..joints).map(|j| self.motion.weight(j) * dot(across.column(j), other.column(j))).sum()
        };
        let size = sum(&across);
        if size > 0.0 { sum(&fitted.rest) / size } else { 0.0 }
    }

    /// The fewest harmonics with which the periods predict one another as well as with the best number, except for 0.1 % of the motion;
    /// none if they do not.
    ///
    /// The mean of the other periods' coefficients predicts those of a period: over K periods with coefficients c_k and
    /// their mean c, the squared error of a harmonic is `(K / (K - 1))^2 sum |c_k - c|^2` with it, and `sum |c_k|^2` without.
    fn harmonics_by_periods(&self, stretch: &Range<usize>, fitted: &Fitted, most: usize) -> Option<usize> {
        let periods = self.period_coefficients(stretch, fitted, most)?;
        let count = periods.len() as f64;
        let joints = self.motion.joints();
        let mut with = vec![vec![0.0; joints]; most + 1];
        let mut without = with.clone();
        for (h, j) in (1..=most).flat_map(|h| (0..joints).map(move |j| (h, j))) {
            for i in [2 * h - 1, 2 * h] {
                let values: Vec<f64> = periods.iter().map(|p| p.at(i, j)).collect();
                let mean = values.iter().sum::<f64>() / count;
                let spread: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
                with[h][j] += (count / (count - 1.0)).powi(2) * spread;
                without[h][j] += dot(&values, &values);
            }
        }
        let error = |most_of: usize, j: usize| -> f64 {
            (1..=most).map(|h| if h <= most_of { with[h][j] } else { without[h][j] }).sum()
        };
        let weighted = |n: usize| (0..joints).map(|j| self.motion.weight(j) * error(n, j)).sum::<f64>();
        let best = (1..=most).min_by(|a, b| weighted(*a).total_cmp(&weighted(*b)))?;
        // Half the squared amplitude is the mean square of a harmonic.
        let square = |n: usize, j: usize| 0.5 * error(n, j) / count;
        let allowed = |j: usize| square(best, j) + (NEGLIGIBLE * self.motion.deviations[j]).powi(2);
        let enough = (1..=best).find(|n| (0..joints).all(|j| square(*n, j) <= allowed(j)))?;
        let rms: Vec<f64> = (0..joints).map(|j| square(enough, j).sqrt()).collect();
        self.is_small(&rms).then_some(enough)
    }

    /// The coefficients of each whole period, from the residual of the polynomial.
    fn period_coefficients(&self, stretch: &Range<usize>, fitted: &Fitted, harmonics: usize) -> Option<Vec<Matrix>> {
        let length = 1.0 / (fitted.terms.base_frequency_hz * self.motion.step_s);
        let terms = Terms { degree: 0, harmonics, ..fitted.terms };
        let drift = Terms { harmonics: 0, ..fitted.terms };
        let of_drift = Matrix::from_fn(drift.count(), self.motion.joints(), |i, j| fitted.coefficients.at(i, j));
        let place = |p: usize| (stretch.start + (p as f64 * length).round() as usize).min(stretch.end);
        let of_period = |p: usize| {
            let rows = place(p)..place(p + 1);
            let qr = PivotedQr::new(&self.design(&rows, &terms));
            let rest = self.measured(&rows).plus(&self.design(&rows, &drift).times_matrix(&of_drift), -1.0);
            let full_rank = rows.len() >= terms.count() && qr.rank(1e-10) == terms.count();
            full_rank.then(|| qr.solve_matrix(&rest))
        };
        let whole = (stretch.len() as f64 / length + INCOMPLETE) as usize;
        (0..whole).map(of_period).collect::<Option<Vec<_>>>().filter(|periods| periods.len() > 1)
    }

    fn is_small(&self, rms: &[f64]) -> bool {
        rms.iter().zip(&self.motion.deviations).all(|(rms, d)| *rms <= (LARGEST_DEVIATION * d).max(SMALL))
    }

    /// The series with the filter's gain divided out of its harmonics.
    fn series(&self, fitted: &Fitted) -> FourierSeries {
        let gain = |i: usize| match i.saturating_sub(fitted.terms.degree).div_ceil(2) {
            0 => 1.0,
            h => self.low_pass.gain(h as f64 * fitted.terms.base_frequency_hz),
        };
        let row = |i: usize| (0..self.motion.joints()).map(|j| fitted.coefficients.at(i, j) / gain(i)).collect();
        FourierSeries::new(fitted.terms, (0..fitted.terms.count()).map(row).collect())
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use thetahat_ground::series::Series;

    const LOW_PASS: LowPass = LowPass { sample_rate_hz: 200.0, order: 4, cutoff_hz: 10.0 };
    const BASE_HZ: f64 = 0.173;

    /// Two joints with three harmonics.
    fn wave(t: f64, j: usize) -> f64 {
        let of = |h: f64| (TAU * BASE_HZ * h * t + h * h + j as f64).sin() / h;
        0.4 * (of(1.0) - of(2.0) + of(3.0))
    }

    fn record(seconds: f64, of: impl Fn(f64, usize) -> f64) -> Series {
        let time = (0..(seconds * LOW_PASS.sample_rate_hz) as usize).map(|k| k as f64 / LOW_PASS.sample_rate_hz);
        Series::shaped(2, time.flat_map(|t| [of(t, 0), of(t, 1)]).collect())
    }

    /// Noise of a standard deviation of 1, smooth below the cut-off.
    fn noise(t: f64, j: usize) -> f64 {
        (0..40)
            .map(|i| (TAU * (0.031 + 0.193 * f64::from(i)) * t + f64::from(i * i) * 1.3 + j as f64).sin())
            .sum::<f64>()
            / 20_f64.sqrt()
    }

    fn find(record: &Series) -> Option<Periodic> {
        find_periodic(record, &(0..record.len()), LOW_PASS)
    }

    #[test]
    fn base_frequency_and_harmonics_are_found() {
        let found = find(&record(30.0, |t, j| wave(t, j) + 1e-3 * noise(t, j))).unwrap();
        assert!((found.series.base_frequency_hz() / BASE_HZ - 1.0).abs() < 1e-4, "{found:?}");
        assert_eq!((found.series.harmonics(), found.series.degree()), (3, 0), "{found:?}");
        assert!((found.periods - 30.0 * BASE_HZ).abs() < 0.05, "{}", found.periods);
    }

    #[test]
    fn without_noise_the_motion_is_exact_but_for_the_filter() {
        let record = record(30.0, wave);
        let found = find(&record).unwrap();
        let q = found.series.sample(LOW_PASS.sample_rate_hz, record.len()).q;
        let largest = q.values().iter().zip(record.values()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        // The gain at the third harmonic is 1 - 3e-11.
        assert!(largest < 1e-9, "{largest}");
    }

    #[test]
    fn averaging_over_periods_leaves_less_noise_than_the_recording_has() {
        let found = find(&record(60.0, |t, j| wave(t, j) + 2e-3 * noise(t, j))).unwrap();
        let q = found.series.sample(LOW_PASS.sample_rate_hz, 12_000).q;
        let square = |k: usize| (q.sample(k)[0] - wave(k as f64 / LOW_PASS.sample_rate_hz, 0)).powi(2);
        let rms = ((0..q.len()).map(square).sum::<f64>() / q.len() as f64).sqrt();
        assert!(rms < 0.3 * 2e-3, "{rms}");
    }

    #[test]
    fn a_drift_and_a_start_up_are_no_obstacle() {
        let drifting = find(&record(30.0, |t, j| wave(t, j) + 0.02 * t)).unwrap();
        assert_eq!((drifting.series.harmonics(), drifting.series.degree()), (3, 1));
        let starting = |t: f64, j: usize| wave(t, j) * (1.0 - (-t).exp() * (1.0 + t)) + (-2.0 * t).exp();
        let found = find(&record(30.0, starting)).unwrap();
        assert!(found.stretch_s[0] > 1.0 && found.stretch_s[0] < 8.0 && found.stretch_s[1] > 29.0, "{found:?}");
        assert!((found.series.base_frequency_hz() / BASE_HZ - 1.0).abs() < 1e-2);
    }

    #[test]
    fn a_motion_that_does_not_repeat_is_not_periodic() {
        assert_eq!(find(&record(30.0, |t, j| 0.3 * noise(t, j))), None);
        // One period and a half.
        assert_eq!(find(&record(1.5 / BASE_HZ, wave)), None);
        // Two frequencies with no period in the recording.
        assert_eq!(find(&record(30.0, |t, j| (t + j as f64).sin() + (t * 2_f64.sqrt()).cos())), None);
        // A sweep.
        assert_eq!(find(&record(30.0, |t, j| (0.1 * t * t + j as f64).sin())), None);
        // An amplitude that grows.
        assert_eq!(find(&record(30.0, |t, j| wave(t, j) * (1.0 + 0.05 * t))), None);
    }

    #[test]
    fn two_periods_are_enough() {
        assert!(find(&record(2.05 / BASE_HZ, wave)).is_some());
    }
}
