use std::path::PathBuf;

use thetahat::Method;

/// What the command line asks for.
pub struct Arguments {
    /// Folder with recorded data sets, for robots that are described there.
    pub data: Option<PathBuf>,
    /// Few cells on short recordings.
    pub quick: bool,
    pub methods: Vec<Method>,
    /// Robots whose names contain this.
    pub robot: String,
    /// Of motions and noise.
    pub seed: u64,
    /// Bandwidths of the simulated loop relative to the twin's.
    pub factors: Vec<f64>,
}

/// Those of the whole table.
pub const FACTORS: [f64; 5] = [0.25, 0.5, 1.0, 2.0, 4.0];

impl Arguments {
    /// Length of the recordings.
    pub fn duration_s(&self) -> f64 {
        if self.quick { 5.0 } else { 10.0 }
    }
}
