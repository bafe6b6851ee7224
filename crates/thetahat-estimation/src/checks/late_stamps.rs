//! Whose instants the time stamps are: those of the samples, or those of their arrival.
//!
//! A sample that was taken at `u` and stamped at `u + d` stands at the wrong place of a record that is brought to equal steps by
//! its stamps: its position there is `q(t - d) = q(t) - d dq(t)`. Where the true steps are equal, `d` is known from the stamps.
//! What is rough in the positions is then `-f` times the roughness of `d dq`: f is 1 where the stamps are those of the arrival,
//! and 0 where the samples were taken when their stamps say.

use std::ops::Range;

use super::subject::Subject;

/// Weights of the fourth difference: of a motion at a hundredth of the rate it leaves a hundred-thousandth.
const FOURTH: [f64; 5] = [1.0, -4.0, 6.0, -4.0, 1.0];
/// Blocks of time by which the factor's standard deviation is found.
const BLOCKS: usize = 10;
/// Standard deviation of the factor from which on the positions do not tell.
const UNSURE: f64 = 0.1;
/// How far from 0 or 1 the factor may be.
const CLEAR: f64 = 0.25;
/// Steps around samples without a stamp that are not looked at.
const AROUND: usize = 8;

/// Whose instants the stamps are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Stamped {
    /// Those of the samples.
    Sampling,
    /// Those of the arrival of samples that were taken at equal steps.
    Arrival,
    /// The positions do not tell.
    Unknown,
}

/// Whose instants the stamps are, by the positions at equal steps in the window.
pub(super) fn stamped(subject: &Subject<'_>, time: &[f64]) -> Stamped {
    let window = subject.signal.window.clone();
    let late = &lateness(time, subject.position.len())[window.clone()];
    let rows = rows(subject.left_out, window.len());
    let position = subject.position.window(window);
    let mut sums = Sums::default();
    (0..position.channels()).for_each(|j| sums.add(&position.channel(j), late, &rows));
    sums.stamped()
}

/// How much later than equal steps the stamps around each of them are, in steps.
fn lateness(time: &[f64], samples: usize) -> Vec<f64> {
    let (first, last) = (time[0], time[time.len() - 1]);
    let step = (last - first) / (samples - 1) as f64;
    let mut place = 0.0;
    let later = time.windows(2).map(|pair| {
        place += ((pair[1] - pair[0]) / step).round().max(1.0);
        (pair[1] - first) / step - place
    });
    let late: Vec<f64> = std::iter::once(0.0).chain(later).collect();
    let mut behind = 0;
    let at = |k: usize| {
        let t = first + step * k as f64;
        while behind + 2 < time.len() && time[behind + 1] <= t {
            behind += 1;
        }
        let part = ((t - time[behind]) / (time[behind + 1] - time[behind])).clamp(0.0, 1.0);
        late[behind] + part * (late[behind + 1] - late[behind])
    };
    (0..samples).map(at).collect()
}

/// The first samples of the fourth differences that hold no sample that is left out, nor any beside one.
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
    /// The roughness of the position times that of what the stamps make of it.
    cross: [f64; BLOCKS],
    /// The square of the latter.
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

    fn stamped(&self) -> Stamped {
        let square: f64 = self.square.iter().sum();
        let factor = -self.cross.iter().sum::<f64>() / square;
        let scores = self.cross.iter().zip(&self.square).map(|(cross, square)| cross + factor * square);
        let deviation = scores.map(|s| s * s).sum::<f64>().sqrt() / square;
        let is_sure = deviation < UNSURE;
        match (is_sure && factor.abs() < CLEAR, is_sure && (factor - 1.0).abs() < CLEAR) {
            (true, _) => Stamped::Sampling,
            (_, true) => Stamped::Arrival,
            (false, false) => Stamped::Unknown,
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

    /// The verdict on samples that were taken at some instants, in steps, and stamped 0.15 steps of noise beside equal steps.
    fn of(taken: impl Fn(usize) -> f64, position_noise: f64) -> Stamped {
        let stamps: Vec<f64> = (0..SAMPLES).map(|k| k as f64 + 0.15 * noise(k)).collect();
        let clock =
            thetahat_data::recording::Clock::from_stamps(stamps.clone(), 0.5, std::path::Path::new("q.csv"), "t")
                .unwrap();
        let recorded = (0..SAMPLES).map(|k| motion(taken(k)) + position_noise * noise(k + SAMPLES)).collect();
        let position = clock.to_equal_steps(thetahat_ground::series::Series::shaped(1, recorded)).channel(0);
        let mut sums = Sums::default();
        sums.add(&position, &lateness(&stamps, position.len()), &rows(&[], position.len()));
        sums.stamped()
    }

    #[test]
    fn the_positions_tell_whose_instants_the_stamps_are() {
        let jittered = |k: usize| k as f64 + 0.15 * noise(k);
        for position_noise in [0.0, 1e-5, 1e-3] {
            assert_eq!(of(jittered, position_noise), Stamped::Sampling, "{position_noise}");
            assert_eq!(of(|k| k as f64, position_noise), Stamped::Arrival, "{position_noise}");
        }
        let half = |k: usize| k as f64 + 0.075 * noise(k);
        assert_eq!(of(half, 1e-5), Stamped::Unknown);
        assert_eq!(of(jittered, 0.1), Stamped::Unknown);
    }
}
