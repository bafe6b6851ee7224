use super::{model::Model, parameters::DynamicParameters, state::State, workspace::Workspace};
use thetahat_ground::vector::{Vec3, dot};

impl Model {
    /// Kinetic and potential energy in J, motor inertias included. The potential is zero at the base's origin.
    pub fn energy(&self, parameters: &DynamicParameters, state: State<'_>, workspace: &mut Workspace) -> f64 {
        if let Some(closed) = self.closed() {
            return closed.energy(parameters, state);
        }
        let State { q, dq, .. } = state;
        let n = self.coordinate_count();
        let mut m = vec![0.0; n * n];
        self.mass_matrix(parameters, q, workspace, &mut m);
        let kinetic: f64 = (0..n).map(|i| (0..n).map(|j| 0.5 * dq[i] * m[i * n + j] * dq[j]).sum::<f64>()).sum();
        // Gravity in each link's frame, and the potential of a unit mass at its origin.
        let mut fields: Vec<(Vec3, f64)> = Vec::with_capacity(self.link_count());
        let mut potential = 0.0;
        for ((joint, link), body) in self.joints.iter().zip(&workspace.links).zip(&parameters.links) {
            let (before, origin) = fields.get(joint.parent).copied().unwrap_or((self.gravity, 0.0));
            let before = joint.turned_back(before);
            let (gravity, origin) = (link.r.transpose_times(before), origin - dot(before, link.p));
            potential += body.m * origin - dot(gravity, body.ms);
            fields.push((gravity, origin));
        }
        kinetic + potential
    }
}
