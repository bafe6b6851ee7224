/// What a simulation knows of a stage.
pub(super) struct StageRecord {
    /// The factors of the mass matrix.
    pub(super) mass: Vec<f64>,
    /// The accelerations.
    pub(super) accelerations: Vec<f64>,
}
