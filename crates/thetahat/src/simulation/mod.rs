//! The closed loop: reference, controller, drive, transmission and the direct dynamic model (5), integrated in time.
//!
//! The simulated controller works on the motors with the true reference. The simulated robot may differ from the true
//! one in its gear ratios, drive gains, controller gains and delay ([`SimulatorBias`]).
//!
//! Coulomb friction is regularised, `sign(v)` as `tanh(v / scale)`: a discontinuous sign makes an adaptive integrator
//! chatter at rest, and its accelerations there do not converge with the step. The scale is data; what it does to the
//! result is in `docs/simulation.md`.

mod bias;
mod closed_loop;
mod dormand_prince;
mod plant;
mod reference;
mod running;
mod sensors;
mod side_by_side;

pub use bias::{BiasKind, SimulatorBias};
pub use closed_loop::{ClosedLoop, OutputGrid, SimulatedMotion, SimulationError};
pub use dormand_prince::{Integrator, Next, Solver, StepTooSmall, StepView, WorkCounts};
pub use reference::{Reference, SampledReference};
pub use sensors::Sensors;
pub use side_by_side::{Job, simulate_all};
