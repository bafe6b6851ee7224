//! The physically consistent set of the robot of a problem.

use super::{physical::all_known, problem::Problem, settings::ParameterSelection, setup::Setup};
use thetahat_estimation::identification::idim_ls;
use thetahat_model::{
    consistency::{ConsistencyError, ConsistentSet, Known, LeastSquares, completed_a_priori, mass_factor},
    robot::{Friction, Robot},
};

impl Problem {
    /// The set of the robot with the friction of the problem, what is excluded being zero. A-priori values that the robot
    /// lacks are guessed. It is built once.
    pub(crate) fn consistent_set(&self, setup: Setup<'_>) -> Result<&ConsistentSet, &ConsistencyError> {
        self.consistent_set.get_or_init(|| consistent_set(setup, self)).as_ref()
    }
}

fn consistent_set(setup: Setup<'_>, problem: &Problem) -> Result<ConsistentSet, ConsistencyError> {
    let table = problem.model.parameter_table();
    let with_friction = |friction: &Friction| Robot { friction: *friction, ..setup.robot.clone() };
    let robot = Friction::ALL.iter().map(with_friction).find(|r| r.parameter_table() == *table);
    let robot = robot.unwrap_or_else(|| setup.robot.clone());
    consistent_set_of(setup, &robot, |a_priori| factor_of_masses(problem, a_priori))
}

/// The set of the setup's robot with a friction model, what is excluded being zero and what is known holding. Where no
/// inertial parameter is given, those that are guessed are multiplied by `mass_factor` of them.
pub(crate) fn consistent_set_of(
    setup: Setup<'_>,
    robot: &Robot,
    mass_factor: impl FnOnce(&[f64]) -> Option<f64>,
) -> Result<ConsistentSet, ConsistencyError> {
    let table = &robot.parameter_table();
    let mut a_priori = completed_a_priori(robot, None);
    let given = robot.a_priori_parameters_for(table);
    let inertial = |i: usize| table.get(i).quantity.is_inertial();
    if (0..given.len()).all(|i| given[i] == 0.0 || !inertial(i)) {
        let factor = mass_factor(&a_priori).unwrap_or(1.0);
        (0..given.len()).filter(|&i| inertial(i)).for_each(|i| a_priori[i] *= factor);
    }
    let excluded = &setup.settings.parameters.exclude;
    let is_excluded = |i: &usize| excluded.contains(&table.get(*i).name());
    (0..given.len()).filter(|i| !inertial(*i)).filter(is_excluded).for_each(|i| a_priori[i] = 0.0);
    let zero = |name: &String| Known::Value { parameter: name.clone(), value: 0.0 };
    let ParameterSelection { fix, known, .. } = &setup.settings.parameters;
    let known = all_known(fix, known).map(|(_, known)| known);
    excluded
        .iter()
        .map(zero)
        .chain(known)
        .try_fold(ConsistentSet::new(robot, &a_priori)?, |set, known| set.with_known(&known))
}

/// The factor of guessed masses that the torques ask for.
fn factor_of_masses(problem: &Problem, a_priori: &[f64]) -> Option<f64> {
    let regression = &problem.regression;
    let ls = idim_ls(regression, Default::default()).ok()?;
    let r = regression.x.triangular_factor();
    let data = LeastSquares::nearest(&r, &ls.theta, &problem.estimated, a_priori.len()).ok()?;
    mass_factor(&data, problem.model.parameter_table(), a_priori)
}
