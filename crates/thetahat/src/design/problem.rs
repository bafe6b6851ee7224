//! The problem that a design poses to its searches: criterion, grids, limits, what earlier recordings tell.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::{
    constraints::Constraints,
    criterion::{Criterion, CriterionName},
    description::Design,
    error::DesignError,
    family::Family,
    fourier::FourierBasis,
    information::Information,
    limits::{JointLimits, Limited},
    loads::Loads,
    optimiser::Problem,
};
use crate::{
    base_parameters::BaseParameters,
    dynamics::{Model, Sign},
    linear_algebra::Matrix,
    reduction::Reduction,
    series::Series,
};

/// Instants of the information for each harmonic, and at least as many in all.
const INSTANTS: usize = 30;
const FEWEST_INSTANTS: usize = 200;
/// Instants at which limits are looked at, for each harmonic.
const WATCHED: usize = 60;
/// Least part of every range that the search leaves unused, for what lies between the watched instants.
const LEAST_MARGIN: f64 = 0.002;
/// Random states by which parameters of different units are compared.
const RANDOM_STATES: usize = 500;

impl Design {
    /// The criterion's problem for the robot within limits.
    pub(super) fn problem(
        &self,
        model: &Model,
        base: &BaseParameters,
        limits: &[JointLimits],
    ) -> Result<Problem, DesignError> {
        let file = &self.file;
        let kept: Vec<JointLimits> = limits.iter().map(|l| l.less(file.limits.margin.max(LEAST_MARGIN))).collect();
        let reach: Vec<[f64; 3]> =
            kept.iter().map(|l| [0.5 * (l.upper - l.lower), l.velocity, l.acceleration]).collect();
        let start = self.start_posture();
        let centre = start.clone().unwrap_or_else(|| kept.iter().map(JointLimits::middle).collect());
        let basis = FourierBasis::new(file.duration_s, file.motion.harmonics);
        let family = Family::new(basis, centre, start.is_none(), &reach);
        let grid = |count: usize| -> Vec<f64> {
            (0..count).map(|k| file.duration_s * (k as f64 + 0.5) / count as f64).collect()
        };
        let noise = file.noise.torque.to_list(limits.len());
        let information = Information::new(model, &base.columns(), &noise).with_prior(self.prior(base, &noise)?);
        let instants = (INSTANTS * file.motion.harmonics).max(FEWEST_INSTANTS);
        Ok(Problem {
            criterion: self.criterion(model, base)?,
            sampled: family.sampled(&grid(instants)),
            share: file.duration_s * file.sample_rate_hz / instants as f64,
            constraints: Constraints::new(kept.clone(), family.sampled(&grid(WATCHED * file.motion.harmonics))),
            loads: Loads::new(model, &self.robot.a_priori_parameters(), kept),
            information,
            family,
        })
    }

    /// What the recordings at hand tell of the base parameters.
    fn prior(&self, base: &BaseParameters, noise: &[f64]) -> Result<Option<Matrix>, DesignError> {
        if self.file.prior.is_empty() {
            return Ok(None);
        }
        let reduction = Reduction::read_all(&self.prior_files())?;
        if !reduction.identity.is_of(&self.robot, base) {
            return Err(DesignError::OtherRobot { path: self.path.clone() });
        }
        Ok(Some(reduction.information(noise)?))
    }

    /// The criterion that is wanted, of the base parameters.
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
            CriterionName::Chosen => {
                Criterion::Chosen { columns: selected.columns().into_iter().filter_map(place).collect() }
            }
        })
    }

    /// One over the squared unit of each parameter: that which changes the torques at random postures and velocities within
    /// the limits by the noise, in the root mean square.
    fn units(&self, model: &Model, base: &BaseParameters) -> Result<Vec<f64>, DesignError> {
        let limits = self.limits()?;
        let noise = self.file.noise.torque.to_list(limits.len());
        let information = Information::new(model, &base.columns(), &noise);
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
