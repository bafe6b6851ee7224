//! The `dynamics` room.
