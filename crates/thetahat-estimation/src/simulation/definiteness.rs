//! Whether parameters can be simulated: compares their mass matrix with that of other parameters.

use super::closed_loop::ClosedLoop;
use thetahat_model::dynamics::{DynamicParameters, Workspace, factorise};

/// Points of the reference at which the mass matrix is evaluated.
const POINTS: usize = 25;

impl ClosedLoop<'_> {
    /// Whether `M(theta) - part M(least)` is positive definite at 25 points of the reference up to `duration_s`.
    #[must_use]
    pub fn has_mass_matrix_above(&self, theta: &[f64], part: f64, least: &[f64], duration_s: f64) -> bool {
        let n = self.model.coordinate_count();
        let parameters = [theta, least].map(|theta| DynamicParameters::sorted(self.model, theta));
        let mut workspace = Workspace::new(self.model);
        let [mut q, mut dq, mut ddq] = [(); 3].map(|()| vec![0.0; n]);
        let [mut mass, mut other] = [(); 2].map(|()| vec![0.0; n * n]);
        (0..POINTS).all(|point| {
            let t = duration_s * point as f64 / (POINTS - 1) as f64;
            self.reference.evaluate(t, &mut q, &mut dq, &mut ddq);
            self.model.mass_matrix(&parameters[0], &q, &mut workspace, &mut mass);
            self.model.mass_matrix(&parameters[1], &q, &mut workspace, &mut other);
            mass.iter_mut().zip(&other).for_each(|(m, o)| *m -= part * o);
            factorise(&mut mass, n).is_ok()
        })
    }
}
