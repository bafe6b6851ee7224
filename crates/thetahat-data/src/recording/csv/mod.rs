//! Text in columns: one line per sample, with or without a header line.
//!
//! | file | what it does |
//! | --- | --- |
//! | `encoding` | converts UTF-16 |
//! | `text` | lines, rows and cells; runs of spaces |
//! | `number` | converts cells to numbers, with a decimal point or comma and groups of digits |
//! | `stamp`, `stamps` | dates and times of day in cells, and columns of them in seconds |
//! | `row`, `sample` | the first rows at a delimiter: which are names, units and values |
//! | `unit_line`, `names` | the line of units, and the names of the columns |
//! | `joint_states` | joints that every row names |
//! | `dialect` | the settings, and their detection if unset: delimiter, header and lines above it |
//! | `values` | the values of one channel while its cells are read |
//! | `read` | reads a whole file into a table |
//! | `transposed` | reads a file with a channel in each line |
//! | `pieces` | reads any rows of a long file into a table |
//! | `stream` | reads the lines of a text that grows into tables |

mod dialect;
mod encoding;
mod joint_states;
mod lists;
mod names;
mod number;
mod pieces;
mod read;
mod row;
mod sample;
mod stamp;
mod stamps;
mod stream;
mod text;
mod transposed;
mod unit_line;
mod values;

pub use dialect::Dialect;
pub use number::Decimal;
pub(super) use pieces::TextPieces;
pub(super) use read::{names, read, read_with_dialect};
pub(super) use stream::TextStream;
pub(super) use unit_line::unit_left_out;

#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_of_tools;
