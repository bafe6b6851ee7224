//! The kernels for one state, compiled for the machine's instructions: those of the same operations, so that the bits do not
//! depend on the machine.

use pulp::{Simd, WithSimd};

use super::{DynamicParameters, Model, Sign, Workspace};

/// Inverse dynamics of `q, dq, ddq`.
pub(super) struct InverseDynamics<'a> {
    pub(super) model: &'a Model,
    pub(super) parameters: &'a DynamicParameters,
    pub(super) state: [&'a [f64]; 3],
    pub(super) sign: Sign,
    pub(super) workspace: &'a mut Workspace,
    pub(super) tau: &'a mut [f64],
}

impl WithSimd for InverseDynamics<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.model.inverse_dynamics_of(self.parameters, self.state, self.sign, self.workspace, self.tau);
    }
}

/// Forward dynamics of `q, dq, tau`.
pub(super) struct ForwardDynamics<'a> {
    pub(super) model: &'a Model,
    pub(super) parameters: &'a DynamicParameters,
    pub(super) state: [&'a [f64]; 3],
    pub(super) sign: Sign,
    pub(super) workspace: &'a mut Workspace,
    pub(super) ddq: &'a mut [f64],
}

impl WithSimd for ForwardDynamics<'_> {
    type Output = Result<(), (usize, f64)>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        self.model.forward_dynamics_of(self.parameters, self.state, self.sign, self.workspace, self.ddq)
    }
}

/// The lower triangle of the mass matrix at `q`, left in the workspace.
pub(super) struct MassMatrix<'a> {
    pub(super) model: &'a Model,
    pub(super) parameters: &'a DynamicParameters,
    pub(super) q: &'a [f64],
    pub(super) workspace: &'a mut Workspace,
}

impl WithSimd for MassMatrix<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.model.place(self.q, &mut self.workspace.links);
        self.model.lower_mass_matrix(self.parameters, self.workspace);
    }
}
