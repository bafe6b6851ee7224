//! Which column is of which joint, by the joints' names in the columns' names.

use super::super::column_names;
use thetahat_data::recording::ColumnSummary;

/// The column of each joint, of one channel: the shortest one that contains the joint's name, be it in other cases of letters where no
/// column has the names as they are. `None` if no column has the name, or several equally short ones do.
pub(super) fn columns_of<'c>(joints: &[&str], columns: &[&'c ColumnSummary]) -> Vec<Option<&'c ColumnSummary>> {
    let as_written = columns_by(joints, columns, &|name| name.to_owned());
    if as_written.iter().any(Option::is_some) {
        return as_written;
    }
    columns_by(joints, columns, &|name| name.to_lowercase())
}

fn columns_by<'c>(
    joints: &[&str],
    columns: &[&'c ColumnSummary],
    written: &dyn Fn(&str) -> String,
) -> Vec<Option<&'c ColumnSummary>> {
    let joints: Vec<String> = joints.iter().map(|joint| written(joint)).collect();
    let owner = |column: &str| {
        let column = written(column);
        let near = (0..joints.len()).filter_map(|j| Some((nearness(&column, &joints[j])?, j)));
        near.max().map(|(_, j)| j)
    };
    let owners: Vec<Option<usize>> =
        columns.iter().map(|c| if c.channels == 1 { owner(&c.name) } else { None }).collect();
    let of_joint = |joint: usize| {
        let own = || columns.iter().zip(&owners).filter(move |(_, owner)| **owner == Some(joint)).map(|(c, _)| *c);
        let shortest = own().map(|c| c.name.len()).min()?;
        let mut nearest = own().filter(|c| c.name.len() == shortest);
        nearest.next().filter(|_| nearest.next().is_none())
    };
    (0..joints.len()).map(of_joint).collect()
}

/// Letters of a joint's name that a column's name contains as separate words; `None` if it does not. The whole name has priority over
/// the name without its word `joint`; with that, only words of signals may remain.
fn nearness(column: &str, joint: &str) -> Option<(bool, usize)> {
    if contains_name(column, joint) {
        return Some((true, joint.len()));
    }
    let bare: Vec<&str> = joint.split('_').filter(|word| *word != "joint").collect();
    let bare = bare.join("_");
    let says_more = bare.chars().filter(|c| c.is_alphabetic()).count() > 1;
    if !says_more || bare.len() == joint.len() || !contains_name(column, &bare) {
        return None;
    }
    column_names::has_only_words_of_signals(&column.replacen(&bare, "_", 1)).then_some((false, bare.len()))
}

/// Whether a column's name holds a joint's name as a word of its own.
fn contains_name(column: &str, joint: &str) -> bool {
    let boundary = |c: Option<char>| c.is_none_or(|c| !c.is_alphanumeric());
    column.match_indices(joint).any(|(start, found)| {
        boundary(column[..start].chars().next_back()) && boundary(column[start + found.len()..].chars().next())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_words_and_may_lack_the_word_joint() {
        for (column, joint, expected) in [
            ("arm_1_joint.position", "arm_1_joint", Some((true, 11))),
            ("/joint_states/arm_1_joint/position", "arm_1_joint", Some((true, 11))),
            ("arm_1_joint.position", "arm_1", Some((true, 5))),
            ("arm_10_joint.position", "arm_1", None),
            ("shoulder_pan_pos", "shoulder_pan_joint", Some((false, 12))),
            ("left_wheel.position", "left_joint", None),
            ("q_1", "joint_1", None),
        ] {
            assert_eq!(nearness(column, joint), expected, "{column} {joint}");
        }
    }
}
