//! Payloads and drive gains as tables.

use crate::{
    report::{
        number::{NONE, optional, significant},
        section::Section,
        table::{Table, strings},
    },
    results::{DriveGainResult, PayloadResult, Results},
};

/// A table for each payload that was estimated, and one of the gains.
pub(in crate::report) fn tables(results: &Results) -> Vec<Table> {
    results.payloads.iter().map(payload).chain(gains(&results.drive_gains)).collect()
}

/// The section of the page.
pub(in crate::report) fn section(results: &Results) -> Section {
    Section { id: "payload", title: "Payloads and drive gains", tables: tables(results), ..Section::default() }
}

fn payload(payload: &PayloadResult) -> Table {
    let end = |interval: Option<[f64; 2]>, i: usize| interval.map_or_else(|| NONE.to_owned(), |e| significant(e[i], 4));
    let rows = payload.parameters.iter().enumerate().map(|(i, p)| {
        vec![
            p.name.clone(),
            p.unit.clone(),
            p.estimate.map_or_else(|| "not identified".to_owned(), |v| significant(v, 4)),
            optional(p.standard_deviation, 2),
            end(p.interval_95, 0),
            end(p.interval_95, 1),
            optional(payload.physical.as_ref().map(|body| body[i]), 4),
        ]
    });
    let mut notes = vec![format!(
        "Carried by {} in recordings {}; relative error there {} %. In the payload's frame, about its origin.",
        payload.joint,
        payload.recordings.join(", "),
        significant(payload.relative_error_percent, 3)
    )];
    notes.extend(payload.centre_m.map(|c| format!("Centre of mass: {} m.", c.map(|v| significant(v, 3)).join(", "))));
    notes.extend(match payload.is_physical {
        Some(true) => None,
        Some(false) => Some(
            "These parameters are physically impossible; the last column has the closest consistent ones.".to_owned(),
        ),
        None => Some(
            "Parameters that the motion does not identify have no number: turn the payload about more axes.".to_owned(),
        ),
    });
    Table {
        title: format!("Payload {}", payload.name),
        lead: 2,
        head: strings(&["parameter", "unit", "estimate", "sd", "95 % from", "to", "closest body"]),
        rows: rows.collect(),
        notes,
        ..Table::default()
    }
}

fn gains(gains: &[DriveGainResult]) -> Option<Table> {
    let row = |g: &DriveGainResult| {
        let end = |i: usize| g.interval_95.map_or_else(|| NONE.to_owned(), |ends| significant(ends[i], 4));
        let factor = g.factor.map_or_else(|| "not identifiable".to_owned(), |f| significant(f, 4));
        vec![g.joint.clone(), factor, optional(g.standard_deviation, 2), end(0), end(1), significant(g.payload_rms, 3)]
    };
    let reason = |g: &DriveGainResult| g.reason.as_ref().map(|reason| format!("{}: {reason}.", g.joint));
    let mut notes = strings(&[
        "Factor: true torque over recorded torque, by the known payload; multiply the torque's gain by it. Load: torque \
         of the payload, N m or N rms.",
    ]);
    notes.extend(gains.iter().filter_map(reason));
    let wrong: Vec<&str> = gains.iter().filter(|g| g.contradicts()).map(|g| g.joint.as_str()).collect();
    if !wrong.is_empty() {
        notes.push(format!(
            "PROBLEM: the torques of {} contradict the payload: set their gains and identify again. Until then no estimate \
             of this run is in SI units.",
            wrong.join(", ")
        ));
    }
    (!gains.is_empty()).then(|| Table {
        title: "Drive gains by the known payload".to_owned(),
        lead: 1,
        head: strings(&["joint", "factor", "sd", "95 % from", "to", "load"]),
        rows: gains.iter().map(row).collect(),
        notes,
        ..Table::default()
    })
}
