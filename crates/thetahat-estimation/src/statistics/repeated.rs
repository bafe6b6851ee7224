//! Errors that come back with a motion that repeats: quantised positions, the texture of a gear, what the model lacks.
//!
//! They are no noise that more repetitions average out. Their autocovariance at whole periods is far outside of the window of
//! [`Sandwich::stationary`], which adds it here.

use realfft::RealFftPlanner;
use thetahat_ground::linear_algebra::dot;

use super::{Sandwich, block::Block, sandwich::squares};
use crate::regression::RowLayout;

/// Recordings, over those whose autocorrelation at some lag counts as one after a period by chance.
const BY_CHANCE: f64 = 10.0;
/// Least part of a recording's rows that has a row one period later.
const FEWEST_PAIRS: f64 = 0.125;
/// Most periods of which the found one may consist.
const MOST_PARTS: usize = 12;
/// Part of the largest autocorrelation from which that of a part of the period counts as the same.
const AS_LARGE: f64 = 0.6;

/// A repetition in one stretch of time.
#[derive(Debug, Clone, Copy)]
struct Repetition {
    stretch: usize,
    /// The period in rows, which need not be whole.
    period: f64,
}

/// What repeated errors add to the variance of each parameter.
pub(super) struct RepeatedErrors {
    pub(super) variances: Vec<f64>,
    /// Rows of the shortest period; the variances have no more degrees of freedom.
    pub(super) freedom: f64,
}

impl Sandwich<'_> {
    /// The variance that repeated errors add; none if the residual does not show that they repeat.
    ///
    /// With phases `p` of the period and sums over pairs of different periods, of the influence `A_l(p) = sum a(t) a(t')` and of the
    /// residual `E_l(p) = sum e(t) e(t')` with t of phase p and t' of phase p + l, and their number `N_l(p)`, it is
    /// `sum_p sum_l w(l) A_l(p) E_l(p) / N_l(p)`: errors that are large at some phases count there (as H. White, 1980, in time).
    /// `w` are Bartlett's weights of [`Sandwich::newey_west`] for one period; lag zero alone counts where it gives more, as a fit takes
    /// slow errors from its residual.
    pub(super) fn repeated(&self, blocks: &[Block], leverage: &[f64]) -> Option<RepeatedErrors> {
        let repetitions = repetitions(self.rows, self.residual);
        let shortest = repetitions.iter().map(|r| r.period).min_by(f64::total_cmp)?;
        let mut variances = vec![0.0; self.influence.columns()];
        for (block, place) in blocks.iter().zip(self.rows.blocks()) {
            let Some(found) = repetitions.iter().find(|r| r.stretch == place.stretch) else { continue };
            let leverage: f64 = leverage[block.rows.clone()].iter().sum();
            let shares = self.rows.shares_or_ones(block.rows.clone());
            let covariances = found.covariances(&self.residual[block.rows.clone()], &shares, leverage);
            let of_column = |i: usize| found.variance(&covariances, &block.part_of(self.influence.column(i)));
            variances.iter_mut().enumerate().for_each(|(i, v)| *v += of_column(i));
        }
        let variances = variances.into_iter().map(|v| v.max(0.0)).collect();
        Some(RepeatedErrors { variances, freedom: shortest })
    }
}

/// How many times the variance of an error that is uncorrelated in time is exceeded along a motion that repeats, of each joint:
/// `1 + (n / P - 1) gamma_P / gamma` with n rows and a period of P; one where the residual does not repeat.
#[must_use]
pub fn repeated_widening(layout: &RowLayout, residual: &[f64]) -> Vec<f64> {
    let mut widening = vec![1.0_f64; layout.joints()];
    let found = repetitions(layout, residual);
    for block in layout.blocks() {
        let Some(repetition) = found.iter().find(|r| r.stretch == block.stretch) else { continue };
        let e = &residual[block.rows.clone()];
        let shares = layout.shares_or_ones(block.rows.clone());
        let of_block = 1.0 + (e.len() as f64 / repetition.period - 1.0) * repetition.repeated_part(e, &shares);
        let of_joint = &mut widening[block.joint];
        *of_joint = of_joint.max(of_block);
    }
    widening
}

fn repetitions(layout: &RowLayout, residual: &[f64]) -> Vec<Repetition> {
    let stretches = layout.blocks().iter().map(|b| b.stretch + 1).max().unwrap_or(0);
    (0..stretches).filter_map(|stretch| repetition(layout, residual, stretch)).collect()
}

/// The lag at which the residuals of all joints together come back.
fn repetition(layout: &RowLayout, residual: &[f64], stretch: usize) -> Option<Repetition> {
    let blocks: Vec<std::ops::Range<usize>> =
        layout.blocks().iter().filter(|b| b.stretch == stretch).map(|b| b.rows.clone()).collect();
    let of_joint = |rows: &std::ops::Range<usize>| {
        Autocorrelation::new(&residual[rows.clone()], &layout.shares_or_ones(rows.clone()))
    };
    let joints: Vec<Autocorrelation> = blocks.iter().filter_map(of_joint).collect();
    let count = joints.iter().map(|j| j.values.len()).min()?;
    let mean = |l: usize| joints.iter().map(|j| j.values[l]).sum::<f64>() / joints.len() as f64;
    let values: Vec<f64> = (0..count).map(mean).collect();
    let independent = independent_series(&blocks.iter().map(|rows| &residual[rows.clone()]).collect::<Vec<_>>());
    let variance = |l: usize| joints.iter().map(|j| j.wide / j.pairs[l]).fold(0.0, f64::max) / independent;
    let deviations = (2.0 * (BY_CHANCE * count as f64).ln()).sqrt();
    let shows = |l: usize| values[l] > deviations * variance(l).sqrt();
    // Errors that fade slowly are correlated up to their first change of sign, and those of filtered rows over a few rows more: the
    // window of [`Sandwich::stationary`], of at least the root of n rows, holds these.
    let first = values.iter().position(|r| *r <= 0.0)?.max((count as f64).sqrt() as usize);
    let enough = |l: &usize| joints.iter().all(|j| j.pairs[*l] >= FEWEST_PAIRS * j.pairs[0]);
    let peaks: Vec<usize> = (first..count - 1)
        .filter(enough)
        .filter(|&l| l > 0 && values[l] >= values[l - 1] && values[l] > values[l + 1] && shows(l))
        .collect();
    let largest = peaks.iter().copied().max_by(|a, b| values[*a].total_cmp(&values[*b]))?;
    let is_part = |l: usize| peaks.contains(&l) && values[l] >= AS_LARGE * values[largest];
    let near = |l: usize| [l, l.saturating_sub(1), l + 1].into_iter().find(|&l| is_part(l));
    let parts = (2..=MOST_PARTS).rev().find_map(|parts| near((largest + parts / 2) / parts));
    let period = parts.unwrap_or(largest);
    Some(Repetition { stretch, period: refined(&peaks, period) })
}

/// How many independent series have a mean autocorrelation of the same variance: `J^2 / sum_jk r_jk^2` by the correlations of J series.
fn independent_series(series: &[&[f64]]) -> f64 {
    let correlation = |a: &[f64], b: &[f64]| dot(a, b).powi(2) / (squares(a) * squares(b)).max(f64::MIN_POSITIVE);
    let sum: f64 = series.iter().flat_map(|a| series.iter().map(move |b| correlation(a, b))).sum();
    (series.len() as f64).powi(2) / sum.max(1.0)
}

/// A period from the peak at its largest multiple: a whole number of rows is off by up to half of one, and that adds up.
fn refined(peaks: &[usize], period: usize) -> f64 {
    let mut refined = period as f64;
    for multiple in 2.. {
        let expected = refined * f64::from(multiple);
        let Some(last) = peaks.last().filter(|last| **last as f64 + 0.5 >= expected) else { break };
        let nearest =
            peaks.iter().min_by(|a, b| (**a as f64 - expected).abs().total_cmp(&(**b as f64 - expected).abs()));
        match nearest.filter(|p| (**p as f64 - expected).abs() <= 1.0 && *p <= last) {
            Some(peak) => refined = *peak as f64 / f64::from(multiple),
            None => break,
        }
    }
    refined
}

/// The autocorrelation of a joint's residual at every lag.
struct Autocorrelation {
    values: Vec<f64>,
    /// Products that a mask leaves at each lag.
    pairs: Vec<f64>,
    /// Sum of the squared correlations at the lags where they have not faded: white noise has one.
    wide: f64,
}

impl Autocorrelation {
    fn new(residual: &[f64], shares: &[f64]) -> Option<Self> {
        let pairs: Vec<f64> = products_at_lags(shares).into_iter().map(|p| p.max(1.0)).collect();
        let products = products_at_lags(residual);
        let own = products[0] / pairs[0];
        let is_used = own > 0.0 && residual.len() > 2;
        let values: Vec<f64> = products.iter().zip(&pairs).map(|(r, p)| r / p / own).collect();
        let near = values.iter().skip(1).take((residual.len() as f64).sqrt() as usize);
        let wide = 1.0 + 2.0 * near.map(|r| r * r).sum::<f64>();
        is_used.then_some(Self { values, pairs, wide })
    }
}

/// `sum_t x(t) x(t + l)` for every lag, by Fourier transforms of a series with as many zeros.
fn products_at_lags(x: &[f64]) -> Vec<f64> {
    let length = (2 * x.len()).next_power_of_two();
    let mut planner = RealFftPlanner::<f64>::new();
    let (forward, inverse) = (planner.plan_fft_forward(length), planner.plan_fft_inverse(length));
    let mut padded = x.to_vec();
    padded.resize(length, 0.0);
    let mut spectrum = forward.make_output_vec();
    // The lengths agree: that is all that these calls check.
    let done = forward.process(&mut padded, &mut spectrum).and_then(|()| {
        spectrum.iter_mut().for_each(|s| *s = (s.norm_sqr() / length as f64).into());
        inverse.process(&mut spectrum, &mut padded)
    });
    if done.is_err() {
        return vec![0.0; x.len()];
    }
    padded.truncate(x.len());
    padded
}

impl Repetition {
    /// The mean product of residuals of each phase and of the phase l later, in different periods, by l.
    fn covariances(&self, residual: &[f64], shares: &[f64], leverage: f64) -> Vec<Vec<f64>> {
        // The fit takes its part of the errors in each phase.
        let left = (1.0 - leverage / self.period).max(0.5);
        let lags = ((4.0 * (self.period / 100.0).powf(2.0 / 9.0)) as usize + 1).min((0.5 * self.period) as usize);
        let of_lag = |lag: usize| {
            let [products, pairs] = [residual, shares].map(|x| self.of_phases(x, lag));
            products.iter().zip(pairs).map(|(p, n)| if n > 0.5 { p / n / left } else { 0.0 }).collect()
        };
        (0..lags.max(1)).map(of_lag).collect()
    }

    fn variance(&self, covariances: &[Vec<f64>], a: &[f64]) -> f64 {
        let of_lag = |(lag, covariance): (usize, &Vec<f64>)| dot(&self.of_phases(a, lag), covariance);
        let lags: Vec<f64> = covariances.iter().enumerate().map(of_lag).collect();
        let weight = |lag: usize| 2.0 * (1.0 - lag as f64 / lags.len() as f64);
        let all: f64 = lags[0] + (1..lags.len()).map(|lag| weight(lag) * lags[lag]).sum::<f64>();
        all.max(lags[0])
    }

    /// The phases of rows, and how many there are.
    fn phase(&self, row: usize) -> usize {
        (row as f64).rem_euclid(self.period).round() as usize % self.phases()
    }

    fn phases(&self) -> usize {
        self.period.ceil() as usize
    }

    /// `sum x(t) x(t')` over pairs of different periods, t' a lag later in phase, by the phase of t.
    fn of_phases(&self, x: &[f64], lag: usize) -> Vec<f64> {
        let phases = self.phases();
        let mut folded = vec![0.0; phases];
        let mut own = vec![0.0; phases];
        for (t, value) in x.iter().enumerate() {
            folded[self.phase(t)] += value;
            own[self.phase(t)] += value * x.get(t + lag).copied().unwrap_or(0.0);
        }
        (0..phases).map(|p| folded[p] * folded[(p + lag) % phases] - own[p]).collect()
    }

    /// The part of the variance that repeats.
    fn repeated_part(&self, residual: &[f64], shares: &[f64]) -> f64 {
        let total = |x: &[f64]| self.of_phases(x, 0).iter().sum::<f64>();
        let repeated = total(residual) / total(shares).max(1.0);
        let all = squares(residual) / squares(shares).max(1.0);
        if all > 0.0 { (repeated / all).clamp(0.0, 1.0) } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;
    use thetahat_ground::linear_algebra::Matrix;

    const PERIOD: usize = 97;

    fn white(random: &mut ChaCha8Rng, count: usize) -> Vec<f64> {
        (0..count).map(|_| StandardNormal.sample(random)).collect()
    }

    /// Whether the variance of the mean slope along a repeated motion is that of many draws.
    fn ratio(repeated: f64, rows: usize) -> (f64, f64) {
        let x: Vec<f64> = (0..rows).map(|k| (std::f64::consts::TAU * 3.0 * k as f64 / PERIOD as f64).sin()).collect();
        let size: f64 = x.iter().map(|v| v * v).sum();
        let design = Matrix::from_columns(rows, x.clone());
        let influence = Matrix::from_fn(rows, 1, |k, _| x[k] / size);
        let layout = RowLayout::new(1, &[rows]);
        let mut random = ChaCha8Rng::seed_from_u64(3);
        let (mut squares, mut estimated) = (0.0, 0.0);
        let draws = 300;
        for _ in 0..draws {
            let texture = white(&mut random, PERIOD);
            let noise = white(&mut random, rows);
            let e: Vec<f64> = (0..rows).map(|k| noise[k] + repeated * texture[k % PERIOD]).collect();
            let error: f64 = (0..rows).map(|k| influence.at(k, 0) * e[k]).sum();
            let residual: Vec<f64> = (0..rows).map(|k| e[k] - x[k] * error).collect();
            let sandwich = Sandwich { design: &design, influence: &influence, residual: &residual, rows: &layout };
            squares += error * error;
            estimated += sandwich.stationary()[0].variance;
        }
        (estimated / squares, (estimated / f64::from(draws)).sqrt())
    }

    #[test]
    fn the_variance_holds_errors_that_repeat_and_stays_where_none_do() {
        for rows in [2 * PERIOD + 9, 7 * PERIOD] {
            let (found, _) = ratio(2.0, rows);
            assert!((0.8..1.25).contains(&found), "{rows} rows: {found}");
            let (found, _) = ratio(0.0, rows);
            assert!((0.8..1.25).contains(&found), "{rows} rows of noise: {found}");
        }
    }

    #[test]
    fn a_period_that_is_no_whole_number_of_rows_is_found() {
        let mut random = ChaCha8Rng::seed_from_u64(5);
        let (period, rows) = (40.4, 1000);
        let shape = |t: f64| (1..4).map(|h| (std::f64::consts::TAU * f64::from(h * h) * t / period).sin()).sum::<f64>();
        let noise = white(&mut random, rows);
        let residual: Vec<f64> = (0..rows).map(|k| shape(k as f64) + noise[k]).collect();
        let layout = RowLayout::new(1, &[rows]);
        let found = repetition(&layout, &residual, 0).map(|r| r.period);
        assert!(found.is_some_and(|p| (p - period).abs() < 0.1), "{found:?}");
    }

    #[test]
    fn the_widening_is_that_of_the_part_that_repeats() {
        let mut random = ChaCha8Rng::seed_from_u64(7);
        let rows = 10 * PERIOD;
        let texture = white(&mut random, PERIOD);
        let noise = white(&mut random, rows);
        let residual: Vec<f64> = (0..rows).map(|k| noise[k] + texture[k % PERIOD]).collect();
        let layout = RowLayout::new(1, &[rows]);
        // Half of the variance repeats in ten periods.
        let found = repeated_widening(&layout, &residual)[0];
        assert!((found / 5.5 - 1.0).abs() < 0.15, "{found}");
        assert_eq!(repeated_widening(&layout, &noise), [1.0]);
    }

    #[test]
    fn rows_that_a_filter_correlates_do_not_repeat() {
        let mut random = ChaCha8Rng::seed_from_u64(11);
        let noise = white(&mut random, 1307);
        // A filter that rings: neighbours of three rows are alike.
        let residual: Vec<f64> = noise.windows(7).map(|w| w[3] - 0.4 * (w[2] + w[4]) + 0.3 * (w[0] + w[6])).collect();
        assert!(repetition(&RowLayout::new(1, &[residual.len()]), &residual, 0).is_none());
    }

    #[test]
    fn the_products_of_other_periods_are_those_of_the_definition() {
        let x: Vec<f64> = (0..23).map(|k| f64::from(k * k % 11) - 4.0).collect();
        for l in 0..3 {
            let found: f64 = Repetition { stretch: 0, period: 7.0 }.of_phases(&x, l).iter().sum();
            let mut expected = 0.0;
            for (t, a) in x.iter().enumerate() {
                for (s, b) in x.iter().enumerate() {
                    if (s + 7 - t % 7) % 7 == l && s.abs_diff(t) > 3 {
                        expected += a * b;
                    }
                }
            }
            assert!((found - expected).abs() < 1e-9, "{l}: {found} {expected}");
        }
    }
}
