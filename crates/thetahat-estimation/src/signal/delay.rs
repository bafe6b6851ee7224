use thetahat_ground::series::Series;

/// The series with each channel delayed by its number of samples, which may be a fraction or negative: the cubic through the four nearest
/// samples. Before its first and after its last sample a channel keeps that sample's value.
///
/// ```
/// use thetahat_estimation::signal::delayed;
/// use thetahat_ground::series::Series;
/// let squares = Series::from_values(1, (0..10).map(|k| f64::from(k * k)).collect())?;
/// let late = delayed(&squares, &[0.5]);
/// assert!((late.sample(6)[0] - 5.5 * 5.5).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Panics
/// If there is not one delay for each channel.
#[must_use]
pub fn delayed(series: &Series, samples: &[f64]) -> Series {
    let last = series.len() as isize - 1;
    let mut result = Series::zeros(series.len(), series.channels());
    for (j, delay) in samples.iter().enumerate() {
        let step = -delay;
        let (whole, part) = (step.floor() as isize, step - step.floor());
        let weights = cubic(part);
        for k in 0..series.len() {
            let value = |i: isize| series.sample((k as isize + whole + i).clamp(0, last) as usize)[j];
            result.sample_mut(k)[j] = (0..4).map(|i| weights[i as usize] * value(i - 1)).sum();
        }
    }
    result
}

/// Weights of the samples at -1, 0, 1 and 2 for the value at `t` from 0 to 1.
fn cubic(t: f64) -> [f64; 4] {
    [
        -t * (t - 1.0) * (t - 2.0) / 6.0,
        (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0,
        -(t + 1.0) * t * (t - 2.0) / 2.0,
        (t + 1.0) * t * (t - 1.0) / 6.0,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cubics_are_exact_and_whole_samples_are_kept() {
        let cubic = |t: f64| 0.3 * t * t * t - t * t + 2.0;
        let series = Series::shaped(1, (0..20).map(|k| cubic(f64::from(k))).collect());
        for delay in [-2.0, -0.3, 0.0, 1.7, 2.9] {
            let late = delayed(&series, &[delay]);
            for k in 4..17 {
                assert!((late.sample(k)[0] - cubic(k as f64 - delay)).abs() < 1e-9, "{delay} {k}");
            }
        }
        assert_eq!(delayed(&series, &[3.0]).sample(1), series.sample(0));
        assert_eq!(delayed(&series, &[-3.0]).sample(19), series.sample(19));
    }
}
