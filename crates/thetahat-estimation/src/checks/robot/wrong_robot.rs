//! Recordings of another robot: nothing fits, and no single correction helps.
//!
//! The robot's model is compared with independent single-joint models without geometry: an inertia, friction, an offset and a
//! pendulum for each joint. A geometry that explains no more than these is not this robot's. Both models get the columns of
//! [`friction_shapes`](crate::checks::fit::friction_shapes), since no geometry fits if most of the torque is friction that the model does
//! not describe.

use crate::checks::{
    examination::{Evidence, Examination, FindingText},
    finding::{Code, Severity},
    fit::thinned_recording::ThinnedRecording,
    numbers::{autocorrelation, rms},
};
use thetahat_ground::{
    linear_algebra::{Matrix, PivotedQr},
    real::sign_or,
    series::Series,
};

/// Rms residual of the robot's model relative to that of the single-joint models, percent, above which the geometry is doubtful;
/// each joint counts relative to its torque's standard deviation. One torque of another motion has 71 and more.
const LIMIT_PERCENT: f64 = 60.0;
/// The same, above which the geometry is wrong. Descriptions of other robots have 84 to 98.
const WRONG_PERCENT: f64 = 80.0;
/// Relative error of the whole fit, percent, above which the model may be another robot's. Clean recordings with a structured
/// residual have at most 5.2, torques of another motion 8 and more.
const POOR_PERCENT: f64 = 7.0;
/// Smallest error of drives without links, percent of the torques: below it friction and motor inertia hide the geometry. The
/// TX40 has 21, the others 32 and more.
const GEOMETRY_PERCENT: f64 = 20.0;
/// Correlation of neighbouring rows of the residual below which it is noise, not another geometry.
const STRUCTURE: f64 = 0.4;
/// Part of the time that a joint stands, from which its rests do not count.
const RESTS: f64 = 0.2;
/// Faults that explain a poor fit; wrong signs, scales and order are corrected before.
const CAUSES: [Code; 5] =
    [Code::TorqueNoise, Code::TorqueIdle, Code::TorqueSaturated, Code::JointsSwapped, Code::StillPeriod];

/// Fewest rows in motion for each column of a joint.
const FEWEST_ROWS_PER_COLUMN: usize = 2;
/// Relative size of the last diagonal entries of R below which columns depend on one another.
const DEPENDENT: f64 = 1e-8;

/// Columns of a joint's drive: velocity, its sign, acceleration and a constant one.
const DRIVE: usize = 4;
/// The same with the sine and cosine of its position.
const PENDULUM: usize = 6;

pub(in crate::checks) fn check(exam: &mut Examination<'_>, recording: &ThinnedRecording<'_>, shapes: &Matrix) {
    if recording.coordinates() < 2 || exam.has(&CAUSES) {
        return;
    }
    let Some(ModelErrors { model, pendulums, drives, whole, structure }) = ModelErrors::of(recording, shapes) else {
        return;
    };
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
            "{how}: the robot's model leaves {model:.0} % of the joints' torques, independent single-joint models leave \
             {pendulums:.0} % (both with general friction), and no single correction of the recording helps"
        );
        let remedy = "check that the description is of this robot (axes, lengths, zeros, gravity of a tilted base), and that \
                      position and torque are columns of the same motion in the order of its joints";
        FindingText::new(message, remedy)
    });
}

/// Errors of models with the friction shapes, percent of the torques.
struct ModelErrors {
    /// Relative to the joints' standard deviations: the robot, pendulums, and drives without links.
    model: f64,
    pendulums: f64,
    drives: f64,
    /// Relative to all torques: the robot.
    whole: f64,
    /// Correlation of neighbouring rows of the robot's residual, mean of the joints.
    structure: f64,
}

impl ModelErrors {
    /// `None` if the columns of a joint's own motion are linearly dependent.
    fn of(recording: &ThinnedRecording<'_>, shapes: &Matrix) -> Option<Self> {
        let joints = 0..recording.coordinates();
        let own_motions = joints.clone().map(|j| own_motion(recording, j)).collect::<Option<Vec<_>>>()?;
        // At rest a joint's friction is anything between two values: no geometry explains it.
        let moves = recording.rows_without_long_rests(RESTS);
        let rows_of = |j: usize| j * recording.rows()..(j + 1) * recording.rows();
        let fewest = FEWEST_ROWS_PER_COLUMN * (PENDULUM + shapes.columns());
        if joints.clone().any(|j| moves[rows_of(j)].iter().filter(|moves| **moves).count() < fewest) {
            return None;
        }
        let fit = recording.fit_with_columns(shapes, &moves.iter().map(|moves| !moves).collect::<Vec<_>>()).ok()?;
        let in_motion = |rows: &[f64], j: usize| -> Vec<f64> {
            recording
                .rows_of(rows, j)
                .iter()
                .zip(&moves[rows_of(j)])
                .filter(|(_, moves)| **moves)
                .map(|(y, _)| *y)
                .collect()
        };
        let error = |columns: usize, j: usize| {
            let own = own_motions[j].select_columns(&(0..columns).collect::<Vec<_>>());
            let all = Matrix::side_by_side(&[&own, &shapes.row_range(rows_of(j))]);
            rms_residual(&in_motion(&fit.y, j), &all.select_rows(&moves[rows_of(j)]))
        };
        let all = |of: &dyn Fn(usize) -> f64| 100.0 * rms(&joints.clone().map(of).collect::<Vec<_>>());
        let neighbours = |j: usize| autocorrelation(&in_motion(&fit.residual, j));
        Some(Self {
            model: all(&|j| fit.joint_error_per_freedom(j)),
            pendulums: all(&|j| error(PENDULUM, j)),
            drives: all(&|j| error(DRIVE, j)),
            whole: 100.0 * fit.relative_error(),
            structure: joints.clone().map(neighbours).sum::<f64>() / joints.len() as f64,
        })
    }
}

/// Rms residual of a joint's torque after a fit of columns, per degree of freedom.
fn rms_residual(y: &[f64], x: &Matrix) -> f64 {
    let qr = PivotedQr::with_equal_columns(x);
    let x = x.select_columns(&qr.pivots()[..qr.rank(DEPENDENT)]);
    let by_own = x.times(&PivotedQr::new(&x).solve(y));
    let squares: f64 = y.iter().zip(&by_own).map(|(y, own)| (y - own).powi(2)).sum();
    (squares / (y.len() as f64 - x.columns() as f64).max(1.0)).sqrt()
}

/// The columns of a joint's own motion, low-passed like the rows; `None` if they are linearly dependent.
fn own_motion(recording: &ThinnedRecording<'_>, j: usize) -> Option<Matrix> {
    let motion = &recording.motion;
    let values = (0..motion.q.len()).flat_map(|k| {
        let (q, v) = (motion.q.sample(k)[j], motion.dq.sample(k)[j]);
        [v, sign_or(v, v), motion.ddq.sample(k)[j], 1.0, q.sin(), q.cos()]
    });
    recording.columns_of(&Series::shaped(PENDULUM, values.collect()))
}
