//! How long a motion is to be recorded until what is wanted is known.

use crate::design::{
    motions::sums::Derivatives,
    prediction::{expected::Expected, prior_data::inverse},
    search::optimiser::Problem,
    text::description::Design,
};
use thetahat_ground::linear_algebra::Matrix;
use thetahat_model::base_parameters::BaseParameters;

/// Shortest and longest time that is considered, in durations of the motion.
const RANGE: [f64; 2] = [1e-3, 1e6];
const HALVINGS: usize = 40;

impl Design {
    /// For each expected parameter the recording time until half of its interval is as wanted, by repeating the motion: absent if its a-priori
    /// value is zero.
    pub(in crate::design) fn recording_times(
        &self,
        base: &BaseParameters,
        problem: &Problem,
        motion: &Derivatives,
        expected: &Expected,
    ) -> Vec<Option<f64>> {
        let (values, duration_s) = (self.a_priori_of(base, expected), self.file.duration_s);
        let halves = values.iter().map(|value| 0.01 * self.file.wanted.half_width_percent * value.abs());
        // How many times the information of the motion is to be there.
        let times: Vec<f64> =
            expected.half_width_95.iter().zip(halves).map(|(predicted, wanted)| (predicted / wanted).powi(2)).collect();
        let known = problem.information.prior().cloned();
        let own = problem.information.of_motion_alone(motion);
        let alone = known.as_ref().and_then(|_| inverse(&own));
        let after = |i: usize| -> Option<f64> {
            let Some((known, alone)) = known.as_ref().zip(alone.as_ref()) else { return Some(duration_s * times[i]) };
            let name = &expected.parameters[i].name;
            let place = base.parameters().iter().position(|p| p.name == *name)?;
            let wanted = alone.at(place, place) / times[i];
            recording_time(duration_s, Some(known), &own, |information| {
                inverse(information).is_some_and(|covariance| covariance.at(place, place) <= wanted)
            })
        };
        (0..values.len()).map(|i| after(i).filter(|_| values[i] != 0.0)).collect()
    }
}

/// The time after which information suffices, s, where a motion of `duration_s` adds `own` to what is known: zero if what is known suffices,
/// absent if a million repetitions do not.
pub(in crate::design) fn recording_time(
    duration_s: f64,
    known: Option<&Matrix>,
    own: &Matrix,
    suffices: impl Fn(&Matrix) -> bool,
) -> Option<f64> {
    if known.is_some_and(&suffices) {
        return Some(0.0);
    }
    let zero = || Matrix::zeros(own.rows(), own.rows());
    let known = known.cloned().unwrap_or_else(zero);
    let after = |times: f64| suffices(&known.plus(own, times));
    let [mut short, mut long] = RANGE.map(f64::ln);
    if !after(long.exp()) {
        return None;
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (short + long);
        if after(middle.exp()) {
            long = middle;
        } else {
            short = middle;
        }
    }
    Some(duration_s * long.exp())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A variance of `1 / (known + times own)` is as wanted at a time in closed form.
    #[test]
    fn the_time_of_a_single_parameter_is_in_closed_form() {
        let scalar = |value: f64| Matrix::from_fn(1, 1, |_, _| value);
        let to = |variance: f64| move |m: &Matrix| 1.0 / m.at(0, 0) <= variance;
        let time = |known: Option<f64>, variance: f64| {
            recording_time(10.0, known.map(scalar).as_ref(), &scalar(2.0), to(variance))
        };
        assert!((time(Some(3.0), 0.1).unwrap() - 35.0).abs() < 1e-6);
        assert!((time(None, 0.25).unwrap() - 20.0).abs() < 1e-6);
        assert_eq!((time(Some(3.0), 0.5), time(None, 1e-9)), (Some(0.0), None));
    }
}
