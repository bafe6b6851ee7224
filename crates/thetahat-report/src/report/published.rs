//! Published figures to compare with ours.

use std::path::{Path, PathBuf};

use serde::{
    Deserialize,
    de::{IntoDeserializer, value::Error as ValueError},
};

use super::error::ReportError;
use crate::results::{Method, ParameterResult, RunResult};
use thetahat_ground::files;

const HEADER: [&str; 5] = ["case", "method", "parameter", "estimate", "relative_standard_deviation_percent"];

/// Deviation, in printed standard deviations, that still counts as agreement.
const DEVIATIONS: f64 = 3.0;

/// Figures of a publication, read from a CSV file in long form.
///
/// Its columns are `case,method,parameter,estimate,relative_standard_deviation_percent`; the last may be empty. Lines
/// that start with `#` hold the source. A row whose parameter is `relative_error_percent`,
/// `cross_validation_relative_error_percent` or `condition_number` holds that figure of the run.
#[derive(Debug, Clone, PartialEq)]
pub struct Published {
    /// The comment lines: where the figures come from.
    pub source: String,
    /// The figures, in the order of the file.
    pub values: Vec<PublishedValue>,
}

/// One published figure.
#[derive(Debug, Clone, PartialEq)]
pub struct PublishedValue {
    /// The case.
    pub case: String,
    /// The method.
    pub method: Method,
    /// The parameter, or the name of a figure of the run.
    pub parameter: String,
    /// The figure as printed: its digits define its precision.
    pub text: String,
    /// The figure.
    pub estimate: f64,
    /// Relative standard deviation in percent as printed; may be empty.
    pub deviation_text: String,
    /// Relative standard deviation, if printed.
    pub relative_standard_deviation_percent: Option<f64>,
}

/// How many of a run's estimates agree with the published ones.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Agreement {
    /// Estimates within three printed standard deviations, or one unit of the last printed digit if that is more.
    pub within: usize,
    /// Parameters with both figures.
    pub compared: usize,
}

impl Published {
    /// Reads the file.
    ///
    /// # Errors
    /// [`ReportError::PublishedUnreadable`], and [`ReportError::PublishedLine`] with the line for one that is not of the
    /// form above or repeats an earlier one.
    pub fn read(path: &Path) -> Result<Self, ReportError> {
        let text = files::read_to_string(path)
            .map_err(|source| ReportError::PublishedUnreadable { path: path.to_owned(), source })?;
        let comments = text.lines().filter_map(|line| line.strip_prefix('#')).map(str::trim);
        let source = comments.collect::<Vec<_>>().join(" ");
        let mut values: Vec<PublishedValue> = Vec::new();
        let mut lines = (1..).zip(text.lines()).filter(|(_, l)| !l.starts_with('#') && !l.trim().is_empty());
        Line::new(path, lines.next().unwrap_or((1, ""))).check_header()?;
        for line in lines {
            let line = Line::new(path, line);
            let value = line.value()?;
            if values.iter().any(|v| v.is_about(&value.case, value.method, &value.parameter)) {
                return Err(line.error("one line for each case, method and parameter", line.text));
            }
            values.push(value);
        }
        Ok(Self { source, values })
    }

    /// The figure for a case, method and parameter.
    #[must_use]
    pub fn value(&self, case: &str, method: Method, parameter: &str) -> Option<&PublishedValue> {
        self.values.iter().find(|v| v.is_about(case, method, parameter))
    }

    /// How many of a run's estimates agree with the published ones of its case and method.
    #[must_use]
    pub fn agreement(&self, run: &RunResult) -> Agreement {
        let both = |p: &ParameterResult| {
            self.value(&run.case, run.method, &p.name).map(|published| published.agrees_with(p.estimate))
        };
        let agreed: Vec<bool> = run.parameters.iter().filter_map(both).collect();
        Agreement { within: agreed.iter().filter(|a| **a).count(), compared: agreed.len() }
    }
}

impl PublishedValue {
    fn is_about(&self, case: &str, method: Method, parameter: &str) -> bool {
        self.case == case && self.method == method && self.parameter == parameter
    }

    /// The printed standard deviation.
    #[must_use]
    pub fn standard_deviation(&self) -> Option<f64> {
        self.relative_standard_deviation_percent.map(|percent| 0.01 * percent * self.estimate.abs())
    }

    /// Decimals of the printed text.
    #[must_use]
    pub fn decimals(&self) -> i32 {
        let (mantissa, exponent) = self.text.split_once(['e', 'E']).unwrap_or((&self.text, "0"));
        let printed = mantissa.split_once('.').map_or(0, |(_, digits)| digits.len());
        i32::try_from(printed).unwrap_or(i32::MAX) - exponent.parse::<i32>().unwrap_or(0)
    }

    /// Whether an estimate lies within three printed standard deviations, or within one unit of the last printed digit
    /// where that is more.
    #[must_use]
    pub fn agrees_with(&self, estimate: f64) -> bool {
        let tolerance = (DEVIATIONS * self.standard_deviation().unwrap_or(0.0)).max(10f64.powi(-self.decimals()));
        (estimate - self.estimate).abs() <= tolerance * (1.0 + 1e-9)
    }
}

/// A line of the file, cut at its commas.
struct Line<'a> {
    path: PathBuf,
    number: u64,
    text: &'a str,
    cells: Vec<&'a str>,
}

impl<'a> Line<'a> {
    fn new(path: &Path, (number, text): (u64, &'a str)) -> Self {
        Self { path: path.to_owned(), number, text, cells: text.split(',').map(str::trim).collect() }
    }

    fn error(&self, expected: &str, found: &str) -> ReportError {
        let (expected, found) = (expected.to_owned(), found.to_owned());
        ReportError::PublishedLine { path: self.path.clone(), line: self.number, expected, found }
    }

    fn check_header(&self) -> Result<(), ReportError> {
        if self.cells == HEADER { Ok(()) } else { Err(self.error(&HEADER.join(","), self.text)) }
    }

    fn value(&self) -> Result<PublishedValue, ReportError> {
        let &[case, method, parameter, text, deviation] = self.cells.as_slice() else {
            return Err(self.error("five cells", self.text));
        };
        let percent = (!deviation.is_empty()).then(|| self.figure(deviation)).transpose()?;
        Ok(PublishedValue {
            case: case.to_owned(),
            method: self.method(method)?,
            parameter: parameter.to_owned(),
            text: text.to_owned(),
            estimate: self.figure(text)?,
            deviation_text: deviation.to_owned(),
            relative_standard_deviation_percent: percent,
        })
    }

    fn method(&self, name: &str) -> Result<Method, ReportError> {
        let method: Result<_, ValueError> = Method::deserialize(name.into_deserializer());
        method.map_err(|_| self.error("a method, such as idim-ls, idim-iv or didim", name))
    }

    fn figure(&self, text: &str) -> Result<f64, ReportError> {
        let number = text.parse().ok().filter(|v: &f64| v.is_finite());
        number.ok_or_else(|| self.error("a number", text))
    }
}
