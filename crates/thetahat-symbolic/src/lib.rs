//! Models of robots as expressions, and code for them in five languages.

pub mod symbolic;
