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
    /// The causes whose columns these are, of one that is several of a kind at once.
    pub(super) members: Vec<usize>,
    /// Columns among which these were the strongest.
    pub(super) searched: usize,
}

impl Cause {
    /// Errors of a kind at several joints or links: equal errors of two gear ratios nearly hide each other.
    pub(super) fn together(kind: CauseKind, causes: &[Self]) -> Option<Self> {
        let members: Vec<usize> = (0..causes.len()).filter(|&k| causes[k].kind == kind).collect();
        let unit = causes[*members.first()?].unit;
        let columns = members.iter().flat_map(|&k| causes[k].columns.clone()).collect();
        let subject = if kind == CauseKind::Length { "several links" } else { "several joints" }.to_owned();
        (members.len() > 1).then_some(Self { kind, subject, unit, columns, instrument: None, members, searched: 1 })
    }
}
