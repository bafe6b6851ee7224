//! The band-passed motion of the window, at the full rate.

use super::{
    numbers::{NORMAL_PER_MEDIAN, quantile_abs},
    subject::Subject,
};
use crate::signal::{Derivative, SignalError, band_pass};
use thetahat_ground::series::Series;

/// Peak velocity in rad/s or m/s below which a coordinate does not move, as in the choice of the window.
pub(super) const STILL: f64 = 1e-3;

/// The motion of the window at the full rate, band-passed as for the estimate.
pub(super) struct Signals {
    /// Positions as recorded.
    pub(super) raw: Series,
    /// Velocities and accelerations, band-passed.
    pub(super) dq: Series,
    pub(super) ddq: Series,
    /// Largest velocity of each coordinate.
    pub(super) peak: Vec<f64>,
    /// Standard deviation of the white part of each position's noise.
    pub(super) noise: Vec<f64>,
}

impl Signals {
    pub(super) fn new(subject: &Subject<'_>, cutoff_hz: f64) -> Result<Self, SignalError> {
        let window = subject.signal.window.clone();
        let raw = subject.position.window(window.clone());
        let order = subject.signal.filter_order;
        let motion = band_pass(subject.position, subject.sample_rate_hz, order, cutoff_hz, Derivative::Central)?;
        let [dq, ddq] = [motion.dq, motion.ddq].map(|s| s.window(window.clone()));
        let coordinates = 0..raw.channels();
        let peak = coordinates.clone().map(|j| quantile_abs(dq.channel(j).into_iter(), 1.0)).collect();
        let noise = coordinates.map(|j| white_noise(&raw.channel(j))).collect();
        Ok(Self { raw, dq, ddq, peak, noise })
    }

    pub(super) fn coordinates(&self) -> usize {
        self.raw.channels()
    }

    /// Whether coordinate `j` moves at all.
    pub(super) fn moves(&self, j: usize) -> bool {
        self.peak[j] > STILL
    }
}

/// The standard deviation of white noise on a smooth signal, from the median size of its sixth differences: they are
/// `sqrt(924)` times the noise, without the motion.
fn white_noise(x: &[f64]) -> f64 {
    const BINOMIAL: [f64; 7] = [1.0, -6.0, 15.0, -20.0, 15.0, -6.0, 1.0];
    let sixth = x.windows(7).map(|w| w.iter().zip(BINOMIAL).map(|(x, b)| b * x).sum::<f64>());
    let gain = BINOMIAL.iter().map(|b| b * b).sum::<f64>().sqrt();
    NORMAL_PER_MEDIAN * quantile_abs(sixth, 0.5) / gain
}
