//! Closed forms and optimality conditions, without recorded data.

use std::path::Path;

use super::*;
use crate::{
    base_parameters::BaseParameters,
    dynamics::{DynamicParameters, Model, Sign, State, Workspace},
    regressor::Regressor,
    robot::Robot,
};
use thetahat_ground::linear_algebra::{Matrix, PivotedQr};

const TX40: &str = include_str!("../../../thetahat/demo/tx40.toml");

/// The content of `robots/two_joint.toml`, which lies outside the package.
const TWO_JOINT: &str = r#"
name = "two-joint arm"
friction = "symmetric"
[[joint]]
name = "shoulder"
kind = "revolute"
alpha_deg = 90
[[joint]]
name = "elbow"
parent = "shoulder"
kind = "revolute"
a_m = 0.4
[transmission]
matrix = [[50, 0], [0, 50]]
[parameters]
m1 = 4
mx1 = 0.8
yy1 = 0.24
zz1 = 0.24
xx1 = 0.02
ia1 = 0.3
fv1 = 2
fc1 = 0.8
m2 = 2
mx2 = 0.3
yy2 = 0.07
zz2 = 0.07
xx2 = 0.01
ia2 = 0.1
fv2 = 1
fc2 = 0.4
"#;

const ONE_JOINT: &str = r#"
name = "one joint"
friction = "symmetric"
[[joint]]
name = "hinge"
kind = "revolute"
[transmission]
matrix = [[1]]
[parameters]
m1 = 2.0
xx1 = 0.3
yy1 = 0.4
zz1 = 0.35
ia1 = 0.1
"#;

fn robot(text: &str) -> Robot {
    Robot::parse(text, Path::new("robot.toml")).unwrap()
}

fn set_of(robot: &Robot) -> ConsistentSet {
    ConsistentSet::new(robot, &completed_a_priori(robot, None)).unwrap()
}

/// A square, well-conditioned matrix without structure.
fn mixing(n: usize) -> Matrix {
    Matrix::from_fn(n, n, |i, j| (1.3 * i as f64 + 2.7 * j as f64).sin() + if i == j { 4.0 } else { 0.0 })
}

/// `|P(theta) - P(target)|_F^2` for the ten inertial parameters, `(theta - target)^2` for the others.
fn frobenius(set: &ConsistentSet, target: &[f64]) -> LeastSquares {
    let n = target.len();
    let row = |theta: &[f64]| -> Vec<f64> {
        let p = &set.pseudo_inertias(theta)[0];
        let root = 2f64.sqrt();
        let entries = (0..4).flat_map(|i| (0..=i).map(move |j| (i, j)));
        let entries = entries.map(|(i, j)| p.at(i, j) * if i == j { 1.0 } else { root });
        entries.chain(theta[10..].iter().copied()).collect()
    };
    let columns: Vec<Vec<f64>> =
        (0..n).map(|v| row(&(0..n).map(|i| if i == v { 1.0 } else { 0.0 }).collect::<Vec<_>>())).collect();
    LeastSquares::in_standard(Matrix::from_fn(n, n, |i, j| columns[j][i]), row(target))
}

fn worst(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn the_nearest_matrix_of_one_link_has_its_negative_eigenvalues_cut_off() {
    let set = set_of(&robot(ONE_JOINT));
    let target = [0.1, 0.05, -0.1, 0.5, 0.02, 0.2, 0.7, -0.3, 0.4, 1.0, -0.2, 0.3, -0.1, 0.05];
    let found = fit(&set, &frobenius(&set, &target), Prior::None, None).unwrap();
    let p = &set.pseudo_inertias(&target)[0];
    let negative: f64 = p.eigenvalues().iter().filter(|v| **v < 0.0).map(|v| v * v).sum();
    assert!(found.converged && negative > 0.01);
    assert!((found.squared_residual - (negative + 0.2 * 0.2 + 0.1 * 0.1)).abs() < 1e-8 * found.squared_residual);
    let eigenvalues = set.pseudo_inertias(&found.standard)[0].eigenvalues();
    let cut: Vec<f64> = p.eigenvalues().iter().map(|v| v.max(0.0)).collect();
    let mut same = eigenvalues.clone();
    same.iter_mut().for_each(|v| *v = v.max(0.0));
    assert!(worst(&same, &cut) < 1e-4, "{eigenvalues:?} {cut:?}");
    assert!(worst(&found.standard[10..], &[0.0, 0.3, 0.0, 0.05]) < 1e-6);
}

#[test]
fn a_consistent_vector_is_its_own_projection() {
    for text in [TWO_JOINT, TX40] {
        let robot = robot(text);
        let set = set_of(&robot);
        let target: Vec<f64> = super::fit::starting_point(&set).iter().map(|v| 1.1 * v).collect();
        let matrix = mixing(target.len());
        let data = LeastSquares::in_standard(matrix.clone(), matrix.times(&target));
        let found = fit(&set, &data, Prior::None, None).unwrap();
        assert!(found.converged);
        assert!(worst(&found.standard, &target) < 1e-8, "{:e}", worst(&found.standard, &target));
    }
}

#[test]
fn the_multipliers_balance_the_residual_and_vanish_on_what_is_free() {
    let robot = robot(TWO_JOINT);
    let set = set_of(&robot).with_interior(0.2).unwrap();
    let n = set.a_priori().len();
    let target: Vec<f64> = (0..n).map(|i| (2.9 * i as f64).sin()).collect();
    let matrix = mixing(n);
    let data = LeastSquares::in_standard(matrix.clone(), matrix.times(&target));
    let found = fit(&set, &data, Prior::None, None).unwrap();
    let mut slope: Vec<f64> = matrix.transpose_times(&data.residual(&found.standard)).iter().map(|v| 2.0 * v).collect();
    let size = slope.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
    for (condition, (name, multiplier)) in set.conditions().iter().zip(&found.multipliers) {
        assert_eq!(condition.condition, *name);
        let s = condition.block.value(&found.standard);
        assert!(s.smallest_eigenvalue() > 0.0 && multiplier.smallest_eigenvalue() > 0.0);
        assert!(s.inner(multiplier) < 1e-8 * found.objective);
        condition.block.add_adjoint(multiplier, -1.0, &mut slope);
    }
    assert!(size > 1.0 && worst(&slope, &vec![0.0; n]) < 1e-6 * size, "{:e}", worst(&slope, &vec![0.0; n]));
    let margin = |(p, p0): (&Symmetric, &Symmetric)| p.plus(p0, -0.2).smallest_eigenvalue();
    let pairs = set.pseudo_inertias(&found.standard);
    assert!(pairs.iter().zip(&set.pseudo_inertias(set.a_priori())).map(margin).all(|m| m > 0.0));
}

#[test]
fn a_fit_is_the_same_from_any_start_and_in_any_scale() {
    let set = set_of(&robot(TX40));
    let n = set.a_priori().len();
    let matrix = mixing(n).scale_columns(&set.scale().iter().map(|s| 1.0 / s).collect::<Vec<_>>());
    let target: Vec<f64> = (0..n).map(|i| (1.7 * i as f64).cos()).collect();
    let fits: Vec<ConsistentFit> = [1.0, 1e5]
        .iter()
        .map(|factor| {
            let a = matrix.scale_columns(&vec![*factor; n]);
            let b: Vec<f64> = target.iter().map(|v| factor * v).collect();
            fit(&set, &LeastSquares::in_standard(a, b), Prior::None, Some(&target)).unwrap()
        })
        .collect();
    let again = LeastSquares::in_standard(matrix, target);
    let plain = fit(&set, &again, Prior::None, None).unwrap();
    assert!(fits.iter().all(|f| f.converged) && plain.converged);
    assert!((fits[0].objective - plain.objective).abs() < 1e-9 * plain.objective);
    assert!((fits[1].objective * 1e-10 - plain.objective).abs() < 1e-9 * plain.objective);
    assert_eq!(fit(&set, &again, Prior::None, None).unwrap(), plain);
}

#[test]
fn a_large_weight_leads_back_to_the_a_priori_parameters() {
    let set = set_of(&robot(TWO_JOINT));
    let n = set.a_priori().len();
    let data = LeastSquares::in_standard(mixing(n), vec![1.0; n]);
    for prior in [Prior::LogDet { weight: 1e9 }, Prior::Euclidean { weight: 1e12 }] {
        let found = fit(&set, &data, prior, None).unwrap();
        let inertial = |theta: &[f64]| [theta[..10].to_vec(), theta[14..24].to_vec()].concat();
        let off = worst(&inertial(&found.standard), &inertial(set.a_priori()));
        assert!(found.converged && off < 1e-3, "{prior:?}: {off:e}");
    }
}

#[test]
fn known_values_hold() {
    let known = [
        Known::Value { parameter: "m2".to_owned(), value: 1.5 },
        Known::TotalMass { lower: 5.0, upper: 5.0 },
        Known::CentreOfMass { link: 1, lower: [0.1, -0.05, -0.02], upper: [0.2, 0.05, 0.02] },
        Known::MirrorPlane { link: 2, normal: 2 },
        Known::Range { parameter: "fv1".to_owned(), lower: 1.0, upper: 2.0 },
    ];
    let mut set = set_of(&robot(TWO_JOINT));
    for one in &known {
        set = set.with_known(one).unwrap();
    }
    let table = set.parameter_table().clone();
    let n = table.len();
    let data = LeastSquares::in_standard(mixing(n), (0..n).map(|i| 5.0 * (i as f64).sin()).collect());
    let found = fit(&set, &data, Prior::None, None).unwrap();
    let value = |name| found.standard[table.index_of(name).unwrap()];
    assert!(found.converged);
    assert_eq!((value("m2"), value("mz2"), value("xz2"), value("yz2")), (1.5, 0.0, 0.0, 0.0));
    assert!((value("m1") - 3.5).abs() < 1e-14);
    assert!(value("mx1") > 0.1 * value("m1") && value("mx1") < 0.2 * value("m1"));
    assert!(value("mz1").abs() < 0.02 * value("m1") && (1.0..2.0).contains(&value("fv1")));
}

#[test]
fn contradictions_are_errors_that_name_them() {
    let set = set_of(&robot(TWO_JOINT));
    let data = LeastSquares::in_standard(mixing(28), vec![1.0; 28]);
    let value = |parameter: &str, value| Known::Value { parameter: parameter.to_owned(), value };
    let fitted = |known: &[Known]| {
        let set = known.iter().try_fold(set.clone(), |set, known| set.with_known(known)).unwrap();
        fit(&set, &data, Prior::None, None).unwrap_err()
    };
    let sum = fitted(&[value("m1", 1.0), value("m2", 1.0), Known::TotalMass { lower: 3.0, upper: 3.0 }]);
    assert!(matches!(&sum, ConsistencyError::ContradictoryValues { .. }), "{sum}");
    for bad in [value("m2", -0.5), value("zz2", -0.01), value("m2", 0.0)] {
        let error = fitted(std::slice::from_ref(&bad));
        let named = matches!(&error, ConsistencyError::NoInterior { conflicting, .. } if *conflicting == ["link 2"]);
        assert!(named, "{bad:?}: {error}");
    }
    let friction = fitted(&[value("fc1", -0.5)]);
    assert!(matches!(&friction, ConsistencyError::NoInterior { conflicting, .. } if *conflicting == ["fc1"]));
    let unknown = set.clone().with_known(&value("zz9", 1.0)).unwrap_err();
    assert_eq!(unknown, ConsistencyError::UnknownParameter { name: "zz9".to_owned() });
    let link = set.clone().with_known(&Known::MirrorPlane { link: 0, normal: 1 }).unwrap_err();
    assert_eq!(link, ConsistencyError::UnknownLink { number: 0, links: 2 });
    let range = Known::Range { parameter: "m1".to_owned(), lower: 2.0, upper: f64::NAN };
    assert!(matches!(set.with_known(&range), Err(ConsistencyError::BadValue { .. })));
}

#[test]
fn sizes_and_values_of_the_regression_are_checked() {
    let set = set_of(&robot(TWO_JOINT));
    let fitted = |data: LeastSquares| fit(&set, &data, Prior::None, None).unwrap_err();
    let narrow = fitted(LeastSquares::in_standard(mixing(27), vec![1.0; 27]));
    assert!(matches!(narrow, ConsistencyError::WrongSize { expected: 28, found: 27, .. }));
    let short = fitted(LeastSquares::in_standard(mixing(28), vec![1.0; 27]));
    assert!(matches!(short, ConsistencyError::WrongSize { what: "the right side", .. }));
    assert_eq!(fitted(LeastSquares::in_standard(mixing(28), vec![f64::NAN; 28])), ConsistencyError::NotFinite);
}

fn base_of(robot: &Robot) -> BaseParameters {
    BaseParameters::of(&Model::new(robot), &[]).unwrap()
}

#[test]
fn consistent_base_parameters_pass_the_examination() {
    for text in [ONE_JOINT, TWO_JOINT, TX40] {
        let robot = robot(text);
        let (set, base) = (set_of(&robot), base_of(&robot));
        let theta = super::fit::starting_point(&set);
        let found = examine(&set, &base, &base.from_standard(&theta)).unwrap();
        assert!(found.consistent && found.outside.is_empty() && found.margin > 0.3, "{found:?}");
        assert!(worst(&base.from_standard(&found.standard), &base.from_standard(&theta)) < 1e-12);
        assert!(found.deviations(&Matrix::identity(base.len())).is_none());
    }
}

#[test]
fn what_is_outside_is_named() {
    let robot = robot(TWO_JOINT);
    let (set, base) = (set_of(&robot), base_of(&robot));
    let table = set.parameter_table();
    let mut theta = set.a_priori().to_vec();
    theta[table.index_of("fc1").unwrap()] = -0.4;
    theta[table.index_of("zz2").unwrap()] = -0.05;
    let estimate = base.from_standard(&theta);
    let found = examine(&set, &base, &estimate).unwrap();
    let names: Vec<String> = found.outside.iter().map(|(condition, _)| condition.to_string()).collect();
    assert!(
        !found.consistent && names.contains(&"fc1".to_owned()) && names.contains(&"link 2".to_owned()),
        "{names:?}"
    );
    assert_eq!(names.len(), 2);
}

#[test]
fn the_combination_is_the_slope_of_the_margin() {
    let robot = robot(TWO_JOINT);
    let light = Known::TotalMass { lower: 0.0, upper: 20.0 };
    let (set, base) = (set_of(&robot).with_known(&light).unwrap(), base_of(&robot));
    let mut theta = set.a_priori().to_vec();
    theta[set.parameter_table().index_of("zz2").unwrap()] = -0.05;
    let estimate = base.from_standard(&theta);
    let found = examine(&set, &base, &estimate).unwrap();
    for i in 0..base.len() {
        let margin_with = |step: f64| {
            let mut moved = estimate.clone();
            moved[i] += step;
            examine(&set, &base, &moved).unwrap().margin
        };
        let (below, above, slope) = (margin_with(-1e-3), margin_with(1e-3), found.combination[i]);
        let name = &base.parameters()[i].name;
        assert!(above <= found.margin + 1e-3 * slope + 1e-7, "{name}: {above} {slope} {}", found.margin);
        assert!(below <= found.margin - 1e-3 * slope + 1e-7, "{name}: {below} {slope} {}", found.margin);
        let change = (above - below) / 2e-3;
        assert!((change - slope).abs() < 1e-2 * (1.0 + change.abs()), "{name}: {change} {slope} {below} {above}");
    }
    let variance: f64 = found.combination.iter().map(|c| c * c).sum();
    let expected = -found.margin / variance.sqrt();
    assert!((found.deviations(&Matrix::identity(base.len())).unwrap() - expected).abs() < 1e-12);
}

#[test]
fn parameters_to_simulate_keep_their_margin_and_start_from_those_before() {
    let robot = robot(TX40);
    let (set, base) = (set_of(&robot), base_of(&robot));
    let estimate: Vec<f64> =
        base.from_standard(set.a_priori()).iter().enumerate().map(|(i, v)| v + 0.05 * (i as f64).sin()).collect();
    let r = mixing(base.len());
    let options = InteriorOptions::default();
    let cold = nearest_to_simulate(&set, &base, &r, &estimate, &options, None).unwrap();
    let warm = nearest_to_simulate(&set, &base, &r, &estimate, &options, Some(&cold)).unwrap();
    assert!(cold.converged && warm.converged);
    assert!((warm.objective - cold.objective).abs() < 1e-9 * cold.objective);
    let least = |(p, p0): (&Symmetric, &Symmetric)| p.plus(p0, -0.3).smallest_eigenvalue();
    let pairs = set.pseudo_inertias(&cold.standard);
    assert!(pairs.iter().zip(&set.pseudo_inertias(set.a_priori())).map(least).all(|m| m > 0.0));
    let bad = InteriorOptions { interior: 1.0, ..options };
    let error = nearest_to_simulate(&set, &base, &r, &estimate, &bad, None).unwrap_err();
    assert!(matches!(error, ConsistencyError::BadValue { .. }));
}

#[test]
fn guessed_links_are_bodies_with_the_total_mass() {
    let mut robot = robot(TX40);
    robot.a_priori.clear();
    let theta = completed_a_priori(&robot, Some(25.0));
    let set = ConsistentSet::new(&robot, &theta).unwrap();
    let masses: Vec<f64> = set.pseudo_inertias(&theta).iter().map(|p| p.at(3, 3)).collect();
    assert!((masses.iter().sum::<f64>() - 25.0).abs() < 1e-12);
    assert!(masses.windows(2).all(|pair| pair[0] >= pair[1]), "{masses:?}");
}

#[test]
fn a_link_of_no_body_keeps_its_mass_and_centre() {
    let mut robot = robot(TWO_JOINT);
    robot.a_priori.insert("zz2".to_owned(), 0.0);
    let table = robot.parameter_table();
    let theta = completed_a_priori(&robot, None);
    let value = |name: &str| theta[table.index_of(name).unwrap()];
    assert_eq!((value("m2"), value("mx2"), value("m1"), value("zz1")), (2.0, 0.3, 4.0, 0.24));
    assert!(ConsistentSet::new(&robot, &theta).is_ok());
    let refused = ConsistentSet::new(&robot, &robot.a_priori_parameters()).unwrap_err();
    assert!(matches!(refused, ConsistencyError::APrioriNotDefinite { link: 2, .. }));
}

#[test]
fn the_mass_factor_finds_the_size_of_the_torques() {
    let robot = robot(TWO_JOINT);
    let table = robot.parameter_table();
    let theta = completed_a_priori(&robot, None);
    let twice: Vec<f64> = theta.iter().enumerate().map(|(i, v)| if i % 14 < 10 { 2.0 * v } else { 7.0 }).collect();
    let matrix = mixing(theta.len());
    let data = LeastSquares::in_standard(matrix.clone(), matrix.times(&twice));
    assert!((mass_factor(&data, &table, &theta).unwrap() - 2.0).abs() < 1e-10);
    let negative = matrix.times(&twice.iter().map(|v| -v).collect::<Vec<_>>());
    assert!(mass_factor(&LeastSquares::in_standard(matrix, negative), &table, &theta).is_none());
}

/// Seven revolute joints about x, y and z in turn, with inertias and no motor inertias.
fn seven_axes() -> String {
    let mut text = "<robot name='seven'><link name='l0'/>".to_owned();
    for k in 1..=7 {
        let (size, axis) = (1.0 / f64::from(k), ["0 0 1", "0 1 0", "1 0 0"][k as usize % 3]);
        let (mass, moment) = (4.0 * size, 0.05 * size * size);
        text += &format!(
            "<link name='l{k}'><inertial><origin xyz='0 0.02 0.1'/><mass value='{mass}'/><inertia ixx='{moment}' iyy='{moment}' \
             izz='{moment}' ixy='0' ixz='0' iyz='0'/></inertial></link><joint name='j{k}' type='revolute'><parent link='l{}'/>\
             <child link='l{k}'/><origin xyz='0 0 0.25'/><axis xyz='{axis}'/><limit lower='-2' upper='2' effort='100' \
             velocity='3'/></joint>",
            k - 1
        );
    }
    text + "</robot>"
}

/// X of a slow motion in base parameters, whose accelerations are small relative to this noise, and the LS estimate.
fn noisy_estimate(robot: &Robot, set: &ConsistentSet, noise: f64) -> (BaseParameters, Matrix, Vec<f64>) {
    let (model, base) = (Model::new(robot), base_of(robot));
    let (columns, n, rows) = (base.columns(), model.coordinate_count(), 60);
    let regressor = Regressor::new(&model, &columns);
    let mut workspace = Workspace::new(&model);
    let mut phi = vec![0.0; regressor.entries().len()];
    let mut x = Matrix::zeros(rows * n, columns.len());
    for k in 0..rows {
        let wave = |rate: f64, j: usize| (rate * k as f64 * (1.0 + 0.37 * j as f64) + j as f64).sin();
        let [q, dq, ddq] =
            [0.31, 0.53, 0.71].map(|rate: f64| (0..n).map(|j| 2.0 * wave(rate, j)).collect::<Vec<f64>>());
        regressor.evaluate(&model, State::new(&q, &dq), &ddq, Sign::Exact, &mut workspace, &mut phi);
        for (entry, value) in regressor.entries().iter().zip(&phi) {
            *x.at_mut(k * n + entry.joint, entry.column) = *value;
        }
    }
    let y = x.times(&base.from_standard(&super::fit::starting_point(set)));
    let error = |i: usize| noise * ((12.9898 * i as f64).sin() * 43758.5453).fract();
    let y: Vec<f64> = y.iter().enumerate().map(|(i, y)| y + error(i)).collect();
    let estimate = PivotedQr::with_equal_columns(&x).solve(&y);
    (base, x.triangular_factor(), estimate)
}

/// For a physically impossible estimate, the parameters to simulate have a definite mass matrix in every configuration, and no
/// other interior point is nearer.
fn assert_simulatable(robot: &Robot, noise: f64) {
    let set = set_of(robot);
    let (base, r, estimate) = noisy_estimate(robot, &set, noise);
    assert!(!examine(&set, &base, &estimate).unwrap().consistent);
    let options = InteriorOptions::default();
    let found = nearest_to_simulate(&set, &base, &r, &estimate, &options, None).unwrap();
    assert!(found.converged);
    let model = Model::new(robot);
    let n = model.coordinate_count();
    let parameters = DynamicParameters::sorted(&model, &found.standard);
    let (mut workspace, mut m) = (Workspace::new(&model), vec![0.0; n * n]);
    for k in 0..50 {
        let q: Vec<f64> = (0..n).map(|j| 3.0 * (1.9 * k as f64 + 0.7 * j as f64).sin()).collect();
        model.mass_matrix(&parameters, &q, &mut workspace, &mut m);
        let matrix = Matrix::from_fn(n, n, |i, j| m[i * n + j]);
        assert!(matrix.cholesky().is_some(), "at {q:?}");
    }
    // Half way to the a-priori parameters is inside as well, and farther from the estimate.
    let data = LeastSquares::nearest(&r, &estimate, &base, set.a_priori().len()).unwrap();
    let squares = |theta: &[f64]| data.residual(theta).iter().map(|e| e * e).sum::<f64>();
    let start = super::fit::starting_point(&set);
    let between: Vec<f64> = found.standard.iter().zip(&start).map(|(a, b)| 0.5 * (a + b)).collect();
    assert!(squares(&found.standard) < squares(&between), "{} {}", squares(&found.standard), squares(&between));
}

#[test]
fn the_noisy_estimate_of_a_two_joint_robot_can_be_simulated_once_projected() {
    assert_simulatable(&robot(TWO_JOINT), 20.0);
}

#[test]
fn the_noisy_estimate_of_a_seven_axis_urdf_can_be_simulated_once_projected() {
    let robot = Robot::parse(&seven_axes(), Path::new("seven.urdf")).unwrap();
    assert_eq!(robot.coordinate_count(), 7);
    assert_simulatable(&robot, 2.0);
}

#[test]
fn conditions_take_effective_parameters_from_the_data() {
    let robot = robot(TWO_JOINT);
    let set = set_of(&robot);
    let n = set.a_priori().len();
    let theta = super::fit::starting_point(&set);
    let inside = LeastSquares::in_standard(mixing(n), mixing(n).times(&theta));
    let free = fit(&set, &inside, Prior::None, None).unwrap().effective_parameters;
    assert!((free - n as f64).abs() < 1e-6, "{free}");
    // Friction below zero ends at zero, which leaves one parameter less; with a strong prior the data determine none of the
    // inertias.
    let mut outside = theta.clone();
    outside[set.parameter_table().index_of("fv1").unwrap()] = -3.0;
    let identity = LeastSquares::in_standard(Matrix::identity(n), outside);
    let one_less = fit(&set, &identity, Prior::None, None).unwrap().effective_parameters;
    assert!((one_less - (n as f64 - 1.0)).abs() < 1e-3, "{one_less}");
    let drawn = fit(&set, &inside, Prior::LogDet { weight: 1e9 }, None).unwrap().effective_parameters;
    assert!((drawn - (n as f64 - 22.0)).abs() < 1e-2, "{drawn}");
}

/// One revolute joint with a body, and the places of its viscous friction and offset.
fn believed_joint() -> (ConsistentSet, BaseParameters, [usize; 2]) {
    let text = "name = 'r'\n[[joint]]\nname = 'a'\nkind = 'revolute'\nalpha_deg = 90\n";
    let robot = Robot::parse(text, Path::new("r.toml")).unwrap();
    let set = ConsistentSet::new(&robot, &completed_a_priori(&robot, None)).unwrap();
    let base = BaseParameters::of(&Model::new(&robot), &[]).unwrap();
    let places = ["fv1", "off1"].map(|name| set.parameter_table().index_of(name).unwrap());
    let mut sizes = vec![0.0; set.parameter_table().len()];
    places.iter().zip([2.0, 3.0]).for_each(|(i, size)| sizes[*i] = size);
    (set.with_beliefs(Beliefs { sizes, link_parts: vec![1.0] }).unwrap(), base, places)
}

/// Two motors turn with the same two joints, of which one is light: what is believed of them is in the set.
#[test]
fn beliefs_of_coupled_motors_are_in_the_set() {
    let text = TWO_JOINT.replace("[[50, 0], [0, 50]]", "[[1, 1], [-1, 1]]");
    let robot = Robot::parse(&text, Path::new("r.toml")).unwrap();
    let set = ConsistentSet::new(&robot, &completed_a_priori(&robot, None)).unwrap();
    let size = |name: String| match name.as_str() {
        "ia1" | "fv1" | "fc1" => 1.0,
        "ia2" | "fv2" | "fc2" => 1e-4,
        "iam1" | "fvm1" | "fcm1" => 0.5,
        "iam2" | "fvm2" | "fcm2" => 0.01,
        _ => 0.0,
    };
    let sizes = set.parameter_table().iter().map(|p| size(p.name())).collect();
    let set = set.with_beliefs(Beliefs { sizes, link_parts: vec![1.0; 2] }).unwrap();
    let believed = set.believed();
    let of = |name: &str| believed[set.parameter_table().index_of(name).unwrap()];
    // The cross term of the two is the difference of the motors.
    assert!((of("iam1") - of("iam2")).powi(2) < of("ia1") * of("ia2") && of("iam1") > 0.0, "{believed:?}");
    let coupled = set.margins(&believed).into_iter().filter(|(c, _)| matches!(c, Condition::CoupledMotors(_)));
    assert!(coupled.clone().count() == 2 && coupled.clone().all(|(_, margin)| margin > 0.0));
}

/// `|a x - b|^2` for each of these parameters by itself.
fn rows_of(set: &ConsistentSet, places: [usize; 2], [a, b]: [f64; 2]) -> LeastSquares {
    let entry = |row: usize, column: usize| if column == places[row] { a } else { 0.0 };
    LeastSquares::in_standard(Matrix::from_fn(2, set.parameter_table().len(), entry), vec![b, b])
}

/// A number that cannot be negative is where `2 a (a s - b) + 1 / s_0 - 1 / s` is zero, one of either sign at
/// `a b / (a^2 + 1 / s_0^2)`, and a body of which the rows say nothing stays.
#[test]
fn a_belief_has_its_closed_form() {
    let (set, _, [fv, off]) = believed_joint();
    let (a, b) = (0.7, 1.9);
    for weight in [1.0, 25.0] {
        let found = fit(&set, &rows_of(&set, [fv, off], [a, b]), Prior::Belief { weight }, None).unwrap();
        let p = 1.0 / 2.0 - 2.0 * a * b;
        let expected = (-p + (p * p + 8.0 * a * a).sqrt()) / (4.0 * a * a);
        // A gap of 1e-10 of the objective leaves its root, over the root of the curvature.
        assert!((found.standard[fv] - expected).abs() < 1e-5, "{} {expected}", found.standard[fv]);
        let expected = a * b / (a * a + 1.0 / 9.0);
        assert!((found.standard[off] - expected).abs() < 1e-5, "{} {expected}", found.standard[off]);
        let body = (0..set.a_priori().len()).filter(|&i| set.parameter_table().get(i).quantity.is_inertial());
        body.for_each(|i| assert!((found.standard[i] - set.a_priori()[i]).abs() < 1e-5, "{i}"));
    }
}

/// Variances `2 s_0^2 / weight` and `s_0^2` by the belief, and one over the sum of informations with the rows.
#[test]
fn what_rows_add_to_a_belief_has_its_closed_form() {
    let (set, base, [fv, off]) = believed_joint();
    let a = 0.7;
    let knowledge = knowledge_of_base(&set, &rows_of(&set, [fv, off], [a, 1.9]), 1.0, &base).unwrap();
    for (kept, believed) in [(fv, 8.0), (off, 9.0)] {
        let i = base.parameters().iter().position(|p| p.kept == kept && p.regrouped.is_empty()).unwrap();
        assert!((knowledge.believed_variance[i] / believed - 1.0).abs() < 1e-9, "{}", knowledge.believed_variance[i]);
        let expected = 1.0 / (a * a + 1.0 / believed);
        assert!((knowledge.covariance.at(i, i) / expected - 1.0).abs() < 1e-9, "{}", knowledge.covariance.at(i, i));
        let percent = 100.0 * (1.0 - expected / believed);
        assert!((knowledge.decided_percent()[i] - percent).abs() < 1e-6);
    }
}
