//! The fit of a robot's parameters with a gravity of choice.

use std::cell::OnceCell;

use crate::{
    checks::{
        examination::Evidence,
        finding::Code,
        fit::{orthogonal_fit::OrthogonalFit, thinned_recording::ThinnedRecording},
    },
    regression::Regression,
};
use thetahat_ground::{
    linear_algebra::Matrix,
    series::Series,
    vector::{Vec3, add, cross, dot, norm, scale},
};
use thetahat_model::{
    dynamics::{Model, Sign},
    regressor::Regressor,
    robot::{Quantity, Robot},
};

/// Factor by which another direction of gravity must reduce the squared residual.
pub(super) const LIMIT: f64 = 1.3;
/// Factor by which the squared residual decreases with another gravity above which all estimates are wrong.
pub(super) const WRONG_RATIO: f64 = 4.0;
/// Relative error of the fit with another gravity above which gravity does not explain it: the description may be of another
/// robot.
pub(super) const POOR: f64 = 0.15;
/// Ratio of squared residuals up to which two directions explain the torques alike.
pub(super) const ALIKE: f64 = 1.02;
/// Largest step, part of the length of gravity.
const LARGEST_STEP: f64 = 0.7;

/// The axes of the base's frame.
pub(super) const AXES: [Vec3; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Evidence of another gravity: a factor by which it reduces the squared residual.
pub(super) fn evidence(value: f64) -> Evidence {
    let unit = "times smaller squared residual";
    Evidence { code: Code::GravityDirection, coordinate: None, value, unit, limit: LIMIT }
}

/// The rows of a recording with any gravity, in which they are linear: `X(g) = X(0) + g_x X_x + g_y X_y + g_z X_z`.
pub(super) struct GravityRows<'a, 'r> {
    recording: &'r ThinnedRecording<'a>,
    columns: Vec<usize>,
    without: Regression,
    /// The change of the rows by unit gravity along each axis, computed when it is needed.
    along: [OnceCell<Matrix>; 3],
}

impl<'a, 'r> GravityRows<'a, 'r> {
    pub(super) fn new(recording: &'r ThinnedRecording<'a>) -> Option<Self> {
        let columns = columns(recording);
        let without = regression(recording, &columns, [0.0; 3])?;
        Some(Self { recording, columns, without, along: [const { OnceCell::new() }; 3] })
    }

    /// The fit of the robot's parameters with a given gravity.
    pub(super) fn fit(&self, gravity: Vec3) -> Option<GravityFit> {
        let mut regression = self.without.clone();
        for (axis, strength) in gravity.into_iter().enumerate().filter(|(_, strength)| *strength != 0.0) {
            regression = regression.with_matrix(regression.x.plus(self.along(axis)?, strength));
        }
        let fit = OrthogonalFit::new(&regression);
        Some(GravityFit { gravity, columns: self.columns.clone(), regression, fit })
    }

    fn along(&self, axis: usize) -> Option<&Matrix> {
        if let Some(along) = self.along[axis].get() {
            return Some(along);
        }
        let with = regression(self.recording, &self.columns, AXES[axis])?;
        Some(self.along[axis].get_or_init(|| with.x.plus(&self.without.x, -1.0)))
    }
}

fn regression(recording: &ThinnedRecording<'_>, columns: &[usize], gravity: Vec3) -> Option<Regression> {
    let model = Model::new(&Robot { gravity, ..recording.subject.robot.clone() });
    recording.regression_of(&model, columns).ok()
}

/// The fit of the robot's parameters with a given gravity.
pub(super) struct GravityFit {
    pub(super) gravity: Vec3,
    pub(super) columns: Vec<usize>,
    regression: Regression,
    pub(super) fit: OrthogonalFit,
}

impl GravityFit {
    pub(super) fn squares(&self) -> f64 {
        self.fit.squares
    }

    /// The fit with further columns: the torques of the fitted links in unit gravity along directions.
    pub(super) fn fit_with_directions(
        &self,
        recording: &ThinnedRecording<'_>,
        directions: &[Vec3],
    ) -> Option<OrthogonalFit> {
        let theta = self.fit.theta();
        let torques: Vec<Vec<f64>> =
            directions.iter().map(|d| self.torque_along(recording, *d, &theta)).collect::<Option<_>>()?;
        let further = Matrix::from_fn(self.regression.x.rows(), directions.len(), |i, c| torques[c][i]);
        let all = Matrix::side_by_side(&[&self.regression.x, &further]);
        Some(OrthogonalFit::new(&self.regression.clone().with_matrix(all)))
    }

    /// The torque of the fitted links at rest in unit gravity, in rows.
    pub(super) fn torque_along(
        &self,
        recording: &ThinnedRecording<'_>,
        direction: Vec3,
        theta: &[f64],
    ) -> Option<Vec<f64>> {
        let model = Model::new(&Robot { gravity: direction, ..recording.subject.robot.clone() });
        let links = |(column, value): (&usize, &f64)| is_link(&model, *column).then_some((*column, *value));
        let (columns, values): (Vec<usize>, Vec<f64>) = self.columns.iter().zip(theta).filter_map(links).unzip();
        let q = &recording.motion.q;
        let rest = Series::zeros(q.len(), q.channels());
        let torque = Regressor::new(&model, &columns).torques(&model, [q, &rest, &rest], Sign::Exact, &values);
        Some(recording.stack(&recording.decimator.filter(&torque).ok()?))
    }

    /// One step of Gauss-Newton on the two angles.
    pub(super) fn next(&self, rows: &GravityRows<'_, '_>) -> Option<Self> {
        let length = norm(self.gravity);
        let across = across(self.gravity);
        let theta = self.fit_with_directions(rows.recording, &across)?.theta();
        let change =
            theta[self.columns.len()..].iter().zip(across).fold([0.0; 3], |sum, (c, d)| add(sum, scale(*c, d)));
        let shorter = (LARGEST_STEP * length / norm(change).max(f64::MIN_POSITIVE)).min(1.0);
        let changed = add(self.gravity, scale(shorter, change));
        rows.fit(scale(length / norm(changed), changed))
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
