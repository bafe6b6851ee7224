use super::*;

const ROWS: usize = 400;

/// Two regressors, one observed with an error that also enters y as feedback would make it, and instruments.
fn example() -> (Regression, Matrix) {
    let clean = Matrix::from_fn(ROWS, 2, |k, j| (0.05 * (k * (j + 1)) as f64).sin());
    let noise = |k: usize| 0.5 * ((12.9898 * k as f64).sin() * 43758.5453).fract();
    let x = Matrix::from_fn(ROWS, 2, |k, j| clean.at(k, j) + if j == 0 { noise(k) } else { 0.0 });
    let y = (0..ROWS).map(|k| 2.0 * clean.at(k, 0) - 3.0 * clean.at(k, 1)).collect();
    (Regression::single_series(x, y), clean)
}

#[test]
fn iv_is_consistent_where_ls_is_not() {
    let (regression, z) = example();
    let ls = idim_ls(&regression, Divisor::default()).unwrap();
    let iv = idim_iv(&regression, &z, Divisor::default()).unwrap();
    assert!((ls.theta[0] - 2.0).abs() > 5.0 * ls.standard_deviation[0]);
    assert!((iv.theta[0] - 2.0).abs() < 3.0 * iv.standard_deviation[0]);
}

#[test]
fn iv_with_its_own_regressors_is_ls() {
    let (regression, _) = example();
    let ls = idim_ls(&regression, Divisor::default()).unwrap();
    let iv = idim_iv(&regression, &regression.x, Divisor::default()).unwrap();
    for i in 0..2 {
        assert!((ls.theta[i] - iv.theta[i]).abs() < 1e-12);
        assert!((ls.standard_deviation[i] - iv.standard_deviation[i]).abs() < 1e-12);
        assert!((ls.covariance.at(0, i) - iv.covariance.at(0, i)).abs() < 1e-12);
    }
    assert!((ls.condition_number - iv.condition_number).abs() < 1e-9);
}

#[test]
fn iv_is_the_formula_of_the_paper() {
    let (regression, z) = example();
    let weights: Vec<f64> = (0..ROWS).map(|k| 1.0 + (k % 3) as f64).collect();
    let fit = idim_iv(&regression.with_weights(Some(weights.clone())), &z, Divisor::default()).unwrap();
    let (zw, xw) = (z.scale_rows(&weights), regression.x.scale_rows(&weights));
    let yw: Vec<f64> = regression.y.iter().zip(&weights).map(|(y, w)| y * w).collect();
    let cross = zw.transpose().times_matrix(&xw).inverse().unwrap();
    let direct = cross.times(&zw.transpose().times(&yw));
    let gram = cross.times_matrix(&zw.transpose().times_matrix(&zw)).times_matrix(&cross.transpose());
    let residual: f64 = xw.times(&direct).iter().zip(&yw).map(|(p, y)| (y - p).powi(2)).sum();
    let variance = residual / (ROWS - 2) as f64;
    for (i, expected) in direct.iter().enumerate() {
        assert!((fit.theta[i] - expected).abs() < 1e-11);
        assert!((fit.standard_deviation[i] - (variance * gram.at(i, i)).sqrt()).abs() < 1e-12);
        assert!((fit.covariance.at(i, 0) - variance * gram.at(i, 0)).abs() < 1e-12);
    }
}

#[test]
fn whitening_acts_on_all_three_alike() {
    // Rows of weight zero count as absent.
    let (regression, z) = example();
    let weights: Vec<f64> = (0..ROWS).map(|k| if k % 2 == 0 { 1.0 } else { 0.0 }).collect();
    let keep: Vec<bool> = (0..ROWS).map(|k| k % 2 == 0).collect();
    let half =
        Regression::single_series(regression.x.select_rows(&keep), regression.y.iter().step_by(2).copied().collect());
    let weighted = idim_iv(&regression.with_weights(Some(weights)), &z, Divisor::default()).unwrap();
    let cut = idim_iv(&half, &z.select_rows(&keep), Divisor::default()).unwrap();
    assert!((weighted.theta[0] - cut.theta[0]).abs() < 1e-12);
}

#[test]
fn torques_of_zero_give_no_estimate() {
    let (regression, _) = example();
    let still = Regression::single_series(regression.x.as_ref().clone(), vec![0.0; ROWS]);
    assert_eq!(idim_ls(&still, Divisor::default()), Err(EstimationError::NotFinite));
}

#[test]
fn a_dependent_column_is_named() {
    let x = Matrix::from_fn(ROWS, 3, |k, j| if j == 2 { 0.0 } else { (0.1 * (k * (j + 1)) as f64).cos() });
    let error = idim_ls(&Regression::single_series(x, vec![1.0; ROWS]), Divisor::default()).unwrap_err();
    assert_eq!(error, EstimationError::NotIdentifiable { rank: 2, columns: 3, dependent: vec![2] });
}

/// Of every estimator of the table: an estimate is its influence times y, and where rows are neither weighted nor filtered the
/// classical covariance is `s^2 A^T A`.
#[test]
fn the_influence_is_what_turns_y_into_the_estimate() {
    let (regression, z) = example();
    let weights: Vec<f64> = (0..ROWS).map(|k| 1.0 + (k % 4) as f64).collect();
    for weights in [None, Some(weights)] {
        let regression = regression.with_weights(weights);
        for method in Method::all() {
            let fit = method.estimate(&regression, Some(&z), Divisor::default()).unwrap();
            let a = method.influence(&regression, Some(&z)).unwrap();
            for (i, theta) in a.transpose_times(&regression.y).into_iter().enumerate() {
                assert!((theta - fit.theta[i]).abs() < 1e-12, "{method}");
            }
            if regression.weights.is_none() && method != Method::IDIM_PIV {
                let variance = regression.residual_sum_of_squares(&fit.prediction) / (ROWS - 2) as f64;
                let product = a.transposed_times(&a);
                let expected = Matrix::from_fn(2, 2, |i, j| variance * product.at(i, j));
                assert!((fit.covariance.at(1, 0) - expected.at(1, 0)).abs() < 1e-12 * expected.at(1, 1), "{method}");
            }
        }
    }
}

#[test]
fn without_instruments_iv_and_didim_have_no_estimate() {
    let (regression, _) = example();
    for method in Method::all().filter(|m| m.needs() == Needs::Instruments) {
        assert_eq!(method.influence(&regression, None), Err(EstimationError::NoInstruments));
        assert_eq!(method.estimate(&regression, None, Divisor::default()), Err(EstimationError::NoInstruments));
    }
}

#[test]
fn names_are_distinct_and_parse_to_their_methods() {
    for method in Method::all() {
        assert_eq!(method.name().parse::<Method>(), Ok(method));
    }
    let error = serde_json::from_str::<Method>("\"idim-lss\"").unwrap_err().to_string();
    assert!(
        error.starts_with("unknown variant `idim-lss`, expected one of `idim-ls`, `idim-wls`, `idim-iv`"),
        "{error}"
    );
}
