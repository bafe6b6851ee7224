//! Dynamics and regressor against Pinocchio 4.1.0: `shared/reference/dynamics_*.json`, made by the script beside them. The
//! TX40 through our description and through its URDF, the KUKA LWR4+ and a tree with skew axes through theirs.

use std::path::PathBuf;

use libtest_mimic::{Failed, Trial};
use serde::Deserialize;
use thetahat::{
    Robot,
    dynamics::{DynamicParameters, Model, Sign, Workspace},
    regressor::Regressor,
};
use thetahat_model::dynamics;

/// Both sides are exact but for rounding.
const TOLERANCE: f64 = 1e-9;

#[derive(Deserialize)]
struct Reference {
    joints: Vec<String>,
    phi: Vec<f64>,
    states: Vec<State>,
}

#[derive(Deserialize)]
struct State {
    q: Vec<f64>,
    dq: Vec<f64>,
    ddq: Vec<f64>,
    tau: Vec<f64>,
    mass_matrix: Vec<Vec<f64>>,
    nonlinear: Vec<f64>,
    gravity: Vec<f64>,
    regressor: Vec<Vec<f64>>,
}

/// Pinocchio's order of the ten inertial parameters, by our names.
const ORDER: [&str; 10] = ["m", "mx", "my", "mz", "xx", "xy", "yy", "xz", "yz", "zz"];

struct Case {
    robot: Robot,
    model: Model,
    theta: Vec<f64>,
    /// The reference's inertial parameters in our table.
    indices: Vec<usize>,
    /// The reference's place of each of our joints.
    places: Vec<usize>,
    reference: Reference,
}

/// A robot, and the name of its reference values.
type Source = (PathBuf, &'static str);

fn tx40_toml() -> Source {
    (thetahat_testing::root().join("robots/tx40.toml"), "tx40")
}

fn tx40_urdf() -> Source {
    (thetahat_testing::data().join("tx40/tx40_mdh_modified.urdf"), "tx40")
}

fn kuka_lwr4() -> Source {
    (thetahat_testing::data().join("kuka_lwr4/kuka_lwr4.urdf"), "kuka_lwr4")
}

fn tree8() -> Source {
    (thetahat_testing::shared().join("reference/tree8.urdf"), "tree8")
}

impl Case {
    fn read((path, name): Source) -> Result<Self, Failed> {
        let robot = Robot::read(&path)?;
        let file = thetahat_testing::shared().join(format!("reference/dynamics_{name}.json"));
        let reference: Reference = serde_json::from_str(&std::fs::read_to_string(file)?)?;
        let model = Model::new(&robot);
        let table = model.parameter_table();
        let place = |name: &String| reference.joints.iter().position(|joint| joint == name);
        let places: Vec<usize> =
            robot.joints.iter().map(|j| place(&j.name)).collect::<Option<_>>().ok_or("a joint of another name")?;
        let number = |theirs: usize| places.iter().position(|&p| p == theirs).map_or(0, |ours| ours + 1);
        let name = |k: usize| format!("{}{}", ORDER[k % 10], number(k / 10));
        let indices: Vec<usize> = (0..reference.phi.len()).filter_map(|k| table.index_of(&name(k))).collect();
        thetahat_testing::ensure(indices.len() == 10 * robot.coordinate_count(), "a parameter of another name")?;
        let mut theta = vec![0.0; table.len()];
        indices.iter().zip(&reference.phi).for_each(|(&i, &v)| theta[i] = v);
        Ok(Self { robot, model, theta, indices, places, reference })
    }

    /// The reference's values in the order of our joints.
    fn ours(&self, theirs: &[f64]) -> Vec<f64> {
        self.places.iter().map(|&p| theirs[p]).collect()
    }

    fn inverse_dynamics(&self, [q, dq, ddq]: [&[f64]; 3], workspace: &mut Workspace) -> Vec<f64> {
        let parameters = DynamicParameters::sorted(&self.model, &self.theta);
        let mut tau = vec![0.0; q.len()];
        self.model.inverse_dynamics(&parameters, dynamics::State::new(q, dq), ddq, Sign::Exact, workspace, &mut tau);
        tau
    }

    fn torques(&self, s: &State, workspace: &mut Workspace) -> f64 {
        let motion = [&s.q, &s.dq, &s.ddq].map(|x| self.ours(x));
        let found = self.inverse_dynamics([&motion[0], &motion[1], &motion[2]], workspace);
        worst(&found, &self.ours(&s.tau))
    }

    fn nonlinear_effects(&self, s: &State, workspace: &mut Workspace) -> f64 {
        let [q, dq] = [&s.q, &s.dq].map(|x| self.ours(x));
        let zero = vec![0.0; q.len()];
        let h = self.inverse_dynamics([&q, &dq, &zero], workspace);
        let g = self.inverse_dynamics([&q, &zero, &zero], workspace);
        worst(&h, &self.ours(&s.nonlinear)).max(worst(&g, &self.ours(&s.gravity)))
    }

    fn mass_matrix(&self, s: &State, workspace: &mut Workspace) -> f64 {
        let n = self.places.len();
        let parameters = DynamicParameters::sorted(&self.model, &self.theta);
        let mut m = vec![0.0; n * n];
        self.model.mass_matrix(&parameters, &self.ours(&s.q), workspace, &mut m);
        let rows = self.places.iter().map(|&p| self.ours(&s.mass_matrix[p]));
        worst(&m, &rows.flatten().collect::<Vec<f64>>())
    }

    fn regressor(&self, s: &State, workspace: &mut Workspace) -> f64 {
        let columns = self.indices.len();
        let regressor = Regressor::new(&self.model, &self.indices);
        let [q, dq, ddq] = [&s.q, &s.dq, &s.ddq].map(|x| self.ours(x));
        let mut phi = vec![0.0; regressor.entries().len()];
        regressor.evaluate(&self.model, dynamics::State::new(&q, &dq), &ddq, Sign::Exact, workspace, &mut phi);
        let mut dense = vec![0.0; q.len() * columns];
        for (entry, value) in regressor.entries().iter().zip(&phi) {
            dense[entry.joint * columns + entry.column] = *value;
        }
        let rows = self.places.iter().flat_map(|&p| s.regressor[p].iter().copied());
        worst(&dense, &rows.collect::<Vec<f64>>())
    }

    /// The URDF's own inertial values are those that the reference was computed with.
    fn a_priori(&self) -> f64 {
        let a_priori = self.robot.a_priori_parameters();
        let ours: Vec<f64> = self.indices.iter().map(|&i| a_priori[i]).collect();
        worst(&ours, &self.reference.phi)
    }
}

/// NaN where the lengths differ or a value is not a number.
fn worst(found: &[f64], expected: &[f64]) -> f64 {
    if found.len() != expected.len() {
        return f64::NAN;
    }
    let errors = found.iter().zip(expected).map(|(a, b)| (a - b).abs() / b.abs().max(1.0));
    errors.fold(0.0, |worst, e| if e.is_nan() || worst < e { e } else { worst })
}

fn check(source: Source) -> Result<(), Failed> {
    let case = Case::read(source)?;
    let mut workspace = Workspace::new(&case.model);
    let near = |what: String, error: f64| thetahat_testing::ensure(error <= TOLERANCE, format!("{what}: {error:e}"));
    near("a-priori values".to_owned(), case.a_priori())?;
    thetahat_testing::ensure(case.reference.states.len() == 25, "25 states")?;
    for (k, state) in case.reference.states.iter().enumerate() {
        near(format!("torques of state {k}"), case.torques(state, &mut workspace))?;
        near(format!("nonlinear effects of state {k}"), case.nonlinear_effects(state, &mut workspace))?;
        near(format!("mass matrix of state {k}"), case.mass_matrix(state, &mut workspace))?;
        near(format!("regressor of state {k}"), case.regressor(state, &mut workspace))?;
    }
    Ok(())
}

/// Lower, upper, velocity and effort of every joint, as the files have them.
#[allow(clippy::approx_constant)] // The file says 3.14.
fn limits() -> Result<(), Failed> {
    let tx40 = [
        [-3.14, 3.14, 5.009, 131.84],
        [-2.18, 2.18, 5.009, 131.84],
        [-2.40, 2.40, 7.504, 103.49],
        [-4.71, 4.71, 7.15, 46.08],
        [-2.09, 2.33, 5.585, 43.19],
        [-4.71, 4.71, 12.217, 30.72],
    ];
    let (wide, narrow) = (2.96705972839, 2.09439510239);
    let kuka = [
        [-wide, wide, 1.91986217719, 176.0],
        [-narrow, narrow, 1.91986217719, 176.0],
        [-wide, wide, 2.23402144255, 100.0],
        [-narrow, narrow, 2.23402144255, 100.0],
        [-wide, wide, 3.56047167407, 100.0],
        [-narrow, narrow, 3.21140582367, 38.0],
        [-wide, wide, 3.21140582367, 38.0],
    ];
    let tree = [[-3.0, 3.0, 5.0, 100.0]; 8];
    for (source, expected) in [(tx40_urdf(), &tx40[..]), (kuka_lwr4(), &kuka[..]), (tree8(), &tree[..])] {
        let robot = Robot::read(&source.0)?;
        let found: Vec<[Option<f64>; 4]> =
            robot.joints.iter().map(|j| [j.limits.lower, j.limits.upper, j.limits.velocity, j.limits.effort]).collect();
        let expected: Vec<[Option<f64>; 4]> = expected.iter().map(|four| four.map(Some)).collect();
        thetahat_testing::ensure(found == expected, format!("{}: {found:?}", source.1))?;
    }
    Ok(())
}

/// The trials of this module.
pub fn all_trials() -> Vec<Trial> {
    thetahat_testing::trials_on_shared_data(
        &["reference", "datasets/tx40", "datasets/kuka_lwr4"],
        vec![
            ("tx40_from_toml", || check(tx40_toml())),
            ("tx40_from_urdf", || check(tx40_urdf())),
            ("kuka_lwr4_from_urdf", || check(kuka_lwr4())),
            ("tree8_from_urdf", || check(tree8())),
            ("limits_of_every_joint", limits),
        ],
    )
}
