//! What the names of columns say: signal, joint, unit.

use super::unit_words;

/// What a column seems to hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Signal {
    Time,
    Position,
    Velocity,
    Torque,
    Reference,
}

/// Words that name a signal, each in the spellings that logs use.
const TIME: [&str; 9] = ["t", "time", "times", "timestamp", "stamp", "sec", "tout", "zeit", "zeitstempel"];
/// Words that make the last of a path a time, whatever stands before: `q.time` of a signal of Simulink.
const LAST_OF_TIME: [&str; 3] = ["time", "timestamp", "stamp"];
const POSITION: [&str; 17] = [
    "q",
    "qpos",
    "qm",
    "pos",
    "position",
    "positions",
    "angle",
    "angles",
    "theta",
    "th",
    "phi",
    "enc",
    "encoder",
    "x",
    "lage",
    "winkel",
    "ist",
];
const VELOCITY: [&str; 10] =
    ["dq", "qd", "qdot", "qvel", "vel", "velocity", "velocities", "speed", "speeds", "geschwindigkeit"];
const TORQUE: [&str; 21] = [
    "qfrc",
    "tau",
    "torque",
    "torques",
    "trq",
    "tq",
    "effort",
    "eff",
    "efforts",
    "moment",
    "force",
    "current",
    "currents",
    "curr",
    "cur",
    "vir",
    "voltage",
    "u",
    "drehmoment",
    "momente",
    "strom",
];
/// Words that name a joint.
const BARE_JOINT: [&str; 3] = ["j", "joint", "axis"];
/// Those of the words for torques that name the signal of a drive.
const DRIVE_SIGNALS: [&str; 8] = ["current", "currents", "curr", "cur", "vir", "voltage", "u", "strom"];
const OTHER: [&str; 9] = ["ddq", "qdd", "qacc", "acc", "accel", "acceleration", "accelerations", "temp", "temperature"];
/// Words that mark a signal as desired, not measured.
const DESIRED_WORDS: [&str; 17] = [
    "ref",
    "reference",
    "references",
    "target",
    "des",
    "desired",
    "cmd",
    "command",
    "commands",
    "commanded",
    "setpoint",
    "goal",
    "soll",
    "action",
    "actions",
    "sp",
    "ctrl",
];
/// Words that mark positions as desired where the log has others without them.
const LEADING_WORDS: [&str; 4] = ["nominal", "leader", "interp", "input"];
/// How LeRobot calls the measured positions where it has no names for them.
const STATE: [&str; 2] = ["observation", "state"];
/// Short for "desired" after the name of a signal: `q_d`, `tau_J_d`.
const DESIRED: &str = "d";

/// Spellings of a reference of the positions in one word.
const REFERENCE: [&str; 6] = ["qg", "qref", "qdes", "qcmd", "qr", "qsoll"];

/// Words of file names that do not distinguish recordings, like the names of signals.
const FILLERS: [&str; 12] =
    ["read", "data", "meas", "measured", "actual", "motor", "mot", "joint", "joints", "log", "file", "raw"];

/// What a name says.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Reading {
    pub(super) signal: Signal,
    /// The last number in it.
    pub(super) number: Option<usize>,
}

/// Reads the name of a column; `None` if it names no signal that is used.
pub(super) fn read(name: &str) -> Option<Reading> {
    let words = words(name);
    let signal = signal(&words, has_word(&words, &DESIRED_WORDS))?;
    Some(Reading { signal, number: number_in(&words) })
}

/// The same of a column among others: `q_d` is the desired value where there is a `q`, and not the position of a joint `d`; `J1` is a
/// position where others are torques and none is a position.
pub(super) fn read_among<'n>(name: &str, mut others: impl Iterator<Item = &'n str> + Clone) -> Option<Reading> {
    let words = words(name);
    let has = |signal| others.clone().any(|other| read(other).is_some_and(|r| r.signal == signal));
    if is_bare_joint(&words) && has(Signal::Torque) && !has(Signal::Position) {
        return Some(Reading { signal: Signal::Position, number: number_in(&words) });
    }
    let is_measured = |other: &str| {
        let words = self::words(other);
        !has_word(&words, &LEADING_WORDS) && read(other).is_some_and(|r| r.signal == Signal::Position)
    };
    let is_desired = match without_desired(&words) {
        Some(without) => others.any(|other| self::words(other) == without),
        None => has_word(&words, &LEADING_WORDS) && others.any(is_measured),
    };
    let signal = signal(&words, is_desired || has_word(&words, &DESIRED_WORDS))?;
    Some(Reading { signal, number: number_in(&words) })
}

/// Whether a name is that of a joint alone: `J1`, `joint_1`.
fn is_bare_joint(words: &[String]) -> bool {
    matches!(words, [word, number] if BARE_JOINT.contains(&word.as_str()) && number.parse::<usize>().is_ok())
}

/// What the name of a file says that its columns hold: desired values of an unnamed signal are positions.
pub(super) fn read_file_name(name: &str) -> Option<Signal> {
    if says_only_desired(name) {
        return Some(Signal::Reference);
    }
    let words = words(name);
    signal(&words, without_desired(&words).is_some() || has_word(&words, &DESIRED_WORDS))
}

/// Whether a name says that values are desired ones, but not of which signal.
pub(super) fn says_only_desired(name: &str) -> bool {
    let words = words(name);
    let lists: [&[&str]; 5] = [&TIME, &POSITION, &VELOCITY, &TORQUE, &OTHER];
    has_word(&words, &DESIRED_WORDS) && !lists.iter().any(|list| has_word(&words, list))
}

/// Whether a name says that values are torques or forces, and not the signal of a drive.
pub(super) fn says_torque(name: &str) -> bool {
    let words = words(name);
    has_word(&words, &TORQUE) && !has_word(&words, &DRIVE_SIGNALS)
}

/// Whether a name is that of a torque which a controller computed.
pub(super) fn says_desired_torque(name: &str) -> bool {
    let words = words(name);
    let is_desired = without_desired(&words).is_some() || has_word(&words, &DESIRED_WORDS);
    has_word(&words, &TORQUE) && is_desired
}

/// The words without the one for "desired"; `None` if there is no such word.
fn without_desired(words: &[String]) -> Option<Vec<String>> {
    let at = words.iter().skip(1).rposition(|word| word == DESIRED)? + 1;
    Some([&words[..at], &words[at + 1..]].concat())
}

fn signal(words: &[String], is_desired: bool) -> Option<Signal> {
    let has = |list: &[&str]| has_word(words, list);
    let signal = match (has(&POSITION), has(&VELOCITY), has(&TORQUE), has(&TIME)) {
        _ if has(&OTHER) => None,
        _ if words.last().is_some_and(|last| LAST_OF_TIME.contains(&last.as_str())) => Some(Signal::Time),
        (_, true, ..) => Some(Signal::Velocity),
        (_, _, true, _) => Some(Signal::Torque),
        (true, ..) => Some(Signal::Position),
        _ if words.starts_with(&STATE.map(str::to_owned)) => Some(Signal::Position),
        (.., true) => Some(Signal::Time),
        _ => None,
    };
    match (signal, is_desired) {
        (None, _) if has(&REFERENCE) && !has(&OTHER) => Some(Signal::Reference),
        (Some(Signal::Position), true) => Some(Signal::Reference),
        (Some(Signal::Time) | None, false) | (Some(_), false) => signal,
        _ => None,
    }
}

/// Whether a name has no words but those of signals, of files and of units, and numbers.
pub(super) fn has_only_words_of_signals(name: &str) -> bool {
    const UNITS: [&str; 8] = ["rad", "deg", "m", "mm", "nm", "n", "a", "ma"];
    let lists: [&[&str]; 7] = [&TIME, &POSITION, &VELOCITY, &TORQUE, &DESIRED_WORDS, &FILLERS, &UNITS];
    let is_known =
        |word: &String| word.parse::<u64>().is_ok() || lists.iter().any(|list| list.contains(&word.as_str()));
    words(name).iter().all(is_known)
}

/// Whether a name has no word of any signal, used or not: something else must show what the column holds.
pub(super) fn is_silent(name: &str) -> bool {
    let words = words(name);
    let lists: [&[&str]; 7] = [&TIME, &POSITION, &VELOCITY, &TORQUE, &OTHER, &DESIRED_WORDS, &REFERENCE];
    !lists.iter().any(|list| has_word(&words, list))
}

/// Whether a name has a word.
pub(super) fn has(name: &str, word: &str) -> bool {
    words(name).iter().any(|w| w == word)
}

/// Whether a name says that a value was measured on the motor's side.
pub(super) fn says_motor(name: &str) -> bool {
    has_word(&words(name), &["motor", "mot", "qm"])
}

/// The name without the words of signals: files of one recording have it in common.
pub(super) fn without_signal(name: &str) -> Vec<String> {
    let lists: [&[&str]; 7] = [&TIME, &POSITION, &VELOCITY, &TORQUE, &OTHER, &DESIRED_WORDS, &REFERENCE];
    let mut words = words(name);
    words.retain(|w| !lists.iter().any(|list| list.contains(&w.as_str())) && !FILLERS.contains(&w.as_str()));
    words
}

/// The last number in a name.
pub(super) fn number(name: &str) -> Option<usize> {
    number_in(&words(name))
}

fn number_in(words: &[String]) -> Option<usize> {
    words.iter().rev().find_map(|w| w.parse().ok())
}

fn has_word(words: &[String], list: &[&str]) -> bool {
    words.iter().any(|w| list.contains(&w.as_str()))
}

/// The words of a name, lower case: cut at everything but letters and digits, between letters and digits, and where a
/// small letter meets a capital one. A unit in brackets is no word.
pub(super) fn words(name: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    let mut before: Option<char> = None;
    for c in unit_words::without_brackets(name).chars() {
        let joins =
            before.is_some_and(|b| b.is_ascii_digit() == c.is_ascii_digit() && !(b.is_lowercase() && c.is_uppercase()));
        match (c.is_alphanumeric(), words.last_mut()) {
            (false, _) => {}
            (true, Some(word)) if joins => word.extend(c.to_lowercase()),
            (true, _) => words.push(c.to_lowercase().collect()),
        }
        before = c.is_alphanumeric().then_some(c);
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    fn signal(name: &str) -> Option<(Signal, Option<usize>)> {
        read(name).map(|r| (r.signal, r.number))
    }

    #[test]
    fn names_of_common_logs_are_understood() {
        for (name, expected) in [
            ("t", Some((Signal::Time, None))),
            ("timestamp_ns", Some((Signal::Time, None))),
            ("q1", Some((Signal::Position, Some(1)))),
            ("joint_2_position", Some((Signal::Position, Some(2)))),
            ("actual_q_0", Some((Signal::Position, Some(0)))),
            ("target_q_0", Some((Signal::Reference, Some(0)))),
            ("actual_qd_3", Some((Signal::Velocity, Some(3)))),
            ("actual_current_5", Some((Signal::Torque, Some(5)))),
            ("target_moment_5", None),
            ("MotorTorque3", Some((Signal::Torque, Some(3)))),
            ("elbow_joint.effort", Some((Signal::Torque, None))),
            ("qg", Some((Signal::Reference, None))),
            ("qref_3", Some((Signal::Reference, Some(3)))),
            ("pos_read_data", Some((Signal::Position, None))),
            ("curr_data", Some((Signal::Torque, None))),
            ("ddq1", None),
            ("positions", Some((Signal::Position, None))),
            ("accelerations", None),
            ("note", None),
            ("q_soll_2", Some((Signal::Reference, Some(2)))),
            ("Ist J1 [deg]", Some((Signal::Position, Some(1)))),
            ("IstMoment 1", Some((Signal::Torque, Some(1)))),
            ("Zeitstempel [ms]", Some((Signal::Time, None))),
            ("q_d", Some((Signal::Position, None))),
            ("speed_3 [1/min]", Some((Signal::Velocity, Some(3)))),
            ("q2 [A]", Some((Signal::Position, Some(2)))),
            ("action.elbow_joint.pos", Some((Signal::Reference, None))),
            ("observation.state", Some((Signal::Position, None))),
            ("observation.state.elbow_joint.effort", Some((Signal::Torque, None))),
            ("pos_sp_2", Some((Signal::Reference, Some(2)))),
            ("q.time", Some((Signal::Time, None))),
            ("tau.signals.values", Some((Signal::Torque, None))),
            ("qpos", Some((Signal::Position, None))),
            ("qvel", Some((Signal::Velocity, None))),
            ("qfrc_actuator", Some((Signal::Torque, None))),
            ("qacc", None),
        ] {
            assert_eq!(signal(name), expected, "{name}");
        }
    }

    #[test]
    fn files_of_one_recording_have_what_is_left_in_common() {
        assert_eq!(without_signal("pos_read_data"), without_signal("curr_data"));
        assert_eq!(without_signal("run2_q"), without_signal("tau_run2"));
        assert_ne!(without_signal("run1_q"), without_signal("run2_tau"));
        assert!(is_silent("Joint_1") && is_silent("7") && !is_silent("temperature_1") && !is_silent("target"));
    }

    #[test]
    fn a_d_is_the_desired_value_where_the_same_name_without_it_exists() {
        let among = |name, others: &[&str]| read_among(name, others.iter().copied()).map(|r| r.signal);
        assert_eq!(among("q_d_0", &["q_0", "q_1"]), Some(Signal::Reference));
        assert_eq!(among("tau_J_d_3", &["tau_J_3"]), None);
        assert_eq!(among("q_d", &["q_a", "q_b", "q_c"]), Some(Signal::Position));
        assert_eq!(among("d.position", &["position"]), Some(Signal::Position));
        assert_eq!(among("leader_q2", &["leader_q2", "follower_q2"]), Some(Signal::Reference));
        assert_eq!(among("leader_q2", &["leader_q1", "leader_q2"]), Some(Signal::Position));
        assert_eq!(among("J2 [deg]", &["J1 [deg]", "J2 [deg]", "tau1"]), Some(Signal::Position));
        assert_eq!(among("joint_2", &["joint_2", "q_2", "tau_2"]), None);
        assert_eq!(among("joint_2", &["joint_1", "joint_2"]), None);
    }

    #[test]
    fn commands_may_lack_the_name_of_a_signal() {
        assert!(says_only_desired("ctrl") && says_only_desired("action") && !says_only_desired("action.elbow.pos"));
    }

    #[test]
    fn names_of_files_say_what_their_columns_hold() {
        let wanted = ["left_command", "reference", "q_d", "positions_soll"].map(read_file_name);
        assert_eq!(wanted, [Some(Signal::Reference); 4]);
        assert_eq!(
            ["tau_J_d", "torque_command", "left", "messung_moment"].map(read_file_name),
            [None, None, None, Some(Signal::Torque)]
        );
    }
}
