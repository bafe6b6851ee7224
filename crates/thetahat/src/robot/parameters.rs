use serde::Deserialize;

use super::JointKind;

/// What a standard parameter is, in the order of the paper's (2), motor parameters last.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[allow(missing_docs)]
pub enum Quantity {
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
    /// Inertia of a coupled motor, acting through the cross terms of the coupling.
    Iam,
    /// Viscous friction of a coupled motor, acting through the cross terms of the coupling.
    Fvm,
    /// Coulomb friction of a coupled motor.
    Fcm,
}

/// The ten inertial parameters of a link: inertia about the frame's origin, first moments, mass.
pub const INERTIAL: [Quantity; 10] = {
    use Quantity::{M, Mx, My, Mz, Xx, Xy, Xz, Yy, Yz, Zz};
    [Xx, Xy, Xz, Yy, Yz, Zz, Mx, My, Mz, M]
};

const SYMMETRIC_FRICTION: [Quantity; 2] = [Quantity::Fv, Quantity::Fc];
const ASYMMETRIC_FRICTION: [Quantity; 4] = [Quantity::Fvp, Quantity::Fcp, Quantity::Fvn, Quantity::Fcn];
const COUPLED_MOTOR: [Quantity; 3] = [Quantity::Iam, Quantity::Fvm, Quantity::Fcm];

impl Quantity {
    /// The name without its number, lower case.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Xx => "xx",
            Self::Xy => "xy",
            Self::Xz => "xz",
            Self::Yy => "yy",
            Self::Yz => "yz",
            Self::Zz => "zz",
            Self::Mx => "mx",
            Self::My => "my",
            Self::Mz => "mz",
            Self::M => "m",
            Self::Ia => "ia",
            Self::Fv => "fv",
            Self::Fc => "fc",
            Self::Fvp => "fvp",
            Self::Fcp => "fcp",
            Self::Fvn => "fvn",
            Self::Fcn => "fcn",
            Self::Off => "off",
            Self::Iam => "iam",
            Self::Fvm => "fvm",
            Self::Fcm => "fcm",
        }
    }

    /// Whether it is one of the ten inertial parameters of a link.
    #[must_use]
    pub fn is_inertial(self) -> bool {
        INERTIAL.contains(&self)
    }

    /// Whether it is an inertia of a motor.
    #[must_use]
    pub fn is_motor_inertia(self) -> bool {
        matches!(self, Self::Ia | Self::Iam)
    }

    /// Whether it is viscous or Coulomb friction.
    #[must_use]
    pub fn is_friction(self) -> bool {
        SYMMETRIC_FRICTION.contains(&self)
            || ASYMMETRIC_FRICTION.contains(&self)
            || matches!(self, Self::Fvm | Self::Fcm)
    }

    /// Whether it belongs to a coupled motor, not to a link or joint.
    #[must_use]
    pub fn is_coupled_motor(self) -> bool {
        COUPLED_MOTOR.contains(&self)
    }

    fn unit(self, kind: JointKind) -> &'static str {
        let revolute = kind == JointKind::Revolute;
        match self {
            Self::M => "kg",
            Self::Mx | Self::My | Self::Mz => "kg m",
            Self::Ia | Self::Iam if !revolute => "kg",
            Self::Fv | Self::Fvp | Self::Fvn | Self::Fvm if revolute => "N m s/rad",
            Self::Fv | Self::Fvp | Self::Fvn | Self::Fvm => "N s/m",
            Self::Fc | Self::Fcp | Self::Fcn | Self::Fcm | Self::Off if revolute => "N m",
            Self::Fc | Self::Fcp | Self::Fcn | Self::Fcm | Self::Off => "N",
            _ => "kg m^2",
        }
    }
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

/// One standard parameter: a quantity and the number, from one, of its link, joint or motor.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Parameter {
    /// What it is.
    pub quantity: Quantity,
    /// Number of the link, joint or motor, from one.
    pub number: usize,
    /// Unit in SI.
    pub unit: &'static str,
}

impl Parameter {
    /// Its name, such as `zz1` or `fcm6`.
    #[must_use]
    pub fn name(&self) -> String {
        format!("{}{}", self.quantity.name(), self.number)
    }
}

/// The standard parameters of a robot, in order: the paper's (2) joint by joint, then those of the coupled motors.
///
/// Every vector of standard parameters in this library has this order.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ParameterTable {
    parameters: Vec<Parameter>,
}

impl ParameterTable {
    /// The table for joints of the given kinds, with `coupled_motors` numbered from zero.
    #[must_use]
    pub fn new(kinds: &[JointKind], friction: Friction, coupled_motors: &[usize]) -> Self {
        let joint_friction: &[Quantity] = match friction {
            Friction::Symmetric => &SYMMETRIC_FRICTION,
            Friction::Asymmetric => &ASYMMETRIC_FRICTION,
        };
        let of_joint: Vec<Quantity> = INERTIAL
            .into_iter()
            .chain([Quantity::Ia])
            .chain(joint_friction.iter().copied())
            .chain([Quantity::Off])
            .collect();
        let entry = |quantity: Quantity, joint: usize| Parameter {
            quantity,
            number: joint + 1,
            unit: quantity.unit(kinds[joint]),
        };
        let joints = (0..kinds.len()).flat_map(|j| of_joint.iter().map(move |&quantity| (quantity, j)));
        let motors = coupled_motors.iter().flat_map(|&i| COUPLED_MOTOR.iter().map(move |&quantity| (quantity, i)));
        Self { parameters: joints.chain(motors).map(|(quantity, j)| entry(quantity, j)).collect() }
    }

    /// Number of parameters.
    #[must_use]
    pub fn len(&self) -> usize {
        self.parameters.len()
    }

    /// Whether the table is empty.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.parameters.is_empty()
    }

    /// The parameters in order.
    pub fn iter(&self) -> std::slice::Iter<'_, Parameter> {
        self.parameters.iter()
    }

    /// The parameter at `index`.
    #[must_use]
    pub fn get(&self, index: usize) -> &Parameter {
        &self.parameters[index]
    }

    /// The index of a parameter by its name.
    #[must_use]
    pub fn index_of(&self, name: &str) -> Option<usize> {
        self.parameters.iter().position(|p| p.name() == name)
    }

    /// The index of a quantity of joint or motor `joint` (from zero).
    #[must_use]
    pub fn index(&self, quantity: Quantity, joint: usize) -> Option<usize> {
        self.parameters.iter().position(|p| p.quantity == quantity && p.number == joint + 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_order_is_that_of_the_paper() {
        let table = ParameterTable::new(&[JointKind::Revolute; 2], Friction::Symmetric, &[1]);
        let names: Vec<String> = table.iter().map(Parameter::name).collect();
        let expected = "xx1 xy1 xz1 yy1 yz1 zz1 mx1 my1 mz1 m1 ia1 fv1 fc1 off1 \
                        xx2 xy2 xz2 yy2 yz2 zz2 mx2 my2 mz2 m2 ia2 fv2 fc2 off2 iam2 fvm2 fcm2";
        assert_eq!(names.join(" "), expected);
        assert_eq!(table.index_of("fcm2"), Some(30));
        assert_eq!(table.index(Quantity::Zz, 1), Some(19));
    }

    #[test]
    fn units_follow_the_kind_of_joint() {
        let table = ParameterTable::new(&[JointKind::Prismatic], Friction::Asymmetric, &[]);
        let unit = |name| table.get(table.index_of(name).unwrap()).unit;
        assert_eq!((unit("fvp1"), unit("fcn1"), unit("ia1"), unit("zz1")), ("N s/m", "N", "kg", "kg m^2"));
    }
}
