use super::{comparison::HARMLESS_BELOW, problems::Problems};
use crate::{
    identification::{Method, Status},
    results::{
        CaseDiagnosis, Comparison, EndogeneityResult, InstrumentResult, ParameterResult, RecordingFindings, RunResult,
    },
};

/// F statistic below which instruments are weak (D. Staiger, J. H. Stock, 1997).
pub(super) const WEAK: f64 = 10.0;
/// Times that the deviations of IV are those of LS from which its instruments say too little: together with a difference below
/// half a deviation of IV, the mean square error of LS is at most half of that of IV.
const WASTEFUL: f64 = 2.0;

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
    /// Median over the parameters of the deviation of IV over that of LS.
    pub(super) iv_to_ls: Option<f64>,
    pub(super) problems: Problems,
}

impl<'a> Evidence<'a> {
    /// The runs of a case beside its diagnosis.
    pub(super) fn of(diagnosis: &'a CaseDiagnosis, runs: &[RunResult], findings: &[RecordingFindings]) -> Self {
        let own: Vec<&RunResult> = runs.iter().filter(|r| r.case == diagnosis.case).collect();
        let problems = Problems::of(findings, &own);
        let iv_to_ls = deviations_to_ls(&own);
        Self { diagnosis, runs: own.iter().map(|r| Ran::of(r)).collect(), iv_to_ls, problems }
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

    /// How many times as uncertain as LS IV is, and their comparison, where IV brings nothing for it.
    pub(super) fn wasteful_iv(&self) -> Option<(f64, &EndogeneityResult)> {
        let ratio = self.iv_to_ls.filter(|r| *r >= WASTEFUL && self.has_estimate(Method::IDIM_LS))?;
        let close = self.diagnosis.endogeneity.as_ref().filter(|e| e.average_difference < HARMLESS_BELOW)?;
        Some((ratio, close))
    }

    pub(super) fn verdict(&self) -> Option<Comparison> {
        self.diagnosis.biased_simulator.as_ref().map(|b| b.verdict)
    }

    pub(super) fn ls_differs(&self) -> Option<&EndogeneityResult> {
        self.diagnosis.endogeneity.as_ref().filter(|e| self.weak().is_none() && e.verdict == Comparison::Alarm)
    }
}

/// Median over the parameters of the standard deviation of IV over that of LS; of correlated errors, where both have it.
fn deviations_to_ls(runs: &[&RunResult]) -> Option<f64> {
    let of = |method: Method| runs.iter().find(|r| r.method == method && r.status == Status::Converged);
    let (ls, iv) = (of(Method::IDIM_LS)?, of(Method::IDIM_IV)?);
    let ratio = |of_iv: &ParameterResult| {
        let of_ls = ls.parameter(&of_iv.name)?;
        let correlated = of_iv.standard_deviation_robust.zip(of_ls.standard_deviation_robust);
        let (iv, ls) = correlated.or(of_iv.standard_deviation.zip(of_ls.standard_deviation))?;
        Some(iv / ls).filter(|r| r.is_finite())
    };
    let mut ratios: Vec<f64> = iv.parameters.iter().filter_map(ratio).collect();
    ratios.sort_by(f64::total_cmp);
    ratios.get(ratios.len() / 2).copied()
}
