use super::problems::Problems;
use crate::{
    identification::{Method, Status},
    results::{CaseDiagnosis, Comparison, EndogeneityResult, InstrumentResult, RecordingFindings, RunResult},
};

/// F statistic below which instruments are weak (D. Staiger, J. H. Stock, 1997).
pub(super) const WEAK: f64 = 10.0;

/// What the advice needs of a run.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ran {
    pub(super) method: Method,
    pub(super) status: Status,
    /// Relative errors, percent: of the fit, and on data that it has not seen.
    pub(super) fit: Option<f64>,
    pub(super) unseen: Option<f64>,
    /// How far its classical standard deviations are too small.
    pub(super) widening: Option<f64>,
}

impl Ran {
    fn of(run: &RunResult) -> Self {
        Self {
            method: run.method,
            status: run.status,
            fit: run.relative_error_percent,
            unseen: run.cross_validation_relative_error_percent,
            widening: run.widening(),
        }
    }
}

/// What is known of a case: its runs, the tests that compare them, and the problems of the recordings.
pub(super) struct Evidence<'a> {
    pub(super) diagnosis: &'a CaseDiagnosis,
    pub(super) runs: Vec<Ran>,
    pub(super) problems: Problems,
}

impl<'a> Evidence<'a> {
    /// The runs of a case beside its diagnosis.
    pub(super) fn of(diagnosis: &'a CaseDiagnosis, runs: &[RunResult], findings: &[RecordingFindings]) -> Self {
        let own: Vec<&RunResult> = runs.iter().filter(|r| r.case == diagnosis.case).collect();
        let problems = Problems::of(findings, &own);
        Self { diagnosis, runs: own.iter().map(|r| Ran::of(r)).collect(), problems }
    }

    pub(super) fn ran(&self, method: Method) -> Option<&Ran> {
        self.runs.iter().find(|r| r.method == method)
    }

    pub(super) fn has_estimate(&self, method: Method) -> bool {
        self.ran(method).is_some_and(|r| r.status == Status::Converged)
    }

    pub(super) fn weak(&self) -> Option<&InstrumentResult> {
        self.diagnosis.instruments.as_ref().filter(|i| i.smallest_f < WEAK)
    }

    pub(super) fn verdict(&self) -> Option<Comparison> {
        self.diagnosis.biased_simulator.as_ref().map(|b| b.verdict)
    }

    pub(super) fn ls_differs(&self) -> Option<&EndogeneityResult> {
        self.diagnosis.endogeneity.as_ref().filter(|e| self.weak().is_none() && e.verdict == Comparison::Alarm)
    }
}
