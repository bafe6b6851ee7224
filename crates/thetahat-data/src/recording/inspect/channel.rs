//! Summarises the values of a channel.

use serde::Serialize;

use super::super::table::is_plausible;

/// Range and resolution of a channel, over its finite values; none if there are none.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ChannelSummary {
    /// The smallest value.
    pub min: Option<f64>,
    /// The largest value.
    pub max: Option<f64>,
    /// The mean.
    pub mean: Option<f64>,
    /// The root mean square.
    pub rms: Option<f64>,
    /// The smallest step between different neighbours: the quantisation of what was recorded. None if all are equal.
    pub resolution: Option<f64>,
    /// Whether all finite values are equal.
    pub constant: bool,
    /// Number of values that are NaN, infinite, implausibly large, missing or text.
    pub not_finite: usize,
}

impl ChannelSummary {
    pub(super) fn of(values: &[f64]) -> Self {
        let finite = || values.iter().copied().filter(|value| is_plausible(*value));
        let count = finite().count();
        let min = finite().reduce(f64::min);
        let max = finite().reduce(f64::max);
        // Values are divided before they are added, so that no sum overflows.
        let scale = min.into_iter().chain(max).map(f64::abs).fold(0.0, f64::max);
        let scaled = || finite().map(|value| if scale > 0.0 { value / scale } else { 0.0 });
        let average = |sum: f64| (count > 0).then(|| sum / count as f64);
        Self {
            min,
            max,
            mean: average(scaled().sum()).map(|mean| scale * mean),
            rms: average(scaled().map(|value| value * value).sum()).map(|square| scale * square.sqrt()),
            resolution: resolution(values),
            constant: min == max,
            not_finite: values.len() - count,
        }
    }
}

fn resolution(values: &[f64]) -> Option<f64> {
    let steps = values.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    steps.filter(|step| step.is_finite() && *step > 0.0).reduce(f64::min)
}
