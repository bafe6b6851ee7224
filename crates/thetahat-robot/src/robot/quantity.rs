//! The table of standard parameters: their names, roles, units and sign bounds.
//!
//! A new torque term needs changes in two files: here its quantity, its row and its friction model; in `dynamics/terms.rs` its
//! torque.

use serde::Deserialize;

use super::joint::JointKind;

/// What a standard parameter is, in the order of the paper's (2), motor parameters last.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Quantity {
    /// Of the link as a rigid body.
    Link(LinkQuantity),
    /// Of a joint's drive: it acts only on that joint.
    Joint(JointQuantity),
    /// Of a coupled motor: it acts on the coordinates that move the motor.
    Motor(MotorQuantity),
    /// Of a torque term that the robot's description adds.
    Term(TermQuantity),
}

/// The parameter of a torque term.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct TermQuantity {
    /// Its column among the robot's terms, from zero.
    pub column: usize,
    /// What kind of torque it gives.
    pub role: Role,
    /// Its physical bound.
    pub bound: Bound,
}

/// Inertial parameters of a link: inertia about the origin of its axes, first moments, mass.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[expect(missing_docs, reason = "they are named as in the paper")]
pub enum LinkQuantity {
    Xx,
    Xy,
    Xz,
    Yy,
    Yz,
    Zz,
    Mx,
    My,
    Mz,
    M,
}

/// Parameters of one joint's drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum JointQuantity {
    /// Inertia of rotor and gears, seen at the joint.
    Ia,
    /// Viscous friction.
    Fv,
    /// Coulomb friction.
    Fc,
    /// Viscous friction for positive velocity.
    Fvp,
    /// Coulomb friction for positive velocity.
    Fcp,
    /// Viscous friction for negative velocity.
    Fvn,
    /// Coulomb friction for negative velocity.
    Fcn,
    /// Offset of the torque.
    Off,
}

/// Parameters of a coupled motor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum MotorQuantity {
    /// Inertia, acting through the cross terms of the coupling.
    Iam,
    /// Viscous friction, acting through the cross terms of the coupling.
    Fvm,
    /// Coulomb friction.
    Fcm,
}

/// The friction model of the joints.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Friction {
    /// `fv dq + fc sign(dq)`.
    #[default]
    Symmetric,
    /// `fvp dq + fcp` for positive velocity, `fvn dq - fcn` for negative velocity.
    Asymmetric,
}

/// What kind of torque a parameter gives.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Role {
    /// Inertia, first moment or mass of a link.
    Inertial,
    /// Inertia of a motor and its gears.
    MotorInertia,
    /// Friction that is continuous in the velocity.
    ViscousFriction,
    /// Friction that jumps where the velocity changes its sign.
    CoulombFriction,
    /// A torque other than inertia and friction, for example an offset.
    Load,
}

/// The physical bound of a parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Bound {
    /// Any.
    Free,
    /// Zero or more.
    NotNegative,
    /// Those of a rigid body, together with the other inertial parameters of its link.
    Body,
}

/// A row of the table.
struct Row {
    name: &'static str,
    role: Role,
    bound: Bound,
    unit: Unit,
}

/// Unit in SI for a revolute and for a prismatic joint.
struct Unit {
    revolute: &'static str,
    prismatic: &'static str,
}

const SECOND_MOMENT: Unit = Unit { revolute: "kg m^2", prismatic: "kg m^2" };
const FIRST_MOMENT: Unit = Unit { revolute: "kg m", prismatic: "kg m" };
const MASS: Unit = Unit { revolute: "kg", prismatic: "kg" };
const INERTIA: Unit = Unit { revolute: "kg m^2", prismatic: "kg" };
const DAMPING: Unit = Unit { revolute: "N m s/rad", prismatic: "N s/m" };
const UNKNOWN: Unit = Unit { revolute: "", prismatic: "" };
const TORQUE: Unit = Unit { revolute: "N m", prismatic: "N" };

/// The ten inertial parameters of a link, in order.
pub const INERTIAL: [LinkQuantity; 10] = {
    use LinkQuantity::{M, Mx, My, Mz, Xx, Xy, Xz, Yy, Yz, Zz};
    [Xx, Xy, Xz, Yy, Yz, Zz, Mx, My, Mz, M]
};

impl LinkQuantity {
    /// The name without its number, lower case.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.row().name
    }

    fn row(self) -> Row {
        let (name, unit) = match self {
            Self::Xx => ("xx", SECOND_MOMENT),
            Self::Xy => ("xy", SECOND_MOMENT),
            Self::Xz => ("xz", SECOND_MOMENT),
            Self::Yy => ("yy", SECOND_MOMENT),
            Self::Yz => ("yz", SECOND_MOMENT),
            Self::Zz => ("zz", SECOND_MOMENT),
            Self::Mx => ("mx", FIRST_MOMENT),
            Self::My => ("my", FIRST_MOMENT),
            Self::Mz => ("mz", FIRST_MOMENT),
            Self::M => ("m", MASS),
        };
        Row { name, role: Role::Inertial, bound: Bound::Body, unit }
    }
}

impl JointQuantity {
    /// The name without its number, lower case.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.row().name
    }

    /// The parameters that replace it in a friction model with separate values for each sign of the velocity.
    pub(super) fn sides(self) -> &'static [Self] {
        match self {
            Self::Fv => &[Self::Fvp, Self::Fvn],
            Self::Fc => &[Self::Fcp, Self::Fcn],
            Self::Ia | Self::Fvp | Self::Fcp | Self::Fvn | Self::Fcn | Self::Off => &[],
        }
    }

    fn row(self) -> Row {
        use Bound::{Free, NotNegative};
        use Role::{CoulombFriction, Load, MotorInertia, ViscousFriction};
        let (name, role, bound, unit) = match self {
            Self::Ia => ("ia", MotorInertia, NotNegative, INERTIA),
            Self::Fv => ("fv", ViscousFriction, NotNegative, DAMPING),
            Self::Fc => ("fc", CoulombFriction, NotNegative, TORQUE),
            Self::Fvp => ("fvp", ViscousFriction, NotNegative, DAMPING),
            Self::Fcp => ("fcp", CoulombFriction, NotNegative, TORQUE),
            Self::Fvn => ("fvn", ViscousFriction, NotNegative, DAMPING),
            Self::Fcn => ("fcn", CoulombFriction, NotNegative, TORQUE),
            Self::Off => ("off", Load, Free, TORQUE),
        };
        Row { name, role, bound, unit }
    }
}

impl MotorQuantity {
    /// Those of every coupled motor, in order.
    pub const ALL: [Self; 3] = [Self::Iam, Self::Fvm, Self::Fcm];

    fn row(self) -> Row {
        let (name, role, unit) = match self {
            Self::Iam => ("iam", Role::MotorInertia, INERTIA),
            Self::Fvm => ("fvm", Role::ViscousFriction, DAMPING),
            Self::Fcm => ("fcm", Role::CoulombFriction, TORQUE),
        };
        Row { name, role, bound: Bound::NotNegative, unit }
    }
}

impl Quantity {
    /// The name without its number, lower case; for a term, `term`: its parameter has its own name.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.row().name
    }

    /// What kind of torque it gives.
    #[must_use]
    pub fn role(self) -> Role {
        self.row().role
    }

    /// Its physical bound.
    #[must_use]
    pub fn bound(self) -> Bound {
        self.row().bound
    }

    /// Its unit in SI, for a joint of this kind; empty for a term, whose parameter has its own unit.
    #[must_use]
    pub fn unit(self, kind: JointKind) -> &'static str {
        let unit = self.row().unit;
        match kind {
            JointKind::Revolute => unit.revolute,
            JointKind::Prismatic => unit.prismatic,
        }
    }

    /// Whether it is one of the ten inertial parameters of a link.
    #[must_use]
    pub fn is_inertial(self) -> bool {
        self.role() == Role::Inertial
    }

    /// Whether it is an inertia of a motor.
    #[must_use]
    pub fn is_motor_inertia(self) -> bool {
        self.role() == Role::MotorInertia
    }

    /// Whether it is friction of any form.
    #[must_use]
    pub fn is_friction(self) -> bool {
        match self.role() {
            Role::ViscousFriction | Role::CoulombFriction => true,
            Role::Inertial | Role::MotorInertia | Role::Load => false,
        }
    }

    /// Whether it is friction that jumps where the velocity changes its sign.
    #[must_use]
    pub fn is_coulomb_friction(self) -> bool {
        self.role() == Role::CoulombFriction
    }

    /// Whether it belongs to a coupled motor, not to a link or joint.
    #[must_use]
    pub fn is_coupled_motor(self) -> bool {
        matches!(self, Self::Motor(_))
    }

    /// Whether it belongs to a torque term that the robot's description adds.
    #[must_use]
    pub fn is_term(self) -> bool {
        matches!(self, Self::Term(_))
    }

    fn row(self) -> Row {
        match self {
            Self::Link(quantity) => quantity.row(),
            Self::Joint(quantity) => quantity.row(),
            Self::Motor(quantity) => quantity.row(),
            Self::Term(TermQuantity { role, bound, .. }) => Row { name: "term", role, bound, unit: UNKNOWN },
        }
    }
}

impl Friction {
    /// Every model.
    pub const ALL: [Self; 2] = [Self::Symmetric, Self::Asymmetric];

    /// Its name in files and reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Symmetric => "symmetric",
            Self::Asymmetric => "asymmetric",
        }
    }

    /// Its parameters, in order.
    #[must_use]
    pub fn quantities(self) -> &'static [JointQuantity] {
        use JointQuantity::{Fc, Fcn, Fcp, Fv, Fvn, Fvp};
        match self {
            Self::Symmetric => &[Fv, Fc],
            Self::Asymmetric => &[Fvp, Fcp, Fvn, Fcn],
        }
    }
}
