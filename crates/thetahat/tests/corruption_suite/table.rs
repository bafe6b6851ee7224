//! The suite's table.

use thetahat::checks::{Finding, Severity};

use super::{
    corruptions::{Corruption, all, of_controllers},
    record::Record,
};

/// What became of a corruption.
pub struct Outcome {
    pub name: &'static str,
    pub expected: String,
    /// The evidence of the expected finding in each record; none where it was not raised, or was raised on the clean one.
    pub evidence: Vec<Option<String>>,
    /// Other findings of the corrupted records, warnings and problems.
    pub others: Vec<Vec<String>>,
}

/// Whether the expected finding is among those that matter.
pub fn expected<'f>(findings: &'f [Finding], corruption: &Corruption) -> Option<&'f Finding> {
    findings.iter().find(|f| {
        let joint = corruption.joint.is_none() || f.joint == corruption.joint;
        f.code == corruption.code && f.severity <= Severity::Warning && joint
    })
}

/// Clean and corrupted findings of a record.
pub fn findings(record: &Record, corruption: &Corruption) -> (Vec<Finding>, Vec<Finding>) {
    let mut record = record.clone();
    (corruption.prepare)(&mut record);
    let clean = record.findings();
    (corruption.apply)(&mut record);
    (clean, record.findings())
}
