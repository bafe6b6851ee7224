//! The verdict card for the terminal.

use super::{
    grades::counted,
    number::{fixed, significant},
    wrap::{TextWidth, labelled},
};
use crate::results::{Card, Grade, Physical, Results, Unseen, Verdict};

/// Columns of the labels.
const LABEL: usize = 12;

/// Reasons on the card.
const REASONS: usize = 3;

/// The verdict in a few words, with a symbol that tells it without colour.
#[must_use]
pub fn headline(results: &Results) -> String {
    headline_of(&results.card())
}

fn headline_of(card: &Card) -> String {
    let case = card.case.as_ref().map(|case| format!(" ({case})")).unwrap_or_default();
    let take = card.method.map_or_else(|| "no method has numbers to take".to_owned(), |m| format!("take {m}{case}"));
    match card.verdict {
        Some(Verdict::Good) => format!("\u{2713} GOOD: {take}"),
        Some(Verdict::Care) => format!("! CARE: {take}, read why"),
        Some(Verdict::DoNotUse) => "\u{2717} DO NOT USE these numbers".to_owned(),
        None => format!("? NOT JUDGED: {take}"),
    }
}

/// The numbers, what the verdict rests on, and what to do next: the lines above the headline, which ends what is printed.
#[must_use]
pub fn card_text(results: &Results, width: TextWidth) -> String {
    let card = results.card();
    let because = because(results).into_iter().map(|text| ("because", text));
    let next = if card.verdict == Some(Verdict::Good) { "to improve" } else { "next" };
    let numbered = |(number, action): (usize, &String)| {
        let label = if number == 0 { next } else { "" };
        (label, format!("{}. {action}", number + 1))
    };
    let lines = facts(&card).into_iter().chain(because).chain(card.actions.iter().enumerate().map(numbered));
    lines.map(|(label, text)| labelled(label, &text, LABEL, width)).collect()
}

/// Errors, the worst joint and what is known of the parameters; nothing where no method has numbers to take.
fn facts(card: &Card) -> Vec<(&'static str, String)> {
    let Some(method) = card.method else { return Vec::new() };
    let worst = |(name, percent): &(String, f64)| format!("{name}, {} %", significant(*percent, 3));
    let facts = [
        card.relative_error_percent.map(|error| ("error", format!("{} %{}", significant(error, 3), unseen(card)))),
        card.worst_joint.as_ref().map(|joint| ("worst joint", worst(joint))),
        card.physical
            .filter(|_| card.verdict != Some(Verdict::DoNotUse))
            .map(|physical| ("physical", physically(physical).to_owned())),
        Some(("parameters", known(card))),
        to_use(card).map(|names| ("to use", names)),
    ];
    let method = (card.verdict == Some(Verdict::DoNotUse)).then(|| ("method", format!("{method}, of those that ran")));
    method.into_iter().chain(facts.into_iter().flatten()).collect()
}

fn unseen(card: &Card) -> String {
    let Some(unseen) = card.unseen else { return "; not validated".to_owned() };
    let on = match unseen {
        Unseen::HeldBack(_) => "on what was held back",
        Unseen::LeftOut(_) => "on parts left out in turn",
    };
    let times = card.times_unseen().map(|times| format!(" ({} times)", fixed(times, 1))).unwrap_or_default();
    format!("; unseen {} %{times}, {on}", significant(unseen.percent(), 3))
}

/// Whether a robot made of bodies has the estimates.
pub(super) fn physically(physical: Physical) -> &'static str {
    match physical {
        Physical::Yes => "yes, a robot can have these numbers",
        Physical::WithinNoise => "not exactly, but within noise",
        Physical::No => "no robot has these numbers as they stand",
    }
}

/// How many parameters have each grade; none where no number is to be used.
fn known(card: &Card) -> String {
    if card.verdict == Some(Verdict::DoNotUse) {
        return "none to use".to_owned();
    }
    let counts = Grade::ALL.into_iter().zip(card.parameters.iter().map(Vec::len));
    let doubt = if card.model_is_doubted { "; grades hold if the model does" } else { "" };
    format!("{} of {}{doubt}", counted(counts), card.parameter_count())
}

/// The names of the parameters that can be used one by one, where numbers are to be used.
fn to_use(card: &Card) -> Option<String> {
    let [precise, ..] = &card.parameters;
    let all = card.parameter_count();
    let rest = if precise.len() < all { format!("; predicting torques takes all {all}") } else { String::new() };
    (card.verdict != Some(Verdict::DoNotUse) && !precise.is_empty()).then(|| precise.join(" ") + &rest)
}

/// The gravest reasons, and how many more there are.
fn because(results: &Results) -> Vec<String> {
    let reasons = &results.verdict_reasons;
    let mut lines: Vec<String> = reasons.iter().take(REASONS).map(|r| format!("{} [{}]", r.seen(), r.code)).collect();
    let more = reasons.len().saturating_sub(REASONS);
    let plural = if more == 1 { "" } else { "s" };
    lines.extend((more > 0).then(|| format!("{more} more reason{plural}, with --full")));
    lines
}
