//! Which method's numbers to take, and why: the rules of `docs/diagnostics.md`.

use super::{Advice, BiasExplanation, BiasedSimulatorResult, CaseDiagnosis, EndogeneityResult, RunResult, Verdict};
use crate::{
    identification::{Method, Status},
    simulation::BiasKind,
};

/// F statistic below which instruments are weak (D. Staiger, J. H. Stock, 1997).
const WEAK: f64 = 10.0;
/// Part of the statistic, percent, from which an error of the simulator is said to explain it.
const EXPLAINS: f64 = 50.0;

/// The advice for one case, from its runs and its diagnosis.
pub(super) fn advise(diagnosis: &CaseDiagnosis, runs: &[RunResult]) -> Advice {
    let of_case: Vec<&RunResult> = runs.iter().filter(|r| r.case == diagnosis.case).collect();
    let good = |m: Method| of_case.iter().any(|r| r.method == m && r.status == Status::Converged);
    let (take, first) = estimates(diagnosis, good);
    let (didim_is_distrusted, second) = simulator(diagnosis, good(Method::Didim), &of_case);
    let unusable = of_case.iter().filter(|r| r.status != Status::Converged).map(|r| r.method);
    let ls = ls_is_distrusted(diagnosis).then_some(Method::IdimLs);
    let iv = weak_instruments(diagnosis).then_some(Method::IdimIv);
    let didim = didim_is_distrusted.then_some(Method::Didim);
    let mut distrust: Vec<Method> = unusable.chain([ls, iv, didim].into_iter().flatten()).collect();
    distrust.sort();
    distrust.dedup();
    Advice { case: diagnosis.case.clone(), take, distrust, text: [first, second].join(" ").trim().to_owned() }
}

fn weak_instruments(diagnosis: &CaseDiagnosis) -> bool {
    diagnosis.instruments.as_ref().is_some_and(|i| i.smallest_f < WEAK)
}

fn ls_is_distrusted(diagnosis: &CaseDiagnosis) -> bool {
    !weak_instruments(diagnosis) && diagnosis.endogeneity.as_ref().is_some_and(|e| e.verdict == Verdict::Alarm)
}

/// LS or IV: IV wherever its instruments are strong, since it needs neither an exact X nor an exact simulator.
fn estimates(diagnosis: &CaseDiagnosis, good: impl Fn(Method) -> bool) -> (Option<Method>, String) {
    let [ls, iv, didim] = [Method::IdimLs, Method::IdimIv, Method::Didim].map(good);
    match (ls, iv, didim) {
        (_, true, _) if !weak_instruments(diagnosis) => (Some(Method::IdimIv), iv_text(diagnosis, ls)),
        (true, true, _) => (Some(Method::IdimLs), weak_text(diagnosis)),
        (true, false, _) => {
            let text = "Take idim-ls: no instruments test it, so what noise in the measured motion does to it is not \
                        known.";
            (Some(Method::IdimLs), text.to_owned())
        }
        (false, false, true) => {
            (Some(Method::Didim), "Take didim with care: no other method has an estimate to test it with.".to_owned())
        }
        (false, true, _) => (Some(Method::IdimIv), weak_text(diagnosis)),
        (false, false, false) => (None, "No method has an estimate to take.".to_owned()),
    }
}

fn iv_text(diagnosis: &CaseDiagnosis, ls: bool) -> String {
    let instruments = diagnosis.instruments.as_ref();
    let strong = instruments.map(|i| format!("its weakest instrument, {}, has F = {}", i.weakest, short(i.smallest_f)));
    let strong = strong.unwrap_or_else(|| "it needs no exact simulator".to_owned());
    match (&diagnosis.endogeneity, ls) {
        (Some(e), true) if e.verdict == Verdict::Alarm => format!(
            "Take idim-iv, distrust idim-ls: they differ by {} standard deviations on average, most in {} \
             (Durbin-Wu-Hausman {}), and {strong}.",
            short(e.average_difference),
            most(e),
            p_value(e.robust.p_value),
        ),
        (Some(e), true) => format!(
            "Take idim-iv, or idim-ls, which differs from it by {} standard deviations on average (Durbin-Wu-Hausman \
             {}), {}; {strong}.",
            short(e.average_difference),
            p_value(e.robust.p_value),
            if e.verdict == Verdict::Agree { "no more than chance" } else { "too little to matter" },
        ),
        (None, true) => format!("Take idim-iv or idim-ls; {strong}."),
        (_, false) => format!("Take idim-iv; {strong}."),
    }
}

fn weak_text(diagnosis: &CaseDiagnosis) -> String {
    let Some(weak) = diagnosis.instruments.as_ref() else { return String::new() };
    format!(
        "Distrust idim-iv and didim: the simulated motion does not follow the measured one well enough, its weakest \
         instrument, {}, has F = {} where {WEAK} is the least to go by.",
        weak.weakest,
        short(weak.smallest_f),
    )
}

/// Whether DIDIM is distrusted, and the sentence that says why or why not.
fn simulator(diagnosis: &CaseDiagnosis, converged: bool, runs: &[&RunResult]) -> (bool, String) {
    let ran = runs.iter().any(|r| r.method == Method::Didim);
    match (&diagnosis.biased_simulator, converged, ran) {
        (_, _, false) => (false, String::new()),
        (_, false, true) => (true, "didim has no converged estimate.".to_owned()),
        (None, true, true) => (weak_instruments(diagnosis), "didim could not be compared with idim-iv.".to_owned()),
        (Some(test), true, true) => (test.verdict.distrusts(), simulator_text(test)),
    }
}

fn simulator_text(test: &BiasedSimulatorResult) -> String {
    let numbers = format!(
        "{} standard deviations on average (biased simulator test {}, 5 % threshold {})",
        short(test.average_difference),
        short(test.statistic),
        short(test.threshold)
    );
    match test.verdict {
        Verdict::Agree => format!("didim differs from idim-iv by {numbers}: no more than noise, the simulator passes."),
        Verdict::SmallDifference => format!(
            "didim differs from idim-iv by {numbers}: the simulator is not exact, but the difference stays below the {} that \
             would matter.",
            test.harmless_below
        ),
        Verdict::Unclear => format!(
            "Distrust didim: it differs from idim-iv by {numbers}, no more than chance, but only because the simulated \
             motion is so far from the measured one: its residual is {} times that of idim-iv.",
            short(test.residual_ratio)
        ),
        Verdict::Alarm => {
            let names: Vec<&str> = test.parameters.iter().take(3).map(|p| p.name.as_str()).collect();
            let best = test.explanations.first().filter(|e| e.explained_percent >= EXPLAINS);
            let why = best.map_or_else(
                || "; no single error of gear ratios, drive gains or delay explains most of it.".to_owned(),
                explained,
            );
            format!("Distrust didim: it differs from idim-iv by {numbers}, most in {}{why}", names.join(", "))
        }
    }
}

fn explained(best: &BiasExplanation) -> String {
    let deviation = best.standard_deviation;
    let decimals = (1.0 - deviation.abs().log10().floor()).clamp(0.0, 8.0) as usize;
    let (value, part) = (best.simulator_to_true, short(best.explained_percent));
    match best.kind {
        BiasKind::Delay => format!(
            "; a simulator that is {:.*} ± {:.*} ms later than the robot would explain {part} % of it.",
            decimals.saturating_sub(3),
            1e3 * value,
            decimals.saturating_sub(3),
            1e3 * deviation
        ),
        kind => format!(
            "; {} at {value:.decimals$} ± {deviation:.decimals$} of the true ones in the simulator would explain {part} % \
             of it.",
            kind.name()
        ),
    }
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
