//! The way of a design: limits, searches, verification, promise.

use super::{
    clearances::Clearances,
    description::Design,
    error::DesignError,
    limits::JointLimits,
    loads::Loads,
    motions::Motions,
    optimiser::Problem,
    promise::{Expected, ExpectedRecord},
    starts::{Searches, Start},
    sums::Derivatives,
    verification::{RATE_HZ, uses},
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

/// Velocity scales of the sign in the search, as parts of the median of the velocity limits.
const SIGN_SCALES: [f64; 2] = [0.02, 0.005];

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
        let chosen = self.choose(&model, &base, &limits, threads)?;
        progress("promising intervals");
        let [q, dq, ddq, _] = &chosen.motion;
        let record = self.expected_motion(&model, q, dq, ddq)?;
        let expected = self.promise(&record, threads)?;
        self.results(&model, &base, chosen, &expected)
    }

    /// The best motion of the searches that holds its limits.
    fn choose(
        &self,
        model: &Model,
        base: &BaseParameters,
        limits: &[JointLimits],
        threads: usize,
    ) -> Result<Chosen, DesignError> {
        let problem = self.problem(model, base, limits)?;
        let motion = &self.file.motion;
        let searches = Searches { count: motion.starts, seed: motion.seed, threads, sign_scales: sign_scales(limits) };
        let mut starts = searches.run(&problem);
        starts.sort_by(|a, b| a.value.total_cmp(&b.value));
        let (mut first_violated, mut first_near) = (None, None);
        for start in &starts {
            let (motion, torque, uses) = self.verify(model, &problem, limits, &start.x);
            match uses.iter().max_by(|a, b| a.part.total_cmp(&b.part)).filter(|worst| worst.part > 1.0) {
                None => {
                    let collision = self.collision(model, &motion[0])?;
                    if let Some(error) = collision.as_ref().and_then(|c| self.too_near(c)) {
                        first_near.get_or_insert(error);
                        continue;
                    }
                    let motion = self.sampled(&problem.watched, &start.x, motion);
                    let (torque, moves) = (self.torques(model, &motion, torque), problem.watched.moves(&start.x));
                    let repeated = self.repeated(&problem)?;
                    return Ok(Chosen { motion, torque, uses, starts, moves, collision, repeated });
                }
                Some(worst) => _ = first_violated.get_or_insert_with(|| worst.clone()),
            }
        }
        if let Some(near) = first_near {
            return Err(near);
        }
        Err(match first_violated {
            Some(worst) => self.infeasible(&worst),
            None => {
                let (path, parameters) = (self.path.clone(), base.len());
                DesignError::ShowsTooLittle { path, starts: self.file.motion.starts, parameters }
            }
        })
    }

    /// The distances of a motion at 1 kHz, and of the way from home.
    fn collision(&self, model: &Model, q: &Series) -> Result<Option<CollisionResults>, DesignError> {
        let (Some(options), Some(surroundings)) = (&self.file.collision, self.surroundings(model)?) else {
            return Ok(None);
        };
        let clearances = Clearances { scene: surroundings.scene, margin: 1e-3 * options.margin };
        Ok(Some(clearances.results(q, RATE_HZ, self.home_posture().as_deref(), &surroundings.uncovered)))
    }

    /// Why distances are too small.
    fn too_near(&self, collision: &CollisionResults) -> Option<DesignError> {
        let nearest = collision.pairs.first().filter(|pair| pair.distance < collision.margin)?;
        Some(DesignError::TooNear {
            path: self.path.clone(),
            first: nearest.first.clone(),
            second: nearest.second.clone(),
            distance_mm: 1e3 * nearest.distance,
            margin_mm: 1e3 * collision.margin,
            when: nearest.at_s.map_or_else(|| "on the way from home".to_owned(), |at| format!("at {at:.3} s")),
        })
    }

    fn infeasible(&self, worst: &LimitUse) -> DesignError {
        let [lower, upper] = worst.reached;
        let is_lower = (worst.limit[0] - lower) > (upper - worst.limit[1]);
        let (limit, needed) = if is_lower { (worst.limit[0], lower) } else { (worst.limit[1], upper) };
        DesignError::Infeasible {
            path: self.path.clone(),
            joint: worst.joint.clone(),
            quantity: worst.quantity,
            limit,
            needed,
            at_s: worst.at_s,
            remedy: "raise it, check the robot's a-priori parameters and friction, or choose another [motion] start",
        }
    }

    /// The motion at 1 kHz with its torques, and how far it uses the limits.
    fn verify(
        &self,
        model: &Model,
        problem: &Problem,
        limits: &[JointLimits],
        x: &[f64],
    ) -> (Derivatives, Series, Vec<LimitUse>) {
        let count = (self.file.duration_s * RATE_HZ).ceil() as usize;
        let grid: Vec<f64> = (0..=count).map(|k| (k as f64 / RATE_HZ).min(self.file.duration_s)).collect();
        let motion = problem.watched.on(x, &grid);
        let loads = Loads::new(model, &self.robot.a_priori_parameters(), limits.to_vec());
        let torque = loads.torques([&motion[0], &motion[1], &motion[2]], Sign::Exact);
        let uses = uses(limits, &motion, &torque);
        (motion, torque, uses)
    }

    /// The motion at the rate of the trajectory; that at 1 kHz where this is the rate.
    fn sampled(&self, motions: &Motions, x: &[f64], at_1_khz: Derivatives) -> Derivatives {
        let rate = self.file.sample_rate_hz;
        if rate == RATE_HZ {
            return at_1_khz;
        }
        let count = (self.file.duration_s * rate).round() as usize;
        let grid: Vec<f64> = (0..=count).map(|k| (k as f64 / rate).min(self.file.duration_s)).collect();
        motions.on(x, &grid)
    }

    fn torques(&self, model: &Model, motion: &Derivatives, at_1_khz: Series) -> Series {
        if motion[0].len() == at_1_khz.len() {
            return at_1_khz;
        }
        let loads = Loads::new(model, &self.robot.a_priori_parameters(), Vec::new());
        loads.torques([&motion[0], &motion[1], &motion[2]], Sign::Exact)
    }

    /// The motion that the robot will make and its torques: that of the closed loop where its controller is known.
    pub(super) fn expected_motion(
        &self,
        model: &Model,
        q: &Series,
        dq: &Series,
        ddq: &Series,
    ) -> Result<(Series, Series), DesignError> {
        let theta = self.robot.a_priori_parameters();
        let Some(controller) = &self.settings.controller else {
            let loads = Loads::new(model, &theta, Vec::new());
            return Ok((q.clone(), loads.torques([q, dq, ddq], Sign::Exact)));
        };
        let rate = self.file.sample_rate_hz;
        let reference = Reference::Sampled(SampledReference::new(q.clone(), rate));
        let setup = Setup { robot: &self.robot, settings: &self.settings };
        let closed_loop = closed_loop(setup, model, controller, &reference, None, SimulatorBias::NONE);
        let inertia = closed_loop.motor_inertia(&theta, self.file.duration_s);
        let grid = OutputGrid { start_s: 0.0, sample_rate_hz: rate, samples: q.len() };
        let motion = closed_loop
            .simulate(&theta, &inertia, &grid)
            .map_err(|source| DesignError::Loop { path: self.path.clone(), source })?;
        Ok((motion.q, motion.tau))
    }

    fn promise(&self, (q, tau): &(Series, Series), threads: usize) -> Result<Expected, DesignError> {
        let torque_noise = self.file.noise.torque.to_list(q.channels());
        let record = ExpectedRecord {
            robot: &self.robot,
            settings: &self.settings,
            sample_rate_hz: self.file.sample_rate_hz,
            q,
            tau,
            torque_noise: &torque_noise,
            position_noise: &self.position_noise(),
        };
        record.promise(&self.path, self.file.motion.seed, threads)
    }
}

/// Wide velocity scales first.
fn sign_scales(limits: &[JointLimits]) -> [f64; 2] {
    let mut velocities: Vec<f64> = limits.iter().map(|l| l.velocity).collect();
    velocities.sort_by(f64::total_cmp);
    let median = velocities[velocities.len() / 2];
    SIGN_SCALES.map(|part| part * median)
}
