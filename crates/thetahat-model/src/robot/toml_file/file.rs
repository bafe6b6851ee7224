use std::collections::BTreeMap;

use serde::{Deserialize, de::IgnoredAny};
use toml::Spanned;

use crate::robot::{Friction, JointKind, TermDescription};
use thetahat_ground::one_or_each::{self, OneOrEach};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RobotFile {
    pub(super) name: Option<String>,
    /// Known here, so that it is no unknown key; read by [`super::urdf_of`].
    #[serde(rename = "urdf")]
    _urdf: Option<IgnoredAny>,
    #[serde(rename = "urdf_text")]
    _urdf_text: Option<IgnoredAny>,
    pub(super) convention: Option<Convention>,
    pub(super) gravity: Option<[f64; 3]>,
    pub(super) friction: Option<Friction>,
    #[serde(default)]
    pub(super) joint: Vec<Spanned<JointEntry>>,
    pub(super) transmission: Option<TransmissionEntry>,
    #[serde(default)]
    pub(super) term: Vec<TermDescription>,
    #[serde(default)]
    pub(super) parameters: BTreeMap<String, f64>,
    #[serde(default)]
    pub(super) locked: BTreeMap<String, f64>,
    #[serde(default, deserialize_with = "one_or_each::list")]
    pub(super) until: Vec<String>,
}

/// What the Denavit-Hartenberg numbers of a joint mean.
#[derive(Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Convention {
    /// Khalil and Kleinfinger: alpha and a come before the joint.
    #[default]
    Modified,
    /// Denavit and Hartenberg as in most data sheets: a and alpha come behind the joint.
    Standard,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct JointEntry {
    pub(super) name: String,
    pub(super) parent: Option<String>,
    pub(super) kind: JointKind,
    #[serde(default)]
    pub(super) gamma_deg: f64,
    #[serde(default)]
    pub(super) b_m: f64,
    #[serde(default)]
    pub(super) alpha_deg: f64,
    #[serde(default)]
    pub(super) a_m: f64,
    #[serde(default)]
    pub(super) theta_deg: f64,
    #[serde(default)]
    pub(super) d_m: f64,
    pub(super) mimic: Option<MimicEntry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MimicEntry {
    pub(super) joint: String,
    pub(super) ratio: f64,
    pub(super) offset_deg: Option<f64>,
    pub(super) offset_m: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TransmissionEntry {
    pub(super) matrix: Option<Spanned<Vec<Vec<f64>>>>,
    pub(super) offset_deg: Option<OneOrEach<f64>>,
    pub(super) offset_m: Option<OneOrEach<f64>>,
    pub(super) drive_gain: Option<OneOrEach<f64>>,
}
