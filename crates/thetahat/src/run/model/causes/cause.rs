use thetahat_report::results::CauseKind;

/// A cause with its columns, in the rows of the model.
#[derive(Debug, Clone)]
pub(super) struct Cause {
    pub(super) kind: CauseKind,
    pub(super) subject: String,
    pub(super) unit: &'static str,
    pub(super) columns: Vec<Vec<f64>>,
    /// The only column without the noise of the recorded motion, of a cause that this noise imitates.
    pub(super) instrument: Option<Vec<f64>>,
}
