//! Convex quadratic programs: the only module that uses the solver's library.

use clarabel::{
    algebra::CscMatrix,
    solver::{DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus},
};

use crate::linear_algebra::Matrix;

/// `sum_i a_i p_i <= bound`, or with the slack that all soft rows share.
#[derive(Debug, Clone)]
pub struct Row {
    /// First unknown of the entries.
    pub start: usize,
    /// Consecutive entries.
    pub entries: Vec<f64>,
    /// The bound.
    pub bound: f64,
    /// Whether it may be violated, at a price.
    pub soft: bool,
}

/// `p` with the least `1/2 p^T B p + g^T p + price t`, where no hard row and with the slack `t >= 0` no soft row is violated.
///
/// `None` if the solver finds no solution.
#[must_use]
pub fn least(hessian: &Matrix, gradient: &[f64], rows: &[Row], price: f64) -> Option<Vec<f64>> {
    let size = gradient.len();
    let p = upper_triangle(hessian);
    let q: Vec<f64> = gradient.iter().copied().chain([price]).collect();
    let slack = Row { start: size, entries: vec![-1.0], bound: 0.0, soft: false };
    let rows: Vec<&Row> = rows.iter().chain([&slack]).collect();
    let a = columns_of(&rows, size + 1);
    let b: Vec<f64> = rows.iter().map(|row| row.bound).collect();
    let settings = DefaultSettings {
        verbose: false,
        max_iter: MOST_STEPS,
        tol_gap_abs: TOLERANCE,
        tol_gap_rel: TOLERANCE,
        tol_feas: TOLERANCE,
        iterative_refinement_enable: false,
        // Rows are in parts of limits, and all of them matter.
        equilibrate_enable: false,
        presolve_enable: false,
        ..DefaultSettings::default()
    };
    let cones = [NonnegativeConeT(rows.len())];
    let mut solver = DefaultSolver::new(&p, &q, &a, &b, &cones, settings).ok()?;
    solver.solve();
    let usable = matches!(
        solver.solution.status,
        SolverStatus::Solved | SolverStatus::AlmostSolved | SolverStatus::InsufficientProgress
    );
    let mut x = solver.solution.x.clone();
    x.truncate(size);
    (usable && x.iter().all(|v| v.is_finite())).then_some(x)
}

/// Steps of the interior point method; it takes 10 to 25.
const MOST_STEPS: u32 = 60;

/// A step need not be exact: a line search follows.
const TOLERANCE: f64 = 1e-6;

/// The upper triangle of the Hessian, then the slack's empty column.
fn upper_triangle(hessian: &Matrix) -> CscMatrix<f64> {
    let size = hessian.rows();
    let mut starts = vec![0];
    let (mut places, mut values) = (Vec::new(), Vec::new());
    for j in 0..size {
        places.extend(0..=j);
        values.extend_from_slice(&hessian.column(j)[..=j]);
        starts.push(places.len());
    }
    starts.push(places.len());
    CscMatrix::new(size + 1, size + 1, starts, places, values)
}

/// The rows as a matrix column by column; soft ones have -1 in the last.
fn columns_of(rows: &[&Row], columns: usize) -> CscMatrix<f64> {
    let mut entries: Vec<Vec<(usize, f64)>> = vec![Vec::new(); columns];
    for (i, row) in rows.iter().enumerate() {
        row.entries.iter().enumerate().for_each(|(c, v)| entries[row.start + c].push((i, *v)));
        if row.soft {
            entries[columns - 1].push((i, -1.0));
        }
    }
    let mut starts = vec![0];
    entries.iter().for_each(|column| starts.push(starts[starts.len() - 1] + column.len()));
    let (places, values) = entries.into_iter().flatten().unzip();
    CscMatrix::new(rows.len(), columns, starts, places, values)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The point of a box nearest to (3, -2), and of the same with a half plane that may be violated.
    #[test]
    fn the_nearest_point_is_found() {
        let (identity, gradient) = (Matrix::identity(2), [-3.0, 2.0]);
        let bound = |start, entry, bound| Row { start, entries: vec![entry], bound, soft: false };
        let mut rows = vec![bound(0, 1.0, 1.0), bound(1, -1.0, 0.5)];
        let close = |found: Option<Vec<f64>>, expected: [f64; 2]| {
            let found = found.unwrap();
            assert!(found.iter().zip(expected).all(|(f, e)| (f - e).abs() < 1e-4), "{found:?}");
        };
        close(least(&identity, &gradient, &rows, 10.0), [1.0, -0.5]);
        // x + y <= 0.2 costs more than the price where that is low.
        rows.push(Row { start: 0, entries: vec![1.0, 1.0], bound: 0.2, soft: true });
        close(least(&identity, &gradient, &rows, 10.0), [0.7, -0.5]);
        close(least(&identity, &gradient, &rows, 0.1), [1.0, -0.5]);
    }
}
