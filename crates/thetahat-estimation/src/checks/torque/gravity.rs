//! A direction of gravity that differs from the description: a robot on a wall, on a ceiling or on a tilted base.
//!
//! The parameters absorb much of a wrong gravity by other signs and offsets; only the links' inertia contradicts them. Torques
//! are linear in gravity, so the fit gets further columns: the torques of the fitted links in unit gravity along each axis of
//! the base. If these explain much, the best axis is the start of Gauss-Newton on the two angles of gravity. The masses of the
//! description are not needed.

use super::fault;
use crate::{
    checks::{
        examination::{Evidence, Examination, FindingText},
        finding::{Code, Severity},
        fit::{orthogonal_fit::OrthogonalFit, thinned_recording::ThinnedRecording},
        remedy_step::RemedyStep,
    },
    regression::Regression,
};
use thetahat_ground::{
    linear_algebra::Matrix,
    number::{fixed, significant},
    series::Series,
    vector::{Vec3, add, cross, dot, norm, scale},
};
use thetahat_model::{
    dynamics::{Model, Sign},
    regressor::Regressor,
    robot::{Quantity, Robot},
};

/// Steps of the stated gravity in one m/s^2.
const DIGITS: f64 = 1e4;
/// Factor by which another direction of gravity must reduce the squared residual.
const LIMIT: f64 = 1.3;
/// Smallest change of direction that is reported, degrees.
const LEAST_DEG: f64 = 2.0;
/// Change of direction in degrees, or factor by which the squared residual decreases, above which all estimates are wrong.
const WRONG_DEG: f64 = 10.0;
const WRONG_RATIO: f64 = 4.0;
/// Change of direction in degrees beyond which parameters of the other sign explain as much: exchanged arms of a torso look like a robot
/// that hangs.
const TURNED_DEG: f64 = 90.0;
/// Relative error of the fit with another gravity above which gravity does not explain it: the description may be of another
/// robot.
const POOR: f64 = 0.15;
/// Most steps of Gauss-Newton.
const STEPS: usize = 6;
/// Part by which a step must reduce the squared residual.
const PROGRESS: f64 = 1e-3;
/// Ratio of squared residuals up to which two directions explain the torques alike.
const ALIKE: f64 = 1.02;
/// Largest step, part of the length of gravity.
const LARGEST_STEP: f64 = 0.7;

const AXES: [Vec3; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Checks gravity; returns whether it makes all estimates wrong. Another fault of the recording is the better explanation if it
/// reduces the squared residual more.
pub(in crate::checks) fn check(exam: &mut Examination<'_>, recording: &ThinnedRecording<'_>) -> bool {
    let stated = exam.subject.robot.gravity;
    let Some((ratio, found)) = better(recording, stated) else { return false };
    let evidence = Evidence {
        code: Code::GravityDirection,
        coordinate: None,
        value: ratio,
        unit: "times smaller squared residual",
        limit: LIMIT,
    };
    let angle = angle_deg(stated, found);
    if angle < LEAST_DEG || ratio <= LIMIT || fault::largest_gain(recording) > ratio {
        exam.note_measure(evidence);
        return false;
    }
    let severity = if angle > WRONG_DEG || ratio > WRONG_RATIO { Severity::Problem } else { Severity::Warning };
    exam.judge(evidence, severity, || finding_text(ratio, found, angle));
    severity == Severity::Problem
}

fn finding_text(ratio: f64, found: Vec3, angle: f64) -> FindingText {
    let gravity = found.map(|component| fixed(component, 2)).join(", ");
    let message = format!(
        "the torques fit {} times better if gravity is [{gravity}] m/s^2 in the base frame, {angle:.0} degrees from the stated one: \
         the robot hangs, is mounted on a wall, or its base is tilted",
        significant(ratio.sqrt(), 3)
    );
    let exact = found.map(|component| (component * DIGITS).round() / DIGITS);
    let remedy = format!(
        "check how the base is mounted; if it is mounted so, state gravity = {exact:?} at the top of the experiment; otherwise check \
         the zeros of the first joints, and whether the description is of this robot"
    );
    let is_sure = angle < TURNED_DEG || ratio > WRONG_RATIO;
    FindingText::new(message, remedy).with_step(is_sure.then_some(RemedyStep::Gravity { gravity: exact }))
}

fn angle_deg(a: Vec3, b: Vec3) -> f64 {
    norm(cross(a, b)).atan2(dot(a, b)).to_degrees()
}

/// Factor by which another gravity of the same length reduces the squared residual, and that gravity; the stated gravity if no
/// other explains the torques, `None` without gravity or links.
fn better(recording: &ThinnedRecording<'_>, stated: Vec3) -> Option<(f64, Vec3)> {
    let length = norm(stated);
    if length == 0.0 {
        return None;
    }
    let stated_fit = GravityFit::new(recording, stated)?;
    let reach = stated_fit.squares() / stated_fit.fit_with_directions(recording, &AXES)?.squares;
    if reach < LIMIT {
        return Some((reach, stated));
    }
    let along = |axis: &Vec3| [length, -length].map(|l| scale(l, *axis));
    let others = AXES.iter().flat_map(along).filter(|g| angle_deg(*g, stated) > LEAST_DEG);
    let all = others.filter_map(|gravity| GravityFit::new(recording, gravity));
    let squares = stated_fit.squares();
    let best = all.fold(stated_fit, |best, other| if other.squares() < best.squares() { other } else { best });
    // A direction of which the torques show no sign keeps the stated one: of a SCARA arm the offset of its slide takes gravity along it.
    let nearest = refined(recording, GravityFit::new(recording, stated)?);
    let best = refined(recording, best);
    let best = if nearest.squares() <= ALIKE * best.squares() { nearest } else { best };
    if best.fit.relative_error() > POOR {
        return Some((1.0, stated));
    }
    Some((squares / best.squares(), best.gravity))
}

/// The best direction near a start.
fn refined(recording: &ThinnedRecording<'_>, start: GravityFit) -> GravityFit {
    let mut best = start;
    for _ in 0..STEPS {
        let Some(next) = best.next(recording).filter(|next| next.squares() < (1.0 - PROGRESS) * best.squares()) else {
            break;
        };
        best = next;
    }
    best
}

/// The fit of the robot's parameters with a given gravity.
struct GravityFit {
    gravity: Vec3,
    columns: Vec<usize>,
    regression: Regression,
    fit: OrthogonalFit,
}

impl GravityFit {
    fn new(recording: &ThinnedRecording<'_>, gravity: Vec3) -> Option<Self> {
        let model = Model::new(&Robot { gravity, ..recording.subject.robot.clone() });
        let columns = columns(recording);
        let regression = recording.regression_of(&model, &columns).ok()?;
        let fit = OrthogonalFit::new(&regression);
        Some(Self { gravity, columns, regression, fit })
    }

    fn squares(&self) -> f64 {
        self.fit.squares
    }

    /// The fit with further columns: the torques of the fitted links in unit gravity along directions.
    fn fit_with_directions(&self, recording: &ThinnedRecording<'_>, directions: &[Vec3]) -> Option<OrthogonalFit> {
        let theta = self.fit.theta();
        let torques: Vec<Vec<f64>> =
            directions.iter().map(|d| self.torque_along(recording, *d, &theta)).collect::<Option<_>>()?;
        let further = Matrix::from_fn(self.regression.x.rows(), directions.len(), |i, c| torques[c][i]);
        let all = Matrix::side_by_side(&[&self.regression.x, &further]);
        Some(OrthogonalFit::new(&self.regression.clone().with_matrix(all)))
    }

    /// The torque of the fitted links at rest in unit gravity, in rows.
    fn torque_along(&self, recording: &ThinnedRecording<'_>, direction: Vec3, theta: &[f64]) -> Option<Vec<f64>> {
        let model = Model::new(&Robot { gravity: direction, ..recording.subject.robot.clone() });
        let links = |(column, value): (&usize, &f64)| is_link(&model, *column).then_some((*column, *value));
        let (columns, values): (Vec<usize>, Vec<f64>) = self.columns.iter().zip(theta).filter_map(links).unzip();
        let q = &recording.motion.q;
        let rest = Series::zeros(q.len(), q.channels());
        let torque = Regressor::new(&model, &columns).torques(&model, [q, &rest, &rest], Sign::Exact, &values);
        Some(recording.stack(&recording.decimator.filter(&torque).ok()?))
    }

    /// One step of Gauss-Newton on the two angles.
    fn next(&self, recording: &ThinnedRecording<'_>) -> Option<Self> {
        let length = norm(self.gravity);
        let across = across(self.gravity);
        let theta = self.fit_with_directions(recording, &across)?.theta();
        let change =
            theta[self.columns.len()..].iter().zip(across).fold([0.0; 3], |sum, (c, d)| add(sum, scale(*c, d)));
        let shorter = (LARGEST_STEP * length / norm(change).max(f64::MIN_POSITIVE)).min(1.0);
        let changed = add(self.gravity, scale(shorter, change));
        Self::new(recording, scale(length / norm(changed), changed))
    }
}

/// The columns of the fit and all columns of links: with another gravity, others of them are independent.
fn columns(recording: &ThinnedRecording<'_>) -> Vec<usize> {
    let model = recording.subject.model;
    let fitted = recording.subject.all.columns();
    (0..model.parameter_table().len()).filter(|i| is_link(model, *i) || fitted.contains(i)).collect()
}

fn is_link(model: &Model, column: usize) -> bool {
    matches!(model.parameter_table().get(column).quantity, Quantity::Link(_))
}

/// Two unit vectors at right angles to a direction and to each other.
fn across(direction: Vec3) -> [Vec3; 2] {
    let unit = scale(1.0 / norm(direction), direction);
    let farthest =
        AXES.into_iter().min_by(|a, b| dot(*a, unit).abs().total_cmp(&dot(*b, unit).abs())).unwrap_or(AXES[0]);
    let first = cross(unit, farthest);
    let first = scale(1.0 / norm(first), first);
    [first, cross(unit, first)]
}
