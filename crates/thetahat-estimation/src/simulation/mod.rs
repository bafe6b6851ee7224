//! The closed loop: reference, controller, drive, transmission and the direct dynamic model (5), integrated in time.
//!
//! The simulated controller works on the motors with the true reference. The simulated robot may differ from the true
//! one in its gear ratios, drive gains, controller gains and delay ([`SimulatorBias`]).
//!
//! Coulomb friction is regularised, `sign(v)` as `tanh(v / scale)`: a discontinuous sign makes an adaptive integrator
//! chatter at rest, and its accelerations there do not converge with the step. The scale is a setting; its effect on the
//! result is in `docs/evidence/simulation.md`.
//!
//! ```
//! use thetahat_estimation::simulation::{Reference, SampledReference};
//! use thetahat_ground::series::Series;
//! // A recorded reference t^2, and its derivatives between two samples.
//! let samples = (0..100).map(|k| (f64::from(k) / 100.0).powi(2)).collect();
//! let reference = Reference::Sampled(SampledReference::new(Series::from_values(1, samples)?, 100.0));
//! let (mut q, mut dq, mut ddq) = ([0.0], [0.0], [0.0]);
//! reference.evaluate(0.505, &mut q, &mut dq, &mut ddq);
//! assert!((dq[0] - 1.01).abs() < 1e-9 && (ddq[0] - 2.0).abs() < 1e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod bias;
mod closed_loop;
mod coupling;
mod definiteness;
mod dormand_prince;
mod error;
mod integrator;
mod motion;
mod motor_reference;
mod noise;
mod plant;
mod reference;
mod rosenbrock_w;
mod running;
mod sampling;
mod sensitivity;
mod sensors;
mod side_by_side;
mod solver;
mod step_control;
mod stiffness;
mod system;

#[doc(hidden)]
pub use bias::NOMINAL;
pub use bias::{BiasKind, SimulatorBias};
pub use closed_loop::{ClosedLoop, Job};
pub use dormand_prince::DormandPrince;
pub use error::SimulationError;
pub use motion::{OutputGrid, SimulatedMotion};
pub use noise::{Autoregression, NoisySignals, RecordingNoise, SignalNoise, random_numbers};
pub use reference::{PeriodicReference, Reference, SampledReference};
pub use rosenbrock_w::{Linearisation, RosenbrockW};
pub use sensitivity::{Motors, SensitiveTo, Sensitivities, SensitivitySample};
pub use sensors::Sensors;
pub use side_by_side::simulate_all;
pub use solver::{Solver, WorkCounts};
pub use step_control::{Next, StepTooSmall, StepView};
