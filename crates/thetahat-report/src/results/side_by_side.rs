//! Comparison of several results: differences of settings and of estimates.

use std::{
    collections::BTreeMap,
    hash::{DefaultHasher, Hash, Hasher},
    path::{Path, PathBuf},
};

use super::{
    card::Unseen,
    content::Results,
    estimate::{EstimateSource, NoEstimate},
    parameters::ParameterResult,
    run::RunResult,
    verdict::Verdict,
};
use thetahat_estimation::identification::Method;

/// Several results, compared with the first.
#[derive(Debug, Clone)]
pub struct SideBySide {
    /// The results, in the order given.
    pub sides: Vec<Side>,
    /// Settings that differ, by name.
    pub settings: Vec<SettingDifference>,
    /// Every parameter in any of the results.
    pub parameters: Vec<ComparedParameter>,
}

/// One of the results.
#[derive(Debug, Clone)]
pub struct Side {
    /// Its file.
    pub file: PathBuf,
    /// Its title.
    pub title: String,
    /// What the compared estimates come from.
    pub source: EstimateSource,
    /// The verdict on its results.
    pub verdict: Option<Verdict>,
    /// Relative error of that method's run, percent.
    pub relative_error_percent: Option<f64>,
    /// The same on data not used.
    pub unseen: Option<Unseen>,
}

/// A setting that differs between results.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SettingDifference {
    /// Its key, such as `signal.cutoff_hz`.
    pub key: String,
    /// Its value in each; none if it is not set.
    pub values: Vec<Option<String>>,
}

/// A parameter in all results.
#[derive(Debug, Clone)]
pub struct ComparedParameter {
    /// Its name.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// Its estimate in each; none without an estimate.
    pub estimates: Vec<Option<ParameterResult>>,
    /// Difference of each estimate from the first, in deviations of the difference; zero for the first itself, none if
    /// one of them has no deviation or another unit.
    pub deviations: Vec<Option<f64>>,
}

/// Why results cannot be compared.
#[derive(Debug, thiserror::Error)]
#[error("{}: {source}", file.display())]
pub struct SideBySideError {
    /// The file without the estimate.
    pub file: PathBuf,
    /// Why it has none.
    pub source: NoEstimate,
}

impl SideBySide {
    /// Compares the results of files: in each the requested method, or otherwise the model; where one of them has none, the
    /// methods that are recommended.
    ///
    /// # Errors
    /// [`SideBySideError`] where one of them has no such estimate.
    pub fn new(results: &[(PathBuf, Results)], case: &str, method: Option<Method>) -> Result<Self, SideBySideError> {
        let have_models = results.iter().all(|(_, results)| results.model_for(case, method).is_some());
        let of = |(file, results): &'_ (PathBuf, Results)| {
            let found = if have_models {
                results.estimate_and_source(case, method).map(|(run, source)| (run.into_owned(), source))
            } else {
                results.estimate(case, method).map(|run| (run.clone(), EstimateSource::Run(run.method)))
            };
            found.map_err(|source| SideBySideError { file: file.to_owned(), source })
        };
        let estimates = results.iter().map(of).collect::<Result<Vec<_>, _>>()?;
        let sides = results.iter().zip(&estimates).map(|((file, results), found)| side(file, results, found)).collect();
        let runs: Vec<&RunResult> = estimates.iter().map(|(run, _)| run).collect();
        Ok(Self { sides, settings: settings(results), parameters: parameters(&runs) })
    }
}

fn side(file: &Path, results: &Results, (run, source): &(RunResult, EstimateSource)) -> Side {
    Side {
        file: file.to_owned(),
        title: results.title.clone(),
        source: *source,
        verdict: results.verdict,
        relative_error_percent: run.relative_error_percent,
        unseen: results.unseen(run),
    }
}

fn parameters(runs: &[&RunResult]) -> Vec<ComparedParameter> {
    let mut all: Vec<&ParameterResult> = Vec::new();
    for parameter in runs.iter().flat_map(|r| &r.parameters) {
        if all.iter().all(|p| p.name != parameter.name) {
            all.push(parameter);
        }
    }
    let compared = |p: &ParameterResult| {
        let estimates: Vec<Option<ParameterResult>> = runs.iter().map(|r| r.parameter(&p.name).cloned()).collect();
        let first = estimates.first().and_then(Option::as_ref);
        let deviations = estimates.iter().map(|e| deviations_above(first?, e.as_ref()?)).collect();
        ComparedParameter { name: p.name.clone(), unit: p.unit.clone(), estimates, deviations }
    };
    all.into_iter().map(compared).collect()
}

/// Difference over its deviation for independent estimates; zero for equal estimates, none for different units.
fn deviations_above(first: &ParameterResult, other: &ParameterResult) -> Option<f64> {
    if first.unit != other.unit {
        return None;
    }
    let (difference, of_difference) = (other.estimate - first.estimate, first.deviation()?.hypot(other.deviation()?));
    match (difference == 0.0, of_difference > 0.0) {
        (true, _) => Some(0.0),
        (false, true) => Some(difference / of_difference),
        (false, false) => None,
    }
}

/// The settings that differ: keys of the experiment and of a robot in TOML, and figures of the recording.
fn settings(results: &[(PathBuf, Results)]) -> Vec<SettingDifference> {
    let all: Vec<BTreeMap<String, String>> = results.iter().map(|(_, results)| settings_of(results)).collect();
    let keys: std::collections::BTreeSet<&String> = all.iter().flat_map(BTreeMap::keys).collect();
    let difference = |key: &String| {
        let values: Vec<Option<String>> = all.iter().map(|of| of.get(key).cloned()).collect();
        let differs = values.iter().any(|value| *value != values[0]);
        differs.then(|| SettingDifference { key: key.clone(), values })
    };
    keys.into_iter().filter_map(difference).collect()
}

fn settings_of(results: &Results) -> BTreeMap<String, String> {
    let mut settings = BTreeMap::from([
        ("thetahat".to_owned(), results.thetahat.clone()),
        ("samples used".to_owned(), results.samples_used.to_string()),
        ("rows after decimation".to_owned(), results.decimated_rows.to_string()),
    ]);
    settings.extend(flattened("", &results.experiment_description));
    settings.extend(flattened("robot.", &results.robot_description));
    settings
}

/// The keys of a TOML text with their values; for other texts, such as a URDF, their length and a checksum.
fn flattened(prefix: &str, text: &str) -> BTreeMap<String, String> {
    let mut all = BTreeMap::new();
    match text.parse::<toml::Table>() {
        Ok(table) => table.iter().for_each(|(key, value)| flatten(format!("{prefix}{key}"), value, &mut all)),
        Err(_) => {
            let mut sum = DefaultHasher::new();
            text.hash(&mut sum);
            let summary = format!("checksum {:016x}, {} characters", sum.finish(), text.chars().count());
            all.insert(format!("{prefix}description"), summary);
        }
    }
    all
}

fn flatten(key: String, value: &toml::Value, all: &mut BTreeMap<String, String>) {
    match value {
        toml::Value::Table(table) => table.iter().for_each(|(k, v)| flatten(format!("{key}.{k}"), v, all)),
        toml::Value::Array(items) if items.iter().any(toml::Value::is_table) => {
            items.iter().enumerate().for_each(|(i, v)| flatten(format!("{key}[{}]", i + 1), v, all));
        }
        toml::Value::Array(_)
        | toml::Value::String(_)
        | toml::Value::Integer(_)
        | toml::Value::Float(_)
        | toml::Value::Boolean(_)
        | toml::Value::Datetime(_) => {
            all.insert(key, value.to_string());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn results(recommended: &str, estimate: f64, cutoff_hz: f64) -> (PathBuf, Results) {
        let text = format!(
            r#"{{
            "schema": 2, "thetahat": "0.1.0", "robot": "A", "title": "T", "samples_used": 100, "decimated_rows": 10,
            "recordings": [], "validation_recordings": [], "seed": null, "elimination": null,
            "bandwidth": {{ "position_cutoff_hz": 50.0, "decimation_cutoff_hz": 20.0 }},
            "experiment_description": "[signal]\ncutoff_hz = {cutoff_hz}\ndecimation = 7\n", "robot_description": "",
            "advice": [{{ "case": "nominal", "recommended": {recommended}, "distrust": [], "text": "Use it." }}],
            "runs": [{{
              "case": "nominal", "method": "idim-ls", "status": "converged", "iterations": 0, "simulations": 0,
              "joint_relative_error_percent": [], "seconds": 0.1, "convergence": [],
              "parameters": [
                {{ "name": "a", "estimate": {estimate}, "standard_deviation": 9.0, "standard_deviation_robust": 0.3,
                   "unit": "kg", "expression": "a", "shown": true }}]
            }}] }}"#
        );
        (PathBuf::from("a.json"), Results::from_json(Path::new("a.json"), &text).unwrap())
    }

    const LS: &str = "\"idim-ls\"";

    #[test]
    fn differences_are_in_deviations_of_the_difference_and_equal_settings_are_not_named() {
        let compared = SideBySide::new(&[results(LS, 1.0, 10.5), results(LS, 2.2, 20.5)], "nominal", None).unwrap();
        let difference = compared.parameters[0].deviations[1].unwrap();
        assert!((difference - 1.2 / (0.3 * 2.0_f64.sqrt())).abs() < 1e-12, "{difference}");
        let [only] = compared.settings.as_slice() else { panic!("{:?}", compared.settings) };
        let values = vec![Some("10.5".to_owned()), Some("20.5".to_owned())];
        assert_eq!((only.key.as_str(), &only.values), ("signal.cutoff_hz", &values));
    }

    /// As `solve` writes them.
    #[test]
    fn results_without_advice_are_compared_too() {
        let mut two = [results(LS, 1.0, 1.5), results(LS, 2.0, 1.5)];
        two.iter_mut().for_each(|(_, results)| results.advice.clear());
        let compared = SideBySide::new(&two, "nominal", None).unwrap();
        assert!(
            compared.sides.iter().all(|side| side.source == EstimateSource::Run(Method::IDIM_LS)),
            "{:?}",
            compared.sides
        );
    }

    #[test]
    fn a_file_without_the_estimate_is_an_error_that_names_the_estimates() {
        let none = SideBySide::new(&[results(LS, 1.0, 1.5), results("null", 1.0, 1.5)], "nominal", None).unwrap_err();
        assert!(matches!(&none.source, NoEstimate::NotAdvised { methods, .. } if methods == &["idim-ls"]), "{none}");
        let two = [results(LS, 1.0, 1.5), results(LS, 1.0, 1.5)];
        let absent = SideBySide::new(&two, "nominal", Some(Method::DIDIM)).unwrap_err();
        assert!(matches!(&absent.source, NoEstimate::Absent { runs, .. } if runs == &["nominal idim-ls"]), "{absent}");
    }
}
