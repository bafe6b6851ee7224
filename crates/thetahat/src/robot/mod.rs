//! The `robot` room.
