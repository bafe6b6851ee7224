//! Which method's numbers to take, and why: the rules of `docs/diagnostics.md`.

use crate::{
    identification::{Design, Method, Needs, Status},
    results::{
        Advice, BiasExplanation, BiasedSimulatorResult, CaseDiagnosis, EndogeneityResult, InstrumentResult, RunResult,
        Verdict,
    },
    simulation::BiasKind,
};

/// F statistic below which instruments are weak (D. Staiger, J. H. Stock, 1997).
const WEAK: f64 = 10.0;
/// Part of the statistic, percent, from which an error of the simulator is said to explain it, and how much less the next
/// one explains.
const EXPLAINS: f64 = 80.0;
const LEAD: f64 = 20.0;

/// The advice for one case, from its runs and its diagnosis.
pub(crate) fn advise(diagnosis: &CaseDiagnosis, runs: &[RunResult]) -> Advice {
    let of_case = runs.iter().filter(|r| r.case == diagnosis.case).map(Ran::of).collect();
    Adviser { diagnosis, runs: of_case }.advice()
}

/// What the advice needs of a run.
#[derive(Debug, Clone, Copy)]
struct Ran {
    method: Method,
    status: Status,
    /// Relative errors, percent: of the fit, and on data that it has not seen.
    fit: Option<f64>,
    unseen: Option<f64>,
    /// How far its classical standard deviations are too small.
    widening: Option<f64>,
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

/// One case.
struct Adviser<'a> {
    diagnosis: &'a CaseDiagnosis,
    runs: Vec<Ran>,
}

impl Adviser<'_> {
    fn advice(&self) -> Advice {
        let distrust: Vec<Method> = self.runs.iter().map(|r| r.method).filter(|m| self.distrusts(*m)).collect();
        let take = self.take();
        let sentences = [self.estimates(take), self.simulator()];
        let said: Vec<&str> = sentences.iter().map(|s| s.trim()).filter(|s| !s.is_empty()).collect();
        Advice { case: self.diagnosis.case.clone(), take, distrust, text: said.join(" ") }
    }

    fn ran(&self, method: Method) -> Option<&Ran> {
        self.runs.iter().find(|r| r.method == method)
    }

    fn has_estimate(&self, method: Method) -> bool {
        self.ran(method).is_some_and(|r| r.status == Status::Converged)
    }

    fn weak(&self) -> Option<&InstrumentResult> {
        self.diagnosis.instruments.as_ref().filter(|i| i.smallest_f < WEAK)
    }

    fn verdict(&self) -> Option<Verdict> {
        self.diagnosis.biased_simulator.as_ref().map(|b| b.verdict)
    }

    fn ls_differs(&self) -> Option<&EndogeneityResult> {
        self.diagnosis.endogeneity.as_ref().filter(|e| self.weak().is_none() && e.verdict == Verdict::Alarm)
    }

    /// Whether a method that was run is not to be trusted.
    fn distrusts(&self, method: Method) -> bool {
        let is_ls = method.needs() == Needs::Measurement;
        let is_didim = method.needs() == Needs::Instruments && method.design() == Design::Simulated;
        let by_ls = is_ls && self.ls_differs().is_some();
        let by_instruments = !is_ls && self.weak().is_some();
        let by_simulator = is_didim && self.verdict().is_some_and(Verdict::distrusts);
        by_ls || by_instruments || by_simulator || !self.has_estimate(method)
    }

    /// IV wherever its instruments are strong, since it needs no exact simulator; then LS, then DIDIM. None of them where
    /// DIDIM and IV differ and it cannot be told which is wrong.
    fn take(&self) -> Option<Method> {
        if self.verdict() == Some(Verdict::Undecided) {
            return None;
        }
        [Method::IDIM_IV, Method::IDIM_LS, Method::DIDIM]
            .into_iter()
            .find(|m| self.ran(*m).is_some() && !self.distrusts(*m))
    }

    /// The sentence on what to take.
    fn estimates(&self, take: Option<Method>) -> String {
        match take {
            Some(method) if method == Method::IDIM_IV => self.take_iv(),
            Some(method) if method == Method::IDIM_LS => self.take_ls(),
            Some(method) => {
                format!("Take {method} with care: no other method has an estimate that can be trusted.")
            }
            None if self.verdict() == Some(Verdict::Undecided) => {
                "Take no method's numbers as they are: the measured motion or the simulator is wrong.".to_owned()
            }
            None if self.runs.iter().any(|r| r.status == Status::Converged) => {
                format!("Take none of these estimates. {}", self.weak().map(weak_text).unwrap_or_default())
            }
            None => "No method has an estimate to take.".to_owned(),
        }
    }

    fn take_iv(&self) -> String {
        let instruments = self.diagnosis.instruments.as_ref();
        let strong = instruments
            .map(|i| format!("its weakest instrument, {}, has F = {}", i.weakest, short(i.smallest_f)))
            .unwrap_or_else(|| "it needs no exact simulator".to_owned());
        let ls = self.has_estimate(Method::IDIM_LS);
        match (&self.diagnosis.endogeneity, ls) {
            (Some(e), true) if e.verdict == Verdict::Alarm => format!(
                "Take idim-iv, distrust idim-ls: they differ by {} standard deviations on average, most in {} \
                 (Durbin-Wu-Hausman {}), and {strong}.",
                short(e.average_difference),
                most(e),
                p_value(e.robust.p_value),
            ),
            (Some(e), true) => format!(
                "Take idim-iv, or idim-ls, which differs from it by {} standard deviations on average \
                 (Durbin-Wu-Hausman {}), {}; {strong}.",
                short(e.average_difference),
                p_value(e.robust.p_value),
                if e.verdict == Verdict::Agree { "no more than chance" } else { "too little to matter" },
            ),
            (None, true) => format!("Take idim-iv or idim-ls; {strong}."),
            (_, false) => format!("Take idim-iv; {strong}."),
        }
    }

    fn take_ls(&self) -> String {
        let why = match (self.weak(), self.ran(Method::IDIM_IV)) {
            (Some(weak), _) => weak_text(weak),
            (None, Some(_)) => "idim-iv has no converged estimate to test it.".to_owned(),
            (None, None) => "Nothing tests it: idim-iv, which needs [controller], was not run.".to_owned(),
        };
        let numbers = self.ran(Method::IDIM_LS).map(ls_numbers).unwrap_or_default();
        format!("Take idim-ls{numbers}. {why}")
    }

    /// The sentence on DIDIM; empty where it was not run.
    fn simulator(&self) -> String {
        match (&self.diagnosis.biased_simulator, self.ran(Method::DIDIM)) {
            (_, None) => String::new(),
            (_, Some(run)) if run.status != Status::Converged => "didim has no converged estimate.".to_owned(),
            (None, Some(_)) => "didim could not be compared with idim-iv.".to_owned(),
            (Some(test), Some(_)) if self.weak().is_some() && !test.verdict.distrusts() => String::new(),
            (Some(test), Some(_)) => simulator_text(test),
        }
    }
}

/// How an LS estimate fits what it has and has not seen, and how far its classical deviations are too small.
fn ls_numbers(run: &Ran) -> String {
    let unseen = run.unseen.zip(run.fit).map(|(unseen, fit)| {
        format!("its error is {} % on data that it has not seen, {} % on its own", short(unseen), short(fit))
    });
    let wider =
        run.widening.map(|w| format!("its deviations with correlated errors are {} times the classical", short(w)));
    let all: Vec<String> = unseen.into_iter().chain(wider).collect();
    if all.is_empty() { String::new() } else { format!(": {}", all.join("; ")) }
}

fn weak_text(weak: &InstrumentResult) -> String {
    format!(
        "Distrust idim-iv and didim: the simulated motion does not follow the measured one, its weakest instrument, {}, \
         has F = {} where {WEAK} is the least to go by.",
        weak.weakest,
        short(weak.smallest_f),
    )
}

fn simulator_text(test: &BiasedSimulatorResult) -> String {
    let numbers = format!(
        "{} standard deviations on average (biased simulator test {}, 5 % threshold {})",
        short(test.average_difference),
        short(test.statistic),
        short(test.threshold)
    );
    let ratio = short(test.residual_ratio);
    match test.verdict {
        Verdict::Agree => format!("didim differs from idim-iv by {numbers}: no more than noise, the simulator passes."),
        Verdict::SmallDifference => format!(
            "didim differs from idim-iv by {numbers}: the simulator is not exact, but the difference stays below the {} that \
             would matter.",
            test.harmless_below
        ),
        Verdict::Unclear => format!(
            "Distrust didim: it differs from idim-iv by {numbers}, no more than chance, but only because the simulated \
             motion is so far from the measured one: its residual is {ratio} times that of idim-iv."
        ),
        Verdict::Undecided => format!(
            "didim differs from idim-iv by {numbers}, most in {}, and explains the torques better, with {ratio} times its \
             residual: so it may be the filter, or the sign of small velocities. Raise [signal] cutoff_hz or leave out \
             stretches at rest, and compare again.",
            names(test)
        ),
        Verdict::Alarm => {
            format!("Distrust didim: it differs from idim-iv by {numbers}, most in {}{}.", names(test), cause(test))
        }
    }
}

fn names(test: &BiasedSimulatorResult) -> String {
    test.parameters.iter().take(3).map(|p| p.name.as_str()).collect::<Vec<_>>().join(", ")
}

/// The error of the simulator that explains the difference, where one does and no other comes near it.
fn cause(test: &BiasedSimulatorResult) -> String {
    let explained = |k: usize| test.explanations.get(k).map_or(0.0, |e| e.explained_percent);
    match test.explanations.first() {
        Some(best) if explained(0) >= EXPLAINS && explained(0) - explained(1) >= LEAD => {
            best.simulator_to_true.map_or_else(nothing_explains, |value| explained_by(best, value))
        }
        _ => nothing_explains(),
    }
}

fn nothing_explains() -> String {
    "; no single error of gear ratios, drive gains or delay explains it".to_owned()
}

fn explained_by(best: &BiasExplanation, value: f64) -> String {
    let deviation = best.standard_deviation.unwrap_or_default();
    let decimals = (1.0 - deviation.abs().log10().floor()).clamp(0.0, 8.0) as usize;
    let part = short(best.explained_percent);
    if best.kind == BiasKind::Delay {
        let (decimals, value, deviation) = (decimals.saturating_sub(3), 1e3 * value, 1e3 * deviation);
        return format!(
            "; a simulator that is {value:.decimals$} ± {deviation:.decimals$} ms later than the robot would explain \
             {part} % of it"
        );
    }
    format!(
        "; {} at {value:.decimals$} ± {deviation:.decimals$} of the true ones in the simulator would explain {part} % of it",
        best.kind.name()
    )
}

fn most(e: &EndogeneityResult) -> String {
    e.parameters.iter().take(3).map(|p| p.name.as_str()).collect::<Vec<_>>().join(", ")
}

/// Three digits of a number, without a power of ten up to a million.
fn short(value: f64) -> String {
    let places = if value == 0.0 { 0.0 } else { 2.0 - value.abs().log10().floor() };
    if !(-4.0..=4.0).contains(&places) {
        return format!("{value:.1e}");
    }
    let rounded = (value * 10_f64.powf(places)).round() / 10_f64.powf(places);
    format!("{rounded}")
}

fn p_value(p: f64) -> String {
    if p < 1e-4 { "p < 0.0001".to_owned() } else { format!("p = {p:.4}") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        results::ParameterDifference,
        statistics::{ChiSquaredTest, FTest},
    };

    const METHODS: [Method; 3] = [Method::IDIM_LS, Method::IDIM_IV, Method::DIDIM];
    const VERDICTS: [Verdict; 5] =
        [Verdict::Agree, Verdict::SmallDifference, Verdict::Alarm, Verdict::Unclear, Verdict::Undecided];

    fn differing() -> Vec<ParameterDifference> {
        vec![ParameterDifference { name: "fv1".to_owned(), difference: 1.0, deviations: 2.0 }]
    }

    fn endogeneity(verdict: Verdict) -> EndogeneityResult {
        EndogeneityResult {
            classical: FTest { statistic: 5.0, numerator_freedom: 3, denominator_freedom: 100, p_value: 0.01 },
            robust: ChiSquaredTest { statistic: 5.0, freedom: 3, p_value: 0.01 },
            average_difference: 1.0,
            parameters: differing(),
            verdict,
        }
    }

    fn instruments(smallest_f: f64) -> InstrumentResult {
        let (f_statistics, weakest) = (vec![smallest_f], "fv1".to_owned());
        InstrumentResult { f_statistics, smallest_f, weakest, rank: 1, condition_number: 1.0 }
    }

    fn simulator(verdict: Verdict) -> BiasedSimulatorResult {
        BiasedSimulatorResult {
            statistic: 50.0,
            freedom: 1,
            threshold: 10.0,
            p_value: 0.005,
            draws: 199,
            seed: 1,
            average_difference: 1.0,
            residual_ratio: 1.1,
            harmless_below: 0.5,
            verdict,
            parameters: differing(),
            joint_percent: vec![100.0],
            explanations: vec![explanation(Some(0.9), 97.0)],
        }
    }

    fn explanation(simulator_to_true: Option<f64>, explained_percent: f64) -> BiasExplanation {
        let standard_deviation = simulator_to_true.map(|_| 0.01);
        BiasExplanation { kind: BiasKind::GearRatio, simulator_to_true, standard_deviation, explained_percent }
    }

    /// Every combination of what was run, how it ended, and what the tests say.
    fn all(each: &mut dyn FnMut(&Adviser<'_>, &Advice)) {
        let ends = [None, Some(Status::Converged), Some(Status::IterationLimit), Some(Status::Diverged)];
        for code in 0..ends.len().pow(3) {
            let end = |k: u32| ends[code / ends.len().pow(k) % ends.len()];
            let ran = |(k, method): (usize, &Method)| {
                let status = end(k as u32)?;
                Some(Ran { method: *method, status, fit: Some(5.0), unseen: Some(7.0), widening: Some(2.0) })
            };
            let runs: Vec<Ran> = METHODS.iter().enumerate().filter_map(ran).collect();
            let converged = |m: Method| runs.iter().any(|r| r.method == m && r.status == Status::Converged);
            for (ls, verdict, f) in
                VERDICTS.iter().flat_map(|ls| VERDICTS.iter().flat_map(move |v| [3.0, 300.0].map(|f| (*ls, *v, f))))
            {
                let diagnosis = CaseDiagnosis {
                    case: "nominal".to_owned(),
                    endogeneity: converged(Method::IDIM_IV).then(|| endogeneity(ls)),
                    instruments: converged(Method::IDIM_IV).then(|| instruments(f)),
                    biased_simulator: converged(Method::DIDIM).then(|| simulator(verdict)),
                };
                let adviser = Adviser { diagnosis: &diagnosis, runs: runs.clone() };
                each(&adviser, &adviser.advice());
            }
        }
    }

    #[test]
    fn what_is_taken_was_run_has_an_estimate_and_is_not_distrusted() {
        all(&mut |adviser, advice| {
            let what = || format!("{:?} {:?}: {advice:?}", adviser.runs, adviser.diagnosis);
            if let Some(method) = advice.take {
                assert!(adviser.has_estimate(method) && !advice.distrust.contains(&method), "{}", what());
                let name = method.name();
                assert!(advice.text.starts_with(&format!("Take {name}")), "{}", what());
            }
            assert!(advice.distrust.iter().all(|m| adviser.ran(*m).is_some()), "{}", what());
            assert!(advice.text.ends_with('.') && !advice.text.contains("  "), "{}", what());
        });
    }

    #[test]
    fn what_the_text_distrusts_is_in_the_list() {
        all(&mut |adviser, advice| {
            for method in METHODS.into_iter().filter(|m| adviser.ran(*m).is_some()) {
                let said = advice.text.contains(&format!("istrust {}", method.name()));
                assert!(!said || advice.distrust.contains(&method), "{:?}: {advice:?}", adviser.runs);
            }
            let passes = advice.text.contains("the simulator passes");
            assert!(!passes || !advice.distrust.contains(&Method::DIDIM), "{advice:?}");
        });
    }

    #[test]
    fn a_cause_is_named_where_it_explains_the_difference_and_no_other_does() {
        let named = |explanations: Vec<BiasExplanation>| {
            cause(&BiasedSimulatorResult { explanations, ..simulator(Verdict::Alarm) }).contains("gear ratios at 0.900")
        };
        assert!(named(vec![explanation(Some(0.9), 97.0), explanation(Some(0.5), 60.0)]));
        assert!(!named(vec![explanation(Some(0.9), 70.0)]));
        assert!(!named(vec![explanation(Some(0.9), 85.0), explanation(Some(0.5), 75.0)]));
        assert!(!named(vec![explanation(None, 95.0), explanation(Some(0.9), 60.0)]));
        assert!(!named(Vec::new()));
    }
}
