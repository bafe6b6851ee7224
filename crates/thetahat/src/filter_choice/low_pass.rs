//! The corner of a low-pass through which signals went before they were recorded.

use crate::preparation::Recording;
use thetahat_estimation::signal::Spectrum;
use thetahat_ground::series::Series;

/// Factor by which the density of a torque falls over an octave above the corner of a low-pass; friction's steps fall by four.
const FALLS: f64 = 10.0;
/// Density over the least one up to which it is rounding.
const ROUNDING: f64 = 10.0;
/// Steps of an octave.
const STEPS: i32 = 3;
/// Bands below half the sample rate that may hold rounding alone: below more, the floor is one of noise.
const HIGHEST: usize = 6;
/// Bands over which a density must fall.
const FALLING: usize = 3;

/// The frequency, Hz, above which the densities of all torques fall steeply; `None` if they do not.
pub(super) fn low_pass_hz(torque: &Series, rate: f64) -> Option<f64> {
    let spectrum = Spectrum::of(torque, rate);
    let knees = (0..torque.channels()).map(|channel| knee_hz(&spectrum, channel, 0.5 * rate));
    let mut knees: Vec<f64> = knees.collect::<Option<_>>()?;
    knees.sort_by(f64::total_cmp);
    knees.get(knees.len() / 2).copied()
}

/// The lowest frequency of the steep end of a density.
fn knee_hz(spectrum: &Spectrum, channel: usize, nyquist_hz: f64) -> Option<f64> {
    let start = |i: i32| nyquist_hz / 2.0_f64.powf(f64::from(i) / f64::from(STEPS));
    let band = |i: i32| spectrum.median(channel, start(i + 1)..start(i));
    let bands: Vec<f64> = (0..10 * STEPS).map_while(band).collect();
    let least = bands.iter().copied().fold(f64::INFINITY, f64::min);
    let top = bands.iter().position(|d| *d > ROUNDING * least).filter(|top| *top <= HIGHEST)?;
    let fall = FALLS.powf(1.0 / f64::from(STEPS));
    let falls = bands[top..].windows(2).take_while(|pair| pair[1] > fall * pair[0]).count();
    (falls >= FALLING).then(|| start((top + falls) as i32))
}

/// Twice the frequency, Hz, up to which the positions of a recording contain noise: the sample rate, or twice the corner of the torques'
/// low-pass if the positions were low-passed as well.
pub(super) fn rate_of_noise(recording: &Recording) -> f64 {
    let Recording { position, torque, sample_rate_hz: rate, .. } = recording;
    let Some(knee) = torque.as_ref().and_then(|torque| low_pass_hz(torque, *rate)) else { return *rate };
    let spectrum = Spectrum::of(position, *rate);
    let falls = |channel: usize| {
        let median = |from: f64, to: f64| spectrum.median(channel, from * knee..to * knee).unwrap_or(f64::NAN);
        let (below, at, above) = (median(0.4, 0.5), median(0.8, 1.0), median(1.6, 2.0));
        at > FALLS * above && below < FALLS * at
    };
    let falling = (0..position.channels()).filter(|&channel| falls(channel)).count();
    if 2 * falling > position.channels() { 2.0 * knee } else { *rate }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;
    use thetahat_estimation::signal::{Padding, SecondOrderSections, zero_phase};

    const RATE_HZ: f64 = 1000.0;

    /// Swings with steps of friction and noise: torques, and positions with noise.
    fn swings() -> [Series; 2] {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let mut noise = || -> f64 { StandardNormal.sample(&mut rng) };
        let phase = |k: usize| 3.0 * k as f64 / RATE_HZ;
        let torque = |k: usize| 20.0 * phase(k).sin() + 5.0 * phase(k).cos().signum() + 0.1 * noise();
        let torque: Vec<f64> = (0..12_000).map(torque).collect();
        let position: Vec<f64> = (0..12_000).map(|k| -phase(k).sin() + 3e-5 * noise()).collect();
        [torque, position].map(|values| Series::shaped(1, values))
    }

    #[test]
    fn a_low_passed_recording_differs_from_a_raw_one() {
        let [torque, position] = swings();
        let recorded = |position: &Series, torque: &Series| Recording::new(RATE_HZ, position.clone(), torque.clone());
        assert_eq!(low_pass_hz(&torque, RATE_HZ), None);
        assert_eq!(rate_of_noise(&recorded(&position, &torque)), RATE_HZ);
        for cutoff_hz in [60.0, 150.0] {
            let filter = SecondOrderSections::butterworth_lowpass(2, cutoff_hz, RATE_HZ).unwrap();
            let [low, smooth] = [&torque, &position].map(|s| zero_phase(&filter, s, Padding::Matlab).unwrap());
            let found = low_pass_hz(&low, RATE_HZ).unwrap();
            assert!((found / cutoff_hz).log2().abs() < 0.5, "{found} for {cutoff_hz}");
            assert_eq!(rate_of_noise(&recorded(&smooth, &low)), 2.0 * found);
            // Positions that were recorded raw have noise up to half the rate.
            assert_eq!(rate_of_noise(&recorded(&position, &low)), RATE_HZ);
        }
    }
}
