use std::borrow::Cow;

use super::{
    joint::JointKind,
    quantity::{Friction, INERTIAL, JointQuantity, MotorQuantity, Quantity, TermQuantity},
    terms::TermColumn,
};

/// One standard parameter: a quantity and the number, from one, of its link, joint or motor.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Parameter {
    /// What it is.
    pub quantity: Quantity,
    /// Number of the link, joint or motor, from one.
    pub number: usize,
    /// Unit in SI.
    pub unit: Cow<'static, str>,
    /// Its own name, if it does not follow from quantity and number.
    pub own_name: Option<String>,
}

impl Parameter {
    /// Its name, such as `zz1` or `fcm6`.
    #[must_use]
    pub fn name(&self) -> String {
        self.own_name.clone().unwrap_or_else(|| format!("{}{}", self.quantity.name(), self.number))
    }
}

/// The standard parameters of a robot, in order: the paper's (2) joint by joint, then the coupled motors' parameters.
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
        let drive = [JointQuantity::Ia].iter().chain(friction.quantities()).chain(&[JointQuantity::Off]);
        let of_joint: Vec<Quantity> =
            INERTIAL.into_iter().map(Quantity::Link).chain(drive.copied().map(Quantity::Joint)).collect();
        let of_motor = MotorQuantity::ALL.map(Quantity::Motor);
        let entry = |quantity: Quantity, joint: usize| Parameter {
            quantity,
            number: joint + 1,
            unit: Cow::Borrowed(quantity.unit(kinds[joint])),
            own_name: None,
        };
        let joints = (0..kinds.len()).flat_map(|j| of_joint.iter().map(move |&quantity| (quantity, j)));
        let motors = coupled_motors.iter().flat_map(|&i| of_motor.iter().map(move |&quantity| (quantity, i)));
        Self { parameters: joints.chain(motors).map(|(quantity, j)| entry(quantity, j)).collect() }
    }

    /// The value of a quantity of a link, joint or motor, from zero, among standard parameters; zero if the robot does not have
    /// it.
    #[must_use]
    pub fn value(&self, parameters: &[f64], quantity: Quantity, place: usize) -> f64 {
        self.index(quantity, place).map_or(0.0, |i| parameters[i])
    }

    /// The table followed by the parameters of terms.
    #[must_use]
    pub fn with_terms(mut self, terms: &[TermColumn]) -> Self {
        let entry = |(column, term): (usize, &TermColumn)| Parameter {
            quantity: Quantity::Term(TermQuantity { column, role: term.role, bound: term.bound }),
            number: term.joint + 1,
            unit: Cow::Owned(term.unit.clone()),
            own_name: Some(term.parameter.clone()),
        };
        self.parameters.extend(terms.iter().enumerate().map(entry));
        self
    }

    /// The table without some parameters.
    pub(super) fn without(mut self, is_gone: impl Fn(&Parameter) -> bool) -> Self {
        self.parameters.retain(|parameter| !is_gone(parameter));
        self
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
    use super::{super::quantity::LinkQuantity, *};

    #[test]
    fn the_order_is_that_of_the_paper() {
        let table = ParameterTable::new(&[JointKind::Revolute; 2], Friction::Symmetric, &[1]);
        let names: Vec<String> = table.iter().map(Parameter::name).collect();
        let expected = "xx1 xy1 xz1 yy1 yz1 zz1 mx1 my1 mz1 m1 ia1 fv1 fc1 off1 \
                        xx2 xy2 xz2 yy2 yz2 zz2 mx2 my2 mz2 m2 ia2 fv2 fc2 off2 iam2 fvm2 fcm2";
        assert_eq!(names.join(" "), expected);
        assert_eq!(table.index_of("fcm2"), Some(30));
        assert_eq!(table.index(Quantity::Link(LinkQuantity::Zz), 1), Some(19));
    }

    #[test]
    fn units_follow_the_kind_of_joint() {
        let table = ParameterTable::new(&[JointKind::Prismatic], Friction::Asymmetric, &[]);
        let unit = |name| table.get(table.index_of(name).unwrap()).unit.to_string();
        assert_eq!([unit("fvp1"), unit("fcn1"), unit("ia1"), unit("zz1")], ["N s/m", "N", "kg", "kg m^2"]);
    }
}
