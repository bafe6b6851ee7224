//! Torque terms in generated functions, and derivatives, compared with the library's kernels and central differences.

use std::path::Path;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::{
    tests::{Case, SETS, bodies, ensure_close, of_each_robot},
    *,
};
use thetahat_model::{
    dynamics::{DynamicParameters, Sign, State, Workspace},
    robot::Robot,
};
use thetahat_testing::ROBOT_WITH_TERMS;

/// User-defined expressions, in addition to every other kind of term.
const EXPRESSIONS: [&str; 8] = [
    "exp(0 - (dq/0.3)^2) * s + ddq1*cos(q3)^2",
    "tanh(dq/0.1) - atan(q)*sqrt(2 + q1^2)",
    "atan2(q, 1 + dq^2) + (q max 0.2) * (dq2 min 0.1)",
    "ln(3 + abs(q)) * log2(4 + dq^2) / log10(20 + q1^2) + cbrt(sin(q) - 3)",
    "sinh(q/3)*cosh(dq/3) + asinh(q) + acosh(2 + dq^2) + atanh(sin(q)/2)",
    "asin(sin(q)/2) - acos(cos(dq)/2) + tan(sin(q)/2) + 2^sin(dq) + (3 + abs(q))^sin(dq)",
    "floor(3*q) + ceil(2*dq) + round(4*q) - trunc(5*q)*fract(3*dq)",
    "PI",
];

/// The robot with every kind of term, and with expressions.
fn robot(expressions: &[&str]) -> Robot {
    let mut text = ROBOT_WITH_TERMS.to_owned();
    for (k, expression) in expressions.iter().enumerate() {
        text += &format!(
            "[[term]]\nkind = \"expression\"\nname = \"mine{k}\"\njoint = \"c\"\nexpression = \"{expression}\"\n"
        );
    }
    Robot::parse(&text, Path::new("all.toml")).unwrap()
}

fn cases(robot: &Robot) -> Vec<Case> {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    (0..20).map(|_| Case::new(robot.clone(), &mut rng)).collect()
}

#[test]
fn terms_have_the_torques_of_the_kernels() {
    for case in cases(&robot(&EXPRESSIONS)) {
        let [q, dq, ddq] = &case.state;
        let expected = case.inverse_dynamics(q, dq, ddq);
        for set in SETS {
            ensure_close(&case.evaluate(ModelKind::InverseDynamics, set), &expected, &format!("torques, {set:?}"));
            let (phi, theta) = (case.evaluate(ModelKind::Regressor, set), case.values(set));
            let row = |row: &[f64]| row.iter().zip(&theta).map(|(a, b)| a * b).sum::<f64>();
            ensure_close(&phi.chunks(theta.len()).map(row).collect::<Vec<_>>(), &expected, "phi theta");
        }
    }
}

#[test]
fn terms_have_the_columns_of_the_kernels() {
    for case in cases(&robot(&EXPRESSIONS)) {
        let (found, expected) = (case.evaluate(ModelKind::Regressor, ParameterSet::Standard), case.kernel_regressor());
        let columns = case.theta.len();
        for (found, expected) in found.chunks(columns).zip(expected.chunks(columns)) {
            ensure_close(found, expected, "columns");
        }
    }
}

#[test]
fn forward_dynamics_with_terms_reverses_inverse_dynamics() {
    for case in cases(&robot(&[])) {
        let ([q, dq, ddq], theta) = (&case.state, bodies(&case.model));
        let parameters = DynamicParameters::sorted(&case.model, &theta);
        let mut tau = vec![0.0; q.len()];
        let mut workspace = Workspace::new(&case.model);
        case.model.inverse_dynamics(&parameters, State::new(q, dq), ddq, Sign::Exact, &mut workspace, &mut tau);
        let program = case.function(ModelKind::ForwardDynamics, ParameterSet::Standard).program;
        ensure_close(&program.evaluate(&Inputs { q, dq, tau: &tau, theta: &theta, ..Inputs::default() }), ddq, "ddm");
    }
}

#[test]
fn terms_that_no_code_has_are_refused_with_a_reason() {
    let refused = |expressions: &[&str], model| {
        Function::new(&robot(expressions), &Request::new(model, ParameterSet::Standard)).unwrap_err().to_string()
    };
    let channel = refused(&["q*temperature"], ModelKind::InverseDynamics);
    assert!(channel.contains("recorded channel `temperature`"), "{channel}");
    let accelerations = refused(&["ddq1"], ModelKind::ForwardDynamics);
    assert!(accelerations.contains("takes accelerations"), "{accelerations}");
    // A model that the term does not change is generated.
    let mass = Request::new(ModelKind::MassMatrix, ParameterSet::Standard);
    assert!(Function::new(&robot(&["q*temperature"]), &mass).is_ok());
    let without =
        Request { drives: DriveTorques::Inertia, ..Request::new(ModelKind::InverseDynamics, ParameterSet::Base) };
    assert!(Function::new(&robot(&["q*temperature"]), &without).is_ok());
    let factor =
        ROBOT_WITH_TERMS.to_owned() + "[[term]]\nkind = \"channel-coulomb\"\nchannel = \"oil\"\nreference = 20\n";
    let robot = Robot::parse(&factor, Path::new("all.toml")).unwrap();
    let refused = Function::new(&robot, &Request::new(ModelKind::Regressor, ParameterSet::Standard)).unwrap_err();
    assert!(refused.to_string().contains("recorded channel `oil`"), "{refused}");
}

/// The derivatives of a case by central differences, row by row, relative to the largest.
fn check_derivatives(case: &Case, set: ParameterSet, what: &str) {
    const STEP: f64 = 1e-5;
    let n = case.model.coordinate_count();
    let found = case.evaluate(ModelKind::InverseDynamicsDerivatives, set);
    let at = |array: usize, c: usize, by: f64| {
        let mut state = case.state.clone();
        state[array][c] += by;
        let [q, dq, ddq] = &state;
        case.inverse_dynamics(q, dq, ddq)
    };
    let size = found.iter().fold(1.0, |size: f64, value| size.max(value.abs()));
    for array in 0..3 {
        for c in 0..n {
            let (above, below) = (at(array, c, STEP), at(array, c, -STEP));
            for row in 0..n {
                let expected = (above[row] - below[row]) / (2.0 * STEP);
                let entry = found[row * 3 * n + array * n + c];
                assert!(
                    (entry - expected).abs() < 2e-8 * size,
                    "{what} {row} {array} {c}: {entry} {expected} of {size}"
                );
            }
        }
    }
    let mass: Vec<f64> = (0..n * n).map(|entry| found[entry / n * 3 * n + 2 * n + entry % n]).collect();
    let is_rigid = case.robot.terms.iter().all(|term| !term.shape.needs_acceleration());
    if is_rigid {
        ensure_close(&mass, &case.evaluate(ModelKind::MassMatrix, set), what);
    }
}

#[test]
fn derivatives_are_those_of_central_differences() {
    of_each_robot(|case, name| SETS.iter().for_each(|set| check_derivatives(case, *set, name)));
}

/// Except at steps, where the derivative is not zero.
#[test]
fn derivatives_of_terms_are_those_of_central_differences() {
    for case in cases(&robot(&EXPRESSIONS)) {
        check_derivatives(&case, ParameterSet::Standard, "terms");
    }
}
