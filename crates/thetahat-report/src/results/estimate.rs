//! The rule for the numbers that are used.

use std::{borrow::Cow, fmt};

use super::{
    content::{NOMINAL, Results},
    model::ModelResult,
    run::RunResult,
};
use thetahat_estimation::identification::Method;

/// What numbers come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EstimateSource {
    /// The model.
    Model,
    /// The run of a method.
    Run(Method),
}

impl EstimateSource {
    /// `model`, or the name of the method.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Model => "model",
            Self::Run(method) => method.name(),
        }
    }
}

impl fmt::Display for EstimateSource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

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
    /// The model, where a case and method ask for it: the nominal case, and no method by name.
    #[must_use]
    pub fn model_for(&self, case: &str, method: Option<Method>) -> Option<&ModelResult> {
        self.model.as_ref().filter(|_| method.is_none() && case == NOMINAL)
    }

    /// What [`Results::estimate`] gives, with its source.
    ///
    /// # Errors
    /// As [`Results::estimate`].
    pub fn estimate_and_source(
        &self,
        case: &str,
        method: Option<Method>,
    ) -> Result<(Cow<'_, RunResult>, EstimateSource), NoEstimate> {
        if let Some(model) = self.model_for(case, method) {
            return Ok((Cow::Owned(model.as_run(case)), EstimateSource::Model));
        }
        self.estimate(case, method).map(|run| (Cow::Borrowed(run), EstimateSource::Run(run.method)))
    }

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
