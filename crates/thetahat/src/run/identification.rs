//! A robot with its recordings and settings, and what its estimations need.

use std::sync::{Arc, OnceLock};

use super::{
    prepared::{PreparedRecording, filtered},
    terms::profiled_robot::with_profiled_terms,
    validation::cross_validation::Folds,
};
use crate::{
    preparation::{
        Case, Payload, PreparationError, Problem, ProposedController, Recording, Settings, Setup, propose_controller,
    },
    scheduling::{EstimationJob, Simulator},
};
use thetahat_estimation::{
    control::ControllerDescription,
    identification::{EstimationError, JointWeights, Method, Needs, Reason, Response, UserEstimator, Weighting},
};
use thetahat_ground::pool::available_threads;
use thetahat_model::{
    base_parameters::BaseParameters,
    robot::{Friction, Robot, TermDescription},
};
use thetahat_report::results::ProfiledTerm;

/// Part by which the sample rates of recordings may differ: clocks differ by less, chosen rates by more.
const RATE_TOLERANCE: f64 = 0.01;

/// A robot with recordings, ready to be identified.
pub struct Identification {
    robot: Robot,
    settings: Settings,
    /// The controller that IV simulates where none is described.
    proposed: Option<ProposedController>,
    /// The constants of torque terms that were searched for.
    pub(super) profiled: Vec<ProfiledTerm>,
    pub(super) main: Arc<Vec<PreparedRecording>>,
    /// Recordings with a payload that is to be estimated: nothing else is estimated from them.
    pub(super) loaded: Vec<PreparedRecording>,
    pub(super) validation: Arc<Vec<PreparedRecording>>,
    /// Estimators of the user's own, for the nominal case.
    pub(super) estimators: Vec<UserEstimator>,
    /// Threads on which loops are simulated.
    pub(super) threads: usize,
}

/// The regression of one friction model, with the weights of its joints.
pub(crate) struct CaseProblem {
    friction: Friction,
    pub(crate) problem: Problem,
    /// The weights of the joints, once a method asked for them, where there is an estimate.
    joint_weights: OnceLock<Option<JointWeights>>,
}

impl CaseProblem {
    pub(crate) fn new(friction: Friction, problem: Problem) -> Self {
        Self { friction, problem, joint_weights: OnceLock::new() }
    }

    /// The weight of each row: that of its recording, and where the method asks for it that of its joint. None if all
    /// are one.
    pub(crate) fn weights(&self, settings: &Settings, method: Method, of_recordings: &[f64]) -> Option<Vec<f64>> {
        let regression = &self.problem.regression;
        let of_joints = match settings.weighting(method) {
            Weighting::None => None,
            Weighting::PerJoint => {
                let found = || JointWeights::of(regression, of_recordings).ok();
                self.joint_weights.get_or_init(found).as_ref().map(|found| &found.weights[..])
            }
        };
        regression.row_weights(of_recordings, of_joints)
    }

    /// Why the weights of a method are not those of its residual, where they did not settle.
    pub(super) fn unsettled_weights(&self, settings: &Settings, method: Method) -> Option<String> {
        let found = self.joint_weights.get()?.as_ref().filter(|found| !found.is_settled())?;
        (settings.weighting(method) == Weighting::PerJoint).then(|| {
            format!(
                "the weights of the joints did not settle in {} estimates: one still changes by {:.1e} of itself",
                found.steps, found.change
            )
        })
    }
}

impl Identification {
    /// Filters the recordings, which are one regression, and finds the reference that simulations of each follow.
    ///
    /// # Errors
    /// [`PreparationError`] for settings or recordings that cannot be used.
    pub fn new(robot: &Robot, recordings: Vec<Recording>, settings: Settings) -> Result<Self, PreparationError> {
        let settings = settings.for_robot(robot)?;
        settings.validate(robot)?;
        let settings = settings.with_cutoff_of(&recordings)?;
        let robot = robot.clone();
        let mut identification = Self {
            robot,
            settings,
            proposed: None,
            profiled: Vec::new(),
            main: Arc::default(),
            loaded: Vec::new(),
            validation: Arc::default(),
            estimators: Vec::new(),
            threads: available_threads(),
        };
        if recordings.is_empty() {
            let why = "a robot is identified from its motion and torques";
            return Err(PreparationError::Missing { missing: "a recording", why });
        }
        let all = identification.prepare(recordings)?;
        identification.take(all)?;
        identification.require_torques()?;
        let profiled = with_profiled_terms(identification.setup(), &filtered(&identification.main))?;
        if let Some((robot, profiled)) = profiled {
            (identification.robot, identification.profiled) = (robot, profiled);
        }
        let lacks_controller = identification.settings.lacks_controller();
        identification.proposed = lacks_controller.then(|| propose_controller(&filtered(&identification.main)));
        Ok(identification)
    }

    /// The same with a given number of threads instead of one for each processor, as where several robots are identified at a time. The results
    /// do not depend on their number.
    #[must_use]
    pub fn on_threads(self, threads: usize) -> Self {
        Self { threads: threads.max(1), ..self }
    }

    /// The same recordings of a robot with more torque terms; none if it cannot have them.
    pub(super) fn with_terms(&self, terms: &[TermDescription]) -> Option<Self> {
        let mut robot = self.robot.clone();
        robot.add_terms(terms).ok()?;
        Some(Self { profiled: Vec::new(), ..self.variant(robot, self.settings.clone()) })
    }

    /// The same recordings with settings that filter them alike.
    pub(super) fn with_settings(&self, settings: Settings) -> Self {
        self.variant(self.robot.clone(), settings)
    }

    fn variant(&self, robot: Robot, settings: Settings) -> Self {
        Self {
            robot,
            settings,
            proposed: None,
            profiled: self.profiled.clone(),
            main: self.main.clone(),
            loaded: Vec::new(),
            validation: self.validation.clone(),
            estimators: Vec::new(),
            threads: self.threads,
        }
    }

    /// The same with recordings that are held back to validate the estimates on.
    ///
    /// # Errors
    /// [`PreparationError`] for recordings that cannot be used.
    pub fn with_validation(mut self, recordings: Vec<Recording>) -> Result<Self, PreparationError> {
        self.validation = Arc::new(self.prepare(recordings)?);
        for prepared in self.validation.iter() {
            let recording = &prepared.filtered.recording;
            if let Some(payload) = self.setup().payload_of(recording)?.filter(|p| !p.is_known()) {
                let key = format!("[[validation]] {}: payload", recording.name);
                let expected = "none, or a known one: no robot is validated with a payload that is not known";
                return Err(PreparationError::value(&key, expected, &payload.name));
            }
        }
        Ok(self)
    }

    /// Takes recordings: those with a payload that is to be estimated apart from the others.
    fn take(&mut self, all: Vec<PreparedRecording>) -> Result<(), PreparationError> {
        let simulating = self.settings.all_methods().into_iter().find(|m| m.needs() != Needs::Measurement);
        let mut main = Vec::new();
        for prepared in all {
            let recording = &prepared.filtered.recording;
            let payload = self.setup().payload_of(recording)?.map(Payload::is_known);
            if let (Some(_), Some(method)) = (payload, simulating) {
                let place = format!("recording {}: methods", recording.name);
                let expected = "idim-ls or idim-wls where a recording has a payload: simulations carry none";
                return Err(PreparationError::value(&place, expected, method));
            }
            if payload == Some(false) { self.loaded.push(prepared) } else { main.push(prepared) }
        }
        self.main = Arc::new(main);
        if self.main.is_empty() {
            let why = "a payload that is to be estimated is distinguished from the robot by motion with and without it";
            return Err(PreparationError::Missing { missing: "a recording without it", why });
        }
        Ok(())
    }

    /// Every method but those that fit positions alone needs torques.
    fn require_torques(&self) -> Result<(), PreparationError> {
        let recordings = self.main.iter().chain(&self.loaded).map(|p| &p.filtered.recording);
        let Some(without) = recordings.clone().find(|r| r.torque.is_none()) else { return Ok(()) };
        let estimation = &self.settings.estimation;
        let asked = |case: Case| case.methods.unwrap_or_else(|| estimation.methods.clone());
        let needs_torque = |m: &Method| m.response() == Response::Torque;
        match self.settings.all_cases().into_iter().flat_map(asked).find(needs_torque) {
            None => Ok(()),
            Some(method) => {
                let place = format!("recording {}: methods", without.name);
                let expected =
                    "[\"cloe\"], since no torque is recorded: it estimates from positions, reference and controller";
                Err(PreparationError::value(&place, expected, method))
            }
        }
    }

    /// Whether every recording from which the robot is estimated has torques.
    pub(super) fn records_torques(&self) -> bool {
        self.main.iter().all(|p| p.filtered.recording.torque.is_some())
    }

    pub(crate) fn setup(&self) -> Setup<'_> {
        Setup { robot: &self.robot, settings: &self.settings }
    }

    fn prepare(&self, recordings: Vec<Recording>) -> Result<Vec<PreparedRecording>, PreparationError> {
        let mut all: Vec<PreparedRecording> = Vec::with_capacity(recordings.len());
        for (i, mut recording) in recordings.into_iter().enumerate() {
            if recording.name.is_empty() {
                recording.name = (i + 1).to_string();
            }
            recording.validate(self.robot.coordinate_count())?;
            let recording = recording.unwrapped(&self.robot);
            let simulates = self.settings.controller.is_some() || self.settings.lacks_controller();
            all.push(PreparedRecording::new(self.setup(), recording, simulates)?);
        }
        require_one_rate(&all)?;
        Ok(all)
    }

    /// The controller that is simulated: the one described, or the one proposed for IV.
    pub(super) fn controller(&self) -> Option<&ControllerDescription> {
        self.settings.controller.as_ref().or(self.proposed.as_ref().map(|p| &p.description))
    }

    /// What simulations take that the experiment does not say.
    pub(super) fn simulation_notes(&self) -> Vec<String> {
        let smoothed = |p: &PreparedRecording| {
            let reference = p.reference.as_ref().filter(|r| r.periodic.is_none())?;
            let cutoff_hz = reference.smoothing_cutoff_hz?;
            Some(format!(
                "no reference is recorded, and the motion is neither made of moves nor periodic; simulations follow the \
                 motion smoothed with a cut-off of {cutoff_hz:.3} Hz"
            ))
        };
        let mut filtered: Vec<String> = self.main.iter().filter_map(smoothed).collect();
        filtered.dedup();
        let of_proposed = |p: &ProposedController| format!("no [controller] is described; {}", p.what);
        self.proposed.as_ref().map(of_proposed).into_iter().chain(filtered).collect()
    }

    /// One problem for each friction model, the nominal one first.
    pub(crate) fn problems(&self, progress: &mut dyn FnMut(&str)) -> Result<Vec<CaseProblem>, PreparationError> {
        let mut problems: Vec<CaseProblem> = Vec::new();
        for case in self.settings.all_cases() {
            let friction = self.friction_of(&case);
            if problems.iter().any(|p| p.friction == friction) {
                continue;
            }
            progress("building the observation matrix");
            let problem = self.setup().problem(&case, &filtered(&self.main))?;
            problems.push(CaseProblem::new(friction, problem));
        }
        Ok(problems)
    }

    fn friction_of(&self, case: &Case) -> Friction {
        case.friction.unwrap_or(self.robot.friction)
    }

    /// The problem of a case's friction model; that of the nominal case where there is none.
    pub(super) fn problem_of<'p>(&self, problems: &'p [CaseProblem], case: &Case) -> &'p CaseProblem {
        let friction = self.friction_of(case);
        problems.iter().find(|p| p.friction == friction).unwrap_or(&problems[0])
    }

    /// A method of a case.
    pub(crate) fn job<'s>(&'s self, problem: &'s CaseProblem, case: &Case, method: Method) -> EstimationJob<'s> {
        let simulator = self.simulator(&self.main, &problem.problem, case);
        self.job_with(problem, method, simulator)
    }

    /// A method of a case in the loop of another controller than the one described, along other references than the recorded ones.
    pub(super) fn job_in_loop_of<'s>(
        &'s self,
        (controller, prepared): (&'s ControllerDescription, &'s [PreparedRecording]),
        (problem, case): (&'s CaseProblem, &Case),
        method: Method,
    ) -> EstimationJob<'s> {
        let simulator = self.simulator_of(controller, prepared, &problem.problem, case);
        self.job_with(problem, method, simulator)
    }

    fn job_with<'s>(
        &'s self,
        problem: &'s CaseProblem,
        method: Method,
        simulator: Option<Simulator<'s>>,
    ) -> EstimationJob<'s> {
        let of_recordings: Vec<f64> = self.main.iter().map(|p| p.filtered.recording.weight).collect();
        let weights = problem.weights(&self.settings, method, &of_recordings);
        EstimationJob::new(&problem.problem, method, weights, simulator)
    }

    pub(super) fn simulator<'s>(
        &'s self,
        prepared: &'s [PreparedRecording],
        problem: &'s Problem,
        case: &Case,
    ) -> Option<Simulator<'s>> {
        self.simulator_of(self.controller()?, prepared, problem, case)
    }

    fn simulator_of<'s>(
        &'s self,
        controller: &'s ControllerDescription,
        prepared: &'s [PreparedRecording],
        problem: &'s Problem,
        case: &Case,
    ) -> Option<Simulator<'s>> {
        let recordings =
            prepared.iter().map(|p| Some((&p.filtered, p.reference.as_ref()?))).collect::<Option<Vec<_>>>()?;
        Some(Simulator::new(self.setup(), problem, &recordings, controller, case))
    }

    /// The true values of what a problem estimates, of twins.
    pub(super) fn truth_of(&self, problem: &Problem) -> Option<Vec<f64>> {
        let truth = self.main.first()?.filtered.recording.truth.as_ref()?;
        problem.estimated.agrees_with_fixed(truth).then(|| problem.estimated.from_standard(truth))
    }

    /// What is left out in turn: a recording where there are several, else a move where three or more are known,
    /// else the same fifth of every period, else a part.
    pub(super) fn folds(&self, problem: &Problem) -> Option<Folds> {
        let layout = &problem.regression.layout;
        let rows_of_joint = layout.len() / layout.joints().max(1);
        let [only] = &self.main[..] else {
            let mut of_row = layout.spread(|b| b.recording);
            of_row.truncate(rows_of_joint);
            return Folds::of_recordings(of_row, self.main.iter().map(|p| &*p.filtered.recording.name));
        };
        problem.decimators.first().map(|decimator| only.folds(decimator))
    }
}

/// One parallel filter and one decimation suit only recordings of one rate.
fn require_one_rate(recordings: &[PreparedRecording]) -> Result<(), PreparationError> {
    let rate = |p: &PreparedRecording| p.filtered.recording.sample_rate_hz;
    let Some(first) = recordings.first().map(rate) else { return Ok(()) };
    match recordings.iter().find(|p| (rate(p) / first - 1.0).abs() > RATE_TOLERANCE) {
        None => Ok(()),
        Some(other) => {
            let key = format!("[[recording]] {}: the sample rate", other.filtered.recording.name);
            let expected = format!("that of the first recording, {first:.6} Hz, within 1 %; resample one of them");
            Err(PreparationError::value(&key, &expected, format!("{:.6} Hz", rate(other))))
        }
    }
}

/// A reason in words: the estimators know columns, people know names.
pub(crate) fn explain(estimated: &BaseParameters, of_loop: &[String], reason: &Reason) -> String {
    let Reason::Estimation(EstimationError::NotIdentifiable { rank, columns, dependent }) = reason else {
        return reason.to_string();
    };
    let all = estimated.parameters().iter().map(|p| &p.name).chain(of_loop).collect::<Vec<_>>();
    let names: Vec<&str> = dependent.iter().filter_map(|&c| Some(all.get(c)?.as_str())).collect();
    format!(
        "the motion separates only {rank} of {columns} parameters; not separated from the others by this motion: {}",
        names.join(" ")
    )
}
