//! Locked joints: fixed at a value before the dynamic model is built, their links part of those that carry them.
//!
//! [`Locks`] names them; [`Robot::with_locks`](crate::robot::Robot::with_locks) builds the remaining robot.

mod error;
mod locks;
mod merge;
mod parts;
mod places;
mod terms;
mod transmission;

pub use error::LockError;
pub use locks::{LockedJoint, Locks};

#[doc(hidden)]
pub use parts::LinkPart;

pub(super) use locks::{LocksOf, resolve_all};
pub(super) use merge::merged;

#[cfg(test)]
mod tests;
