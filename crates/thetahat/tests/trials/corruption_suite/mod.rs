//! The corruption suite: clean records, corruptions that raise one finding each, and the table of `docs/evidence/checks.md`.

pub mod arms;
pub mod corruptions;
pub mod defects;
pub mod pairs;
pub mod power;
pub mod record;
pub mod robots;
pub mod table;
