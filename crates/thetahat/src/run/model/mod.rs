//! The model: one physically consistent robot, chosen by what it predicts of motion that it has not seen.
//!
//! A consistent least squares in the rows of all samples, each joint whitened by the long-run deviation of its residual, with a
//! belief in the a-priori robot ([`thetahat_model::consistency::Prior::Belief`]). Other weights of the belief and other
//! velocities at which the friction changes its sign replace the default where they predict what is left out better by more
//! than chance, and so do torque terms of friction that the residual shows.

mod beliefs;
mod causes;
mod choice;
mod deviations;
mod errors;
mod folds;
mod friction_terms;
mod intervals;
mod law;
mod result;
mod rows;
mod variant;
mod whitened;

use super::identification::Identification;
use crate::preparation::{PreparationError, Problem};
use causes::FrictionEvidence;
use choice::{Choice, Choosing, SearchedLaws};
use folds::ModelFolds;
use friction_terms::friction_terms;
use law::Law;
use result::ChosenLaw;
use thetahat_ground::clock::Stopwatch;
use thetahat_model::robot::JointKind;
use thetahat_report::results::{CauseKind, ModelCause, ModelResult, RunResult};
use variant::{Variant, WithTerms};

/// Velocities v of `tanh(dq / v)`, the sign of the Coulomb friction, rad/s; the first is the default.
const TRANSITIONS: [f64; 5] = [0.03, 0.001, 0.003, 0.01, 0.1];
/// Radians of a motor for each metre of a robot whose joints all slide: a pinion of 0.1 m.
const SLIDING: f64 = 10.0;

/// Weights of the belief, in long-run variances of the residual; the first is the default.
const WEIGHTS: [f64; 7] = [1.0, 1e-3, 1e-2, 0.1, 10.0, 100.0, 1000.0];

/// The model, or why there is none.
type ModelOrReason = Result<ModelResult, String>;

impl Identification {
    /// The model of the nominal case, or why there is none.
    ///
    /// # Errors
    /// [`PreparationError`] where rows cannot be made.
    pub(super) fn model(&self, problem: &Problem, runs: &[RunResult]) -> Result<ModelOrReason, PreparationError> {
        let stopwatch = Stopwatch::start();
        if self.main.iter().any(|p| p.filtered.recording.torque.is_none()) {
            return Ok(Err("the model is fitted to torques, and none are recorded".to_owned()));
        }
        let described = match Variant::new(self, problem, &[], &self.transitions())? {
            Ok(described) => described,
            Err(why) => return Ok(Err(why)),
        };
        let mut variants = vec![described];
        let Some(choice) = self.choose(&variants, SearchedLaws::default()) else {
            return Ok(Err("the rows determine no physically consistent robot".to_owned()));
        };
        let is_stated = self.setup().settings.model.is_stated();
        let friction = if is_stated { FrictionEvidence::AfterTerms } else { FrictionEvidence::BeforeTerms };
        let mut model = law_of(&variants, choice.law).model(&choice, runs, friction)?;
        let tried = if is_stated { Vec::new() } else { friction_terms(self, &model.causes) };
        let with_terms = tried.iter().filter_map(|terms| WithTerms::new(self, terms).transpose());
        let with_terms = with_terms.collect::<Result<Vec<_>, _>>()?;
        for WithTerms { identification, problem, terms } in &with_terms {
            variants.extend(Variant::new(identification, problem, terms, &[model.friction_transition])?.ok());
        }
        if !tried.is_empty()
            && let Some(choice) = self.choose(&variants, choice.found)
        {
            let described = std::mem::take(&mut model.causes);
            model = law_of(&variants, choice.law).model(&choice, runs, FrictionEvidence::AfterTerms)?;
            add_causes_in_model(&mut model, described);
        }
        model.seconds = stopwatch.seconds();
        Ok(Ok(model))
    }

    /// The law and the weight that predict best what is left out.
    fn choose(&self, variants: &[Variant], found: SearchedLaws) -> Option<Choice> {
        let laws: Vec<Law> = variants.iter().flat_map(Variant::laws).collect();
        let weights = self.setup().settings.model.belief_weight.map_or_else(|| WEIGHTS.to_vec(), |stated| vec![stated]);
        let folds = ModelFolds::new(self, laws[0].rows);
        let kinds: Vec<JointKind> = self.setup().robot.coordinates().map(|joint| joint.kind).collect();
        Choosing { laws: &laws, weights: &weights, folds: &folds, kinds: &kinds }.choose(self.threads, found)
    }

    fn transitions(&self) -> Vec<f64> {
        if let Some(stated) = self.setup().settings.model.friction_transition {
            return vec![stated];
        }
        let slides = self.setup().robot.coordinates().all(|joint| joint.kind == JointKind::Prismatic);
        TRANSITIONS.map(|v| if slides { v / SLIDING } else { v }).to_vec()
    }
}

/// Adds the causes of the robot as described for which the model has a term.
fn add_causes_in_model(model: &mut ModelResult, described: Vec<ModelCause>) {
    let has_term = |cause: &ModelCause| match cause.kind {
        CauseKind::LoadFriction | CauseKind::SpeedFriction => !model.causes.iter().any(|c| c.kind == cause.kind),
        CauseKind::LateTorque
        | CauseKind::EncoderZero
        | CauseKind::GearRatio
        | CauseKind::DriveGain
        | CauseKind::OffsetDrift
        | CauseKind::Elasticity
        | CauseKind::Length
        | CauseKind::Coupling
        | CauseKind::FrictionDrift
        | CauseKind::Payload => false,
    };
    if model.terms.is_empty() {
        return;
    }
    let in_model = described.into_iter().filter(has_term);
    let in_model: Vec<ModelCause> =
        in_model.map(|cause| ModelCause { in_model: true, moved: Vec::new(), ..cause }).collect();
    model.causes.extend(in_model);
    model.causes.sort_by(|a, b| a.log10_probability.total_cmp(&b.log10_probability));
}

/// The law of a number, counted over all variants.
fn law_of<'v, 'a>(variants: &'v [Variant<'a>], law: usize) -> ChosenLaw<'v, 'a> {
    let mut laws = variants.iter().flat_map(|variant| variant.rows.iter().map(move |rows| (variant, rows)));
    let (variant, (transition, rows)) = laws.nth(law).unwrap_or((&variants[0], &variants[0].rows[0]));
    ChosenLaw { variant, transition: *transition, rows }
}
