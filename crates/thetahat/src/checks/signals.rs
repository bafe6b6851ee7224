use super::{Subject, numbers::NORMAL_PER_MEDIAN, numbers::quantile_abs};
use crate::{
    series::Series,
    signal::{Padding, SecondOrderSections, SignalError, central_difference, zero_phase},
};

/// Peak velocity in rad/s or m/s below which a joint counts as still, as in the choice of the window.
pub(super) const STILL: f64 = 1e-3;

/// The motion of the window at the full rate, band-passed as for the estimate.
pub(super) struct Signals {
    /// Positions as recorded.
    pub(super) raw: Series,
    /// Velocities and accelerations, band-passed.
    pub(super) dq: Series,
    pub(super) ddq: Series,
    /// Largest velocity of each joint.
    pub(super) peak: Vec<f64>,
    /// Standard deviation of the white part of each position's noise.
    pub(super) noise: Vec<f64>,
}

impl Signals {
    pub(super) fn new(subject: &Subject<'_>, cutoff_hz: f64) -> Result<Self, SignalError> {
        let window = subject.signal.window.clone();
        let raw = subject.position.window(window.clone());
        let (_, dq, ddq) = band_pass(subject, subject.position, cutoff_hz)?;
        let [dq, ddq] = [dq, ddq].map(|s| s.window(window.clone()));
        let joints = 0..raw.channels();
        let peak = joints.clone().map(|j| quantile_abs(dq.channel(j).into_iter(), 1.0)).collect();
        let noise = joints.map(|j| white_noise(&raw.channel(j))).collect();
        Ok(Self { raw, dq, ddq, peak, noise })
    }

    pub(super) fn joints(&self) -> usize {
        self.raw.channels()
    }

    /// Whether joint `j` moves at all.
    pub(super) fn moves(&self, j: usize) -> bool {
        self.peak[j] > STILL
    }
}

/// Position, velocity and acceleration of a whole record, as the estimate has them.
pub(super) fn band_pass(
    subject: &Subject<'_>,
    position: &Series,
    cutoff_hz: f64,
) -> Result<(Series, Series, Series), SignalError> {
    let rate = subject.sample_rate_hz;
    let filter = SecondOrderSections::butterworth_lowpass(subject.signal.filter_order, cutoff_hz, rate)?;
    let q = zero_phase(&filter, position, Padding::Matlab)?;
    let dq = central_difference(&q, rate);
    let ddq = central_difference(&dq, rate);
    Ok((q, dq, ddq))
}

/// The standard deviation of white noise on a smooth signal: the median size of its sixth differences, whose noise is
/// `sqrt(924)` times as large and in which the motion is gone.
fn white_noise(x: &[f64]) -> f64 {
    const BINOMIAL: [f64; 7] = [1.0, -6.0, 15.0, -20.0, 15.0, -6.0, 1.0];
    let sixth = x.windows(7).map(|w| w.iter().zip(BINOMIAL).map(|(x, b)| b * x).sum::<f64>());
    let gain = BINOMIAL.iter().map(|b| b * b).sum::<f64>().sqrt();
    NORMAL_PER_MEDIAN * quantile_abs(sixth, 0.5) / gain
}
