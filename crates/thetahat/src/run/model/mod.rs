//! The model: one physically consistent robot, chosen by what it predicts of motion that it has not seen.
//!
//! A consistent least squares in the rows of all samples, each joint whitened by the long-run deviation of its residual, with a
//! belief in the a-priori robot ([`thetahat_model::consistency::Prior::Belief`]). Other weights of the belief and other
//! velocities at which the friction changes its sign replace the default where they predict what is left out better by more
//! than chance, and so do torque terms of friction that the residual shows.

mod beliefs;
mod between;
mod candidates;
mod causes;
mod choice;
mod columns;
mod deviations;
mod errors;
mod factors;
mod folds;
mod friction_terms;
mod intervals;
mod joints;
mod lasting;
mod law;
mod law_factors;
mod of_rows;
mod parts;
mod reduced;
mod result;
mod rows;
mod transition;
mod variant;
mod whitened;

pub(crate) use candidates::{kinds, transitions};
pub(crate) use columns::{ModelColumns, changing};
pub(crate) use factors::{InPlaceOfRows, ModelCollector, Slow, near_rest_limits, span};
pub use factors::{ModelCell, ModelFactors, RepeatedRows, SettledRows};
pub(crate) use folds::FEWEST_RECORDINGS;
pub(in crate::run) use joints::largest;
pub(crate) use law_factors::ModelData;
pub use parts::Parts;
pub(crate) use parts::{FOLDS, RowParts, STRETCHES, memory, places};
pub(in crate::run) use reduced::model_of_factors;

use super::identification::Identification;
use crate::preparation::{PreparationError, Problem};
use candidates::{LARGEST, weights};
use causes::FrictionEvidence;
use choice::{Choice, Choosing, SearchedLaws};
use friction_terms::friction_terms;
use law::Law;
use result::ChosenLaw;
use thetahat_ground::clock::Stopwatch;
use thetahat_report::results::{CauseKind, ModelCause, ModelResult, RunResult};
use transition::Refinement;
use variant::{Variant, WithTerms};

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
        let described = match Variant::new(self, problem, &[], &transitions(self.setup()))? {
            Ok(described) => described,
            Err(why) => return Ok(Err(why)),
        };
        let mut variants = vec![described];
        let Some(choice) = self.choose(&mut variants, SearchedLaws::default())? else {
            return Ok(Err("the rows determine no physically consistent robot".to_owned()));
        };
        let is_stated = self.setup().settings.model.is_stated();
        let friction = if is_stated { FrictionEvidence::AfterTerms } else { FrictionEvidence::BeforeTerms };
        let mut model = law_of(&variants, choice.law).model(&choice, runs, friction)?;
        let tried = if is_stated { Vec::new() } else { friction_terms(self, &model.causes) };
        let with_terms = tried.iter().filter_map(|terms| WithTerms::new(self, terms).transpose());
        let with_terms = with_terms.collect::<Result<Vec<_>, _>>()?;
        for WithTerms { identification, problem, terms } in &with_terms {
            variants.extend(Variant::new(identification, problem, terms, &[model.transition()])?.ok());
        }
        if !tried.is_empty()
            && let Some(choice) = self.best_of(&variants, choice.found)
            && let Some(choice) = self.with_any_transition(&mut variants, choice)?
        {
            let described = std::mem::take(&mut model.causes);
            model = law_of(&variants, choice.law).model(&choice, runs, FrictionEvidence::AfterTerms)?;
            add_causes_in_model(&mut model, described);
        }
        model.seconds = stopwatch.seconds();
        Ok(Ok(model))
    }

    /// The best law; one of the last variant may get a velocity between those tried first.
    fn choose(&self, variants: &mut Vec<Variant>, found: SearchedLaws) -> Result<Option<Choice>, PreparationError> {
        let Some(choice) = self.best_of(variants, found) else { return Ok(None) };
        let last = variants.len() - 1;
        if variant_of(variants, choice.law) != last {
            return Ok(Some(choice));
        }
        let mut refinement = Refinement::of(variants[last].laws(), &choice).up_to(LARGEST);
        let mut refined = None;
        while let Some(transition) = refinement.next() {
            let variant = variants[last].with_transition(transition)?;
            if variant.laws().any(|law| refinement.add(&law)) {
                refined = Some(variant);
            }
        }
        let Some(refined) = refined else { return Ok(Some(choice)) };
        variants.push(refined);
        Ok(self.best_of(variants, choice.found))
    }

    /// The best law where that of a robot with more terms may have any velocity: without the terms it made up for them.
    fn with_any_transition(
        &self,
        variants: &mut Vec<Variant>,
        choice: Choice,
    ) -> Result<Option<Choice>, PreparationError> {
        let Variant { identification, problem, terms, .. } = variants[variant_of(variants, choice.law)];
        if terms.is_empty() {
            return Ok(Some(choice));
        }
        let with_all = Variant::new(identification, problem, terms, &transitions(self.setup()))?;
        variants.extend(with_all.ok());
        self.choose(variants, choice.found)
    }

    /// The law and the weight that predict best what is left out.
    fn best_of(&self, variants: &[Variant], found: SearchedLaws) -> Option<Choice> {
        let laws: Vec<Law> = variants.iter().flat_map(Variant::laws).collect();
        let (weights, kinds) = (weights(self.setup()), kinds(self.setup()));
        let choosing = Choosing { laws: &laws, weights: &weights, folds: variants[0].folds(), kinds: &kinds };
        choosing.choose(self.threads, found)
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
        | CauseKind::Payload
        | CauseKind::GravityDirection
        | CauseKind::Crosstalk
        | CauseKind::FallingConstant
        | CauseKind::JointSpring
        | CauseKind::AsymmetricFriction
        | CauseKind::GainDrift
        | CauseKind::TorqueRipple
        | CauseKind::ZeroShift
        | CauseKind::LatePosition
        | CauseKind::TorqueFilter
        | CauseKind::TimeScale => false,
    };
    if model.terms.is_empty() {
        return;
    }
    // Named once: friction over speed looks early too.
    let is_named = described.iter().any(|cause| cause.kind == CauseKind::SpeedFriction);
    let once = described.into_iter().filter(|cause| !(is_named && cause.looks_early()));
    let in_model = once.map(as_friction).filter(has_term);
    let in_model: Vec<ModelCause> =
        in_model.map(|cause| ModelCause { in_model: true, moved: Vec::new(), ..cause }).collect();
    model.causes.extend(in_model);
    model.causes.sort_by(|a, b| a.log10_probability.total_cmp(&b.log10_probability));
}

/// What a cause is where a torque term takes it: torques that look early are friction over speed.
fn as_friction(cause: ModelCause) -> ModelCause {
    if !cause.looks_early() {
        return cause;
    }
    let (kind, size, standard_deviation, unit) = (CauseKind::SpeedFriction, None, None, String::new());
    ModelCause { kind, size, standard_deviation, unit, ..cause }
}

/// The variant of a law, counted over all variants.
fn variant_of(variants: &[Variant], law: usize) -> usize {
    let mut laws = variants.iter().enumerate().flat_map(|(k, variant)| variant.rows.iter().map(move |_| k));
    laws.nth(law).unwrap_or_default()
}

/// The law of a number, counted over all variants.
fn law_of<'v, 'a>(variants: &'v [Variant<'a>], law: usize) -> ChosenLaw<'v, 'a> {
    let of_variant = |variant: &'v Variant<'a>| {
        let laws = variant.rows.iter().zip(&variant.factors);
        laws.map(move |((transition, rows), factors)| ChosenLaw { variant, transition: *transition, rows, factors })
    };
    let mut laws = variants.iter().flat_map(of_variant);
    laws.nth(law).unwrap_or_else(|| {
        let variant = &variants[0];
        let (transition, rows) = &variant.rows[0];
        ChosenLaw { variant, transition: *transition, rows, factors: &variant.factors[0] }
    })
}
