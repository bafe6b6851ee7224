//! The optimisation problem of a design: criterion, grids, limits, prior information.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::design::{
    error::DesignError,
    limits::{clearances::Clearances, constraints::Constraints, joint_limits::JointLimits, loads::Loads},
    motions::{
        basis::Basis,
        family::Motions,
        moves::{MoveFamily, Sweep},
        sums::Sums,
    },
    search::{
        criterion::{Criterion, CriterionName},
        information::Information,
        optimiser::Problem,
    },
    text::{description::Design, options::MotionKind},
};
use thetahat_ground::series::Series;
use thetahat_model::{
    base_parameters::BaseParameters,
    dynamics::{Model, Sign},
};
use thetahat_report::results::Limited;

/// Instants of the information for each harmonic or two splines, and at least as many in all.
const INSTANTS: usize = 30;
const FEWEST_INSTANTS: usize = 200;
/// Instants at which limits are checked, likewise.
const WATCHED: usize = 60;
/// Added to the margin of distances in the search, m.
const BETWEEN: f64 = 0.004;
/// Random states that give parameters of different dimensions a common unit.
const RANDOM_STATES: usize = 500;

impl Design {
    /// The criterion's problem for the robot within limits.
    pub(in crate::design) fn problem(
        &self,
        model: &Model,
        base: &BaseParameters,
        limits: &[JointLimits],
    ) -> Result<Problem, DesignError> {
        let file = &self.file;
        let kept = self.kept(limits);
        let [summed, watched] = match file.motion.kind {
            MotionKind::Fourier => {
                self.sums(&kept, Basis::fourier(self.period_s(), file.motion.harmonics(file.duration_s)))
            }
            MotionKind::Splines => self.sums(&kept, Basis::splines(self.period_s(), file.motion.splines())),
            MotionKind::Moves => self.moves(model, &kept)?,
        };
        let swept = summed.move_family().and_then(|family| self.information_of_sweeps(model, base, family));
        let noise = &self.noise.deviations;
        Ok(Problem {
            criterion: self.criterion(model, base)?,
            information: Information::new(model, &base.columns(), noise)
                .with_prior(self.prior(base, noise)?)
                .with_sweeps(swept),
            sample_rate_hz: file.sample_rate_hz,
            constraints: Constraints::new(kept.clone(), &watched),
            clearances: self.clearances_in_reach(model, &kept)?,
            loads: Loads::new(model, &self.possible_robots(model)?, kept),
            summed,
            watched,
        })
    }

    /// The distances that the search keeps: more than the margin, for what lies between the watched instants.
    pub(in crate::design) fn clearances(&self, model: &Model) -> Result<Option<Clearances>, DesignError> {
        let Some(surroundings) = self.surroundings(model)? else { return Ok(None) };
        let margin = self.file.collision.as_ref().map_or(0.0, |options| 1e-3 * options.margin);
        Ok(Some(Clearances { scene: surroundings.scene, margin: margin + BETWEEN }))
    }

    /// The same, where every pair is far enough apart at some posture within the limits: no search can part the others.
    fn clearances_in_reach(&self, model: &Model, kept: &[JointLimits]) -> Result<Option<Clearances>, DesignError> {
        let clearances = self.clearances(model)?;
        let Some((pair, furthest)) = clearances.as_ref().and_then(|c| c.never_apart(kept)) else {
            return Ok(clearances);
        };
        let [first, second] = clearances.as_ref().map_or(["", ""], |c| c.scene.names(pair)).map(str::to_owned);
        Err(DesignError::NeverApart {
            path: self.path.clone(),
            first,
            second,
            furthest_mm: 1e3 * furthest,
            margin_mm: self.file.collision.as_ref().map_or(0.0, |options| options.margin),
        })
    }

    fn periods(&self) -> usize {
        self.file.motion.periods(self.file.duration_s)
    }

    /// The time in which a motion of sums is made once, s.
    pub(in crate::design) fn period_s(&self) -> f64 {
        self.file.duration_s / self.periods() as f64
    }

    /// Sums of functions, at the instants of the information and at those of the limits in one period.
    fn sums(&self, kept: &[JointLimits], basis: Basis) -> [Motions; 2] {
        let (period_s, harmonics) = (self.period_s(), basis.functions().div_ceil(2));
        let reach: Vec<[f64; 3]> =
            kept.iter().map(|l| [0.5 * (l.upper - l.lower), l.velocity, l.acceleration]).collect();
        let start = self.start_posture();
        let centre = start.clone().unwrap_or_else(|| kept.iter().map(JointLimits::middle).collect());
        let family = Sums::new(basis, centre, start.is_none(), &reach).repeated(self.periods());
        [(INSTANTS * harmonics).max(FEWEST_INSTANTS), WATCHED * harmonics].map(|count| {
            let grid: Vec<f64> = (0..count).map(|k| period_s * (k as f64 + 0.5) / count as f64).collect();
            Motions::Sums { sampled: family.sampled(&grid), family: family.clone() }
        })
    }

    /// Moves, at the points of the information and at those of the limits.
    fn moves(&self, model: &Model, kept: &[JointLimits]) -> Result<[Motions; 2], DesignError> {
        let family = self.move_family(kept, self.sweeps(model, kept)?);
        Ok([family.summed(), family.watched()].map(|points| Motions::Moves { family: family.clone(), points }))
    }

    /// Moves in the time that the sweeps leave.
    pub(in crate::design) fn move_family(&self, kept: &[JointLimits], sweeps: Vec<Sweep>) -> MoveFamily {
        let motion = &self.file.motion;
        let family = MoveFamily {
            limits: kept.to_vec(),
            start: self.start_posture(),
            moves: motion.moves(),
            duration_s: self.file.duration_s,
            smoothing_s: motion.smoothing_s(self.file.duration_s),
            rest_s: motion.rest_s(),
            sweeps,
        };
        MoveFamily { duration_s: self.file.duration_s - family.sweeps_s(), ..family }
    }

    /// The criterion of the design, for the base parameters.
    fn criterion(&self, model: &Model, base: &BaseParameters) -> Result<Criterion, DesignError> {
        let wanted = &self.file.wanted;
        let selected = base
            .select(model.parameter_table(), &wanted.parameters)
            .map_err(|source| DesignError::BaseParameters { path: self.path.clone(), source })?;
        let columns = base.columns();
        let place = |kept: usize| columns.iter().position(|c| *c == kept);
        Ok(match wanted.criterion {
            CriterionName::D => Criterion::D,
            CriterionName::A => Criterion::A { weights: self.units(model, base)? },
            CriterionName::Worst => Criterion::Worst { weights: self.units(model, base)? },
            CriterionName::Torque => {
                let missing = || self.value("[wanted] motion", "the motion whose torques are wanted", "missing");
                Criterion::Torque { of_motion: self.wanted_torques(model, base)?.ok_or_else(missing)?.squares }
            }
            CriterionName::SelectedParameters => {
                Criterion::SelectedParameters { columns: selected.columns().into_iter().filter_map(place).collect() }
            }
        })
    }

    /// One over the squared unit of each parameter: that which changes the torques at random postures and velocities within
    /// the limits by the noise, in the root mean square.
    fn units(&self, model: &Model, base: &BaseParameters) -> Result<Vec<f64>, DesignError> {
        let limits = self.limits()?;
        let information = Information::new(model, &base.columns(), &self.noise.deviations);
        let motion = random_states(&limits, self.file.motion.seed);
        let m = information.of(motion.each_ref(), 1.0 / RANDOM_STATES as f64, Sign::Exact);
        Ok((0..base.len()).map(|i| m.at(i, i)).collect())
    }
}

/// Positions, velocities and accelerations within the limits, each evenly.
fn random_states(limits: &[JointLimits], seed: u64) -> [Series; 3] {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    [Limited::Position, Limited::Velocity, Limited::Acceleration].map(|limited| {
        let mut states = Series::zeros(RANDOM_STATES, limits.len());
        for k in 0..RANDOM_STATES {
            for (value, limits) in states.sample_mut(k).iter_mut().zip(limits) {
                let [lower, upper] = limits.range(limited).unwrap_or([-1.0, 1.0]);
                *value = rng.random_range(lower..upper);
            }
        }
        states
    })
}
