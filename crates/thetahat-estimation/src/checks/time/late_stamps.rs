//! Whether the time stamps are the times of sampling or of arrival.
//!
//! A recording is resampled to equal steps by its time stamps. A sample taken at `u` and stamped at `u + d` then has the wrong
//! time: its position is `q(t - d) = q(t) - d dq(t)`. If the true steps are equal, `d` is known from the stamps. The roughness
//! of the positions is then `-f` times the roughness of `d dq`: f is 1 if the stamps are times of arrival, and 0 if they are
//! times of sampling.

use std::ops::Range;

use crate::checks::subject::Subject;

/// Weights of the fourth difference: of a motion at a hundredth of the rate it leaves a hundred-thousandth.
const FOURTH: [f64; 5] = [1.0, -4.0, 6.0, -4.0, 1.0];
/// Blocks of time for the standard deviation of the factor.
const BLOCKS: usize = 10;
/// Standard deviation of the factor above which the positions do not decide.
const UNSURE: f64 = 0.1;
/// Largest difference of the factor from 0 or 1.
const CLEAR: f64 = 0.25;
/// Steps around samples without a stamp that are not used.
const AROUND: usize = 8;

/// The meaning of the time stamps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::checks) enum StampMeaning {
    /// Times of sampling.
    Sampling,
    /// Times of arrival of samples that were taken at equal steps.
    Arrival,
    /// The positions do not decide.
    Unknown,
}

/// The meaning of the time stamps, from the positions at equal steps in the window.
pub(in crate::checks) fn stamp_meaning(subject: &Subject<'_>, time: &[f64]) -> StampMeaning {
    let window = subject.signal.window.clone();
    let late = &lateness(time, subject.position.len())[window.clone()];
    let rows = rows(subject.left_out, window.len());
    let position = subject.position.window(window);
    let mut sums = Sums::default();
    (0..position.channels()).for_each(|j| sums.add(&position.channel(j), late, &rows));
    sums.meaning()
}

/// How much later than equal steps the stamps are around each step, in steps.
fn lateness(time: &[f64], samples: usize) -> Vec<f64> {
    let (first, last) = (time[0], time[time.len() - 1]);
    let step = (last - first) / (samples - 1) as f64;
    let mut equal_step = 0.0;
    let later = time.windows(2).map(|pair| {
        equal_step += ((pair[1] - pair[0]) / step).round().max(1.0);
        (pair[1] - first) / step - equal_step
    });
    let late: Vec<f64> = std::iter::once(0.0).chain(later).collect();
    let mut before = 0;
    let at = |k: usize| {
        let t = first + step * k as f64;
        while before + 2 < time.len() && time[before + 1] <= t {
            before += 1;
        }
        let part = ((t - time[before]) / (time[before + 1] - time[before])).clamp(0.0, 1.0);
        late[before] + part * (late[before + 1] - late[before])
    };
    (0..samples).map(at).collect()
}

/// The first samples of the fourth differences without samples that are left out or next to such.
fn rows(left_out: &[Range<usize>], samples: usize) -> Vec<usize> {
    let mut near = vec![false; samples];
    for range in left_out {
        near[range.start.saturating_sub(AROUND).min(samples)..(range.end + AROUND).min(samples)].fill(true);
    }
    let starts = 2..samples.saturating_sub(FOURTH.len() + 1);
    starts.filter(|&k| !near[k - 2..k + FOURTH.len() + 2].contains(&true)).collect()
}

fn fourth_difference(x: impl Fn(usize) -> f64, k: usize) -> f64 {
    FOURTH.iter().enumerate().map(|(i, weight)| weight * x(k + i)).sum()
}

/// Sums over the joints, by block of time; each joint's roughness has a mean square of one.
#[derive(Default)]
struct Sums {
    /// The roughness of the position times that of the position error of the stamps.
    cross: [f64; BLOCKS],
    /// The square of the latter roughness.
    square: [f64; BLOCKS],
}

impl Sums {
    fn add(&mut self, position: &[f64], late: &[f64], rows: &[usize]) {
        // Velocity times a step, from samples two steps away: the shift of the sample itself does not enter.
        let shift = |k: usize| late[k] * (position[k + 2] - position[k - 2]) / 4.0;
        let pairs: Vec<[f64; 2]> =
            rows.iter().map(|&k| [fourth_difference(|i| position[i], k), fourth_difference(shift, k)]).collect();
        let squares: f64 = pairs.iter().map(|[rough, _]| rough * rough).sum();
        if squares == 0.0 {
            return;
        }
        let weight = pairs.len() as f64 / squares;
        for (i, [rough, shifted]) in pairs.iter().enumerate() {
            let block = i * BLOCKS / pairs.len();
            self.cross[block] += weight * rough * shifted;
            self.square[block] += weight * shifted * shifted;
        }
    }

    fn meaning(&self) -> StampMeaning {
        let square: f64 = self.square.iter().sum();
        let factor = -self.cross.iter().sum::<f64>() / square;
        let scores = self.cross.iter().zip(&self.square).map(|(cross, square)| cross + factor * square);
        let deviation = scores.map(|s| s * s).sum::<f64>().sqrt() / square;
        let is_precise = deviation < UNSURE;
        match (is_precise && factor.abs() < CLEAR, is_precise && (factor - 1.0).abs() < CLEAR) {
            (true, _) => StampMeaning::Sampling,
            (_, true) => StampMeaning::Arrival,
            (false, false) => StampMeaning::Unknown,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SAMPLES: usize = 4000;

    fn noise(k: usize) -> f64 {
        2.0 * ((78.233 * k as f64).sin() * 43_758.545_3).fract().abs() - 1.0
    }

    fn motion(t: f64) -> f64 {
        (0.02 * t).sin() + 0.3 * (0.051 * t).cos()
    }

    /// The meaning found for samples that were taken at given times, in steps, and stamped with 0.15 steps of noise about equal
    /// steps.
    fn meaning_found(taken: impl Fn(usize) -> f64, position_noise: f64) -> StampMeaning {
        let stamps: Vec<f64> = (0..SAMPLES).map(|k| k as f64 + 0.15 * noise(k)).collect();
        let clock =
            thetahat_data::recording::Clock::from_stamps(stamps.clone(), 0.5, std::path::Path::new("q.csv"), "t")
                .unwrap();
        let recorded = (0..SAMPLES).map(|k| motion(taken(k)) + position_noise * noise(k + SAMPLES)).collect();
        let position = clock.to_equal_steps(thetahat_ground::series::Series::shaped(1, recorded)).channel(0);
        let mut sums = Sums::default();
        sums.add(&position, &lateness(&stamps, position.len()), &rows(&[], position.len()));
        sums.meaning()
    }

    #[test]
    fn the_positions_show_what_the_stamps_mean() {
        let jittered = |k: usize| k as f64 + 0.15 * noise(k);
        for position_noise in [0.0, 1e-5, 1e-3] {
            assert_eq!(meaning_found(jittered, position_noise), StampMeaning::Sampling, "{position_noise}");
            assert_eq!(meaning_found(|k| k as f64, position_noise), StampMeaning::Arrival, "{position_noise}");
        }
        let half = |k: usize| k as f64 + 0.075 * noise(k);
        assert_eq!(meaning_found(half, 1e-5), StampMeaning::Unknown);
        assert_eq!(meaning_found(jittered, 0.1), StampMeaning::Unknown);
    }
}
