use super::spectrum::Spectrum;
use thetahat_ground::series::Series;

/// Density, relative to the largest, below which nothing of the motion is left: raw torques have noise and friction above it.
const NOTHING: f64 = 1e-8;
/// Part of half the sample rate from which on the density behind a filter is looked at.
const TOP: f64 = 0.8;
/// Factor by which the density behind a filter still falls; a floor of noise does not.
const FALLS: f64 = 0.1;

/// Where the torques of a log end that were low-passed before they were recorded, Hz: the frequency above which the density
/// of every channel is below 1e-8 of its largest, and goes on falling. None where they are raw, with a floor of noise.
///
/// The recorded LWR4+ ends at 7 Hz and the UR10 at 8 Hz; of the raw TX40, densities stay above 1e-6.
#[must_use]
pub fn spectrum_end_hz(torque: &Series, sample_rate_hz: f64) -> Option<f64> {
    let spectrum = Spectrum::of(torque, sample_rate_hz);
    let ends = (0..torque.channels()).map(|channel| end_of(&spectrum, channel, 0.5 * sample_rate_hz));
    ends.collect::<Option<Vec<f64>>>()?.into_iter().reduce(f64::max)
}

fn end_of(spectrum: &Spectrum, channel: usize, nyquist_hz: f64) -> Option<f64> {
    let density = &spectrum.density[channel];
    let largest = density.iter().copied().fold(0.0, f64::max);
    let last = density.iter().rposition(|d| *d >= NOTHING * largest)?;
    let end_hz = (last + 1) as f64 * spectrum.step_hz;
    if largest == 0.0 || 2.0 * end_hz > TOP * nyquist_hz {
        return None;
    }
    let behind = spectrum.median(channel, end_hz..2.0 * end_hz)?;
    let top = spectrum.median(channel, TOP * nyquist_hz..nyquist_hz)?;
    (top < FALLS * behind).then_some(end_hz)
}

#[cfg(test)]
mod tests {
    use super::super::{design::SecondOrderSections, zero_phase::Padding, zero_phase::zero_phase};
    use super::*;

    const RATE_HZ: f64 = 500.0;

    /// Swings with steps of friction, and noise of a part of them.
    fn raw(noise: f64) -> Series {
        let value = |k: usize| {
            let t = k as f64 / RATE_HZ;
            let dq = (2.0 * t).cos() + 0.4 * (5.3 * t).cos();
            20.0 * (2.0 * t).sin() + 5.0 * dq.signum() + noise * ((k * k % 1009) as f64 / 1009.0 - 0.5)
        };
        Series::shaped(1, (0..8000).map(value).collect())
    }

    #[test]
    fn filtered_and_raw_logs_are_told_apart() {
        for noise in [1.0, 0.05] {
            assert_eq!(spectrum_end_hz(&raw(noise), RATE_HZ), None);
        }
        let filter = SecondOrderSections::butterworth_lowpass(4, 10.0, RATE_HZ).unwrap();
        let filtered = zero_phase(&filter, &raw(1.0), Padding::Matlab).unwrap();
        let end = spectrum_end_hz(&filtered, RATE_HZ).unwrap();
        assert!((10.0..40.0).contains(&end), "{end}");
    }
}
