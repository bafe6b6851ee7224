//! From results to the model that is exported.

use std::path::Path;

use super::{
    choice::Kept,
    error::ExportError,
    pd_loop::PdLoop,
    posterior::Posterior,
    provenance::{AdjustedParameter, Provenance, moved},
    render::{Export, Target, export_with_loop},
    xml::number,
};
use crate::experiment::{EstimateRequest, IdentifiedRobot};
use thetahat_report::results::Results;

/// Base parameters that are named where they moved; the others are counted.
const NAMED: usize = 12;

/// An identified robot with the standard parameters that are exported.
#[derive(Debug, Clone)]
pub struct IdentifiedModel {
    /// The robot with its estimates.
    pub identified: IdentifiedRobot,
    /// Its standard parameters, SI, in the order of its table: physically consistent.
    pub standard: Vec<f64>,
    /// The base parameters that are not at their estimates, those moved most first.
    pub moved: Vec<AdjustedParameter>,
    kept: Kept,
    pub(super) posterior: Posterior,
}

impl IdentifiedModel {
    /// The model of an estimate in results; `path` names these in messages.
    ///
    /// # Errors
    /// [`ExportError`]: untrusted results, no estimate, another robot, or no consistent parameters within the intervals.
    pub fn of_results(path: &Path, results: &Results, request: &EstimateRequest) -> Result<Self, ExportError> {
        Self::new(IdentifiedRobot::of_results(path, results, request)?)
    }

    /// The model of an identified robot.
    ///
    /// # Errors
    /// [`ExportError`] where no consistent parameters are within the intervals.
    pub fn new(identified: IdentifiedRobot) -> Result<Self, ExportError> {
        let mut posterior = Posterior::new(&identified)?;
        let (standard, kept) = posterior.choose()?;
        Ok(Self { moved: moved(&identified, &standard), identified, standard, kept, posterior })
    }

    /// Where each standard parameter comes from, in the order of the robot's table.
    #[must_use]
    pub fn provenance(&self) -> &[Provenance] {
        &self.posterior.provenance
    }

    /// The file of the robot.
    ///
    /// # Errors
    /// As [`export_robot`](super::export_robot).
    pub fn export<'t>(&self, target: impl Into<Target<'t>>) -> Result<Export, ExportError> {
        let Self { identified, standard, .. } = self;
        let pd = PdLoop::of(identified);
        let urdf = identified.urdf_text();
        export_with_loop(&identified.robot, urdf, standard, target.into(), &self.about(), pd.as_ref())
    }

    /// What there is to say of the exported parameters, a sentence each: how they were chosen, what moved, and what was not
    /// identified.
    #[must_use]
    pub fn about(&self) -> Vec<String> {
        let mut lines = vec![self.identified.origin(), self.choice().to_owned()];
        if self.posterior.rejects == Some(true) {
            lines.push(
                "the data reject every robot made of bodies at 5 %: something is wrong that no parameters repair"
                    .to_owned(),
            );
        }
        lines.extend(self.moved_in_words());
        lines.extend(self.provenance_in_words());
        lines
    }

    /// Where the standard parameters come from, a sentence for each origin.
    pub(super) fn provenance_in_words(&self) -> Vec<String> {
        let table = self.posterior.set.parameter_table();
        let of = |wanted: Provenance| {
            let names = table.iter().zip(self.provenance()).filter(|(_, p)| **p == wanted).map(|(p, _)| p.name());
            names.collect::<Vec<_>>().join(" ")
        };
        let says = [
            (Provenance::Identified, "identified by themselves"),
            (Provenance::InPart, "decided by the recordings in part, by the a-priori robot otherwise"),
            (Provenance::InSums, "identified in sums with others alone, shared out as the a-priori values are"),
            (Provenance::Given, "given by the experiment"),
            (Provenance::Zero, "not in the identified model, zero"),
            (Provenance::APriori, "not identified, chosen near the a-priori values"),
        ];
        let named = says.into_iter().map(|(which, what)| (of(which), what)).filter(|(names, _)| !names.is_empty());
        named.map(|(names, what)| format!("{what}: {names}")).collect()
    }

    fn choice(&self) -> &'static str {
        match self.kept {
            Kept::AtEstimates => {
                "standard parameters: of the physically consistent sets with the estimated base parameters, the one nearest to \
                 the a-priori parameters (log-det)"
            }
            Kept::WithinIntervals => {
                "standard parameters: no robot made of bodies has the estimates; the physically consistent set nearest to them \
                 in the metric of their covariance, with the base parameters within their 95 % intervals"
            }
            Kept::ConsistentEstimate if self.identified.model.is_some() => "standard parameters: those of the model",
            Kept::ConsistentEstimate => "standard parameters: the consistent estimate of the results (physical = true)",
        }
    }

    fn moved_in_words(&self) -> Option<String> {
        if self.moved.is_empty() {
            return Some("every base parameter is at its estimate".to_owned());
        }
        let one = |m: &AdjustedParameter| {
            let far = m.deviations.map_or_else(String::new, |d| format!(" ({d:+.2} standard deviations)"));
            format!("{} {} instead of {} {}{far}", m.name, digits(m.exported), digits(m.estimate), m.unit)
        };
        let named: Vec<String> = self.moved.iter().take(NAMED).map(one).collect();
        let others = self.moved.len().saturating_sub(NAMED);
        let others = if others > 0 { format!(", and {others} others by less") } else { String::new() };
        Some(format!("base parameters that are not at their estimates: {}{others}", named.join(", ")))
    }
}

/// Four digits.
fn digits(value: f64) -> String {
    format!("{value:.3e}").parse().map_or_else(|_| value.to_string(), number)
}
