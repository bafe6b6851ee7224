//! The kernels for one state, compiled for the machine's vector instructions. Every machine performs the same
//! operations, so the results are bit-identical on all of them.

use pulp::{Simd, WithSimd};

use super::{
    model::{DynamicsError, Model},
    parameters::DynamicParameters,
    sign::Sign,
    state::State,
    workspace::Workspace,
};

impl Model {
    /// Inverse dynamics (1): the joint torques `tau` of a motion, by recursive Newton-Euler, with motor inertia,
    /// friction, offsets and coupled motors. `tau = phi(q, dq, ddq) theta` (3).
    ///
    /// # Panics
    /// If a slice is shorter than the robot has coordinates, or parameters or workspace are of another model.
    pub fn inverse_dynamics(
        &self,
        parameters: &DynamicParameters,
        state: State<'_>,
        ddq: &[f64],
        sign: Sign,
        workspace: &mut Workspace,
        tau: &mut [f64],
    ) {
        if let (Some(closed), Some(scratch)) = (self.closed(), workspace.loops.as_deref_mut()) {
            return closed.inverse_dynamics(parameters, [state.q, state.dq, ddq], sign, scratch, tau);
        }
        pulp::Arch::new().dispatch(InverseDynamics { model: self, parameters, state, ddq, sign, workspace, tau });
    }

    /// Forward dynamics (5): the accelerations `ddq` of torques `tau`.
    ///
    /// # Errors
    /// [`DynamicsError::MassMatrixNotPositiveDefinite`] where these parameters have no such mass matrix.
    ///
    /// # Panics
    /// As [`Model::inverse_dynamics`].
    pub fn forward_dynamics(
        &self,
        parameters: &DynamicParameters,
        state: State<'_>,
        tau: &[f64],
        sign: Sign,
        workspace: &mut Workspace,
        ddq: &mut [f64],
    ) -> Result<(), DynamicsError> {
        if let (Some(closed), Some(scratch)) = (self.closed(), workspace.loops.as_deref_mut()) {
            let scratch = (scratch, &mut workspace.mass_matrix[..]);
            return closed.forward_dynamics(parameters, [state.q, state.dq, tau], sign, scratch, ddq);
        }
        let kernel = ForwardDynamics { model: self, parameters, state, tau, sign, workspace, ddq };
        pulp::Arch::new().dispatch(kernel).map_err(|(coordinate, pivot)| DynamicsError::MassMatrixNotPositiveDefinite {
            joint: self.coordinates[coordinate] + 1,
            pivot,
        })
    }

    /// The mass matrix `M(q)`, row by row: `M = d tau / d ddq`, motor inertias and their coupling included.
    ///
    /// # Panics
    /// As [`Model::inverse_dynamics`], and if `m` has fewer entries than the matrix.
    pub fn mass_matrix(&self, parameters: &DynamicParameters, q: &[f64], workspace: &mut Workspace, m: &mut [f64]) {
        match (self.closed(), workspace.loops.as_deref_mut()) {
            (Some(closed), Some(scratch)) => closed.mass_matrix(parameters, q, scratch, &mut workspace.mass_matrix),
            (None, _) | (_, None) => {
                pulp::Arch::new().dispatch(MassMatrix { model: self, parameters, q, workspace });
            }
        }
        let n = self.coordinate_count();
        m.copy_from_slice(&workspace.mass_matrix);
        for i in 1..n {
            let (above, row) = m.split_at_mut(i * n);
            above.chunks_exact_mut(n).zip(row).for_each(|(upper, lower)| upper[i] = *lower);
        }
    }

    /// The inertia of each coordinate alone: the diagonal of the mass matrix of standard parameters at a position.
    ///
    /// # Errors
    /// As [`DynamicParameters::new`].
    #[doc(hidden)]
    pub fn joint_inertias(&self, standard: &[f64], q: &[f64]) -> Result<Vec<f64>, DynamicsError> {
        let parameters = DynamicParameters::new(self, standard)?;
        let n = self.coordinate_count();
        let mut mass = vec![0.0; n * n];
        self.mass_matrix(&parameters, q, &mut Workspace::new(self), &mut mass);
        Ok((0..n).map(|j| mass[j * n + j]).collect())
    }
}

struct InverseDynamics<'a> {
    model: &'a Model,
    parameters: &'a DynamicParameters,
    state: State<'a>,
    ddq: &'a [f64],
    sign: Sign,
    workspace: &'a mut Workspace,
    tau: &'a mut [f64],
}

impl WithSimd for InverseDynamics<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.model.inverse_dynamics_of(self.parameters, self.state, self.ddq, self.sign, self.workspace, self.tau);
    }
}

struct ForwardDynamics<'a> {
    model: &'a Model,
    parameters: &'a DynamicParameters,
    state: State<'a>,
    tau: &'a [f64],
    sign: Sign,
    workspace: &'a mut Workspace,
    ddq: &'a mut [f64],
}

impl WithSimd for ForwardDynamics<'_> {
    type Output = Result<(), (usize, f64)>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        self.model.forward_dynamics_of(self.parameters, self.state, self.tau, self.sign, self.workspace, self.ddq)
    }
}

/// Computes the lower triangle of the mass matrix at `q` in the workspace.
struct MassMatrix<'a> {
    model: &'a Model,
    parameters: &'a DynamicParameters,
    q: &'a [f64],
    workspace: &'a mut Workspace,
}

impl WithSimd for MassMatrix<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.model.place(self.q, &mut self.workspace.links);
        self.model.lower_mass_matrix(self.parameters, self.workspace);
    }
}
