//! The mass matrix by composite rigid bodies, for one state or one in each lane.

use super::{
    geometry::BASE, inertial::Inertial, model::Model, motion::LinkMotion, parameters::DynamicParameters,
    workspace::Workspace,
};
use thetahat_ground::real::{Parameter, Real};

impl Model {
    /// The lower triangle of the mass matrix of the coordinates; the workspace must hold the placements.
    #[inline(always)]
    pub(super) fn lower_mass_matrix<T: Real, P: Parameter<T>>(
        &self,
        parameters: &DynamicParameters<P>,
        workspace: &mut Workspace<T>,
    ) {
        let n = self.coordinate_count();
        let Workspace { links, composite, mass_matrix, link_masses, .. } = workspace;
        if n == self.link_count() {
            self.composite_rigid_bodies(parameters, links, composite, mass_matrix);
        } else {
            self.composite_rigid_bodies(parameters, links, composite, link_masses);
            self.reduce_to_coordinates(link_masses, mass_matrix);
        }
        for (motor, of_motor) in self.coupled_motors().iter().zip(&parameters.motors) {
            for (j, k, w) in motor.cross_terms() {
                let entry = &mut mass_matrix[j * n + k];
                *entry += of_motor.iam.in_lanes(*entry) * w;
            }
        }
    }

    /// The lower triangle of the mass matrix of all joints, as if none followed another, by composite rigid bodies from the
    /// tips to the base: the wrench of each joint's unit acceleration is propagated to the base and projected on the joints it
    /// passes.
    #[inline(always)]
    fn composite_rigid_bodies<T: Real, P: Parameter<T>>(
        &self,
        parameters: &DynamicParameters<P>,
        links: &[LinkMotion<T>],
        composite: &mut [Inertial<T>],
        m: &mut [T],
    ) {
        for (k, own) in parameters.links.iter().enumerate() {
            composite[k] = own.in_lanes(links[k].dv[0]);
        }
        for (j, joint) in self.joints.iter().enumerate().rev() {
            let row = &mut m[j * links.len()..=j * links.len() + j];
            let mut wrench = composite[j].wrench_of_joint(joint.revolute);
            row[j] = wrench.along(joint.revolute);
            row[j] += parameters.joints[j].ia.in_lanes(row[j]);
            // All earlier joints are visited, not only those on the path: on a chain, no index then waits for a parent's.
            let (mut outer, mut link) = (joint, &links[j]);
            for (i, inner) in self.joints[..j].iter().enumerate().rev() {
                if i != outer.parent {
                    row[i] = row[i].like(0.0);
                    continue;
                }
                wrench = wrench.moved_to_parent(link, outer.turn.as_ref());
                row[i] = wrench.along(inner.revolute);
                (outer, link) = (inner, &links[i]);
            }
            if joint.parent != BASE {
                let moved = composite[j].moved_to_parent(&links[j], joint.turn.as_ref());
                composite[joint.parent].absorb(&moved);
            }
        }
    }

    /// The lower triangle of `G^T M G`, from the lower triangle of the joints' mass matrix M.
    #[inline(always)]
    fn reduce_to_coordinates<T: Real>(&self, m: &[T], reduced: &mut [T]) {
        let (n, links) = (self.coordinate_count(), self.link_count());
        for entry in reduced.iter_mut() {
            *entry = entry.like(0.0);
        }
        for (i, first) in self.joints.iter().enumerate() {
            for (j, second) in self.joints[..=i].iter().enumerate() {
                for (a, (of_first, ratio)) in first.shares().enumerate() {
                    // Each pair of shares of one joint counts once.
                    let pairs = if i == j { a + 1 } else { usize::MAX };
                    for (of_second, other) in second.shares().take(pairs) {
                        let (row, column) = (of_first.max(of_second), of_first.min(of_second));
                        let both = if i != j && row == column { 2.0 } else { 1.0 };
                        reduced[row * n + column] += m[i * links + j] * (ratio * other) * both;
                    }
                }
            }
        }
    }
}
