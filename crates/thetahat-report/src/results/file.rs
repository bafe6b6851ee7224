//! Reading and writing `results.json`.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use serde::Deserialize;

use super::{
    content::{Results, SCHEMA},
    verdict::{ReasonCode, ReasonSubject, Verdict, VerdictReason},
};
use thetahat_ground::{digest::sha256, files};

/// Why a `results.json` cannot be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ResultsError {
    /// The file cannot be read.
    #[error("{}: cannot be read: {source}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The error of the operating system.
        source: std::io::Error,
    },
    /// The file is not JSON of the expected form.
    #[error(
        "{}: is not the results.json of an identification: {source}; give one that an identification wrote",
        path.display()
    )]
    Malformed {
        /// The file.
        path: PathBuf,
        /// The parser's message, with line and column.
        source: serde_json::Error,
    },
    /// A later version of this program wrote the file.
    #[error(
        "{}: has schema {found}, and this version of thetahat reads schemas up to {supported}; update thetahat, or \
         identify again with this version",
        path.display()
    )]
    NewerSchema {
        /// The file.
        path: PathBuf,
        /// The schema of the file.
        found: u64,
        /// The largest schema that can be read.
        supported: u32,
    },
    /// The results have no form in JSON.
    #[error("results.json: {source}")]
    Unwritable {
        /// Why.
        source: serde_json::Error,
    },
}

/// Keys that are read first. A file without a schema has schema 0; files from before the digest have none.
#[derive(Deserialize)]
struct SchemaKey {
    #[serde(default)]
    schema: u64,
    #[serde(default)]
    digest: Option<String>,
}

impl Results {
    /// The results in a `results.json`.
    ///
    /// # Errors
    /// [`ResultsError`] for a file that cannot be read, is not of the expected form or has a larger schema than [`SCHEMA`].
    pub fn read(path: &Path) -> Result<Self, ResultsError> {
        let text =
            files::read_to_string(path).map_err(|source| ResultsError::Unreadable { path: path.to_owned(), source })?;
        Self::from_json(path, &text)
    }

    /// The results in the text of a `results.json`; `path` names it in errors.
    ///
    /// # Errors
    /// [`ResultsError`] for a text that is not of the expected form or has a larger schema than [`SCHEMA`].
    pub fn from_json(path: &Path, text: &str) -> Result<Self, ResultsError> {
        let malformed = |source| ResultsError::Malformed { path: path.to_owned(), source };
        // The schema is read first: a later one may have another form.
        let SchemaKey { schema, digest } = serde_json::from_str(text).map_err(malformed)?;
        if schema > SCHEMA.into() {
            return Err(ResultsError::NewerSchema { path: path.to_owned(), found: schema, supported: SCHEMA });
        }
        let mut results: Self = serde_json::from_str(text).map_err(malformed)?;
        if digest.is_some_and(|stated| is_changed(text, &stated)) {
            results.distrust();
        }
        Ok(results)
    }

    /// Says that the file was changed: nobody computed its numbers.
    fn distrust(&mut self) {
        self.verdict = self.verdict.map(|verdict| verdict.max(Verdict::Care));
        let remedy = "identify again, or take the file that thetahat wrote".to_owned();
        self.verdict_reasons.push(VerdictReason {
            code: ReasonCode::ChangedFile,
            verdict: Verdict::Care,
            numbers: BTreeMap::new(),
            subject: ReasonSubject::default(),
            text: format!("the file of the results was changed after thetahat wrote it; {remedy}"),
            remedy,
            remedies: Vec::new(),
        });
    }

    /// The text of `results.json`.
    ///
    /// # Errors
    /// [`ResultsError::Unwritable`] where JSON has no form for a value.
    pub fn to_json(&self) -> Result<String, ResultsError> {
        let text = serde_json::to_string_pretty(self).map_err(|source| ResultsError::Unwritable { source })?;
        let content = text.strip_suffix(END).unwrap_or(&text);
        Ok(format!("{content}{DIGEST}{}\"{END}\n", digest(content)))
    }
}

/// The end of the text.
const END: &str = "\n}";
/// What precedes the digest, which is the last key.
const DIGEST: &str = ",\n  \"digest\": \"";

/// SHA-256 of the text without its lines `"seconds"`, which differ from run to run.
fn digest(content: &str) -> String {
    let kept = content.lines().filter(|line| !line.trim_start().starts_with("\"seconds\":"));
    sha256(kept.collect::<Vec<_>>().join("\n").as_bytes())
}

/// Whether a text has another digest than it states.
fn is_changed(text: &str, stated: &str) -> bool {
    text.rsplit_once(DIGEST).is_none_or(|(content, _)| stated != digest(content))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file of schema 1, with every key that schema 2 renamed.
    const SCHEMA_1: &str = r#"{
      "schema": 1, "thetahat": "0.1.0", "robot": "A", "title": "T", "samples_used": 100, "decimated_rows": 10,
      "recordings": [{
        "name": "1", "weight": 1.0, "samples_used": 100, "sample_rate_hz": 100.0, "window_s": [0.0, 1.0], "resampling": null,
        "torque_ends_hz": 20.5, "reference": null }],
      "validation_recordings": [], "seed": null, "elimination": null,
      "bandwidth": { "position_cutoff_hz": 50.0, "decimation_cutoff_hz": 20.0 },
      "with_rest": { "relative_error_percent": 6.5, "parameter": "fc1", "deviations": 2.5 },
      "experiment_description": "", "robot_description": "",
      "advice": [{ "case": "nominal", "take": "idim-ls", "distrust": [], "text": "" }],
      "runs": [{
        "case": "nominal", "method": "idim-ls", "status": "converged", "iterations": 0, "simulations": 0,
        "joint_relative_error_percent": [5.5], "seconds": 0.1, "convergence": [], "parameters": [],
        "residual": { "homoscedasticity": null, "joints": [{
          "joint": 1, "rms": 0.5, "autocorrelation": 0.1, "whiteness": null, "normality": null, "explained": {
            "statistic": 1.5, "numerator_freedom": 1, "denominator_freedom": 9, "p_value": 0.25, "stands_out": 3.5 } }] },
        "physical": {
          "consistent": false, "outside": ["ia1"], "lacking": [0.125], "smallest_eigenvalue": -1.0, "estimate": {
            "parameters": [{ "name": "ia1", "unit": "", "estimate": 0.0, "beside": -0.125, "interval_95": null }],
            "standard": [], "known": [], "prior": "log-det", "prior_weight": 0.1, "smallest_eigenvalue": 0.1,
            "at_boundary": [], "squared_residual_free": 1.0, "squared_residual": 1.5, "relative_error_percent": 5.5,
            "test": null, "converged": true, "iterations": 7, "seconds": 0.1 } }
      }]
    }"#;

    #[test]
    fn keys_of_schema_1_are_read() {
        let results = Results::from_json(Path::new("old.json"), SCHEMA_1).unwrap();
        assert_eq!(results.schema, 1);
        assert_eq!(results.recordings[0].torque_bandwidth_hz, Some(20.5));
        assert_eq!(results.unmasked_comparison.as_ref().map(|c| c.deviations), Some(2.5));
        assert_eq!(results.advice[0].recommended.map(|m| m.to_string()).as_deref(), Some("idim-ls"));
        let run = &results.runs[0];
        let explained = run.residual.as_ref().and_then(|r| r.joints[0].explained).unwrap();
        assert_eq!((explained.test.p_value, explained.deviations_above_shifted), (0.25, Some(3.5)));
        let physical = run.physical.as_ref().unwrap();
        assert_eq!(
            (physical.inconsistent.as_slice(), physical.violations.as_slice()),
            (&["ia1".to_owned()][..], &[0.125][..])
        );
        assert_eq!(physical.estimate.as_ref().unwrap().parameters[0].reference_value, Some(-0.125));
    }

    /// A number that was changed is said; times, which differ from run to run, are not.
    #[test]
    fn a_changed_file_is_read_and_not_trusted() {
        let results = Results::from_json(Path::new("old.json"), SCHEMA_1).unwrap();
        let text = Results { schema: SCHEMA, verdict: Some(Verdict::Good), ..results }.to_json().unwrap();
        let read = |text: &str| Results::from_json(Path::new("new.json"), text).unwrap();
        let verdict = |results: Results| (results.verdict, results.verdict_reasons.len());
        assert_eq!(verdict(read(&text)), (Some(Verdict::Good), 0));
        assert_eq!(verdict(read(&text.replace("\"seconds\": 0.1", "\"seconds\": 0.2"))), (Some(Verdict::Good), 0));
        let changed = read(&text.replace("\"relative_error_percent\": 6.5", "\"relative_error_percent\": 0.5"));
        assert_eq!(changed.verdict_reasons[0].code, ReasonCode::ChangedFile);
        assert_eq!(verdict(changed), (Some(Verdict::Care), 1));
    }

    #[test]
    fn files_are_written_with_the_new_keys() {
        let results = Results::from_json(Path::new("old.json"), SCHEMA_1).unwrap();
        let text = Results { schema: SCHEMA, ..results }.to_json().unwrap();
        for old in ["torque_ends_hz", "with_rest", "take", "stands_out", "outside", "lacking", "beside"] {
            assert!(!text.contains(&format!("\"{old}\":")), "{old}");
        }
        let again = Results::from_json(Path::new("new.json"), &text).unwrap();
        assert_eq!((again.schema, again.to_json().unwrap()), (SCHEMA, text));
    }
}
