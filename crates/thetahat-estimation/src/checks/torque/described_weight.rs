//! The weight that the description's links have, in the torques.

use super::gravity_fit::GravityFit;
use crate::checks::fit::thinned_recording::ThinnedRecording;
use thetahat_ground::vector::Vec3;

/// The weight of the description's links in the torques.
#[derive(Clone, Copy)]
pub(super) struct DescribedWeight {
    /// Part of it that the torques hold; negative if they have the opposite sign.
    pub(super) part: f64,
    /// Factor by which all of it would increase the squared residual of the fit without gravity.
    pub(super) ratio: f64,
}

/// From a fit without gravity; none without masses.
pub(super) fn described_weight(
    recording: &ThinnedRecording<'_>,
    gravity: Vec3,
    without: &GravityFit,
) -> Option<DescribedWeight> {
    let subject = recording.subject;
    let theta = subject.robot.a_priori_parameters_for(subject.model.parameter_table());
    let of_columns: Vec<f64> = without.columns.iter().map(|&column| theta[column]).collect();
    let weight = without.fit.unexplained(&without.torque_along(recording, gravity, &of_columns)?);
    let squares: f64 = weight.iter().map(|w| w * w).sum();
    let along: f64 = weight.iter().zip(&without.fit.residual).map(|(w, e)| w * e).sum();
    (squares > 0.0).then(|| DescribedWeight { part: along / squares, ratio: 1.0 + squares / without.squares() })
}
