//! The torques of the drives: motor inertia, friction, offset, and other terms that act on one joint or one coupled motor.
//!
//! The torque of a term for a unit of its parameter is defined only in [`JointState::unit_torque`] and [`CoupledMotor::unit_torque`],
//! the columns of the regressor. Inverse dynamics sums these columns. It combines the terms of the usual friction models
//! ([`JointTerms`]), which takes fewer operations for the same sum; a term that [`JointTerms::insert`] rejects is summed by its
//! column, and must not depend on the acceleration, because the mass matrix contains only the motor inertia.

use super::{
    coupled_motor::CoupledMotor,
    sign::Sign,
    state::{JointCoordinate, State},
};
use crate::robot::{JointKind, JointQuantity, MotorQuantity};
use thetahat_ground::real::{Parameter, Real};

/// The state on which the torque of a joint's drive depends.
#[derive(Debug, Clone, Copy)]
pub(crate) struct JointState<T> {
    /// The joint's velocity.
    dq: T,
    /// Its acceleration.
    ddq: T,
    /// The sign of its velocity, exact or smooth.
    s: T,
}

impl JointCoordinate {
    /// The joint's own state.
    #[inline(always)]
    pub(crate) fn state<T: Real>(&self, state: State<'_, T>, ddq: &[T], sign: Sign) -> JointState<T> {
        JointState::new(self.rate(state.dq), self.rate(ddq), (sign, self.kind))
    }
}

impl<T: Real> JointState<T> {
    #[inline(always)]
    pub(super) fn new(dq: T, ddq: T, (sign, kind): (Sign, JointKind)) -> Self {
        Self { dq, ddq, s: sign.of_each(dq, kind) }
    }

    /// Torque on the joint for a unit of the parameter.
    #[inline(always)]
    pub(crate) fn unit_torque(&self, quantity: JointQuantity) -> T {
        let Self { dq, ddq, s } = *self;
        let one = dq.like(1.0);
        match quantity {
            JointQuantity::Ia => ddq,
            JointQuantity::Fv => dq,
            JointQuantity::Fc => s,
            JointQuantity::Fvp => (one + s) * 0.5 * dq,
            JointQuantity::Fcp => (one + s) * 0.5,
            JointQuantity::Fvn => (one - s) * 0.5 * dq,
            JointQuantity::Fcn => (one - s) * -0.5,
            JointQuantity::Off => one,
        }
    }
}

impl CoupledMotor {
    /// Torque on a coordinate for a unit of the motor's parameter.
    #[inline(always)]
    pub(crate) fn unit_torque<T: Real>(
        &self,
        quantity: MotorQuantity,
        coordinate: usize,
        state: State<'_, T>,
        ddq: &[T],
        sign: Sign,
    ) -> T {
        let own = self.weights.iter().find(|(j, _)| *j == coordinate).map_or(0.0, |(_, w)| *w);
        let dq = state.dq;
        match quantity {
            MotorQuantity::Iam => (self.rate(ddq) - ddq[coordinate] * own) * own,
            MotorQuantity::Fvm => (self.rate(dq) - dq[coordinate] * own) * own,
            MotorQuantity::Fcm => sign.of_each(self.rate(dq), JointKind::Revolute) * own,
        }
    }
}

/// Motor inertia, usual friction and offset of one joint; symmetric friction is held as equal sides.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct JointTerms<P = f64> {
    pub(super) ia: P,
    fv: [P; 2],
    fc: [P; 2],
    off: P,
}

impl JointTerms {
    /// Stores the value of a parameter. A returned quantity is not among these terms: it is summed by its column.
    pub(super) fn insert(&mut self, quantity: JointQuantity, value: f64) -> Option<JointQuantity> {
        match quantity {
            JointQuantity::Ia => self.ia += value,
            JointQuantity::Fv => self.fv = self.fv.map(|side| side + value),
            JointQuantity::Fc => self.fc = self.fc.map(|side| side + value),
            JointQuantity::Fvp => self.fv[0] += value,
            JointQuantity::Fcp => self.fc[0] += value,
            JointQuantity::Fvn => self.fv[1] += value,
            JointQuantity::Fcn => self.fc[1] += value,
            JointQuantity::Off => self.off += value,
        }
        None
    }
}

impl<P: Copy> JointTerms<P> {
    /// The terms, each computed from the same one of several scalar sets.
    #[inline(always)]
    pub(super) fn from_numbers(number: impl Fn(&dyn Fn(&JointTerms) -> f64) -> P) -> Self {
        Self {
            ia: number(&|t| t.ia),
            fv: [0, 1].map(|side| number(&|t| t.fv[side])),
            fc: [0, 1].map(|side| number(&|t| t.fc[side])),
            off: number(&|t| t.off),
        }
    }

    /// Torque on the joint.
    #[inline(always)]
    pub(super) fn torque<T: Real>(&self, state: &JointState<T>) -> T
    where
        P: Parameter<T>,
    {
        let inertia = self.ia.in_lanes(state.dq);
        state.ddq * inertia + self.friction(state.dq, state.s)
    }

    /// Friction and offset at velocity `dq`, whose sign is `s`.
    #[inline(always)]
    fn friction<T: Real>(&self, dq: T, s: T) -> T
    where
        P: Parameter<T>,
    {
        let one = s.like(1.0);
        let (positive, negative) = ((one + s) * 0.5, (one - s) * 0.5);
        let forwards = dq * self.fv[0].in_lanes(s) + self.fc[0].in_lanes(s);
        let backwards = dq * self.fv[1].in_lanes(s) - self.fc[1].in_lanes(s);
        forwards * positive + backwards * negative + self.off.in_lanes(s)
    }
}

/// A term of one joint that is summed by its column.
#[derive(Debug, Clone, Copy)]
pub(super) struct OtherTerm<P = f64> {
    /// The joint, from zero.
    pub(super) joint: usize,
    pub(super) quantity: JointQuantity,
    pub(super) value: P,
}

impl<P: Copy> OtherTerm<P> {
    /// Torque on the joint.
    #[inline(always)]
    pub(super) fn torque<T: Real>(&self, state: &JointState<T>) -> T
    where
        P: Parameter<T>,
    {
        state.unit_torque(self.quantity) * self.value.in_lanes(state.dq)
    }
}

/// Cross inertia, cross viscous friction and Coulomb friction of one coupled motor.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct MotorTerms<P = f64> {
    pub(super) iam: P,
    fvm: P,
    fcm: P,
}

impl MotorTerms {
    /// Stores the value of a parameter.
    pub(super) fn insert(&mut self, quantity: MotorQuantity, value: f64) {
        match quantity {
            MotorQuantity::Iam => self.iam += value,
            MotorQuantity::Fvm => self.fvm += value,
            MotorQuantity::Fcm => self.fcm += value,
        }
    }
}

impl<P: Copy> MotorTerms<P> {
    /// The terms, each computed from the same one of several scalar sets.
    #[inline(always)]
    pub(super) fn from_numbers(number: impl Fn(&dyn Fn(&MotorTerms) -> f64) -> P) -> Self {
        Self { iam: number(&|t| t.iam), fvm: number(&|t| t.fvm), fcm: number(&|t| t.fcm) }
    }

    /// Adds the torques on the coordinates that move `motor`.
    #[inline(always)]
    pub(super) fn add_torques<T: Real>(&self, motor: &CoupledMotor, dq: &[T], ddq: &[T], sign: Sign, tau: &mut [T])
    where
        P: Parameter<T>,
    {
        let rate = motor.rate(dq);
        let (iam, fvm) = (self.iam.in_lanes(rate), self.fvm.in_lanes(rate));
        let coulomb = sign.of_each(rate, JointKind::Revolute) * self.fcm.in_lanes(rate);
        for &(j, w) in &motor.weights {
            tau[j] += coulomb * w;
        }
        for (j, k, w) in motor.cross_terms() {
            tau[j] += (ddq[k] * iam + dq[k] * fvm) * w;
        }
    }
}
