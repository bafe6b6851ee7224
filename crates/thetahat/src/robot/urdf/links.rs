use super::{UrdfError, element::Element};
use crate::vector::{IDENTITY, Mat3, Vec3, add, dot, product, scale, times, turned};

/// A frame in another: `x = rotation x' + origin`.
#[derive(Clone, Copy)]
pub(super) struct Frame {
    pub(super) rotation: Mat3,
    pub(super) origin: Vec3,
}

impl Frame {
    pub(super) const SAME: Self = Self { rotation: IDENTITY, origin: [0.0; 3] };

    /// The `<origin>` of an element; what is not given is zero.
    pub(super) fn of(element: Element<'_>) -> Result<Self, UrdfError> {
        let Some(origin) = element.child("origin") else { return Ok(Self::SAME) };
        let xyz = origin.vector("xyz")?.unwrap_or_default();
        let rpy = origin.angles("rpy")?.unwrap_or_default();
        Ok(Self { rotation: roll_pitch_yaw(rpy), origin: xyz })
    }

    /// A frame that is given in this one, in the frame in which this one is given.
    pub(super) fn then(&self, next: &Self) -> Self {
        Self {
            rotation: product(&self.rotation, &next.rotation),
            origin: add(self.origin, times(&self.rotation, next.origin)),
        }
    }
}

/// `Rot(z, yaw) Rot(y, pitch) Rot(x, roll)`.
fn roll_pitch_yaw([roll, pitch, yaw]: Vec3) -> Mat3 {
    let ((sr, cr), (sp, cp), (sy, cy)) = (roll.sin_cos(), pitch.sin_cos(), yaw.sin_cos());
    [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]
}

/// Mass, first moments and inertia about the origin of a frame.
#[derive(Clone, Copy, Default)]
pub(super) struct Body {
    pub(super) m: f64,
    pub(super) ms: Vec3,
    pub(super) inertia: Mat3,
}

impl Body {
    /// The `<inertial>` of a link, about the origin of the link's frame; zero without one.
    pub(super) fn of(link: Element<'_>) -> Result<Self, UrdfError> {
        let Some(inertial) = link.child("inertial") else { return Ok(Self::default()) };
        let remedy = "give it, or leave out the whole <inertial>";
        let mass = inertial.required_child("mass", remedy)?;
        let m = required_number(mass, "value", remedy)?;
        let inertia = inertial.required_child("inertia", remedy)?;
        let entry = |key| required_number(inertia, key, "all six of ixx ixy ixz iyy iyz izz are needed");
        let (xx, xy, xz) = (entry("ixx")?, entry("ixy")?, entry("ixz")?);
        let (yy, yz, zz) = (entry("iyy")?, entry("iyz")?, entry("izz")?);
        let about_center = Self { m, ms: [0.0; 3], inertia: [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]] };
        Ok(about_center.seen_in(&Frame::of(inertial)?))
    }

    /// The same body, given in a frame, about the origin in which that frame is given.
    pub(super) fn seen_in(&self, frame: &Frame) -> Self {
        let (p, s) = (frame.origin, times(&frame.rotation, self.ms));
        let mut inertia = turned(&frame.rotation, &self.inertia);
        let spherical = 2.0 * dot(p, s) + self.m * dot(p, p);
        for (i, row) in inertia.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                *entry -= p[i] * s[j] + s[i] * p[j] + self.m * p[i] * p[j];
            }
            row[i] += spherical;
        }
        Self { m: self.m, ms: add(s, scale(self.m, p)), inertia }
    }

    pub(super) fn absorb(&mut self, other: &Self) {
        self.m += other.m;
        self.ms = add(self.ms, other.ms);
        for (mine, theirs) in self.inertia.iter_mut().zip(&other.inertia) {
            *mine = add(*mine, *theirs);
        }
    }

    /// In the order of [`crate::robot::INERTIAL`].
    pub(super) fn parameters(&self) -> [f64; 10] {
        let [[xx, xy, xz], [_, yy, yz], [_, _, zz]] = self.inertia;
        let [mx, my, mz] = self.ms;
        [xx, xy, xz, yy, yz, zz, mx, my, mz, self.m]
    }
}

fn required_number(element: Element<'_>, key: &'static str, remedy: &'static str) -> Result<f64, UrdfError> {
    element.required(key, remedy)?;
    element.bounded_number(key)?.ok_or_else(|| element.missing(&format!("attribute {key}"), remedy))
}
