//! Whether the model explains a joint's torque better than a constant does, where its rows are correlated.

use super::independent::independent_rows;
use thetahat_estimation::{
    regression::Regression,
    statistics::{FTest, f_test, median},
};
use thetahat_ground::linear_algebra::{Matrix, PivotedQr, norm};
use thetahat_report::results::Explained;

/// Shifts of the torque against the motion, at the most.
const SHIFTS: usize = 200;
/// Median of the distances from the median, of a normal distribution in its standard deviations.
const MEDIAN_DISTANCE: f64 = 0.6745;

/// Compares the fit of joint `j` with that of a constant. The F-test counts as many rows as independent ones of the residual are
/// worth, and every parameter that acts on the joint; where it cannot exclude chance, as many as the joint's own rows determine,
/// `absorbed`: other joints determine the rest. Where that cannot either, because rows are too few, the joint's parameters are
/// fitted to the same torque shifted in time: a torque that belongs to the motion is explained better than these are.
pub(super) fn explained(
    regression: &Regression,
    j: usize,
    residual: &[&[f64]],
    absorbed: &dyn Fn(usize) -> f64,
) -> Option<Explained> {
    let rows: Vec<usize> = regression.layout.used_rows_of_joint(j).collect();
    let x = acting(regression, &rows);
    let y: Vec<f64> = rows.iter().map(|&k| regression.y[k]).collect();
    let centred = less_mean(&y);
    let of_mean = norm(&centred).powi(2);
    // The base of a robot in flight: what acts on it is zero, and nothing is left to explain.
    if of_mean == 0.0 {
        return None;
    }
    let of_model = norm(&residual.concat()).powi(2);
    let independent = independent_rows(residual).floor() as usize;
    let test_of = |parameters: usize| {
        let parameters = parameters.max(2);
        f_test(of_mean, 1, of_model, parameters, independent.max(parameters + 1))
    };
    let is_certain = |test: &FTest| test.p_value <= Explained::LIMIT;
    let test = test_of(x.columns())?;
    let test = if is_certain(&test) { test } else { test_of(absorbed(j).ceil() as usize)? };
    let deviations_above_shifted = if is_certain(&test) { None } else { deviations_above_shifted(&x, &centred) };
    Some(Explained { test, deviations_above_shifted })
}

/// How many parameters the rows of each joint determine: the sums of their leverages, whitened, which are all parameters together.
pub(super) fn absorbed(regression: &Regression) -> Vec<f64> {
    let q = PivotedQr::new(&regression.whiten_matrix(&regression.x)).thin_q();
    let mut leverage = vec![0.0; q.rows()];
    for c in 0..q.columns() {
        leverage.iter_mut().zip(q.column(c)).for_each(|(h, q)| *h += q * q);
    }
    let of_joint = |j: usize| regression.layout.used_rows_of_joint(j).map(|k| leverage[k]).sum();
    (0..regression.layout.joints()).map(of_joint).collect()
}

/// The columns that are not zero in some rows.
fn acting(regression: &Regression, rows: &[usize]) -> Matrix {
    let acts = |c: &usize| {
        let column = regression.x.column(*c);
        rows.iter().any(|&k| column[k] != 0.0)
    };
    let columns: Vec<usize> = (0..regression.parameters()).filter(acts).collect();
    Matrix::from_fn(rows.len(), columns.len(), |k, c| regression.x.at(rows[k], columns[c]))
}

fn less_mean(y: &[f64]) -> Vec<f64> {
    let mean = y.iter().sum::<f64>() / y.len().max(1) as f64;
    y.iter().map(|y| y - mean).collect()
}

/// By how many robust deviations of the shifted fits the logarithm of what is left is below their median; none if the fits
/// leave nothing, or do not differ.
fn deviations_above_shifted(x: &Matrix, y: &[f64]) -> Option<f64> {
    if x.columns() == 0 || x.columns() >= x.rows() {
        return None;
    }
    let q = PivotedQr::new(x).thin_q();
    let all = norm(y).powi(2);
    let left = |shift: usize| {
        let shifted: Vec<f64> = (0..y.len()).map(|k| y[(k + shift) % y.len()]).collect();
        (1.0 - norm(&q.transpose_times(&shifted)).powi(2) / all).max(f64::MIN_POSITIVE).ln()
    };
    let shifts = SHIFTS.min(y.len() - 1);
    let shifted: Vec<f64> = (1..=shifts).map(|s| left(s * y.len() / (shifts + 1))).collect();
    let centre = median(&shifted);
    let distances: Vec<f64> = shifted.iter().map(|l| (l - centre).abs()).collect();
    let deviation = median(&distances) / MEDIAN_DISTANCE;
    Some((centre - left(0)) / deviation).filter(|z| z.is_finite())
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use thetahat_estimation::regression::RowLayout;

    const ROWS: usize = 400;

    /// Sines as columns, and a torque of noise with a correlation from row to row added to some part of the first column.
    fn regression(seed: u64, correlation: f64, part: f64) -> Regression {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let column = |k: usize, c: usize| (0.013 * (1.0 + 1.7 * c as f64) * k as f64 + c as f64).sin();
        let x = Matrix::from_fn(ROWS, 6, column);
        let mut noise = 0.0;
        let mut y = Vec::with_capacity(ROWS);
        for k in 0..ROWS {
            noise = correlation * noise + rng.random_range(-1.0..1.0);
            y.push(part * column(k, 0) + noise);
        }
        Regression::new(x, y, RowLayout::new(1, &[ROWS]))
    }

    fn of(regression: &Regression) -> Explained {
        let theta = PivotedQr::new(&regression.x).solve(&regression.y);
        let residual = regression.residual(&regression.x.times(&theta));
        explained(regression, 0, &[&residual], &|j| absorbed(regression)[j]).unwrap()
    }

    /// Of forty joints that share their parameters, each one's torque was said to be "explained no better than a constant does", and
    /// "0 % of it" left: all parameters were counted against the rows of one joint.
    #[test]
    fn parameters_that_other_joints_determine_do_not_count() {
        let (joints, rows, columns) = (20, 60, 50);
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let x = Matrix::from_fn(joints * rows, columns, |k, c| (0.37 * (k * (c + 1)) as f64 + c as f64).sin());
        let theta: Vec<f64> = (0..columns).map(|_| rng.random_range(-1.0..1.0)).collect();
        let mut y = x.times(&theta);
        y.iter_mut().for_each(|y| *y += rng.random_range(-0.1..0.1));
        // The last joint has noise alone.
        y[(joints - 1) * rows..].iter_mut().for_each(|y| *y = rng.random_range(-1.0..1.0));
        let regression = Regression::new(x, y, RowLayout::new(joints, &[rows]));
        let residual = regression.residual(&regression.x.times(&theta));
        let absorbed = absorbed(&regression);
        assert!((absorbed.iter().sum::<f64>() - columns as f64).abs() < 1e-9, "{absorbed:?}");
        for (j, runs) in regression.layout.runs(&residual).iter().enumerate() {
            let found = explained(&regression, j, runs, &|j| absorbed[j]).unwrap();
            assert_eq!(found.is_by_chance(), j == joints - 1, "joint {j}: {found:?}");
            assert!(found.test.p_value < Explained::LIMIT || j == joints - 1, "joint {j}: {found:?}");
        }
    }

    #[test]
    fn a_motion_is_distinguished_from_noise_of_any_correlation() {
        for (seed, correlation) in (0..200).flat_map(|seed| [0.0, 0.5, 0.9].map(|c| (seed, c))) {
            let noise = of(&regression(seed, correlation, 0.0));
            assert!(noise.is_by_chance(), "seed {seed}, {correlation}: {noise:?}");
            let size = 3.0 / (1.0 - correlation);
            let torque = of(&regression(seed, correlation, size));
            assert!(!torque.is_by_chance(), "seed {seed}, {correlation}: {torque:?}");
        }
    }
}
