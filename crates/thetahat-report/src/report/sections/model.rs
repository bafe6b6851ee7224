//! The model: what it may be used for, its errors, what it is wrong in, and its parameters.

use crate::{
    report::{
        number::{NONE, estimate, optional, significant},
        table::{Group, Table, strings},
        wrap::{TextWidth, wrap},
    },
    results::{
        ModelCandidate, ModelCause, ModelJointError, ModelParameter, ModelResult, ModelStandardParameter, ModelUse,
        Results, SmallestShown,
    },
};

/// The model for the terminal: its errors.
pub(in crate::report) fn brief(results: &Results, width: TextWidth) -> String {
    let Some(model) = &results.model else {
        return results.no_model.iter().map(|why| wrap(&format!("There is no model: {why}."), "  ", width)).collect();
    };
    let error = model.judged_error();
    let of = |value: fn(&ModelJointError) -> Option<f64>| {
        error.joints.iter().map(|e| optional(value(e), 2)).collect::<Vec<_>>().join(" ")
    };
    let shares = error.joints.iter().map(|e| e.near_rest_share_percent);
    let [least, most] = [shares.clone().fold(100.0, f64::min), shares.fold(0.0, f64::max)];
    let all = format!("  the model on data not used, each joint %: {}", of(|e| e.percent));
    let rest = format!("  the same near rest ({least:.0} to {most:.0} % of samples): {}", of(|e| e.near_rest_percent));
    [all, rest].map(|line| wrap(line.trim_start(), "  ", width)).concat()
}

/// Every table, for the terminal.
pub(in crate::report) fn text(results: &Results, width: TextWidth) -> String {
    let Some(model) = &results.model else { return brief(results, width) };
    let tables = [Some(uses(model)), Some(errors(results, model)), causes(model), Some(parameters(model))];
    let further = [standard(model), candidates(model)];
    let all = tables.into_iter().flatten().chain(further).map(|table| table.to_text(width));
    [wrap(&what(model), "", width)].into_iter().chain(all).collect::<Vec<_>>().join("\n")
}

/// What it is, in a sentence or two.
fn what(model: &ModelResult) -> String {
    let guessed = match model.guessed_links.as_slice() {
        [] => String::new(),
        _ => " The bodies that the description lacks are guessed from its geometry.".to_owned(),
    };
    let estimated = match model.estimated_sizes.as_slice() {
        [] => String::new(),
        sizes => {
            format!(" Estimated from the recordings too, with the deviation in the intervals: {}.", sizes.join(", "))
        }
    };
    format!(
        "The physically consistent robot that predict, export, generate and sample use. Before the recordings each a-priori body \
         is believed to {} % (weight {}), friction and motor inertias to a factor of three. Coulomb friction changes its sign as \
         {}.{}{guessed}{estimated}",
        significant(model.belief_percent, 2),
        significant(model.belief_weight, 3),
        sign(model),
        terms(model)
    )
}

/// The sign of Coulomb friction, as a formula.
fn sign(model: &ModelResult) -> String {
    let turning = significant(model.friction_transition, 3);
    match model.friction_transition_sliding {
        None => format!("tanh(dq / {turning})"),
        Some(sliding) => {
            let sliding = significant(sliding, 3);
            format!(
                "tanh(dq / v), where v is {turning} rad/s of joints that turn and {sliding} m/s of joints that slide"
            )
        }
    }
}

/// The torque terms that it has in addition to the robot's, in a sentence.
fn terms(model: &ModelResult) -> String {
    match model.kinds_of_terms().as_slice() {
        [] => String::new(),
        kinds => format!(" It has torque terms that the description has not: {}.", kinds.join(", ")),
    }
}

fn uses(model: &ModelResult) -> Table {
    let row = |u: &ModelUse| vec![u.for_what.words().to_owned(), u.verdict.name().to_owned()];
    let why = |u: &ModelUse| format!("{}: {}", u.for_what.words(), u.why);
    Table {
        title: "The model may be used to".to_owned(),
        lead: 1,
        head: strings(&["use", "verdict"]),
        rows: model.uses.iter().map(row).collect(),
        notes: model.uses.iter().filter(|u| !u.why.is_empty()).map(why).collect(),
        ..Table::default()
    }
}

fn errors(results: &Results, model: &ModelResult) -> Table {
    let error = model.judged_error();
    let of = match (&model.held_back, &model.unseen) {
        (Some(_), _) => "on the recordings held back",
        (None, Some(_)) => "on unseen motion",
        (None, None) => "on the motion that it is fitted to",
    };
    let row = |(j, e): (usize, &ModelJointError)| {
        vec![
            results.joint_label(j),
            optional(e.percent, 3),
            optional(e.moving_percent, 3),
            optional(e.near_rest_percent, 3),
            significant(e.near_rest_share_percent, 2),
            significant(e.rms, 3),
        ]
    };
    let all = [vec!["all joints".to_owned(), significant(error.percent, 3)], vec![String::new(); 4]].concat();
    Table {
        title: format!("Errors of the model's torques {of}, percent of each torque"),
        lead: 1,
        groups: vec![
            Group { label: "error on samples".to_owned(), columns: 3 },
            Group { label: "of them".to_owned(), columns: 2 },
        ],
        head: strings(&["joint", "all", "moving", "near rest", "near rest, %", "rms error"]),
        rows: error.joints.iter().enumerate().map(row).chain([all]).collect(),
        notes: strings(&[
            "Parts of the recordings are left out in turn: neither the fit nor the choice of the model has seen them. near rest, \
             %: the share of the joint's samples at which it stands or turns back.",
        ]),
    }
}

fn causes(model: &ModelResult) -> Option<Table> {
    let row = |c: &ModelCause| {
        let moved: Vec<&str> = c.moved.iter().take(3).map(|m| m.parameter.as_str()).collect();
        vec![
            c.kind.with_subject(&c.subject),
            c.size_in_words().unwrap_or_else(|| NONE.to_owned()),
            format!("1e{:.0}", c.log10_probability),
            significant(c.error_percent, 2),
            match moved.as_slice() {
                [] if c.in_model => "nothing: a term of the model".to_owned(),
                [] => NONE.to_owned(),
                moved => moved.join(" "),
            },
        ]
    };
    let rivals = model
        .causes
        .iter()
        .filter(|c| !c.rivals.is_empty())
        .map(|c| format!("{} is not separated from {}", c.kind.with_subject(&c.subject), c.rivals.join(", ")));
    let sized: Vec<String> = model.smallest_shown.iter().map(SmallestShown::in_words).collect();
    let smallest = (!sized.is_empty())
        .then(|| format!("Errors of the description that would show, and from which size: {}", sized.join("; ")));
    (!model.causes.is_empty() || smallest.is_some()).then(|| Table {
        title: "What the residual says that the model or the recordings are wrong in".to_owned(),
        lead: 1,
        head: strings(&["cause", "size", "chance", "explains, %", "moved"]),
        rows: model.causes.iter().map(row).collect(),
        notes: rivals.chain(smallest).collect(),
        ..Table::default()
    })
}

fn parameters(model: &ModelResult) -> Table {
    let row = |p: &ModelParameter| {
        let half = p.interval_95.map(|[low, high]| 0.5 * (high - low));
        let [low, high] = p
            .interval_95
            .filter(|_| p.is_decided())
            .map_or([NONE.to_owned(), NONE.to_owned()], |ends| ends.map(|end| estimate(end, half)));
        vec![
            p.name.clone(),
            estimate(p.value, half),
            p.unit.clone(),
            significant(p.a_priori, 3),
            format!("{:.0}", p.decided_percent),
            low,
            high,
        ]
    };
    Table {
        title: "Base parameters of the model".to_owned(),
        lead: 1,
        head: strings(&["name", "value", "unit", "a priori", "decided, %", "95 % from", "to"]),
        rows: model.parameters.iter().map(row).collect(),
        notes: strings(&[
            "decided: the percent of a parameter that the recordings decided; below 90 it is not quoted by itself. The interval is \
             of the recordings alone, inside what a robot can have.",
        ]),
        ..Table::default()
    }
}

fn standard(model: &ModelResult) -> Table {
    let row = |p: &ModelStandardParameter| {
        vec![p.name.clone(), significant(p.value, 4), p.unit.clone(), significant(p.a_priori, 4)]
    };
    Table {
        title: "Standard parameters of the model".to_owned(),
        lead: 1,
        head: strings(&["name", "value", "unit", "believed before"]),
        rows: model.standard.iter().map(row).collect(),
        ..Table::default()
    }
}

/// Of joints that turn, rad/s, and of those that slide, m/s, where both are.
fn transition(candidate: &ModelCandidate) -> String {
    let turning = significant(candidate.friction_transition, 3);
    match candidate.friction_transition_sliding {
        None => turning,
        Some(sliding) => format!("{turning}, {}", significant(sliding, 3)),
    }
}

fn candidates(model: &ModelResult) -> Table {
    let row = |c: &ModelCandidate| {
        let [difference, error] =
            c.difference.map_or([NONE.to_owned(), NONE.to_owned()], |d| d.map(|v| significant(v, 3)));
        vec![
            transition(c),
            if c.terms.is_empty() { NONE.to_owned() } else { c.terms.join(", ") },
            significant(c.belief_weight, 3),
            significant(c.unseen_square, 4),
            difference,
            error,
            if c.taken { "yes" } else { "" }.to_owned(),
        ]
    };
    Table {
        title: "Candidates for the model".to_owned(),
        lead: 3,
        head: strings(&["transition", "terms", "weight", "unseen", "difference", "its error", "taken"]),
        rows: model.candidates.iter().map(row).collect(),
        notes: strings(&[
            "unseen: mean square of the errors on what is left out, in long-run variances of the residual. A candidate replaces the \
             one that it challenges if it is better by more than two standard errors of the difference.",
        ]),
        ..Table::default()
    }
}
