//! The band-pass of positions that arrive sample by sample.

use std::f64::consts::PI;

use thetahat_ground::series::Series;

use super::{
    design::SecondOrderSections,
    differentiate::Derivative,
    error::SignalError,
    zero_phase::{Padding, zero_phase},
};

/// Part of its largest value at which the filter's response ends.
const REMAINDER: f64 = 1e-3;
/// Samples that the differences of a second derivative reach to either side.
const REACH: usize = 8;

/// The motion of [`band_pass`](super::band_pass()), sample by sample and later by a fixed delay.
///
/// The response of the filter that runs forward and backward is symmetric: brought to zero where it has decayed to a thousandth, it needs as
/// many samples after an instant as before it: three periods of the cut-off. Constant positions and velocities pass exactly, constant
/// accelerations to 5e-4.
///
/// ```
/// use thetahat_estimation::signal::{CausalBandPass, Derivative};
/// let mut filter = CausalBandPass::new(1, 1000.0, 4, 20.0, Derivative::NinePoint)?;
/// let [mut q, mut dq, mut ddq] = [[0.0]; 3];
/// for k in 0..1000 {
///     let t = 1e-3 * f64::from(k);
///     filter.push(&[0.5 * t * t], [&mut q, &mut dq, &mut ddq]);
/// }
/// let late = 0.999 - 1e-3 * filter.delay_samples() as f64;
/// assert!((dq[0] - late).abs() < 1e-9 && (ddq[0] - 1.0).abs() < 5e-4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct CausalBandPass {
    /// Weights of the samples for position, velocity and acceleration, the oldest sample first.
    weights: [Vec<f64>; 3],
    /// The last samples, channel after channel: each has room for twice the weights, and is moved when that is full.
    samples: Vec<Vec<f64>>,
    /// Samples since the start, at most as many as there are weights.
    filled: usize,
}

impl CausalBandPass {
    /// The filter of so many channels.
    ///
    /// # Errors
    /// As [`SecondOrderSections::butterworth_lowpass`].
    pub fn new(
        channels: usize,
        sample_rate_hz: f64,
        filter_order: usize,
        cutoff_hz: f64,
        derivative: Derivative,
    ) -> Result<Self, SignalError> {
        let filter = SecondOrderSections::butterworth_lowpass(filter_order, cutoff_hz, sample_rate_hz)?;
        let half = filter.settling_samples(REMAINDER);
        let response = ended(&filter, half)?;
        let velocity = derivative.of(&response, sample_rate_hz);
        let acceleration = derivative.of(&velocity, sample_rate_hz);
        // The weight of a sample is the response that much earlier.
        let reversed = |series: &Series| series.values().iter().rev().copied().collect();
        let weights: [Vec<f64>; 3] = [&response, &velocity, &acceleration].map(reversed);
        let samples = vec![Vec::with_capacity(2 * weights[0].len()); channels];
        Ok(Self { weights, samples, filled: 0 })
    }

    /// By how many samples the motion is late.
    #[must_use]
    pub fn delay_samples(&self) -> usize {
        self.weights[0].len() / 2
    }

    /// Forgets all samples, as after a gap.
    pub fn restart(&mut self) {
        self.filled = 0;
        self.samples.iter_mut().for_each(Vec::clear);
    }

    /// Takes the positions of a sample, one for each channel, and writes position, velocity and acceleration of the sample
    /// [`CausalBandPass::delay_samples`] earlier; false, with nothing written, until enough samples are known.
    ///
    /// # Panics
    /// If a slice is shorter than the channels.
    pub fn push(&mut self, position: &[f64], motion: [&mut [f64]; 3]) -> bool {
        let length = self.weights[0].len();
        for (samples, value) in self.samples.iter_mut().zip(position) {
            if samples.len() == 2 * length {
                samples.drain(..=length);
            }
            samples.push(*value);
        }
        self.filled = (self.filled + 1).min(length);
        if self.filled < length {
            return false;
        }
        for (weights, values) in self.weights.iter().zip(motion) {
            for (samples, value) in self.samples.iter().zip(values) {
                *value = weighted(&samples[samples.len() - length..], weights);
            }
        }
        true
    }
}

/// The sum of products in eight parts, which a processor adds side by side.
fn weighted(samples: &[f64], weights: &[f64]) -> f64 {
    let mut parts = [0.0; 8];
    let (samples, samples_left) = samples.as_chunks::<8>();
    let (weights, weights_left) = weights.as_chunks::<8>();
    for (s, w) in samples.iter().zip(weights) {
        (0..8).for_each(|i| parts[i] += s[i] * w[i]);
    }
    let left: f64 = samples_left.iter().zip(weights_left).map(|(s, w)| s * w).sum();
    parts.iter().sum::<f64>() + left
}

/// The response of both passes to an impulse, which ends smoothly `half` samples before and after it, with a sum of one and zeros for the
/// differences at both ends.
fn ended(filter: &SecondOrderSections, half: usize) -> Result<Series, SignalError> {
    let middle = 4 * half + 3 * filter.order();
    let mut impulse = Series::zeros(2 * middle + 1, 1);
    impulse.sample_mut(middle)[0] = 1.0;
    let whole = zero_phase(filter, &impulse, Padding::Matlab)?;
    let mut response = whole.window(middle - half - REACH..middle + half + REACH + 1);
    for (k, value) in response.values_mut().iter_mut().enumerate() {
        *value *= taper(k.abs_diff(half + REACH) as f64 / (half as f64 + 1.0));
    }
    let sum: f64 = response.values().iter().sum();
    response.values_mut().iter_mut().for_each(|value| *value /= sum);
    Ok(response)
}

/// One up to two thirds of the way, then half a cosine down to zero.
fn taper(part: f64) -> f64 {
    let fall = (3.0 * part - 2.0).clamp(0.0, 1.0);
    0.5 * (1.0 + (PI * fall).cos())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::{Motion, band_pass};

    const RATE_HZ: f64 = 500.0;
    const CUTOFF_HZ: f64 = 15.0;
    /// What the ends of the response change, of the largest value.
    const CUT: f64 = 5e-4;

    fn moving(k: usize) -> f64 {
        let t = k as f64 / RATE_HZ;
        0.8 * (4.0 * t).sin() + 0.2 * (11.0 * t + 1.0).cos() + 1.0
    }

    /// The delayed motion, from the sample on at which it begins.
    fn delayed(filter: &mut CausalBandPass, samples: usize) -> Motion {
        let mut found = [Vec::new(), Vec::new(), Vec::new()];
        for k in 0..samples {
            let [mut q, mut dq, mut ddq] = [[0.0]; 3];
            if filter.push(&[moving(k)], [&mut q, &mut dq, &mut ddq]) {
                found.iter_mut().zip([q, dq, ddq]).for_each(|(all, value)| all.push(value[0]));
            }
        }
        let [q, dq, ddq] = found.map(|values| Series::shaped(1, values));
        Motion { q, dq, ddq }
    }

    #[test]
    fn the_motion_is_that_of_the_filter_without_delay() {
        let mut filter = CausalBandPass::new(1, RATE_HZ, 4, CUTOFF_HZ, Derivative::NinePoint).unwrap();
        let found = delayed(&mut filter, 3000);
        let position = Series::shaped(1, (0..3000).map(moving).collect());
        let whole = band_pass(&position, RATE_HZ, 4, CUTOFF_HZ, Derivative::NinePoint).unwrap();
        let delay = filter.delay_samples();
        assert_eq!(found.q.len(), 3000 - 2 * delay);
        for (found, whole) in [(&found.q, &whole.q), (&found.dq, &whole.dq), (&found.ddq, &whole.ddq)] {
            let inside = whole.window(3 * delay..3000 - 3 * delay);
            let largest = inside.values().iter().fold(0.0_f64, |m, v| m.max(v.abs()));
            let found = found.window(2 * delay..3000 - 4 * delay);
            let difference = inside.values().iter().zip(found.values()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(difference < CUT * largest, "{difference} of {largest}");
        }
    }

    #[test]
    fn a_restart_forgets_all_samples() {
        let mut filter = CausalBandPass::new(1, RATE_HZ, 4, CUTOFF_HZ, Derivative::Central).unwrap();
        let first = delayed(&mut filter, 200);
        filter.restart();
        assert_eq!(delayed(&mut filter, 200), first);
    }
}
