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

/// Times that a motion descends again where it misses a limit at 1 kHz, and the gain of the last step of each, nats.
const REPAIRS: usize = 3;
const REPAIR_GAIN: f64 = 0.05;

/// A motion at 1 kHz.
struct Verified {
    motion: Derivatives,
    torque: Series,
    uses: Vec<LimitUse>,
    collision: Option<CollisionResults>,
}

impl Verified {
    fn worst(&self) -> Option<&LimitUse> {
        self.uses.iter().max_by(|a, b| a.part.total_cmp(&b.part))
    }

    /// The part of a limit by which it is exceeded, and the distance that is missing, m; below zero where there is none.
    fn violation(&self) -> (f64, f64) {
        let over = self.worst().map_or(-1.0, |worst| worst.part - 1.0);
        let nearest = self.collision.as_ref().and_then(|c| Some(c.margin - c.pairs.first()?.distance));
        (over, nearest.unwrap_or(-1.0))
    }
}

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
        let mut first_error = None;
        for k in 0..starts.len() {
            match self.repaired(model, &problem, limits, &starts[k]) {
                Ok((x, Verified { motion, torque, uses, collision })) => {
                    // The one that is taken stands first.
                    starts[..=k].rotate_right(1);
                    let motion = self.sampled(&problem.watched, &x, motion);
                    let (torque, moves) = (self.torques(model, &motion, torque), problem.watched.moves(&x));
                    let repeated = self.repeated(&problem)?;
                    return Ok(Chosen { motion, torque, uses, starts, moves, collision, repeated });
                }
                Err(error) => _ = first_error.get_or_insert(error),
            }
        }
        let (path, parameters) = (self.path.clone(), base.len());
        let starts = self.file.motion.starts;
        Err(first_error.unwrap_or(DesignError::ShowsTooLittle { path, starts, parameters }))
    }

    /// The motion of a search with what it needs at 1 kHz. Where it misses a limit or a distance between the instants that
    /// were watched, it descends again within limits that are as much tighter.
    fn repaired(
        &self,
        model: &Model,
        problem: &Problem,
        limits: &[JointLimits],
        start: &Start,
    ) -> Result<(Vec<f64>, Verified), DesignError> {
        let [_, scale] = sign_scales(limits);
        let (mut tight, mut x) = (problem.clone(), start.x.clone());
        let mut verified = self.verify(model, &problem.watched, limits, &x)?;
        for _ in 0..REPAIRS {
            let (over, missing) = verified.violation();
            if over <= 0.0 && missing <= 0.0 {
                break;
            }
            tight.tighten(1.2 * over.max(0.0), 1.2 * missing.max(0.0));
            let Some(found) = tight.optimise(x.clone(), Sign::Smooth { scale }, REPAIR_GAIN) else { break };
            x = found.x;
            verified = self.verify(model, &problem.watched, limits, &x)?;
        }
        match self.error_of(&verified) {
            Some(error) => Err(error),
            None => Ok((x, verified)),
        }
    }

    /// Why a motion cannot be taken.
    fn error_of(&self, verified: &Verified) -> Option<DesignError> {
        let worst = verified.worst().filter(|worst| worst.part > 1.0);
        let error = worst.map(|worst| self.infeasible(worst));
        error.or_else(|| verified.collision.as_ref().and_then(|collision| self.too_near(collision)))
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

    /// The motion at 1 kHz with its torques, how far it uses the limits, and distances.
    fn verify(
        &self,
        model: &Model,
        motions: &Motions,
        limits: &[JointLimits],
        x: &[f64],
    ) -> Result<Verified, DesignError> {
        let count = (self.file.duration_s * RATE_HZ).ceil() as usize;
        let grid: Vec<f64> = (0..=count).map(|k| (k as f64 / RATE_HZ).min(self.file.duration_s)).collect();
        let motion = motions.on(x, &grid);
        let loads = Loads::new(model, &self.robot.a_priori_parameters(), limits.to_vec());
        let torque = loads.torques([&motion[0], &motion[1], &motion[2]], Sign::Exact);
        let (uses, collision) = (uses(limits, &motion, &torque), self.collision(model, &motion[0])?);
        Ok(Verified { motion, torque, uses, collision })
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
