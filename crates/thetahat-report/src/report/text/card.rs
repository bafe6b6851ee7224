//! The verdict card for the terminal.

use super::grades::counted;
use crate::{
    report::{
        number::significant,
        wrap::{TextWidth, labelled},
    },
    results::{Card, EstimateSource, Grade, ModelUse, Physical, Results, Unseen, UseGrade, Verdict},
};

/// Columns of the labels.
const LABEL: usize = 12;

/// Reasons on the card.
const REASONS: usize = 3;

/// The verdict in a few words, with a symbol that does not need colour.
#[must_use]
pub fn headline(results: &Results) -> String {
    headline_of(&results.card())
}

fn headline_of(card: &Card) -> String {
    let case = card.case.as_ref().map(|case| format!(" ({case})")).unwrap_or_default();
    let method = match card.source {
        Some(EstimateSource::Model) => "use the model".to_owned(),
        Some(EstimateSource::Run(method)) => format!("use {method}{case}"),
        None => "no method is recommended".to_owned(),
    };
    match card.verdict {
        Some(Verdict::Good) => format!("\u{2713} GOOD: {method}"),
        Some(Verdict::Care) => format!("! CARE: {method}, read why"),
        Some(Verdict::DoNotUse) => "\u{2717} DO NOT USE these numbers".to_owned(),
        None => format!("? NOT JUDGED: {method}"),
    }
}

/// The numbers, the reasons of the verdict, and what to do next: the lines above the headline, which is printed last.
#[must_use]
pub fn card_text(results: &Results, width: TextWidth) -> String {
    let card = results.card();
    let because = because(results).into_iter().map(|text| ("because", text));
    let next = if card.verdict == Some(Verdict::Good) { "to improve" } else { "next" };
    let several = card.actions.len() > 1;
    let numbered = |(number, action): (usize, &String)| {
        let label = if number == 0 { next } else { "" };
        (label, if several { format!("{}. {action}", number + 1) } else { action.clone() })
    };
    let lines = facts(&card).into_iter().chain(because).chain(card.actions.iter().enumerate().map(numbered));
    lines.map(|(label, text)| labelled(label, &text, LABEL, width)).collect()
}

/// Errors, the worst joint and the grades of the parameters; empty without a recommended method.
fn facts(card: &Card) -> Vec<(&'static str, String)> {
    let Some(source) = card.source else { return Vec::new() };
    let worst = |(name, percent): &(String, f64)| format!("{name}, {} %", significant(*percent, 3));
    let facts = [
        (!card.uses.is_empty()).then(|| ("use to", uses_in_words(card))),
        why_not_simulate(card).map(|why| ("simulate", why)),
        card.relative_error_percent.map(|error| ("error", format!("{} %{}", significant(error, 3), validation(card)))),
        card.worst_joint.as_ref().map(|joint| ("worst joint", worst(joint))),
        card.physical
            .filter(|_| card.verdict != Some(Verdict::DoNotUse) && card.source != Some(EstimateSource::Model))
            .map(|physical| ("physical", physically(physical).to_owned())),
        Some(("parameters", known(card))),
        quotable(card).map(|names| ("quote", names)),
        hidden(card).map(|errors| ("not shown", errors)),
    ];
    let method =
        (card.verdict == Some(Verdict::DoNotUse)).then(|| ("method", format!("{source} (shown, not recommended)")));
    method.into_iter().chain(facts.into_iter().flatten()).collect()
}

fn validation(card: &Card) -> String {
    let Some(unseen) = card.unseen else { return "; not validated".to_owned() };
    let on = match unseen {
        Unseen::HeldBack(_) => "recordings held back",
        Unseen::LeftOut(_) => "parts left out in turn",
    };
    format!("; {} % on data not used ({on})", significant(unseen.percent(), 3))
}

/// Each use with its verdict, and the condition under which it is good.
pub(in crate::report) fn uses_in_words(card: &Card) -> String {
    let condition = |u: &ModelUse| match u.verdict {
        Verdict::Good if !u.why.is_empty() => format!(" {}", u.why),
        Verdict::Good | Verdict::Care | Verdict::DoNotUse => String::new(),
    };
    let all = card.uses.iter().map(|u| format!("{}: {}{}", u.for_what.words(), u.verdict, condition(u)));
    all.collect::<Vec<_>>().join("; ")
}

/// Why simulations need care where predictions do not: the reasons of the verdict do not say it.
pub(in crate::report) fn why_not_simulate(card: &Card) -> Option<String> {
    let of = |what: UseGrade| card.uses.iter().find(|u| u.for_what == what);
    let predicts = of(UseGrade::PredictTorques)?.verdict == Verdict::Good;
    let simulate = of(UseGrade::Simulate)?;
    (predicts && simulate.verdict == Verdict::Care).then(|| simulate.why.clone())
}

/// Whether the estimates are physically consistent.
pub(in crate::report) fn physically(physical: Physical) -> &'static str {
    match physical {
        Physical::Yes => "yes, physically consistent",
        Physical::WithinNoise => "physically inconsistent, but within noise",
        Physical::No => "physically inconsistent, e.g. a negative inertia; do not simulate with these",
    }
}

/// How many parameters have each grade; none if no number can be used.
fn known(card: &Card) -> String {
    if card.verdict == Some(Verdict::DoNotUse) {
        return "none can be used".to_owned();
    }
    let counts = Grade::ALL.into_iter().zip(card.parameters.iter().map(Vec::len));
    let doubt = if card.model_is_doubted { "; grades are valid only if the model is" } else { "" };
    format!("{} of {}{doubt}", counted(counts), card.parameter_count())
}

/// The names of the parameters that can be quoted one by one, if numbers can be used.
fn quotable(card: &Card) -> Option<String> {
    let [precise, ..] = &card.parameters;
    let all = card.parameter_count();
    let rest = if precise.len() < all { format!(" (to predict torques, use all {all})") } else { String::new() };
    (card.verdict != Some(Verdict::DoNotUse) && !precise.is_empty()).then(|| precise.join(" ") + &rest)
}

/// The errors of the description that the recordings do not show, if values can be quoted: these rest on it.
pub(in crate::report) fn hidden(card: &Card) -> Option<String> {
    let is_quoted = card.verdict != Some(Verdict::DoNotUse) && !card.hidden.is_empty();
    is_quoted.then(|| format!("errors of up to: {}", card.hidden.join(", ")))
}

/// The most serious reasons, and the number of others.
fn because(results: &Results) -> Vec<String> {
    let reasons = &results.verdict_reasons;
    let mut lines: Vec<String> = reasons.iter().take(REASONS).map(|r| format!("{} [{}]", r.seen(), r.code)).collect();
    let more = reasons.len().saturating_sub(REASONS);
    let plural = if more == 1 { "" } else { "s" };
    lines.extend((more > 0).then(|| format!("{more} more reason{plural} in the report")));
    lines
}
