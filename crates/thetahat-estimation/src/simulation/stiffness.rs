//! Choice of the method for a simulation: how fast friction stops a joint, and what that costs an explicit method.

use super::{closed_loop::ClosedLoop, plant::interpolate};
use thetahat_model::dynamics::{
    DampingWorkspace, DynamicParameters, Sign, State, Workspace, factorise, solve_factorised,
};

/// Points of the reference at which the stiffness is evaluated.
const POINTS: usize = 25;
/// The stiffness times the duration beyond which [`super::Solver::Automatic`] integrates implicitly. An explicit method is stable up
/// up to steps of 3.3 over the stiffness: for a joint that rests this long it takes more than 300 000 steps, about a second's work.
const COSTLY: f64 = 1e6;

impl ClosedLoop<'_> {
    /// The rate in 1/s at which friction stops a joint: the largest, over the joints and along the reference up to
    /// `duration_s`, of the slope of the smooth friction at rest over the inertia of the joint with the others free, `D_jj (M^-1)_jj`.
    /// Points without a positive definite mass matrix are left out.
    #[must_use]
    pub fn stiffness(&self, theta: &[f64], duration_s: f64) -> f64 {
        let n = self.model.coordinate_count();
        let parameters = DynamicParameters::sorted(self.model, theta);
        let mut workspace = Workspace::new(self.model);
        let [mut q, mut dq, mut ddq] = [(); 3].map(|()| vec![0.0; n]);
        let [mut mass, mut damping] = [(); 2].map(|()| vec![0.0; n * n]);
        let mut channels = vec![0.0; self.channels.map_or(0, |(series, _)| series.channels())];
        let sign = Sign::smooth(self.sign_velocity_scale);
        let mut damping_workspace = DampingWorkspace::default();
        let mut fastest: f64 = 0.0;
        for point in 0..POINTS {
            let t = duration_s * point as f64 / (POINTS - 1) as f64;
            self.reference.evaluate(t, &mut q, &mut dq, &mut ddq);
            dq.fill(0.0);
            if let Some((series, rate)) = self.channels {
                interpolate(series, t * rate, &mut channels);
            }
            let rest = State::new(&q, &dq).with_channels(&channels);
            self.model.damping_into(&parameters, rest, sign, &mut damping_workspace, &mut damping);
            self.model.mass_matrix(&parameters, &q, &mut workspace, &mut mass);
            if factorise(&mut mass, n).is_ok() {
                let rates = (0..n).map(|j| damping[j * n + j] * diagonal_of_inverse(&mass, j, n));
                fastest = rates.fold(fastest, f64::max);
            }
        }
        self.bias.friction * fastest
    }

    /// Whether [`super::Solver::Automatic`] integrates this loop implicitly.
    pub(super) fn is_costly_explicitly(&self, theta: &[f64], duration_s: f64) -> bool {
        self.stiffness(theta, duration_s) * duration_s > COSTLY
    }
}

/// `(M^-1)_jj` of the factors of M.
fn diagonal_of_inverse(factors: &[f64], j: usize, n: usize) -> f64 {
    let mut column = vec![0.0; n];
    column[j] = 1.0;
    solve_factorised(factors, &mut column);
    column[j]
}
