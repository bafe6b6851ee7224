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

mod box_plot;
mod brief;
mod campaign;
mod campaign_figures;
mod campaign_power;
mod campaign_tables;
mod card;
mod closed_loop;
mod comparison;
mod contents;
mod design;
mod design_figures;
mod design_tables;
mod diagnosis;
mod error;
mod facts;
mod figures;
mod files;
mod findings;
mod grades;
mod hidden_bias;
mod json;
mod model_text;
mod move_programs;
mod names;
mod number;
mod outputs;
mod page;
mod payload;
mod physical;
mod plot;
mod prediction;
mod published;
mod section;
mod sections;
mod sensitivity;
mod series;
mod table;
mod tables;
mod terms;
pub mod text;
mod units;
mod user_runs;
mod verdict;
mod wrap;

pub use brief::brief;
pub use campaign::{CAMPAIGN_PAGE, campaign_text, write_campaign};
pub use card::{card_text, headline};
pub use comparison::{comparison_text, write_comparison};
pub use contents::contents_text;
pub use design::{DESIGN_FILES, design_text, write_design};
pub use error::ReportError;
pub use findings::{filter_text, findings_text};
pub use json::{findings_json, model_json};
pub use model_text::model_text;
pub use move_programs::MOVE_FILES;
pub use outputs::{file_names, render, write_all};
pub use prediction::{prediction_text, write_prediction};
pub use published::{Agreement, Published, PublishedValue};
pub use sensitivity::{SENSITIVITY_FILES, sensitivity_text, write_sensitivity};
pub use series::{recording_csv, write_recording};
pub use table::{Group, Table};
pub use wrap::TextWidth;
