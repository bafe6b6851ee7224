use super::{
    DynamicParameters, DynamicsError, Model, Sign,
    geometry::BASE,
    parameters::Inertial,
    rotation::{Rotation, Turn},
    twist::Twist,
};
use crate::vector::{Mat3, Vec3, add, cross, dot, scale, times, transpose_times};

/// Scratch of the algorithms: one for each thread.
#[derive(Debug, Clone)]
pub struct Workspace {
    pub(crate) links: Vec<LinkMotion>,
    pub(crate) twists: Vec<Twist>,
    wrenches: Vec<Wrench>,
    composite: Vec<Inertial>,
    /// Mass matrix of the joints as if none followed another, its lower triangle; used where one does.
    link_masses: Vec<f64>,
    /// Mass matrix of the coordinates, its lower triangle.
    mass_matrix: Vec<f64>,
    rhs: Vec<f64>,
    zeros: Vec<f64>,
}

/// Placement of one link in the turned frame before it (see [`Turn`]), and its motion in its own frame.
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

    /// The motion in the frame turned by gamma.
    #[inline]
    pub(super) fn turned_back(&self, turn: &Turn) -> Self {
        let back = |x| turn.transpose_times(x);
        Self { w: back(self.w), dw: back(self.dw), dv: back(self.dv), ..*self }
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
            link_masses: vec![0.0; links * links],
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
        self.add_drive_torques(parameters, dq, ddq, sign, tau);
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
        self.lower_mass_matrix(parameters, workspace);
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
        self.lower_mass_matrix(parameters, workspace);
        let n = self.joint_count();
        m.copy_from_slice(&workspace.mass_matrix);
        for i in 1..n {
            let (above, row) = m.split_at_mut(i * n);
            above.chunks_exact_mut(n).zip(row).for_each(|(upper, lower)| upper[i] = *lower);
        }
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
            let before = joint.turned_back(before);
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
            before = joint.propagate(before, q, dq, ddq);
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
                of_parent.absorb(&wrench.moved_to_parent(&workspace.links[j], joint.turn.as_ref()));
            }
        }
    }

    /// Motor inertia, friction and offset of the joints, and the cross terms of the coupled motors.
    fn add_drive_torques(&self, parameters: &DynamicParameters, dq: &[f64], ddq: &[f64], sign: Sign, tau: &mut [f64]) {
        for (joint, own) in self.joints.iter().zip(&parameters.friction) {
            let velocity = joint.rate(dq);
            let torque = own.ia * joint.rate(ddq) + own.friction(velocity, sign.of(velocity));
            tau[joint.coordinate] += joint.ratio * torque;
        }
        for (motor, of_motor) in self.coupled_motors().iter().zip(&parameters.motors) {
            let coulomb = of_motor.fcm * sign.of(motor.velocity(dq));
            motor.weights.iter().for_each(|&(j, w)| tau[j] += w * coulomb);
            motor.cross_terms().for_each(|(j, k, w)| tau[j] += w * (of_motor.iam * ddq[k] + of_motor.fvm * dq[k]));
        }
    }

    /// The lower triangle of the mass matrix of the coordinates; the placements must be in the workspace.
    fn lower_mass_matrix(&self, parameters: &DynamicParameters, workspace: &mut Workspace) {
        let n = self.joint_count();
        let Workspace { links, composite, mass_matrix, link_masses, .. } = workspace;
        if n == self.link_count() {
            self.composite_rigid_bodies(parameters, links, composite, mass_matrix);
        } else {
            self.composite_rigid_bodies(parameters, links, composite, link_masses);
            self.reduce_to_coordinates(link_masses, mass_matrix);
        }
        for (motor, of_motor) in self.coupled_motors().iter().zip(&parameters.motors) {
            motor.cross_terms().for_each(|(j, k, w)| mass_matrix[j * n + k] += of_motor.iam * w);
        }
    }

    /// The lower triangle of the mass matrix of all joints, as if none followed another, by composite rigid bodies from
    /// the tips to the base: the wrench of each joint's unit acceleration is carried to the base and meets the joints on
    /// the way.
    fn composite_rigid_bodies(
        &self,
        parameters: &DynamicParameters,
        links: &[LinkMotion],
        composite: &mut [Inertial],
        m: &mut [f64],
    ) {
        composite.copy_from_slice(&parameters.links);
        for (j, joint) in self.joints.iter().enumerate().rev() {
            let row = &mut m[j * links.len()..=j * links.len() + j];
            let mut wrench = composite[j].wrench_of_joint(joint.revolute);
            row[j] = wrench.along(joint.revolute) + parameters.friction[j].ia;
            // All joints before are passed, not only those on the way: on a chain, no index waits for a parent's.
            let (mut outer, mut link) = (joint, &links[j]);
            for (i, (inner, entry)) in self.joints[..j].iter().zip(row).enumerate().rev() {
                if i != outer.parent {
                    *entry = 0.0;
                    continue;
                }
                wrench = wrench.moved_to_parent(link, outer.turn.as_ref());
                *entry = wrench.along(inner.revolute);
                (outer, link) = (inner, &links[i]);
            }
            if joint.parent != BASE {
                let moved = composite[j].moved_to_parent(&links[j], joint.turn.as_ref());
                composite[joint.parent].absorb(&moved);
            }
        }
    }

    /// The lower triangle of `G^T M G`, of that of the joints' mass matrix.
    fn reduce_to_coordinates(&self, m: &[f64], reduced: &mut [f64]) {
        let (n, links) = (self.joint_count(), self.link_count());
        reduced.fill(0.0);
        for (i, first) in self.joints.iter().enumerate() {
            for (j, second) in self.joints[..=i].iter().enumerate() {
                let value = first.ratio * second.ratio * m[i * links + j];
                let (row, column) = (first.coordinate.max(second.coordinate), first.coordinate.min(second.coordinate));
                let both = if i != j && row == column { 2.0 } else { 1.0 };
                reduced[row * n + column] += both * value;
            }
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
    fn moved_to_parent(&self, link: &LinkMotion, turn: Option<&Turn>) -> Self {
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
        let ms = add(s, scale(self.m, p));
        match turn {
            None => Self { inertia, ms, m: self.m },
            Some(turn) => Self { inertia: turn.rotate_symmetric(&inertia), ms: turn.times(ms), m: self.m },
        }
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
    fn moved_to_parent(&self, link: &LinkMotion, turn: Option<&Turn>) -> Self {
        let force = link.r.times(self.force);
        let moment = add(link.r.times(self.moment), cross(link.p, force));
        match turn {
            None => Self { force, moment },
            Some(turn) => Self { force: turn.times(force), moment: turn.times(moment) },
        }
    }

    #[inline]
    fn absorb(&mut self, other: &Self) {
        self.force = add(self.force, other.force);
        self.moment = add(self.moment, other.moment);
    }
}

/// Solves `M x = b` in place by `M = L D L^T`; M is row by row, its lower triangle alone is used, and it is overwritten by L with `1/D` on its diagonal.
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
