//! Time stamps that are the times of arrival of samples taken at equal steps.

use thetahat_data::recording::Clock;
use thetahat_ground::series::Series;

/// Rms deviation of the steps, in steps, from which stamps are doubted: below, both readings give nearly the same motion.
const LEAST_JITTER: f64 = 0.1;
/// Largest difference of a stamp from its equal time, in steps: samples that are missing together shift all later ones by more.
const LARGEST_SHIFT: f64 = 0.75;
/// Roughness of a joint's positions at equal steps, relative to that by the stamps, below which the steps were equal.
const SMOOTHER: f64 = 0.25;

/// The equal times of samples whose stamps jitter, where the positions say that they were taken at equal steps: by their stamps they are
/// rough, and one after the other they are smooth. Where the stamps are times of sampling, or samples are missing, it is the other way round.
pub(super) fn equal_times(times: &[f64], clock: &Clock, position: &Series) -> Option<Vec<f64>> {
    clock.resampling().filter(|resampling| resampling.rms_deviation > LEAST_JITTER)?;
    let (first, last) = (times.first()?, times.last()?);
    let step = (last - first) / (times.len() - 1) as f64;
    let equal: Vec<f64> = (0..times.len()).map(|k| first + step * k as f64).collect();
    if times.iter().zip(&equal).any(|(stamp, equal)| (stamp - equal).abs() > LARGEST_SHIFT * step) {
        return None;
    }
    let by_stamps = clock.to_equal_steps(position.clone());
    let ratio = |j: usize| roughness(position, j) / roughness(&by_stamps, j);
    let ratios: Vec<f64> = (0..position.channels()).map(ratio).filter(|r| r.is_finite()).collect();
    let arrive = ratios.iter().any(|r| *r < SMOOTHER) && ratios.iter().all(|r| *r < 1.0 / SMOOTHER);
    arrive.then_some(equal)
}

/// Mean square of the fourth difference, which hardly contains motion.
fn roughness(series: &Series, channel: usize) -> f64 {
    let x = series.channel(channel);
    let squares = x.windows(5).map(|w| (w[0] - 4.0 * w[1] + 6.0 * w[2] - 4.0 * w[3] + w[4]).powi(2));
    squares.sum::<f64>() / x.len() as f64
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    const SAMPLES: usize = 2000;

    fn jitter(k: usize) -> f64 {
        0.3 * ((78.233 * k as f64).sin() * 43_758.545_3).fract()
    }

    fn found(stamps: &[f64], taken: &dyn Fn(usize) -> f64) -> Option<Vec<f64>> {
        let motion = |t: f64, j: f64| (0.25 * t + j).sin() + 1e-5 * (9.1 * t).sin();
        let values = (0..SAMPLES).flat_map(|k| [motion(taken(k), 0.0), motion(taken(k), 1.0)]).collect();
        let clock = Clock::from_stamps(stamps.to_vec(), 0.5, Path::new("log.csv"), "time").unwrap();
        equal_times(stamps, &clock, &Series::shaped(2, values))
    }

    #[test]
    fn the_positions_distinguish_arrival_from_sampling() {
        let stamps: Vec<f64> = (0..SAMPLES).map(|k| k as f64 + jitter(k)).collect();
        let equal = found(&stamps, &|k| k as f64).unwrap();
        assert!((0..SAMPLES).all(|k| (equal[k] - k as f64).abs() < 0.5));
        assert_eq!(found(&stamps, &|k| stamps[k]), None);
        let even: Vec<f64> = (0..SAMPLES).map(|k| k as f64).collect();
        assert_eq!(found(&even, &|k| k as f64), None);
    }

    /// Where a sample is missing the positions jump: their order gives no information about the times.
    #[test]
    fn missing_samples_keep_their_stamps() {
        let true_time = |k: usize| (k + 3 * (k / 1000)) as f64;
        let stamps: Vec<f64> = (0..SAMPLES).map(|k| true_time(k) + 0.8 * jitter(k)).collect();
        assert_eq!(found(&stamps, &true_time), None);
    }
}
