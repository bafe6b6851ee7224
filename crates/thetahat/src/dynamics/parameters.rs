use super::Model;
use crate::{
    real::Real,
    robot::{INERTIAL, Quantity},
    vector::{Mat3, Vec3, like, times, turned},
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
            Self::Smooth { scale } => smooth_sign(v / v.like(scale)),
        }
    }
}

/// Beyond this argument tanh is one to the last bit.
const SATURATED: f64 = 19.1;

#[inline(always)]
fn smooth_sign<T: Real>(x: T) -> T {
    let between = |x: f64| if x.abs() > SATURATED { x.signum() } else { x.tanh() };
    let square = x * x;
    // Mostly, every lane is beyond.
    if (square - x.like(SATURATED * SATURATED)).is_positive() { sign_or(x, x) } else { x.map(between) }
}

/// -1 or 1, and `at_zero` where x is neither below nor above.
#[inline(always)]
fn sign_or<T: Real>(x: T, at_zero: T) -> T {
    let zero = x.like(0.0);
    x.select_less(zero, x.like(-1.0), zero.select_less(x, x.like(1.0), at_zero))
}

/// A vector of standard parameters, sorted for the kernels.
#[derive(Debug, Clone)]
pub struct DynamicParameters {
    pub(super) links: Vec<Inertial>,
    pub(super) friction: Vec<JointParameters>,
    pub(super) motors: Vec<MotorParameters>,
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
pub(super) struct JointParameters {
    pub(super) ia: f64,
    pub(super) fv: [f64; 2],
    pub(super) fc: [f64; 2],
    pub(super) off: f64,
}

/// Cross inertia, cross viscous friction and Coulomb friction of one coupled motor.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct MotorParameters {
    pub(super) iam: f64,
    pub(super) fvm: f64,
    pub(super) fcm: f64,
}

impl JointParameters {
    /// Friction and offset at velocity `dq`, whose sign is `s`.
    #[inline(always)]
    pub(super) fn friction<T: Real>(&self, dq: T, s: T) -> T {
        let one = s.like(1.0);
        let (positive, negative) = ((one + s) * 0.5, (one - s) * 0.5);
        let (forwards, backwards) = (dq * self.fv[0] + s.like(self.fc[0]), dq * self.fv[1] - s.like(self.fc[1]));
        forwards * positive + backwards * negative + s.like(self.off)
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

impl Inertial {
    /// From the order of [`INERTIAL`].
    fn from_vector([xx, xy, xz, yy, yz, zz, mx, my, mz, m]: [f64; 10]) -> Self {
        Self { inertia: [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]], ms: [mx, my, mz], m }
    }

    /// The same in every lane.
    #[inline(always)]
    pub(super) fn like<T: Real>(&self, kind: T) -> Inertial<T> {
        let [x, y, z] = self.inertia;
        Inertial {
            inertia: [like(kind, x), like(kind, y), like(kind, z)],
            ms: like(kind, self.ms),
            m: kind.like(self.m),
        }
    }

    fn in_joint_axes(self, link_axes: Option<&Mat3>) -> Self {
        let Some(axes) = link_axes else { return self };
        Self { inertia: turned(axes, &self.inertia), ms: times(axes, self.ms), m: self.m }
    }
}
