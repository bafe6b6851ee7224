use thetahat_estimation::identification::Status;

/// Noise level, start and seed of a recording, each counted from zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Key {
    /// The noise level.
    pub level: u32,
    /// The start.
    pub start: u32,
    /// The seed.
    pub seed: u32,
}

/// One run. Numbers that a failed run does not have are absent.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// The case of the experiment.
    pub case: String,
    /// The noise level.
    pub noise: String,
    /// The start, from one.
    pub start: u32,
    /// The seed, from one.
    pub seed: u32,
    /// The method, as in the campaign file.
    pub method: String,
    /// How it ended.
    pub status: Status,
    /// Why, where it is not converged.
    pub reason: Option<String>,
    /// Iterations.
    pub iterations: usize,
    /// Closed-loop simulations of the iteration.
    pub simulations: usize,
    /// Wall-clock time from the measurements to the estimate, s; it is kept in a file of its own.
    pub seconds: Option<f64>,
    /// `100 |y - y_hat| / |y|`, unweighted.
    pub relative_error_percent: Option<f64>,
    /// `100 |q - q_true| / |q_true|` of the loop simulated with the estimate, against the motion without noise.
    pub position_error_percent: Option<f64>,
    /// The same of the joint torques.
    pub torque_error_percent: Option<f64>,
    /// `|theta - theta_true|`, in SI units that differ from parameter to parameter.
    pub parameter_distance: Option<f64>,
    /// The estimates, in the order of the campaign's parameters; absent where the case does not have one.
    pub estimates: Vec<Option<f64>>,
    /// Their classical standard deviations.
    pub deviations: Vec<Option<f64>>,
    /// Their 95 % intervals, with errors that may be correlated in time and differ between joints.
    pub intervals: Vec<Option<[f64; 2]>>,
}

impl Row {
    /// Whether its numbers count: failures are counted, never averaged in.
    #[must_use]
    pub fn has_converged(&self) -> bool {
        self.status == Status::Converged
    }
}

/// The name of a status in files and tables.
pub(super) fn status_name(status: Status) -> &'static str {
    match status {
        Status::Converged => "converged",
        Status::Stalled => "stalled",
        Status::IterationLimit => "iteration_limit",
        Status::Diverged => "diverged",
        Status::NotIdentifiable => "not_identifiable",
    }
}
