//! Motor inertia, friction, offsets and coupled motors.

use super::{
    expression::Expression,
    joints::{Chain, Joint},
    newton_euler::Rates,
};
use thetahat_model::{
    dynamics::CoupledMotor,
    robot::{JointQuantity, MotorQuantity, ParameterTable, Quantity},
};

/// The drives of a robot with its parameters.
#[derive(Debug, Clone, Copy)]
pub(super) struct Drives<'a, 'g> {
    pub(super) chain: &'a Chain<'g>,
    pub(super) table: &'a ParameterTable,
    pub(super) motors: &'a [CoupledMotor],
    /// The standard parameters.
    pub(super) theta: &'a [Expression<'g>],
}

impl<'g> Drives<'_, 'g> {
    fn value(&self, quantity: Quantity, number: usize) -> Expression<'g> {
        self.table.index(quantity, number).map_or_else(|| self.chain.builder.zero(), |index| self.theta[index])
    }

    fn of_motor(&self, motor: &CoupledMotor) -> impl Fn(MotorQuantity) -> Expression<'g> {
        move |quantity| self.value(Quantity::Motor(quantity), motor.motor)
    }

    /// Inertia of the motor and the gears of a joint, in joint units.
    pub(super) fn motor_inertia(&self, joint: usize) -> Expression<'g> {
        self.value(Quantity::Joint(JointQuantity::Ia), joint)
    }

    /// Coordinates and the inertia between them, for each ordered pair of different coordinates of each coupled motor.
    pub(super) fn coupled_inertias(&self) -> impl Iterator<Item = (usize, usize, Expression<'g>)> {
        let of_motor = |motor: &CoupledMotor| {
            let inertia = self.of_motor(motor)(MotorQuantity::Iam);
            motor.cross_terms().map(|(i, j, weight)| (i, j, inertia * weight)).collect::<Vec<_>>()
        };
        self.motors.iter().flat_map(of_motor)
    }

    /// Adds the torques that accelerate the motors.
    pub(super) fn add_inertia(&self, rates: Rates<'_, 'g>, torques: &mut [Expression<'g>]) {
        for (j, joint) in self.chain.joints.iter().enumerate() {
            let torque = self.motor_inertia(j) * (rates.ddq[joint.coordinate] * joint.ratio) * joint.ratio;
            torques[joint.coordinate] = torques[joint.coordinate] + torque;
        }
        for (i, j, inertia) in self.coupled_inertias() {
            torques[i] = torques[i] + inertia * rates.ddq[j];
        }
    }

    /// Adds friction and offsets.
    pub(super) fn add_friction(&self, rates: Rates<'_, 'g>, torques: &mut [Expression<'g>]) {
        for (j, joint) in self.chain.joints.iter().enumerate() {
            let dq = rates.dq[joint.coordinate] * joint.ratio;
            let torque = self.joint_friction(j, dq) * joint.ratio;
            torques[joint.coordinate] = torques[joint.coordinate] + torque;
        }
        for motor in self.motors {
            self.add_motor_friction(motor, rates.dq, torques);
        }
    }

    /// Symmetric friction, or friction whose sides are selected by the sign of the velocity.
    fn joint_friction(&self, joint: usize, dq: Expression<'g>) -> Expression<'g> {
        let zero = self.chain.builder.zero();
        let [mut viscous, mut viscous_by_side, mut coulomb, mut constant] = [zero; 4];
        for parameter in self.table.iter().filter(|parameter| parameter.number == joint + 1) {
            let Quantity::Joint(quantity) = parameter.quantity else { continue };
            let value = self.value(parameter.quantity, joint);
            let half = value * 0.5;
            match quantity {
                JointQuantity::Ia => {}
                JointQuantity::Fv => viscous = viscous + value,
                JointQuantity::Fvp => (viscous, viscous_by_side) = (viscous + half, viscous_by_side + half),
                JointQuantity::Fvn => (viscous, viscous_by_side) = (viscous + half, viscous_by_side - half),
                JointQuantity::Fc => coulomb = coulomb + value,
                JointQuantity::Fcp => (coulomb, constant) = (coulomb + half, constant + half),
                JointQuantity::Fcn => (coulomb, constant) = (coulomb + half, constant - half),
                JointQuantity::Off => constant = constant + value,
            }
        }
        let sign = self.chain.joints[joint].sign(dq);
        (viscous + viscous_by_side * sign) * dq + (coulomb * sign + constant)
    }

    fn add_motor_friction(&self, motor: &CoupledMotor, dq: &[Expression<'g>], torques: &mut [Expression<'g>]) {
        let of = self.of_motor(motor);
        let zero = self.chain.builder.zero();
        let rate = motor.weights.iter().fold(zero, |sum, &(j, weight)| sum + dq[j] * weight);
        let coulomb = of(MotorQuantity::Fcm) * rate.sign();
        for &(j, weight) in &motor.weights {
            torques[j] = torques[j] + coulomb * weight;
        }
        for (i, j, weight) in motor.cross_terms() {
            torques[i] = torques[i] + of(MotorQuantity::Fvm) * weight * dq[j];
        }
    }

    /// The column of a parameter of the drives: the torque for a unit of it, coordinate by coordinate.
    pub(super) fn column(
        &self,
        quantity: Quantity,
        number: usize,
        rates: Rates<'_, 'g>,
    ) -> Vec<(usize, Expression<'g>)> {
        match quantity {
            Quantity::Joint(quantity) => {
                let joint = &self.chain.joints[number];
                vec![(joint.coordinate, joint_column(quantity, joint, rates))]
            }
            Quantity::Motor(quantity) => {
                let own = self.motors.iter().find(|motor| motor.motor == number);
                own.map(|motor| motor_column(quantity, motor, rates)).unwrap_or_default()
            }
            Quantity::Link(_) | Quantity::Term(_) => Vec::new(),
        }
    }
}

fn joint_column<'g>(quantity: JointQuantity, joint: &Joint<'g>, rates: Rates<'_, 'g>) -> Expression<'g> {
    let (c, ratio) = (joint.coordinate, joint.ratio);
    let (dq, ddq) = (rates.dq[c] * ratio, rates.ddq[c] * ratio);
    let (sign, one) = (joint.sign(dq), dq.builder().constant(1.0));
    let torque = match quantity {
        JointQuantity::Ia => ddq,
        JointQuantity::Fv => dq,
        JointQuantity::Fc => sign,
        JointQuantity::Fvp => (one + sign) * 0.5 * dq,
        JointQuantity::Fcp => (one + sign) * 0.5,
        JointQuantity::Fvn => (one - sign) * 0.5 * dq,
        JointQuantity::Fcn => (sign - one) * 0.5,
        JointQuantity::Off => one,
    };
    torque * ratio
}

fn motor_column<'g>(
    quantity: MotorQuantity,
    motor: &CoupledMotor,
    rates: Rates<'_, 'g>,
) -> Vec<(usize, Expression<'g>)> {
    let zero = rates.dq[0].builder().zero();
    let others = |own: usize, of: &[Expression<'g>]| {
        let others = motor.weights.iter().filter(|(j, _)| *j != own);
        others.fold(zero, |sum, &(j, weight)| sum + of[j] * weight)
    };
    let rate = motor.weights.iter().fold(zero, |sum, &(j, weight)| sum + rates.dq[j] * weight);
    let entry = |&(j, weight): &(usize, f64)| {
        let torque = match quantity {
            MotorQuantity::Iam => others(j, rates.ddq),
            MotorQuantity::Fvm => others(j, rates.dq),
            MotorQuantity::Fcm => rate.sign(),
        };
        (j, torque * weight)
    };
    motor.weights.iter().map(entry).collect()
}
