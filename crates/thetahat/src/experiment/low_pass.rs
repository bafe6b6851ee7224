//! Torques that were recorded through a low-pass filter.

use thetahat_ground::series::Series;

/// The torques before a filter of first order with a time constant, in samples: of exponential smoothing
/// `y[k] = a y[k-1] + (1 - a) x[k]`, `a = exp(-1 / samples)`, the exact inverse.
pub(super) fn before_low_pass(filtered: &Series, samples: f64) -> Series {
    let kept = (-1.0 / samples).exp();
    let mut torque = filtered.clone();
    for k in 1..torque.len() {
        let values = filtered.sample(k).iter().zip(filtered.sample(k - 1));
        let before = values.map(|(now, last)| (now - kept * last) / (1.0 - kept));
        torque.sample_mut(k).iter_mut().zip(before).for_each(|(torque, before)| *torque = before);
    }
    torque
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two channels through the filter as a drive computes it, with its first value the first sample.
    #[test]
    fn the_inverse_gives_what_was_smoothed() {
        let torque: Vec<f64> = (0..200).map(|k| (0.3 * f64::from(k)).sin() + f64::from(k % 7)).collect();
        let torque = Series::shaped(2, torque);
        let samples = 12.5_f64;
        let mut smoothed = torque.clone();
        let gain = 1.0 - (-1.0 / samples).exp();
        for k in 1..torque.len() {
            for j in 0..2 {
                let last = smoothed.sample(k - 1)[j];
                smoothed.sample_mut(k)[j] = last + gain * (torque.sample(k)[j] - last);
            }
        }
        let found = before_low_pass(&smoothed, samples);
        let largest = found.values().iter().zip(torque.values()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(largest < 1e-10, "{largest}");
    }
}
