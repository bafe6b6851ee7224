//! What an experiment says of physical consistency: fixed and known values, and the a-priori parameters' weight.

use std::collections::BTreeMap;

use serde::Deserialize;

use super::error::PreparationError;
use thetahat_model::{
    consistency::{ConsistencyError, ConsistentSet, Known, completed_a_priori, require_interior},
    robot::Robot,
};

/// Something known of the robot, as from a data sheet: an entry of `[[parameters.known]]`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum KnownQuantity {
    /// The mass of all moving links together, kg.
    TotalMass {
        /// Its value or range.
        kg: ValueOrRange,
    },
    /// The mass of a link, kg.
    Mass {
        /// The link's number, as in the names of its parameters.
        link: usize,
        /// Its value or range.
        kg: ValueOrRange,
    },
    /// A standard parameter.
    Parameter {
        /// Name, as `fv3`.
        name: String,
        /// Its value or range, SI.
        value: ValueOrRange,
    },
    /// The centre of mass of a link lies in a box along the axes of its frame.
    CentreOfMass {
        /// The link's number.
        link: usize,
        /// The lower corner, m.
        lower_m: [f64; 3],
        /// The upper corner, m.
        upper_m: [f64; 3],
    },
    /// A link is symmetric about a plane through its frame's origin.
    MirrorPlane {
        /// The link's number.
        link: usize,
        /// The axis that is normal to the plane.
        normal: Axis,
    },
    /// A sum of standard parameters.
    Sum {
        /// Factors by name.
        terms: BTreeMap<String, f64>,
        /// Its value, SI.
        value: f64,
    },
}

/// A value, or a lower and an upper bound.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(untagged, expecting = "expected a number, or two in brackets: [lowest, highest]")]
pub enum ValueOrRange {
    /// A value.
    Value(f64),
    /// A lower and an upper bound.
    Range([f64; 2]),
}

/// An axis of a link's frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Axis {
    /// The first.
    X,
    /// The second.
    Y,
    /// The third: that of the joint.
    Z,
}

/// How the consistent estimate is drawn to the a-priori parameters.
#[derive(Debug, Clone, Copy, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PriorOptions {
    /// The distance from them.
    pub kind: PriorKind,
    /// Its weight.
    pub weight: PriorWeight,
}

/// A distance from the a-priori parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PriorKind {
    /// The log-det divergence of the pseudo-inertia matrices, without unit.
    #[default]
    LogDet,
    /// The squared difference of the inertial parameters in their SI units.
    Euclidean,
}

impl PriorKind {
    /// Its name in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::LogDet => "log-det",
            Self::Euclidean => "euclidean",
        }
    }
}

/// The weight of the distance, in variances of the error.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(untagged, expecting = "expected a number above zero, or \"cross-validation\"")]
pub enum PriorWeight {
    /// A number.
    Number(f64),
    /// By a rule.
    Rule(WeightRule),
}

/// How the weight is chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum WeightRule {
    /// The one that predicts best what is left out.
    CrossValidation,
}

/// Weight that keeps the estimate finite and is a weak prior: standard deviation 100 times the parameter.
const SMALL: f64 = 1e-3;

impl Default for PriorWeight {
    fn default() -> Self {
        Self::Number(SMALL)
    }
}

impl ValueOrRange {
    fn bounds(self) -> [f64; 2] {
        match self {
            Self::Value(value) => [value, value],
            Self::Range(range) => range,
        }
    }
}

impl KnownQuantity {
    /// As the consistent set takes it.
    #[must_use]
    pub fn known(&self) -> Known {
        let range = |parameter: String, value: ValueOrRange| match value {
            ValueOrRange::Value(value) => Known::Value { parameter, value },
            ValueOrRange::Range([lower, upper]) => Known::Range { parameter, lower, upper },
        };
        match self {
            Self::TotalMass { kg } => {
                let [lower, upper] = kg.bounds();
                Known::TotalMass { lower, upper }
            }
            Self::Mass { link, kg } => range(format!("m{link}"), *kg),
            Self::Parameter { name, value } => range(name.clone(), *value),
            Self::CentreOfMass { link, lower_m, upper_m } => {
                Known::CentreOfMass { link: *link, lower: *lower_m, upper: *upper_m }
            }
            Self::MirrorPlane { link, normal } => Known::MirrorPlane { link: *link, normal: *normal as usize },
            Self::Sum { terms, value } => {
                Known::Sum { terms: terms.iter().map(|(name, c)| (name.clone(), *c)).collect(), value: *value }
            }
        }
    }
}

impl KnownQuantity {
    /// The standard parameter that it gives a value.
    pub(crate) fn given(&self) -> Option<String> {
        match self {
            Self::Parameter { name, value: ValueOrRange::Value(_) } => Some(name.clone()),
            Self::Mass { link, kg: ValueOrRange::Value(_) } => Some(format!("m{link}")),
            Self::Parameter { .. }
            | Self::Mass { .. }
            | Self::TotalMass { .. }
            | Self::CentreOfMass { .. }
            | Self::MirrorPlane { .. }
            | Self::Sum { .. } => None,
        }
    }

    /// The standard parameters that it names.
    pub(crate) fn named(&self) -> Vec<String> {
        match self {
            Self::Parameter { name, .. } => vec![name.clone()],
            Self::Mass { link, .. } => vec![format!("m{link}")],
            Self::Sum { terms, .. } => terms.keys().cloned().collect(),
            Self::TotalMass { .. } | Self::CentreOfMass { .. } | Self::MirrorPlane { .. } => Vec::new(),
        }
    }
}

impl ValueOrRange {
    fn in_words(self) -> String {
        match self {
            Self::Value(value) => format!("= {value}"),
            Self::Range([low, high]) => format!("from {low} to {high}"),
        }
    }
}

impl KnownQuantity {
    /// As a report states it.
    fn in_words(&self) -> String {
        match self {
            Self::TotalMass { kg } => format!("total mass {} kg", kg.in_words()),
            Self::Mass { link, kg } => format!("m{link} {} kg", kg.in_words()),
            Self::Parameter { name, value } => format!("{name} {}", value.in_words()),
            Self::CentreOfMass { link, lower_m, upper_m } => {
                format!("centre of mass of link {link} from {lower_m:?} to {upper_m:?} m")
            }
            Self::MirrorPlane { link, normal } => {
                format!("link {link} symmetric about the plane normal to its {} axis", normal.name())
            }
            Self::Sum { terms, value } => {
                let terms: Vec<String> = terms.iter().map(|(name, c)| format!("{c} {name}")).collect();
                format!("{} = {value}", terms.join(" + "))
            }
        }
    }
}

impl Axis {
    fn name(self) -> char {
        match self {
            Self::X => 'x',
            Self::Y => 'y',
            Self::Z => 'z',
        }
    }
}

/// What is fixed or known, as a report states it.
pub(crate) fn known_in_words(fix: &BTreeMap<String, f64>, known: &[KnownQuantity]) -> Vec<String> {
    let fixed = fix.iter().map(|(name, value)| format!("{name} = {value} (fixed)"));
    fixed.chain(known.iter().map(KnownQuantity::in_words)).collect()
}

/// All that is fixed and known, each with its place in an experiment file.
pub(super) fn all_known<'a>(
    fix: &'a BTreeMap<String, f64>,
    known: &'a [KnownQuantity],
) -> impl Iterator<Item = (String, Known)> + 'a {
    let fixed = fix.iter().map(|(name, value)| {
        (format!("[parameters] fix.{name}"), Known::Value { parameter: name.clone(), value: *value })
    });
    let known = known.iter().enumerate().map(|(i, k)| (format!("[[parameters.known]] number {}", i + 1), k.known()));
    fixed.chain(known)
}

/// Refuses values of parameters and links that the robot does not have, and values that are physically impossible together.
pub(super) fn validate_known(
    robot: &Robot,
    fix: &BTreeMap<String, f64>,
    known: &[KnownQuantity],
) -> Result<(), PreparationError> {
    let refuse = |place: &str, e: &ConsistencyError| PreparationError::Consistency {
        place: place.to_owned(),
        source: e.clone(),
    };
    let a_priori = completed_a_priori(robot, None);
    let mut set = ConsistentSet::new(robot, &a_priori).map_err(|e| refuse("[parameters] physical", &e))?;
    for (place, known) in all_known(fix, known) {
        set = set.with_known(&known).map_err(|e| refuse(&place, &e))?;
    }
    require_interior(&set).map_err(|e| refuse("[parameters] fix and known", &e))
}
