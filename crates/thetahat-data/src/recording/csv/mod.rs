//! Text in columns: one line per sample, with or without a header line.
//!
//! | file | what it does |
//! | --- | --- |
//! | `text` | drops byte order mark, comments and runs of spaces; splits lines into cells |
//! | `dialect` | the settings, and their detection if unset: delimiter and header |
//! | `number` | converts cells to numbers, with a decimal point or comma |
//! | `read` | reads a whole file into a table |
//! | `pieces` | reads any rows of a long file into a table |

mod dialect;
mod number;
mod pieces;
mod read;
mod text;

pub use dialect::Dialect;
pub use number::Decimal;
pub(super) use pieces::TextPieces;
pub(super) use read::{names, read, read_with_dialect};

#[cfg(test)]
mod tests;
