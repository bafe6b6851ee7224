//! The verdict card for the terminal.

use super::{
    grades::{counted, word},
    number::significant,
    wrap::{TextWidth, labelled, wrap_to},
};
use crate::results::{Card, Grade, Results, Unseen, Verdict};

/// Columns of the labels.
const LABEL: usize = 12;

/// Reasons on the card.
const REASONS: usize = 3;

/// Lines of names on the card.
const NAMES: usize = 2;

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
    let lines = facts(&card, width).into_iter().chain(because).chain(card.actions.iter().enumerate().map(numbered));
    lines.map(|(label, text)| labelled(label, &text, LABEL, width)).collect()
}

/// Errors, the worst joint and what is known of the parameters; nothing where no method has numbers to take.
fn facts(card: &Card, width: TextWidth) -> Vec<(&'static str, String)> {
    let Some(method) = card.method else { return Vec::new() };
    let worst = |(name, percent): &(String, f64)| format!("{name}, {} %", significant(*percent, 3));
    let facts = [
        card.relative_error_percent.map(|error| ("error", format!("{} %{}", significant(error, 3), unseen(card)))),
        card.worst_joint.as_ref().map(|joint| ("worst joint", worst(joint))),
        Some(("parameters", known(card))),
        sure(card, width).map(|names| (word(Grade::Sure, card.model_is_doubted), names)),
    ];
    let method = (card.verdict == Some(Verdict::DoNotUse)).then(|| ("method", format!("{method}, of those that ran")));
    method.into_iter().chain(facts.into_iter().flatten()).collect()
}

fn unseen(card: &Card) -> String {
    match card.unseen {
        Some(Unseen::HeldBack(error)) => format!("; {} % on what was held back", significant(error, 3)),
        Some(Unseen::LeftOut(error)) => format!("; {} % on parts left out in turn", significant(error, 3)),
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

/// The names of the parameters that are sure, as many as stand in two lines, and how many more there are.
fn sure(card: &Card, width: TextWidth) -> Option<String> {
    let (_, names) = Grade::ALL.into_iter().zip(&card.parameters).find(|(grade, _)| *grade == Grade::Sure)?;
    let listed = |count: usize| {
        let more = names.len() - count;
        let rest = if more == 0 { String::new() } else { format!(" and {more} more") };
        names[..count].join(" ") + &rest
    };
    let is_short = |text: &String| wrap_to(text, width.columns() - LABEL).len() <= NAMES;
    let is_told = card.verdict != Some(Verdict::DoNotUse);
    (1..=names.len()).rev().filter(|_| is_told).map(listed).find(is_short)
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

#[cfg(test)]
mod tests {
    use super::*;

    fn card(verdict: Verdict, sure: usize) -> Card {
        let names = (1..=sure).map(|number| format!("fv{number}")).collect();
        let parameters = [names, Vec::new(), Vec::new(), Vec::new()];
        Card {
            verdict: Some(verdict),
            method: None,
            relative_error_percent: None,
            unseen: None,
            worst_joint: None,
            parameters,
            model_is_doubted: false,
            actions: Vec::new(),
        }
    }

    #[test]
    fn names_of_sure_parameters_stand_in_two_lines() {
        let sure = |verdict, count| sure(&card(verdict, count), TextWidth::new(40));
        assert_eq!(sure(Verdict::Good, 3).as_deref(), Some("fv1 fv2 fv3"));
        let many = sure(Verdict::Care, 60).unwrap();
        assert_eq!(many, "fv1 fv2 fv3 fv4 fv5 fv6 fv7 fv8 fv9 fv10 and 50 more");
        assert_eq!(wrap_to(&many, 40 - LABEL).len(), 2);
        assert_eq!((sure(Verdict::Good, 0), sure(Verdict::DoNotUse, 3)), (None, None));
    }
}
