use super::{
    DynamicParameters, DynamicsError, Model, Sign,
    geometry::BASE,
    one_state::{ForwardDynamics, InverseDynamics, MassMatrix},
    parameters::Inertial,
    rotation::{Rotation, Turn},
    solve::solve_positive_definite,
    twist::Twist,
};
use crate::{
    real::{Parameter, Real},
    vector::{Mat3, Vec3, add, cross, dot, in_lanes, scale, times, transpose_times},
};

/// Scratch of the algorithms: one for each thread.
#[derive(Debug, Clone)]
pub struct Workspace<T = f64> {
    pub(crate) links: Vec<LinkMotion<T>>,
    pub(crate) twists: Vec<Twist<T>>,
    wrenches: Vec<Wrench<T>>,
    composite: Vec<Inertial<T>>,
    /// Mass matrix of the joints as if none followed another, its lower triangle; used where one does.
    link_masses: Vec<T>,
    /// Mass matrix of the coordinates, its lower triangle.
    mass_matrix: Vec<T>,
    rhs: Vec<T>,
    zeros: Vec<T>,
}

/// Placement of one link in the turned frame before it (see [`Turn`]), and its motion in its own frame.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct LinkMotion<T = f64> {
    pub(crate) r: Rotation<T>,
    pub(crate) p: Vec3<T>,
    pub(crate) w: Vec3<T>,
    pub(crate) dw: Vec3<T>,
    pub(crate) dv: Vec3<T>,
}

impl<T: Real> LinkMotion<T> {
    /// A link at rest with acceleration `dv`, less gravity.
    #[inline(always)]
    fn at_rest(kind: T, dv: Vec3) -> Self {
        let zero = kind.like(0.0);
        let r = Rotation { sin_alpha: 0.0, cos_alpha: 1.0, sin_theta: zero, cos_theta: kind.like(1.0) };
        Self { r, p: [zero; 3], w: [zero; 3], dw: [zero; 3], dv: in_lanes(kind, dv) }
    }

    /// Acceleration, less gravity, of the point of the link at `p`.
    #[inline(always)]
    pub(super) fn acceleration_at(&self, p: Vec3<T>) -> Vec3<T> {
        let centripetal = cross(self.w, cross(self.w, p));
        add(self.dv, add(cross(self.dw, p), centripetal))
    }

    /// The motion in the frame turned by gamma.
    #[inline(always)]
    pub(super) fn turned_back(&self, turn: &Turn) -> Self {
        let [w, dw, dv] = [self.w, self.dw, self.dv];
        Self { w: turn.transpose_times(w), dw: turn.transpose_times(dw), dv: turn.transpose_times(dv), ..*self }
    }

    /// The motion in the link's own axes, `x_here = axes x_link`.
    #[inline(always)]
    pub(crate) fn in_axes(&self, axes: &Mat3) -> Self {
        let [w, dw, dv] = [self.w, self.dw, self.dv];
        Self { w: transpose_times(axes, w), dw: transpose_times(axes, dw), dv: transpose_times(axes, dv), ..*self }
    }
}

#[derive(Debug, Clone, Copy, Default)]
struct Wrench<T = f64> {
    force: Vec3<T>,
    moment: Vec3<T>,
}

impl Workspace {
    /// Scratch for a model.
    #[must_use]
    pub fn new(model: &Model) -> Self {
        Self::like(model, 0.0)
    }
}

impl<T: Copy> Workspace<T> {
    /// Scratch for numbers of a kind.
    #[inline(always)]
    pub(crate) fn like(model: &Model, kind: T) -> Self
    where
        T: Real,
    {
        let (n, links, zero) = (model.coordinate_count(), model.link_count(), kind.like(0.0));
        let none = [zero; 3];
        Self {
            links: vec![LinkMotion::at_rest(kind, [0.0; 3]); links],
            twists: vec![Twist { angular: none, linear: none }; model.twist_count()],
            wrenches: vec![Wrench { force: none, moment: none }; links],
            composite: vec![Inertial::<f64>::default().in_lanes(kind); links],
            link_masses: vec![zero; links * links],
            mass_matrix: vec![zero; n * n],
            rhs: vec![zero; n],
            zeros: vec![zero; n],
        }
    }
}

impl<T> Workspace<T> {
    /// The mass matrix of the last forward dynamics, as `L` with `1/D` on its diagonal.
    pub(crate) fn factored_mass_matrix(&self) -> &[T] {
        &self.mass_matrix
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
        let state = [q, dq, ddq];
        pulp::Arch::new().dispatch(InverseDynamics { model: self, parameters, state, sign, workspace, tau });
    }

    /// The same of states side by side.
    #[inline(always)]
    pub(super) fn inverse_dynamics_of<T: Real, P: Parameter<T>>(
        &self,
        parameters: &DynamicParameters<P>,
        [q, dq, ddq]: [&[T]; 3],
        sign: Sign,
        workspace: &mut Workspace<T>,
        tau: &mut [T],
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
        let state = [q, dq, tau];
        let kernel = ForwardDynamics { model: self, parameters, state, sign, workspace, ddq };
        pulp::Arch::new().dispatch(kernel).map_err(|(coordinate, pivot)| DynamicsError::MassMatrixNotPositiveDefinite {
            joint: self.coordinates[coordinate] + 1,
            pivot,
        })
    }

    /// The same of states side by side. The error is the coordinate and the pivots, of which one is not positive.
    #[inline(always)]
    pub(crate) fn forward_dynamics_of<T: Real, P: Parameter<T>>(
        &self,
        parameters: &DynamicParameters<P>,
        [q, dq, tau]: [&[T]; 3],
        sign: Sign,
        workspace: &mut Workspace<T>,
        ddq: &mut [T],
    ) -> Result<(), (usize, T)> {
        let mut bias = std::mem::take(&mut workspace.rhs);
        let zeros = std::mem::take(&mut workspace.zeros);
        self.inverse_dynamics_of(parameters, [q, dq, &zeros], sign, workspace, &mut bias);
        self.lower_mass_matrix(parameters, workspace);
        for (a, (t, b)) in ddq.iter_mut().zip(tau.iter().zip(&bias)) {
            *a = *t - *b;
        }
        workspace.rhs = bias;
        workspace.zeros = zeros;
        solve_positive_definite(&mut workspace.mass_matrix, ddq)
    }

    /// The mass matrix `M(q)`, row by row: `M = d tau / d ddq`, motor inertias and their coupling included.
    pub fn mass_matrix(&self, parameters: &DynamicParameters, q: &[f64], workspace: &mut Workspace, m: &mut [f64]) {
        pulp::Arch::new().dispatch(MassMatrix { model: self, parameters, q, workspace });
        let n = self.coordinate_count();
        m.copy_from_slice(&workspace.mass_matrix);
        for i in 1..n {
            let (above, row) = m.split_at_mut(i * n);
            above.chunks_exact_mut(n).zip(row).for_each(|(upper, lower)| upper[i] = *lower);
        }
    }

    /// The placements of the links alone.
    #[inline(always)]
    pub(super) fn place(&self, q: &[f64], links: &mut [LinkMotion]) {
        for (joint, link) in self.joints.iter().zip(links) {
            (link.r, link.p) = joint.placement(q);
        }
    }

    /// Kinetic and potential energy in J, motor inertias included. The potential is zero at the base's origin.
    pub fn energy(&self, parameters: &DynamicParameters, q: &[f64], dq: &[f64], workspace: &mut Workspace) -> f64 {
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

    /// Forward pass of recursive Newton-Euler: placement, velocity and acceleration of every link.
    #[inline(always)]
    pub(crate) fn propagate_motion<T: Real>(&self, q: &[T], dq: &[T], ddq: &[T], links: &mut [LinkMotion<T>]) {
        let Some(&kind) = q.first() else { return };
        let base = LinkMotion::at_rest(kind, scale(-1.0, self.gravity));
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
            tau[joint.coordinate] += wrench.along(joint.revolute) * joint.ratio;
            if let Some(of_parent) = workspace.wrenches.get_mut(joint.parent) {
                of_parent.absorb(&wrench.moved_to_parent(&workspace.links[j], joint.turn.as_ref()));
            }
        }
    }

    /// Motor inertia, friction and offset of the joints, and the cross terms of the coupled motors.
    #[inline(always)]
    pub(super) fn add_drive_torques<T: Real, P: Parameter<T>>(
        &self,
        parameters: &DynamicParameters<P>,
        dq: &[T],
        ddq: &[T],
        sign: Sign,
        tau: &mut [T],
    ) {
        for (joint, own) in self.joints.iter().zip(&parameters.friction) {
            let velocity = joint.rate(dq);
            let inertia = own.ia.in_lanes(velocity);
            let torque = joint.rate(ddq) * inertia + own.friction(velocity, sign.of_each(velocity));
            tau[joint.coordinate] += torque * joint.ratio;
        }
        for (motor, of_motor) in self.coupled_motors().iter().zip(&parameters.motors) {
            let rate = motor.rate(dq);
            let (iam, fvm) = (of_motor.iam.in_lanes(rate), of_motor.fvm.in_lanes(rate));
            let coulomb = sign.of_each(rate) * of_motor.fcm.in_lanes(rate);
            for &(j, w) in &motor.weights {
                tau[j] += coulomb * w;
            }
            for (j, k, w) in motor.cross_terms() {
                tau[j] += (ddq[k] * iam + dq[k] * fvm) * w;
            }
        }
    }

    /// The lower triangle of the mass matrix of the coordinates; the placements must be in the workspace.
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

    /// The lower triangle of the mass matrix of all joints, as if none followed another, by composite rigid bodies from
    /// the tips to the base: the wrench of each joint's unit acceleration is carried to the base and meets the joints on
    /// the way.
    #[inline(always)]
    fn composite_rigid_bodies<T: Real, P: Parameter<T>>(
        &self,
        parameters: &DynamicParameters<P>,
        links: &[LinkMotion<T>],
        composite: &mut [Inertial<T>],
        m: &mut [T],
    ) {
        for ((composite, own), link) in composite.iter_mut().zip(&parameters.links).zip(links) {
            *composite = own.in_lanes(link.dv[0]);
        }
        for (j, joint) in self.joints.iter().enumerate().rev() {
            let row = &mut m[j * links.len()..=j * links.len() + j];
            let mut wrench = composite[j].wrench_of_joint(joint.revolute);
            row[j] = wrench.along(joint.revolute);
            row[j] += parameters.friction[j].ia.in_lanes(row[j]);
            // All joints before are passed, not only those on the way: on a chain, no index waits for a parent's.
            let (mut outer, mut link) = (joint, &links[j]);
            for (i, (inner, entry)) in self.joints[..j].iter().zip(row).enumerate().rev() {
                if i != outer.parent {
                    *entry = entry.like(0.0);
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
    #[inline(always)]
    fn reduce_to_coordinates<T: Real>(&self, m: &[T], reduced: &mut [T]) {
        let (n, links) = (self.coordinate_count(), self.link_count());
        for entry in reduced.iter_mut() {
            *entry = entry.like(0.0);
        }
        for (i, first) in self.joints.iter().enumerate() {
            for (j, second) in self.joints[..=i].iter().enumerate() {
                let value = m[i * links + j] * (first.ratio * second.ratio);
                let (row, column) = (first.coordinate.max(second.coordinate), first.coordinate.min(second.coordinate));
                let both = if i != j && row == column { 2.0 } else { 1.0 };
                reduced[row * n + column] += value * both;
            }
        }
    }
}

impl<T: Real> Inertial<T> {
    /// Force and moment about the frame's origin that move the link: `F = m dv + dw x ms + w x (w x ms)`,
    /// `N = J dw + w x J w + ms x dv`.
    #[inline(always)]
    fn wrench(&self, link: &LinkMotion<T>) -> Wrench<T> {
        let LinkMotion { w, dw, dv, .. } = *link;
        let force = add(scale(self.m, dv), add(cross(dw, self.ms), cross(w, cross(w, self.ms))));
        let gyroscopic = cross(w, times(&self.inertia, w));
        let moment = add(add(times(&self.inertia, dw), gyroscopic), cross(self.ms, dv));
        Wrench { force, moment }
    }

    /// The wrench of a unit acceleration about (revolute) or along (prismatic) the z axis.
    #[inline(always)]
    fn wrench_of_joint(&self, revolute: bool) -> Wrench<T> {
        let zero = self.m.like(0.0);
        if revolute {
            let moment = [self.inertia[0][2], self.inertia[1][2], self.inertia[2][2]];
            Wrench { force: [-self.ms[1], self.ms[0], zero], moment }
        } else {
            Wrench { force: [zero, zero, self.m], moment: [self.ms[1], -self.ms[0], zero] }
        }
    }

    /// The same body about the origin of the frame before.
    ///
    /// With the first moments rotated to `s = R ms`: `J' = R J R^T + (2 p.s + m p.p) 1 - (p s^T + s p^T + m p p^T)`.
    #[inline(always)]
    fn moved_to_parent(&self, link: &LinkMotion<T>, turn: Option<&Turn>) -> Self {
        let p = link.p;
        let s = link.r.times(self.ms);
        let mut inertia = link.r.rotate_symmetric(&self.inertia);
        let spherical = dot(p, s) * 2.0 + self.m * dot(p, p);
        for i in 0..3 {
            for j in 0..3 {
                inertia[i][j] -= p[i] * s[j] + s[i] * p[j] + self.m * p[i] * p[j];
            }
            inertia[i][i] += spherical;
        }
        let ms = add(s, scale(self.m, p));
        match turn {
            None => Self { inertia, ms, m: self.m },
            Some(turn) => Self { inertia: turn.rotate_symmetric(&inertia), ms: turn.times(ms), m: self.m },
        }
    }

    #[inline(always)]
    fn absorb(&mut self, other: &Self) {
        for (mine, theirs) in self.inertia.iter_mut().zip(&other.inertia) {
            *mine = add(*mine, *theirs);
        }
        self.ms = add(self.ms, other.ms);
        self.m += other.m;
    }
}

impl<T: Real> Wrench<T> {
    /// The component that the joint's drive carries.
    #[inline(always)]
    fn along(&self, revolute: bool) -> T {
        if revolute { self.moment[2] } else { self.force[2] }
    }

    #[inline(always)]
    fn moved_to_parent(&self, link: &LinkMotion<T>, turn: Option<&Turn>) -> Self {
        let force = link.r.times(self.force);
        let moment = add(link.r.times(self.moment), cross(link.p, force));
        match turn {
            None => Self { force, moment },
            Some(turn) => Self { force: turn.times(force), moment: turn.times(moment) },
        }
    }

    #[inline(always)]
    fn absorb(&mut self, other: &Self) {
        self.force = add(self.force, other.force);
        self.moment = add(self.moment, other.moment);
    }
}
