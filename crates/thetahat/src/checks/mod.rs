//! What is wrong with a recording, found before anything is estimated from it.
//!
//! [`examine`] looks at one recording on the joint side: at its samples (missing, repeated, outliers, coarse steps, limits,
//! rests), at what the filter makes of them, at velocities and references that were recorded beside, and at the fit of the
//! robot's model, which shows units, sides of the gears, signs, exchanged joints, ratios, lags, and what the motion does not
//! excite. Each [`Finding`] has a stable [`Code`], a [`Severity`], its evidence as a number, and what to do. Limits,
//! their margins on clean records, and what is not detected are in `docs/checks.md`.
//!
//! ```
//! use thetahat::checks::{Code, Severity};
//! // Codes and severities have names that stay, for scripts that look for them.
//! assert_eq!((Code::DroppedSamples.name(), Severity::Problem.name()), ("dropped-samples", "problem"));
//! let mut names = Code::ALL.map(Code::name).to_vec();
//! names.sort_unstable();
//! names.dedup();
//! assert_eq!(names.len(), Code::ALL.len());
//! ```

mod affine;
mod chain;
mod controller;
mod cutoff;
mod examination;
mod excitation;
mod fault;
mod finding;
mod friction;
mod gear;
mod hypotheses;
mod lag;
mod lag_search;
mod motion;
mod numbers;
mod reference;
mod regression;
mod repeats;
mod resolution;
mod signals;
mod spikes;
mod stamps;
mod subject;
mod torque;
mod velocity;

pub use examination::{examine, measure};
pub use finding::{Code, Finding, Measure, Severity};
pub use subject::{SignalSettings, Subject};
