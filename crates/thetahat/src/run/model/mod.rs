//! The model: one physically consistent robot, chosen by what it predicts of motion that it has not seen.
//!
//! A consistent least squares in the rows of all samples, each joint whitened by the long-run deviation of its residual, with a
//! belief in the a-priori robot ([`thetahat_model::consistency::Prior::Belief`]). Other weights of the belief and other
//! velocities at which the friction changes its sign replace the default where they predict what is left out better by more
//! than chance.

mod beliefs;
mod causes;
mod choice;
mod errors;
mod folds;
mod intervals;
mod rows;

use super::identification::Identification;
use crate::preparation::{PreparationError, Problem};
use beliefs::beliefs;
use causes::FoundCauses;
use choice::{Choice, Choosing};
use errors::{Speeds, errors};
use folds::ModelFolds;
use intervals::{Intervals, widened};
use rows::ModelRows;
use thetahat_estimation::identification::Method;
use thetahat_ground::{clock::Stopwatch, linear_algebra::Matrix};
use thetahat_model::{
    consistency::{BaseKnowledge, ConsistentSet, bounds_of, interval_in, knowledge_of_base},
    robot::JointKind,
};
use thetahat_report::results::{ModelError, ModelParameter, ModelResult, ModelStandardParameter, RunResult};

/// Velocities v of `tanh(dq / v)`, the sign of the Coulomb friction, rad/s; the first is the default.
const TRANSITIONS: [f64; 5] = [0.03, 0.001, 0.003, 0.01, 0.1];
/// Radians of a motor for each metre of a robot whose joints all slide: a pinion of 0.1 m.
const SLIDING: f64 = 10.0;

/// Weights of the belief, in long-run variances of the residual; the first is the default.
const WEIGHTS: [f64; 7] = [1.0, 1e-3, 1e-2, 0.1, 10.0, 100.0, 1000.0];

impl Identification {
    /// The model of the nominal case, or why there is none.
    ///
    /// # Errors
    /// [`PreparationError`] where rows cannot be made.
    pub(super) fn model(
        &self,
        problem: &Problem,
        runs: &[RunResult],
    ) -> Result<Result<ModelResult, String>, PreparationError> {
        let stopwatch = Stopwatch::start();
        if self.main.iter().any(|p| p.filtered.recording.torque.is_none()) {
            return Ok(Err("the model is fitted to torques, and none are recorded".to_owned()));
        }
        let set = match problem.consistent_set(self.setup()) {
            Ok(set) => set,
            Err(error) => return Ok(Err(error.to_string())),
        };
        let transitions = self.transitions();
        let rows = ModelRows::new(self.setup(), &self.main, problem, transitions[0])?;
        let set = match set.clone().with_beliefs(beliefs(self, problem, &rows, set)) {
            Ok(set) => set,
            Err(error) => return Ok(Err(error.to_string())),
        };
        let folds = ModelFolds::new(self, &rows);
        let others = transitions[1..].iter().map(|v| rows.with_transition(self, problem, *v));
        let laws: Vec<ModelRows> =
            std::iter::once(Ok(rows.clone())).chain(others).collect::<Result<_, PreparationError>>()?;
        let weights = self.setup().settings.model.belief_weight.map_or_else(|| WEIGHTS.to_vec(), |stated| vec![stated]);
        let choosing = Choosing {
            set: &set,
            base: &problem.base,
            laws: &laws,
            transitions: &transitions,
            weights: &weights,
            folds: &folds,
        };
        let Some(choice) = choosing.choose(self.threads) else {
            return Ok(Err("the rows determine no physically consistent robot".to_owned()));
        };
        let mut model = self.model_result(problem, &set, &laws, &choice, runs);
        model.held_back = self.model_on_held_back(problem, &choice)?;
        model.seconds = stopwatch.seconds();
        Ok(Ok(model))
    }

    /// The error of the model on the recordings that were held back.
    fn model_on_held_back(&self, problem: &Problem, choice: &Choice) -> Result<Option<ModelError>, PreparationError> {
        let has_torque = self.validation.iter().all(|p| p.filtered.recording.torque.is_some());
        if self.validation.is_empty() || !has_torque {
            return Ok(None);
        }
        let rows = ModelRows::new(self.setup(), &self.validation, problem, choice.transition)?;
        let speeds = Speeds::new(&self.validation, &rows, choice.transition);
        let prediction = rows.x.times(&problem.base.from_standard(&choice.standard));
        Ok(Some(errors(&rows, &prediction, None, &speeds)))
    }

    fn transitions(&self) -> Vec<f64> {
        if let Some(stated) = self.setup().settings.model.friction_transition {
            return vec![stated];
        }
        let slides = self.setup().robot.coordinates().all(|joint| joint.kind == JointKind::Prismatic);
        TRANSITIONS.map(|v| if slides { v / SLIDING } else { v }).to_vec()
    }

    fn model_result(
        &self,
        problem: &Problem,
        set: &ConsistentSet,
        laws: &[ModelRows],
        choice: &Choice,
        runs: &[RunResult],
    ) -> ModelResult {
        let rows = &laws[choice.law];
        let theta = problem.base.from_standard(&choice.standard);
        let speeds = Speeds::new(&self.main, rows, choice.transition);
        let guessed = thetahat_model::consistency::stated_links(self.setup().robot);
        let found = (&choice.standard[..], &choice.deviations[..], choice.transition);
        let FoundCauses { causes, smallest_shown, delay } = causes::causes(self, problem, rows, &speeds, found);
        let knowledge = knowledge_of_base(set, &choice.data, choice.weight, &problem.base).ok();
        let intervals = Intervals::new(&rows.without(&speeds.turning), &choice.deviations, delay, runs);
        let mut parameters = self.model_parameters(problem, set, &theta, knowledge.as_ref(), &intervals);
        parameters
            .iter_mut()
            .for_each(|p| p.interval_95 = p.interval_95.map(|interval| widened(interval, &p.name, &causes)));
        ModelResult {
            method: Method::IDIM_WLS,
            belief_weight: choice.weight,
            belief_percent: 100.0 * (2.0 / choice.weight).sqrt(),
            guessed_links: (0..guessed.len()).filter(|k| !guessed[*k]).map(|k| k + 1).collect(),
            friction_transition: choice.transition,
            candidates: choice.candidates.clone(),
            fit: errors(rows, &rows.x.times(&theta), None, &speeds),
            held_back: None,
            unseen: choice.unseen.as_ref().map(|unseen| errors(rows, &unseen.prediction, Some(&unseen.seen), &speeds)),
            causes,
            smallest_shown,
            uses: Vec::new(),
            parameters,
            covariance: knowledge.map(|k| lower_triangle(&k.covariance, &theta)).unwrap_or_default(),
            standard: standard_parameters(set, &choice.standard),
            seconds: 0.0,
        }
    }

    fn model_parameters(
        &self,
        problem: &Problem,
        set: &ConsistentSet,
        theta: &[f64],
        knowledge: Option<&BaseKnowledge>,
        intervals: &Intervals,
    ) -> Vec<ModelParameter> {
        let a_priori = problem.base.from_standard(set.a_priori());
        let decided = knowledge.map_or_else(|| vec![0.0; theta.len()], BaseKnowledge::decided_percent);
        let truth = self.main.first().and_then(|p| p.filtered.recording.truth.as_ref());
        let truth = truth.filter(|t| problem.base.agrees_with_fixed(t)).map(|t| problem.base.from_standard(t));
        let parameter = |(i, p): (usize, &thetahat_model::base_parameters::BaseParameter)| ModelParameter {
            name: p.name.clone(),
            unit: p.unit.to_string(),
            expression: p.expression.clone(),
            value: theta[i],
            a_priori: a_priori[i],
            decided_percent: decided[i],
            interval_95: intervals.of(i, &p.name).map(|interval| interval_in(bounds_of(set, p), interval, theta[i])),
            true_value: truth.as_ref().map(|truth| truth[i]),
        };
        problem.base.parameters().iter().enumerate().map(parameter).collect()
    }
}

/// Deviation of a parameter whose value is given, over the value or over one: next to none, so that the covariance stays regular.
const OF_GIVEN: f64 = 1e-9;

/// The lower triangle of a covariance, row by row.
fn lower_triangle(covariance: &Matrix, values: &[f64]) -> Vec<f64> {
    let least = |i: usize| (OF_GIVEN * values[i].abs().max(1.0)).powi(2);
    let entry = |i: usize, j: usize| if i == j { covariance.at(i, i) + least(i) } else { covariance.at(i, j) };
    (0..covariance.rows()).flat_map(|i| (0..=i).map(move |j| entry(i, j))).collect()
}

fn standard_parameters(set: &ConsistentSet, standard: &[f64]) -> Vec<ModelStandardParameter> {
    let parameters = set.parameter_table().iter().zip(standard).zip(set.believed());
    let parameter = |((p, value), a_priori): ((&thetahat_model::robot::Parameter, &f64), f64)| ModelStandardParameter {
        name: p.name(),
        unit: p.unit.to_string(),
        value: *value,
        a_priori,
    };
    parameters.map(parameter).collect()
}
