//! Results of an identification as data, and reports of them as text, HTML, JSON and CSV.

pub mod results;

pub mod report;
