//! Reference trajectories: the commanded motion of the robot.
//!
//! A trajectory is a sequence of point-to-point moves, synchronised over the joints, each with one normalised time law. It is planned from
//! end points and limits ([`plan`]), or reconstructed from a recorded motion ([`reconstruct`]), which gives the simulator a reference free
//! of noise, with ten numbers per move instead of a file. A motion that repeats is a
//! [`FourierSeries`] instead ([`find_periodic`]), which averages the noise over its periods.
//!
//! | letter | word | shape | unit |
//! | --- | --- | --- | --- |
//! | `s ds dds` | normalised time law from 0 to 1, and its derivatives | 1 | 1, 1/s, 1/s^2 |
//! | `T1` | time at full speed plus one acceleration: the displacement divided by the peak velocity | 1 | s |
//! | `T2` | acceleration time before smoothing | 1 | s |
//! | `T3` | time over which the acceleration is smoothed: the jerk is bounded | 1 | s |
//! | `P_0, P_k` | where the trajectory starts, where move k ends | n | rad (m for prismatic joints) |
//! | `D_kj` | displacement of joint j in move k, `P_kj - P_(k-1)j` | 1 | rad |
//! | `q dq ddq` | joint positions and their derivatives | n | rad, rad/s, rad/s^2 |
//! | `w_j` | weight of joint j in a fit | 1 | 1/rad |
//!
//! ```
//! use thetahat_estimation::trajectory::{plan, MotionLimits};
//! let limits = MotionLimits { max_velocity: vec![2.0], acceleration_time_s: 0.1, smoothing_time_s: 0.02, dwell_s: 0.1 };
//! let moves = plan(vec![0.0], &[vec![1.0]], &limits, 0.0)?;
//! let motion = moves.sample(1000.0, 1000);
//! assert!((motion.q.sample(999)[0] - 1.0).abs() < 1e-12);
//! assert!((motion.dq.values().iter().copied().fold(0.0, f64::max) - 2.0).abs() < 1e-12);
//! # Ok::<(), thetahat_estimation::trajectory::TrajectoryError>(())
//! ```

mod detect;
mod envelope;
mod error;
mod fit;
mod fourier;
mod law;
mod linear_step;
mod local_column;
mod moves;
mod period;
mod periodic;
mod plan;
mod reconstruct;

pub use error::TrajectoryError;
pub use fourier::FourierSeries;
#[doc(hidden)]
pub use law::PHASES;
pub use law::TimeLaw;
pub use moves::{Move, Moves};
pub use periodic::{FEWEST_PERIODS, LowPass, Periodic, find_periodic};
pub use plan::{MotionLimits, plan};
pub use reconstruct::{Reconstruction, reconstruct};
