//! The verdict card for the terminal.

use super::{
    grades::counted,
    number::significant,
    wrap::{TextWidth, labelled, wrap_to},
};
use crate::results::{Card, Grade, Results, Unseen, Verdict};

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
    let take = card.method.map_or_else(|| "no method has numbers to take".to_owned(), |m| format!("take {m}"));
    match card.verdict {
        Some(Verdict::Good) => format!("\u{2713} GOOD: {take}"),
        Some(Verdict::Care) => format!("! CARE: {take}, and read why"),
        Some(Verdict::DoNotUse) => "\u{2717} DO NOT USE these numbers".to_owned(),
        None => format!("? NOT JUDGED: {take}"),
    }
}

/// What the verdict rests on, and what to do next: the lines under the headline.
#[must_use]
pub fn card_text(results: &Results, width: TextWidth) -> String {
    let card = results.card();
    let because = because(results, width).into_iter().map(|text| ("because", text));
    let numbered = |(number, action): (usize, &String)| {
        let label = if number == 0 { "next" } else { "" };
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
        Some(("parameters", known(card))),
    ];
    let method = (card.verdict == Some(Verdict::DoNotUse)).then(|| ("method", format!("{method}, of those that ran")));
    method.into_iter().chain(facts.into_iter().flatten()).collect()
}

fn unseen(card: &Card) -> String {
    match card.unseen {
        Some(Unseen::HeldBack(error)) => format!("; unseen {} %, on what was held back", significant(error, 3)),
        Some(Unseen::LeftOut(error)) => format!("; unseen {} %, on parts left out in turn", significant(error, 3)),
        None => "; not validated".to_owned(),
    }
}

/// How many parameters have each grade; none where no number is to be used.
fn known(card: &Card) -> String {
    if card.verdict == Some(Verdict::DoNotUse) {
        return "none to use".to_owned();
    }
    let counts = Grade::ALL.into_iter().zip(card.parameters.iter().map(Vec::len));
    let doubt = if card.model_is_doubted { "; what the model lacks may shift them" } else { "" };
    format!(
        "{} of {}{doubt}",
        counted(counts, card.model_is_doubted),
        card.parameters.iter().map(Vec::len).sum::<usize>()
    )
}

/// As much of a text as stands in two lines of so many characters.
fn first_lines(text: &str, columns: usize) -> String {
    let lines: Vec<String> = wrap_to(text, columns);
    match lines.as_slice() {
        [first, second, _, ..] => format!("{first} {}…", wrap_to(second, columns - 1).swap_remove(0)),
        [] | [_] | [_, _] => lines.join(" "),
    }
}

/// The gravest reasons in two lines each, and how many more there are.
fn because(results: &Results, width: TextWidth) -> Vec<String> {
    let reasons = &results.verdict_reasons;
    let line = |text: &str| first_lines(text, width.columns() - LABEL);
    let mut lines: Vec<String> =
        reasons.iter().take(REASONS).map(|r| line(&format!("[{}] {}", r.code, r.seen()))).collect();
    let more = reasons.len().saturating_sub(REASONS);
    let plural = if more == 1 { "" } else { "s" };
    lines.extend((more > 0).then(|| format!("{more} more reason{plural}, with --full")));
    lines
}
