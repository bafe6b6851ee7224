//! Remedies in a few words.

use thetahat_ground::number::{fixed, significant};
use thetahat_model::robot::Robot;
use thetahat_report::results::{RemedySignal, RemedyStep, SettingChange};

/// What a step does.
pub(super) fn label(step: &RemedyStep, changes: &[SettingChange], robot: &Robot) -> String {
    let number = |coordinate: usize| robot.joint_of(coordinate) + 1;
    match step {
        RemedyStep::OrderJoints { signal, order } => {
            let of = match signal {
                RemedySignal::Both => String::new(),
                RemedySignal::Position | RemedySignal::Torque => format!("the {} of ", plural(*signal)),
            };
            match step.moved_joints()[..] {
                [a, b] => format!("Exchange {of}joints {} and {}", number(a - 1), number(b - 1)),
                _ => {
                    let order: Vec<String> = order.iter().map(|joint| number(joint - 1).to_string()).collect();
                    format!("Take {of}joints in the order {}", order.join(", "))
                }
            }
        }
        RemedyStep::Scale { position, torque } => {
            let of = |signal, factors| scaled(signal, factors, changes, &number);
            [of(RemedySignal::Position, position), of(RemedySignal::Torque, torque)]
                .into_iter()
                .flatten()
                .collect::<Vec<_>>()
                .join("; ")
        }
        RemedyStep::Side { signal, at_motor } => {
            format!("{} at the {}", capital(plural(*signal)), if *at_motor { "motor" } else { "joint" })
        }
        RemedyStep::Delay { delay_s, joints } => {
            let order = if *delay_s > 0.0 { "late" } else { "early" };
            let joints: Vec<String> = joints.iter().map(|&j| number(j - 1).to_string()).collect();
            let of = if joints.is_empty() { String::new() } else { format!(" of joint {}", joints.join(", ")) };
            format!("Torque{of} {} ms {order}", significant(1e3 * delay_s.abs(), 3))
        }
        RemedyStep::Hold => "Torque held until the next sample".to_owned(),
        RemedyStep::LowPass { time_constant_s } => {
            format!("Torque before a low-pass filter of {} ms", significant(1e3 * time_constant_s, 3))
        }
        RemedyStep::Cutoff { cutoff_hz } => format!("Cut-off {cutoff_hz} Hz"),
        RemedyStep::EqualSteps { sample_rate_hz } => format!("Equal steps at {} Hz", significant(*sample_rate_hz, 6)),
        RemedyStep::LeaveOutRests => "Leave out samples near rest".to_owned(),
        RemedyStep::LeaveOutTimes { times } => {
            let seconds: f64 = times.iter().map(|[from, to]| to - from).sum();
            format!("Leave out {} s of the recording", significant(seconds, 3))
        }
        RemedyStep::Essential { left_out } => {
            format!("Leave out {left_out} parameter{}", if *left_out == 1 { "" } else { "s" })
        }
        RemedyStep::CorrectReference { .. } => "Correct the reference".to_owned(),
        RemedyStep::LockJoint { joint, .. } => format!("Lock joint {}", number(joint - 1)),
        RemedyStep::AddTerm { term, joints } => match joints.as_slice() {
            [] => format!("Add the term {term}"),
            joints => format!("Add the term {term} to {}", joints.join(", ")),
        },
        RemedyStep::Gravity { gravity } => {
            format!("Gravity [{}] m/s^2", gravity.map(|g| fixed(g, 3)).join(", "))
        }
        RemedyStep::Estimated { size } => format!("Count the deviation of {size} in the intervals"),
    }
}

fn plural(signal: RemedySignal) -> &'static str {
    match signal {
        RemedySignal::Position => "positions",
        RemedySignal::Torque => "torques",
        RemedySignal::Both => "positions and torques",
    }
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map(|first| first.to_uppercase().chain(letters).collect()).unwrap_or_default()
}

/// Factors of a signal: a unit, a sign or a factor.
fn scaled(
    signal: RemedySignal,
    factors: &[f64],
    changes: &[SettingChange],
    number: &dyn Fn(usize) -> usize,
) -> Option<String> {
    let changed: Vec<usize> = (0..factors.len()).filter(|&j| factors[j] != 1.0).collect();
    let first = factors[*changed.first()?];
    let name = if signal == RemedySignal::Position { "position" } else { "torque" };
    let unit = changes.iter().find(|change| change.key.ends_with(&format!("{name}.unit")));
    if let Some(unit) = unit.and_then(|change| change.after.as_ref()) {
        return Some(format!("Unit of {name}: {}", unit.trim_matches('"')));
    }
    let joints: Vec<String> = changed.iter().map(|&j| number(j).to_string()).collect();
    let whose = match (changed.len() == factors.len(), joints.as_slice()) {
        (true, [_, _, ..]) => "all joints".to_owned(),
        (_, [joint]) => format!("joint {joint}"),
        (_, joints) => format!("joints {}", joints.join(", ")),
    };
    let is_one_factor = changed.iter().all(|&j| factors[j] == first);
    Some(match (is_one_factor, first == -1.0) {
        (true, true) => format!("Reverse the {name} of {whose}"),
        (true, false) => format!("Scale the {name} of {whose} by {}", significant(first, 5)),
        (false, _) => format!("Scale the {name} of {whose}"),
    })
}
