//! The rule for the run whose numbers are used.

use super::{content::Results, run::RunResult};
use thetahat_estimation::identification::Method;

/// Why results give no estimate of a case.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NoEstimate {
    /// No method was asked for, and the advice takes none.
    #[error("the advice takes no method in case {case}; ask for one of {}", methods.join(", "))]
    NotAdvised {
        /// The case.
        case: String,
        /// The methods with estimates of this case.
        methods: Vec<String>,
    },
    /// The case has no estimate by any method.
    #[error("there is no estimate of case {case}; there {}", listed(runs))]
    NoCase {
        /// The case.
        case: String,
        /// The runs with estimates, as `case method`.
        runs: Vec<String>,
    },
    /// There is no such run, or it has no estimate.
    #[error("{method} has no estimate in case {case}; there {}", listed(runs))]
    Absent {
        /// The case.
        case: String,
        /// The method.
        method: Method,
        /// The runs with estimates, as `case method`.
        runs: Vec<String>,
    },
}

impl Results {
    /// The estimate of a case by a method, or by the recommended one ([`Results::recommended_run_in`]). If the advice recommends none,
    /// the caller must name the method.
    ///
    /// # Errors
    /// [`NoEstimate`], with the existing estimates.
    pub fn estimate(&self, case: &str, method: Option<Method>) -> Result<&RunResult, NoEstimate> {
        let case_name = || case.to_owned();
        let estimated = || self.runs.iter().filter(|run| !run.parameters.is_empty());
        let runs = || estimated().map(|run| format!("{} {}", run.case, run.method)).collect();
        if let Some(method) = method.or_else(|| Some(self.recommended_run_in(case)?.method)) {
            let found = estimated().find(|run| run.case == case && run.method == method);
            return found.ok_or_else(|| NoEstimate::Absent { case: case_name(), method, runs: runs() });
        }
        let methods: Vec<String> = estimated().filter(|r| r.case == case).map(|r| r.method.to_string()).collect();
        Err(match methods.is_empty() {
            true => NoEstimate::NoCase { case: case_name(), runs: runs() },
            false => NoEstimate::NotAdvised { case: case_name(), methods },
        })
    }
}

fn listed(runs: &[String]) -> String {
    if runs.is_empty() { "is none".to_owned() } else { format!("are {}", runs.join(", ")) }
}
