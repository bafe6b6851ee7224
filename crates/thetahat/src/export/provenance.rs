//! Where exported standard parameters come from.

use super::posterior::Posterior;

/// What the identification says of a standard parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Provenance {
    /// It is a base parameter by itself.
    Identified,
    /// It is identified as part of a sum with others alone; the a-priori values say how the sum is shared out.
    InSums,
    /// No estimate holds it: its value is the a-priori one, as far as the robot is one of bodies, or zero.
    APriori,
}

impl Provenance {
    /// Its name in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Identified => "identified",
            Self::InSums => "in sums",
            Self::APriori => "a priori",
        }
    }
}

/// A base parameter that is not exported with its estimate.
#[derive(Debug, Clone, PartialEq)]
pub struct MovedParameter {
    /// Its name.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// Its estimate.
    pub estimate: f64,
    /// What the exported standard parameters make of it.
    pub exported: f64,
    /// The difference in standard deviations; none where the results hold none.
    pub deviations: Option<f64>,
}

/// Difference of a base parameter from its estimate, relative to the estimate or in deviations, that is rounding.
const ROUNDING: f64 = 1e-6;

/// Of each standard parameter.
pub(super) fn provenance(posterior: &Posterior) -> Vec<Provenance> {
    let mut all: Vec<Provenance> = vec![Provenance::APriori; posterior.set.parameter_table().len()];
    for parameter in posterior.base.parameters() {
        let alone = parameter.regrouped.is_empty();
        all[parameter.kept] = if alone { Provenance::Identified } else { Provenance::InSums };
        parameter.regrouped.iter().for_each(|&(i, _)| all[i] = Provenance::InSums);
    }
    all
}

/// The base parameters that standard parameters do not keep at their estimates, those moved most first.
pub(super) fn moved(posterior: &Posterior, standard: &[f64]) -> Vec<MovedParameter> {
    let exported = posterior.base.from_standard(standard);
    let mut moved: Vec<MovedParameter> = Vec::new();
    for (i, parameter) in posterior.base.parameters().iter().enumerate() {
        let (estimate, deviation) = (posterior.estimate[i], posterior.deviation[i]);
        let difference = exported[i] - estimate;
        if difference.abs() > ROUNDING * estimate.abs().max(deviation.unwrap_or(0.0)) {
            moved.push(MovedParameter {
                name: parameter.name.clone(),
                unit: parameter.unit.to_string(),
                estimate,
                exported: exported[i],
                deviations: deviation.filter(|d| *d > 0.0).map(|d| difference / d),
            });
        }
    }
    let size = |m: &MovedParameter| m.deviations.map_or(f64::INFINITY, f64::abs);
    moved.sort_by(|a, b| size(b).total_cmp(&size(a)));
    moved
}
