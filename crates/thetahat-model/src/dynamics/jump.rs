//! The velocities at whose change of sign Coulomb friction makes torques jump.

use super::model::Model;
use crate::robot::{MotorQuantity, Quantity, Role};

/// A velocity at whose change of sign torques jump: that of a joint, or of a coupled motor in joint units.
#[derive(Debug, Clone, PartialEq)]
pub struct Jump {
    /// The coordinates in the velocity, with their weights.
    pub velocity: Vec<(usize, f64)>,
    /// The coordinates whose torques jump.
    pub acts_on: Vec<usize>,
}

/// The jump of a joint's own friction: on the coordinate that moves it, or on all of those whose sum it follows.
fn of_joint(model: &Model, joint: usize) -> Jump {
    let shares: Vec<(usize, f64)> = model.shares_of(joint).collect();
    let acts_on = shares.iter().map(|(c, _)| *c).collect();
    match shares[..] {
        [(coordinate, _)] => Jump { velocity: vec![(coordinate, 1.0)], acts_on },
        _ => Jump { velocity: shares, acts_on },
    }
}

impl Jump {
    /// The velocity, rad/s or m/s.
    #[must_use]
    pub fn velocity(&self, dq: &[f64]) -> f64 {
        self.velocity.iter().map(|&(j, w)| w * dq[j]).sum()
    }

    /// The jumps of the Coulomb friction among parameters of a model's table, without duplicates.
    #[must_use]
    pub fn among(model: &Model, parameters: &[usize]) -> Vec<Self> {
        let table = model.parameter_table();
        let mut jumps: Vec<Self> = Vec::new();
        for parameter in parameters.iter().map(|&i| table.get(i)) {
            if parameter.quantity.role() != Role::CoulombFriction {
                continue;
            }
            let own = |j: usize| Self { velocity: vec![(j, 1.0)], acts_on: vec![j] };
            let jump = match parameter.quantity {
                Quantity::Link(_) => continue,
                Quantity::Joint(_) => of_joint(model, parameter.number - 1),
                Quantity::Term(term) => own(model.terms()[term.column].moved_by.coordinate),
                Quantity::Motor(MotorQuantity::Iam | MotorQuantity::Fvm | MotorQuantity::Fcm) => {
                    match model.coupled_motors().iter().find(|m| m.motor + 1 == parameter.number) {
                        Some(motor) => Self {
                            velocity: motor.weights.clone(),
                            acts_on: motor.weights.iter().map(|(j, _)| *j).collect(),
                        },
                        None => continue,
                    }
                }
            };
            if !jumps.contains(&jump) {
                jumps.push(jump);
            }
        }
        jumps
    }
}
