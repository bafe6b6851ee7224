//! Physically consistent parameters against cvxpy with Clarabel: `shared/reference/consistency`, made by the script there.
//! The regression has all standard parameters of a KUKA LWR4+.

use std::{path::PathBuf, time::Instant};

use libtest_mimic::{Failed, Trial};
use serde::Deserialize;
use thetahat::{
    Matrix, Robot,
    base_parameters::BaseParameters,
    consistency::{ConsistentFit, ConsistentSet, Known, LeastSquares, Prior, examine, fit},
    dynamics::Model,
    robot::Parameter,
};
use thetahat_ground::linear_algebra::{PivotedQr, norm};
use thetahat_model::consistency::{InteriorOptions, nearest_to_simulate};
use thetahat_testing::{Named, data, ensure, shared};

/// Clarabel was asked for gaps of 1e-11.
const TOLERANCE: f64 = 1e-6;

/// Rounding of an eigenvalue relative to the largest of its matrix.
const EIGENVALUE_ROUNDING: f64 = 1e-14;

#[derive(Deserialize)]
struct Golden {
    rest_of_squares: f64,
    ls_cost: f64,
    gamma: f64,
    urdf: Vec<f64>,
    lmi: Run,
    euclid: Run,
    logdet: Run,
}

#[derive(Deserialize)]
struct Run {
    data_cost: f64,
    objective: f64,
    theta: Vec<f64>,
}

/// The reference's order of the ten inertial parameters, by our names.
const ORDER: [&str; 10] = ["m", "mx", "my", "mz", "xx", "xy", "yy", "xz", "yz", "zz"];

struct Case {
    golden: Golden,
    set: ConsistentSet,
    data: LeastSquares,
    /// Our place of each of the reference's parameters.
    places: Vec<usize>,
}

fn folder() -> PathBuf {
    shared().join("reference/consistency")
}

fn numbers(name: &str) -> Result<Vec<Vec<f64>>, Failed> {
    let text = std::fs::read_to_string(folder().join(name))?;
    let line = |line: &str| line.split(',').map(|v| v.trim().parse::<f64>()).collect::<Result<Vec<_>, _>>();
    Ok(text.lines().map(line).collect::<Result<_, _>>()?)
}

impl Case {
    fn read() -> Result<Self, Failed> {
        let golden: Golden = serde_json::from_str(&std::fs::read_to_string(folder().join("kuka_consistency.json"))?)?;
        let robot = Robot::read(&data().join("kuka_lwr4/kuka_lwr4.urdf"))?;
        let table = robot.parameter_table();
        let names: Vec<String> = table.iter().map(Parameter::name).collect();
        let inertial = (1..=7).flat_map(|k| ORDER.iter().map(move |q| format!("{q}{k}")));
        let joints = ["fv", "fc", "off"].iter().flat_map(|q| (1..=7).map(move |k| format!("{q}{k}")));
        let place = |name: String| names.iter().position(|n| *n == name).ok_or("a parameter of another name");
        let places: Vec<usize> = inertial.chain(joints).map(place).collect::<Result<_, _>>()?;
        let (r, z) = (numbers("kuka_R.csv")?, numbers("kuka_z.csv")?);
        let mut matrix = Matrix::zeros(r.len(), names.len());
        for (column, &place) in places.iter().enumerate() {
            (0..r.len()).for_each(|row| *matrix.at_mut(row, place) = r[row][column]);
        }
        let mut a_priori = vec![0.0; names.len()];
        golden.urdf.iter().zip(&places).for_each(|(v, &place)| a_priori[place] = *v);
        let mut set = ConsistentSet::new(&robot, &a_priori)?;
        for k in 1..=7 {
            set = set.with_known(&Known::Value { parameter: format!("ia{k}"), value: 0.0 })?;
        }
        let data = LeastSquares::in_standard(matrix, z.concat()).with_residual_squares(golden.rest_of_squares);
        Ok(Self { golden, set, data, places })
    }

    fn fit(&self, prior: Prior) -> Result<ConsistentFit, Failed> {
        let start = Instant::now();
        let fit = fit(&self.set, &self.data, prior, None)?;
        let elapsed = start.elapsed().as_secs_f64() * 1e3;
        let relative = |values: Vec<f64>| values[0] / values[3];
        let smallest = self.set.pseudo_inertias(&fit.standard).into_iter().map(|p| relative(p.eigenvalues()));
        let smallest = smallest.fold(f64::INFINITY, f64::min);
        let ConsistentFit { squared_residual, objective, gap, iterations, .. } = &fit;
        eprintln!(
            "{prior:?}: {squared_residual:.8} {objective:.8} gap {gap:.1e} {iterations} iterations {elapsed:.1} ms"
        );
        ensure(fit.converged, format!("not converged: gap {:e}", fit.gap))?;
        ensure(smallest > -EIGENVALUE_ROUNDING, format!("not consistent: {smallest:e} of the largest eigenvalue"))?;
        Ok(fit)
    }
}

fn ensure_near(value: f64, expected: f64, what: &str) -> Result<(), Failed> {
    ensure((value - expected).abs() <= TOLERANCE * expected, format!("{what}: {value} against {expected}"))
}

fn constrained() -> Result<(), Failed> {
    let case = Case::read()?;
    let fit = case.fit(Prior::None)?;
    ensure(fit.squared_residual > case.golden.ls_cost, "below the unconstrained residual")?;
    ensure_near(fit.squared_residual, case.golden.lmi.data_cost, "squared residual")
}

fn euclidean() -> Result<(), Failed> {
    let case = Case::read()?;
    let fit = case.fit(Prior::Euclidean { weight: case.golden.gamma })?;
    ensure_near(fit.squared_residual, case.golden.euclid.data_cost, "squared residual")?;
    ensure_near(fit.objective, case.golden.euclid.objective, "objective")
}

fn log_det() -> Result<(), Failed> {
    let case = Case::read()?;
    let fit = case.fit(Prior::LogDet { weight: case.golden.gamma })?;
    ensure_near(fit.squared_residual, case.golden.logdet.data_cost, "squared residual")?;
    ensure_near(fit.objective, case.golden.logdet.objective, "objective")?;
    for (&place, expected) in case.places.iter().zip(&case.golden.logdet.theta) {
        let name = case.set.parameter_table().get(place).name();
        let value = fit.standard[place];
        ensure((value - expected).abs() <= 1e-4 * expected.abs().max(1e-2), format!("{name}: {value} {expected}"))?;
    }
    Ok(())
}

/// The record in base parameters: motor inertias are not among them, as the reference has none.
struct InBase {
    base: BaseParameters,
    r: Matrix,
    estimate: Vec<f64>,
}

impl InBase {
    fn of(case: &Case) -> Result<Self, Failed> {
        let model = Model::new(&Robot::read(&data().join("kuka_lwr4/kuka_lwr4.urdf"))?);
        let without: Vec<String> = (1..=7).map(|k| format!("ia{k}")).collect();
        let base = BaseParameters::of(&model, &without)?;
        let unit = |place: usize| (0..case.set.a_priori().len()).map(|i| if i == place { 1.0 } else { 0.0 }).collect();
        let zero = case.data.residual(&vec![0.0; case.set.a_priori().len()]);
        let column = |place: usize| -> Vec<f64> {
            let with: Vec<f64> = unit(place);
            case.data.residual(&with).iter().zip(&zero).map(|(a, b)| a - b).collect()
        };
        let columns: Vec<Vec<f64>> = base.columns().into_iter().map(column).collect();
        let x = Matrix::from_fn(zero.len(), columns.len(), |i, j| columns[j][i]);
        let z: Vec<f64> = zero.iter().map(|v| -v).collect();
        let estimate = PivotedQr::with_equal_columns(&x).solve(&z);
        Ok(Self { base, r: x.triangular_factor(), estimate })
    }
}

/// From the estimate in base parameters it is as far to the set as in standard parameters.
fn nearest() -> Result<(), Failed> {
    let case = Case::read()?;
    let InBase { base, r, estimate } = InBase::of(&case)?;
    let data = LeastSquares::nearest(&r, &estimate, &base, case.set.a_priori().len())?;
    let fit = fit(&case.set, &data.with_residual_squares(case.golden.ls_cost), Prior::None, None)?;
    ensure_near(fit.squared_residual, case.golden.lmi.data_cost, "squared residual")
}

fn simulated() -> Result<(), Failed> {
    let case = Case::read()?;
    let InBase { base, r, estimate } = InBase::of(&case)?;
    let (options, mut before) = (InteriorOptions::default(), None);
    for _ in 0..3 {
        let start = Instant::now();
        let fit = nearest_to_simulate(&case.set, &base, &r, &estimate, &options, before.as_ref())?;
        let elapsed = start.elapsed().as_secs_f64() * 1e3;
        let moved = fit.squared_residual.sqrt() / norm(&r.times(&estimate));
        eprintln!(
            "to simulate: {} iterations {elapsed:.1} ms, moved by {:.3} % of |R theta|",
            fit.iterations,
            100.0 * moved
        );
        ensure(fit.converged && moved < 0.02, format!("moved by {moved}"))?;
        before = Some(fit);
    }
    Ok(())
}

fn examined() -> Result<(), Failed> {
    let case = Case::read()?;
    let InBase { base, estimate, .. } = InBase::of(&case)?;
    let start = Instant::now();
    let found = examine(&case.set, &base, &estimate)?;
    let names: Vec<String> = found.outside.iter().map(|(condition, lack)| format!("{condition} ({lack:.3})")).collect();
    eprintln!(
        "margin {:.4}, outside: {} ({:.1} ms)",
        found.margin,
        names.join(", "),
        start.elapsed().as_secs_f64() * 1e3
    );
    ensure(!found.consistent && !found.outside.is_empty(), "the estimate is not consistent")
}

/// The trials of this module.
pub fn all_trials() -> Vec<Trial> {
    let tests: Vec<Named> = vec![
        ("constrained", constrained),
        ("euclidean", euclidean),
        ("log_det", log_det),
        ("nearest", nearest),
        ("simulated", simulated),
        ("examined", examined),
    ];
    thetahat_testing::trials_on_shared_data(&["reference/consistency", "datasets/kuka_lwr4"], tests)
}
