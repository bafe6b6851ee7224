use super::{comparison::HARMLESS_BELOW, problems::Problems};
use thetahat_estimation::{
    identification::{Method, Status},
    statistics::median,
};
use thetahat_report::results::{
    CaseDiagnosis, Comparison, EndogeneityResult, InstrumentResult, ParameterResult, RecordingFindings, RunResult,
};

/// F statistic below which instruments are weak (D. Staiger, J. H. Stock, 1997).
pub(super) const WEAK: f64 = 10.0;
/// Root mean square of the differences of estimates, in their standard deviations, from which two methods contradict each other:
/// on the TX40 CLIE and DIDIM differ from IV by 0.3.
const CONTRADICTING: f64 = 3.0;
/// Times that the deviations of IV are those of LS from which its instruments say too little: together with a difference below
/// half a deviation of IV, the mean square error of LS is at most half of the one of IV.
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
    /// How far methods that fit the simulated loop are from those that use the measured motion.
    pub(super) distances: Vec<Distance>,
    pub(super) problems: Problems,
}

/// The difference of two estimates.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Distance {
    /// The method that fits the simulated loop, and the one that uses the measured motion.
    pub(super) methods: [Method; 2],
    /// Root mean square over the parameters, in standard deviations of the difference.
    pub(super) rms: f64,
    /// The parameter that differs most.
    pub(super) most: String,
}

impl Distance {
    /// None if a method has no estimate with deviations.
    fn of(methods: [Method; 2], runs: &[&RunResult]) -> Option<Self> {
        let [of_loop, measured] = methods.map(|method| converged(runs, method));
        let (of_loop, measured) = (of_loop?, measured?);
        let difference = |p: &ParameterResult| {
            let other = measured.parameter(&p.name)?;
            let deviation = p.deviation()?.hypot(other.deviation()?);
            Some(((p.estimate - other.estimate).abs() / deviation, p.name.clone())).filter(|(d, _)| d.is_finite())
        };
        let all: Vec<(f64, String)> = of_loop.parameters.iter().filter_map(difference).collect();
        let rms = (all.iter().map(|(d, _)| d * d).sum::<f64>() / all.len().max(1) as f64).sqrt();
        let most = all.into_iter().max_by(|a, b| a.0.total_cmp(&b.0))?.1;
        Some(Self { methods, rms, most })
    }
}

impl<'a> Evidence<'a> {
    /// The runs of a case with its diagnosis.
    pub(super) fn of(diagnosis: &'a CaseDiagnosis, runs: &[RunResult], findings: &[RecordingFindings]) -> Self {
        let own: Vec<&RunResult> = runs.iter().filter(|r| r.case == diagnosis.case).collect();
        let problems = Problems::of(findings, &own);
        let pairs = [Method::CLIE, Method::CLOE].map(|m| [[m, Method::IDIM_IV], [m, Method::IDIM_LS]]);
        let distances = pairs.as_flattened().iter().filter_map(|pair| Distance::of(*pair, &own)).collect();
        let runs = own.iter().map(|r| Ran::of(r)).collect();
        Self { diagnosis, runs, iv_to_ls: deviations_to_ls(&own), distances, problems }
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

    /// How far a method is from IV, or where that has no strong estimate from LS, where it contradicts it.
    pub(super) fn contradiction(&self, method: Method) -> Option<&Distance> {
        let by = |measured: Method| self.distances.iter().find(|d| d.methods == [method, measured]);
        let iv = by(Method::IDIM_IV).filter(|_| self.weak().is_none());
        iv.or_else(|| by(Method::IDIM_LS)).filter(|d| d.rms > CONTRADICTING)
    }

    pub(super) fn verdict(&self) -> Option<Comparison> {
        self.diagnosis.biased_simulator.as_ref().map(|b| b.verdict)
    }

    pub(super) fn ls_differs(&self) -> Option<&EndogeneityResult> {
        self.diagnosis.endogeneity.as_ref().filter(|e| self.weak().is_none() && e.verdict == Comparison::Alarm)
    }
}

fn converged<'r>(runs: &[&'r RunResult], method: Method) -> Option<&'r RunResult> {
    runs.iter().find(|r| r.method == method && r.status == Status::Converged).copied()
}

/// Median over the parameters of the standard deviation of IV over that of LS.
fn deviations_to_ls(runs: &[&RunResult]) -> Option<f64> {
    let (ls, iv) = (converged(runs, Method::IDIM_LS)?, converged(runs, Method::IDIM_IV)?);
    let ratio = |p: &ParameterResult| Some(p.deviation()? / ls.parameter(&p.name)?.deviation()?);
    let ratios: Vec<f64> = iv.parameters.iter().filter_map(ratio).filter(|r| r.is_finite()).collect();
    (!ratios.is_empty()).then(|| median(&ratios))
}
