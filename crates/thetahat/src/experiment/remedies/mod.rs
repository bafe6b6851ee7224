//! Findings whose remedy is a setting, as changes of the experiment file.
//!
//! The checks and the model say what is wrong with a recording in a [`RemedyStep`](thetahat_report::results::RemedyStep): factors of
//! channels, an exchange, a delay. [`collect`] makes the [`Remedy`](thetahat_report::results::Remedy)s of results, each
//! with a code; [`steps`] turns a step into changes of keys; [`text`] makes these changes in the text of the file, in which all
//! other bytes stay. [`Experiment::with_remedies`](crate::Experiment::with_remedies) does what is asked for by codes.

mod apply;
mod candidate;
mod causes;
mod chains;
mod channels;
mod collect;
mod estimated;
mod label;
mod steps;
mod text;

#[cfg(test)]
mod tests;

pub(super) use collect::enter;
