//! Torques whose scale, or whose friction, changes from the first to the last part of the record.
//!
//! The fit explains the mean of the record. What a joint's predicted torque, and its predicted friction, times a ramp of
//! time explain of the residual is the drift.

use super::{
    examination::{Evidence, Examination, FindingText},
    finding::{Code, Severity},
    orthogonal_fit::OrthogonalFit,
    thinned_recording::ThinnedRecording,
};
use thetahat_ground::linear_algebra::{Matrix, dot};

/// Drift of a torque's scale over the record, percent, that counts.
const GAIN_LIMIT_PERCENT: f64 = 5.0;
/// Drift of a joint's friction over the record, percent, that counts.
const FRICTION_LIMIT_PERCENT: f64 = 12.0;
/// Drifts that are larger than this, percent, are none of a robot: they are seen where nothing else tells of a torque.
const PLAUSIBLE_PERCENT: f64 = 70.0;
/// Standard deviations, taken from blocks of time, by which the drift of a scale must differ from none. Clean: the recorded
/// TX40 has 4 at its first joint (-7 %), all others 3 or less.
const SURE_OF_GAIN: f64 = 5.0;
/// The same of friction: the clean records have at most 3.
const SURE_OF_FRICTION: f64 = 4.0;
/// Blocks of time.
const BLOCKS: usize = 20;

/// A drift with its standard deviation, both relative.
#[derive(Debug, Clone, Copy)]
struct Drift {
    change: f64,
    deviation: f64,
}

pub(super) fn check(exam: &mut Examination<'_>, recording: &ThinnedRecording<'_>) {
    let Ok(fit) = recording.fit() else { return };
    for j in 0..recording.coordinates() {
        let Some([gain, friction]) = drifts(recording, &fit, j) else { continue };
        judge(exam, j, Code::GainDrift, gain);
        judge(exam, j, Code::FrictionDrift, friction);
    }
}

fn judge(exam: &mut Examination<'_>, j: usize, code: Code, drift: Drift) {
    let percent = 100.0 * drift.change;
    let (limit, sure, what, remedy) = if code == Code::GainDrift {
        (
            GAIN_LIMIT_PERCENT,
            SURE_OF_GAIN,
            "scale of the torque",
            "check the drive's gain over temperature, and whether a payload was taken up or put down; cut the record into \
             shorter ones ([signal] window_start_s, window_end_s) and compare their estimates",
        )
    } else {
        (
            FRICTION_LIMIT_PERCENT,
            SURE_OF_FRICTION,
            "friction",
            "warm the joint up before recording, or start later by [signal] window_start_s: one friction holds for the whole \
             record",
        )
    };
    let is_sure = percent.abs() > sure * 100.0 * drift.deviation && percent.abs() < PLAUSIBLE_PERCENT;
    let value = if is_sure { percent.abs() } else { 0.0 };
    let evidence = Evidence { code, coordinate: Some(j), value, unit: "% over the record", limit };
    let number = exam.subject.joint_number(j);
    exam.judge(evidence, Severity::Warning, || {
        let message = format!(
            "joint {number}: the {what} changes by {percent:+.1} % (± {:.1}) from the start to the end of the record",
            100.0 * drift.deviation
        );
        FindingText::new(message, remedy)
    });
}

/// The drifts of a joint's gain and friction. The one that explains more is estimated by itself, the other beside it; none
/// where there is nothing that could drift.
fn drifts(recording: &ThinnedRecording<'_>, fit: &OrthogonalFit, j: usize) -> Option<[Drift; 2]> {
    let theta = fit.theta();
    let friction_alone: Vec<f64> =
        theta.iter().enumerate().map(|(c, v)| if recording.is_friction(c) { *v } else { 0.0 }).collect();
    let directions = [theta, friction_alone].map(|theta| fit.project_out(&ramped(recording, fit, j, &theta)));
    let explained = |d: &Vec<f64>| dot(d, &fit.residual).powi(2) / dot(d, d).max(f64::MIN_POSITIVE);
    let first = usize::from(explained(&directions[1]) > explained(&directions[0]));
    let alone = estimate(recording, &fit.residual, &[&directions[first]])?;
    let beside = estimate(recording, &fit.residual, &[&directions[0], &directions[1]]);
    let none = Drift { change: 0.0, deviation: f64::INFINITY };
    let mut drifts = [none; 2];
    drifts[first] = alone[0];
    drifts[1 - first] = beside.map_or(none, |both| both[1 - first]);
    Some(drifts)
}

/// The changes along directions by least squares, with deviations from blocks of time; none where the directions are one.
fn estimate(recording: &ThinnedRecording<'_>, residual: &[f64], directions: &[&Vec<f64>]) -> Option<Vec<Drift>> {
    let n = directions.len();
    let inverse = Matrix::from_fn(n, n, |a, b| dot(directions[a], directions[b])).inverse()?;
    let change = inverse.times(&directions.iter().map(|d| dot(d, residual)).collect::<Vec<_>>());
    let explained = |i: usize| directions.iter().zip(&change).map(|(d, c)| c * d[i]).sum::<f64>();
    let rest: Vec<f64> = residual.iter().enumerate().map(|(i, r)| r - explained(i)).collect();
    let spread = block_spread(recording, directions, &rest);
    let covariance = inverse.times_matrix(&spread).times_matrix(&inverse);
    let drift = |i: usize| Drift { change: change[i], deviation: covariance.at(i, i).max(0.0).sqrt() };
    change.iter().all(|c| c.is_finite()).then(|| (0..n).map(drift).collect())
}

/// The predicted torque of a joint times a ramp of time from -1/2 to 1/2; zero in the other joints' rows.
fn ramped(recording: &ThinnedRecording<'_>, fit: &OrthogonalFit, j: usize, theta: &[f64]) -> Vec<f64> {
    let rows = recording.rows();
    let mut direction = fit.x.times(theta);
    let ramp = |i: usize| (i % rows) as f64 / (rows - 1).max(1) as f64 - 0.5;
    direction.iter_mut().enumerate().for_each(|(i, v)| *v *= if i / rows == j { ramp(i) } else { 0.0 });
    direction
}

/// The sum over blocks of time of the squared scores.
fn block_spread(recording: &ThinnedRecording<'_>, directions: &[&Vec<f64>], rest: &[f64]) -> Matrix {
    let (rows, n) = (recording.rows(), directions.len());
    let mut scores = vec![vec![0.0; n]; BLOCKS];
    for (i, r) in rest.iter().enumerate() {
        let score = &mut scores[(i % rows) * BLOCKS / rows];
        score.iter_mut().zip(directions).for_each(|(s, d)| *s += d[i] * r);
    }
    Matrix::from_fn(n, n, |a, b| scores.iter().map(|s| s[a] * s[b]).sum())
}
