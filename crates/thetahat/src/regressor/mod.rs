//! The `regressor` room.
