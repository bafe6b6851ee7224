//! What `watch` says, as lines for the terminal and for machines.

use super::{
    error::ReportError,
    number::significant,
    wrap::{TextWidth, wrap},
};
use crate::results::{
    JointResult, WatchChange, WatchCollision, WatchDrift, WatchEvent, WatchResidual, WatchSettled, WatchSummary,
};
use thetahat_ground::visible::visible;

/// Parameters of a cause that are shown: of a payload its mass and first moments.
const SHOWN: usize = 4;
/// Columns of the time at the beginning of a line.
const TIME: usize = 10;

/// The lines before all events: whose torques are compared.
#[must_use]
pub fn watch_head(origin: &str, width: TextWidth) -> String {
    wrap(&format!("measured torques less those of {origin}"), "", width)
}

/// An event as lines that fit; `joints` are those of the robot.
#[must_use]
pub fn watch_text(event: &WatchEvent, joints: &[JointResult], width: TextWidth) -> String {
    match event {
        WatchEvent::Settled(settled) => at(settled.time_s, &settled_text(settled, joints), width),
        WatchEvent::Start(drift) => at(drift.time_s, &format!("at the start: {}", drift_text(drift)), width),
        WatchEvent::Collision(collision) => at(collision.time_s, &collision_text(collision), width),
        WatchEvent::Drift(drift) => {
            let began = format!("; began near {:.1} s", drift.began_s);
            at(drift.time_s, &format!("changed: {}{began}", drift_text(drift)), width)
        }
        WatchEvent::Residual(residual) => at(residual.time_s, &residual_text(residual, joints), width),
        WatchEvent::Summary(summary) => summary_text(summary, width),
    }
}

/// An event as one line of JSON.
///
/// # Errors
/// [`ReportError`] for what cannot be rendered.
pub fn watch_json(event: &WatchEvent) -> Result<String, ReportError> {
    let line = serde_json::to_string(event).map_err(|source| ReportError::PrintedJson { source })?;
    Ok(line + "\n")
}

/// A text after its time, with later lines below it.
fn at(time_s: f64, text: &str, width: TextWidth) -> String {
    let lines = wrap(text, &" ".repeat(TIME), width);
    format!("{:<TIME$}{}", format!("{time_s:.2} s "), lines.trim_start())
}

fn settled_text(settled: &WatchSettled, joints: &[JointResult]) -> String {
    let resting = joints.iter().zip(1..).zip(&settled.deviation).filter(|(_, deviation)| deviation.is_none());
    let resting: Vec<String> = resting.map(|((joint, number), _)| visible(&joint.label(number)).into_owned()).collect();
    let not_watched = match resting.as_slice() {
        [] => String::new(),
        _ => format!("; too little motion to watch {}", resting.join(", ")),
    };
    format!(
        "watching: noise and mean of the residual are known, events are said {:.2} s late or more; {} false alarms per hour{not_watched}",
        settled.delay_s,
        significant(settled.alarms_per_hour, 2)
    )
}

fn collision_text(collision: &WatchCollision) -> String {
    format!(
        "collision-like: {} {} {}, began at {:.2} s",
        visible(&collision.label),
        signed(collision.torque),
        collision.unit,
        collision.began_s
    )
}

fn drift_text(drift: &WatchDrift) -> String {
    let changes: Vec<String> = drift.changes.iter().take(SHOWN).map(change_text).collect();
    let rivals = match drift.rivals.as_slice() {
        [] => String::new(),
        rivals => {
            format!("; explained as well by {}", rivals.iter().map(|r| visible(r)).collect::<Vec<_>>().join(", "))
        }
    };
    format!("{}: {}{rivals}", visible(&drift.cause), changes.join(", "))
}

/// `fc2 +0.65 (0.41 to 0.89) N m, +10 %`.
fn change_text(change: &WatchChange) -> String {
    let [low, high] = change.interval_95;
    let percent = change.percent.map(|percent| format!(", {percent:+.0} %")).unwrap_or_default();
    format!(
        "{} {} ({} to {}) {}{percent}",
        change.parameter,
        signed(change.change),
        significant(low, 2),
        significant(high, 2),
        change.unit
    )
}

fn signed(value: f64) -> String {
    let sign = if value < 0.0 { "" } else { "+" };
    format!("{sign}{}", significant(value, 2))
}

fn residual_text(residual: &WatchResidual, joints: &[JointResult]) -> String {
    let of = |(j, joint): (usize, &JointResult)| {
        let (rms, percent) = (residual.rms[j]?, residual.percent[j]?);
        let label = joint.label(j + 1);
        Some(format!("{} {} {} ({percent:.1} %)", visible(&label), significant(rms, 2), joint.torque_unit))
    };
    let all: Vec<String> = joints.iter().enumerate().filter_map(of).collect();
    format!("residual: {}", if all.is_empty() { "no joint moved".to_owned() } else { all.join(", ") })
}

fn summary_text(summary: &WatchSummary, width: TextWidth) -> String {
    let WatchSummary { watched_s, gaps, incomplete, collisions, drifts, residual, joints, .. } = summary;
    let of = |count: usize, one: &str, many: &str| format!("{count} {}", if count == 1 { one } else { many });
    let found = match (*collisions, *drifts) {
        (0, 0) => "nothing found".to_owned(),
        (collisions, drifts) => format!(
            "{}, {}",
            of(collisions, "collision-like event", "collision-like events"),
            of(drifts, "change of friction, offset or payload", "changes of friction, offset or payload")
        ),
    };
    let mut text = wrap(
        &format!(
            "watched for {watched_s:.1} s: {found}; {}, {} left out",
            of(*gaps, "gap", "gaps"),
            of(*incomplete, "incomplete sample", "incomplete samples")
        ),
        "",
        width,
    );
    text += &wrap(&residual_text(residual, joints), "", width);
    let changed = summary.changes.iter().filter(|change| is_shown(change));
    let changed: Vec<String> = changed.map(change_text).collect();
    if !changed.is_empty() {
        text += &wrap(&format!("since watching began (95 % for all together): {}", changed.join("; ")), "", width);
    }
    text
}

/// Whether a change's interval leaves zero out.
fn is_shown(change: &WatchChange) -> bool {
    let [low, high] = change.interval_95;
    low > 0.0 || high < 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_fit_and_say_what_changed() {
        let change = WatchChange {
            parameter: "fc2".to_owned(),
            unit: "N m".to_owned(),
            change: 0.654,
            interval_95: [0.41, 0.89],
            percent: Some(10.2),
        };
        let drift = WatchDrift {
            time_s: 73.2,
            began_s: 61.0,
            cause: "friction of joint 2".to_owned(),
            rivals: vec!["payload".to_owned()],
            changes: vec![change],
            evidence: 17.0,
        };
        let text = watch_text(&WatchEvent::Drift(drift.clone()), &[], TextWidth::default());
        let expected = "73.20 s   changed: friction of joint 2: fc2 +0.65 (0.41 to 0.89) N m, +10 %;\n          explained as well by \
                        payload; began near 61.0 s\n";
        assert_eq!(text, expected);
        let json = watch_json(&WatchEvent::Drift(drift)).unwrap();
        assert!(json.starts_with("{\"kind\":\"drift\",\"time_s\":73.2,") && json.ends_with("}\n"), "{json}");
    }
}
