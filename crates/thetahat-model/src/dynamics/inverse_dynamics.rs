//! Recursive Newton-Euler with the torques of the drives, for one state or one in each lane.

use super::{
    model::Model,
    parameters::DynamicParameters,
    sign::Sign,
    state::{JointCoordinate, State},
    workspace::Workspace,
};
use thetahat_ground::real::{Parameter, Real};

impl Model {
    /// The torques `tau` of a motion, for one state or one in each lane.
    #[inline(always)]
    pub(super) fn inverse_dynamics_of<T: Real, P: Parameter<T>>(
        &self,
        parameters: &DynamicParameters<P>,
        state: State<'_, T>,
        ddq: &[T],
        sign: Sign,
        workspace: &mut Workspace<T>,
        tau: &mut [T],
    ) {
        self.propagate_motion(state, ddq, &mut workspace.links);
        self.rigid_torques(parameters, workspace, tau);
        self.add_drive_torques(parameters, state, ddq, sign, tau);
    }

    /// Backward pass of recursive Newton-Euler: only the torques of the rigid links.
    #[inline(always)]
    fn rigid_torques<T: Real, P: Parameter<T>>(
        &self,
        parameters: &DynamicParameters<P>,
        workspace: &mut Workspace<T>,
        tau: &mut [T],
    ) {
        for ((link, body), wrench) in workspace.links.iter().zip(&parameters.links).zip(&mut workspace.wrenches) {
            *wrench = body.in_lanes(link.dv[0]).wrench(link);
        }
        for torque in tau.iter_mut() {
            *torque = torque.like(0.0);
        }
        for (j, joint) in self.joints.iter().enumerate().rev() {
            let wrench = workspace.wrenches[j];
            tau[joint.moved_by.coordinate] += wrench.along(joint.revolute) * joint.moved_by.ratio;
            if let Some(of_parent) = workspace.wrenches.get_mut(joint.parent) {
                of_parent.absorb(&wrench.moved_to_parent(&workspace.links[j], joint.turn.as_ref()));
            }
        }
        if self.has_sums {
            self.add_torques_of_shares(workspace, tau);
        }
    }

    /// The torques of the links on the further joints that a joint follows, whose own wrenches are complete.
    #[cold]
    #[inline(never)]
    fn add_torques_of_shares<T: Real>(&self, workspace: &Workspace<T>, tau: &mut [T]) {
        for (joint, wrench) in self.joints.iter().zip(&workspace.wrenches) {
            joint.project_shares(wrench.along(joint.revolute), tau);
        }
    }

    /// The torques of the joints' drives where some follow several others.
    #[cold]
    #[inline(never)]
    fn add_drive_torques_of_sums<T: Real, P: Parameter<T>>(
        &self,
        parameters: &DynamicParameters<P>,
        state: State<'_, T>,
        ddq: &[T],
        sign: Sign,
        tau: &mut [T],
    ) {
        for (joint, terms) in self.joints.iter().zip(&parameters.joints) {
            joint.project(terms.torque(&joint.drive_state(state, ddq, sign)), tau);
        }
    }

    /// The torques of the drives: the terms of the joints and of the coupled motors.
    #[inline(always)]
    pub(super) fn add_drive_torques<T: Real, P: Parameter<T>>(
        &self,
        parameters: &DynamicParameters<P>,
        state: State<'_, T>,
        ddq: &[T],
        sign: Sign,
        tau: &mut [T],
    ) {
        if self.has_sums {
            self.add_drive_torques_of_sums(parameters, state, ddq, sign, tau);
        } else {
            for (joint, terms) in self.joints.iter().zip(&parameters.joints) {
                let JointCoordinate { coordinate, ratio, .. } = joint.moved_by;
                tau[coordinate] += terms.torque(&joint.moved_by.state(state, ddq, sign)) * ratio;
            }
        }
        for (motor, terms) in self.coupled_motors().iter().zip(&parameters.motors) {
            terms.add_torques(motor, state.dq, ddq, sign, tau);
        }
        for term in &parameters.others {
            let joint = &self.joints[term.joint];
            joint.project(term.torque(&joint.drive_state(state, ddq, sign)), tau);
        }
        if !parameters.terms.is_empty() {
            self.add_term_torques(parameters, state, ddq, sign, tau);
        }
    }
}
