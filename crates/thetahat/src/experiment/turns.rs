//! Estimations that take turns at the simulator: what several of them want simulated runs side by side.

use std::time::Instant;

use super::{
    chain::Problem,
    simulator::Simulator,
    wishes::{Output, Simulated, Wish, simulate_side_by_side},
};
use crate::{
    identification::{Convergence, Divisor, Estimation, Method, Outcome, idim_ls},
    simulation::{SimulatedMotion, SimulationError},
};

/// A method on a problem.
pub(crate) struct Attempt<'a> {
    pub(crate) problem: &'a Problem,
    pub(crate) method: Method,
    /// The weight of each row, where the method has any.
    pub(crate) weights: Option<Vec<f64>>,
    pub(crate) simulator: Option<Simulator<'a>>,
    /// Where IV and DIDIM start.
    pub(crate) start: Vec<f64>,
}

/// How an attempt ended.
pub(crate) struct Finished {
    pub(crate) outcome: Outcome,
    /// The motion of each recording simulated with the estimate, where it was asked for and succeeds.
    pub(crate) motions: Option<Vec<SimulatedMotion>>,
    /// Time spent on the estimate; simulations side by side share theirs in equal parts.
    pub(crate) seconds: f64,
}

/// How attempts are made.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Terms {
    pub(crate) divisor: Divisor,
    pub(crate) convergence: Convergence,
    /// Simulate with the estimate, too, at every so many samples of the window.
    pub(crate) motion_step: Option<usize>,
    pub(crate) threads: usize,
}

/// Simulations for each thread that run at a time: as many as a vector of most machines has lanes. More would wait, with
/// their motions in memory.
pub(crate) const SIDE_BY_SIDE: usize = 4;

enum Stage {
    Estimating(Estimation),
    Estimated(Outcome),
    Over,
}

/// Makes all attempts. `take` is given each, by its place, as soon as it is finished; `progress` is told how many
/// simulations are to be run next. The results do not depend on the attempts' company nor on the number of threads.
///
/// # Errors
/// What `take` refuses.
pub(crate) fn make<E>(
    attempts: &[Attempt<'_>],
    terms: Terms,
    progress: &mut dyn FnMut(usize),
    take: &mut dyn FnMut(usize, Finished) -> Result<(), E>,
) -> Result<(), E> {
    let mut turns: Vec<Turn<'_>> = attempts.iter().map(|attempt| Turn::new(attempt, terms)).collect();
    loop {
        for (k, turn) in turns.iter_mut().enumerate().filter(|(_, t)| t.wish().is_none()) {
            turn.end().map_or(Ok(()), |finished| take(k, finished))?;
        }
        let (waiting, wishes) = next_wishes(&turns, SIDE_BY_SIDE * terms.threads.max(1));
        if wishes.is_empty() {
            return Ok(());
        }
        progress(wishes.len());
        let started = Instant::now();
        let simulated = simulate_side_by_side(&wishes, terms.threads);
        let seconds = started.elapsed().as_secs_f64() / waiting.len() as f64;
        for (k, simulated) in waiting.into_iter().zip(simulated) {
            if let Some(finished) = turns[k].take(simulated, seconds) {
                take(k, finished)?;
            }
        }
    }
}

/// The first attempts that wait, and what they wish: no more different simulations than `most`, or those of one wish.
fn next_wishes<'a>(turns: &[Turn<'a>], most: usize) -> (Vec<usize>, Vec<Wish<'a>>) {
    let (mut waiting, mut wishes, mut simulations) = (Vec::new(), Vec::<Wish<'_>>::new(), 0);
    for (k, wish) in turns.iter().enumerate().filter_map(|(k, turn)| Some((k, turn.wish()?))) {
        let is_new = !wishes.iter().any(|other| wish.is_like(other));
        let with_it = simulations + if is_new { wish.simulator.recordings() } else { 0 };
        if wishes.is_empty() || with_it <= most {
            simulations = with_it;
            waiting.push(k);
            wishes.push(wish);
        }
    }
    (waiting, wishes)
}

/// An attempt under way.
struct Turn<'a> {
    attempt: &'a Attempt<'a>,
    terms: Terms,
    stage: Stage,
    seconds: f64,
}

impl<'a> Turn<'a> {
    fn new(attempt: &'a Attempt<'a>, terms: Terms) -> Self {
        let started = Instant::now();
        let Attempt { problem, method, weights, .. } = attempt;
        let stage = match (method, &attempt.simulator) {
            (Method::IdimIv | Method::Didim, Some(_)) => {
                Stage::Estimating(Estimation::new(*method, (terms.divisor, terms.convergence), attempt.start.clone()))
            }
            _ => Stage::Estimated(Outcome::direct(idim_ls(&problem.x, &problem.y, weights.as_deref(), terms.divisor))),
        };
        Self { attempt, terms, stage, seconds: started.elapsed().as_secs_f64() }
    }

    /// The simulation that it waits for.
    fn wish(&self) -> Option<Wish<'a>> {
        let simulator = self.attempt.simulator.as_ref()?;
        let (theta, output) = match &self.stage {
            Stage::Estimating(estimation) => (estimation.wanted()?, Output::Instruments),
            Stage::Estimated(outcome) => {
                (&outcome.fit.as_ref()?.theta[..], Output::Motion { step: self.terms.motion_step? })
            }
            Stage::Over => return None,
        };
        Some(Wish { simulator, theta: theta.to_vec(), output })
    }

    /// Takes what was simulated in `seconds`; how the attempt ended, where it has.
    fn take(&mut self, simulated: Result<Simulated, SimulationError>, seconds: f64) -> Option<Finished> {
        let z = match (&self.stage, simulated) {
            (Stage::Estimating(_), Ok(Simulated::Instruments(z))) => Ok(z),
            (Stage::Estimating(_), Err(error)) => Err(error),
            (_, Ok(Simulated::Motions(motions))) => {
                return self.end().map(|finished| Finished { motions: Some(motions), ..finished });
            }
            _ => return self.end(),
        };
        let started = Instant::now();
        if let Stage::Estimating(mut estimation) = std::mem::replace(&mut self.stage, Stage::Over) {
            let Problem { x, y, .. } = self.attempt.problem;
            estimation.take(z, (x, y), self.attempt.weights.as_deref());
            let goes_on = estimation.wanted().is_some();
            self.stage =
                if goes_on { Stage::Estimating(estimation) } else { Stage::Estimated(estimation.into_outcome()) };
        }
        self.seconds += seconds + started.elapsed().as_secs_f64();
        None
    }

    /// How the attempt ended, once.
    fn end(&mut self) -> Option<Finished> {
        match std::mem::replace(&mut self.stage, Stage::Over) {
            Stage::Estimating(estimation) => Some(estimation.into_outcome()),
            Stage::Estimated(outcome) => Some(outcome),
            Stage::Over => None,
        }
        .map(|outcome| Finished { outcome, motions: None, seconds: self.seconds })
    }
}
