//! The advice in words.

use super::evidence::{Distance, Evidence, Ran, WEAK};
use thetahat_estimation::{
    identification::{Method, Status},
    simulation::BiasKind,
};
use thetahat_report::results::{
    BiasExplanation, BiasedSimulatorResult, Comparison, EndogeneityResult, InstrumentResult,
};

/// Part of the statistic, percent, from which an error of the simulator is said to explain it, and how much less the next
/// one explains.
const EXPLAINS: f64 = 80.0;
const LEAD: f64 = 20.0;

/// The sentence on what to take.
pub(super) fn on_estimates(evidence: &Evidence<'_>, take: Option<Method>) -> String {
    match take {
        Some(method) if method == Method::IDIM_IV => take_iv(evidence),
        Some(method) if method == Method::IDIM_LS => take_ls(evidence),
        Some(method) => {
            format!("Take {method} with care: no other method has an estimate that can be trusted.")
        }
        None if evidence.verdict() == Some(Comparison::Undecided) => {
            "Take no method's numbers as they are: the measured motion or the simulator is wrong.".to_owned()
        }
        None if evidence.runs.iter().any(|r| r.status == Status::Converged) => {
            format!("Take none of these estimates. {}", evidence.weak().map(weak_text).unwrap_or_default())
        }
        None => "No method has an estimate to take.".to_owned(),
    }
}

fn take_iv(evidence: &Evidence<'_>) -> String {
    let instruments = evidence.diagnosis.instruments.as_ref();
    let strong = instruments
        .map(|i| format!("its weakest instrument, {}, has F = {}", i.weakest, short(i.smallest_f)))
        .unwrap_or_else(|| "it needs no exact simulator".to_owned());
    let ls = evidence.has_estimate(Method::IDIM_LS);
    match (&evidence.diagnosis.endogeneity, ls) {
        (Some(e), true) if e.verdict == Comparison::Alarm => format!(
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
            if e.verdict == Comparison::Agree { "no more than chance" } else { "detectable but negligible" },
        ),
        (None, true) => format!("Take idim-iv or idim-ls; {strong}."),
        (_, false) => format!("Take idim-iv; {strong}."),
    }
}

fn take_ls(evidence: &Evidence<'_>) -> String {
    let why = match (evidence.weak(), evidence.wasteful_iv(), evidence.ran(Method::IDIM_IV)) {
        (Some(weak), _, _) => weak_text(weak),
        (None, Some((ratio, close)), _) => wasteful_text(ratio, close),
        (None, None, Some(_)) => "idim-iv has no converged estimate to test it.".to_owned(),
        (None, None, None) => "Nothing tests it: idim-iv was not run; add it to methods in [estimation].".to_owned(),
    };
    let numbers = evidence.ran(Method::IDIM_LS).map(ls_numbers).unwrap_or_default();
    format!("Take idim-ls{numbers}. {why}")
}

/// The sentence on DIDIM; empty where it was not run.
pub(super) fn on_simulator(evidence: &Evidence<'_>) -> String {
    match (&evidence.diagnosis.biased_simulator, evidence.ran(Method::DIDIM)) {
        (_, None) => String::new(),
        (_, Some(run)) if run.status != Status::Converged => "didim has no converged estimate.".to_owned(),
        (None, Some(_)) => "didim could not be compared with idim-iv.".to_owned(),
        (Some(test), Some(_)) if evidence.weak().is_some() && !test.verdict.distrusts() => String::new(),
        (Some(test), Some(_)) => simulator_text(test) + &same_simulator(evidence, test),
    }
}

/// The sentences on methods whose estimates contradict those of the measured motion.
pub(super) fn on_contradictions(evidence: &Evidence<'_>) -> String {
    let contradictions = [Method::CLIE, Method::CLOE].into_iter().filter_map(|m| evidence.contradiction(m));
    let sentence = |distance: &Distance| {
        let [method, measured] = distance.methods;
        format!(
            "Distrust {method}: it differs from {measured} by {} standard deviations (rms), most in {}.",
            short(distance.rms),
            distance.most
        )
    };
    contradictions.map(sentence).collect::<Vec<_>>().join(" ")
}

/// What an alarm about the simulator means for the other methods that fit it; empty where none was run.
fn same_simulator(evidence: &Evidence<'_>, test: &BiasedSimulatorResult) -> String {
    let ran: Vec<&str> =
        [Method::CLIE, Method::CLOE].iter().filter(|m| evidence.ran(**m).is_some()).map(|m| m.name()).collect();
    if ran.is_empty() || !test.verdict.distrusts() {
        return String::new();
    }
    format!(" The same simulator is used by {}.", ran.join(" and "))
}

/// How an LS estimate fits what it has and has not seen, and how far its classical deviations are too small.
fn ls_numbers(run: &Ran) -> String {
    let unseen = run
        .unseen
        .zip(run.fit)
        .map(|(unseen, fit)| format!("its unseen error is {} %, that of its fit {} %", short(unseen), short(fit)));
    let wider =
        run.widening.map(|w| format!("its deviations with correlated errors are {} times the classical", short(w)));
    let all: Vec<String> = unseen.into_iter().chain(wider).collect();
    if all.is_empty() { String::new() } else { format!(": {}", all.join("; ")) }
}

fn wasteful_text(ratio: f64, close: &EndogeneityResult) -> String {
    format!(
        "idim-iv is {} times as uncertain, since its simulated motion resembles the measured one too little, and differs from \
         idim-ls by {} of its own deviations on average: an error of idim-ls of {} of the deviations of idim-ls would not show.",
        short(ratio),
        short(close.average_difference),
        short(ratio * close.average_difference),
    )
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
        "{} standard deviations on average (biased simulator test {}, 5 % threshold {}, {})",
        short(test.average_difference),
        short(test.statistic),
        short(test.threshold),
        bootstrap_p_value(test)
    );
    let ratio = short(test.residual_ratio);
    match test.verdict {
        Comparison::Agree => {
            format!("didim differs from idim-iv by {numbers}: no more than noise, the simulator passes.")
        }
        Comparison::SmallDifference => format!(
            "didim differs from idim-iv by {numbers}: the simulator is not exact, but the difference stays below the {} that \
             would matter.",
            test.harmless_below
        ),
        Comparison::Unclear => format!(
            "Distrust didim: it differs from idim-iv by {numbers}, no more than chance, but only because the simulated \
             motion is so far from the measured one: its residual is {ratio} times that of idim-iv."
        ),
        Comparison::Undecided => format!(
            "didim differs from idim-iv by {numbers}, most in {}, and explains the torques better, with {ratio} times its \
             residual: the measured motion may be wrong as well as the simulator. A drive signal that is held from sample to \
             sample is recorded half a sample early: say so by held = true next to its columns. Samples near rest have the wrong \
             sign of friction: leave more of them out by a larger velocity in [signal] mask. Then compare again.",
            names(test)
        ),
        Comparison::Alarm => {
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
             {part} % of the difference"
        );
    }
    format!(
        "; {} at {value:.decimals$} ± {deviation:.decimals$} of the true ones in the simulator would explain {part} % of the difference",
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

/// The bootstrap knows no probability below that of one of its draws and the recording itself.
fn bootstrap_p_value(test: &BiasedSimulatorResult) -> String {
    let least = 1.0 / (test.draws + 1) as f64;
    if test.p_value > least { format!("p = {}", short(test.p_value)) } else { format!("p <= {}", short(least)) }
}

fn p_value(p: f64) -> String {
    if p < 1e-4 { "p < 0.0001".to_owned() } else { format!("p = {p:.4}") }
}

#[cfg(test)]
mod tests {
    use super::{
        super::advice::tests::{explanation, simulator},
        *,
    };

    #[test]
    fn a_cause_is_named_where_it_explains_the_difference_and_no_other_does() {
        let named = |explanations: Vec<BiasExplanation>| {
            cause(&BiasedSimulatorResult { explanations, ..simulator(Comparison::Alarm) })
                .contains("gear ratios at 0.900")
        };
        assert!(named(vec![explanation(Some(0.9), 97.0), explanation(Some(0.5), 60.0)]));
        assert!(!named(vec![explanation(Some(0.9), 70.0)]));
        assert!(!named(vec![explanation(Some(0.9), 85.0), explanation(Some(0.5), 75.0)]));
        assert!(!named(vec![explanation(None, 95.0), explanation(Some(0.9), 60.0)]));
        assert!(!named(Vec::new()));
    }
}
