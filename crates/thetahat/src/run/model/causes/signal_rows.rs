//! Signals of which one joint's rows are the column of a cause.

/// Signals of all joints in the tested rows; absent if a filter fails.
#[derive(Default)]
pub(super) struct SignalRows {
    /// The predicted torques.
    pub(super) torque: Option<Vec<f64>>,
    /// The derivative of the torques by their delay.
    pub(super) late: Option<Vec<f64>>,
    /// The same of the smoothed torques, an instrument.
    pub(super) smoothed_late: Option<Vec<f64>>,
    /// What a low-pass filter makes of the torques in addition to its delay: their second derivative.
    pub(super) filtered: Option<Vec<f64>>,
    /// The same of the smoothed torques, an instrument.
    pub(super) smoothed_filtered: Option<Vec<f64>>,
    /// What a motor constant that falls with the square of the torque adds to a recorded torque.
    pub(super) cube: Option<Vec<f64>>,
    /// What a gain that changes by itself from beginning to end adds to a recorded torque; each recording from its own beginning.
    pub(super) aging: Option<Vec<f64>>,
    /// The torques of springs whose rest is anywhere, which the offsets take.
    pub(super) position: Option<Vec<f64>>,
    /// Viscous friction that is larger in one direction.
    pub(super) speed: Option<Vec<f64>>,
    /// One for each sample, as offsets are.
    pub(super) constant: Option<Vec<f64>>,
    /// The part of the recording that has passed, as offsets that grow.
    pub(super) time: Option<Vec<f64>>,
    /// Viscous friction that grows with time; each recording from its own beginning.
    pub(super) viscous_drift: Option<Vec<f64>>,
    /// The same of Coulomb friction.
    pub(super) coulomb_drift: Option<Vec<f64>>,
    /// Coulomb friction in proportion to the torque of gravity, and the part by which it differs with the direction.
    pub(super) gravity_friction: [Option<Vec<f64>>; 2],
    /// The same in proportion to the whole torque of the bodies.
    pub(super) load_friction: [Option<Vec<f64>>; 2],
    /// Coulomb friction that fades at each of [`SPEEDS`](super::torques::SPEEDS).
    pub(super) fading: [Option<Vec<f64>>; 2],
}
