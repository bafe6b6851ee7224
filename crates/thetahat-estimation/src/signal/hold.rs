use thetahat_ground::series::Series;

/// The mean about each sample of a signal that holds its value from each sample on: `(1 - a) u_k + a u_(k-1)`, where a is half the fraction
/// of a sample period for which it holds.
///
/// A sampled controller holds its torque over the step after a sample, and the motion's derivatives are centred on the sample: as recorded,
/// the torque is half a step early. A signal that holds for less than a step, because the recording is slower than the controller, is
/// interpolated linearly between samples.
///
/// ```
/// use thetahat_estimation::signal::centred_hold;
/// use thetahat_ground::series::Series;
/// let held = Series::from_values(1, vec![1.0, 3.0, 7.0])?;
/// assert_eq!(centred_hold(&held, 1.0).values(), [1.0, 2.0, 5.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn centred_hold(series: &Series, part_of_step: f64) -> Series {
    let (mut centred, mut hold) = (series.clone(), CentredHold::new(part_of_step));
    (0..series.len()).for_each(|k| hold.pass(centred.sample_mut(k)));
    centred
}

/// [`centred_hold`], sample by sample.
#[derive(Debug)]
#[doc(hidden)]
pub struct CentredHold {
    /// Weight of the sample before.
    before: f64,
    last: Vec<f64>,
}

impl CentredHold {
    #[doc(hidden)]
    pub fn new(part_of_step: f64) -> Self {
        Self { before: 0.5 * part_of_step.clamp(0.0, 1.0), last: Vec::new() }
    }

    /// Replaces a sample by the mean. The first sample is unchanged.
    #[doc(hidden)]
    pub fn pass(&mut self, sample: &mut [f64]) {
        if self.before == 0.0 {
            return;
        }
        let now = sample.to_vec();
        sample.iter_mut().zip(&self.last).for_each(|(value, last)| *value += self.before * (last - *value));
        self.last = now;
    }
}
