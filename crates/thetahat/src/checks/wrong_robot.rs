//! Recordings of another robot: nothing fits, and no single correction helps.
//!
//! The rival of the robot's model knows nothing of the geometry: each joint has an inertia, friction, an offset and a
//! pendulum of its own. A geometry that explains no more than that is not this robot's.

use super::{
    examination::{Evidence, Examination, Words},
    finding::{Code, Severity},
    numbers::{autocorrelation, rms},
    thinned_record::ThinnedRecord,
};
use crate::{
    dynamics::Sign,
    linear_algebra::{Matrix, PivotedQr},
    series::Series,
};

/// Rms residual of the robot's model relative to the rival's, percent, joint by joint relative to the torques' deviations, from
/// which the geometry is doubtful. Clean: recorded KUKA 69 (with 4 % of the whole), UR10 45, TX40 29, twins at most 26.
const LIMIT_PERCENT: f64 = 50.0;
/// The same from which it is wrong. The TX40 taken for a UR10 has 85.
const WRONG_PERCENT: f64 = 77.0;
/// Relative error of the whole fit, percent, from which the model may be another robot's. Clean: recorded at most 6.3, noisy
/// twins 10.
const POOR_PERCENT: f64 = 10.0;
/// What drives without links must leave of the torques, percent: else friction and motor inertia hide the geometry. The TX40
/// has 32, the others 47 and more.
const GEOMETRY_PERCENT: f64 = 25.0;
/// Correlation of neighbouring rows of the residual below which it is noise and not another geometry.
const STRUCTURE: f64 = 0.4;
/// Faults that explain a poor fit by themselves; those of signs, scales and order are corrected before.
const CAUSES: [Code; 4] = [Code::TorqueNoise, Code::TorqueIdle, Code::TorqueSaturated, Code::JointsSwapped];

/// Columns of a joint's drive: velocity, its sign, acceleration and one.
const DRIVE: usize = 4;
/// The same with the sine and cosine of its position.
const PENDULUM: usize = 6;

pub(super) fn check(exam: &mut Examination<'_>, record: &ThinnedRecord<'_>) {
    let Ok(fit) = record.fit() else { return };
    let joints = 0..record.coordinates();
    if joints.len() < 2 || exam.has(&CAUSES) {
        return;
    }
    let Some(rivals) = joints.clone().map(|j| own_motion(record, j)).collect::<Option<Vec<_>>>() else { return };
    let all = |of: &dyn Fn(usize) -> f64| 100.0 * rms(&joints.clone().map(of).collect::<Vec<_>>());
    let left_by = |columns: usize| all(&|j| left(record.rows_of(&fit.y, j), &rivals[j], columns));
    let (model, pendulums, drives) = (all(&|j| fit.joint_error_per_freedom(j)), left_by(PENDULUM), left_by(DRIVE));
    let neighbours = |j: usize| autocorrelation(record.rows_of(&fit.residual, j));
    let structure = joints.clone().map(neighbours).sum::<f64>() / joints.len() as f64;
    let whole = 100.0 * fit.relative_error();
    let is_tested = whole > POOR_PERCENT && drives > GEOMETRY_PERCENT && structure > STRUCTURE;
    let value = if is_tested { 100.0 * model / pendulums } else { 0.0 };
    let evidence = Evidence {
        code: Code::WrongRobot,
        coordinate: None,
        value,
        unit: "% of the error without the geometry",
        limit: LIMIT_PERCENT,
    };
    let severity = if value > WRONG_PERCENT { Severity::Problem } else { Severity::Warning };
    exam.judge(evidence, severity, || {
        let how = if value > WRONG_PERCENT { "nothing fits" } else { "little fits" };
        let message = format!(
            "{how}: the robot's geometry leaves {model:.0} % of the joints' torques, joints that know nothing of one \
             another leave {pendulums:.0} %, and no single correction of the record helps"
        );
        let remedy = "check that the description is of this robot (axes, lengths, zeros, gravity of a tilted base), and that \
                      position and torque are columns of the same motion in the order of its joints";
        Words::new(message, remedy)
    });
}

/// Rms of what the first columns leave of a joint's torque, per degree of freedom.
fn left(y: &[f64], own: &Matrix, columns: usize) -> f64 {
    let x = own.select_columns(&(0..columns).collect::<Vec<_>>());
    let by_own = x.times(&PivotedQr::new(&x).solve(y));
    let squares: f64 = y.iter().zip(&by_own).map(|(y, own)| (y - own).powi(2)).sum();
    (squares / (y.len() as f64 - columns as f64).max(1.0)).sqrt()
}

/// The columns of a joint's own motion, low-passed as the rows are; none where they depend on one another.
fn own_motion(record: &ThinnedRecord<'_>, j: usize) -> Option<Matrix> {
    let motion = &record.motion;
    let values = (0..motion.q.len()).flat_map(|k| {
        let (q, v) = (motion.q.sample(k)[j], motion.dq.sample(k)[j]);
        [v, Sign::Exact.of(v), motion.ddq.sample(k)[j], 1.0, q.sin(), q.cos()]
    });
    record.columns_of(&Series::from_values(PENDULUM, values.collect()))
}
