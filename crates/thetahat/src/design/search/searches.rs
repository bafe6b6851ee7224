//! Several searches of a motion: each by descents from random motions, then from combinations of the motions that were found.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use crate::design::{
    limits::joint_limits::JointLimits,
    motions::{family::Motions, sums::Sums},
    search::{
        crossing::crossed,
        optimiser::{OptimiserResult, Problem},
        starts::{best_of_random, kicked},
        watch::Descents,
    },
};
use thetahat_ground::pool::in_parallel;
use thetahat_model::dynamics::Sign;

/// Gain of the last step of a descent, nats: with the wide sign, and of the last with the tight one.
const COARSE: f64 = 0.5;
const FINE: f64 = 0.01;

/// Velocity scales of the sign in the search: the wide one as a part of the median of the velocity limits, the tight one of
/// the smallest.
const SIGN_SCALES: [f64; 2] = [0.02, 0.005];

/// How several searches are made.
#[derive(Debug, Clone)]
pub(in crate::design) struct Searches {
    pub(in crate::design) count: usize,
    pub(in crate::design) seed: u64,
    pub(in crate::design) threads: usize,
    /// Velocity scales of the regularised sign: a wide one, then a tight one.
    pub(in crate::design) sign_scales: [f64; 2],
}

/// A search that ended, with the criterion of its motion.
#[derive(Debug, Clone)]
pub(in crate::design) struct Start {
    pub(in crate::design) x: Vec<f64>,
    pub(in crate::design) first_value: f64,
    pub(in crate::design) value: f64,
    pub(in crate::design) steps: usize,
}

/// How often searches of sums exchange their motions, and how many combinations each tries then.
const EXCHANGES: usize = 8;
const CHILDREN: usize = 2;

/// The descents with which a search begins.
struct Beginning {
    /// From random motions: the search continues with the best.
    random: usize,
    /// From the best motion, perturbed by random numbers.
    kicks: usize,
}

impl Beginning {
    /// Searches of moves do not exchange: the widths of moves belong to all joints together.
    const fn of(motions: &Motions) -> Self {
        match motions {
            Motions::Sums { .. } => Self { random: 2, kicks: 2 },
            Motions::Moves { .. } => Self { random: 3, kicks: 5 },
        }
    }
}

/// A search that is not finished.
#[derive(Clone)]
struct Search {
    rng: ChaCha8Rng,
    best: DescentEnd,
    /// Its own combined motions.
    children: Vec<Vec<f64>>,
}

impl Searches {
    /// The descents of all searches on a problem.
    pub(in crate::design) fn descents(&self, problem: &Problem) -> usize {
        let Beginning { random, kicks } = Beginning::of(&problem.watched);
        let crossed = match problem.watched {
            Motions::Sums { .. } => EXCHANGES * CHILDREN,
            Motions::Moves { .. } => 0,
        };
        self.count * (random + kicks + crossed + 1)
    }

    /// Every search that found a motion; the result does not depend on the number of threads. Searches that are stopped end with the best
    /// motion of all.
    pub(in crate::design) fn run(&self, problem: &Problem, descents: &Descents<'_>) -> Vec<Start> {
        let begun = in_parallel(self.count, self.threads, |number| self.begin(problem, number, descents));
        let mut searches: Vec<Search> = begun.into_iter().flatten().collect();
        if let Motions::Sums { family, .. } = &problem.watched {
            for _ in 0..EXCHANGES {
                let bests: Vec<Vec<f64>> = searches.iter().map(|search| search.best.found.x.clone()).collect();
                let exchange = |number: usize| self.cross((problem, family), &searches[number], &bests, descents);
                searches = in_parallel(searches.len(), self.threads, exchange);
            }
        }
        if descents.is_stopped() {
            searches.sort_by(|a, b| a.best.merit.total_cmp(&b.best.merit));
            searches.truncate(1);
        }
        let ends = in_parallel(searches.len(), self.threads, |number| {
            let end = self.end(problem, &searches[number].best);
            descents.ended(end.as_ref().map(|start| start.value));
            end
        });
        ends.into_iter().flatten().collect()
    }

    fn wide(&self) -> Sign {
        Sign::smooth(self.sign_scales[0])
    }

    fn tight(&self) -> Sign {
        Sign::smooth(self.sign_scales[1])
    }

    /// Descents from random motions, and from the best motion found, perturbed by random numbers.
    fn begin(&self, problem: &Problem, number: usize, descents: &Descents<'_>) -> Option<Search> {
        let Beginning { random, kicks } = Beginning::of(&problem.watched);
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed);
        rng.set_stream(number as u64);
        let mut best: Option<DescentEnd> = None;
        for descent in 0..random + kicks {
            // The first search ends one descent whenever it is stopped.
            if descents.is_stopped() && (best.is_some() || number > 0) {
                break;
            }
            let (start, first_value) = match &best {
                Some(best) if descent >= random => (kicked(problem, &best.found.x, &mut rng), best.first_value),
                None if descent >= random => return None,
                Some(_) | None => match best_of_random(problem, &mut rng, self.tight()) {
                    Some(random) => random,
                    None => continue,
                },
            };
            let end = DescentEnd::from(problem, start, self.wide(), first_value);
            descents.ended(end.as_ref().map(|end| end.merit));
            best = best.into_iter().chain(end).reduce(DescentEnd::or_better);
        }
        Some(Search { rng, best: best?, children: Vec::new() })
    }

    /// Descents from combinations of the joints' motions in `bests` and in the search's own.
    fn cross(
        &self,
        (problem, family): (&Problem, &Sums),
        search: &Search,
        bests: &[Vec<f64>],
        descents: &Descents<'_>,
    ) -> Search {
        let Search { mut rng, mut best, mut children } = search.clone();
        for _ in 0..CHILDREN {
            if descents.is_stopped() {
                break;
            }
            let pool: Vec<Vec<f64>> = bests.iter().chain(&children).cloned().collect();
            let child = crossed(problem, family, &best.found.x, &pool, self.wide(), &mut rng);
            let from = |child| DescentEnd::from(problem, child, self.wide(), best.first_value);
            let other = child.and_then(from);
            descents.ended(other.as_ref().map(|other| other.merit));
            if let Some(other) = other {
                children.push(other.found.x.clone());
                best = best.or_better(other);
            }
        }
        Search { rng, best, children }
    }

    /// The last descent, with the tight sign.
    fn end(&self, problem: &Problem, best: &DescentEnd) -> Option<Start> {
        let OptimiserResult { x, steps } = problem.optimise(best.found.x.clone(), self.tight(), FINE)?;
        let value = problem.value(&x, self.tight())?;
        Some(Start { value, x, first_value: best.first_value, steps: best.found.steps + steps })
    }
}

/// The end of one descent.
#[derive(Clone)]
struct DescentEnd {
    found: OptimiserResult,
    /// The criterion plus the price of violated limits.
    merit: f64,
    /// The criterion of the random motion that it comes from.
    first_value: f64,
}

impl DescentEnd {
    fn from(problem: &Problem, start: Vec<f64>, sign: Sign, first_value: f64) -> Option<Self> {
        let found = problem.optimise(start, sign, COARSE)?;
        Some(Self { merit: problem.merit(&found.x, sign)?, found, first_value })
    }

    /// The better of both, with the steps of both.
    fn or_better(self, other: Self) -> Self {
        let steps = self.found.steps + other.found.steps;
        let better = if other.merit < self.merit { other } else { self };
        Self { found: OptimiserResult { steps, ..better.found }, ..better }
    }
}

/// The wide velocity scale, from the median joint, then the tight one, which the slowest joint needs. Revolute and prismatic joints
/// share both.
pub(in crate::design) fn sign_scales(limits: &[JointLimits]) -> [f64; 2] {
    let mut velocities: Vec<f64> = limits.iter().map(|l| l.velocity).collect();
    velocities.sort_by(f64::total_cmp);
    let [wide, tight] = SIGN_SCALES;
    [wide * velocities[velocities.len() / 2], tight * velocities[0]]
}
