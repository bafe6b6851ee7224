use serde::{Deserialize, Serialize};

/// Comparison of laws of torque terms per joint, on the measured motion, by least squares weighted per joint; where no torques are
/// recorded by `cloe`, with each law added to all joints at once.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TermComparison {
    /// Effective number of independent samples in all joints' residuals, with the model as described.
    pub effective_samples: f64,
    /// The comparison, per joint.
    pub joints: Vec<JointTermComparison>,
}

/// The laws of one joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JointTermComparison {
    /// The joint.
    pub joint: String,
    /// Relative error of the joint's torque when it is predicted from other parts of the recording, percent, with the model as
    /// described; of the simulated positions of all joints where no torques are recorded; `null` if nothing can be left out.
    pub cross_validation_relative_error_percent: Option<f64>,
    /// The laws tried.
    pub laws: Vec<TermLaw>,
}

/// A law that was added to the model as described, or removed from it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TermLaw {
    /// Its name, as `kind` in files; `without KIND` if it was removed.
    pub law: String,
    /// Its parameters.
    pub parameters: Vec<String>,
    /// Their estimates; empty if it was removed.
    pub estimates: Vec<f64>,
    /// As [`JointTermComparison::cross_validation_relative_error_percent`].
    pub cross_validation_relative_error_percent: Option<f64>,
    /// Change of the Bayesian information criterion with the effective number of samples; below zero is better than the
    /// model as described.
    pub criterion_change: f64,
    /// Whether this law is recommended.
    pub recommended: bool,
    /// The text for the robot or experiment file to accept it; empty if it was removed.
    pub description: String,
}

/// Constants of a law that were found by a search, as its description says `profile = true`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ProfiledTerm {
    /// Index of the term, from zero.
    pub term: usize,
    /// The joint.
    pub joint: String,
    /// The velocity `vs`, rad/s or m/s.
    pub velocity: f64,
    /// The exponent `delta`.
    pub exponent: f64,
    /// Whether the velocity is at the end of the searched range: the recording does not determine it.
    pub at_limit: bool,
}
