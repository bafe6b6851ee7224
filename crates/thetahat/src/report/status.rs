//! How a run ended, in words.

use crate::results::Status;

pub(super) fn status_words(status: Status) -> &'static str {
    match status {
        Status::Converged => "converged",
        Status::Stalled => "stalled",
        Status::IterationLimit => "iteration limit",
        Status::Diverged => "diverged",
        Status::NotIdentifiable => "not identifiable",
    }
}
