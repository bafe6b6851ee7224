use serde::{Deserialize, Serialize};

/// Laws of torque terms compared joint by joint on the measured motion, by least squares weighted per joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TermComparison {
    /// Independent samples that all joints' residuals are worth, of the model as described.
    pub effective_samples: f64,
    /// What was compared, joint by joint.
    pub joints: Vec<JointTermComparison>,
}

/// The laws of one joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JointTermComparison {
    /// The joint.
    pub joint: String,
    /// Relative error of the joint's torque where it is predicted from other parts of the record, percent, of the model as
    /// described; none where nothing can be left out.
    pub cross_validation_relative_error_percent: Option<f64>,
    /// The laws tried.
    pub laws: Vec<TermLaw>,
}

/// A law that was added to the model as described, or taken out of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TermLaw {
    /// Its name, as `kind` in files; `without KIND` where it was taken out.
    pub law: String,
    /// Its parameters.
    pub parameters: Vec<String>,
    /// Their estimates; empty where it was taken out.
    pub estimates: Vec<f64>,
    /// As [`JointTermComparison::cross_validation_relative_error_percent`].
    pub cross_validation_relative_error_percent: Option<f64>,
    /// Change of the Bayesian information criterion with the effective number of samples; below zero it is better than the
    /// model as described.
    pub criterion_change: f64,
    /// Whether it is the one to accept.
    pub recommended: bool,
    /// What to write into the robot or experiment file to accept it; empty where it was taken out.
    pub description: String,
}

/// Constants of a law that were searched for, because its description says `profile = true`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ProfiledTerm {
    /// Which term, from zero.
    pub term: usize,
    /// The joint.
    pub joint: String,
    /// The velocity `vs`, rad/s or m/s.
    pub velocity: f64,
    /// The exponent `delta`.
    pub exponent: f64,
    /// Whether it is at the end of what was searched, so that the record does not say it.
    pub at_limit: bool,
}
