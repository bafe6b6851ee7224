//! Text in columns: one line per sample, with or without a line of names before.
//!
//! | file | what it does |
//! | --- | --- |
//! | `text` | drops byte order mark, comments and runs of spaces; splits lines into cells |
//! | `dialect` | what may be set, and what is detected where it is not: delimiter and header |
//! | `number` | cells to numbers, with a decimal point or comma |
//! | `read` | a whole file into a table |
//! | `pieces` | any rows of a long file into a table |

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
