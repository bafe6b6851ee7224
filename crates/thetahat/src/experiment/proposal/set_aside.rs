//! Columns that look like a signal, and stand next to those of its measurement: they are set aside where the measured ones are there.

use super::{
    super::column_names::{self, Signal},
    source::Source,
};
use thetahat_data::recording::ColumnSummary;
use thetahat_model::robot::Robot;

/// A kind of columns that are set aside, and the words of their names. Where columns with one of the words are there alone, they stay.
struct Kind {
    why: &'static str,
    signals: &'static [Signal],
    words: &'static [&'static str],
}

const MEASURED: &[Signal] = &[Signal::Position, Signal::Velocity, Signal::Torque];

const KINDS: [Kind; 7] = [
    Kind {
        why: "errors, limits or deviations",
        signals: &[Signal::Position, Signal::Velocity, Signal::Torque, Signal::Reference],
        words: &[
            "error",
            "errors",
            "err",
            "deviation",
            "min",
            "max",
            "lower",
            "upper",
            "limit",
            "limits",
            "std",
            "stddev",
            "sigma",
            "var",
            "variance",
        ],
    },
    Kind { why: EXTERNAL, signals: &[Signal::Torque], words: &EXTERNAL_WORDS },
    Kind {
        why: "computed torques",
        signals: &[Signal::Torque],
        words: &[
            "model",
            "gravity",
            "grav",
            "coriolis",
            "friction",
            "inertia",
            "ff",
            "feedforward",
            "bias",
            "passive",
            "constraint",
            "applied",
            "inverse",
        ],
    },
    Kind { why: "positions before the gears", signals: &[Signal::Position], words: &["theta"] },
    Kind { why: "raw or filtered copies", signals: MEASURED, words: &["filtered", "filt", "smoothed", "raw"] },
    Kind { why: "positions of the tool", signals: &[Signal::Position], words: &["tcp", "cartesian", "cart", "x"] },
    Kind {
        why: "voltages and currents next to torques",
        signals: &[Signal::Torque],
        words: &["voltage", "current", "currents", "curr"],
    },
];

const EXTERNAL: &str = "external torques, without those of the robot's own dynamics";
const EXTERNAL_WORDS: [&str; 4] = ["ext", "external", "extern", "contact"];

/// Whether a name says that torques are external ones.
pub(super) fn says_external(name: &str) -> bool {
    EXTERNAL_WORDS.iter().any(|word| column_names::has(name, word))
}

/// Columns that are set aside, and why.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct SetAside {
    pub(super) why: &'static str,
    pub(super) columns: Vec<String>,
}

/// The columns of a signal without those that stand next to it, and these.
pub(super) fn parted<'a>(
    source: &Source<'a>,
    robot: &Robot,
    signal: Signal,
    mut columns: Vec<&'a ColumnSummary>,
) -> (Vec<&'a ColumnSummary>, Vec<SetAside>) {
    let mut set_aside: Vec<SetAside> = Vec::new();
    for kind in KINDS.iter().filter(|kind| kind.signals.contains(&signal)) {
        let words = kind.words.iter().filter(|word| !robot.coordinates().any(|j| column_names::has(&j.name, word)));
        for word in words {
            let has = |c: &&ColumnSummary| column_names::has(&c.name, word) && source.by_driver(&c.name).is_none();
            let (with, without): (Vec<_>, Vec<_>) = columns.iter().copied().partition(has);
            if are_as_many(&without, &with, robot.coordinate_count()) {
                columns = without;
                set_aside.push(SetAside { why: kind.why, columns: with.iter().map(|c| c.name.clone()).collect() });
            }
        }
    }
    (columns, set_aside)
}

/// Whether columns are a group of their own next to others: one joint whose name has the word is none.
fn are_as_many(without: &[&ColumnSummary], with: &[&ColumnSummary], joints: usize) -> bool {
    let [without, with] = [without, with].map(|columns| columns.iter().map(|c| c.channels).sum::<usize>());
    with >= joints.min(2) && without >= with
}
