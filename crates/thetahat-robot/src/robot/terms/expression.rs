//! A user-defined column: arithmetic on the state and on recorded channels, no code.

use exmex::{Express, FlatEx};

/// Longest expression, bytes.
const LONGEST: usize = 500;

/// A torque per unit of its parameter, as arithmetic on the state of the joints and on recorded channels.
#[derive(Debug, Clone)]
pub struct Expression {
    text: String,
    variables: Vec<Variable>,
    compiled: FlatEx<f64>,
}

/// The meaning of a variable of an expression; joints by their index.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Variable {
    /// Position of a joint, rad or m.
    Position(usize),
    /// Its velocity.
    Velocity(usize),
    /// Its acceleration.
    Acceleration(usize),
    /// The sign of its velocity, smooth in simulations.
    Sign(usize),
    /// A recorded channel.
    Channel(String),
}

impl PartialEq for Expression {
    fn eq(&self, other: &Self) -> bool {
        self.text == other.text && self.variables == other.variables
    }
}

impl Expression {
    /// Parses an expression for joint `own` of a robot with `joints` joints.
    ///
    /// # Errors
    /// What is wrong with it, in words.
    pub fn parse(text: &str, own: usize, joints: usize) -> Result<Self, String> {
        if text.len() > LONGEST {
            return Err(format!("it has {} characters, at most {LONGEST} are read", text.len()));
        }
        let compiled = FlatEx::<f64>::parse(text).map_err(|e| e.to_string())?;
        if let Some(jump) = compiled.operator_reprs().iter().find(|r| *r == "signum") {
            return Err(format!("{jump} jumps; write s, the sign of dq, or s2 of joint 2: simulations make it smooth"));
        }
        let variables =
            compiled.var_names().iter().map(|name| variable(name, own, joints)).collect::<Result<_, _>>()?;
        Ok(Self { text: text.to_owned(), variables, compiled })
    }

    /// Its text.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Its variables, in the order of the values of [`Expression::value`].
    #[must_use]
    pub fn variables(&self) -> &[Variable] {
        &self.variables
    }

    /// Its value; NaN where it is undefined.
    #[must_use]
    pub fn value(&self, variables: &[f64]) -> f64 {
        self.compiled.eval(variables).unwrap_or(f64::NAN)
    }

    /// Whether it depends on accelerations.
    #[must_use]
    pub fn needs_acceleration(&self) -> bool {
        self.variables.iter().any(|v| matches!(v, Variable::Acceleration(_)))
    }
}

/// `q`, `dq`, `ddq` and `s` of the own joint, or of another joint if followed by its number; any other name is a channel.
fn variable(name: &str, own: usize, joints: usize) -> Result<Variable, String> {
    let letters = name.trim_end_matches(|c: char| c.is_ascii_digit());
    let of_joint = match letters {
        "q" => Variable::Position,
        "dq" => Variable::Velocity,
        "ddq" => Variable::Acceleration,
        "s" => Variable::Sign,
        _ => return Ok(Variable::Channel(name.to_owned())),
    };
    let digits = &name[letters.len()..];
    if digits.is_empty() {
        return Ok(of_joint(own));
    }
    match digits.parse::<usize>() {
        Ok(number) if (1..=joints).contains(&number) => Ok(of_joint(number - 1)),
        _ => Err(format!("{name}: the robot has the joints 1 to {joints}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn variables_are_of_joints_or_channels() {
        let e = Expression::parse("ddq2 * sin(3*q) + s * temperature", 0, 2).unwrap();
        let expected = [
            Variable::Acceleration(1),
            Variable::Position(0),
            Variable::Sign(0),
            Variable::Channel("temperature".to_owned()),
        ];
        assert_eq!(e.variables(), expected);
        assert!(e.needs_acceleration());
        assert!((e.value(&[2.0, 0.5, -1.0, 7.0]) - (2.0 * 1.5f64.sin() - 7.0)).abs() < 1e-15);
    }

    #[test]
    fn what_cannot_be_read_is_refused() {
        let message = |text: &str| Expression::parse(text, 0, 2).unwrap_err();
        assert_eq!(message("q3"), "q3: the robot has the joints 1 to 2");
        assert_eq!(
            message("signum(dq)"),
            "signum jumps; write s, the sign of dq, or s2 of joint 2: simulations make it smooth"
        );
        assert!(message("q +* dq (").len() > 5);
        assert!(message(&"q+".repeat(300)).contains("at most 500"));
    }
}
