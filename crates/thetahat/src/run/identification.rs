//! Every case, every method, on all recordings.

use super::{
    assessment::Assessment,
    examination::examine,
    prepared::{Prepared, filtered},
};
use crate::{
    base_parameters::BaseParameters,
    diagnosis::{Estimated, advise, diagnose},
    identification::{EstimationError, Method, Reason, Weighting, idim_ls},
    pool::available_threads,
    preparation::{Case, PreparationError, Problem, Recording, Settings, Setup},
    results::{CaseDiagnosis, Plots, RecordingFindings, Results, RunResult},
    robot::{Friction, Robot},
    scheduling::{EstimationJob, RunOptions, Simulator, instruments_side_by_side, run_all},
    series::Series,
    simulation::SimulatorBias,
};

/// Part by which the sample rates of recordings may differ: clocks differ by less, chosen rates by more.
const RATE_TOLERANCE: f64 = 0.01;

/// A robot with recordings, ready to be identified.
pub struct Identification {
    robot: Robot,
    settings: Settings,
    pub(super) main: Vec<Prepared>,
    pub(super) validation: Vec<Prepared>,
}

/// The regression of one friction model, with the weights of its joints.
pub(crate) struct CaseProblem {
    friction: Friction,
    pub(crate) problem: Problem,
    /// One over the standard deviation of each joint's LS residual, where LS has an estimate.
    joint_weights: Option<Vec<f64>>,
}

impl CaseProblem {
    pub(crate) fn new(friction: Friction, problem: Problem, settings: &Settings) -> Self {
        let fit = idim_ls(&problem.regression, settings.estimation.variance).ok();
        let joint_weights = fit.map(|fit| problem.regression.joint_weights(&fit.prediction));
        Self { friction, problem, joint_weights }
    }

    /// The weight of each row: that of its recording, and where the method asks for it that of its joint. None where all
    /// are one.
    pub(crate) fn weights(&self, settings: &Settings, method: Method, of_recordings: &[f64]) -> Option<Vec<f64>> {
        let of_joints = match settings.weighting(method) {
            Weighting::None => None,
            Weighting::PerJoint => self.joint_weights.as_deref(),
        };
        self.problem.regression.row_weights(of_recordings, of_joints)
    }
}

impl Identification {
    /// Filters the recordings, which are one regression, and finds the reference that simulations of each follow.
    ///
    /// # Errors
    /// [`PreparationError`] for settings or recordings that cannot be used.
    pub fn new(robot: &Robot, recordings: Vec<Recording>, settings: Settings) -> Result<Self, PreparationError> {
        settings.validate(robot)?;
        let mut identification = Self { robot: robot.clone(), settings, main: Vec::new(), validation: Vec::new() };
        if recordings.is_empty() {
            let why = "a robot is identified from its motion and torques";
            return Err(PreparationError::Missing { missing: "a recording", why });
        }
        identification.main = identification.prepare(recordings)?;
        Ok(identification)
    }

    /// The same with recordings that are held back to validate the estimates on.
    ///
    /// # Errors
    /// [`PreparationError`] for recordings that cannot be used.
    pub fn with_validation(mut self, recordings: Vec<Recording>) -> Result<Self, PreparationError> {
        self.validation = self.prepare(recordings)?;
        Ok(self)
    }

    /// Runs every case and method.
    ///
    /// A method that does not converge or a motion that does not identify the parameters is not an error: the run says
    /// so in its status.
    ///
    /// # Errors
    /// [`PreparationError`] for input that cannot be used.
    pub fn run(&self) -> Result<Results, PreparationError> {
        self.run_with_progress(&mut |_| {})
    }

    /// The same; `progress` is told what is being done.
    ///
    /// # Errors
    /// As [`Identification::run`].
    pub fn run_with_progress(&self, progress: &mut dyn FnMut(&str)) -> Result<Results, PreparationError> {
        let problems = self.problems(progress)?;
        progress("checking the recordings");
        let findings = self.findings(&problems[0].problem);
        let cases = self.settings.all_cases();
        let assessed = self.assess_all(&problems, &cases, progress)?;
        let (mut runs, mut diagnostics) = (Vec::new(), Vec::new());
        for (case, assessed) in cases.iter().zip(assessed) {
            progress(&format!("{}: diagnosis", case.name));
            let (results, estimated): (Vec<_>, Vec<_>) = assessed.into_iter().unzip();
            runs.extend(results);
            diagnostics.push(self.diagnose(&self.problem_of(&problems, case).problem, case, &estimated));
        }
        self.results(&problems[0].problem, findings, runs, diagnostics)
    }

    pub(crate) fn setup(&self) -> Setup<'_> {
        Setup { robot: &self.robot, settings: &self.settings }
    }

    fn prepare(&self, recordings: Vec<Recording>) -> Result<Vec<Prepared>, PreparationError> {
        let mut all: Vec<Prepared> = Vec::with_capacity(recordings.len());
        for (i, mut recording) in recordings.into_iter().enumerate() {
            if recording.name.is_empty() {
                recording.name = (i + 1).to_string();
            }
            recording.validate(self.robot.coordinate_count())?;
            all.push(Prepared::new(self.setup(), recording)?);
        }
        require_one_rate(&all)?;
        Ok(all)
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
            problems.push(CaseProblem::new(friction, problem, &self.settings));
        }
        Ok(problems)
    }

    fn friction_of(&self, case: &Case) -> Friction {
        case.friction.unwrap_or(self.robot.friction)
    }

    /// The problem of a case's friction model; that of the nominal case where there is none.
    fn problem_of<'p>(&self, problems: &'p [CaseProblem], case: &Case) -> &'p CaseProblem {
        let friction = self.friction_of(case);
        problems.iter().find(|p| p.friction == friction).unwrap_or(&problems[0])
    }

    /// Every method of every case.
    fn assess_all(
        &self,
        problems: &[CaseProblem],
        cases: &[Case],
        progress: &mut dyn FnMut(&str),
    ) -> Result<Vec<Vec<(RunResult, Estimated)>>, PreparationError> {
        let estimation = &self.settings.estimation;
        let methods = |case: &Case| case.methods.clone().unwrap_or_else(|| estimation.methods.clone());
        let all: Vec<(usize, Method)> =
            cases.iter().enumerate().flat_map(|(c, case)| methods(case).into_iter().map(move |m| (c, m))).collect();
        let job = |&(c, method): &(usize, Method)| self.job(self.problem_of(problems, &cases[c]), &cases[c], method);
        let jobs: Vec<EstimationJob<'_>> = all.iter().map(job).collect();
        let options =
            RunOptions { iteration: estimation.iteration(), motion_step: Some(1), threads: available_threads() };
        let mut assessed: Vec<Option<(RunResult, Estimated)>> = all.iter().map(|_| None).collect();
        let mut tell =
            |simulations| progress(&format!("simulating and estimating: {simulations} simulations side by side"));
        run_all(&jobs, options, &mut tell, &mut |k, finished| {
            let assessment = Assessment { identification: self, case: &cases[all[k].0], job: &jobs[k] };
            assessed[k] = Some(assessment.assess(finished)?);
            Ok::<(), PreparationError>(())
        })?;
        let mut by_case: Vec<Vec<_>> = cases.iter().map(|_| Vec::new()).collect();
        all.iter().zip(assessed).for_each(|((c, _), run)| by_case[*c].extend(run));
        Ok(by_case)
    }

    /// A method of a case.
    pub(crate) fn job<'s>(&'s self, problem: &'s CaseProblem, case: &Case, method: Method) -> EstimationJob<'s> {
        let simulator = self.simulator(&self.main, &problem.problem, case);
        let of_recordings: Vec<f64> = self.main.iter().map(|p| p.filtered.recording.weight).collect();
        let weights = problem.weights(&self.settings, method, &of_recordings);
        EstimationJob::new(&problem.problem, method, weights, simulator)
    }

    /// Compares the methods of a case; what needs a simulator with another bias makes one.
    fn diagnose(&self, problem: &Problem, case: &Case, estimated: &[Estimated]) -> CaseDiagnosis {
        let simulate = |biases: &[SimulatorBias], theta: &[f64]| {
            let with_bias = |&bias| self.simulator(&self.main, problem, &case.clone().with_simulator(bias));
            let Some(simulators) = biases.iter().map(with_bias).collect::<Option<Vec<_>>>() else { return Vec::new() };
            instruments_side_by_side(&simulators, theta, available_threads())
        };
        diagnose(problem, case, estimated, &simulate)
    }

    pub(super) fn simulator<'s>(
        &'s self,
        prepared: &'s [Prepared],
        problem: &'s Problem,
        case: &Case,
    ) -> Option<Simulator<'s>> {
        let controller = self.settings.controller.as_ref()?;
        let recordings =
            prepared.iter().map(|p| Some((&p.filtered, p.reference.as_ref()?))).collect::<Option<Vec<_>>>()?;
        Some(Simulator::new(self.setup(), problem, &recordings, controller, case.simulator))
    }

    /// What is found in the recordings, those that are identified from and those held back.
    fn findings(&self, nominal: &Problem) -> Vec<RecordingFindings> {
        let examine = |prepared: &Prepared, held_back| examine(self.setup(), prepared, nominal, held_back);
        let main = self.main.iter().map(|p| examine(p, false));
        main.chain(self.validation.iter().map(|p| examine(p, true))).collect()
    }

    fn results(
        &self,
        problem: &Problem,
        findings: Vec<RecordingFindings>,
        runs: Vec<RunResult>,
        diagnostics: Vec<CaseDiagnosis>,
    ) -> Result<Results, PreparationError> {
        let positions: Vec<&Series> = self.main.iter().map(|p| &p.filtered.motion.q).collect();
        let rate = self.main.first().map_or(0.0, |p| p.filtered.recording.sample_rate_hz);
        let regression = &problem.regression;
        Ok(Results {
            thetahat: env!("CARGO_PKG_VERSION").to_owned(),
            robot: self.robot.name.clone(),
            title: String::new(),
            samples_used: self.main.iter().map(|p| p.filtered.window.len()).sum(),
            decimated_rows: regression.y.len(),
            recordings: self.main.iter().map(Prepared::describe).collect(),
            validation_recordings: self.validation.iter().map(Prepared::describe).collect(),
            bandwidth: self.setup().measure_bandwidth(rate)?,
            seed: None,
            findings,
            elimination: problem.elimination_result(),
            advice: diagnostics.iter().map(|d| advise(d, &runs)).collect(),
            diagnostics,
            runs,
            experiment_description: String::new(),
            robot_description: String::new(),
            plots: Plots {
                time_s: self.times(problem),
                measured: regression.layout.by_joint(&regression.y),
                position: problem.at_rows(&positions),
            },
        })
    }

    /// The time of each row of a joint; the recordings follow one another.
    pub(super) fn times(&self, problem: &Problem) -> Vec<f64> {
        let mut times = Vec::new();
        let mut before_s = 0.0;
        for (Prepared { filtered, .. }, decimator) in self.main.iter().zip(&problem.decimators) {
            let rate = filtered.recording.sample_rate_hz;
            times.extend(decimator.kept().map(|k| before_s + filtered.start_s() + k as f64 / rate));
            before_s += filtered.recording.position.len() as f64 / rate;
        }
        times
    }
}

/// One parallel filter and one decimation suit only recordings of one rate.
fn require_one_rate(recordings: &[Prepared]) -> Result<(), PreparationError> {
    let rate = |p: &Prepared| p.filtered.recording.sample_rate_hz;
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
pub(crate) fn explain(estimated: &BaseParameters, reason: &Reason) -> String {
    let Reason::Estimation(EstimationError::NotIdentifiable { rank, columns, dependent }) = reason else {
        return reason.to_string();
    };
    let names: Vec<&str> = dependent.iter().map(|&c| estimated.parameters()[c].name.as_str()).collect();
    format!(
        "the motion separates only {rank} of {columns} parameters; not separated from the others by this motion: {}",
        names.join(" ")
    )
}
