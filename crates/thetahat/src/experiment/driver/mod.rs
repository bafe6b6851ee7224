//! What the drivers of robots write into their logs: names of columns, units, signs, and what they mean by effort.
//!
//! | file | what it does |
//! | --- | --- |
//! | `file` | a driver as its TOML file has it |
//! | `presets` | the drivers that come with the program: the files in the folder `drivers` |
//! | `find` | a driver by the name of a preset or by its file |
//! | `pattern` | which columns a name such as `actual_q_*` stands for |
//! | `columns` | what the columns of a log hold, as a driver has it |
//! | `check` | what a driver's file must hold |
//! | `error` | why there is no driver |

mod check;
mod columns;
mod error;
mod file;
mod find;
mod pattern;
mod presets;

pub(super) use columns::DriverColumns;
pub use error::DriverError;
pub use file::{Driver, DriverController, DriverSignal, DriverTime};

#[cfg(test)]
mod tests;
