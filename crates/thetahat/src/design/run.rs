//! The way of a design: limits, searches, verification, promise.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::{
    constraints::Constraints,
    criterion::{Criterion, CriterionName},
    description::Design,
    error::DesignError,
    experiment_text::experiment_text,
    family::{Derivatives, Family},
    fourier::FourierBasis,
    information::Information,
    limits::{JointLimits, Limited},
    loads::Loads,
    optimiser::Problem,
    promise::{Expected, ExpectedRecord},
    starts::{Searches, Start},
    verification::{RATE_HZ, uses},
};
use crate::{
    base_parameters::BaseParameters,
    dynamics::{Model, Sign},
    linear_algebra::Matrix,
    preparation::Setup,
    reduction::Reduction,
    results::{DesignResults, DesignedJoint, LimitUse, PromisedParameter, SearchResult},
    scheduling::closed_loop,
    series::Series,
    simulation::{OutputGrid, Reference, SampledReference, SimulatorBias},
};

/// Instants of the information for each harmonic, and at least as many in all.
const INSTANTS: usize = 30;
const FEWEST_INSTANTS: usize = 200;
/// Instants at which limits are looked at, for each harmonic.
const WATCHED: usize = 60;
/// Velocity scales of the sign in the search, as parts of the median of the velocity limits.
const SIGN_SCALES: [f64; 2] = [0.02, 0.005];

/// A motion within its limits.
struct Chosen {
    motion: Derivatives,
    torque: Series,
    uses: Vec<LimitUse>,
    starts: Vec<Start>,
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
        let expected = self.promise(&record)?;
        Ok(self.results(&model, &base, chosen, &expected))
    }

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
        if base.parameters().iter().map(|p| &p.name).ne(&reduction.identity.parameters) {
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

    fn promise(&self, (q, tau): &(Series, Series)) -> Result<Expected, DesignError> {
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
        record.promise(&self.path, self.file.motion.seed)
    }

    fn results(&self, model: &Model, base: &BaseParameters, chosen: Chosen, expected: &Expected) -> DesignResults {
        let Chosen { motion, torque, uses, starts } = chosen;
        let a_priori = base.from_standard(&self.robot.a_priori_parameters());
        let wanted = self.file.wanted.half_width_percent;
        let promised = expected.parameters.iter().enumerate().map(|(i, parameter)| {
            let place = base.parameters().iter().position(|p| p.name == parameter.name);
            let a_priori = place.map_or(0.0, |place| a_priori[place]);
            let half = expected.half_width_95[i];
            let times = (100.0 * half / (wanted * a_priori.abs())).powi(2);
            PromisedParameter {
                name: parameter.name.clone(),
                unit: parameter.unit.to_string(),
                expression: parameter.expression.clone(),
                joint: model.parameter_table().get(parameter.kept).number,
                a_priori,
                standard_deviation: expected.standard_deviation[i],
                half_width_95: half,
                seconds: (a_priori != 0.0).then_some(self.file.duration_s * times),
            }
        });
        let promised = promised.collect();
        let [q, dq, ddq, _] = motion;
        DesignResults {
            title: self.file.title.clone(),
            robot: self.robot.name.clone(),
            joints: self.robot.coordinates().map(|j| DesignedJoint { name: j.name.clone(), kind: j.kind }).collect(),
            sample_rate_hz: self.file.sample_rate_hz,
            q,
            dq,
            ddq,
            torque,
            criterion: self.file.wanted.criterion.name().to_owned(),
            starts: starts
                .iter()
                .map(|s| SearchResult { first: s.first_value, found: s.value, steps: s.steps })
                .collect(),
            limits: uses,
            promised,
            method: self.method().name().to_owned(),
            is_closed_loop: self.settings.controller.is_some(),
            half_width_percent: wanted,
            experiment: experiment_text(self),
        }
    }

    fn method(&self) -> crate::identification::Method {
        super::promise::promised_method(&self.settings)
    }
}

/// Least part of every range that the search leaves unused, for what lies between the watched instants.
const LEAST_MARGIN: f64 = 0.002;

/// Wide velocity scales first.
fn sign_scales(limits: &[JointLimits]) -> [f64; 2] {
    let mut velocities: Vec<f64> = limits.iter().map(|l| l.velocity).collect();
    velocities.sort_by(f64::total_cmp);
    let median = velocities[velocities.len() / 2];
    SIGN_SCALES.map(|part| part * median)
}

/// Random states by which parameters of different units are compared.
const RANDOM_STATES: usize = 500;

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
