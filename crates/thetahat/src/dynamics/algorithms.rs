use super::{DynamicParameters, DynamicsError, Model, Sign, geometry::BASE, parameters::Inertial, rotation::Rotation, twist::Twist};
use crate::vector::{Mat3, Vec3, add, cross, dot, scale, times, transpose_times};

/// Scratch of the algorithms: one for each thread.
#[derive(Debug, Clone)]
pub struct Workspace {
    pub(crate) links: Vec<LinkMotion>,
    pub(crate) twists: Vec<Twist>,
    wrenches: Vec<Wrench>,
    composite: Vec<Inertial>,
    mass_matrix: Vec<f64>,
    rhs: Vec<f64>,
    zeros: Vec<f64>,
}

/// Placement and motion of one link, in its own frame.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct LinkMotion {
    pub(crate) r: Rotation,
    pub(crate) p: Vec3,
    pub(crate) w: Vec3,
    pub(crate) dw: Vec3,
    pub(crate) dv: Vec3,
}

impl LinkMotion {
    /// Acceleration, less gravity, of the point of the link at `p`.
    #[inline]
    pub(super) fn acceleration_at(&self, p: Vec3) -> Vec3 {
        let centripetal = cross(self.w, cross(self.w, p));
        add(self.dv, add(cross(self.dw, p), centripetal))
    }

    /// The motion in the link's own axes, `x_here = axes x_link`.
    pub(crate) fn in_axes(&self, axes: &Mat3) -> Self {
        let turn = |x| transpose_times(axes, x);
        Self { w: turn(self.w), dw: turn(self.dw), dv: turn(self.dv), ..*self }
    }
}

#[derive(Debug, Clone, Copy, Default)]
struct Wrench {
    force: Vec3,
    moment: Vec3,
}

impl Workspace {
    /// Scratch for a model.
    #[must_use]
    pub fn new(model: &Model) -> Self {
        let (n, links) = (model.joint_count(), model.link_count());
        Self {
            links: vec![LinkMotion::default(); links],
            twists: vec![Twist::default(); model.twist_count()],
            wrenches: vec![Wrench::default(); links],
            composite: vec![Inertial::default(); links],
            mass_matrix: vec![0.0; n * n],
            rhs: vec![0.0; n],
            zeros: vec![0.0; n],
        }
    }
}

impl Model {
    /// Inverse dynamics (1): the joint torques `tau` of a motion, by recursive Newton-Euler, with motor inertia,
    /// friction, offsets and coupled motors. `tau = phi(q, dq, ddq) theta` (3).
    #[allow(clippy::too_many_arguments)]
    pub fn inverse_dynamics(
        &self,
        parameters: &DynamicParameters,
        q: &[f64],
        dq: &[f64],
        ddq: &[f64],
        sign: Sign,
        workspace: &mut Workspace,
        tau: &mut [f64],
    ) {
        self.propagate_motion(q, dq, ddq, &mut workspace.links);
        self.rigid_torques(parameters, workspace, tau);
        for (joint, own) in self.joints.iter().zip(&parameters.friction) {
            tau[joint.coordinate] += joint.ratio * own.ia * joint.rate(ddq);
        }
        for (motor, of_motor) in self.coupled_motors().iter().zip(&parameters.motors) {
            motor.cross_terms().for_each(|(j, k, w)| tau[j] += of_motor.iam * w * ddq[k]);
        }
        self.add_friction(parameters, dq, sign, tau);
    }

    /// Forward dynamics (5): the accelerations `ddq` that torques `tau` give.
    ///
    /// # Errors
    /// [`DynamicsError::MassMatrixNotPositiveDefinite`] where these parameters have no such mass matrix.
    #[allow(clippy::too_many_arguments)]
    pub fn forward_dynamics(
        &self,
        parameters: &DynamicParameters,
        q: &[f64],
        dq: &[f64],
        tau: &[f64],
        sign: Sign,
        workspace: &mut Workspace,
        ddq: &mut [f64],
    ) -> Result<(), DynamicsError> {
        let mut bias = std::mem::take(&mut workspace.rhs);
        let zeros = std::mem::take(&mut workspace.zeros);
        self.inverse_dynamics(parameters, q, dq, &zeros, sign, workspace, &mut bias);
        self.composite_mass_matrix(parameters, workspace);
        for (a, (t, b)) in ddq.iter_mut().zip(tau.iter().zip(&bias)) {
            *a = t - b;
        }
        workspace.rhs = bias;
        workspace.zeros = zeros;
        solve_positive_definite(&mut workspace.mass_matrix, ddq).map_err(|(coordinate, pivot)| {
            DynamicsError::MassMatrixNotPositiveDefinite { joint: self.coordinates[coordinate] + 1, pivot }
        })
    }

    /// The mass matrix `M(q)`, row by row: `M = d tau / d ddq`, motor inertias and their coupling included.
    pub fn mass_matrix(&self, parameters: &DynamicParameters, q: &[f64], workspace: &mut Workspace, m: &mut [f64]) {
        for (joint, link) in self.joints.iter().zip(&mut workspace.links) {
            (link.r, link.p) = joint.placement(q);
        }
        self.composite_mass_matrix(parameters, workspace);
        m.copy_from_slice(&workspace.mass_matrix);
    }

    /// Kinetic and potential energy in J, motor inertias included. The potential is zero at the base's origin.
    pub fn energy(&self, parameters: &DynamicParameters, q: &[f64], dq: &[f64], workspace: &mut Workspace) -> f64 {
        let n = self.joint_count();
        let mut m = vec![0.0; n * n];
        self.mass_matrix(parameters, q, workspace, &mut m);
        let kinetic: f64 = (0..n).map(|i| (0..n).map(|j| 0.5 * dq[i] * m[i * n + j] * dq[j]).sum::<f64>()).sum();
        // Gravity in each link's frame, and the potential of a unit mass at its origin.
        let mut fields: Vec<(Vec3, f64)> = Vec::with_capacity(self.link_count());
        let mut potential = 0.0;
        for ((joint, link), body) in self.joints.iter().zip(&workspace.links).zip(&parameters.links) {
            let (before, origin) = fields.get(joint.parent).copied().unwrap_or((self.gravity, 0.0));
            let (gravity, origin) = (link.r.transpose_times(before), origin - dot(before, link.p));
            potential += body.m * origin - dot(gravity, body.ms);
            fields.push((gravity, origin));
        }
        kinetic + potential
    }

    /// Forward pass of recursive Newton-Euler: placement, velocity and acceleration of every link.
    pub(crate) fn propagate_motion(&self, q: &[f64], dq: &[f64], ddq: &[f64], links: &mut [LinkMotion]) {
        let base = LinkMotion { dv: scale(-1.0, self.gravity), ..LinkMotion::default() };
        let mut before = base;
        for (j, joint) in self.joints.iter().enumerate() {
            // A chain hands its motion on without a detour through the memory.
            if !joint.continues_chain {
                before = links.get(joint.parent).copied().unwrap_or(base);
            }
            before = joint.propagate(&before, q, dq, ddq);
            links[j] = before;
        }
    }

    /// Backward pass of recursive Newton-Euler: the torques of the rigid links alone.
    fn rigid_torques(&self, parameters: &DynamicParameters, workspace: &mut Workspace, tau: &mut [f64]) {
        for ((link, body), wrench) in workspace.links.iter().zip(&parameters.links).zip(&mut workspace.wrenches) {
            *wrench = body.wrench(link);
        }
        tau.fill(0.0);
        for (j, joint) in self.joints.iter().enumerate().rev() {
            let wrench = workspace.wrenches[j];
            tau[joint.coordinate] += joint.ratio * wrench.along(joint.revolute);
            if let Some(of_parent) = workspace.wrenches.get_mut(joint.parent) {
                of_parent.absorb(&wrench.moved_to_parent(&workspace.links[j]));
            }
        }
    }

    fn add_friction(&self, parameters: &DynamicParameters, dq: &[f64], sign: Sign, tau: &mut [f64]) {
        for (joint, own) in self.joints.iter().zip(&parameters.friction) {
            let velocity = joint.rate(dq);
            tau[joint.coordinate] += joint.ratio * own.friction(velocity, sign.of(velocity));
        }
        for (motor, of_motor) in self.coupled_motors().iter().zip(&parameters.motors) {
            let coulomb = of_motor.fcm * sign.of(motor.velocity(dq));
            motor.weights.iter().for_each(|&(j, w)| tau[j] += w * coulomb);
            motor.cross_terms().for_each(|(j, k, w)| tau[j] += of_motor.fvm * w * dq[k]);
        }
    }

    /// Composite rigid bodies from the tips to the base; the placements must be in the workspace. The wrench of each
    /// joint's unit acceleration is carried to the base, and meets the joints on the way.
    fn composite_mass_matrix(&self, parameters: &DynamicParameters, workspace: &mut Workspace) {
        let n = self.joint_count();
        workspace.composite.copy_from_slice(&parameters.links);
        workspace.mass_matrix.fill(0.0);
        for (j, joint) in self.joints.iter().enumerate().rev() {
            let mut wrench = workspace.composite[j].wrench_of_joint(joint.revolute);
            let own = wrench.along(joint.revolute) + parameters.friction[j].ia;
            workspace.mass_matrix[joint.coordinate * (n + 1)] += joint.ratio * joint.ratio * own;
            let (mut at, mut next) = (j, joint.parent);
            while let Some(before) = self.joints.get(next) {
                wrench = wrench.moved_to_parent(&workspace.links[at]);
                let coupling = joint.ratio * before.ratio * wrench.along(before.revolute);
                workspace.mass_matrix[joint.coordinate * n + before.coordinate] += coupling;
                workspace.mass_matrix[before.coordinate * n + joint.coordinate] += coupling;
                (at, next) = (next, before.parent);
            }
            if joint.parent != BASE {
                let moved = workspace.composite[j].moved_to_parent(&workspace.links[j]);
                workspace.composite[joint.parent].absorb(&moved);
            }
        }
        for (motor, of_motor) in self.coupled_motors().iter().zip(&parameters.motors) {
            motor.cross_terms().for_each(|(j, k, w)| workspace.mass_matrix[j * n + k] += of_motor.iam * w);
        }
    }
}

impl Inertial {
    /// Force and moment about the frame's origin that move the link: `F = m dv + dw x ms + w x (w x ms)`,
    /// `N = J dw + w x J w + ms x dv`.
    #[inline]
    fn wrench(&self, link: &LinkMotion) -> Wrench {
        let LinkMotion { w, dw, dv, .. } = *link;
        let force = add(scale(self.m, dv), add(cross(dw, self.ms), cross(w, cross(w, self.ms))));
        let gyroscopic = cross(w, times(&self.inertia, w));
        let moment = add(add(times(&self.inertia, dw), gyroscopic), cross(self.ms, dv));
        Wrench { force, moment }
    }

    /// The wrench of a unit acceleration about (revolute) or along (prismatic) the z axis.
    #[inline]
    fn wrench_of_joint(&self, revolute: bool) -> Wrench {
        if revolute {
            let moment = [self.inertia[0][2], self.inertia[1][2], self.inertia[2][2]];
            Wrench { force: [-self.ms[1], self.ms[0], 0.0], moment }
        } else {
            Wrench { force: [0.0, 0.0, self.m], moment: [self.ms[1], -self.ms[0], 0.0] }
        }
    }

    /// The same body about the origin of the frame before.
    ///
    /// With the first moments rotated to `s = R ms`: `J' = R J R^T + (2 p.s + m p.p) 1 - (p s^T + s p^T + m p p^T)`.
    #[inline]
    fn moved_to_parent(&self, link: &LinkMotion) -> Self {
        let p = link.p;
        let s = link.r.times(self.ms);
        let mut inertia = link.r.rotate_symmetric(&self.inertia);
        let spherical = 2.0 * dot(p, s) + self.m * dot(p, p);
        for (i, row) in inertia.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                *entry -= p[i] * s[j] + s[i] * p[j] + self.m * p[i] * p[j];
            }
            row[i] += spherical;
        }
        Self { inertia, ms: add(s, scale(self.m, p)), m: self.m }
    }

    #[inline]
    fn absorb(&mut self, other: &Self) {
        for (mine, theirs) in self.inertia.iter_mut().zip(&other.inertia) {
            *mine = add(*mine, *theirs);
        }
        self.ms = add(self.ms, other.ms);
        self.m += other.m;
    }
}

impl Wrench {
    /// The component that the joint's drive carries.
    #[inline]
    fn along(&self, revolute: bool) -> f64 {
        if revolute { self.moment[2] } else { self.force[2] }
    }

    #[inline]
    fn moved_to_parent(&self, link: &LinkMotion) -> Self {
        let force = link.r.times(self.force);
        Self { force, moment: add(link.r.times(self.moment), cross(link.p, force)) }
    }

    #[inline]
    fn absorb(&mut self, other: &Self) {
        self.force = add(self.force, other.force);
        self.moment = add(self.moment, other.moment);
    }
}

/// Solves `M x = b` in place by `M = L D L^T`; M is row by row and is overwritten by L with `1/D` on its diagonal.
///
/// The error is the index and value of a pivot that is not positive. Written out because it runs in every right-hand side of the simulation, where nothing may allocate.
fn solve_positive_definite(m: &mut [f64], b: &mut [f64]) -> Result<(), (usize, f64)> {
    let n = b.len();
    for j in 0..n {
        let (above, row) = m.split_at_mut(j * n);
        // Entry i of the row becomes (L D)_ji, then L_ji; the pivot takes away the squares of L weighted by D.
        for i in 0..j {
            let before = &above[i * n..i * n + i];
            row[i] -= before.iter().zip(&row[..i]).map(|(l, ld)| l * ld).sum::<f64>();
        }
        let mut pivot = row[j];
        for i in 0..j {
            let l = row[i] * above[i * n + i];
            pivot -= l * row[i];
            row[i] = l;
        }
        if pivot.is_nan() || pivot <= 0.0 {
            return Err((j, pivot));
        }
        row[j] = 1.0 / pivot;
    }
    for i in 0..n {
        b[i] -= (0..i).map(|k| m[i * n + k] * b[k]).sum::<f64>();
    }
    for i in (0..n).rev() {
        let sum: f64 = (i + 1..n).map(|k| m[k * n + i] * b[k]).sum();
        b[i] = b[i] * m[i * n + i] - sum;
    }
    Ok(())
}
