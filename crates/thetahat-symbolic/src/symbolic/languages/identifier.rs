//! Identifiers that are valid in every language.

use super::super::error::SymbolicError;

/// Longest prefix: MATLAB allows 63 letters, and the longest model's name is appended.
const LONGEST: usize = 44;

/// The prefix of a robot's functions: the given name, or one derived from the robot's.
pub(super) fn prefix(robot: &str, given: Option<&str>) -> Result<String, SymbolicError> {
    match given {
        Some(name) if is_identifier(name) => Ok(name.to_owned()),
        Some(name) => Err(SymbolicError::NotAnIdentifier { name: name.to_owned(), longest: LONGEST }),
        None => made(robot).ok_or_else(|| SymbolicError::NoIdentifier { name: robot.to_owned() }),
    }
}

fn is_identifier(name: &str) -> bool {
    let rest = |c: char| c.is_ascii_alphanumeric() || c == '_';
    name.starts_with(|c: char| c.is_ascii_alphabetic()) && name.chars().all(rest) && name.len() <= LONGEST
}

/// Lower case, with `_` for all that is not a letter or a digit of ASCII.
fn made(robot: &str) -> Option<String> {
    let letter = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '_' };
    let text: String = robot.chars().map(letter).collect();
    let words: Vec<&str> = text.split('_').filter(|word| !word.is_empty()).collect();
    let joined = words.join("_");
    let name = if joined.starts_with(|c: char| c.is_ascii_digit()) { format!("robot_{joined}") } else { joined };
    let name: String = name.chars().take(LONGEST).collect();
    is_identifier(&name).then_some(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_made_valid_or_refused() {
        let of = |robot: &str| prefix(robot, None);
        assert_eq!(of("Staubli TX40").as_deref(), Ok("staubli_tx40"));
        assert_eq!(of("6-axis  arm!").as_deref(), Ok("robot_6_axis_arm"));
        assert!(matches!(of("ロボット"), Err(SymbolicError::NoIdentifier { .. })));
        assert!(matches!(of(""), Err(SymbolicError::NoIdentifier { .. })));
        assert_eq!(of(&"7".repeat(60)), Ok(format!("robot_{}", "7".repeat(LONGEST - 6))));
        assert_eq!(prefix("x", Some("arm_2")).as_deref(), Ok("arm_2"));
        let refused = prefix("x", Some(&"a".repeat(LONGEST + 1))).unwrap_err().to_string();
        assert!(refused.contains("44 at most"), "{refused}");
        // MATLAB's longest name.
        let longest = crate::symbolic::ModelKind::ALL.iter().map(|(_, model)| model.identifier().len()).max();
        assert_eq!(longest, Some(63 - LONGEST - 1));
        for name in ["2arm", "arm-2", "", "_arm", "arm;"] {
            assert!(matches!(prefix("x", Some(name)), Err(SymbolicError::NotAnIdentifier { .. })), "{name}");
        }
    }
}
