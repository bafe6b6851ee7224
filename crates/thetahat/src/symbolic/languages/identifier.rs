//! Names that every language can have.

use super::super::error::SymbolicError;

/// Longest name that is used.
const LONGEST: usize = 48;

/// What the names of a robot's functions begin with: the name given, or what can be made of the robot's.
pub(super) fn prefix(robot: &str, given: Option<&str>) -> Result<String, SymbolicError> {
    match given {
        Some(name) if is_identifier(name) => Ok(name.to_owned()),
        Some(name) => Err(SymbolicError::NotAnIdentifier { name: name.to_owned() }),
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
    let joined: String = words.join("_").chars().take(LONGEST).collect();
    let name = if joined.starts_with(|c: char| c.is_ascii_digit()) { format!("robot_{joined}") } else { joined };
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
        assert_eq!(prefix("x", Some("arm_2")).as_deref(), Ok("arm_2"));
        for name in ["2arm", "arm-2", "", "_arm", "arm;"] {
            assert!(matches!(prefix("x", Some(name)), Err(SymbolicError::NotAnIdentifier { .. })), "{name}");
        }
    }
}
