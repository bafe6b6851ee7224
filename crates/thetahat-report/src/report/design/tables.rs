//! A design as facts, sentences and tables.

use crate::{
    report::{
        number::{NONE, estimate, significant},
        table::Table,
    },
    results::{
        CollisionResults, DesignResults, Grade, LimitUse, Limited, PairDistance, PredictedGain, PredictedParameter,
        PredictedPayload, PredictedTorques, SpectrumBound,
    },
};
use thetahat_ground::visible::visible;

fn duration_s(results: &DesignResults) -> f64 {
    results.q.len().saturating_sub(1) as f64 / results.sample_rate_hz
}

pub(in crate::report) fn facts(results: &DesignResults) -> Vec<(&'static str, String)> {
    let best = results.starts.first().map_or(f64::NAN, |s| s.found);
    vec![
        ("robot", results.robot.clone()),
        ("motion", motion(results)),
        ("criterion", format!("{}: {best:.2} nats, the best of {} starts", results.criterion, results.starts.len())),
        (
            "predicted",
            format!(
                "{} on {}",
                results.method,
                if results.is_closed_loop { "the simulated loop" } else { "the motion as designed" }
            ),
        ),
    ]
}

fn motion(results: &DesignResults) -> String {
    let sweeps = if results.sweeps > 0 { format!(" and {} sweeps", results.sweeps) } else { String::new() };
    let moves = results.moves.as_ref().map(|moves| moves.moves().len() - results.sweeps);
    let kind = moves.map_or_else(String::new, |moves| format!(", {moves} moves{sweeps}"));
    format!("{} s at {} Hz{kind}, from rest to rest", significant(duration_s(results), 4), results.sample_rate_hz)
}

/// The conclusions from the tables.
pub(in crate::report) fn conclusions(results: &DesignResults) -> Vec<String> {
    let known = || results.predicted.iter().filter(|p| p.a_priori != 0.0);
    let count = |grade: Grade| known().filter(|p| p.grade() == grade).count();
    let [precise, rough, lost] = [Grade::Precise, Grade::Rough, Grade::NotIdentified].map(count);
    let (all, known_ones) = (results.predicted.len(), known().count());
    let mut lines: Vec<String> = results.stopped_after.iter().map(stopped).collect();
    lines.push(format!(
        "{all} parameters are predicted. Of the {known_ones} whose a-priori value is not zero, if that is right: {precise} precise, \
         {rough} rough, {lost} not distinguishable from zero."
    ));
    let unknown: Vec<&str> = known().filter(|p| p.grade() == Grade::NotIdentified).map(|p| p.name.as_str()).collect();
    if !unknown.is_empty() {
        lines.push(format!("Not distinguishable from zero: {}.", unknown.join(", ")));
        lines.extend(remedy(results));
    }
    lines.extend(without_drives(results));
    lines.extend(results.limits.iter().max_by(|a, b| a.part.total_cmp(&b.part)).map(|worst| {
        format!(
            "No limit is exceeded at 1 kHz; the closest is the {} of {}, used to {:.1} % at {:.3} s.",
            worst.quantity.name(),
            visible(&worst.joint),
            100.0 * worst.part,
            worst.at_s
        )
    }));
    lines.extend(executed(results));
    lines.extend(results.assumed_overshoot.map(|percent| {
        format!(
            "Velocities of the moves leave room for an overshoot of {} %, since [controller] is missing (overshoot_percent in [uncertainty]).",
            significant(percent, 3)
        )
    }));
    lines.extend(narrow_filter(results));
    lines.extend(results.uncertainty.map(|(draws, percent)| {
        format!(
            "Torque and power limits hold for the a-priori parameters and for {draws} random robots with parameters {} % off; the criterion \
             does not depend on them.",
            significant(percent, 3)
        )
    }));
    lines.extend(results.payload.iter().map(payload));
    lines.extend(results.collision.iter().flat_map(nearness));
    if results.collision.is_none() {
        lines.push(NOT_CHECKED.to_owned());
    }
    lines.extend(earlier(results));
    lines.extend(results.wanted_torques.iter().map(wanted_torques));
    lines.extend(results.compared.iter().map(|[title, method]| narrower(results, title, method)));
    let best = results.starts.first().map(|s| s.found);
    lines.extend(results.repeated.zip(best).map(|(repeated, best)| repetition(repeated, best)));
    lines
}

fn stopped([ended, of]: &[usize; 2]) -> String {
    format!("The search was stopped after {ended} of {of} descents: a longer one may find a better motion.")
}

/// The limits in the simulated loop.
fn executed(results: &DesignResults) -> Option<String> {
    let executed = &results.executed;
    let controller =
        if executed.is_stated { "the controller" } else { "a usual PD loop of 10 Hz, since [controller] is missing" };
    if let Some(failure) = &executed.failure {
        return Some(format!("Not checked: the limits under {controller}: {}.", visible(failure)));
    }
    let worst = executed.uses.iter().max_by(|a, b| a.part.total_cmp(&b.part))?;
    let used = format!(
        "{} of {}, used to {:.1} % at {:.3} s",
        worst.quantity.name(),
        visible(&worst.joint),
        100.0 * worst.part,
        worst.at_s
    );
    Some(if worst.part <= 1.0 {
        format!(
            "Simulated once under {controller}, the robot stays within velocity, torque and power too; the closest is the {used}."
        )
    } else {
        format!(
            "Simulated once under {controller}, the robot exceeds a limit: the {used}. Remedy: a larger [limits] margin{}.",
            if executed.is_stated { "" } else { ", or the controller's values" }
        )
    })
}

/// How long the motion must last, with what earlier recordings know.
fn earlier(results: &DesignResults) -> Option<String> {
    let times: Vec<(&str, f64)> =
        results.predicted.iter().filter_map(|p| Some((p.name.as_str(), p.seconds?))).collect();
    let soon = times.iter().filter(|(_, seconds)| *seconds <= LONGEST_S).max_by(|a, b| a.1.total_cmp(&b.1));
    let (last, seconds) = soon.filter(|_| results.knows_earlier)?;
    let never: Vec<&str> = times.iter().filter(|(_, s)| *s > LONGEST_S).map(|(name, _)| *name).collect();
    let but = if never.is_empty() { String::new() } else { format!("; an hour does not for {}", never.join(", ")) };
    Some(format!(
        "With what the earlier recordings know, {} s of this motion bring {} of {} intervals to {} % (the last is {last}){but}.",
        significant(*seconds, 2),
        times.len() - never.len(),
        times.len(),
        significant(results.half_width_percent, 3)
    ))
}

/// The error of the wanted torques.
fn wanted_torques(torques: &PredictedTorques) -> String {
    let [percent, wanted] = [torques.percent, torques.wanted_percent].map(|percent| significant(percent, 2));
    let before = torques.before_percent.map(|before| format!(", {} % before", significant(before, 2)));
    let time = match torques.seconds {
        Some(0.0) => format!("what is known suffices for {wanted} %"),
        Some(seconds) if seconds <= LONGEST_S => format!("{wanted} % takes {} s of it", significant(seconds, 2)),
        Some(_) | None => format!("an hour of it does not bring {wanted} %"),
    };
    format!(
        "The torques of {} will be known to {percent} % (standard deviation by noise alone{}) after this motion; {time}.",
        visible(&torques.file),
        before.unwrap_or_default()
    )
}

/// What a design without shapes does not check, and how to.
const NOT_CHECKED: &str = "Not checked: whether the robot touches itself, the floor or what stands around it. With [collision] margin = 50 and \
     [[collision.obstacles]] kind = \"plane\", name = \"floor\", normal = [0, 0, 1] its links stay 50 mm above the floor.";

/// The joints whose torques will be larger than designed.
fn without_drives(results: &DesignResults) -> Option<String> {
    let named =
        |joints: &[String]| joints.iter().map(|joint| visible(joint).into_owned()).collect::<Vec<_>>().join(" ");
    let lacks = [("friction", &results.without_friction), ("motor inertia", &results.without_motor_inertia)];
    let lacks: Vec<String> = lacks
        .into_iter()
        .filter(|(_, joints)| !joints.is_empty())
        .map(|(what, joints)| format!("no {what} ({})", named(joints)))
        .collect();
    (!lacks.is_empty()).then(|| {
        let [friction, inertia] = results.assumed_percent.map(|percent| significant(percent, 3));
        let alone = largest_torque(results).map_or_else(String::new, |part| {
            format!("; of the a-priori robot alone torques reach {} % of a limit", significant(100.0 * part, 3))
        });
        format!(
            "The a-priori robot has {}: executed torques will be larger than its own. Torque limits hold for a robot with friction of \
             {friction} % of the limit at the largest velocity, and motor inertia of {inertia} % of the joint's, in their place{alone}. \
             These are guesses: state fv, fc and ia in [parameters] of the robot, or other guesses as friction_percent and \
             motor_inertia_percent in [uncertainty].",
            lacks.join(" and ")
        )
    })
}

/// The largest torque of the a-priori robot, as a part of its limit.
fn largest_torque(results: &DesignResults) -> Option<f64> {
    let limits = results.limits.iter().filter(|limit| limit.quantity == Limited::Torque);
    let part = |limit: &LimitUse| {
        let largest = results.torque.channel(limit.coordinate).iter().fold(0.0, |most: f64, tau| most.max(tau.abs()));
        largest / limit.limit[1]
    };
    limits.map(part).reduce(f64::max)
}

/// The longest recording that is worth a proposal, s.
const LONGEST_S: f64 = 3600.0;

/// Recording time until the intervals exclude zero, with this motion and with one designed for such parameters alone.
fn remedy(results: &DesignResults) -> Vec<String> {
    let duration_s = duration_s(results);
    let one = |p: &PredictedParameter| {
        let times = p.narrower_by_own_motion?;
        let seconds = duration_s * (p.half_width_95 / p.a_priori).powi(2);
        let [this, own] = [seconds, seconds / times.powi(2)].map(recording_time);
        let is_soon = seconds.min(seconds / times.powi(2)) <= LONGEST_S;
        Some((is_soon, p.name.clone(), format!("{} after {this} of this motion or {own} of its own", p.name)))
    };
    let (soon, late): (Vec<_>, Vec<_>) = results.predicted.iter().filter_map(one).partition(|(is_soon, ..)| *is_soon);
    let times: Vec<String> = soon.into_iter().map(|(.., times)| times).collect();
    let names: Vec<String> = late.into_iter().map(|(_, name, _)| name).collect();
    let remedy = (!times.is_empty()).then(|| {
        format!(
            "Remedy: a motion designed for them alone ([wanted] criterion = \"chosen\", parameters = their names), or a longer \
             recording. Distinguishable from zero, by the information of both motions: {}. A known payload does not help \
             with these.",
            times.join("; ")
        )
    });
    let none = (!names.is_empty())
        .then(|| format!("An hour of this motion, or of one of its own, does not show {}.", names.join(", ")));
    remedy.into_iter().chain(none).collect()
}

fn recording_time(seconds: f64) -> String {
    if seconds <= LONGEST_S { format!("{} s", significant(seconds, 2)) } else { "more than an hour".to_owned() }
}

/// The requirements of a payload, and the predicted intervals of the drive gains.
fn payload(payload: &PredictedPayload) -> String {
    let identifiable = |gain: &PredictedGain| {
        let percent = gain.half_width_percent?;
        Some(format!("{} to {} %", visible(&gain.joint), significant(percent, 2)))
    };
    let all: Vec<String> = payload.gains.iter().filter_map(identifiable).collect();
    let not_identifiable = payload.gains.iter().filter(|gain| gain.half_width_percent.is_none());
    let not_identifiable: Vec<String> = not_identifiable.map(|gain| visible(&gain.joint).into_owned()).collect();
    let listed = |list: &[String]| if list.is_empty() { "none".to_owned() } else { list.join(", ") };
    format!(
        "Payload {} of {} kg: limits hold with and without it. It is known, so the robot's parameters are identified as \
         well as without it. A second recording without it identifies the drive gains (half width of the 95 % interval): {}. \
         Not identifiable: {}.",
        visible(&payload.name),
        significant(payload.mass_kg, 4),
        listed(&all),
        listed(&not_identifiable)
    )
}

/// The intervals compared with those of earlier results.
fn narrower(results: &DesignResults, title: &str, method: &str) -> String {
    let times: Vec<f64> = results.predicted.iter().filter_map(PredictedParameter::times_smaller).collect();
    let mean = (times.iter().map(|t| t.ln()).sum::<f64>() / times.len() as f64).exp();
    let wider = results.predicted.iter().filter(|p| p.times_smaller().is_some_and(|t| t < 1.0));
    let wider: Vec<&str> = wider.map(|p| p.name.as_str()).collect();
    let also = if wider.is_empty() { "none is wider".to_owned() } else { format!("wider: {}", wider.join(", ")) };
    format!(
        "Compared with {method} of {}: for {} parameters the intervals are {} times narrower in the geometric mean; {also}.",
        visible(title),
        times.len(),
        significant(mean, 3)
    )
}

/// Whether the motion is better than repeating the last recording.
fn repetition(repeated: f64, best: f64) -> String {
    let gain = repeated - best;
    if gain >= 0.0 {
        format!("Repeating the last recording for the same time would give a criterion {gain:.2} nats higher (worse).")
    } else {
        format!(
            "Repeat the last recording instead: for the same time its criterion is {:.2} nats lower (better).",
            -gain
        )
    }
}

/// Times the frequencies of a motion that a filter must pass: with less, friction looks like another law at the corners of moves.
const HEADROOM: f64 = 1.5;

/// The cut-off that the motion needs, where it has less.
fn narrow_filter(results: &DesignResults) -> Option<String> {
    let end = results.spectrum.end_hz.iter().copied().fold(0.0, f64::max);
    let cutoff = results.spectrum.position_cutoff_hz;
    (cutoff < HEADROOM * end).then(|| {
        format!(
            "The position filter of {} Hz is narrow for this motion, whose accelerations have 99 % of their variance below {} Hz: friction \
             will look like another law. Remedy: [signal] cutoff_hz = {}, or a smoother motion.",
            significant(cutoff, 3),
            significant(end, 3),
            significant(HEADROOM * end, 2)
        )
    })
}

/// Whether the motion is within the bandwidths of filters and controller.
pub(in crate::report) fn frequencies(results: &DesignResults) -> Vec<String> {
    let spectrum = &results.spectrum;
    let end = spectrum.end_hz.iter().copied().fold(0.0, f64::max);
    let bound = |b: &SpectrumBound| format!("{} {} Hz", b.name, significant(b.frequency_hz, 3));
    let bounds: Vec<String> = spectrum.bounds.iter().map(bound).collect();
    let passed: Vec<&str> = spectrum.bounds.iter().filter(|b| b.frequency_hz < end).map(|b| b.name).collect();
    let verdict = match passed[..] {
        [] => "all of them pass the motion".to_owned(),
        _ => format!("the motion exceeds: {}", passed.join(", ")),
    };
    vec![format!(
        "99 % of the variance of each joint's acceleration lies below {} Hz. Bandwidths: {}; {verdict}.",
        significant(end, 3),
        bounds.join(", ")
    )]
}

/// The smallest distance of shapes, and what is not covered.
pub(in crate::report) fn nearness(collision: &CollisionResults) -> Vec<String> {
    let mut lines = Vec::new();
    if let Some(nearest) = collision.pairs.first() {
        let at = nearest.at_s.map_or_else(|| "on the path from home".to_owned(), |at| format!("at {at:.3} s"));
        lines.push(format!(
            "All shapes stay at least {} mm apart at 1 kHz; the closest are {} and {}, {} mm {at}.",
            significant(1e3 * collision.margin, 4),
            visible(&nearest.first),
            visible(&nearest.second),
            significant(1e3 * nearest.distance, 4)
        ));
    }
    if !collision.has_way {
        lines.push("The path to the first posture is not covered: give [collision] home.".to_owned());
    }
    if !collision.uncovered.is_empty() {
        let names: Vec<_> = collision.uncovered.iter().map(|name| visible(name)).collect();
        lines.push(format!(
            "Not covered, since their shapes are meshes: {}. Give [collision] capsules.",
            names.join(", ")
        ));
    }
    lines
}

pub(in crate::report) fn distances(collision: &CollisionResults) -> Table {
    let row = |pair: &PairDistance| {
        vec![
            visible(&pair.first).into_owned(),
            visible(&pair.second).into_owned(),
            significant(1e3 * pair.distance, 4),
            pair.at_s.map_or_else(|| "from home".to_owned(), |at| format!("{at:.3}")),
        ]
    };
    Table {
        title: "Smallest distances at 1 kHz".to_owned(),
        lead: 2,
        head: strings(&["link", "from", "mm", "at, s"]),
        rows: collision.pairs.iter().map(row).collect(),
        ..Table::default()
    }
}

fn strings(texts: &[&str]) -> Vec<String> {
    texts.iter().map(|t| (*t).to_owned()).collect()
}

pub(in crate::report) fn predicted(results: &DesignResults) -> Table {
    let time_for = format!("s for {} %", significant(results.half_width_percent, 3));
    let row = |p: &PredictedParameter| {
        let percent = (p.a_priori != 0.0).then(|| 100.0 * p.half_width_95 / p.a_priori.abs());
        vec![
            p.name.clone(),
            p.unit.clone(),
            estimate(p.a_priori, Some(p.half_width_95)),
            significant(p.standard_deviation, 3),
            significant(p.half_width_95, 3),
            percent.map_or_else(|| NONE.to_owned(), |v| significant(v, 3)),
            p.seconds.map_or_else(|| NONE.to_owned(), |s| significant(s, 2)),
            if p.a_priori == 0.0 { NONE.to_owned() } else { p.grade().name().to_owned() },
        ]
        .into_iter()
        .chain(
            results
                .compared
                .iter()
                .map(|_| p.times_smaller().map_or_else(|| NONE.to_owned(), |times| significant(times, 3))),
        )
        .collect()
    };
    let mut head = strings(&["name", "unit", "a priori", "deviation", "half of 95 %", "in %", &time_for, "grade"]);
    head.extend(results.compared.iter().map(|_| "times as narrow".to_owned()));
    Table {
        title: "Predicted intervals".to_owned(),
        lead: 1,
        head,
        rows: results.predicted.iter().map(row).collect(),
        notes: vec![format!(
            "half of 95 %: predicted half width of interval_95 by {}; {time_for}: recording time for it, by repeating the motion. Intervals \
             shrink with the root of the time.",
            results.method
        )],
        ..Table::default()
    }
}

pub(in crate::report) fn limits(results: &DesignResults) -> Table {
    let in_loop = |l: &LimitUse| {
        let same = |e: &&LimitUse| (e.coordinate, e.quantity) == (l.coordinate, l.quantity);
        results.executed.uses.iter().find(same).map_or_else(|| NONE.to_owned(), |e| format!("{:.1}", 100.0 * e.part))
    };
    let row = |l: &LimitUse| {
        let [low, high] = l.limit.map(|v| significant(v, 4));
        let [least, most] = l.reached.map(|v| significant(v, 4));
        let (used, at) = (format!("{:.1}", 100.0 * l.part), format!("{:.3}", l.at_s));
        vec![visible(&l.joint).into_owned(), l.quantity.name().to_owned(), low, high, least, most, used, at, in_loop(l)]
    };
    Table {
        title: "Limits at 1 kHz, SI".to_owned(),
        lead: 2,
        head: strings(&["joint", "quantity", "lower", "upper", "min", "max", "used, %", "at, s", "loop, %"]),
        rows: results.limits.iter().map(row).collect(),
        notes: vec!["loop: used in the simulated loop.".to_owned()],
        ..Table::default()
    }
}
