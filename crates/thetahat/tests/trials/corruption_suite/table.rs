//! The suite's outcomes and their table in `docs/evidence/checks.md`.

use thetahat::checks::{Code, Finding, Severity};

use super::{
    corruptions::{Beside, Corruption},
    record::Record,
};

/// A clean record with its findings, by what is recorded beside it.
pub struct Clean {
    record: Record,
    findings: Vec<(Beside, Vec<Finding>)>,
}

impl Clean {
    pub fn new(record: Record) -> Self {
        let all = [Beside::Nothing, Beside::Velocities, Beside::TimeStamps, Beside::Reference];
        let findings = all.into_iter().map(|b| (b, serious(record.with(b).findings()))).collect();
        Self { record, findings }
    }

    /// The warnings and problems of the record as it is.
    pub fn findings(&self, beside: Beside) -> &[Finding] {
        self.findings.iter().find(|f| f.0 == beside).map_or(&[], |f| &f.1)
    }

    /// The warnings and problems of the corrupted record.
    pub fn corrupted(&self, corruption: &Corruption) -> Vec<Finding> {
        let mut record = self.record.with(corruption.beside);
        (corruption.apply)(&mut record);
        serious(record.findings())
    }

    /// The warnings and problems of the record with a change.
    pub fn changed(&self, change: fn(&mut Record)) -> Vec<Finding> {
        let mut record = self.record.clone();
        change(&mut record);
        serious(record.findings())
    }

    /// The expected finding, raised by the corruption and not without it.
    pub fn outcome(&self, corruption: &Corruption) -> Result<(Finding, Vec<Code>), String> {
        let clean = self.findings(corruption.beside);
        if let Some(finding) = clean.iter().find(|f| f.code == corruption.code) {
            return Err(format!("the clean record raises {}: {}", finding.code, finding.message));
        }
        let found = self.corrupted(corruption);
        let others = other_codes(&found, corruption.code);
        let expected =
            |f: &&Finding| f.code == corruption.code && (corruption.joint.is_none() || f.joint == corruption.joint);
        match found.iter().find(expected) {
            Some(finding) => Ok((finding.clone(), others)),
            None => Err(format!("{} {:?} is not raised, but {others:?}", corruption.code, corruption.joint)),
        }
    }
}

fn serious(findings: Vec<Finding>) -> Vec<Finding> {
    findings.into_iter().filter(|f| f.severity <= Severity::Warning).collect()
}

fn other_codes(found: &[Finding], expected: Code) -> Vec<Code> {
    let mut codes: Vec<Code> = found.iter().map(|f| f.code).filter(|c| *c != expected).collect();
    codes.dedup();
    codes
}

/// A row of the table: corruption, finding, evidence in the twin and in the real record, and what else is raised.
pub fn row(corruption: &Corruption, records: &[&Clean]) -> Vec<String> {
    let outcomes: Vec<_> = records.iter().map(|r| r.outcome(corruption)).collect();
    let evidence = |o: &Result<(Finding, Vec<Code>), String>| match o {
        Ok((finding, _)) => format!("{} {}", short(finding.value), finding.unit),
        Err(_) => "not raised".to_owned(),
    };
    let others = |o: &Result<(Finding, Vec<Code>), String>| {
        let codes = o.as_ref().map(|o| o.1.clone()).unwrap_or_default();
        codes.iter().map(|c| c.name()).collect::<Vec<_>>().join(", ")
    };
    let joint = corruption.joint.map_or(String::new(), |j| format!(", joint {j}"));
    let mut row = vec![corruption.name.to_owned(), format!("`{}`{joint}", corruption.code)];
    row.extend(outcomes.iter().map(evidence));
    let mut also: Vec<String> = outcomes.iter().map(others).filter(|o| !o.is_empty()).collect();
    also.dedup();
    row.push(also.join("; "));
    row
}

/// Two significant digits.
pub fn short(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let digits = (1 - value.abs().log10().floor() as i32).max(0) as usize;
    format!("{value:.digits$}")
}

/// Rows as Markdown.
pub fn markdown(head: &[&str], rows: &[Vec<String>]) -> String {
    let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
    let head: Vec<String> = head.iter().map(|h| (*h).to_owned()).collect();
    let rule: Vec<String> = head.iter().map(|_| "---".to_owned()).collect();
    [head, rule].iter().chain(rows).map(|cells| line(cells)).collect()
}

/// The cells of the Markdown table behind a heading.
pub fn cells(text: &str, heading: &str) -> Vec<Vec<String>> {
    let behind = text.split_once(heading).map_or("", |t| t.1);
    let lines = behind.lines().skip_while(|l| !l.starts_with('|')).take_while(|l| l.starts_with('|'));
    let split = |l: &str| l.trim_matches('|').split('|').map(|c| c.trim().to_owned()).collect();
    lines.skip(2).map(split).collect()
}

/// Whether two cells say the same: word by word, numbers to 15 %.
pub fn same(a: &str, b: &str) -> bool {
    let (a, b): (Vec<&str>, Vec<&str>) = (a.split(' ').collect(), b.split(' ').collect());
    let word = |(a, b): (&&str, &&str)| match (a.parse::<f64>(), b.parse::<f64>()) {
        (Ok(a), Ok(b)) => (a - b).abs() <= 0.15 * a.abs().max(b.abs()),
        _ => a == b,
    };
    a.len() == b.len() && a.iter().zip(&b).all(word)
}
