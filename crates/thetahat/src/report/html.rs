//! Pages: each one file that needs nothing else.

use minijinja::{Environment, Value, context, syntax::SyntaxConfig};
use serde::Serialize;

use super::{error::ReportError, section::Section};

const TEMPLATE: &str = include_str!("template.html");

/// A page with a title, a head of labels and texts, and sections.
pub(super) fn page_of(
    title: &str,
    facts: &[(&'static str, String)],
    sections: &[Section],
) -> Result<String, ReportError> {
    let refuse = |source| ReportError::Json { source };
    let facts = value_of(&facts).map_err(refuse)?;
    let sections = value_of(&sections).map_err(refuse)?;
    page(context! { title, facts, sections }).map_err(|source| ReportError::Html { source })
}

fn page(content: Value) -> Result<String, minijinja::Error> {
    let mut environment = Environment::new();
    environment.set_syntax(SyntaxConfig::builder().trim_blocks(true).lstrip_blocks(true).build()?);
    // The extension of the name switches escaping on.
    environment.add_template("report.html", TEMPLATE)?;
    environment.get_template("report.html")?.render(content)
}

/// Anything as the template sees it.
fn value_of(content: &impl Serialize) -> Result<Value, serde_json::Error> {
    serde_json::to_value(content).map(value)
}

fn value(json: serde_json::Value) -> Value {
    use serde_json::Value as Json;
    match json {
        Json::Null => Value::from(()),
        Json::Bool(b) => b.into(),
        Json::Number(n) => n.as_u64().map_or_else(|| n.as_f64().into(), Value::from),
        Json::String(text) => text.into(),
        Json::Array(items) => items.into_iter().map(value).collect(),
        Json::Object(fields) => Value::from_pairs(fields.into_iter().map(|(name, field)| (name, value(field)))),
    }
}
