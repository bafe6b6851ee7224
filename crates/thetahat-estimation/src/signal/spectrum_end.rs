use super::spectrum::Spectrum;
use thetahat_ground::series::Series;

/// Density, relative to the largest, below which no motion is left: raw torques have noise and friction above it.
const NOTHING: f64 = 1e-8;
/// Fraction of half the sample rate above which the density is compared with the density just above the end of the motion.
const TOP: f64 = 0.8;
/// Factor by which a filtered density still falls between the two; a floor of noise does not fall.
const FALLS: f64 = 0.1;

/// The frequency, Hz, at which the torques of a log end if they were low-passed before recording: above it the density of every channel is
/// below 1e-8 of its largest and keeps falling. None if they are raw, with a floor of noise.
///
/// The torques of the recorded LWR4+ end at 7 Hz and those of the UR10 at 8 Hz; the densities of the raw TX40 stay above 1e-6.
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
    let above_end = spectrum.median(channel, end_hz..2.0 * end_hz)?;
    let top = spectrum.median(channel, TOP * nyquist_hz..nyquist_hz)?;
    (top < FALLS * above_end).then_some(end_hz)
}

#[cfg(test)]
mod tests {
    use super::super::{design::SecondOrderSections, zero_phase::Padding, zero_phase::zero_phase};
    use super::*;

    const RATE_HZ: f64 = 500.0;

    /// Swings with steps of friction, and noise of a fraction of them.
    fn raw(noise: f64) -> Series {
        let value = |k: usize| {
            let t = k as f64 / RATE_HZ;
            let dq = (2.0 * t).cos() + 0.4 * (5.3 * t).cos();
            20.0 * (2.0 * t).sin() + 5.0 * dq.signum() + noise * ((k * k % 1009) as f64 / 1009.0 - 0.5)
        };
        Series::shaped(1, (0..8000).map(value).collect())
    }

    #[test]
    fn filtered_and_raw_logs_are_distinguished() {
        for noise in [1.0, 0.05] {
            assert_eq!(spectrum_end_hz(&raw(noise), RATE_HZ), None);
        }
        let filter = SecondOrderSections::butterworth_lowpass(4, 10.0, RATE_HZ).unwrap();
        let filtered = zero_phase(&filter, &raw(1.0), Padding::Matlab).unwrap();
        let end = spectrum_end_hz(&filtered, RATE_HZ).unwrap();
        assert!((10.0..40.0).contains(&end), "{end}");
    }
}
