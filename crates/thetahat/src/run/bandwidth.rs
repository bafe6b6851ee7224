use crate::preparation::{PreparationError, Setup};
use thetahat_estimation::signal::{Decimator, minus_3_db_bandwidth_hz};
use thetahat_report::results::Bandwidth;

/// Length, in periods of the cut-off, of the recording through which bandwidths are measured.
const PROBE_PERIODS: f64 = 200.0;

impl Setup<'_> {
    /// Sends an impulse through the filters as they are used on the recording, and measures where they are 3 dB down.
    pub(super) fn measure_bandwidth(&self, sample_rate_hz: f64) -> Result<Bandwidth, PreparationError> {
        let options = &self.settings.signal;
        let decimation_cutoff_hz = 0.8 * 0.5 * sample_rate_hz / options.decimation as f64;
        let length = |cutoff: f64| (PROBE_PERIODS * sample_rate_hz / cutoff).ceil() as usize;
        let filtered = length(options.cutoff_hz);
        let motion = |x: &_| self.band_pass(x, sample_rate_hz);
        let position = minus_3_db_bandwidth_hz(sample_rate_hz, filtered, 0, |x| motion(x).map(|m| m.q))?;
        let acceleration = minus_3_db_bandwidth_hz(sample_rate_hz, filtered, 2, |x| motion(x).map(|m| m.ddq))?;
        let decimated = length(decimation_cutoff_hz);
        let decimator = Decimator::new(options.decimation, decimated)?;
        let decimation = minus_3_db_bandwidth_hz(sample_rate_hz, decimated, 0, |x| decimator.filter(x))?;
        Ok(Bandwidth {
            position_cutoff_hz: options.cutoff_hz,
            position_measured_hz: position,
            acceleration_measured_hz: acceleration,
            decimation_cutoff_hz,
            decimation_measured_hz: decimation,
        })
    }
}
