//! thetahat in a browser's page: a session with files in memory, JSON in and out.
//!
//! [`Session`] does the work, on any system; `page` is its JavaScript interface.

mod answers;
mod budget;
mod kind;
mod page;
mod remedies;
mod request;
mod session;
mod store;
#[cfg(all(target_family = "wasm", target_os = "unknown"))]
mod threads;

pub use session::{Outcome, Session};
