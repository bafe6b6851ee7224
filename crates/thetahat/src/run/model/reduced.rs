//! The model from triangular factors alone.

use super::{
    beliefs::beliefs,
    between::Between,
    candidates::{kinds, transitions, weights},
    causes::FoundCauses,
    choice::{Choosing, SearchedLaws},
    columns::ModelColumns,
    intervals::Intervals,
    joints::Covered,
    law::Law,
    law_factors::{LawFactors, ModelData},
    result::FittedLaw,
    transition::Refinement,
};
use crate::preparation::{Problem, Setup};
use thetahat_ground::{clock::Stopwatch, pool::available_threads};
use thetahat_model::{base_parameters::BaseParameters, consistency::ConsistentSet, dynamics::FrictionTransition};
use thetahat_report::results::{ModelResult, RunResult};

/// The model of the robot as described, or why there is none; `truth` holds the true base parameters of twins. What only samples show
/// is not examined: the causes of its error, and torque terms for them.
pub(in crate::run) fn model_of_factors(
    (setup, problem): (Setup<'_>, &Problem),
    data: &ModelData,
    truth: Option<Vec<f64>>,
    runs: &[RunResult],
) -> Result<ModelResult, String> {
    let stopwatch = Stopwatch::start();
    let set = problem.consistent_set(setup).map_err(ToString::to_string)?;
    let (factors, base, columns) = (data.laws(), &problem.base, &data.columns);
    let mean_position = data.recordings.first().map_or(&[][..], |(_, first)| &first.mean_position);
    let beliefs = beliefs(setup, problem, (&factors[0], mean_position), set);
    let set = &set.clone().with_beliefs(beliefs).map_err(|e| e.to_string())?;
    let described = Described { set, base, columns };
    let transitions = transitions(setup);
    let mut laws: Vec<Law> = factors.iter().zip(&transitions).map(|(factors, v)| described.law(factors, *v)).collect();
    let (weights, kinds, folds) = (weights(setup), kinds(setup), data.folds());
    let choose = |laws: &[Law], found: SearchedLaws| {
        let choosing = Choosing { laws, weights: &weights, folds, kinds: &kinds };
        choosing.choose(available_threads(), found).ok_or("the rows determine no physically consistent robot")
    };
    let between = |at: FrictionTransition| Between { transitions: &transitions, kinds: &kinds, at };
    let mut choice = choose(&laws, SearchedLaws::default())?;
    let mut refinement = Refinement::of(laws.iter().copied(), &choice);
    let mut refined = None;
    while let Some(transition) = refinement.next() {
        let found = data.law(&between(transition).weights());
        if refinement.add(&described.law(&found, transition)) {
            refined = Some((found, transition));
        }
    }
    if let Some((factors, transition)) = &refined {
        laws.push(described.law(factors, *transition));
        choice = choose(&laws, choice.found)?;
    }
    let Law { transition, factors, .. } = laws[choice.law];
    let settled = data.settled(&between(transition), &choice.deviations);
    let fitted = FittedLaw { setup, base, set, terms: &[], transition, factors, truth };
    let model = fitted.result(
        &choice,
        FoundCauses::default(),
        &Intervals::of_stretches(&settled, runs),
        &Covered::of_factors(data),
    );
    Ok(ModelResult { seconds: stopwatch.seconds(), ..model })
}

/// The robot as described.
struct Described<'a> {
    set: &'a ConsistentSet,
    base: &'a BaseParameters,
    columns: &'a ModelColumns,
}

impl Described<'_> {
    fn law<'a>(&'a self, factors: &'a LawFactors, transition: FrictionTransition) -> Law<'a> {
        let Self { set, base, columns } = *self;
        Law { set, base, columns, factors, rows: None, transition, terms: &[] }
    }
}
