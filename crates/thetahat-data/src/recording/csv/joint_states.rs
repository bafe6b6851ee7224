//! Joints of logged `sensor_msgs/JointState` messages, whose names are repeated in every row, as `rostopic echo -p` and
//! `ros2 topic echo --csv` write them.

use csv::ByteRecord;

use super::super::table::Flaw;
use super::sample::Sample;
use super::text::characters;

/// The signals of a message in its order.
const SIGNALS: [&str; 3] = ["position", "velocity", "effort"];
/// Cells before the names without a header: seconds, nanoseconds and frame.
const CELLS_BEFORE_NAMES: usize = 3;

/// Which columns belong to which joints.
#[derive(Default)]
pub(super) struct JointColumns {
    /// Columns with a name of a joint, and the name.
    joints: Vec<(usize, String)>,
    /// Columns of signals, and `JOINT.SIGNAL`.
    signals: Vec<(usize, String)>,
}

impl JointColumns {
    /// By the names of the columns, or by the arrangement of the cells without names.
    pub(super) fn of(sample: &Sample<'_>, names: Option<&[String]>) -> Self {
        let cells = sample.cells(sample.table.values);
        let is_text = |column: usize| sample.is_text(column);
        let found = match names {
            Some(names) => Self::by_names(names, &cells, is_text),
            None => Self::by_arrangement(&cells, is_text),
        };
        let are_joints = names.is_some() || found.are_in_all(sample);
        if !are_joints || found.has_equal_joints() { Self::default() } else { found }
    }

    /// `field.name0` with `field.position0`.
    fn by_names(names: &[String], cells: &[String], is_text: impl Fn(usize) -> bool) -> Self {
        let mut found = Self::default();
        for (column, (name, joint)) in names.iter().zip(cells).enumerate() {
            let Some(place) = name.rfind("name").filter(|_| is_text(column) && name.ends_with(is_index)) else {
                continue;
            };
            let signal = |signal: &str| {
                let other = format!("{}{signal}{}", &name[..place], &name[place + "name".len()..]);
                let column = names.iter().position(|name| *name == other).filter(|&column| !is_text(column))?;
                Some((column, format!("{joint}.{signal}")))
            };
            let signals: Vec<_> = SIGNALS.into_iter().filter_map(signal).collect();
            if !signals.is_empty() {
                found.joints.push((column, joint.clone()));
                found.signals.extend(signals);
            }
        }
        found
    }

    /// Seconds, nanoseconds, frame, names, then as many positions, velocities and efforts.
    fn by_arrangement(cells: &[String], is_text: impl Fn(usize) -> bool) -> Self {
        let rest = CELLS_BEFORE_NAMES..cells.len();
        let count = rest.clone().take_while(|&column| is_text(column)).count();
        let first_value = CELLS_BEFORE_NAMES + count;
        let are_values = [0, 1].into_iter().chain(first_value..cells.len()).all(|column| !is_text(column));
        let values = cells.len().saturating_sub(first_value);
        let is_stamp = matches!(cells, [seconds, nanoseconds, ..] if is_whole(seconds) && is_whole(nanoseconds));
        let signals = values.checked_div(count).filter(|signals| (1..=SIGNALS.len()).contains(signals));
        let Some(signals) = signals.filter(|signals| is_stamp && are_values && signals * count == values) else {
            return Self::default();
        };
        // Of two signals the second may be the velocity or the effort.
        let named = if signals == 2 { count } else { values };
        let joints: Vec<(usize, String)> = rest.take(count).map(|column| (column, cells[column].clone())).collect();
        let signal = |place: usize| format!("{}.{}", joints[place % count].1, SIGNALS[place / count]);
        let signals = (0..named).map(|place| (first_value + place, signal(place))).collect();
        Self { joints, signals }
    }

    /// Whether all rows have the same names, in any order.
    fn are_in_all(&self, sample: &Sample<'_>) -> bool {
        let names = |cells: &[String]| {
            let mut names: Vec<String> =
                self.joints.iter().filter_map(|(column, _)| cells.get(*column).cloned()).collect();
            names.sort();
            names
        };
        let mut rows = sample.rows_of_values().map(|cells| names(&cells));
        let first = rows.next();
        rows.all(|row| Some(row) == first)
    }

    fn has_equal_joints(&self) -> bool {
        let mut names: Vec<&String> = self.joints.iter().map(|(_, name)| name).collect();
        names.sort();
        names.windows(2).any(|pair| pair[0] == pair[1])
    }

    /// The signal in a column, `JOINT.SIGNAL`.
    pub(super) fn signal(&self, column: usize) -> Option<&String> {
        self.signals.iter().find(|(place, _)| *place == column).map(|(_, signal)| signal)
    }

    /// What is wrong with a row whose names are not those of the first.
    pub(super) fn other_order(&self, row: &ByteRecord, line: impl Fn() -> u64) -> Option<Flaw> {
        let differs = |(column, joint): &&(usize, String)| {
            row.get(*column)
                .is_none_or(|cell| cell.trim_ascii() != joint.as_bytes() && characters(cell).trim() != joint)
        };
        let (column, joint) = self.joints.iter().find(differs)?;
        let found = row.get(*column).map(characters).unwrap_or_default();
        Some(Flaw::JointOrder { line: line(), expected: joint.clone(), found })
    }
}

fn is_whole(cell: &str) -> bool {
    cell.parse::<u32>().is_ok()
}

/// Whether a character ends the index of an element.
fn is_index(c: char) -> bool {
    c.is_ascii_digit() || c == ']'
}
