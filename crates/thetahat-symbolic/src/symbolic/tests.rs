//! The generated functions compared with the library's kernels, in random states.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::{snapping::snapped, *};
use thetahat_model::{
    base_parameters::BaseParameters,
    dynamics::{DynamicParameters, FrictionTransition, Model, Sign, State, Workspace},
    regressor::Regressor,
    robot::{JointQuantity, LinkQuantity, Locks, Parameter, Quantity, Robot, RobotSource},
};

const ROBOTS: [&str; 9] = [
    "two_joint.toml",
    "emps.toml",
    "scara.toml",
    "tx40.toml",
    "ur10.toml",
    "branching.urdf",
    "seven_axes.urdf",
    "mobile_manipulator.urdf",
    "quadruped.urdf",
];
/// Relative to the largest entry.
const ROUNDING: f64 = 1e-12;

fn robots() -> impl Iterator<Item = Robot> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../robots");
    ROBOTS.iter().map(move |name| {
        let source = RobotSource::read(&folder.join(name)).unwrap();
        let until = if name.starts_with("mobile") { vec!["arm_7_joint".to_owned()] } else { Vec::new() };
        let locks = Locks { until, ..Locks::default() };
        snapped(&source.robot_with_locks(&locks, Path::new("test")).unwrap()).0
    })
}

#[derive(Clone)]
pub(super) struct Case {
    pub(super) robot: Robot,
    pub(super) model: Model,
    pub(super) theta: Vec<f64>,
    parameters: DynamicParameters,
    pub(super) state: [Vec<f64>; 3],
}

impl Case {
    pub(super) fn new(robot: Robot, rng: &mut ChaCha8Rng) -> Self {
        let model = Model::new(&robot);
        let mut random = |n: usize| -> Vec<f64> { (0..n).map(|_| rng.random_range(-2.0..2.0)).collect() };
        let theta = random(model.parameter_table().len());
        let n = model.coordinate_count();
        let state = [random(n), random(n), random(n)];
        let parameters = DynamicParameters::sorted(&model, &theta);
        Self { robot, model, theta, parameters, state }
    }

    pub(super) fn inverse_dynamics(&self, q: &[f64], dq: &[f64], ddq: &[f64]) -> Vec<f64> {
        let mut tau = vec![0.0; q.len()];
        let mut workspace = Workspace::new(&self.model);
        self.model.inverse_dynamics(&self.parameters, State::new(q, dq), ddq, Sign::Exact, &mut workspace, &mut tau);
        tau
    }

    /// `phi` of the kernels, row by row.
    pub(super) fn kernel_regressor(&self) -> Vec<f64> {
        let columns: Vec<usize> = (0..self.theta.len()).collect();
        let regressor = Regressor::new(&self.model, &columns);
        let mut entries = vec![0.0; regressor.entries().len()];
        let [q, dq, ddq] = &self.state;
        let mut workspace = Workspace::new(&self.model);
        regressor.evaluate(&self.model, State::new(q, dq), ddq, Sign::Exact, &mut workspace, &mut entries);
        let mut phi = vec![0.0; q.len() * columns.len()];
        for (entry, value) in regressor.entries().iter().zip(entries) {
            phi[entry.joint * columns.len() + entry.column] += value;
        }
        phi
    }

    pub(super) fn function(&self, model: ModelKind, parameters: ParameterSet) -> Function {
        Function::new(&self.robot, &Request::new(model, parameters)).unwrap()
    }

    /// The output of a function with the parameters' values inserted.
    fn folded(&self, model: ModelKind, parameters: ParameterSet, drives: DriveTorques) -> Vec<f64> {
        let request = Request {
            model,
            parameters,
            values: Some(self.theta.clone()),
            drives,
            about: Vec::new(),
            friction_transition: None,
        };
        let [q, dq, ddq] = &self.state;
        let program = Function::new(&self.robot, &request).unwrap().program;
        program.evaluate(&Inputs { q, dq, ddq, tau: ddq, ..Inputs::default() })
    }

    /// The case with zero values for parameters that are not kept.
    fn keeping(&self, is_kept: impl Fn(&Parameter) -> bool) -> Self {
        let table = self.model.parameter_table();
        let theta: Vec<f64> = table.iter().zip(&self.theta).map(|(p, v)| if is_kept(p) { *v } else { 0.0 }).collect();
        Self { parameters: DynamicParameters::sorted(&self.model, &theta), theta, ..self.clone() }
    }

    pub(super) fn values(&self, set: ParameterSet) -> Vec<f64> {
        match set {
            ParameterSet::Standard => self.theta.clone(),
            ParameterSet::Base => BaseParameters::of(&self.model, &[]).unwrap().from_standard(&self.theta),
        }
    }

    fn without_offsets(&self) -> Self {
        self.keeping(|p| p.quantity != Quantity::Joint(JointQuantity::Off))
    }

    /// Only the drives: the parameters of the links are zero.
    fn friction_at_rest(&self, dq: &[f64]) -> Vec<f64> {
        self.keeping(|p| !matches!(p.quantity, Quantity::Link(_))).inverse_dynamics(
            &self.state[0],
            dq,
            &vec![0.0; dq.len()],
        )
    }

    pub(super) fn evaluate(&self, model: ModelKind, parameters: ParameterSet) -> Vec<f64> {
        let theta = self.values(parameters);
        let [q, dq, ddq] = &self.state;
        self.function(model, parameters).program.evaluate(&Inputs { q, dq, ddq, tau: ddq, theta: &theta })
    }
}

pub(super) fn ensure_close(found: &[f64], expected: &[f64], what: &str) {
    let size = expected.iter().fold(1e-3, |size: f64, value| size.max(value.abs()));
    assert_eq!(found.len(), expected.len(), "{what}");
    for (place, (a, b)) in found.iter().zip(expected).enumerate() {
        assert!((a - b).abs() <= ROUNDING * size, "{what}, entry {place}: {a} against {b}, of {size}");
    }
}

pub(super) fn of_each_robot(check: impl Fn(&Case, &str)) {
    let mut rng = ChaCha8Rng::seed_from_u64(16);
    for robot in robots() {
        for _ in 0..3 {
            let case = Case::new(robot.clone(), &mut rng);
            check(&case, &robot.name);
        }
    }
}

pub(super) const SETS: [ParameterSet; 2] = [ParameterSet::Standard, ParameterSet::Base];

#[test]
fn inverse_dynamics_is_that_of_the_kernels() {
    of_each_robot(|case, name| {
        let [q, dq, ddq] = &case.state;
        let expected = case.inverse_dynamics(q, dq, ddq);
        for set in SETS {
            ensure_close(&case.evaluate(ModelKind::InverseDynamics, set), &expected, name);
        }
    });
}

#[test]
fn mass_matrix_is_that_of_the_kernels() {
    of_each_robot(|case, name| {
        let n = case.model.coordinate_count();
        let mut expected = vec![0.0; n * n];
        case.model.mass_matrix(&case.parameters, &case.state[0], &mut Workspace::new(&case.model), &mut expected);
        for set in SETS {
            ensure_close(&case.evaluate(ModelKind::MassMatrix, set), &expected, name);
        }
    });
}

/// Forward dynamics of the torques of inverse dynamics returns the accelerations; the mass matrix of random parameters need not
/// be positive definite.
#[test]
fn forward_dynamics_reverses_inverse_dynamics() {
    of_each_robot(|case, name| {
        let [q, dq, ddq] = &case.state;
        let theta = bodies(&case.model);
        let parameters = DynamicParameters::sorted(&case.model, &theta);
        let mut tau = vec![0.0; q.len()];
        let (state, mut workspace) = (State::new(q, dq), Workspace::new(&case.model));
        case.model.inverse_dynamics(&parameters, state, ddq, Sign::Exact, &mut workspace, &mut tau);
        let mut expected = vec![0.0; q.len()];
        case.model.forward_dynamics(&parameters, state, &tau, Sign::Exact, &mut workspace, &mut expected).unwrap();
        let error = |of: &[f64]| of.iter().zip(ddq).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        for set in SETS {
            let theta = match set {
                ParameterSet::Standard => theta.clone(),
                ParameterSet::Base => BaseParameters::of(&case.model, &[]).unwrap().from_standard(&theta),
            };
            let program = case.function(ModelKind::ForwardDynamics, set).program;
            let found = program.evaluate(&Inputs { q, dq, tau: &tau, theta: &theta, ..Inputs::default() });
            let (own, kernel) = (error(&found), error(&expected));
            // Another order of the same operations: the condition of the mass matrix is in both.
            assert!(own <= 100.0 * kernel + 1e-12, "{name}: {own:e} against {kernel:e} of the kernel");
        }
    });
}

/// Parameters of balls of 1 kg at the links' frames, with motors: the mass matrix is positive definite.
pub(super) fn bodies(model: &Model) -> Vec<f64> {
    let value = |parameter: &Parameter| match parameter.quantity {
        Quantity::Link(LinkQuantity::Xx | LinkQuantity::Yy | LinkQuantity::Zz) => 0.1,
        Quantity::Link(LinkQuantity::M) => 1.0,
        quantity if quantity.is_motor_inertia() => 0.2,
        Quantity::Link(_) => 0.0,
        Quantity::Joint(_) | Quantity::Motor(_) | Quantity::Term(_) => 0.3,
    };
    model.parameter_table().iter().map(value).collect()
}

/// Inserted values and omitted drives give the kernels' result with these parameters at zero.
#[test]
fn folded_values_and_drives_left_out_are_those_of_the_kernels() {
    of_each_robot(|case, name| {
        let [q, dq, ddq] = &case.state;
        for drives in DriveTorques::ALL.map(|(_, drives)| drives) {
            let kept = case.keeping(|p| drives.contain(p.quantity));
            let torques = kept.inverse_dynamics(q, dq, ddq);
            ensure_close(&case.folded(ModelKind::InverseDynamics, ParameterSet::Standard, drives), &torques, name);
            let phi = case.folded(ModelKind::Regressor, ParameterSet::Standard, drives);
            let row = |row: &[f64]| row.iter().zip(&case.theta).map(|(a, b)| a * b).sum::<f64>();
            let by_regressor: Vec<f64> = phi.chunks(case.theta.len()).map(row).collect();
            ensure_close(&by_regressor, &torques, name);
        }
        let whole = case.inverse_dynamics(q, dq, ddq);
        ensure_close(&case.folded(ModelKind::InverseDynamics, ParameterSet::Base, DriveTorques::All), &whole, name);
        for model in [ModelKind::MassMatrix, ModelKind::Coriolis] {
            let expected = case.evaluate(model, ParameterSet::Standard);
            for set in SETS {
                ensure_close(&case.folded(model, set, DriveTorques::All), &expected, name);
            }
        }
    });
}

/// The frames agree with the library's kinematics, in m.
#[test]
fn the_tips_are_those_of_the_kinematics() {
    of_each_robot(|case, name| {
        let function = case.function(ModelKind::ForwardKinematics, ParameterSet::Standard);
        let q = &case.state[0];
        let frames = function.program.evaluate(&Inputs { q, ..Inputs::default() });
        for (tip, pose) in function.tips.iter().zip(frames.chunks(12)) {
            let link = case.robot.joints.iter().position(|joint| joint.name == *tip).unwrap();
            let (origin, axis) = case.model.frame(link, q);
            ensure_close(&[pose[3], pose[7], pose[11]], &origin, name);
            ensure_close(&[pose[2], pose[6], pose[10]], &axis, name);
        }
    });
}

#[test]
fn values_without_inertia_have_no_accelerations() {
    let text = "name = 'arm'\n[[joint]]\nname = 'a'\nkind = 'revolute'\n[[joint]]\nname = 'b'\nkind = 'revolute'\na_m = 1\n\
                [parameters]\nzz1 = 1\n";
    let robot = Robot::parse(text, Path::new("arm.toml")).unwrap();
    let values = Some(robot.a_priori_parameters());
    let request = |model| Request { values: values.clone(), ..Request::new(model, ParameterSet::Base) };
    let error = Function::new(&robot, &request(ModelKind::ForwardDynamics)).unwrap_err();
    assert_eq!(error, SymbolicError::NotDefinite { joint: "b".to_owned() });
    assert!(Function::new(&robot, &request(ModelKind::InverseDynamics)).is_ok());
}

#[test]
fn base_parameters_that_hold_what_is_left_out_are_named() {
    let robot = robots().next().unwrap();
    let request = |drives| Request { drives, ..Request::new(ModelKind::InverseDynamics, ParameterSet::Base) };
    let kept = |drives| Function::new(&robot, &request(drives)).unwrap().kept_drives;
    assert_eq!(kept(DriveTorques::None), ["zz1r"]);
    assert!(kept(DriveTorques::Inertia).is_empty() && kept(DriveTorques::All).is_empty());
}

#[test]
fn joints_that_slide_change_the_sign_of_friction_at_their_own_velocity() {
    let text = "name = 'arm'\nfriction = 'symmetric'\n[[joint]]\nname = 'a'\nkind = 'revolute'\n[[joint]]\nname = 'b'\n\
                kind = 'prismatic'\n[parameters]\nfc1 = 1\nfc2 = 1\n";
    let robot = Robot::parse(text, Path::new("arm.toml")).unwrap();
    let friction_transition = Some(FrictionTransition { turning: 0.5, sliding: 0.125 });
    let values = Some(robot.a_priori_parameters());
    let request =
        Request { values, friction_transition, ..Request::new(ModelKind::InverseDynamics, ParameterSet::Standard) };
    let python = Language::Python.code(&Function::new(&robot, &request).unwrap(), None).unwrap();
    assert!(python.contains("np.tanh((dq[..., 0]) / 0.5)"), "{python}");
    assert!(["4.0 * dq[..., 1]", "dq[..., 1] * 4.0"].iter().any(|scaled| python.contains(scaled)), "{python}");
}

/// No parameter acts: the torques of velocity of a vertical slide.
#[test]
fn a_function_without_terms_is_code_all_the_same() {
    let text = "name = 'slide /* of'\n[[joint]]\nname = 'a'\nkind = 'prismatic'\n";
    let robot = Robot::parse(text, Path::new("slide.toml")).unwrap();
    let of = |model| Function::new(&robot, &Request::new(model, ParameterSet::Base)).unwrap();
    let latex = Language::Latex.code(&of(ModelKind::Coriolis), None).unwrap();
    assert!(latex.contains("All entries are zero"), "{latex}");
    let c = Language::C.code(&of(ModelKind::Coriolis), None).unwrap();
    assert!(c.contains("slide / * of") && c.contains("No parameter acts on the output"), "{c}");
    assert!(c.starts_with("/*\n * Generated by thetahat "), "{c}");
    // One coordinate has a matrix all the same.
    let python = Language::Python.code(&of(ModelKind::MassMatrix), None).unwrap();
    assert!(python.contains("reshape(states + (1, 1))"), "{python}");
}

#[test]
fn the_regressor_times_the_parameters_is_inverse_dynamics() {
    of_each_robot(|case, name| {
        let [q, dq, ddq] = &case.state;
        let expected = case.inverse_dynamics(q, dq, ddq);
        for set in SETS {
            let theta = case.values(set);
            let phi = case.evaluate(ModelKind::Regressor, set);
            let row = |row: &[f64]| row.iter().zip(&theta).map(|(a, b)| a * b).sum::<f64>();
            let found: Vec<f64> = phi.chunks(theta.len()).map(row).collect();
            ensure_close(&found, &expected, name);
        }
    });
}

#[test]
fn the_regressor_is_that_of_the_kernels() {
    of_each_robot(|case, name| {
        ensure_close(&case.evaluate(ModelKind::Regressor, ParameterSet::Standard), &case.kernel_regressor(), name);
    });
}

#[test]
fn gravity_and_coriolis_torques_are_parts_of_inverse_dynamics() {
    of_each_robot(|case, name| {
        // Base parameters combine an offset with the weight that a slide always carries.
        let case = &case.without_offsets();
        let ([q, dq, _], n) = (&case.state, case.model.coordinate_count());
        let zeros = vec![0.0; n];
        let mut still = case.robot.clone();
        still.gravity = [0.0; 3];
        let weightless = Case { model: Model::new(&still), robot: still, ..case.clone() };
        let difference = |a: Vec<f64>, b: Vec<f64>| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| a - b).collect() };
        let weight =
            difference(case.inverse_dynamics(q, &zeros, &zeros), weightless.inverse_dynamics(q, &zeros, &zeros));
        let friction = case.friction_at_rest(dq);
        let coriolis = difference(weightless.inverse_dynamics(q, dq, &zeros), friction);
        for set in SETS {
            ensure_close(&case.evaluate(ModelKind::Gravity, set), &weight, name);
            ensure_close(&case.evaluate(ModelKind::Coriolis, set), &coriolis, name);
        }
    });
}

/// The power of a force at a tip is the same by the Jacobian and by small changes of the coordinates.
#[test]
fn the_jacobian_is_the_derivative_of_the_kinematics() {
    const STEP: f64 = 1e-6;
    of_each_robot(|case, name| {
        let n = case.model.coordinate_count();
        let jacobian = case.evaluate(ModelKind::Jacobian, ParameterSet::Standard);
        let program = case.function(ModelKind::ForwardKinematics, ParameterSet::Standard).program;
        let at = |c: usize, by: f64| {
            let mut q = case.state[0].clone();
            q[c] += by;
            program.evaluate(&Inputs { q: &q, ..Inputs::default() })
        };
        let here = at(0, 0.0);
        for c in 0..n {
            let (above, below) = (at(c, STEP), at(c, -STEP));
            let rate: Vec<f64> = above.iter().zip(below).map(|(a, b)| (a - b) / (2.0 * STEP)).collect();
            for (tip, (rate, pose)) in rate.chunks(12).zip(here.chunks(12)).enumerate() {
                let column: Vec<f64> = (0..6).map(|row| jacobian[(6 * tip + row) * n + c]).collect();
                let spin = |i: usize, j: usize| (0..3).map(|k| rate[4 * i + k] * pose[4 * j + k]).sum::<f64>();
                let expected = [spin(2, 1), spin(0, 2), spin(1, 0), rate[3], rate[7], rate[11]];
                for (a, b) in column.iter().zip(expected) {
                    assert!((a - b).abs() < 1e-8, "{name}, coordinate {c}, tip {tip}: {a} against {b}");
                }
            }
        }
    });
}

/// The formulas have the coefficients of the numeric regrouping.
#[test]
fn formulas_are_the_numeric_regrouping() {
    for robot in robots() {
        let base = BaseParameters::of(&Model::new(&robot), &[]).unwrap();
        let formulas = BaseFormulas::of(&robot).unwrap();
        assert_eq!(base.len(), formulas.parameters.len());
        for (numeric, formula) in base.parameters().iter().zip(&formulas.parameters) {
            let mut left: BTreeMap<usize, f64> = formula.coefficients.iter().copied().collect();
            for (index, coefficient) in std::iter::once(&(numeric.kept, 1.0)).chain(&numeric.regrouped) {
                *left.entry(*index).or_insert(0.0) -= coefficient;
            }
            let worst = left.values().fold(0.0, |worst: f64, rest| worst.max(rest.abs()));
            assert!(
                worst < 1e-8,
                "{} {}: {} against {}",
                robot.name,
                numeric.name,
                formula.expression,
                numeric.expression
            );
        }
    }
}

#[test]
fn formulas_have_the_names_of_the_geometry() {
    let robot = Robot::parse(include_str!("../../../thetahat/demo/tx40.toml"), Path::new("tx40.toml")).unwrap();
    let formulas = BaseFormulas::of(&robot).unwrap();
    let of = |name: &str| formulas.parameters.iter().find(|p| p.name == name).unwrap().expression.clone();
    assert_eq!(
        of("zz1r"),
        "zz1 + ia1 + yy2 + yy3 + 2*d3*mz3 + (a3^2 + d3^2)*m3 + (a3^2 + d3^2)*m4 + (a3^2 + d3^2)*m5 + (a3^2 + d3^2)*m6"
    );
    assert_eq!(of("xx4r"), "xx4 - yy4 + yy5");
}
