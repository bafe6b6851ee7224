//! Recordings of another robot: nothing fits, and no single correction helps.
//!
//! The rival of the robot's model knows nothing of the geometry: each joint has an inertia, friction, an offset and a
//! pendulum of its own. A geometry that explains no more than that is not this robot's. Both have the columns of
//! [`friction_shapes`](super::friction_shapes) beside them: where friction is most of the torques and its law is not the model's, no geometry fits.

use super::{
    examination::{Evidence, Examination, Words},
    finding::{Code, Severity},
    numbers::{autocorrelation, rms},
    thinned_record::ThinnedRecord,
};
use thetahat_ground::{
    linear_algebra::{Matrix, PivotedQr},
    series::Series,
};
use thetahat_model::dynamics::Sign;

/// Rms residual of the robot's model relative to the rival's, percent, joint by joint relative to the torques' deviations, from
/// which the geometry is doubtful. One torque of another motion has 71 and more.
const LIMIT_PERCENT: f64 = 60.0;
/// The same from which it is wrong. Descriptions of other robots have 84 to 98.
const WRONG_PERCENT: f64 = 80.0;
/// Relative error of the whole fit, percent, from which the model may be another robot's. Clean records whose residual has a
/// structure leave at most 5.2, torques of another motion 8 and more.
const POOR_PERCENT: f64 = 7.0;
/// What drives without links must leave of the torques, percent: else friction and motor inertia hide the geometry. The TX40
/// has 21, the others 32 and more.
const GEOMETRY_PERCENT: f64 = 20.0;
/// Correlation of neighbouring rows of the residual below which it is noise and not another geometry.
const STRUCTURE: f64 = 0.4;
/// Faults that explain a poor fit by themselves; those of signs, scales and order are corrected before.
const CAUSES: [Code; 5] =
    [Code::TorqueNoise, Code::TorqueIdle, Code::TorqueSaturated, Code::JointsSwapped, Code::StillPeriod];

/// Relative size of the last diagonal entries of R below which columns depend on one another.
const DEPENDENT: f64 = 1e-8;

/// Columns of a joint's drive: velocity, its sign, acceleration and one.
const DRIVE: usize = 4;
/// The same with the sine and cosine of its position.
const PENDULUM: usize = 6;

pub(super) fn check(exam: &mut Examination<'_>, record: &ThinnedRecord<'_>, shapes: &Matrix) {
    if record.coordinates() < 2 || exam.has(&CAUSES) {
        return;
    }
    let Some(Left { model, pendulums, drives, whole, structure }) = Left::of(record, shapes) else { return };
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
            "{how}: with friction of any law the robot's geometry leaves {model:.0} % of the joints' torques, joints that \
             know nothing of one another leave {pendulums:.0} %, and no single correction of the record helps"
        );
        let remedy = "check that the description is of this robot (axes, lengths, zeros, gravity of a tilted base), and that \
                      position and torque are columns of the same motion in the order of its joints";
        Words::new(message, remedy)
    });
}

/// What models leave of the torques beside the shapes of friction, percent.
struct Left {
    /// Of the joints' deviations, by the robot, by pendulums and by drives without links.
    model: f64,
    pendulums: f64,
    drives: f64,
    /// Of all torques, by the robot.
    whole: f64,
    /// Correlation of neighbouring rows of what the robot leaves, mean of the joints.
    structure: f64,
}

impl Left {
    /// None where the columns of a joint's own motion depend on one another.
    fn of(record: &ThinnedRecord<'_>, shapes: &Matrix) -> Option<Self> {
        let joints = 0..record.coordinates();
        let rivals = joints.clone().map(|j| own_motion(record, j)).collect::<Option<Vec<_>>>()?;
        let fit = record.fit_beside(shapes, &vec![false; shapes.rows()]).ok()?;
        let by_own = |columns: usize, j: usize| {
            let own = rivals[j].select_columns(&(0..columns).collect::<Vec<_>>());
            let rows = j * record.rows()..(j + 1) * record.rows();
            left(record.rows_of(&fit.y, j), &Matrix::beside(&[&own, &shapes.row_range(rows)]))
        };
        let all = |of: &dyn Fn(usize) -> f64| 100.0 * rms(&joints.clone().map(of).collect::<Vec<_>>());
        let neighbours = |j: usize| autocorrelation(record.rows_of(&fit.residual, j));
        Some(Self {
            model: all(&|j| fit.joint_error_per_freedom(j)),
            pendulums: all(&|j| by_own(PENDULUM, j)),
            drives: all(&|j| by_own(DRIVE, j)),
            whole: 100.0 * fit.relative_error(),
            structure: joints.clone().map(neighbours).sum::<f64>() / joints.len() as f64,
        })
    }
}

/// Rms of what columns leave of a joint's torque, per degree of freedom.
fn left(y: &[f64], x: &Matrix) -> f64 {
    let qr = PivotedQr::with_equal_columns(x);
    let x = x.select_columns(&qr.pivots()[..qr.rank(DEPENDENT)]);
    let by_own = x.times(&PivotedQr::new(&x).solve(y));
    let squares: f64 = y.iter().zip(&by_own).map(|(y, own)| (y - own).powi(2)).sum();
    (squares / (y.len() as f64 - x.columns() as f64).max(1.0)).sqrt()
}

/// The columns of a joint's own motion, low-passed as the rows are; none where they depend on one another.
fn own_motion(record: &ThinnedRecord<'_>, j: usize) -> Option<Matrix> {
    let motion = &record.motion;
    let values = (0..motion.q.len()).flat_map(|k| {
        let (q, v) = (motion.q.sample(k)[j], motion.dq.sample(k)[j]);
        [v, Sign::Exact.of(v), motion.ddq.sample(k)[j], 1.0, q.sin(), q.cos()]
    });
    record.columns_of(&Series::shaped(PENDULUM, values.collect()))
}
