//! The way of a design: limits, searches, verification, promise.

use super::{
    description::Design,
    error::DesignError,
    family::{Derivatives, Family},
    limits::JointLimits,
    loads::Loads,
    optimiser::Problem,
    promise::{Expected, ExpectedRecord},
    starts::{Searches, Start},
    verification::{RATE_HZ, uses},
};
use crate::{
    base_parameters::BaseParameters,
    dynamics::{Model, Sign},
    preparation::Setup,
    results::{DesignResults, LimitUse},
    scheduling::closed_loop,
    series::Series,
    simulation::{OutputGrid, Reference, SampledReference, SimulatorBias},
};

/// Velocity scales of the sign in the search, as parts of the median of the velocity limits.
const SIGN_SCALES: [f64; 2] = [0.02, 0.005];

/// A motion within its limits.
pub(super) struct Chosen {
    pub(super) motion: Derivatives,
    pub(super) torque: Series,
    pub(super) uses: Vec<LimitUse>,
    pub(super) starts: Vec<Start>,
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
        Ok(self.results(&model, &base, chosen, &expected))
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
        let mut first_violated = None;
        for start in &starts {
            let (motion, torque, uses) = self.verify(model, &problem, limits, &start.x);
            match uses.iter().max_by(|a, b| a.part.total_cmp(&b.part)).filter(|worst| worst.part > 1.0) {
                None => {
                    let motion = self.sampled(&problem.family, &start.x, motion);
                    let torque = self.torques(model, &motion, torque);
                    return Ok(Chosen { motion, torque, uses, starts });
                }
                Some(worst) => _ = first_violated.get_or_insert_with(|| worst.clone()),
            }
        }
        Err(match first_violated {
            Some(worst) => self.infeasible(&worst),
            None => {
                let (path, parameters) = (self.path.clone(), base.len());
                DesignError::ShowsTooLittle { path, starts: self.file.motion.starts, parameters }
            }
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
        let motion = problem.family.motion(&problem.family.sampled(&grid), x);
        let loads = Loads::new(model, &self.robot.a_priori_parameters(), limits.to_vec());
        let torque = loads.torques([&motion[0], &motion[1], &motion[2]], Sign::Exact);
        let uses = uses(limits, &motion, &torque);
        (motion, torque, uses)
    }

    /// The motion at the rate of the trajectory; that at 1 kHz where this is the rate.
    fn sampled(&self, family: &Family, x: &[f64], at_1_khz: Derivatives) -> Derivatives {
        let rate = self.file.sample_rate_hz;
        if rate == RATE_HZ {
            return at_1_khz;
        }
        let count = (self.file.duration_s * rate).round() as usize;
        let grid: Vec<f64> = (0..=count).map(|k| (k as f64 / rate).min(self.file.duration_s)).collect();
        family.motion(&family.sampled(&grid), x)
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
