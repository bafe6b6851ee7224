//! Corrections of a recording that are affine in its positions and linear in its torques.

use crate::{
    checks::remedy_step::{RemedySignal, RemedyStep},
    signal::Motion,
};
use thetahat_ground::{linear_algebra::Matrix, series::Series};
use thetahat_model::robot::Robot;

/// The correction of a recording: `q' = A q + b`, with the same `A` for its derivatives, and `tau' = T tau`.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::checks) struct Affine {
    pub(in crate::checks) position: Matrix,
    pub(in crate::checks) shift: Vec<f64>,
    pub(in crate::checks) torque: Matrix,
}

impl Affine {
    pub(in crate::checks) fn identity(n: usize) -> Self {
        Self { position: Matrix::identity(n), shift: vec![0.0; n], torque: Matrix::identity(n) }
    }

    /// Positions times a factor for each coordinate, about `center`.
    pub(in crate::checks) fn scaled_positions(factor: &[f64], center: &[f64]) -> Self {
        let shift = factor.iter().zip(center).map(|(f, c)| c * (1.0 - f)).collect();
        Self { position: diagonal(factor), shift, ..Self::identity(factor.len()) }
    }

    /// Torques times a factor for each coordinate.
    pub(in crate::checks) fn scaled_torques(factor: &[f64]) -> Self {
        Self { torque: diagonal(factor), ..Self::identity(factor.len()) }
    }

    /// Positions plus a shift.
    pub(in crate::checks) fn shifted(shift: Vec<f64>) -> Self {
        let n = shift.len();
        Self { shift, ..Self::identity(n) }
    }

    /// Positions of coordinates `a` and `b` exchanged.
    pub(in crate::checks) fn exchanged_positions(n: usize, a: usize, b: usize) -> Self {
        Self { position: exchange(n, a, b), ..Self::identity(n) }
    }

    /// Torques of coordinates `a` and `b` exchanged.
    pub(in crate::checks) fn exchanged_torques(n: usize, a: usize, b: usize) -> Self {
        Self { torque: exchange(n, a, b), ..Self::identity(n) }
    }

    /// Torques, or positions as well, in another order: those of coordinate j are in channel `order[j]`.
    pub(in crate::checks) fn ordered(order: &[usize], signal: RemedySignal) -> Self {
        let [position, torque] = [signal.has_position(), signal.has_torque()]
            .map(|is_moved| if is_moved { permutation(order) } else { Matrix::identity(order.len()) });
        Self { position, torque, shift: vec![0.0; order.len()] }
    }

    /// The same motors with gear ratios that are `factor` times as large: `q' = N^-1 D^-1 N (q - o) + o` and
    /// `tau' = N^T D N^-T tau`. `None` if N is singular.
    pub(in crate::checks) fn geared(robot: &Robot, factor: &[f64]) -> Option<Self> {
        let n = robot.transmission.matrix();
        let inverse = n.inverse()?;
        let slower: Vec<f64> = factor.iter().map(|f| 1.0 / f).collect();
        let position = inverse.times_matrix(&diagonal(&slower)).times_matrix(n);
        let torque = n.transpose().times_matrix(&diagonal(factor)).times_matrix(&inverse.transpose());
        let offset = robot.transmission.offset();
        let shift = offset.iter().zip(position.times(offset)).map(|(o, turned)| o - turned).collect();
        Some(Self { position, shift, torque })
    }

    pub(in crate::checks) fn motion(&self, motion: &Motion) -> Motion {
        let zero = vec![0.0; self.shift.len()];
        Motion {
            q: map(&self.position, &self.shift, &motion.q),
            dq: map(&self.position, &zero, &motion.dq),
            ddq: map(&self.position, &zero, &motion.ddq),
        }
    }

    pub(in crate::checks) fn torque(&self, torque: &Series) -> Series {
        map(&self.torque, &vec![0.0; self.shift.len()], torque)
    }
}

impl Affine {
    /// The change of the channels that has the same effect: factors, or another order of the joints. `None` if it has another form, such
    /// as a shift.
    pub(in crate::checks) fn step(&self) -> Option<RemedyStep> {
        if self.shift.iter().any(|s| *s != 0.0) {
            return None;
        }
        match (entries_of(&self.position), entries_of(&self.torque)) {
            (Some(position), Some(torque)) => {
                let [position, torque] = [position, torque].map(factors);
                Some(RemedyStep::Scale { position, torque })
            }
            (position, torque) => {
                let order = |matrix: &Matrix, entries: &Option<Vec<f64>>| match entries {
                    None => order_of(matrix).map(Some),
                    Some(entries) => entries.iter().all(|e| *e == 1.0).then_some(None),
                };
                let (signal, order) = match (order(&self.position, &position)?, order(&self.torque, &torque)?) {
                    (Some(order), None) => (RemedySignal::Position, order),
                    (None, Some(order)) => (RemedySignal::Torque, order),
                    (Some(order), Some(same)) if order == same => (RemedySignal::Both, order),
                    (Some(_), Some(_)) | (None, None) => return None,
                };
                let order = order.iter().map(|channel| channel + 1).collect();
                Some(RemedyStep::OrderJoints { signal, order })
            }
        }
    }
}

impl Affine {
    /// The coordinates, from zero, whose positions and torques are exchanged.
    pub(in crate::checks) fn exchanged_joints(&self) -> Option<[usize; 2]> {
        let step =
            self.step().filter(|step| matches!(step, RemedyStep::OrderJoints { signal: RemedySignal::Both, .. }))?;
        let [a, b] = step.moved_joints()[..] else { return None };
        Some([a - 1, b - 1])
    }
}

/// The entries of a diagonal matrix.
fn entries_of(matrix: &Matrix) -> Option<Vec<f64>> {
    let n = matrix.columns();
    let is_diagonal = (0..n).all(|i| (0..n).all(|j| i == j || matrix.at(i, j) == 0.0));
    is_diagonal.then(|| (0..n).map(|i| matrix.at(i, i)).collect())
}

/// Factors, or an empty list where all are one.
fn factors(entries: Vec<f64>) -> Vec<f64> {
    if entries.iter().all(|e| *e == 1.0) { Vec::new() } else { entries }
}

/// The order of a permutation; none of another matrix.
fn order_of(matrix: &Matrix) -> Option<Vec<usize>> {
    let n = matrix.columns();
    let order: Vec<usize> = (0..n).map(|i| (0..n).find(|&j| matrix.at(i, j) != 0.0)).collect::<Option<_>>()?;
    (*matrix == permutation(&order)).then_some(order)
}

pub(in crate::checks) fn diagonal(entries: &[f64]) -> Matrix {
    Matrix::from_fn(entries.len(), entries.len(), |i, j| if i == j { entries[i] } else { 0.0 })
}

fn exchange(n: usize, a: usize, b: usize) -> Matrix {
    let mut order: Vec<usize> = (0..n).collect();
    order.swap(a, b);
    permutation(&order)
}

fn permutation(order: &[usize]) -> Matrix {
    Matrix::from_fn(order.len(), order.len(), |i, j| if order[i] == j { 1.0 } else { 0.0 })
}

fn map(matrix: &Matrix, shift: &[f64], series: &Series) -> Series {
    let mut mapped = Series::zeros(series.len(), series.channels());
    for k in 0..series.len() {
        let (from, to) = (series.sample(k), mapped.sample_mut(k));
        for (i, t) in to.iter_mut().enumerate() {
            *t = shift[i] + from.iter().enumerate().map(|(j, v)| matrix.at(i, j) * v).sum::<f64>();
        }
    }
    mapped
}
