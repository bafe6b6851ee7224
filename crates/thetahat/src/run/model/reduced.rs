//! The model from triangular factors alone.

use super::{
    beliefs::beliefs,
    candidates::{kinds, transitions, weights},
    causes::FoundCauses,
    choice::{Choosing, SearchedLaws},
    intervals::Intervals,
    joints::Covered,
    law::Law,
    law_factors::ModelData,
    result::FittedLaw,
};
use crate::preparation::{Problem, Setup};
use thetahat_ground::{clock::Stopwatch, pool::available_threads};
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
    let law = |(factors, transition)| Law { set, base, columns, factors, rows: None, transition, terms: &[] };
    let transitions = transitions(setup);
    let laws: Vec<Law> = factors.iter().zip(transitions.iter().copied()).map(law).collect();
    let (weights, kinds) = (weights(setup), kinds(setup));
    let choosing = Choosing { laws: &laws, weights: &weights, folds: data.folds(), kinds: &kinds };
    let choice = choosing.choose(available_threads(), SearchedLaws::default());
    let choice = choice.ok_or("the rows determine no physically consistent robot")?;
    let Law { transition, factors, .. } = laws[choice.law];
    let settled = data.settled(choice.law, &transitions, &choice.deviations);
    let fitted = FittedLaw { setup, base, set, terms: &[], transition, factors, truth };
    let model = fitted.result(
        &choice,
        FoundCauses::default(),
        &Intervals::of_stretches(&settled, runs),
        &Covered::of_factors(data),
    );
    Ok(ModelResult { seconds: stopwatch.seconds(), ..model })
}
