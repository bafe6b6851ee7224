//! A robot watched while it works: its torque residual, collision-like events, and changes of friction, offsets and payload.
//!
//! Positions pass the identification's filter with a fixed delay, and the residual is the measured torque of that instant less the
//! model's. The first seconds show its noise and its mean. From then on ratios of likelihoods between "changed at an instant" and "not
//! changed" are formed for every instant and cause, with the size of the change integrated over a Gaussian prior. Their largest value is a
//! CUSUM; under no change the mean of each ratio is one, so that the mean time to a false alarm is at least the threshold, in steps. A change
//! is said a second after its ratio passed the threshold, with estimates from the seconds after the one in which it began.
//!
//! | file | what it does |
//! | --- | --- |
//! | `subject` | the identified model: torque, and what each change adds to it |
//! | `step` | samples averaged to steps, and steps near rest |
//! | `likelihood` | sums of rows, and ratios of likelihoods |
//! | `settling` | baseline and noise from the first seconds |
//! | `collision` | fast residuals |
//! | `drift` | lasting changes |
//! | `monitor` | all of it, sample by sample |
//! | `samples` | samples of a recording, and of text that grows |

mod belief;
mod collision;
mod drift;
mod error;
mod history;
mod input;
mod layout;
mod likelihood;
mod monitor;
mod options;
mod residual;
mod samples;
mod scale;
mod second;
mod settling;
mod start;
mod step;
mod subject;
mod whitening;
mod words;

pub use error::WatchError;
pub use monitor::Watch;
pub use options::WatchOptions;
pub use samples::{GrowingText, Sample, recorded_samples};
pub use subject::WatchedRobot;
