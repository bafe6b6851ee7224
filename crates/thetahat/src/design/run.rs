//! The way of a design: limits, searches, verification, promise.

use super::{
    description::Design,
    error::DesignError,
    limits::JointLimits,
    motions::Motions,
    optimiser::Problem,
    promise::{Expected, ExpectedRecord},
    starts::{Searches, Start, sign_scales},
    sums::Derivatives,
    verified::Verified,
};
use crate::{
    base_parameters::BaseParameters,
    dynamics::{Model, Sign},
    preparation::Setup,
    results::{CollisionResults, DesignResults, LimitUse},
    scheduling::closed_loop,
    series::Series,
    simulation::{OutputGrid, Reference, SampledReference, SimulatorBias},
    trajectory::Moves,
};

/// A motion within its limits.
pub(super) struct Chosen {
    pub(super) motion: Derivatives,
    pub(super) torque: Series,
    pub(super) uses: Vec<LimitUse>,
    pub(super) starts: Vec<Start>,
    /// The moves, where the motion is made of such.
    pub(super) moves: Option<Moves>,
    /// Distances of shapes, where they are looked at.
    pub(super) collision: Option<CollisionResults>,
    /// The criterion if the last recording at hand were repeated.
    pub(super) repeated: Option<f64>,
}

impl Design {
    /// Searches the best motion, verifies its limits at 1 kHz, and promises what its record will tell.
    ///
    /// The result does not depend on the number of `threads`.
    ///
    /// # Errors
    /// [`DesignError`] where no motion within the limits shows every parameter, or a limit cannot hold.
    pub fn run(&self, threads: usize, progress: &mut dyn FnMut(&str)) -> Result<DesignResults, DesignError> {
        let limits = self.limits()?;
        let model = Model::new(&self.robot);
        let base = BaseParameters::with_fixed(&model, &self.settings.parameters.exclude, &self.settings.parameters.fix)
            .map_err(|source| DesignError::BaseParameters { path: self.path.clone(), source })?;
        progress("searching motions");
        let problem = self.problem(&model, &base, &limits)?;
        let chosen = self.choose(&model, &problem, &limits, threads)?;
        progress("promising intervals");
        let followed = self.followed(&model, &chosen.motion[0])?;
        let expected = match &followed {
            Some((q, tau)) => self.promise(q, tau, threads)?,
            None => self.promise(&chosen.motion[0], &chosen.torque, threads)?,
        };
        progress("looking for what would show more");
        let remedies = self.remedies(&problem, (&base, &limits), (&chosen.motion, &expected), threads);
        self.results(&model, &base, chosen, (&expected, &remedies))
    }

    /// The best motion of the searches that holds its limits.
    fn choose(
        &self,
        model: &Model,
        problem: &Problem,
        limits: &[JointLimits],
        threads: usize,
    ) -> Result<Chosen, DesignError> {
        let motion = &self.file.motion;
        let searches = Searches { count: motion.starts, seed: motion.seed, threads, sign_scales: sign_scales(limits) };
        let mut starts = searches.run(problem);
        starts.sort_by(|a, b| a.value.total_cmp(&b.value));
        let mut first_error = None;
        for k in 0..starts.len() {
            match self.repaired(model, problem, limits, &starts[k]) {
                Ok((x, Verified { uses, collision })) => {
                    // The one that is taken stands first.
                    starts[..=k].rotate_right(1);
                    let motion = self.sampled(&problem.watched, &x);
                    let torque = problem.loads.torques([&motion[0], &motion[1], &motion[2]], Sign::Exact);
                    let moves = problem.watched.moves(&x);
                    let repeated = self.repeated(problem)?;
                    return Ok(Chosen { motion, torque, uses, starts, moves, collision, repeated });
                }
                Err(error) => _ = first_error.get_or_insert(error),
            }
        }
        let (path, parameters) = (self.path.clone(), problem.information.parameters());
        let starts = self.file.motion.starts;
        Err(first_error.unwrap_or(DesignError::ShowsTooLittle { path, starts, parameters }))
    }

    /// The motion at the rate of the trajectory.
    pub(super) fn sampled(&self, motions: &Motions, x: &[f64]) -> Derivatives {
        let rate = self.file.sample_rate_hz;
        let count = (self.file.duration_s * rate).round() as usize;
        let grid: Vec<f64> = (0..=count).map(|k| (k as f64 / rate).min(self.file.duration_s)).collect();
        motions.on(x, &grid)
    }

    /// The motion that the robot makes in the closed loop, and its torques; none where no controller is described.
    fn followed(&self, model: &Model, q: &Series) -> Result<Option<(Series, Series)>, DesignError> {
        let Some(controller) = &self.settings.controller else { return Ok(None) };
        let theta = self.robot.a_priori_parameters();
        let rate = self.file.sample_rate_hz;
        let reference = Reference::Sampled(SampledReference::new(q.clone(), rate));
        let setup = Setup { robot: &self.robot, settings: &self.settings };
        let closed_loop = closed_loop(setup, model, controller, &reference, None, SimulatorBias::NONE);
        let inertia = closed_loop.motor_inertia(&theta, self.file.duration_s);
        let grid = OutputGrid { start_s: 0.0, sample_rate_hz: rate, samples: q.len() };
        let motion = closed_loop
            .simulate(&theta, &inertia, &grid)
            .map_err(|source| DesignError::Loop { path: self.path.clone(), source })?;
        Ok(Some((motion.q, motion.tau)))
    }

    fn promise(&self, q: &Series, tau: &Series, threads: usize) -> Result<Expected, DesignError> {
        let record = ExpectedRecord {
            robot: &self.robot,
            settings: &self.settings,
            sample_rate_hz: self.file.sample_rate_hz,
            q,
            tau,
            torque_noise: &self.noise.deviations,
            torque_spectrum: self.noise.spectrum.as_ref(),
            position_noise: &self.position_noise(),
        };
        record.promise(&self.path, self.file.motion.seed, threads)
    }
}
