//! The robot of `thetahat model` for the terminal.

use crate::{
    report::{
        number::{NONE, given, significant},
        table::Table,
        wrap::{TextWidth, labelled, wrap},
    },
    results::{
        BaseParameterSummary, Doubt, JointKind, JointSummary, LockedJoint, ParameterCount, Quantity, RobotSummary,
        StandardParameterSummary,
    },
};

/// Widest label of the head.
const LABEL: usize = 14;
/// Digits of a-priori values.
const DIGITS: usize = 4;

/// The robot as text.
#[must_use]
pub fn model_text(summary: &RobotSummary, width: TextWidth) -> String {
    let mut parts = vec![head(summary, width), structure(summary).to_text(width)];
    parts.extend(transmission(summary, width));
    parts.push(standard_parameters(summary).to_text(width));
    parts.extend(terms(summary).map(|table| table.to_text(width)));
    parts.push(counts(summary).to_text(width));
    parts.push(base_parameters(summary, width));
    parts.extend(doubts(summary, width));
    parts.join("\n")
}

/// Physically impossible values in the description, with remedies.
fn doubts(summary: &RobotSummary, width: TextWidth) -> Option<String> {
    let doubt = |d: &Doubt| {
        wrap(&format!("{}: {}", d.place, d.what), "  ", width) + &wrap(&format!("-> {}", d.remedy), "     ", width)
    };
    let lines: String = summary.doubts.iter().map(doubt).collect();
    (!lines.is_empty()).then(|| format!("Findings in the description\n{lines}"))
}

/// A number with four significant digits at most.
fn short(value: f64) -> String {
    let text = significant(value, DIGITS);
    match text.contains('.') && !text.contains('e') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

fn head(summary: &RobotSummary, width: TextWidth) -> String {
    let [x, y, z] = summary.gravity.map(given);
    let (links, coordinates) = (summary.joints.len(), summary.coordinates());
    let passive = summary.joints.iter().filter(|joint| joint.passive).count();
    let others = [(links - coordinates - passive, "following others"), (passive, "moved by loops of links")];
    let words = |(count, what): (usize, &str)| (count > 0).then(|| format!(", {count} of {links} joints {what}"));
    let follow: String = others.into_iter().filter_map(words).collect();
    let facts = [
        ("robot", summary.name.clone()),
        ("source", format!("{} ({})", summary.source, summary.format)),
        ("coordinates", format!("{coordinates}{follow}")),
        ("gravity", format!("{x} {y} {z} m/s^2 in the base frame")),
        ("friction", summary.friction.to_owned()),
    ];
    let locked = (!summary.locked.is_empty()).then(|| ("locked", locked(summary)));
    let line = |(label, value): (&str, String)| labelled(label, &value, LABEL, width);
    facts.into_iter().chain(locked).map(line).collect()
}

fn locked(summary: &RobotSummary) -> String {
    let at =
        |joint: &LockedJoint| format!("{} at {} {}", joint.name, coordinate(joint.value, joint.kind), unit(joint.kind));
    summary.locked.iter().map(at).collect::<Vec<_>>().join(", ")
}

/// A column of the structure: the text for a joint, if any.
type Cell = fn(&JointSummary) -> Option<String>;

/// One row for each joint; names are indented at each branch of the tree.
fn structure(summary: &RobotSummary) -> Table {
    let joints = &summary.joints;
    let columns: [(&str, Cell); 4] =
        [("range", range), ("velocity", velocity), ("effort", effort), ("follows", follows)];
    let shown: Vec<_> = columns.iter().filter(|(_, text)| joints.iter().any(|j| text(j).is_some())).collect();
    let row = |joint: &JointSummary| {
        let name = format!("{}{}", "  ".repeat(branches_before(joints, joint)), joint.name);
        let on = joint.parent.map_or_else(|| "base".to_owned(), |p| p.to_string());
        let lead = [joint.number.to_string(), name, kind(joint.kind).to_owned(), on];
        lead.into_iter().chain(shown.iter().map(|(_, text)| text(joint).unwrap_or_else(|| NONE.to_owned()))).collect()
    };
    Table {
        title: "Structure".to_owned(),
        lead: 2,
        head: ["", "joint", "kind", "on"]
            .into_iter()
            .chain(shown.iter().map(|(head, _)| *head))
            .map(str::to_owned)
            .collect(),
        rows: joints.iter().map(row).collect(),
        ..Table::default()
    }
}

/// The number of branches from the base to a joint.
fn branches_before(joints: &[JointSummary], joint: &JointSummary) -> usize {
    let siblings = |parent: Option<usize>| joints.iter().filter(|j| j.parent == parent).count();
    let mut at = Some(joint);
    let mut branches = 0;
    while let Some(joint) = at {
        branches += usize::from(siblings(joint.parent) > 1);
        at = joint.parent.and_then(|p| joints.get(p - 1));
    }
    branches
}

fn kind(kind: JointKind) -> &'static str {
    match kind {
        JointKind::Revolute => "revolute",
        JointKind::Prismatic => "prismatic",
    }
}

/// An angle in degrees, or a length in m.
fn coordinate(value: f64, kind: JointKind) -> String {
    match kind {
        JointKind::Revolute => short(value.to_degrees()),
        JointKind::Prismatic => short(value),
    }
}

fn unit(kind: JointKind) -> &'static str {
    match kind {
        JointKind::Revolute => "deg",
        JointKind::Prismatic => "m",
    }
}

fn range(joint: &JointSummary) -> Option<String> {
    let text = |bound: Option<f64>| bound.map(|value| coordinate(value, joint.kind));
    match (text(joint.lower), text(joint.upper)) {
        (None, None) => None,
        (lower, upper) => {
            let [lower, upper] = [lower, upper].map(|bound| bound.unwrap_or_else(|| "?".to_owned()));
            Some(format!("{lower}..{upper} {}", unit(joint.kind)))
        }
    }
}

fn velocity(joint: &JointSummary) -> Option<String> {
    joint.velocity.map(|v| format!("{} {}/s", coordinate(v, joint.kind), unit(joint.kind)))
}

fn effort(joint: &JointSummary) -> Option<String> {
    let unit = if joint.kind == JointKind::Revolute { "N m" } else { "N" };
    joint.effort.map(|effort| format!("{} {unit}", given(effort)))
}

fn follows(joint: &JointSummary) -> Option<String> {
    if joint.passive {
        return Some("loops".to_owned());
    }
    let mimic = joint.mimic.as_ref()?;
    let offset = match mimic.offset {
        0.0 => String::new(),
        offset => format!(" + {} {}", coordinate(offset, joint.kind), unit(joint.kind)),
    };
    let sign = |ratio: f64| if ratio < 0.0 { "-" } else { "+" };
    let others = joint.also_follows.iter();
    let others: String =
        others.map(|of| format!(" {} {} q{}", sign(of.ratio), given(of.ratio.abs()), of.joint)).collect();
    Some(format!("{} q{}{others}{offset}", given(mimic.ratio), mimic.joint))
}

/// The ratios, or the matrix for coupled motors, and the offsets; none if motors and joints are identical.
fn transmission(summary: &RobotSummary, width: TextWidth) -> Option<String> {
    let transmission = &summary.transmission;
    let notes = transmission_notes(summary);
    let ratios: Vec<String> = transmission.matrix.iter().enumerate().map(|(i, row)| given(row[i])).collect();
    if transmission.coupled_motors.is_empty() {
        let direct = ratios.iter().all(|ratio| ratio == "1");
        let lines = wrap(&format!("motor positions per joint positions: {}", ratios.join(" ")), "  ", width);
        let lines = if direct { String::new() } else { lines };
        let lines = lines + &notes.iter().map(|note| wrap(note, "  ", width)).collect::<String>();
        return (!lines.is_empty()).then(|| format!("Transmission\n{lines}"));
    }
    let rows = transmission.matrix.iter().enumerate();
    let rows = rows.map(|(i, row)| std::iter::once((i + 1).to_string()).chain(row.iter().map(|v| given(*v))).collect());
    let independent = summary.joints.iter().filter(|joint| joint.coordinate.is_some());
    let table = Table {
        title: "Transmission: motor positions per joint positions".to_owned(),
        lead: 1,
        head: std::iter::once("motor".to_owned()).chain(independent.map(|j| format!("q{}", j.number))).collect(),
        rows: rows.collect(),
        notes,
        ..Table::default()
    };
    Some(table.to_text(width))
}

fn transmission_notes(summary: &RobotSummary) -> Vec<String> {
    let transmission = &summary.transmission;
    let independent = summary.joints.iter().filter(|joint| joint.coordinate.is_some());
    let mut notes = Vec::new();
    if transmission.offset.iter().any(|offset| *offset != 0.0) {
        let offset = |(joint, offset): (&JointSummary, &f64)| {
            format!("{} {}", coordinate(*offset, joint.kind), unit(joint.kind))
        };
        let all: Vec<String> = independent.zip(&transmission.offset).map(offset).collect();
        notes.push(format!("joints at the motors' zero: {}", all.join(", ")));
    }
    let own_ratio = |(i, drive): (usize, &f64)| transmission.matrix[i][i] == *drive;
    if !transmission.drive_to_joint.iter().enumerate().all(own_ratio) {
        let drives: Vec<String> = transmission.drive_to_joint.iter().map(|d| given(*d)).collect();
        notes.push(format!("torque in joint units per drive signal: {}", drives.join(" ")));
    }
    for motor in &transmission.coupled_motors {
        let number = number_of_coordinate(summary, *motor);
        notes.push(format!("motor {motor} is coupled: it has iam{number} fvm{number} fcm{number}"));
    }
    notes
}

/// One row for each link; columns that are zero in the description are not shown.
fn standard_parameters(summary: &RobotSummary) -> Table {
    let all = &summary.standard_parameters;
    let mut quantities: Vec<Quantity> = Vec::new();
    let of_links = all.iter().filter(|p| p.a_priori != 0.0 && !p.parameter.quantity.is_term());
    for parameter in of_links.map(|p| &p.parameter) {
        if !quantities.contains(&parameter.quantity) {
            quantities.push(parameter.quantity);
        }
    }
    quantities.sort_unstable();
    let cell = |number: usize, quantity: Quantity| {
        let is = |p: &&StandardParameterSummary| p.parameter.number == number && p.parameter.quantity == quantity;
        all.iter().find(is).map_or_else(|| NONE.to_owned(), |p| short(p.a_priori))
    };
    let row = |number: usize| {
        std::iter::once(number.to_string()).chain(quantities.iter().map(|q| cell(number, *q))).collect()
    };
    let numbers = if quantities.is_empty() { 0 } else { summary.joints.len() };
    let mut notes = vec![names_of_link(all)];
    if quantities.is_empty() {
        notes.push("the description gives no a-priori values".to_owned());
    }
    Table {
        title: format!("Standard parameters: {}, with their a-priori values (SI)", all.len()),
        lead: 1,
        head: std::iter::once("link").chain(quantities.iter().map(|q| q.name())).map(str::to_owned).collect(),
        rows: (1..=numbers).map(row).collect(),
        notes,
        ..Table::default()
    }
}

/// One row for each parameter of a torque term; none without terms.
fn terms(summary: &RobotSummary) -> Option<Table> {
    let all = summary.standard_parameters.iter().filter(|p| p.parameter.quantity.is_term());
    let row = |p: &StandardParameterSummary| {
        let joint = summary.joints.get(p.parameter.number - 1).map_or_else(String::new, |j| j.name.clone());
        vec![p.name.clone(), joint, short(p.a_priori), p.unit.to_string()]
    };
    let rows: Vec<Vec<String>> = all.map(row).collect();
    (!rows.is_empty()).then(|| Table {
        title: format!("Parameters of torque terms: {}", rows.len()),
        lead: 2,
        head: ["parameter", "joint", "a priori", "unit"].map(str::to_owned).to_vec(),
        rows,
        ..Table::default()
    })
}

fn names_of_link(all: &[StandardParameterSummary]) -> String {
    let first = all.iter().filter(|p| {
        p.parameter.number == 1 && !p.parameter.quantity.is_coupled_motor() && !p.parameter.quantity.is_term()
    });
    let names: Vec<&str> = first.map(|p| p.name.as_str()).collect();
    format!("link 1 and its joint have {}, and so on by number", names.join(" "))
}

fn counts(summary: &RobotSummary) -> Table {
    let row = |label: &str, count: &ParameterCount| {
        let numbers = [count.inertial, count.motor_inertia, count.friction, count.offset, count.terms, count.all()];
        std::iter::once(label.to_owned()).chain(numbers.iter().map(usize::to_string)).collect()
    };
    let counts = &summary.counts;
    Table {
        title: "Numbers of parameters".to_owned(),
        lead: 1,
        head: ["", "inertial", "motor inertia", "friction", "offset", "terms", "all"].map(str::to_owned).to_vec(),
        rows: vec![
            row("standard", &counts.standard),
            row("without effect", &counts.without_effect),
            row("base", &counts.base),
        ],
        ..Table::default()
    }
}

/// Name, a-priori value and unit, and the formula of regrouped parameters.
fn base_parameters(summary: &RobotSummary, width: TextWidth) -> String {
    if let Some(problem) = &summary.problem {
        return wrap(&format!("No base parameters: {problem}"), "", width);
    }
    let all = &summary.base_parameters;
    let longest = |text: fn(&BaseParameterSummary) -> usize| all.iter().map(text).max().unwrap_or(0);
    let (names, units) = (longest(|p| p.name.len()), longest(|p| p.unit.len()));
    let line = |p: &BaseParameterSummary| {
        let lead = format!("{:<names$} {:>10} {:<units$}", p.name, short(p.a_priori), p.unit);
        if p.regrouped.is_empty() {
            return format!("{}\n", lead.trim_end());
        }
        let formula = formula(&p.expression, &" ".repeat(lead.chars().count() + 2), width);
        format!("{lead}  {}", formula.trim_start())
    };
    let title = format!("Base parameters: {}, with their a-priori values and formulas\n", all.len());
    title + &all.iter().map(line).collect::<String>() + &without_effect(summary, width)
}

/// A formula in lines; a sign stays with the term that follows.
fn formula(expression: &str, indent: &str, width: TextWidth) -> String {
    let joined = expression.replace(" + ", " +~").replace(" - ", " -~");
    wrap(&joined, indent, width).replace('~', " ")
}

fn without_effect(summary: &RobotSummary, width: TextWidth) -> String {
    let without = summary.standard_parameters.iter().filter(|p| p.has_effect == Some(false));
    let names: Vec<&str> = without.map(|p| p.name.as_str()).collect();
    if names.is_empty() {
        String::new()
    } else {
        format!("\n{}", wrap(&format!("Without effect on any torque: {}", names.join(" ")), "", width))
    }
}

/// The joint's number of a coordinate, both from one.
fn number_of_coordinate(summary: &RobotSummary, coordinate: usize) -> usize {
    summary.joints.iter().find(|j| j.coordinate == Some(coordinate)).map_or(coordinate, |j| j.number)
}
