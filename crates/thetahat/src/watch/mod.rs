//! A robot watched while it works: its torque residual, collision-like events, and changes of friction, offsets and payload.
//!
//! Positions pass the identification's filter with a fixed delay, and the residual is the measured torque of that instant less the
//! model's. The first seconds show its noise and its mean. From then on ratios of likelihoods between "changed at an instant" and "not
//! changed" are formed for every instant and cause, with the size of the change integrated over a Gaussian prior. Their largest value is a
//! CUSUM; under no change the mean of each ratio is one, so that the mean time to a false alarm is at least the threshold, in steps.
//!
//! "Not changed" holds what the model may be wrong in, so that other motion than that of settling is no change: the parameters within their
//! covariance, a curve of each joint's friction, a delay of its torque, and a noise for each octave of speed that is larger until it was seen.
//! What a joint's motion has shown of them is known from then on. A change is said a second after its ratio passed the threshold, if the
//! seconds after the one in which it began show it as well, with estimates from these.
//!
//! | file | what it does |
//! | --- | --- |
//! | `options` | how a robot is watched |
//! | `layout` | the changes, and their places |
//! | `step` | samples averaged to steps, and steps near rest |
//! | `subject` | the identified model: torque, and what each change adds to it |
//! | `samples`, `input` | samples of a recording, and of text that grows; their steps |
//! | `likelihood` | sums of rows, and ratios of likelihoods |
//! | `whitening`, `scale`, `second` | blocks whose noise is not correlated; noise by speed; the blocks of a second |
//! | `belief`, `settling` | what is believed before; baseline and noise from the first seconds |
//! | `collision` | fast residuals |
//! | `history`, `drift` | the last seconds; lasting changes |
//! | `words`, `start`, `residual` | events in words; friction at the start; the residual's size |
//! | `monitor` | all of it, sample by sample |

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
