//! The `base_parameters` room.
