//! The model that was chosen, as it is written.

use super::{
    beliefs::with_open_motors,
    candidates::kinds,
    causes::{FoundCauses, FrictionEvidence, causes},
    choice::Choice,
    errors::{SquaredErrors, turning},
    intervals::{Intervals, widened},
    joints::Covered,
    lasting::lasting_percent,
    law_factors::LawFactors,
    of_rows::data_of_rows,
    rows::ModelRows,
    variant::Variant,
};
use crate::preparation::{PreparationError, Setup};
use thetahat_estimation::identification::Method;
use thetahat_ground::linear_algebra::Matrix;
use thetahat_model::{
    base_parameters::{BaseParameter, BaseParameters},
    consistency::{BaseKnowledge, ConsistentSet, bounds_of, interval_in, knowledge_of_base, stated_links},
    dynamics::FrictionTransition,
    robot::{Parameter, TermDescription},
};
use thetahat_report::results::{ModelError, ModelParameter, ModelResult, ModelStandardParameter, RunResult};

/// The law of friction that was chosen, with its rows.
pub(super) struct ChosenLaw<'v, 'a> {
    pub(super) variant: &'v Variant<'a>,
    pub(super) transition: FrictionTransition,
    pub(super) rows: &'v ModelRows,
    pub(super) factors: &'v LawFactors,
}

/// The law of friction that was chosen, without what only samples say.
pub(super) struct FittedLaw<'a> {
    pub(super) setup: Setup<'a>,
    pub(super) base: &'a BaseParameters,
    pub(super) set: &'a ConsistentSet,
    /// In addition to the robot's.
    pub(super) terms: &'a [TermDescription],
    pub(super) transition: FrictionTransition,
    pub(super) factors: &'a LawFactors,
    /// True base parameters, of twins.
    pub(super) truth: Option<Vec<f64>>,
}

impl ChosenLaw<'_, '_> {
    /// The model, with its error on the recordings that were held back.
    pub(super) fn model(
        &self,
        choice: &Choice,
        runs: &[RunResult],
        friction: FrictionEvidence,
    ) -> Result<ModelResult, PreparationError> {
        let held_back = self.error_on_held_back(choice)?;
        let lasting_percent = lasting_percent(self.variant, choice, self.transition);
        Ok(ModelResult { held_back, lasting_percent, ..self.fitted(choice, runs, friction) })
    }

    fn error_on_held_back(&self, choice: &Choice) -> Result<Option<ModelError>, PreparationError> {
        let Variant { identification, problem, .. } = self.variant;
        let validation = &identification.validation;
        let has_torque = validation.iter().all(|p| p.filtered.recording.torque.is_some());
        if validation.is_empty() || !has_torque {
            return Ok(None);
        }
        let rows = ModelRows::new(identification.setup(), validation, problem, self.transition)?;
        let rows = [(self.transition, rows)];
        let laws = data_of_rows(identification.setup(), validation, problem, &rows).laws();
        let theta = problem.base.from_standard(&choice.standard);
        Ok(Some(SquaredErrors::of(&laws[0], &theta).error()))
    }

    fn fitted(&self, choice: &Choice, runs: &[RunResult], friction: FrictionEvidence) -> ModelResult {
        let Self { variant: Variant { identification, problem, set, terms, .. }, transition, rows, factors } = *self;
        let turning = turning(&identification.main, rows, (transition, &kinds(identification.setup())));
        let found = (&choice.standard[..], &choice.deviations[..], transition);
        let found = causes(identification, problem, rows, &turning, found, friction);
        // The runs are of the robot without the terms, and take estimated sizes as exact.
        let is_of_runs = terms.is_empty() && identification.setup().settings.model.estimated.is_empty();
        let runs = if is_of_runs { runs } else { &[] };
        let intervals = Intervals::new(&rows.without(&turning), &choice.deviations, &found.estimated, runs);
        let (setup, base, truth) = (identification.setup(), &problem.base, self.truth());
        let covered = Covered::of_recordings(&identification.main);
        FittedLaw { setup, base, set, terms, transition, factors, truth }.result(choice, found, &intervals, &covered)
    }

    /// The true base parameters of a simulated robot that has no more terms than the described one.
    fn truth(&self) -> Option<Vec<f64>> {
        let Variant { identification, problem, terms, .. } = self.variant;
        let truth = identification.main.first()?.filtered.recording.truth.as_ref()?;
        let is_of_model = terms.is_empty() && problem.base.agrees_with_fixed(truth);
        is_of_model.then(|| problem.base.from_standard(truth))
    }
}

impl FittedLaw<'_> {
    /// The model with what samples say: the causes of its errors, and intervals.
    pub(super) fn result(
        &self,
        choice: &Choice,
        found: FoundCauses,
        intervals: &Intervals,
        covered: &Covered,
    ) -> ModelResult {
        let Self { setup, base, set, terms, transition, factors, .. } = *self;
        let theta = base.from_standard(&choice.standard);
        let guessed = stated_links(setup.robot);
        let FoundCauses { causes, smallest_shown, .. } = found;
        let knowledge = knowledge_of_base(set, &choice.data, choice.weight, base).ok();
        let open = knowledge_of_base(&with_open_motors(set), &choice.data, choice.weight, base).ok();
        let covariance = open.map(|k| k.covariance);
        let mut parameters = self.parameters(&theta, knowledge.as_ref(), intervals);
        parameters
            .iter_mut()
            .for_each(|p| p.interval_95 = p.interval_95.map(|interval| widened(interval, &p.name, &causes)));
        let model = ModelResult {
            method: Method::IDIM_WLS,
            belief_weight: choice.weight,
            belief_percent: 100.0 * (2.0 / choice.weight).sqrt(),
            estimated_sizes: setup.settings.model.estimated.iter().map(ToString::to_string).collect(),
            guessed_links: (0..guessed.len()).filter(|k| !guessed[*k]).map(|k| k + 1).collect(),
            friction_transition: transition.turning,
            friction_transition_sliding: transition.sliding_apart(),
            terms: terms.to_vec(),
            candidates: choice.candidates.clone(),
            fit: SquaredErrors::of(factors, &theta).error(),
            held_back: None,
            lasting_percent: None,
            unseen: choice.unseen.clone(),
            causes,
            smallest_shown,
            joints: Vec::new(),
            uses: Vec::new(),
            parameters,
            covariance: covariance.map(|c| lower_triangle(&c, &theta)).unwrap_or_default(),
            standard: standard_parameters(set, &choice.standard),
            seconds: 0.0,
        };
        let joints = covered.joints(setup, base, (&choice.standard, &model.open_covariance()));
        ModelResult { joints, ..model }
    }

    fn parameters(
        &self,
        theta: &[f64],
        knowledge: Option<&BaseKnowledge>,
        intervals: &Intervals,
    ) -> Vec<ModelParameter> {
        let Self { base, set, truth, .. } = self;
        let a_priori = base.from_standard(set.a_priori());
        let decided = knowledge.map_or_else(|| vec![0.0; theta.len()], BaseKnowledge::decided_percent);
        let parameter = |(i, p): (usize, &BaseParameter)| ModelParameter {
            name: p.name.clone(),
            unit: p.unit.to_string(),
            expression: p.expression.clone(),
            value: theta[i],
            a_priori: a_priori[i],
            decided_percent: decided[i],
            interval_95: intervals.of(i, &p.name).map(|interval| interval_in(bounds_of(set, p), interval, theta[i])),
            true_value: truth.as_ref().map(|truth| truth[i]),
        };
        base.parameters().iter().enumerate().map(parameter).collect()
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
    let parameter = |((p, value), a_priori): ((&Parameter, &f64), f64)| ModelStandardParameter {
        name: p.name(),
        unit: p.unit.to_string(),
        value: *value,
        a_priori,
    };
    parameters.map(parameter).collect()
}
