use thetahat::{
    Results,
    results::{NOMINAL, Verdict},
};

use super::trial::Trial;

/// Deviations by which the largest error of an honest estimate is off at most.
const OFF: f64 = 4.0;

/// What became of a trial.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// The numbers are good and can be used, or false and refused.
    Right,
    /// The numbers are false, and the verdict is care with the cause.
    Undecided,
    /// The numbers are good, and refused.
    Strict,
    /// The numbers are wrong, and the verdict does not warn.
    Misled,
}

impl Outcome {
    pub const ALL: [Self; 4] = [Self::Right, Self::Undecided, Self::Strict, Self::Misled];

    pub fn name(self) -> &'static str {
        match self {
            Self::Right => "right",
            Self::Undecided => "undecided",
            Self::Strict => "too strict",
            Self::Misled => "**misled**",
        }
    }

    pub fn of(trial: Trial, results: &Results) -> Self {
        let error = largest_error(results);
        let verdict = results.verdict.unwrap_or(Verdict::Good);
        let is_named = results.verdict_reasons.iter().any(|r| trial.is_cause(r));
        match (verdict, error <= OFF) {
            (Verdict::Good | Verdict::Care, true) | (Verdict::DoNotUse, false) => Self::Right,
            (Verdict::DoNotUse, true) => Self::Strict,
            (Verdict::Care, false) if is_named => Self::Undecided,
            (Verdict::Good | Verdict::Care, false) => Self::Misled,
        }
    }
}

/// The largest error of the method that is taken, or else of those that could be, in deviations with correlated errors;
/// infinite where there is no truth for the robot as described.
pub fn largest_error(results: &Results) -> f64 {
    let taken = results.advice.first().and_then(|a| a.recommended);
    let runs = results.runs.iter().filter(|r| r.case == NOMINAL && taken.is_none_or(|m| m == r.method));
    let errors = runs.flat_map(|r| &r.parameters).map(|p| {
        let error = p.true_value.zip(p.standard_deviation_robust).map(|(truth, sd)| (p.estimate - truth).abs() / sd);
        error.unwrap_or(f64::INFINITY)
    });
    errors.reduce(f64::max).unwrap_or(f64::INFINITY)
}
