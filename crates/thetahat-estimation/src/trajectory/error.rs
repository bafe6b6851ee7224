/// Why a trajectory cannot be built or reconstructed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TrajectoryError {
    /// Two lists have different numbers of joints.
    #[error("{what} has {found} joints, expected {expected}; give one value for each joint")]
    JointCount {
        /// The list.
        what: String,
        /// Number of joints of the start point or of the position.
        expected: usize,
        /// Number found.
        found: usize,
    },
    /// A number is not finite or out of range.
    #[error("{what} is {found}, expected {expected}")]
    Value {
        /// The quantity.
        what: String,
        /// What is allowed.
        expected: &'static str,
        /// What was found.
        found: f64,
    },
    /// The times of a move do not satisfy T1 >= T2 >= T3 > 0.
    #[error("move {number}: t1_s = {t1_s}, t2_s = {t2_s}, t3_s = {t3_s}; expected t1_s >= t2_s >= t3_s > 0")]
    TimeLaw {
        /// The move, counted from one.
        number: usize,
        /// T1.
        t1_s: f64,
        /// T2.
        t2_s: f64,
        /// T3.
        t3_s: f64,
    },
    /// A move starts or ends before the previous one does.
    #[error(
        "move {number} ({start_s:.4} s to {end_s:.4} s) starts or ends before move {} does; order the moves by time, \
         and in a reconstruction look at the recording there: it is not a sequence of point-to-point moves",
        number - 1
    )]
    Order {
        /// The move, counted from one.
        number: usize,
        /// Its start.
        start_s: f64,
        /// Its end.
        end_s: f64,
    },
    /// Position and velocity have different numbers of samples.
    #[error("{position} samples of position but {velocity} of velocity; derive the velocity from the position")]
    SampleCount {
        /// Samples of position.
        position: usize,
        /// Samples of velocity.
        velocity: usize,
    },
    /// A sample is not a number.
    #[error("{what} of joint {joint} at sample {sample} is not finite; cut the recording or correct the sample")]
    NotFinite {
        /// Position or velocity.
        what: &'static str,
        /// The joint, counted from one.
        joint: usize,
        /// The sample, counted from zero.
        sample: usize,
    },
    /// A recording or a move has too few samples to be fitted.
    #[error("{what} has {found} samples, at least {needed} are needed; record longer, or at a higher rate")]
    TooFewSamples {
        /// The recording, or one of its moves.
        what: String,
        /// Samples found.
        found: usize,
        /// Samples needed.
        needed: usize,
    },
    /// No joint moves between two points.
    #[error(
        "no move is found: the largest range of position is {largest_range:.3e} rad or m; give a recording in which the \
         robot moves from rest to rest, in joint units, with a low-passed velocity"
    )]
    NoMotion {
        /// The largest range of position over the joints.
        largest_range: f64,
    },
}
