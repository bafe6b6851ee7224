use serde::{Deserialize, Serialize};

/// One `[[term]]` of a robot or experiment file.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum TermDescription {
    /// `k (q - rest)`.
    JointSpring {
        /// The joints; all if none is named.
        joints: Option<Vec<String>>,
        /// The angle without torque of a revolute joint; it is estimated if not given.
        rest_deg: Option<f64>,
        /// The position without torque of a prismatic joint.
        rest_m: Option<f64>,
    },
    /// `fs s exp(-|dq / vs|^delta)`.
    ExponentialStribeck {
        /// The joints; all if none is named.
        joints: Option<Vec<String>>,
        /// `vs`, rad/s or m/s.
        velocity: f64,
        /// `delta`.
        #[serde(default = "two")]
        exponent: f64,
        /// Whether `vs` and `delta` are searched.
        #[serde(default)]
        profile: bool,
    },
    /// `fs s / (1 + |dq / vs|^delta)`.
    Stribeck {
        /// The joints; all if none is named.
        joints: Option<Vec<String>>,
        /// `vs`, rad/s or m/s.
        velocity: f64,
        /// `delta`.
        #[serde(default = "two")]
        exponent: f64,
        /// Whether `vs` and `delta` are searched.
        #[serde(default)]
        profile: bool,
    },
    /// `fvq s |dq|^2`, `fvc s |dq|^3`.
    PolynomialViscous {
        /// The joints; all if none is named.
        joints: Option<Vec<String>>,
        /// The powers, 2 and 3.
        #[serde(default = "square")]
        powers: Vec<u8>,
    },
    /// `fva s dq`: viscous friction that differs with the direction.
    AsymmetricViscous {
        /// The joints; all if none is named.
        joints: Option<Vec<String>>,
    },
    /// `fl s |gravity torque|`.
    LoadFriction {
        /// The joints; all if none is named.
        joints: Option<Vec<String>>,
    },
    /// `fc_CHANNEL s (value - reference)`.
    ChannelCoulomb {
        /// The joints; all if none is named.
        joints: Option<Vec<String>>,
        /// The recorded channel.
        channel: String,
        /// The value at which the term is zero.
        reference: f64,
    },
    /// `fv_CHANNEL dq (value - reference)`.
    ChannelViscous {
        /// The joints; all if none is named.
        joints: Option<Vec<String>>,
        /// The recorded channel.
        channel: String,
        /// The value at which the term is zero.
        reference: f64,
    },
    /// `hs sin(k motor angle) + hc cos(k motor angle)` for each k.
    MotorHarmonics {
        /// The joints whose motors are meant; all if none is named.
        joints: Option<Vec<String>>,
        /// The multiples k.
        harmonics: Vec<f64>,
    },
    /// A linear spring between two points.
    Spring {
        /// Its name.
        name: String,
        /// One end.
        from: PointDescription,
        /// The other.
        to: PointDescription,
        /// Length without force; if not given, the preload is estimated as well.
        free_length_m: Option<f64>,
    },
    /// A gas spring between two points: it pushes with a constant force, and with a stiffness if its length is given.
    GasSpring {
        /// Its name.
        name: String,
        /// One end.
        from: PointDescription,
        /// The other.
        to: PointDescription,
        /// Length at which it pushes with only the constant force.
        extended_length_m: Option<f64>,
    },
    /// A cylinder between two points, connected to a gas accumulator: a counterbalance.
    Hydraulic {
        /// Its name.
        name: String,
        /// One end.
        from: PointDescription,
        /// The other.
        to: PointDescription,
        /// Whether it pulls the points together or pushes them apart.
        direction: Direction,
        /// Length at which the force is the parameter.
        length_m: f64,
        /// Volume of the gas at that length over the area of the piston.
        gas_length_m: f64,
        /// The polytropic exponent; if not given, the force is affine in the length.
        exponent: Option<f64>,
    },
    /// A user-defined column.
    Expression {
        /// Name of the parameter.
        name: String,
        /// The joint on which it acts.
        joint: String,
        /// The torque for a unit of the parameter.
        expression: String,
        /// Unit of the parameter.
        #[serde(default)]
        unit: String,
        /// Whether the parameter is physically nonnegative.
        #[serde(default)]
        not_negative: bool,
    },
}

/// A point of a link.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct PointDescription {
    /// The link's joint; none for the base.
    pub link_of: Option<String>,
    /// The point in the link's frame.
    pub point_m: [f64; 3],
}

/// The direction of a cylinder's force.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Direction {
    /// It pulls the points together.
    Pull,
    /// It pushes them apart.
    Push,
}

fn two() -> f64 {
    2.0
}

fn square() -> Vec<u8> {
    vec![2]
}

impl TermDescription {
    /// Its kind, as in files.
    #[must_use]
    pub fn kind(&self) -> &'static str {
        match self {
            Self::JointSpring { .. } => "joint-spring",
            Self::ExponentialStribeck { .. } => "exponential-stribeck",
            Self::Stribeck { .. } => "stribeck",
            Self::PolynomialViscous { .. } => "polynomial-viscous",
            Self::AsymmetricViscous { .. } => "asymmetric-viscous",
            Self::LoadFriction { .. } => "load-friction",
            Self::ChannelCoulomb { .. } => "channel-coulomb",
            Self::ChannelViscous { .. } => "channel-viscous",
            Self::MotorHarmonics { .. } => "motor-harmonics",
            Self::Spring { .. } => "spring",
            Self::GasSpring { .. } => "gas-spring",
            Self::Hydraulic { .. } => "hydraulic",
            Self::Expression { .. } => "expression",
        }
    }

    /// The term with other constants, if it is Stribeck friction.
    #[must_use]
    pub fn with_constants(mut self, vs: f64, delta: f64) -> Self {
        if let Self::ExponentialStribeck { velocity, exponent, profile, .. }
        | Self::Stribeck { velocity, exponent, profile, .. } = &mut self
        {
            (*velocity, *exponent, *profile) = (vs, delta, false);
        }
        self
    }

    /// The term on one joint only, if it is a term of joints.
    #[must_use]
    pub fn on_joint(mut self, name: &str) -> Self {
        if let Some(joints) = self.joints_mut() {
            *joints = Some(vec![name.to_owned()]);
        }
        self
    }

    /// Whether its constants are to be searched.
    #[must_use]
    pub fn is_profiled(&self) -> bool {
        matches!(self, Self::ExponentialStribeck { profile: true, .. } | Self::Stribeck { profile: true, .. })
    }

    /// The `[[term]]` of a file.
    #[must_use]
    pub fn to_toml(&self) -> String {
        #[derive(Serialize)]
        struct File<'a> {
            term: [&'a TermDescription; 1],
        }
        toml::to_string(&File { term: [self] }).unwrap_or_default()
    }

    /// The term without the joints for which `is_gone` holds; none if it acts on no other.
    pub(in crate::robot) fn without_joints(mut self, is_gone: &dyn Fn(&str) -> bool) -> Option<Self> {
        if let Self::Expression { joint, .. } = &self {
            return (!is_gone(joint)).then_some(self);
        }
        let Some(joints) = self.joints_mut().and_then(Option::as_mut) else { return Some(self) };
        joints.retain(|joint| !is_gone(joint));
        (!joints.is_empty()).then_some(self)
    }

    /// The joints that it names, if it is a term of joints.
    fn joints_mut(&mut self) -> Option<&mut Option<Vec<String>>> {
        match self {
            Self::JointSpring { joints, .. }
            | Self::ExponentialStribeck { joints, .. }
            | Self::Stribeck { joints, .. }
            | Self::PolynomialViscous { joints, .. }
            | Self::AsymmetricViscous { joints }
            | Self::LoadFriction { joints }
            | Self::ChannelCoulomb { joints, .. }
            | Self::ChannelViscous { joints, .. }
            | Self::MotorHarmonics { joints, .. } => Some(joints),
            Self::Expression { .. } | Self::Spring { .. } | Self::GasSpring { .. } | Self::Hydraulic { .. } => None,
        }
    }

    /// Its two points, if it acts between points.
    pub(in crate::robot) fn points_mut(&mut self) -> Option<[&mut PointDescription; 2]> {
        match self {
            Self::Spring { from, to, .. } | Self::GasSpring { from, to, .. } | Self::Hydraulic { from, to, .. } => {
                Some([from, to])
            }
            Self::JointSpring { .. }
            | Self::ExponentialStribeck { .. }
            | Self::Stribeck { .. }
            | Self::PolynomialViscous { .. }
            | Self::AsymmetricViscous { .. }
            | Self::LoadFriction { .. }
            | Self::ChannelCoulomb { .. }
            | Self::ChannelViscous { .. }
            | Self::MotorHarmonics { .. }
            | Self::Expression { .. } => None,
        }
    }

    /// Whether its parameter has its own name, not one with the number of its joint.
    pub(in crate::robot) fn has_own_name(&self) -> bool {
        match self {
            Self::Spring { .. } | Self::GasSpring { .. } | Self::Hydraulic { .. } | Self::Expression { .. } => true,
            Self::JointSpring { .. }
            | Self::ExponentialStribeck { .. }
            | Self::Stribeck { .. }
            | Self::PolynomialViscous { .. }
            | Self::AsymmetricViscous { .. }
            | Self::LoadFriction { .. }
            | Self::ChannelCoulomb { .. }
            | Self::ChannelViscous { .. }
            | Self::MotorHarmonics { .. } => false,
        }
    }

    /// The joints that it names; none if it names none.
    #[doc(hidden)]
    #[must_use]
    pub fn joints(&self) -> Option<&[String]> {
        match self {
            Self::JointSpring { joints, .. }
            | Self::ExponentialStribeck { joints, .. }
            | Self::Stribeck { joints, .. }
            | Self::PolynomialViscous { joints, .. }
            | Self::AsymmetricViscous { joints }
            | Self::LoadFriction { joints }
            | Self::ChannelCoulomb { joints, .. }
            | Self::ChannelViscous { joints, .. }
            | Self::MotorHarmonics { joints, .. } => joints.as_deref(),
            Self::Spring { .. } | Self::GasSpring { .. } | Self::Hydraulic { .. } => None,
            Self::Expression { joint, .. } => Some(std::slice::from_ref(joint)),
        }
    }
}
