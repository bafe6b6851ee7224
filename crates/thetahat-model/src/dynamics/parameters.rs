use pulp::Simd;

use super::{
    inertial::Inertial,
    model::{DynamicsError, Model},
    terms::{JointTerms, MotorTerms, OtherTerm},
};
use crate::robot::Quantity;
use thetahat_ground::real::Lanes;

/// A vector of standard parameters, arranged for the kernels; or one in each lane.
#[derive(Debug, Clone)]
pub struct DynamicParameters<P = f64> {
    pub(super) links: Vec<Inertial<P>>,
    pub(super) joints: Vec<JointTerms<P>>,
    /// Further terms of the joints, joint by joint.
    pub(super) others: Vec<OtherTerm<P>>,
    pub(super) motors: Vec<MotorTerms<P>>,
    /// The parameters of the robot's terms, column by column.
    pub(super) terms: Vec<P>,
}

impl DynamicParameters {
    /// Sorts the standard parameters `theta`, in the order of the model's table, and rotates each link's inertial
    /// parameters into the axes of its joint's frame.
    ///
    /// # Errors
    /// [`DynamicsError::ParameterCount`] if there is not one value for each standard parameter.
    pub fn new(model: &Model, theta: &[f64]) -> Result<Self, DynamicsError> {
        let (expected, found) = (model.parameter_table().len(), theta.len());
        if found != expected {
            return Err(DynamicsError::ParameterCount { expected, found });
        }
        Ok(Self::sorted(model, theta))
    }

    /// The same of values that are known to be one for each standard parameter.
    ///
    /// # Panics
    /// If they are not.
    #[doc(hidden)]
    #[must_use]
    pub fn sorted(model: &Model, theta: &[f64]) -> Self {
        let (table, links) = (model.parameter_table(), model.link_count());
        assert_eq!(table.len(), theta.len(), "one value for each standard parameter");
        let mut inertial = vec![[0.0; 10]; links];
        let mut joints = vec![JointTerms::default(); links];
        let mut motors = vec![MotorTerms::default(); model.coupled_motors().len()];
        let (mut others, mut terms) = (Vec::new(), vec![0.0; model.terms().len()]);
        for (parameter, &value) in table.iter().zip(theta) {
            let own = parameter.number - 1;
            match parameter.quantity {
                Quantity::Link(quantity) => inertial[own][quantity as usize] = value,
                Quantity::Joint(quantity) => {
                    let other = joints[own].insert(quantity, value);
                    others.extend(other.map(|quantity| OtherTerm { joint: own, quantity, value }));
                }
                Quantity::Motor(quantity) => {
                    let of_number = model.coupled_motors().iter().zip(&mut motors).filter(|(m, _)| m.motor == own);
                    of_number.for_each(|(_, terms)| terms.insert(quantity, value));
                }
                Quantity::Term(quantity) => terms[quantity.column] = value,
            }
        }
        let link = |(k, inertial)| Inertial::from_vector(inertial).in_joint_axes(model.link_axes(k));
        Self { links: inertial.into_iter().enumerate().map(link).collect(), joints, others, motors, terms }
    }
}

impl<S: Simd> DynamicParameters<Lanes<S>> {
    /// Combines the parameters of all lanes, which must belong to the same model.
    #[inline(always)]
    #[doc(hidden)]
    pub fn side_by_side<'a>(simd: S, of_lane: impl Fn(usize) -> &'a DynamicParameters) -> Self {
        let lanes = |value: &dyn Fn(&DynamicParameters) -> f64| Lanes::from_fn(simd, |lane| value(of_lane(lane)));
        let link = |k: usize| Inertial::from_numbers(|number| lanes(&|p| number(&p.links[k])));
        let joint = |k: usize| JointTerms::from_numbers(|number| lanes(&|p| number(&p.joints[k])));
        let motor = |k: usize| MotorTerms::from_numbers(|number| lanes(&|p| number(&p.motors[k])));
        let first = of_lane(0);
        let other = |(k, &OtherTerm { joint, quantity, .. }): (usize, &OtherTerm)| {
            let value = lanes(&|p| p.others[k].value);
            OtherTerm { joint, quantity, value }
        };
        Self {
            links: (0..first.links.len()).map(link).collect(),
            joints: (0..first.joints.len()).map(joint).collect(),
            others: first.others.iter().enumerate().map(other).collect(),
            motors: (0..first.motors.len()).map(motor).collect(),
            terms: (0..first.terms.len()).map(|k| lanes(&|p| p.terms[k])).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::{super::Sign, *};
    use crate::{
        dynamics::{State, Workspace},
        robot::{Friction, Robot, Role},
    };

    const FOLLOWER: &str = "name = \"follower\"\n\
        [[joint]]\nname = \"a\"\nkind = \"revolute\"\n\
        [[joint]]\nname = \"b\"\nkind = \"prismatic\"\na_m = 0.5\nalpha_deg = 90\nmimic = { joint = \"a\", ratio = -1.5 }\n\
        [[joint]]\nname = \"c\"\nkind = \"revolute\"\na_m = 0.4\n";

    fn torques(model: &Model, parameters: &DynamicParameters) -> [f64; 2] {
        let state = State::new(&[0.3, -0.7], &[1.1, -0.4]);
        let mut tau = [0.0; 2];
        let sign = Sign::smooth(0.5);
        model.inverse_dynamics(parameters, state, &[2.0, 3.0], sign, &mut Workspace::new(model), &mut tau);
        tau
    }

    #[test]
    fn a_value_for_each_standard_parameter_is_taken() {
        let model = Model::new(&Robot::parse(FOLLOWER, Path::new("follower.toml")).unwrap());
        assert!(DynamicParameters::new(&model, &vec![1.0; model.parameter_table().len()]).is_ok());
    }

    #[test]
    fn a_wrong_number_of_values_is_a_parameter_count() {
        let model = Model::new(&Robot::parse(FOLLOWER, Path::new("follower.toml")).unwrap());
        let expected = model.parameter_table().len();
        let error = DynamicParameters::new(&model, &[1.0]).map(drop).unwrap_err();
        assert_eq!(error, DynamicsError::ParameterCount { expected, found: 1 });
    }

    /// Friction taken together and friction summed by its columns are the same torques.
    #[test]
    fn a_term_may_be_summed_by_its_column() {
        for friction in Friction::ALL {
            let mut robot = Robot::parse(FOLLOWER, Path::new("follower.toml")).unwrap();
            robot.friction = friction;
            let model = Model::new(&robot);
            let mut theta: Vec<f64> = (0..model.parameter_table().len()).map(|i| (1.7 * i as f64).sin()).collect();
            let together = torques(&model, &DynamicParameters::sorted(&model, &theta));
            let mut others = Vec::new();
            for (parameter, value) in model.parameter_table().iter().zip(&mut theta) {
                let Quantity::Joint(quantity) = parameter.quantity else { continue };
                if parameter.quantity.role() != Role::MotorInertia {
                    let value = std::mem::take(value);
                    others.push(OtherTerm { joint: parameter.number - 1, quantity, value });
                }
            }
            let mut parameters = DynamicParameters::sorted(&model, &theta);
            parameters.others = others;
            for (found, expected) in torques(&model, &parameters).iter().zip(together) {
                assert!((found - expected).abs() < 1e-13, "{friction:?}: {found} {expected}");
            }
            let lanes = DynamicParameters::side_by_side(pulp::Scalar::new(), |_| &parameters);
            for (lane, own) in lanes.others.iter().zip(&parameters.others) {
                assert_eq!((lane.joint, lane.quantity, lane.value.to_array()[0]), (own.joint, own.quantity, own.value));
            }
        }
    }
}
