//! The `experiment` room.
