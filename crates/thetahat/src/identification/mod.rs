//! The `identification` room.
