//! The estimator of the program against the NIST reference sets for linear regression: digits of estimates and of
//! standard deviations. The table in `docs/evidence/reference_data.md` is printed by
//! `cargo test --release -p thetahat --test suite nist_strd -- --nocapture`.

#[path = "nist_strd/data.rs"]
mod data;

use data::{Columns, DataSet, SETS};
use thetahat::{
    Matrix,
    identification::{Fit, idim_ls},
    regression::Regression,
};
use thetahat_estimation::identification::Divisor;

/// Certified values have 15 digits.
const CERTIFIED_DIGITS: f64 = 15.0;

/// Digits that each set must keep: of its estimates, its standard deviations and its residual's standard deviation. Where
/// fewer than nine, the data do not determine more in double precision: the condition numbers of Filip's and Wampler's
/// powers, and for Wampler4 and 5 a residual that is far larger than the signal.
const FLOORS: [(&str, f64, f64, f64); 11] = [
    ("Norris", 12.0, 12.0, 13.0),
    ("Pontius", 11.0, 12.0, 12.0),
    ("NoInt1", 14.0, 14.0, 14.0),
    ("NoInt2", 14.0, 14.0, 14.0),
    ("Longley", 10.0, 11.0, 12.0),
    ("Filip", 6.0, 6.0, 7.0),
    ("Wampler1", 8.0, 0.0, 0.0),
    ("Wampler2", 11.0, 0.0, 0.0),
    ("Wampler3", 8.0, 9.0, 12.0),
    ("Wampler4", 7.0, 9.0, 12.0),
    ("Wampler5", 5.0, 9.0, 12.0),
];

fn matrix(set: &DataSet) -> Matrix {
    let rows = set.y.len();
    match set.columns {
        Columns::Polynomial(columns) => Matrix::from_fn(rows, columns, |k, i| set.x[k].powi(i as i32)),
        Columns::Proportional => Matrix::from_fn(rows, 1, |k, _| set.x[k]),
        Columns::Longley => Matrix::from_fn(rows, 7, |k, i| if i == 0 { 1.0 } else { set.x[6 * k + i - 1] }),
    }
}

/// Correct decimal digits, `-log10 |(value - certified) / certified|`; none for a certified zero.
fn digits(value: f64, certified: f64) -> Option<f64> {
    let error = ((value - certified) / certified).abs();
    (certified != 0.0).then(|| (-error.log10()).min(CERTIFIED_DIGITS))
}

/// The fewest digits of a list of values.
fn fewest(values: &[f64], certified: &[f64]) -> Option<f64> {
    values.iter().zip(certified).filter_map(|(v, c)| digits(*v, *c)).reduce(f64::min)
}

fn regression(set: &DataSet) -> Regression {
    Regression::single_series(matrix(set), set.y.to_vec())
}

fn residual_deviation(set: &DataSet, fit: &Fit) -> f64 {
    (regression(set).residual_sum_of_squares(&fit.prediction) / (set.y.len() - fit.theta.len()) as f64).sqrt()
}

fn shown(digits: Option<f64>) -> String {
    digits.map_or("-".to_owned(), |d| format!("{d:.1}"))
}

#[test]
fn certified_values_are_met_to_the_digits_stated() {
    println!(
        "| set | condition number | estimates | standard deviations | residual |\n| --- | --- | --- | --- | --- |"
    );
    for (set, (name, estimates, deviations, residual)) in SETS.iter().zip(FLOORS) {
        assert_eq!(set.name, name);
        let fit = idim_ls(&regression(set), Divisor::default()).unwrap();
        let found = [
            fewest(&fit.theta, set.estimates),
            fewest(&fit.standard_deviation, set.standard_deviations),
            digits(residual_deviation(set, &fit), set.residual_standard_deviation),
        ];
        let [e, d, r] = found.map(shown);
        println!("| {name} | {:.1e} | {e} | {d} | {r} |", fit.condition_number);
        for (found, floor) in found.into_iter().zip([estimates, deviations, residual]) {
            assert!(found.is_none_or(|f| f >= floor), "{name}: {found:?} digits, at least {floor} expected");
        }
    }
}

/// Where the certified residual is zero, ours is rounding beside the data.
#[test]
fn exact_fits_leave_nothing_but_rounding() {
    for set in SETS.iter().filter(|s| s.residual_standard_deviation == 0.0) {
        let fit = idim_ls(&regression(set), Divisor::default()).unwrap();
        let largest = set.y.iter().copied().fold(0.0, f64::max);
        let deviation = residual_deviation(set, &fit);
        assert!(deviation < 1e-13 * largest, "{}: {deviation:e}", set.name);
        assert!(fit.standard_deviation.iter().all(|sd| *sd < 1e-9), "{}: {:?}", set.name, fit.standard_deviation);
    }
}
