//! The `trajectory` room.
