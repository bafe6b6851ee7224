use thetahat_ground::series::Series;

/// The recording of a simulated robot: what its sensors measure.
#[derive(Debug, Clone, PartialEq)]
pub struct TwinRecording {
    /// Names of the joints.
    pub joints: Vec<String>,
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Joint positions, rad or m.
    pub position: Series,
    /// Joint torques, N m or N.
    pub torque: Series,
}
