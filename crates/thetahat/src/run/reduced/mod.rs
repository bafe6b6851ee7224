//! The run of rows alone: what a reduction keeps of recordings.

pub(in crate::run) mod data;

use super::validation::uncertain;
use super::{
    assessment::Assessment,
    estimation_data::EstimationData,
    examination::{examine_robot, with_note},
    explained_by_model::with_model_explained,
    model::model_of_factors,
    parameters::{elimination_result, not_separated},
};
use crate::{
    diagnosis::{MethodEstimate, advise, diagnose, judge},
    preparation::{Case, PreparationError},
    scheduling::{EstimationJob, Finished},
};
use data::ReducedIdentification;
use thetahat_estimation::identification::{Fit, Method, Needs, Outcome, Response, Status};
use thetahat_ground::clock::Stopwatch;
use thetahat_report::results::{
    CaseDiagnosis, JointResult, ModelResult, Plots, RecordingFindings, Results, RunResult, SCHEMA,
};

impl ReducedIdentification<'_> {
    /// Runs the nominal case with every method that needs no further simulation, and judges it as a run of recordings is.
    ///
    /// # Errors
    /// [`PreparationError`] for input that cannot be used.
    pub(crate) fn run(&self) -> Result<Results, PreparationError> {
        let case = Case::nominal();
        let assessed: Vec<(RunResult, MethodEstimate)> =
            self.methods().into_iter().map(|method| self.assess(&case, method)).collect::<Result<_, _>>()?;
        let (runs, estimated): (Vec<RunResult>, Vec<MethodEstimate>) = assessed.into_iter().unzip();
        let diagnosis = diagnose(&self.problem.problem, &case, &estimated, &|_, _| Vec::new());
        let mut results = self.results(runs, diagnosis)?;
        match self.model(&results.runs) {
            Ok(model) => {
                with_model_explained(&mut results.findings, &model);
                results.model = Some(model);
            }
            Err(why) => results.no_model = Some(why),
        }
        judge(&mut results);
        Ok(results)
    }

    fn model(&self, runs: &[RunResult]) -> Result<ModelResult, String> {
        let data = &self.data;
        model_of_factors((self.setup, &self.problem.problem), &data.model, data.truth.clone(), runs)
    }

    /// IDIM-LS, what else of the settings needs the measured motion alone, and IDIM-IV where there are instruments.
    fn methods(&self) -> Vec<Method> {
        let of_measurement = |m: &Method| m.needs() == Needs::Measurement && m.response() == Response::Torque;
        let asked = self.setup.settings.estimation.methods.iter().copied();
        let others = asked.filter(of_measurement).filter(|m| *m != Method::IDIM_LS);
        let iv = self.data.instruments.as_ref().map(|_| Method::IDIM_IV);
        [Method::IDIM_LS].into_iter().chain(others).chain(iv).collect()
    }

    fn assess(&self, case: &Case, method: Method) -> Result<(RunResult, MethodEstimate), PreparationError> {
        let settings = self.setup.settings;
        let of_recordings: Vec<f64> = self.data.recordings.iter().map(|r| r.weight).collect();
        let weights = self.problem.weights(settings, method, &of_recordings);
        let job = EstimationJob::new(&self.problem.problem, method, weights, None);
        let stopwatch = Stopwatch::start();
        let outcome = self.estimate(&job);
        let finished = Finished { outcome, motions: None, note: None, seconds: stopwatch.seconds() };
        let assessment = Assessment { data: EstimationData::Reduced(self), case, job: &job };
        let (mut run, mut estimated) = assessment.assess(finished)?;
        run.iterations = usize::from(method.needs() == Needs::Instruments);
        let unsettled = self.problem.unsettled_weights(settings, method);
        let unsettled = unsettled.or_else(|| self.moved(method, estimated.outcome.fit.as_ref()?));
        if let Some(reason) = unsettled.filter(|_| run.status == Status::Converged) {
            (run.status, run.reason) = (Status::IterationLimit, Some(reason));
            estimated.outcome.status = Status::IterationLimit;
        }
        Ok((run, estimated))
    }

    fn estimate(&self, job: &EstimationJob<'_>) -> Outcome {
        let instruments = self.data.instruments.as_ref().filter(|_| job.method.needs() != Needs::Measurement);
        let z = instruments.map(|instruments| instruments.z.select_columns(&self.columns));
        let fit = job.method.estimate(&job.regression, z.as_ref(), self.setup.settings.estimation.variance);
        Outcome { instruments: z, ..Outcome::direct(fit) }
    }

    /// Why the estimates are not those with which the instruments were simulated, where one differs by more than the limit.
    fn moved(&self, method: Method, fit: &Fit) -> Option<String> {
        let simulated = self.data.instruments.as_ref().filter(|_| method.needs() != Needs::Measurement)?;
        let change = |(i, &c): (usize, &usize)| (fit.theta[i] - simulated.theta[c]).abs() / fit.standard_deviation[i];
        let largest = self.columns.iter().enumerate().map(change).fold(0.0, f64::max);
        (largest > self.setup.settings.estimation.convergence.parameter_change).then(|| {
            format!(
                "an estimate is {largest:.2} standard deviations from the parameters of its instruments; reduce again with \
                 instruments from these results"
            )
        })
    }

    /// What was found in the robot's description, in the recordings, and in the estimates.
    fn findings(&self, runs: &[RunResult]) -> Vec<RecordingFindings> {
        let note = uncertain::of_runs(self.setup, &self.problem.problem, runs);
        let of_recordings = with_note(self.data.findings.clone(), note);
        examine_robot(self.setup.robot).into_iter().chain(of_recordings).chain(self.data.compared.clone()).collect()
    }

    fn results(&self, runs: Vec<RunResult>, diagnosis: CaseDiagnosis) -> Result<Results, PreparationError> {
        let Self { setup, data, .. } = self;
        let rate = data.recordings.first().map_or(0.0, |r| r.sample_rate_hz);
        let findings = self.findings(&runs);
        Ok(Results {
            schema: SCHEMA,
            thetahat: env!("CARGO_PKG_VERSION").to_owned(),
            robot: setup.robot.name.clone(),
            title: String::new(),
            verdict: None,
            verdict_reasons: Vec::new(),
            remedies: Vec::new(),
            not_examined: data.not_examined.clone(),
            robot_joints: JointResult::of_coordinates(setup.robot),
            robot_locked: setup.robot.locked.clone(),
            samples_used: data.recordings.iter().map(|r| r.samples_used).sum(),
            decimated_rows: data.rows,
            recordings: data.recordings.clone(),
            validation_recordings: Vec::new(),
            bandwidth: setup.measure_bandwidth(rate)?,
            seed: None,
            excluded_parameters: setup.settings.parameters.exclude.clone(),
            fixed_parameters: setup.settings.parameters.fix.clone(),
            elimination: elimination_result(&self.problem.problem),
            not_separated: not_separated(&self.problem.problem),
            unmasked_comparison: None,
            profiled_terms: Vec::new(),
            term_comparison: None,
            advice: vec![advise(&diagnosis, &runs, &findings)],
            findings,
            diagnostics: vec![diagnosis],
            runs,
            user_runs: Vec::new(),
            model: None,
            no_model: None,
            payloads: Vec::new(),
            drive_gains: Vec::new(),
            experiment_description: String::new(),
            robot_description: String::new(),
            robot_files: Vec::new(),
            plots: Plots::default(),
        })
    }
}
