//! What a file holds: its tables and columns, with ranges, resolution, rate, jitter and gaps.
//!
//! Nothing is refused that can be told: columns of text, missing values and irregular times are part of the answer.
//!
//! | file | what it does |
//! | --- | --- |
//! | `contents` | the summaries, and the walk over a file |
//! | `channel` | range, mean, root mean square and resolution of a channel |
//! | `time` | which columns are times; unit, rate, jitter, gaps, repetitions |

mod channel;
mod contents;
mod time;

pub use channel::ChannelSummary;
pub use contents::{ColumnSummary, Contents, TableSummary, contradicting_times, inspect, inspect_with_time};
pub use time::{Gap, TimeSummary};

#[cfg(test)]
mod tests;
