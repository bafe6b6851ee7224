use crate::experiment::column_names::words;

/// A name of columns: `actual_q_*`, `*.effort`, `motor_state_*_q`. It is compared by its words, so that `actual_q_0`, `actual_q[0]` and
/// `ActualQ0` are the same.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Pattern {
    before: Vec<String>,
    /// After the place of the joint; `None` if the name has no such place.
    after: Option<Vec<String>>,
}

impl Pattern {
    /// `None` if the name has no word or several places.
    pub(super) fn of(name: &str) -> Option<Self> {
        let mut parts = name.split('*').map(words);
        let (before, after, more) = (parts.next()?, parts.next(), parts.next());
        let has_words = !before.is_empty() || after.as_ref().is_some_and(|after| !after.is_empty());
        (has_words && more.is_none()).then_some(Self { before, after })
    }

    /// Whether a column has the name: with a number or the name of a joint in the place of `*`, or without any, as a matrix has it.
    /// Before the name of a joint's column its topic may stand: `/joint_states/elbow/position`.
    pub(super) fn matches(&self, column: &str, joints: &[Vec<String>]) -> bool {
        let of_joint =
            |(at, _): (usize, &str)| self.place(&words(&column[at + 1..])).is_some_and(|p| is_place(&p, joints));
        let whole = words(column);
        match self.place(&whole) {
            Some(place) if place.is_empty() || is_place(&place, joints) => true,
            Some(_) | None => self.after.is_some() && column.match_indices('/').any(of_joint),
        }
    }

    /// The words in the place of `*`; `None` if the others are not the name's.
    fn place(&self, words: &[String]) -> Option<Vec<String>> {
        let rest = words.strip_prefix(&self.before[..])?;
        match &self.after {
            Some(after) => rest.strip_suffix(&after[..]).map(<[String]>::to_vec),
            None => rest.is_empty().then(Vec::new),
        }
    }
}

/// Whether these words are a number or the name of a joint.
fn is_place(words: &[String], joints: &[Vec<String>]) -> bool {
    match words {
        [number] if number.parse::<u64>().is_ok() => true,
        name => joints.iter().any(|joint| joint == name),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_compared_by_their_words() {
        let joints = [words("wrist_1_joint")];
        for (pattern, column, expected) in [
            ("actual_q_*", "actual_q_0", true),
            ("actual_q_*", "actual_q[0]", true),
            ("actual_q_*", "ActualQ0", true),
            ("actual_q_*", "actual_q", true),
            ("actual_q_*", "actual_qd_0", false),
            ("q_*", "q_d_0", false),
            ("motor_state_*_q", "motor_state[3].q", true),
            ("motor_state_*_q", "motor_state[3].q_raw", false),
            ("motorState_*_tauEst", "motorState[3].tauEst", true),
            ("*.effort", "wrist_1_joint.effort", true),
            ("*.effort", "wheel.effort", false),
            ("*.effort", "/joint_states/wrist_1_joint/effort", true),
            ("*.effort", "/joint_states/effort", false),
            ("motor_state_*_q", "/lowstate/motor_state[3]/q", true),
            ("timestamp", "timestamp", true),
            ("timestamp", "/log/timestamp", false),
            ("timestamp", "timestamp_2", false),
        ] {
            let of = Pattern::of(pattern).unwrap();
            assert_eq!(of.matches(column, &joints), expected, "{pattern} {column}");
        }
        assert_eq!(["", "*", "a_*_*"].map(Pattern::of), [None, None, None]);
    }
}
