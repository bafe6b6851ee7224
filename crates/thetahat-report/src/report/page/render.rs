//! From the content of a page to its text.

use base64::{Engine, engine::general_purpose::STANDARD};
use minijinja::{Environment, Value, context, syntax::SyntaxConfig};
use serde::Serialize;

use super::card::HeadCard;
use crate::report::{error::ReportError, figures::Figure, section::Section};
use thetahat_ground::digest::sha256_bytes;

/// The macros, and the page that uses them.
const TEMPLATE: &str = concat!(include_str!("tables.html"), include_str!("charts.html"), include_str!("page.html"));
const STYLE: &str = concat!("\n", include_str!("style.css"), "\n");
const SCRIPT: &str = concat!("\n", include_str!("script.js"), "\n");

/// The content of a page.
#[derive(Debug, Default, Serialize)]
pub(in crate::report) struct Page<'a> {
    pub(in crate::report) title: &'a str,
    /// The kind of page, of which a command replaces another.
    pub(in crate::report) generator: &'static str,
    /// The verdict, where there is one.
    pub(in crate::report) card: Option<HeadCard>,
    /// The recommended method: its curves are drawn without gaps.
    pub(in crate::report) recommended: &'static str,
    /// A small picture next to it.
    pub(in crate::report) picture: Option<Figure>,
    /// Labels and texts of the head.
    pub(in crate::report) facts: Vec<(&'static str, String)>,
    pub(in crate::report) sections: Vec<Section>,
    /// The last line.
    pub(in crate::report) footer: &'static str,
}

/// The text of a page.
///
/// # Errors
/// [`ReportError::Json`] and [`ReportError::Html`] where it cannot be made.
pub(in crate::report) fn render(page: &Page<'_>) -> Result<String, ReportError> {
    let json = serde_json::to_value(page).map_err(|source| ReportError::Json { source })?;
    text(value(json)).map_err(|source| ReportError::Html { source })
}

fn text(page: Value) -> Result<String, minijinja::Error> {
    let mut environment = Environment::new();
    environment.set_syntax(SyntaxConfig::builder().trim_blocks(true).lstrip_blocks(true).build()?);
    // The extension of the name switches escaping on.
    environment.add_template("page.html", TEMPLATE)?;
    let style = Value::from_safe_string(STYLE.to_owned());
    let script = Value::from_safe_string(SCRIPT.to_owned());
    environment.get_template("page.html")?.render(context! { page, style, script, policy => policy() })
}

/// The content security policy: the page runs and shows only what is in this file. Attributes place ticks and colour cells.
fn policy() -> String {
    let hash = |text: &str| STANDARD.encode(sha256_bytes(text.as_bytes()));
    let [style, script] = [STYLE, SCRIPT].map(hash);
    format!(
        "default-src 'none'; style-src 'sha256-{style}'; style-src-attr 'unsafe-inline'; script-src 'sha256-{script}'; img-src data:; \
         base-uri 'none'; form-action 'none'"
    )
}

/// Converts JSON to a value of the template.
fn value(json: serde_json::Value) -> Value {
    use serde_json::Value as Json;
    match json {
        Json::Null => Value::from(()),
        Json::Bool(b) => b.into(),
        Json::Number(n) => n.as_i64().map_or_else(|| n.as_f64().into(), Value::from),
        Json::String(text) => text.into(),
        Json::Array(items) => items.into_iter().map(value).collect(),
        Json::Object(fields) => Value::from_pairs(fields.into_iter().map(|(name, field)| (name, value(field)))),
    }
}
