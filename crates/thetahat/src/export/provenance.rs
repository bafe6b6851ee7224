//! Where exported standard parameters come from.

use crate::{
    experiment::IdentifiedRobot,
    preparation::{KnownQuantity, ParameterSelection},
};
use thetahat_model::{
    base_parameters::{BaseParameter, BaseParameters},
    robot::ParameterTable,
};
use thetahat_report::results::ParameterResult;

/// What the identification says of a standard parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Provenance {
    /// It is a base parameter by itself.
    Identified,
    /// The model's, decided by the recordings in part and by the a-priori robot otherwise.
    InPart,
    /// It is identified as part of a sum with others alone; the a-priori values say how the sum is shared out.
    InSums,
    /// The experiment gives its value.
    Given,
    /// It is not in the identified model, which has it at zero.
    Zero,
    /// No estimate holds it: its value is the a-priori one, changed only where the robot would not be physically possible.
    APriori,
}

impl Provenance {
    /// Its name in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Identified => "identified",
            Self::InPart => "in part",
            Self::InSums => "in sums",
            Self::Given => "given",
            Self::Zero => "zero",
            Self::APriori => "a priori",
        }
    }
}

/// A base parameter that is not exported with its estimate.
#[derive(Debug, Clone, PartialEq)]
pub struct AdjustedParameter {
    /// Its name.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// Its estimate.
    pub estimate: f64,
    /// What the exported standard parameters make of it.
    pub exported: f64,
    /// The difference in standard deviations; `None` if the results have none.
    pub deviations: Option<f64>,
}

/// Difference of a base parameter from its estimate that is rounding: relative to the estimate, in deviations, or relative to the
/// terms of one that has none.
const ROUNDING: f64 = 1e-6;

/// The provenance of each standard parameter, from the estimates and the given values.
pub(super) fn provenance(
    estimated: &BaseParameters,
    selection: &ParameterSelection,
    table: &ParameterTable,
    is_decided: impl Fn(&str) -> bool,
) -> Vec<Provenance> {
    let mut all = vec![Provenance::APriori; table.len()];
    for parameter in estimated.parameters() {
        let alone = if is_decided(&parameter.name) { Provenance::Identified } else { Provenance::InPart };
        all[parameter.kept] = if parameter.regrouped.is_empty() { alone } else { Provenance::InSums };
        parameter.regrouped.iter().for_each(|&(i, _)| all[i] = Provenance::InSums);
    }
    let mut set = |name: &str, to: Provenance| table.index_of(name).into_iter().for_each(|i| all[i] = to);
    selection.exclude.iter().for_each(|name| set(name, Provenance::Zero));
    let known = selection.known.iter().filter_map(KnownQuantity::given);
    selection.fix.keys().cloned().chain(known).for_each(|name| set(&name, Provenance::Given));
    all
}

/// The base parameters that standard parameters do not keep at their estimates, those moved most first. What was not
/// estimated is zero in the identified model.
pub(super) fn moved(identified: &IdentifiedRobot, standard: &[f64]) -> Vec<AdjustedParameter> {
    let (base, estimates) = (&identified.base, identified.estimates());
    let exported = base.from_standard(standard);
    let mut moved: Vec<AdjustedParameter> = Vec::new();
    for ((parameter, estimate), exported) in base.parameters().iter().zip(estimates).zip(exported) {
        let deviation = identified.run.parameter(&parameter.name).and_then(ParameterResult::deviation);
        let difference = exported - estimate;
        let usual = deviation.unwrap_or_else(|| size_of_terms(parameter, standard));
        if difference.abs() > ROUNDING * estimate.abs().max(usual) {
            moved.push(AdjustedParameter {
                name: parameter.name.clone(),
                unit: parameter.unit.to_string(),
                estimate,
                exported,
                deviations: deviation.filter(|d| *d > 0.0).map(|d| difference / d),
            });
        }
    }
    let size = |m: &AdjustedParameter| m.deviations.map_or(f64::INFINITY, f64::abs);
    moved.sort_by(|a, b| size(b).total_cmp(&size(a)));
    moved
}

fn size_of_terms(parameter: &BaseParameter, standard: &[f64]) -> f64 {
    standard[parameter.kept].abs() + parameter.regrouped.iter().map(|&(i, c)| (c * standard[i]).abs()).sum::<f64>()
}
