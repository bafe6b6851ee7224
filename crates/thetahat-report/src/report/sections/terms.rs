//! Comparison of laws of torque terms, and constants of terms found by a search.

use crate::{
    report::{
        number::{NONE, optional, significant},
        section::Section,
        table::Table,
        wrap::{TextWidth, wrap},
    },
    results::{JointTermComparison, ProfiledTerm, Results, TermComparison, TermLaw},
};

/// Laws of a joint that the terminal lists: the best by the criterion, and those recommended.
const LISTED: usize = 3;

pub(in crate::report) fn section(results: &Results) -> Section {
    let accept = results.term_comparison.as_ref().map(accepted).filter(|text| !text.is_empty());
    Section {
        id: "terms",
        title: "Torque terms",
        lines: profiled(results).chain(results.term_comparison.as_ref().map(advice)).collect(),
        tables: results.term_comparison.as_ref().map(|c| comparison(c, usize::MAX)).into_iter().collect(),
        files: accept.map(|text| ("To accept", text)).into_iter().collect(),
        ..Section::default()
    }
}

/// The same for the terminal; may be empty.
pub(in crate::report) fn text(results: &Results, width: TextWidth) -> String {
    let lines: String = profiled(results).map(|line| wrap(&line, "", width)).collect();
    let compared = results.term_comparison.as_ref().map(|c| {
        let accepted = accepted(c);
        let gap = if accepted.is_empty() { "" } else { "\n" };
        format!("{}{}{gap}{accepted}", comparison(c, LISTED).to_text(width), wrap(&advice(c), "", width))
    });
    [lines].into_iter().chain(compared).filter(|part| !part.is_empty()).collect::<Vec<_>>().join("\n")
}

/// One row for each joint as described, and one for each law.
fn comparison(comparison: &TermComparison, listed: usize) -> Table {
    let head = ["joint", "law", "estimates", "left-out error %", "criterion", "accept"];
    Table {
        title: "Laws of torque terms".to_owned(),
        lead: 2,
        head: head.map(str::to_owned).to_vec(),
        rows: comparison.joints.iter().flat_map(|joint| rows(joint, listed)).collect(),
        notes: vec![
            "left-out error: error of the joint's torque, predicted from other parts of the recording, by least squares weighted per joint; \
             of the simulated positions of all joints where no torques are recorded. criterion: change of Bayes's information criterion, counted in independent samples; below -10 the evidence is very \
             strong."
                .to_owned(),
        ],
        ..Table::default()
    }
}

fn rows(joint: &JointTermComparison, listed: usize) -> Vec<Vec<String>> {
    let described = optional(joint.cross_validation_relative_error_percent, 4);
    let first = vec![
        joint.joint.clone(),
        "as described".to_owned(),
        NONE.to_owned(),
        described,
        NONE.to_owned(),
        String::new(),
    ];
    let mut laws: Vec<&TermLaw> = joint.laws.iter().collect();
    laws.sort_by(|a, b| a.criterion_change.total_cmp(&b.criterion_change));
    let shown = laws.into_iter().enumerate().filter(|(rank, law)| *rank < listed || law.recommended);
    [first].into_iter().chain(shown.map(|(_, law)| row(&joint.joint, law))).collect()
}

fn row(joint: &str, law: &TermLaw) -> Vec<String> {
    let estimates = law.parameters.iter().zip(&law.estimates).map(|(p, e)| format!("{p} = {}", significant(*e, 3)));
    let estimates = estimates.collect::<Vec<_>>().join(", ");
    vec![
        joint.to_owned(),
        law.law.clone(),
        if estimates.is_empty() { NONE.to_owned() } else { estimates },
        optional(law.cross_validation_relative_error_percent, 4),
        format!("{:+.1}", law.criterion_change),
        if law.recommended { "yes" } else { "" }.to_owned(),
    ]
}

fn advice(comparison: &TermComparison) -> String {
    let samples = significant(comparison.effective_samples, 3);
    let recommended = comparison.joints.iter().flat_map(|j| j.laws.iter().map(move |law| (j, law)));
    let recommended: Vec<String> = recommended
        .filter(|(_, law)| law.recommended)
        .map(|(joint, law)| format!("{} of {}", law.law, joint.joint))
        .collect();
    if recommended.is_empty() {
        return format!(
            "No law explains the torques better than the model as described ({samples} independent samples)."
        );
    }
    format!(
        "Recommended, by {samples} independent samples: {}. Each was tried alone: add the text below to the robot or experiment \
         file, remove the laws recommended with `without`, and compare again.",
        recommended.join("; ")
    )
}

/// The text that accepts the recommendations.
fn accepted(comparison: &TermComparison) -> String {
    let laws = comparison.joints.iter().flat_map(|j| &j.laws).filter(|law| law.recommended);
    laws.map(|law| law.description.as_str()).filter(|text| !text.is_empty()).collect::<Vec<_>>().join("\n")
}

/// The constants found by a search.
pub(in crate::report) fn profiled(results: &Results) -> impl Iterator<Item = String> + '_ {
    results.profiled_terms.iter().map(|ProfiledTerm { term, joint, velocity, exponent, at_limit }| {
        let found = format!(
            "Term {}, {joint}: velocity = {velocity}, exponent = {exponent} give the smallest residual; the intervals assume that they are exact.",
            term + 1
        );
        if *at_limit {
            format!("{found} The velocity is at the end of the searched range: the recording does not determine it.")
        } else {
            found
        }
    })
}
