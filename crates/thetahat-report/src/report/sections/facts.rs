//! Recordings and processing as labels and texts for the terminal and the page.

use super::diagnosis;
use crate::{
    report::{
        number::{given, optional, rate, significant},
        units, verdict,
    },
    results::{JointKind, LockedJoint, NearRestResult, RecordingResult, ReferenceResult, Results},
};

/// The head: the verdict, the advice, then the recordings and their filters.
pub(in crate::report) fn head(results: &Results) -> Vec<(&'static str, String)> {
    verdict::lines(results).into_iter().chain(diagnosis::advice(results)).chain(facts(results)).collect()
}

/// The recordings and their filters, as labels and texts.
pub(in crate::report) fn facts(results: &Results) -> Vec<(&'static str, String)> {
    let rows = format!("{} after decimation", results.decimated_rows);
    let mut facts = vec![("robot", results.robot.clone())];
    facts.extend(locked_joints(results).map(|joints| ("locked", joints)));
    facts.extend(recordings("samples used", &results.recordings));
    facts.extend(recordings("held back", &results.validation_recordings));
    facts.push(("rows", rows));
    facts.extend(filters(results));
    facts.extend(near_rest(results));
    facts.extend(references(results).map(|r| ("reference", r)));
    facts.extend(results.seed.map(|seed| ("seed", seed.to_string())));
    facts.push(("thetahat", results.thetahat.clone()));
    facts
}

/// The locked joints with their values, if any.
pub(in crate::report) fn locked_joints(results: &Results) -> Option<String> {
    (!results.robot_locked.is_empty()).then(|| locked(&results.robot_locked))
}

fn locked(joints: &[LockedJoint]) -> String {
    let unit = |kind| match kind {
        JointKind::Revolute => "rad",
        JointKind::Prismatic => "m",
    };
    let at = |joint: &LockedJoint| format!("{} at {} {}", joint.name, significant(joint.value, 3), unit(joint.kind));
    joints.iter().map(at).collect::<Vec<_>>().join(", ")
}

/// A line for each recording; with its name if there are several.
fn recordings(label: &'static str, recordings: &[RecordingResult]) -> Vec<(&'static str, String)> {
    let line = |r: &RecordingResult| {
        let ([start, end], rate) = (r.window_s.map(given), rate(r.sample_rate_hz));
        let name = if recordings.len() > 1 { format!("{}: ", r.name) } else { String::new() };
        let weight = if r.weight == 1.0 { String::new() } else { format!(", weight {}", given(r.weight)) };
        let resampled = r.resampling.map(|j| {
            let [rms, largest] = [j.rms_deviation, j.largest_deviation].map(|d| significant(100.0 * d, 2));
            let gaps = match j.gaps {
                0 => String::new(),
                gaps => format!(", {} samples missing in {gaps} gaps", j.missing),
            };
            format!("; resampled: its steps deviate by {rms} % rms, at most {largest} %{gaps}")
        });
        let ends = r.torque_bandwidth_hz.map_or_else(String::new, |hz| {
            format!("; the torques were filtered before recording, bandwidth {} Hz", significant(hz, 2))
        });
        let held = match r.torque_hold_s {
            0.0 => String::new(),
            hold => format!("; torques have a hold time of {} ms and were centred", significant(1e3 * hold, 3)),
        };
        let window = format!("{} at {rate} Hz, window {start} s to {end} s", r.samples_used);
        let notes: String = r.notes.iter().map(|note| format!("; {note}")).collect();
        (label, format!("{name}{window}{weight}{}{ends}{held}{notes}", resampled.unwrap_or_default()))
    };
    recordings.iter().map(line).collect()
}

/// One line for each recording's reference.
fn references(results: &Results) -> impl Iterator<Item = String> {
    let several = results.recordings.len() > 1;
    results.recordings.iter().filter_map(move |r| {
        let text = reference(results, r.reference.as_ref()?);
        Some(if several { format!("{}: {text}", r.name) } else { text })
    })
}

/// The samples near rest that were left out, and how they would change the estimates; none if all were used.
fn near_rest(results: &Results) -> Option<(&'static str, String)> {
    let masks: Vec<&NearRestResult> = results.recordings.iter().filter_map(|r| r.near_rest.as_ref()).collect();
    let percents = || masks.iter().flat_map(|mask| mask.left_out_percent.iter().copied().enumerate());
    let least = percents().map(|(_, percent)| percent).fold(f64::INFINITY, f64::min);
    let (joint, most) = percents().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let widened = masks.iter().map(|mask| mask.widened_s).fold(0.0, f64::max);
    let left_out = format!(
        "{} to {} % of a joint's samples left out, most of joint {}, with {} ms on either side",
        significant(least, 2),
        significant(most, 2),
        joint + 1,
        significant(1e3 * widened, 2),
    );
    let with = results.unmasked_comparison.as_ref().map(|with| {
        let [error, deviations] = [with.relative_error_percent, with.deviations.abs()].map(|v| significant(v, 2));
        let order = if with.deviations < 0.0 { "lower" } else { "higher" };
        format!(
            "; with them idim-ls has an error of {error} %, and {} is {deviations} deviations {order}",
            with.parameter
        )
    });
    Some(("near rest", left_out + &with.unwrap_or_default()))
}

fn filters(results: &Results) -> [(&'static str, String); 2] {
    let bandwidth = &results.bandwidth;
    let position = format!(
        "{} Hz requested; measured: positions {}, accelerations {} Hz",
        given(bandwidth.position_cutoff_hz),
        optional(bandwidth.position_measured_hz, 3),
        optional(bandwidth.acceleration_measured_hz, 3),
    );
    let decimation = format!(
        "{} Hz requested; measured: {} Hz",
        given(bandwidth.decimation_cutoff_hz),
        optional(bandwidth.decimation_measured_hz, 3),
    );
    [("position filter", position), ("parallel filter", decimation)]
}

fn reference(results: &Results, reference: &ReferenceResult) -> String {
    let moves = reference.moves.map(|m| format!(", {m} moves")).unwrap_or_default();
    let period = reference.periodic.map(|p| {
        let [frequency, from, to] = [p.base_frequency_hz, p.stretch_s[0], p.stretch_s[1]].map(|v| significant(v, 4));
        let drift = if p.degree > 0 { format!(" and a polynomial of degree {}", p.degree) } else { String::new() };
        let periods = significant(p.periods, 3);
        let plural = if p.harmonics == 1 { "" } else { "s" };
        format!(
            ", {frequency} Hz with {} harmonic{plural}{drift}, {periods} periods from {from} s to {to} s",
            p.harmonics
        )
    });
    let smoothed = reference.smoothing_cutoff_hz.map(|hz| match reference.periodic {
        Some(_) => format!(", outside smoothed at {} Hz", significant(hz, 3)),
        None => format!(", smoothed at {} Hz", significant(hz, 3)),
    });
    let worst = reference.rms_deviation.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1));
    let deviation = worst.map(|(joint, rms)| {
        let unit = units::thousandth_of_position(results, joint);
        format!("; worst rms deviation {} {unit}, joint {}", significant(1e3 * rms, 3), joint + 1)
    });
    let parts = [period, smoothed, deviation].map(Option::unwrap_or_default).concat();
    format!("{}{moves}{parts}", reference.origin)
}

/// The weighting of each method; none if the results do not contain it.
pub(in crate::report) fn weights(results: &Results) -> Option<String> {
    let mut weights: Vec<String> = Vec::new();
    for run in &results.runs {
        let weight = format!("{} {}", run.method.name(), run.weighting?.name());
        if !weights.contains(&weight) {
            weights.push(weight);
        }
    }
    Some(weights.join(", "))
}
