//! Torques whose scale, or whose friction, changes from the first to the last part of the record.
//!
//! The fit explains the mean of the record. What a joint's predicted torque, and its predicted friction, times a ramp of
//! time explain of the residual is the drift.

use super::{
    examination::{Evidence, Examination, Words},
    finding::{Code, Severity},
    orthogonal_fit::OrthogonalFit,
    thinned_record::ThinnedRecord,
};
use crate::linear_algebra::{Matrix, dot};

/// Drift of a torque's scale over the record, percent. The clean records have at most 3.
const GAIN_LIMIT_PERCENT: f64 = 6.0;
/// Drift of a joint's friction over the record, percent.
const FRICTION_LIMIT_PERCENT: f64 = 12.0;
/// Standard deviations, taken from blocks of time, by which a drift must differ from none.
const SURE: f64 = 5.0;
/// Blocks of time.
const BLOCKS: usize = 20;

/// A drift with its standard deviation, both relative.
#[derive(Debug, Clone, Copy)]
struct Drift {
    change: f64,
    deviation: f64,
}

pub(super) fn check(exam: &mut Examination<'_>, record: &ThinnedRecord<'_>) {
    let Ok(fit) = record.fit() else { return };
    for j in 0..record.coordinates() {
        let Some([gain, friction]) = drifts(record, &fit, j) else { continue };
        judge(exam, j, Code::GainDrift, gain);
        judge(exam, j, Code::FrictionDrift, friction);
    }
}

fn judge(exam: &mut Examination<'_>, j: usize, code: Code, drift: Drift) {
    let percent = 100.0 * drift.change;
    let (limit, what, remedy) = if code == Code::GainDrift {
        (
            GAIN_LIMIT_PERCENT,
            "scale of the torque",
            "check the drive's gain over temperature; cut the record into shorter ones ([signal] window_start_s, \
             window_end_s) and compare their estimates",
        )
    } else {
        (
            FRICTION_LIMIT_PERCENT,
            "friction",
            "warm the joint up before recording, or start later by [signal] window_start_s: one friction holds for the whole \
             record",
        )
    };
    let value = if percent.abs() > SURE * 100.0 * drift.deviation { percent.abs() } else { 0.0 };
    let evidence = Evidence { code, coordinate: Some(j), value, unit: "% over the record", limit };
    let number = exam.subject.joint_number(j);
    exam.judge(evidence, Severity::Warning, || {
        let message = format!(
            "joint {number}: the {what} changes by {percent:+.0} % (+- {:.0}) from the start to the end of the record",
            100.0 * drift.deviation
        );
        Words::new(message, remedy)
    });
}

/// The drifts of a joint's gain and friction, estimated together; none where they cannot be told apart.
fn drifts(record: &ThinnedRecord<'_>, fit: &OrthogonalFit, j: usize) -> Option<[Drift; 2]> {
    let theta = fit.theta();
    let friction_alone: Vec<f64> =
        theta.iter().enumerate().map(|(c, v)| if record.is_friction(c) { *v } else { 0.0 }).collect();
    let directions = [theta, friction_alone].map(|theta| ramped(record, fit, j, &theta));
    let [gain, friction] = directions.map(|d| fit.project_out(&d));
    let information = Matrix::from_fn(2, 2, |a, b| dot([&gain, &friction][a], [&gain, &friction][b]));
    let inverse = information.inverse()?;
    let score = [dot(&gain, &fit.residual), dot(&friction, &fit.residual)];
    let change = inverse.times(&score);
    let rest: Vec<f64> =
        (0..fit.residual.len()).map(|i| fit.residual[i] - change[0] * gain[i] - change[1] * friction[i]).collect();
    let spread = block_spread(record, [&gain, &friction], &rest);
    let covariance = inverse.times_matrix(&spread).times_matrix(&inverse);
    let drift = |i: usize| Drift { change: change[i], deviation: covariance.at(i, i).max(0.0).sqrt() };
    change.iter().all(|c| c.is_finite()).then(|| [drift(0), drift(1)])
}

/// The predicted torque of a joint times a ramp of time from -1/2 to 1/2; zero in the other joints' rows.
fn ramped(record: &ThinnedRecord<'_>, fit: &OrthogonalFit, j: usize, theta: &[f64]) -> Vec<f64> {
    let rows = record.rows();
    let mut direction = fit.x.times(theta);
    let ramp = |i: usize| (i % rows) as f64 / (rows - 1).max(1) as f64 - 0.5;
    direction.iter_mut().enumerate().for_each(|(i, v)| *v *= if i / rows == j { ramp(i) } else { 0.0 });
    direction
}

/// The sum over blocks of time of the squared scores.
fn block_spread(record: &ThinnedRecord<'_>, directions: [&Vec<f64>; 2], rest: &[f64]) -> Matrix {
    let rows = record.rows();
    let mut scores = [[0.0; 2]; BLOCKS];
    for (i, r) in rest.iter().enumerate() {
        let block = &mut scores[(i % rows) * BLOCKS / rows];
        (block[0], block[1]) = (block[0] + directions[0][i] * r, block[1] + directions[1][i] * r);
    }
    Matrix::from_fn(2, 2, |a, b| scores.iter().map(|s| s[a] * s[b]).sum())
}
