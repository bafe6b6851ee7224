/// Curves that all runs share; joint by joint as in y.
#[derive(Debug, Clone, Default)]
pub struct Plots {
    /// Time of each decimated row of a joint, s.
    pub time_s: Vec<f64>,
    /// y, one vector per joint, N m or N.
    pub measured: Vec<Vec<f64>>,
    /// Filtered positions at the same times, one vector per joint, rad or m.
    pub position: Vec<Vec<f64>>,
}

/// Curves of one run.
#[derive(Debug, Clone, Default)]
pub struct RunPlots {
    /// `y_hat`, one vector per joint.
    pub predicted: Vec<Vec<f64>>,
    /// Simulated positions, one vector per joint; empty without a simulation.
    pub simulated_position: Vec<Vec<f64>>,
}
