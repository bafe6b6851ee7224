//! Forward dynamics for one state, or for one state in each lane.

use super::{
    model::Model, parameters::DynamicParameters, sign::Sign, solve::solve_positive_definite, state::State,
    workspace::Workspace,
};
use thetahat_ground::real::{Parameter, Real};

impl Model {
    /// The accelerations `ddq` of torques `tau`, for one state or one in each lane. The error is the coordinate and the pivots,
    /// of which one is not positive.
    #[inline(always)]
    #[doc(hidden)]
    pub fn forward_dynamics_of<T: Real, P: Parameter<T>>(
        &self,
        parameters: &DynamicParameters<P>,
        state: State<'_, T>,
        tau: &[T],
        sign: Sign,
        workspace: &mut Workspace<T>,
        ddq: &mut [T],
    ) -> Result<(), (usize, T)> {
        let mut bias = std::mem::take(&mut workspace.rhs);
        let zeros = std::mem::take(&mut workspace.zeros);
        self.inverse_dynamics_of(parameters, state, &zeros, sign, workspace, &mut bias);
        self.lower_mass_matrix(parameters, workspace);
        for (a, (t, b)) in ddq.iter_mut().zip(tau.iter().zip(&bias)) {
            *a = *t - *b;
        }
        workspace.rhs = bias;
        workspace.zeros = zeros;
        solve_positive_definite(&mut workspace.mass_matrix, ddq)
    }
}
