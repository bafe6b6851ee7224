use super::{
    Identity, Reduction,
    factors::{Segment, coarsened},
};
use crate::{
    identification::{Divisor, EstimationError, Fit, idim_iv, idim_ls},
    linear_algebra::{Matrix, norm},
};

/// A least squares problem with the factors in place of the rows: what orthonormal columns took from X and y alike, so that
/// estimates, residual sums and covariances are those of the rows.
pub(super) struct Compressed {
    /// X with all base columns.
    pub x: Matrix,
    /// Z likewise, where there are instruments.
    pub z: Option<Matrix>,
    pub y: Vec<f64>,
    /// Joint, recording and segment of each row.
    pub place: Vec<Place>,
    /// Rows that they stand for, of all joints.
    pub rows: usize,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Place {
    pub joint: usize,
    pub recording: usize,
    pub segment: usize,
}

impl Compressed {
    /// With one factor for each joint and recording.
    pub(super) fn whole(reduction: &Reduction) -> Self {
        let whole = |segments: &[Segment]| coarsened(segments.to_vec(), 1);
        let segments: Vec<Vec<Segment>> = reduction.recordings.iter().map(|r| whole(&r.segments)).collect();
        Self::of(&reduction.identity, segments.iter().map(|s| &s[..]))
    }

    /// With every segment by itself.
    pub(super) fn in_segments(reduction: &Reduction) -> Self {
        Self::of(&reduction.identity, reduction.recordings.iter().map(|r| &r.segments[..]))
    }

    fn of<'a>(identity: &Identity, recordings: impl Iterator<Item = &'a [Segment]>) -> Self {
        let columns = identity.parameters.len();
        let (mut parts, mut instruments, mut y, mut place) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let (mut rows, mut number) = (0, 0);
        for (recording, segments) in recordings.enumerate() {
            for segment in segments {
                for (joint, (factor, acting)) in segment.factors.iter().zip(&identity.acting).enumerate() {
                    let matrix = |first: usize| {
                        let mut matrix = Matrix::zeros(factor.rows(), columns);
                        for (c, &column) in acting.iter().enumerate() {
                            matrix.column_mut(column).copy_from_slice(factor.column(first + c));
                        }
                        matrix
                    };
                    let before = factor.columns() - 1 - acting.len();
                    instruments.extend((before > 0).then(|| matrix(0)));
                    parts.push(matrix(before));
                    y.extend_from_slice(factor.column(before + acting.len()));
                    place.extend(vec![Place { joint, recording, segment: number }; factor.rows()]);
                }
                rows += segment.rows * segment.factors.len();
                number += 1;
            }
        }
        let stack = |parts: &[Matrix]| Matrix::stack(&parts.iter().collect::<Vec<_>>());
        let z = (instruments.len() == parts.len()).then(|| stack(&instruments));
        Self { x: stack(&parts), z, y, place, rows }
    }

    /// LS on some columns of X, with its deviations for the rows that there were.
    pub(super) fn fit(&self, x: &Matrix, weights: Option<&[f64]>, divisor: Divisor) -> Result<Fit, EstimationError> {
        Ok(self.for_all_rows(idim_ls(x, &self.y, weights, divisor)?, x, divisor))
    }

    /// IV likewise.
    pub(super) fn fit_iv(
        &self,
        (z, x): (&Matrix, &Matrix),
        weights: Option<&[f64]>,
        divisor: Divisor,
    ) -> Result<Fit, EstimationError> {
        Ok(self.for_all_rows(idim_iv(z, x, &self.y, weights, divisor)?, x, divisor))
    }

    fn for_all_rows(&self, mut fit: Fit, x: &Matrix, divisor: Divisor) -> Fit {
        let freedom = |rows: usize| match divisor {
            Divisor::RowsMinusParameters => rows.saturating_sub(x.columns()),
            Divisor::RowsMinusOne => rows - 1,
        };
        let factor = (freedom(self.y.len()).max(1) as f64 / freedom(self.rows).max(1) as f64).sqrt();
        fit.standard_deviation.iter_mut().for_each(|sd| *sd *= factor);
        fit
    }

    /// One over the standard deviation of each joint's residual, as
    /// [`joint_weights`](crate::identification::joint_weights) has it.
    pub(super) fn joint_weights(&self, x: &Matrix, fit: &Fit, joints: usize, acting: &[Vec<usize>]) -> Vec<f64> {
        let rows = self.rows / joints;
        let deviation = |joint: usize| {
            let squares: f64 = self.of_joint(joint).map(|k| (self.y[k] - fit.prediction[k]).powi(2)).sum();
            let acts = |c: &usize| self.of_joint(joint).any(|k| x.at(k, *c) != 0.0);
            let parameters = (0..x.columns()).filter(acts).count().min(acting[joint].len());
            (squares / rows.saturating_sub(parameters).max(1) as f64).sqrt()
        };
        let deviations: Vec<f64> = (0..joints).map(deviation).collect();
        let smallest = deviations.iter().copied().filter(|d| *d > 0.0).fold(f64::INFINITY, f64::min);
        let smallest = if smallest.is_finite() { smallest } else { 1.0 };
        deviations.iter().map(|d| 1.0 / d.max(smallest)).collect()
    }

    fn of_joint(&self, joint: usize) -> impl Iterator<Item = usize> + '_ {
        (0..self.y.len()).filter(move |&k| self.place[k].joint == joint)
    }

    /// The relative error of each joint, percent; none where its torque is zero.
    pub(super) fn joint_errors(&self, prediction: &[f64], joints: usize) -> Vec<Option<f64>> {
        let error = |joint| {
            let residual: Vec<f64> = self.of_joint(joint).map(|k| self.y[k] - prediction[k]).collect();
            let measured: Vec<f64> = self.of_joint(joint).map(|k| self.y[k]).collect();
            Some(100.0 * norm(&residual) / norm(&measured)).filter(|e| e.is_finite())
        };
        (0..joints).map(error).collect()
    }
}
