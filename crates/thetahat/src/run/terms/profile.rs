//! The constants of Stribeck friction by variable projection: for each velocity and exponent of a grid, the linear
//! parameters are estimated, and the grid closes in on the smallest residual.

use super::column_source::ColumnSource;
use crate::preparation::PreparationError;
use thetahat_ground::linear_algebra::{Matrix, PivotedQr, dot};
use thetahat_model::robot::{Shape, Stribeck, StribeckLaw, TermColumn};

/// Rounds of the search, each in a grid that is half as wide.
const ROUNDS: usize = 4;
/// The first grid: velocities relative to the joint's largest one.
const SLOWEST: f64 = 2e-3;
const FASTEST: f64 = 0.5;
/// Velocities and exponents of a grid.
const VELOCITIES: usize = 9;
const EXPONENTS: [f64; 3] = [0.5, 1.0, 2.0];
/// Exponents that are searched.
const EXPONENT_RANGE: [f64; 2] = [0.4, 4.0];

/// Constants found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::run) struct ProfileMinimum {
    pub(in crate::run) stribeck: Stribeck,
    /// Whether they are at an end of what is searched.
    pub(in crate::run) at_limit: bool,
}

/// What is left of the weighted rows once the other columns are taken off.
pub(in crate::run) struct Projection<'a> {
    source: ColumnSource<'a>,
    weights: Vec<f64>,
    others: Matrix,
    qr: PivotedQr,
    residual: Vec<f64>,
}

impl<'a> Projection<'a> {
    /// `others` are the columns whose parameters are estimated along, without weights.
    pub(in crate::run) fn new(source: ColumnSource<'a>, weights: Vec<f64>, others: &Matrix) -> Self {
        let others = others.scale_rows(&weights);
        let qr = PivotedQr::new(&others);
        let y: Vec<f64> = source.problem.regression.y.iter().zip(&weights).map(|(y, w)| y * w).collect();
        let residual = less_projection(&qr, &others, &y);
        Self { source, weights, others, qr, residual }
    }

    /// The constants of a column of Stribeck friction with the smallest residual.
    pub(in crate::run) fn profile(
        &self,
        column: &TermColumn,
        law: StribeckLaw,
    ) -> Result<ProfileMinimum, PreparationError> {
        let joints = self.source.robot().coordinate_joints();
        let peak = self.source.peak_velocity(joints.iter().position(|&j| j == column.joint).unwrap_or(0));
        let (slowest, fastest) = ((SLOWEST * peak).ln(), (FASTEST * peak).ln());
        let (mut centre, mut width) = (0.5 * (slowest + fastest), fastest - slowest);
        let mut exponents = EXPONENTS.to_vec();
        let mut best = Stribeck { law, velocity: centre.exp(), exponent: 1.0 };
        for _ in 0..ROUNDS {
            let place = |k: usize| centre + width * (k as f64 / (VELOCITIES - 1) as f64 - 0.5);
            let velocities = (0..VELOCITIES).map(|k| place(k).clamp(slowest, fastest).exp());
            let grid: Vec<Stribeck> = velocities
                .flat_map(|velocity| exponents.iter().map(move |&exponent| Stribeck { law, velocity, exponent }))
                .collect();
            best = self.best_of(column, &grid)?;
            centre = best.velocity.ln();
            width *= 0.35;
            let [least, most] = EXPONENT_RANGE;
            exponents = [0.75, 0.9, 1.0, 1.1, 1.35].map(|factor| (best.exponent * factor).clamp(least, most)).to_vec();
        }
        let near = |value: f64, end: f64| (value / end - 1.0).abs() < 0.02;
        let at_limit = near(best.velocity, slowest.exp()) || near(best.velocity, fastest.exp());
        let stribeck = Stribeck { velocity: rounded(best.velocity), exponent: rounded(best.exponent), law };
        Ok(ProfileMinimum { stribeck, at_limit })
    }

    /// The constants of a grid whose column takes most off the residual.
    fn best_of(&self, column: &TermColumn, grid: &[Stribeck]) -> Result<Stribeck, PreparationError> {
        let of = |(k, stribeck): (usize, &Stribeck)| TermColumn {
            parameter: format!("profiled_{k}"),
            shape: Shape::Stribeck(*stribeck),
            ..column.clone()
        };
        let columns = grid.iter().enumerate().map(of).collect();
        let matrix = self.source.columns(columns)?;
        let taken = |k: usize| {
            let weighted: Vec<f64> = matrix.column(k).iter().zip(&self.weights).map(|(z, w)| z * w).collect();
            let size = dot(&weighted, &weighted);
            let own = less_projection(&self.qr, &self.others, &weighted);
            let left = dot(&own, &own);
            // A column that the others replace takes nothing off.
            if left > DEPENDENT * size { dot(&own, &self.residual).powi(2) / left } else { 0.0 }
        };
        let best = (0..grid.len()).map(|k| (k, taken(k))).max_by(|a, b| a.1.total_cmp(&b.1));
        Ok(best.map_or(grid[0], |(k, _)| grid[k]))
    }
}

/// Part of a column's square that is rounding once the others are taken off.
const DEPENDENT: f64 = 1e-10;

fn less_projection(qr: &PivotedQr, columns: &Matrix, y: &[f64]) -> Vec<f64> {
    y.iter().zip(columns.times(&qr.solve(y))).map(|(y, p)| y - p).collect()
}

/// Three significant digits, as they are written into a file.
fn rounded(value: f64) -> f64 {
    let digits = 10.0_f64.powf(2.0 - value.abs().log10().floor());
    (value * digits).round() / digits
}
