//! The verdict at the top of the page.

use serde::Serialize;

use crate::{
    report::{
        names,
        number::significant,
        text::{
            card::{hidden, physically, uses_in_words, why_not_simulate},
            grades::{class, is_counted},
        },
    },
    results::{Card, EstimateSource, Grade, Method, Physical, Results, Unseen, Verdict},
};

/// The verdict with its figures, reasons and actions.
#[derive(Debug, Serialize)]
pub(in crate::report) struct HeadCard {
    /// The class that colours it.
    pub(in crate::report) class: &'static str,
    pub(in crate::report) symbol: &'static str,
    pub(in crate::report) word: &'static str,
    /// The most serious reason.
    pub(in crate::report) reason: String,
    /// Labels and texts.
    pub(in crate::report) facts: Vec<(&'static str, String)>,
    /// How many parameters are precise; empty if no number can be used.
    pub(in crate::report) share: String,
    pub(in crate::report) grades: Vec<Graded>,
    /// The number of all parameters.
    pub(in crate::report) parameter_count: usize,
    /// What the names of parameters mean: symbols and their meanings.
    pub(in crate::report) key: Vec<(String, &'static str)>,
    /// Whether the grades are valid only if the model is.
    pub(in crate::report) is_doubted: bool,
    /// The heading of the actions.
    pub(in crate::report) next: &'static str,
    pub(in crate::report) actions: Vec<String>,
    /// Every reason, with its code.
    pub(in crate::report) reasons: Vec<(&'static str, String)>,
}

/// The parameters that have a grade.
#[derive(Debug, Serialize)]
pub(in crate::report) struct Graded {
    pub(in crate::report) class: &'static str,
    pub(in crate::report) name: &'static str,
    pub(in crate::report) count: usize,
    /// How to use these parameters.
    pub(in crate::report) advice: &'static str,
    pub(in crate::report) names: String,
    /// Whether the names are folded.
    pub(in crate::report) is_folded: bool,
}

impl HeadCard {
    /// The card of results; none without a verdict.
    pub(in crate::report) fn of(results: &Results) -> Option<Self> {
        let card = results.card();
        let verdict = card.verdict?;
        let (class, symbol, word) = match verdict {
            Verdict::Good => ("good", "\u{2713}", "Good"),
            Verdict::Care => ("care", "!", "Use with care"),
            Verdict::DoNotUse => ("do-not-use", "\u{2715}", "Do not use"),
        };
        Some(Self {
            class,
            symbol,
            word,
            reason: results.verdict_reasons.first().map(|r| sentence(r.seen())).unwrap_or_default(),
            facts: facts(&card, verdict),
            share: share(&card),
            grades: graded(&card),
            parameter_count: card.parameter_count(),
            key: names::key(card.parameters.iter().flatten().map(String::as_str)),
            is_doubted: card.model_is_doubted,
            next: match verdict {
                Verdict::Good => "How to improve it",
                Verdict::Care | Verdict::DoNotUse => "What to do next",
            },
            reasons: results.verdict_reasons.iter().map(|r| (r.code.name(), sentence(&r.text))).collect(),
            actions: card.actions.iter().map(|action| sentence(action)).collect(),
        })
    }
}

fn facts(card: &Card, verdict: Verdict) -> Vec<(&'static str, String)> {
    let percent = |e: f64| format!("{}\u{a0}%", significant(e, 3));
    let method = card.source.map(|m| match verdict {
        Verdict::Good | Verdict::Care => {
            let case = card.case.as_ref().map(|case| format!(" ({case})")).unwrap_or_default();
            match m {
                EstimateSource::Model => ("Use", "the model".to_owned()),
                EstimateSource::Run(method) => ("Recommended method", format!("{method}{case}")),
            }
        }
        Verdict::DoNotUse => ("Method", format!("none; the numbers below are those of {}", m.name())),
    });
    let fit = card.relative_error_percent.map(|error| format!(" (fit: {})", percent(error))).unwrap_or_default();
    let unseen = card.unseen.map(|unseen| match unseen {
        Unseen::HeldBack(error) => {
            ("Validation, recordings held back", format!("{} on data not used{fit}", percent(error)))
        }
        Unseen::LeftOut(error) => {
            ("Validation, parts left out in turn", format!("{} on data not used{fit}", percent(error)))
        }
    });
    let physical = card.physical.filter(|_| verdict != Verdict::DoNotUse);
    let physical = physical.map(|physical| ("Physically possible", physically(physical).to_owned()));
    let at = |(name, error): &(String, f64)| format!(" overall, {} at {name}", percent(*error));
    let worst = card.worst_joint.as_ref().map(at).unwrap_or_default();
    let of = if card.source == Some(EstimateSource::Run(Method::CLOE)) {
        "Error of the positions"
    } else {
        "Error of the torque"
    };
    let error = card.relative_error_percent.map(|error| (of, percent(error) + &worst));
    let none = (verdict == Verdict::DoNotUse).then(|| ("Parameters to use", "none".to_owned()));
    let uses = (!card.uses.is_empty()).then(|| ("It may be used to", uses_in_words(card)));
    let simulate = why_not_simulate(card).map(|why| ("Simulate with care", why));
    let hidden = hidden(card).map(|errors| ("Wrong descriptions that would not show", errors));
    [method, uses, simulate, error, unseen, physical, hidden, none].into_iter().flatten().collect()
}

/// How many parameters are precise.
fn share(card: &Card) -> String {
    let all = card.parameter_count();
    if card.verdict == Some(Verdict::DoNotUse) || all == 0 {
        return String::new();
    }
    let [sure, ..] = &card.parameters;
    let are = if sure.len() == 1 { "is" } else { "are" };
    let count = if sure.len() == all { format!("all {all}") } else { format!("{} of {all}", sure.len()) };
    let doubt = if card.model_is_doubted { " if the model holds" } else { "" };
    let simulated = match card.physical {
        Some(Physical::No | Physical::WithinNoise) => "; for a simulator, take the export (it makes them physical)",
        Some(Physical::Yes) | None => "",
    };
    format!("{count} parameters {are} {}{doubt}{simulated}", Grade::Precise.name())
}

/// The grades of the parameters; none if no number can be used.
fn graded(card: &Card) -> Vec<Graded> {
    if card.verdict == Some(Verdict::DoNotUse) {
        return Vec::new();
    }
    let advice = |grade| match grade {
        Grade::Precise => "Precise",
        Grade::Rough => "Rough, use with caution",
        Grade::Impossible => "Impossible (below zero), do not use",
        Grade::NotIdentified => "Not identified, do not quote",
    };
    let of_grade = |(grade, of): (Grade, &Vec<String>)| Graded {
        class: class(grade),
        name: grade.name(),
        count: of.len(),
        advice: advice(grade),
        names: of.join(" "),
        is_folded: grade == Grade::NotIdentified,
    };
    let all = Grade::ALL.into_iter().zip(&card.parameters);
    all.filter(|(grade, of)| is_counted(*grade, of.len())).map(of_grade).collect()
}

/// A text that begins with a capital letter and ends with a full stop.
///
/// Names keep their letters: a first word with a digit, a hyphen or an underscore, and that of a method.
fn sentence(text: &str) -> String {
    let first_word = text.split_whitespace().next().unwrap_or_default();
    let begins_with_name = first_word.contains(|c: char| c.is_ascii_digit() || "-_".contains(c))
        || Method::all().any(|m| m.name() == first_word);
    let mut letters = text.trim().chars();
    let upper = |c: char| if begins_with_name { c.to_string() } else { c.to_uppercase().collect() };
    let first: String = letters.next().map(upper).unwrap_or_default();
    let end = if text.trim_end().ends_with(['.', '!', '?']) || text.is_empty() { "" } else { "." };
    format!("{first}{}{end}", letters.as_str())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_share_counts_the_precise_parameters() {
        let names = |count: usize| (0..count).map(|k| format!("p{k}")).collect::<Vec<_>>();
        let card = |verdict, sure, rough| Card {
            verdict: Some(verdict),
            source: None,
            uses: Vec::new(),
            case: None,
            physical: None,
            hidden: Vec::new(),
            relative_error_percent: None,
            unseen: None,
            worst_joint: None,
            parameters: [names(sure), names(rough), Vec::new(), Vec::new()],
            model_is_doubted: false,
            actions: Vec::new(),
        };
        assert_eq!(share(&card(Verdict::Care, 6, 63)), "6 of 69 parameters are precise");
        assert_eq!(share(&card(Verdict::Good, 1, 3)), "1 of 4 parameters is precise");
        assert_eq!(share(&card(Verdict::Good, 4, 0)), "all 4 parameters are precise");
        assert_eq!(
            share(&Card { model_is_doubted: true, ..card(Verdict::Care, 2, 3) }),
            "2 of 5 parameters are precise if the model holds"
        );
        let not_physical = Card { physical: Some(Physical::No), ..card(Verdict::Care, 2, 3) };
        assert_eq!(
            share(&not_physical),
            "2 of 5 parameters are precise; for a simulator, take the export (it makes them physical)"
        );
        assert_eq!(share(&card(Verdict::DoNotUse, 6, 63)), "");
    }

    #[test]
    fn a_sentence_begins_with_a_capital_letter_and_ends_once() {
        assert_eq!(sentence("shift it by 2 ms"), "Shift it by 2 ms.");
        assert_eq!(sentence("Done."), "Done.");
        assert_eq!(sentence("idim-ls differs"), "idim-ls differs.");
        assert_eq!(sentence("didim differs"), "didim differs.");
        assert_eq!(sentence("mx2 changes"), "mx2 changes.");
        assert_eq!(sentence(""), "");
    }
}
