//! The report of an experiment: `results.json`, `parameters.csv`, `report.html`, and tables for the terminal.
//!
//! [`write_all`] writes the files, [`text`] holds the tables for the terminal. Both show the same [`Table`]s, and both
//! compare with [`Published`] figures if there are any. Nothing is computed here but comparisons: all values come
//! from [`results`](crate::results) alone.
//!
//! ```
//! use thetahat_report::report::{Table, TextWidth};
//!
//! let table = Table {
//!     title: "nominal: estimates".to_owned(),
//!     lead: 1,
//!     head: ["name", "idim-iv"].map(str::to_owned).into(),
//!     rows: vec![["zz1r", "1.250 (1.04 %)"].map(str::to_owned).into()],
//!     ..Table::default()
//! };
//! let text = table.to_text(TextWidth::default());
//! assert!(text.contains("zz1r") && text.lines().all(|line| line.chars().count() <= 80));
//! ```

mod campaign;
mod comparison;
mod design;
mod error;
mod figures;
mod files;
mod json;
mod names;
mod number;
mod outputs;
mod page;
mod plot;
mod predicted_intervals;
mod prediction;
mod published;
mod section;
mod sections;
mod sensitivity;
mod series;
mod table;
mod tables;
pub mod text;
mod units;
mod verdict;
mod watch;
mod wrap;

pub use campaign::{CAMPAIGN_PAGE, campaign_text, write_campaign};
pub use comparison::{COMPARISON_PAGE, comparison_text, write_comparison};
pub use design::move_programs::MOVE_FILES;
pub use design::{DESIGN_FILES, POINT_FILES, design_text, write_design};
pub use error::ReportError;
pub use json::{findings_json, model_json};
pub use outputs::{file_names, files, render, write_all};
pub use predicted_intervals::{predicted_intervals_text, write_predicted_intervals};
pub use prediction::{prediction_text, write_prediction};
pub use published::{Agreement, Published, PublishedValue};
pub use sections::findings::{filter_text, findings_text};
pub use sensitivity::{SENSITIVITY_FILES, sensitivity_text, write_sensitivity};
pub use series::{recording_csv, write_recording};
pub use table::{Group, Table};
pub use text::brief::brief;
pub use text::card::{card_text, headline};
pub use text::contents::contents_text;
pub use text::model_text::model_text;
pub use text::remedies::{change_text, remedies_text};
pub use watch::{watch_head, watch_json, watch_text};
pub use wrap::TextWidth;
