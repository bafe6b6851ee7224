use thetahat_estimation::{
    identification::{Method, Status},
    simulation::BiasKind,
};

/// A sweep over errors of the simulator.
#[derive(Debug, Clone)]
pub struct Sensitivity {
    /// Title of the experiment.
    pub title: String,
    /// Name of the robot.
    pub robot: String,
    /// Names of the parameters, in the order of the estimates.
    pub parameters: Vec<String>,
    /// Which of them the tables show and the changes include.
    pub shown: Vec<bool>,
    /// The estimates with the unchanged simulator, per method.
    pub nominal: Vec<SensitivityPoint>,
    /// The estimates with each error.
    pub points: Vec<SensitivityPoint>,
}

/// The estimates of one method with one error of the simulator.
#[derive(Debug, Clone)]
pub struct SensitivityPoint {
    /// The quantity in error.
    pub kind: BiasKind,
    /// Factor, or the value that is added: s for a delay, rad or m for an offset.
    pub value: f64,
    /// The method.
    pub method: Method,
    /// How its iteration ended.
    pub status: Status,
    /// `100 |y - y_hat| / |y|`; none without an estimate.
    pub relative_error_percent: Option<f64>,
    /// Root mean square change of the shown estimates, in standard deviations, against the simulator without the error.
    pub rms_change: Option<f64>,
    /// The largest change, with its sign, and its parameter.
    pub largest_change: Option<(String, f64)>,
    /// The estimates; may be empty.
    pub estimates: Vec<f64>,
}
