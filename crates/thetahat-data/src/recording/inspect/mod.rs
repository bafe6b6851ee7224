//! The content of a file: its tables and columns, with ranges, resolution, rate, jitter and gaps.
//!
//! Whatever can be reported is not an error: columns of text, missing values and irregular times are part of the result.
//!
//! | file | what it does |
//! | --- | --- |
//! | `contents` | the summaries, and the reading of a file for them |
//! | `channel` | range, mean, root mean square and resolution of a channel |
//! | `time` | columns that are times; unit, rate, jitter, gaps, repetitions |

mod channel;
mod contents;
mod time;

pub use channel::ChannelSummary;
pub use contents::{ColumnSummary, Contents, TableSummary, contradicting_times, inspect, inspect_with_time};
pub use time::{Gap, TimeSummary};

#[cfg(test)]
mod tests;
