//! Tests of the command line, in one program.

mod bad_input;
mod campaign;
mod captures;
mod documents;
mod exports;
mod generate;
mod locked_joints;
mod model;
mod payload;
mod reductions;
mod reference;
mod safe_files;
mod shell;
mod terminal;
mod tutorial;
mod watch;
mod your_own_robot;
