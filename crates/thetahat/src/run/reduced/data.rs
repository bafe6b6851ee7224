//! What a reduction keeps of recordings, with the chosen parameters.

use crate::{
    preparation::{Basis, PreparationError, Setup},
    run::{identification::CaseProblem, model::ModelData, validation::cross_validation::Folds},
};
use thetahat_estimation::regression::Regression;
use thetahat_ground::linear_algebra::Matrix;
use thetahat_report::results::{NotExamined, RecordingFindings, RecordingResult};

/// Z of simulations that were made before.
pub(crate) struct SimulatedInstruments {
    /// With all columns of the base.
    pub(crate) z: Matrix,
    /// The base parameters with which it was simulated.
    pub(crate) theta: Vec<f64>,
}

/// What is known of recordings whose samples are not there.
pub(crate) struct ReducedData {
    /// The rows, or triangular factors of them, with all columns of the base.
    pub(crate) regression: Regression,
    pub(crate) instruments: Option<SimulatedInstruments>,
    /// The rows of every sample, of which the model is chosen.
    pub(crate) model: ModelData,
    pub(crate) recordings: Vec<RecordingResult>,
    /// Rows of y before they were reduced.
    pub(crate) rows: usize,
    /// True base parameters, of twins.
    pub(crate) truth: Option<Vec<f64>>,
    /// What is left out in turn.
    pub(crate) folds: Option<Folds>,
    /// What was found in each recording.
    pub(crate) findings: Vec<RecordingFindings>,
    /// What was found in recordings that were compared with one another.
    pub(crate) compared: Vec<RecordingFindings>,
    pub(crate) not_examined: Vec<NotExamined>,
}

/// A robot with rows from which its parameters are estimated.
pub(crate) struct ReducedIdentification<'a> {
    pub(in crate::run) setup: Setup<'a>,
    pub(in crate::run) problem: CaseProblem,
    /// The estimated columns among those of the base.
    pub(in crate::run) columns: Vec<usize>,
    pub(in crate::run) data: ReducedData,
}

impl<'a> ReducedIdentification<'a> {
    /// Chooses the parameters.
    ///
    /// # Errors
    /// [`PreparationError`] for settings that do not fit the rows.
    pub(crate) fn new(setup: Setup<'a>, basis: Basis, data: ReducedData) -> Result<Self, PreparationError> {
        let choice = &setup.settings.parameters.estimate;
        let problem = setup.problem_of_rows(basis, data.regression.clone(), choice)?.of_separated(choice)?;
        let columns = problem.estimated_columns();
        Ok(Self { setup, problem: CaseProblem::new(setup.robot.friction, problem), columns, data })
    }

    pub(in crate::run) fn setup(&self) -> Setup<'a> {
        self.setup
    }

    pub(in crate::run) fn folds(&self) -> Option<Folds> {
        self.data.folds.clone()
    }

    /// The true values of the estimated parameters.
    pub(in crate::run) fn truth(&self) -> Option<Vec<f64>> {
        let truth = self.data.truth.as_ref()?;
        Some(self.columns.iter().map(|&c| truth[c]).collect())
    }
}
