use super::Model;
use pulp::Simd;

use crate::{
    real::{Lanes, Parameter, Real, sign_or, tanh},
    robot::{INERTIAL, Quantity},
    vector::{Mat3, Vec3, in_lanes, times, turned},
};

/// How the sign function of Coulomb friction is evaluated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sign {
    /// -1, 0 or 1: for measured velocities.
    Exact,
    /// `tanh(v / scale)`: for simulated velocities, with the scale in rad/s or m/s.
    Smooth {
        /// The velocity at which friction reaches 76 % of its Coulomb value.
        scale: f64,
    },
}

impl Sign {
    /// The sign of `v`.
    #[inline(always)]
    #[must_use]
    pub fn of(self, v: f64) -> f64 {
        self.of_each(v)
    }

    /// The sign in each lane; that of zero or NaN is itself.
    #[inline(always)]
    pub(crate) fn of_each<T: Real>(self, v: T) -> T {
        match self {
            Self::Exact => sign_or(v, v),
            Self::Smooth { scale } => tanh(v / v.like(scale)),
        }
    }
}

/// A vector of standard parameters, sorted for the kernels; or several side by side.
#[derive(Debug, Clone)]
pub struct DynamicParameters<P = f64> {
    pub(super) links: Vec<Inertial<P>>,
    pub(super) friction: Vec<JointParameters<P>>,
    pub(super) motors: Vec<MotorParameters<P>>,
}

/// Inertial parameters of one link about the origin of its frame.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Inertial<T = f64> {
    pub(super) inertia: Mat3<T>,
    pub(super) ms: Vec3<T>,
    pub(super) m: T,
}

/// Motor inertia, friction and offset of one joint; symmetric friction is held as equal sides.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct JointParameters<P = f64> {
    pub(super) ia: P,
    pub(super) fv: [P; 2],
    pub(super) fc: [P; 2],
    pub(super) off: P,
}

/// Cross inertia, cross viscous friction and Coulomb friction of one coupled motor.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct MotorParameters<P = f64> {
    pub(super) iam: P,
    pub(super) fvm: P,
    pub(super) fcm: P,
}

impl<P: Copy> JointParameters<P> {
    /// Friction and offset at velocity `dq`, whose sign is `s`.
    #[inline(always)]
    pub(super) fn friction<T: Real>(&self, dq: T, s: T) -> T
    where
        P: Parameter<T>,
    {
        let one = s.like(1.0);
        let (positive, negative) = ((one + s) * 0.5, (one - s) * 0.5);
        let forwards = dq * self.fv[0].in_lanes(s) + self.fc[0].in_lanes(s);
        let backwards = dq * self.fv[1].in_lanes(s) - self.fc[1].in_lanes(s);
        forwards * positive + backwards * negative + self.off.in_lanes(s)
    }
}

impl DynamicParameters {
    /// Sorts the standard parameters `theta`, in the order of the model's table, and turns those of each link into the
    /// axes of its joint's frame.
    ///
    /// # Panics
    /// If there is not one value for each standard parameter.
    #[must_use]
    pub fn new(model: &Model, theta: &[f64]) -> Self {
        let (table, links) = (model.parameter_table(), 0..model.link_count());
        assert_eq!(table.len(), theta.len(), "one value for each standard parameter");
        let value = |quantity, j| table.index(quantity, j).map_or(0.0, |i| theta[i]);
        let link =
            |k| Inertial::from_vector(INERTIAL.map(|quantity| value(quantity, k))).in_joint_axes(model.link_axes(k));
        Self {
            links: links.clone().map(link).collect(),
            friction: links.map(|j| joint_parameters(&|quantity| value(quantity, j))).collect(),
            motors: model
                .coupled_motors()
                .iter()
                .map(|m| motor_parameters(&|quantity| value(quantity, m.motor)))
                .collect(),
        }
    }
}

fn motor_parameters(value: &dyn Fn(Quantity) -> f64) -> MotorParameters {
    MotorParameters { iam: value(Quantity::Iam), fvm: value(Quantity::Fvm), fcm: value(Quantity::Fcm) }
}

/// Symmetric coefficients stand for both signs of the velocity.
fn joint_parameters(value: &dyn Fn(Quantity) -> f64) -> JointParameters {
    let (fv, fc) = (value(Quantity::Fv), value(Quantity::Fc));
    JointParameters {
        ia: value(Quantity::Ia),
        fv: [fv + value(Quantity::Fvp), fv + value(Quantity::Fvn)],
        fc: [fc + value(Quantity::Fcp), fc + value(Quantity::Fcn)],
        off: value(Quantity::Off),
    }
}

impl<P: Copy> Inertial<P> {
    /// As numbers of the kernels.
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
}

impl<S: Simd> DynamicParameters<Lanes<S>> {
    /// Those of each lane, which must be of the same model.
    #[inline(always)]
    pub(crate) fn side_by_side<'a>(simd: S, of_lane: impl Fn(usize) -> &'a DynamicParameters) -> Self {
        let lanes = |value: &dyn Fn(&DynamicParameters) -> f64| Lanes::from_fn(simd, |lane| value(of_lane(lane)));
        let link = |k: usize| Inertial {
            inertia: [0, 1, 2].map(|i| [0, 1, 2].map(|j| lanes(&|p| p.links[k].inertia[i][j]))),
            ms: [0, 1, 2].map(|i| lanes(&|p| p.links[k].ms[i])),
            m: lanes(&|p| p.links[k].m),
        };
        let joint = |k: usize| JointParameters {
            ia: lanes(&|p| p.friction[k].ia),
            fv: [0, 1].map(|side| lanes(&|p| p.friction[k].fv[side])),
            fc: [0, 1].map(|side| lanes(&|p| p.friction[k].fc[side])),
            off: lanes(&|p| p.friction[k].off),
        };
        let motor = |k: usize| MotorParameters {
            iam: lanes(&|p| p.motors[k].iam),
            fvm: lanes(&|p| p.motors[k].fvm),
            fcm: lanes(&|p| p.motors[k].fcm),
        };
        let first = of_lane(0);
        Self {
            links: (0..first.links.len()).map(link).collect(),
            friction: (0..first.friction.len()).map(joint).collect(),
            motors: (0..first.motors.len()).map(motor).collect(),
        }
    }
}

impl Inertial {
    /// From the order of [`INERTIAL`].
    fn from_vector([xx, xy, xz, yy, yz, zz, mx, my, mz, m]: [f64; 10]) -> Self {
        Self { inertia: [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]], ms: [mx, my, mz], m }
    }

    fn in_joint_axes(self, link_axes: Option<&Mat3>) -> Self {
        let Some(axes) = link_axes else { return self };
        Self { inertia: turned(axes, &self.inertia), ms: times(axes, self.ms), m: self.m }
    }
}
