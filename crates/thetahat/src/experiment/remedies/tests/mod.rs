//! Twins with one fault each: the remedy of the fault brings the right values back.

mod edits;
mod faults;
mod twin;
