//! Variances from the scores of stretches of time: errors may be correlated in any way within a stretch, and between the
//! joints, and are taken to be independent from one stretch to the next.

use crate::{
    identification::EstimationError,
    linear_algebra::{Matrix, PivotedQr},
    statistics::EstimatedVariance,
};

/// Least part of its own errors that a stretch is taken to leave in its residual.
const LEAST_LEFT: f64 = 0.01;

/// The variance of each parameter of a least squares fit, with its degrees of freedom.
///
/// With `X = Q R` and `W_g` the rows of Q of stretch g, `G_g = W_g^T W_g`, the score is `b_g = (I - G_g)^(-1/2) W_g^T e_g`
/// and the covariance `R^-1 sum_g b_g b_g^T R^-T`: the bias-reduced linearisation (CR2) and its Satterthwaite degrees of
/// freedom of R. M. Bell, D. F. McCaffrey, "Bias reduction in standard errors for linear regression with multi-stage
/// samples", Survey Methodology 28, 2002, written for matrices of the size of the parameters. Any rows that have the factors
/// of the stretches give the same.
///
/// `segment` names the stretch of each row, from zero.
///
/// # Errors
/// [`EstimationError::TooFewRows`] for fewer than two stretches.
pub(super) fn cluster_variances(
    x: &Matrix,
    residual: &[f64],
    segment: &[usize],
) -> Result<Vec<EstimatedVariance>, EstimationError> {
    let (columns, count) = (x.columns(), segment.iter().max().map_or(0, |last| last + 1));
    if count < 2 {
        return Err(EstimationError::TooFewRows { rows: count, columns: 2 });
    }
    let inverse = PivotedQr::with_equal_columns(&x.triangular_factor()).solve_matrix(&Matrix::identity(columns));
    let stretches: Vec<Stretch> =
        (0..count).map(|g| Stretch::new(x, residual, segment, g, &inverse)).collect::<Option<_>>().ok_or(EstimationError::NotFinite)?;
    Ok((0..columns).map(|i| variance(&stretches, &(0..columns).map(|c| inverse.at(i, c)).collect::<Vec<_>>())).collect())
}

/// What a stretch of time contributes.
struct Stretch {
    /// `b_g`
    score: Vec<f64>,
    /// `(I - G)^(-1/2) G` and `(I - G)^-1 G`
    half: Matrix,
    full: Matrix,
}

impl Stretch {
    fn new(x: &Matrix, residual: &[f64], segment: &[usize], number: usize, inverse: &Matrix) -> Option<Self> {
        let own: Vec<bool> = segment.iter().map(|s| *s == number).collect();
        let e: Vec<f64> = residual.iter().zip(&own).filter(|(_, own)| **own).map(|(e, _)| *e).collect();
        let w = x.select_rows(&own).times_matrix(inverse);
        let (values, vectors) = w.transposed_times(&w).symmetric_eigen()?;
        let left = |g: &f64| (1.0 - g).max(LEAST_LEFT);
        let of = |f: &dyn Fn(&f64) -> f64| {
            let scaled = vectors.scale_columns(&values.iter().map(f).collect::<Vec<_>>());
            scaled.times_matrix(&vectors.transpose())
        };
        let root = of(&|g| left(g).powf(-0.5));
        let score = root.times(&w.transpose().times(&e));
        Some(Self { score, half: of(&|g| g * left(g).powf(-0.5)), full: of(&|g| g / left(g)) })
    }
}

/// The variance of `d^T` times the sum of the scores.
fn variance(stretches: &[Stretch], d: &[f64]) -> EstimatedVariance {
    let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    let own: Vec<f64> = stretches.iter().map(|s| dot(d, &s.full.times(d))).collect();
    let v: Vec<Vec<f64>> = stretches.iter().map(|s| s.half.times(d)).collect();
    let entry = |g: usize, h: usize| if g == h { own[g] - dot(&v[g], &v[g]) } else { -dot(&v[g], &v[h]) };
    let trace: f64 = (0..v.len()).map(|g| entry(g, g)).sum();
    let squares: f64 = (0..v.len()).flat_map(|g| (0..v.len()).map(move |h| (g, h))).map(|(g, h)| entry(g, h).powi(2)).sum();
    let found: f64 = stretches.iter().map(|s| dot(d, &s.score).powi(2)).sum();
    // One where no stretch takes up nearly all of its own errors.
    let unbiased = dot(d, d) / trace;
    EstimatedVariance { variance: unbiased * found, freedom: trace * trace / squares }
}
