use super::{motion::LinkMotion, rotation::Turn};
use thetahat_ground::{
    real::{Parameter, Real},
    vector::{Mat3, Vec3, add, cross, dot, in_lanes, scale, times, turned},
};

/// Inertial parameters of one link about the origin of its frame.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Inertial<T = f64> {
    pub(super) inertia: Mat3<T>,
    pub(super) ms: Vec3<T>,
    pub(super) m: T,
}

/// Force, and moment about the origin of a frame, in that frame.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Wrench<T = f64> {
    pub(super) force: Vec3<T>,
    pub(super) moment: Vec3<T>,
}

impl Inertial {
    /// From the ten parameters in the order of [`crate::robot::INERTIAL`].
    pub(super) fn from_vector([xx, xy, xz, yy, yz, zz, mx, my, mz, m]: [f64; 10]) -> Self {
        Self { inertia: [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]], ms: [mx, my, mz], m }
    }

    /// Transforms from the link's own axes to its joint's frame, if they differ.
    pub(super) fn in_joint_axes(self, link_axes: Option<&Mat3>) -> Self {
        let Some(axes) = link_axes else { return self };
        Self { inertia: turned(axes, &self.inertia), ms: times(axes, self.ms), m: self.m }
    }
}

impl<P: Copy> Inertial<P> {
    /// The parameters as numbers of the kernels.
    #[inline(always)]
    pub(super) fn in_lanes<T: Real>(&self, kind: T) -> Inertial<T>
    where
        P: Parameter<T>,
    {
        let [x, y, z] = self.inertia;
        Inertial {
            inertia: [in_lanes(kind, x), in_lanes(kind, y), in_lanes(kind, z)],
            ms: in_lanes(kind, self.ms),
            m: self.m.in_lanes(kind),
        }
    }

    /// The parameters, each computed from the same one of several scalar sets.
    #[inline(always)]
    pub(super) fn from_numbers(number: impl Fn(&dyn Fn(&Inertial) -> f64) -> P) -> Self {
        Self {
            inertia: [0, 1, 2].map(|i| [0, 1, 2].map(|j| number(&|body| body.inertia[i][j]))),
            ms: [0, 1, 2].map(|i| number(&|body| body.ms[i])),
            m: number(&|body| body.m),
        }
    }
}

impl<T: Real> Inertial<T> {
    /// Force and moment about the frame's origin that accelerate the link: `F = m dv + dw x ms + w x (w x ms)`,
    /// `N = J dw + w x J w + ms x dv`.
    #[inline(always)]
    pub(super) fn wrench(&self, link: &LinkMotion<T>) -> Wrench<T> {
        let LinkMotion { w, dw, dv, .. } = *link;
        let force = add(scale(self.m, dv), add(cross(dw, self.ms), cross(w, cross(w, self.ms))));
        let gyroscopic = cross(w, times(&self.inertia, w));
        let moment = add(add(times(&self.inertia, dw), gyroscopic), cross(self.ms, dv));
        Wrench { force, moment }
    }

    /// The wrench of a unit acceleration about (revolute) or along (prismatic) the z axis.
    #[inline(always)]
    pub(super) fn wrench_of_joint(&self, revolute: bool) -> Wrench<T> {
        let zero = self.m.like(0.0);
        if revolute {
            let moment = [self.inertia[0][2], self.inertia[1][2], self.inertia[2][2]];
            Wrench { force: [-self.ms[1], self.ms[0], zero], moment }
        } else {
            Wrench { force: [zero, zero, self.m], moment: [self.ms[1], -self.ms[0], zero] }
        }
    }

    /// The body about the origin of the frame before.
    ///
    /// With the first moments rotated to `s = R ms`: `J' = R J R^T + (2 p.s + m p.p) 1 - (p s^T + s p^T + m p p^T)`.
    #[inline(always)]
    pub(super) fn moved_to_parent(&self, link: &LinkMotion<T>, turn: Option<&Turn>) -> Self {
        let p = link.p;
        let s = link.r.times(self.ms);
        let mut inertia = link.r.rotate_symmetric(&self.inertia);
        let spherical = dot(p, s) * 2.0 + self.m * dot(p, p);
        for i in 0..3 {
            for j in i..3 {
                inertia[i][j] -= p[i] * s[j] + s[i] * p[j] + self.m * p[i] * p[j];
                inertia[j][i] = inertia[i][j];
            }
            inertia[i][i] += spherical;
        }
        let ms = add(s, scale(self.m, p));
        match turn {
            None => Self { inertia, ms, m: self.m },
            Some(turn) => Self { inertia: turn.rotate_symmetric(&inertia), ms: turn.times(ms), m: self.m },
        }
    }

    /// Adds a body in the same frame.
    #[inline(always)]
    pub(super) fn absorb(&mut self, other: &Self) {
        for (mine, theirs) in self.inertia.iter_mut().zip(&other.inertia) {
            *mine = add(*mine, *theirs);
        }
        self.ms = add(self.ms, other.ms);
        self.m += other.m;
    }
}

impl<T: Real> Wrench<T> {
    /// The component transmitted to the joint's drive.
    #[inline(always)]
    pub(super) fn along(&self, revolute: bool) -> T {
        if revolute { self.moment[2] } else { self.force[2] }
    }

    /// The wrench about the origin of the frame before.
    #[inline(always)]
    pub(super) fn moved_to_parent(&self, link: &LinkMotion<T>, turn: Option<&Turn>) -> Self {
        let force = link.r.times(self.force);
        let moment = add(link.r.times(self.moment), cross(link.p, force));
        match turn {
            None => Self { force, moment },
            Some(turn) => Self { force: turn.times(force), moment: turn.times(moment) },
        }
    }

    /// Adds a wrench in the same frame.
    #[inline(always)]
    pub(super) fn absorb(&mut self, other: &Self) {
        self.force = add(self.force, other.force);
        self.moment = add(self.moment, other.moment);
    }
}
