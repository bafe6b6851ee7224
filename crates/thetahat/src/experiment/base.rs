//! The base of a robot that floats, as an experiment describes its recording: pose, contacts and measured forces.

use serde::Deserialize;

use thetahat_data::recording::{ChannelSource, Dimension, RecordingError};
use thetahat_ground::vector::{Mat3, quaternion_rotation};

/// The base of a robot that floats: its pose, and what touches the robot.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
#[doc(hidden)]
pub struct BaseDescription {
    /// The origin of the root body's frame in the world: three columns. Without it, `specific_force`.
    pub position: Option<ChannelSource>,
    /// What an accelerometer at the origin of the root body measures, along the axes of that body, m/s^2: three columns.
    pub specific_force: Option<ChannelSource>,
    /// The orientation of the root body's axes in the world: a quaternion, or roll, pitch and yaw.
    pub orientation: ChannelSource,
    /// The order of its columns.
    pub order: Orientation,
    /// What touches the robot from outside; none is `"measured"` with `contact`, and refused without.
    pub contacts: Option<Contacts>,
    /// The forces that were measured.
    #[serde(default)]
    pub contact: Vec<ContactDescription>,
}

/// The columns of an orientation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
#[doc(hidden)]
pub enum Orientation {
    /// A quaternion, its real part first.
    Wxyz,
    /// A quaternion, its real part last.
    Xyzw,
    /// Angles about x, then y, then z of the world.
    Rpy,
}

impl Orientation {
    pub(super) fn columns(self) -> usize {
        match self {
            Self::Wxyz | Self::Xyzw => 4,
            Self::Rpy => 3,
        }
    }

    /// Yaw, pitch and roll.
    pub(super) fn yaw_pitch_roll(self, columns: &[f64]) -> [f64; 3] {
        let of_quaternion = |[w, x, y, z]: [f64; 4]| {
            let length = [w, x, y, z].iter().map(|v| v * v).sum::<f64>().sqrt();
            yaw_pitch_roll(&quaternion_rotation([w, x, y, z].map(|v| v / length)))
        };
        match (self, columns) {
            (Self::Wxyz, &[w, x, y, z]) | (Self::Xyzw, &[x, y, z, w]) => of_quaternion([w, x, y, z]),
            (Self::Rpy, &[roll, pitch, yaw]) => [yaw, pitch, roll],
            (Self::Wxyz | Self::Xyzw | Self::Rpy, _) => [f64::NAN; 3],
        }
    }
}

/// The angles of a rotation `Rz(yaw) Ry(pitch) Rx(roll)`.
fn yaw_pitch_roll(r: &Mat3) -> [f64; 3] {
    [r[1][0].atan2(r[0][0]), (-r[2][0]).atan2(r[0][0].hypot(r[1][0])), r[2][1].atan2(r[2][2])]
}

/// What touches a robot from outside.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(untagged, expecting = "expected \"measured\", \"none\", \"base\", \"flight\", or a list of [start, end] in s")]
#[doc(hidden)]
pub enum Contacts {
    /// By a word.
    Named(NamedContacts),
    /// Nothing from each start to each end, s; something that was not measured at other times.
    NoneFrom(Vec<[f64; 2]>),
}

/// What touches a robot from outside, by a word.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
#[doc(hidden)]
pub enum NamedContacts {
    /// Forces that were all measured.
    Measured,
    /// Nothing.
    None,
    /// A rope, stand or hand that holds the base alone, with a force that was not measured.
    Base,
    /// Forces that were not measured, but where the robot is in flight.
    Flight,
}

/// A contact whose force was measured.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
#[doc(hidden)]
pub struct ContactDescription {
    /// The joint whose link is touched; none is the root body.
    pub link_of: Option<String>,
    /// Where, in the link's axes from the origin of the joint's frame, m.
    #[serde(default)]
    pub point_m: [f64; 3],
    /// The axes of force and moment.
    pub axes: WrenchAxes,
    /// The force on the robot, three columns, or with its moment about the point, six.
    pub force: ChannelSource,
}

/// The axes of a wrench.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
#[doc(hidden)]
pub enum WrenchAxes {
    /// Those of the world.
    World,
    /// Those of the link.
    Link,
}

/// The name of a channel that holds a contact's force until it is known at equal steps.
pub(super) fn channel(number: usize) -> String {
    format!("[[recording.base.contact]] {}", number + 1)
}

/// The name of the channel that holds the specific force.
pub(super) const SPECIFIC_FORCE: &str = "[recording.base] specific_force";

impl BaseDescription {
    /// The channels that it names.
    pub(super) fn sources(&self) -> impl Iterator<Item = &ChannelSource> {
        let own = self.position.iter().chain(&self.specific_force).chain([&self.orientation]);
        own.chain(self.contact.iter().map(|contact| &contact.force))
    }

    /// The same, to rename.
    pub(super) fn sources_mut(&mut self) -> impl Iterator<Item = &mut ChannelSource> {
        let own = self.position.iter_mut().chain(&mut self.specific_force).chain([&mut self.orientation]);
        own.chain(self.contact.iter_mut().map(|contact| &mut contact.force))
    }

    /// Refuses units of other quantities.
    pub(super) fn require_units(&self) -> Result<(), RecordingError> {
        let angles = match self.order {
            Orientation::Wxyz | Orientation::Xyzw => Dimension::Dimensionless,
            Orientation::Rpy => Dimension::Angle,
        };
        let require = |source: &Option<ChannelSource>, name: &str, dimension| {
            source.iter().try_for_each(|source| source.require_dimension(name, &[dimension]))
        };
        require(&self.position, "[recording.base] position", Dimension::Length)?;
        require(&self.specific_force, SPECIFIC_FORCE, Dimension::LinearAcceleration)?;
        self.orientation.require_dimension("[recording.base] orientation", &[angles])?;
        let effort = [Dimension::Force, Dimension::Torque];
        let mut contacts = self.contact.iter().enumerate();
        contacts.try_for_each(|(k, contact)| contact.force.require_dimension(&channel(k), &effort))
    }

    /// The channels other than the pose, by the names under which they are brought to equal steps.
    pub(super) fn channels(&self) -> impl Iterator<Item = (String, &ChannelSource)> {
        let contacts = self.contact.iter().enumerate().map(|(k, contact)| (channel(k), &contact.force));
        let own = self.specific_force.iter().map(|source| (SPECIFIC_FORCE.to_owned(), source));
        own.filter(|_| self.position.is_none()).chain(contacts)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_come_back_from_quaternions_in_either_order() {
        // Yaw 90 degrees, then pitch 30 degrees.
        let (a, b) = (std::f64::consts::FRAC_PI_4, 15f64.to_radians());
        let [w, x, y, z] = [a.cos() * b.cos(), -a.sin() * b.sin(), a.cos() * b.sin(), a.sin() * b.cos()];
        for found in [
            Orientation::Wxyz.yaw_pitch_roll(&[w, x, y, z]),
            Orientation::Xyzw.yaw_pitch_roll(&[2.0 * x, 2.0 * y, 2.0 * z, 2.0 * w]),
        ] {
            let expected = [2.0 * a, 2.0 * b, 0.0];
            assert!(found.iter().zip(expected).all(|(f, e)| (f - e).abs() < 1e-14), "{found:?}");
        }
        assert_eq!(Orientation::Rpy.yaw_pitch_roll(&[1.0, 2.0, 3.0]), [3.0, 2.0, 1.0]);
    }
}
