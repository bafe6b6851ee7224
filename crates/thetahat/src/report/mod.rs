//! The report of an experiment: `results.json`, `parameters.csv`, `report.html`, and tables for the terminal.
//!
//! [`write_all`] writes the files, [`text`] holds the tables for the terminal. Both show the same [`Table`]s, and both
//! put [`Published`] figures beside ours where there are any. Nothing is computed here but comparisons.

#[cfg(feature = "parquet")]
mod box_plot;
#[cfg(feature = "parquet")]
mod campaign;
#[cfg(feature = "parquet")]
mod campaign_tables;
mod contents;
mod diagnosis;
mod error;
mod figures;
mod files;
mod findings;
mod html;
mod model;
mod model_text;
mod number;
mod plot;
mod prediction;
mod published;
mod sections;
mod sensitivity;
mod series;
mod table;
mod tables;
pub mod text;

#[cfg(feature = "parquet")]
pub use campaign::{campaign_text, write_campaign};
pub use contents::contents_text;
pub use error::ReportError;
pub use files::{check_folder, model_json, write_all};
pub use findings::findings_text;
pub use model::{
    BaseParameterReport, Count, Counts, JointReport, MimicReport, ModelReport, StandardParameterReport,
    TransmissionReport,
};
pub use model_text::model_text;
pub use prediction::{prediction_text, write_prediction};
pub use published::{Agreement, Published, PublishedValue};
pub use sensitivity::{sensitivity_text, write_sensitivity};
pub use series::write_record;
pub use table::{Group, TEXT_WIDTH, Table};
