//! The links of a URDF that make up each moving link of a robot.

use std::path::Path;

use super::places::{frame_in_carrier, new_indices, places};
use crate::robot::{Robot, RobotError, Solid, body::Frame, floating::Base, urdf};
use thetahat_ground::vector::{Mat3, Vec3, product, times};

/// A link of a URDF as a part of a moving link: the link of the moving joint itself, or one fixed or locked to it.
#[derive(Debug, Clone, PartialEq)]
#[doc(hidden)]
pub struct LinkPart {
    /// Its name.
    #[doc(hidden)]
    pub name: String,
    /// The index of the moving link; none for parts of the base.
    #[doc(hidden)]
    pub carrier: Option<usize>,
    /// Whether it is the link of the moving joint itself.
    #[doc(hidden)]
    pub is_carrier: bool,
    /// Its inertial parameters in the file, about the origin and in the axes of its own frame.
    #[doc(hidden)]
    pub own: [f64; 10],
    /// The inertial parameters about the origin and in the axes of the frame of the moving joint's link.
    #[doc(hidden)]
    pub in_carrier: [f64; 10],
    /// Its axes as columns and its origin in the frame of the moving joint, or of the base.
    #[doc(hidden)]
    pub placement: (Mat3, Vec3),
    /// Its collision shapes in the frame of the moving joint, or of the base.
    #[doc(hidden)]
    pub shapes: Vec<PlacedSolid>,
}

/// A solid in a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
#[doc(hidden)]
pub struct PlacedSolid {
    /// Its axes as columns.
    #[doc(hidden)]
    pub rotation: Mat3,
    /// Its origin, m.
    #[doc(hidden)]
    pub origin: Vec3,
    /// None for a mesh.
    #[doc(hidden)]
    pub solid: Option<Solid>,
}

impl Robot {
    /// The links of the URDF that this robot was read from, in the order of the file, with the moving links that they are parts
    /// of; joints that are locked in this robot move with their carriers.
    ///
    /// # Errors
    /// [`RobotError`] for a text that is not a URDF.
    #[doc(hidden)]
    pub fn parts_of_urdf(&self, text: &str, path: &Path) -> Result<Vec<LinkPart>, RobotError> {
        let base = Base::of(self.base_coordinates() > 0);
        let whole = urdf::read(text, path, urdf::Transmissions::Ignored, &[], base)?;
        let carrying = |link: &urdf::LinkBody| match link.carrier {
            Some(joint) => Some(joint + whole.base_coordinates()),
            None => whole.root_joint(),
        };
        let value = |name: &str| self.locked.iter().find(|l| l.name == name).map(|l| l.value);
        let locked: Vec<Option<f64>> = whole.joints.iter().map(|joint| value(&joint.name)).collect();
        let (places, numbers) = (places(&whole.joints, &locked), new_indices(&locked));
        let part = |link: urdf::LinkBody| {
            let place = carrying(&link).map(|joint| (joint, places[joint]));
            let is_carrier = link.is_carrier || (link.is_root && place.is_some());
            let frame = match place {
                Some((joint, place)) if locked[joint].is_some() => frame_in_carrier(&whole, joint, &place),
                Some(_) | None => Frame::SAME,
            };
            let carrier = place.and_then(|(_, place)| place.carrier).and_then(|carrier| numbers[carrier]);
            let in_carrier = frame.then(&link.frame);
            let (rotation, origin) = self.in_joint(carrier, &in_carrier);
            LinkPart {
                carrier,
                is_carrier: is_carrier && place.is_some_and(|(joint, _)| locked[joint].is_none()),
                own: link.body.parameters(),
                in_carrier: link.body.seen_in(&in_carrier).parameters(),
                placement: (rotation, origin),
                shapes: link
                    .shapes
                    .iter()
                    .map(|(own, solid)| {
                        let (rotation, origin) = self.in_joint(carrier, &in_carrier.then(own));
                        PlacedSolid { rotation, origin, solid: *solid }
                    })
                    .collect(),
                name: link.name,
            }
        };
        Ok(urdf::link_bodies(text, path)?.into_iter().map(part).collect())
    }

    /// Transforms a frame given in a joint's link to the joint's own frame.
    fn in_joint(&self, carrier: Option<usize>, frame: &Frame) -> (Mat3, Vec3) {
        match carrier.and_then(|joint| self.joints[joint].link_axes) {
            None => (frame.rotation, frame.origin),
            Some(axes) => (product(&axes, &frame.rotation), times(&axes, frame.origin)),
        }
    }
}
