//! A MuJoCo model as a robot: what an export has written, read back.

use super::{
    element::Element,
    error::MjcfError,
    model::{MjcfModel, ModelParts},
    written::tendon_name,
};
use crate::export::{coupling::Tendon, read_back::ReadLink, represented::RepresentedRobot};
use thetahat_model::robot::{RigidBody, Robot};

/// The links of the exported robot as the model has them, and whether the model's axes are those of the robot to rounding.
pub(in crate::export) struct ReadModel {
    pub(in crate::export) links: Vec<ReadLink>,
    pub(in crate::export) tendons: Vec<Tendon>,
    /// The largest difference of axes, rad and m.
    pub(in crate::export) difference: f64,
}

/// Reads what an export of `represented` has written.
pub(in crate::export) fn read(model: &MjcfModel, represented: &RepresentedRobot) -> Result<ReadModel, MjcfError> {
    model.with_robot(&represented.robot, |found| {
        let links =
            (0..represented.robot.joints.len()).map(|k| found.link(&represented.robot, k)).collect::<Result<_, _>>()?;
        let tendons = represented.tendons.iter().map(|tendon| found.read_tendon(tendon, &represented.robot));
        Ok(ReadModel { links, tendons: tendons.collect::<Result<_, _>>()?, difference: found.matched.difference })
    })
}

impl<'a> ModelParts<'a> {
    fn link(&self, robot: &Robot, k: usize) -> Result<ReadLink, MjcfError> {
        let matched = &self.matched;
        let own = matched.tree.bodies[matched.body(k)].inertial;
        let mut body = own.map_or(Ok(RigidBody::default()), |inertial| self.settings.body(inertial))?;
        for (b, frame) in matched.moving_with(k) {
            if let Some(inertial) = matched.tree.bodies[b].inertial {
                body.absorb(&self.settings.body(inertial)?.seen_in(&frame));
            }
        }
        let number = |key: &str| matched.tree.number(matched.joints[k], key);
        Ok(ReadLink {
            joint: matched.joint_in_parent(robot, k),
            in_joint: body.seen_in(&matched.joint_in_body(k).inverse()).parameters(),
            in_link: body.seen_in(&matched.link_in_body(robot, k).inverse()).parameters(),
            armature: number("armature")?,
            damping: number("damping")?,
            friction: number("frictionloss")?,
        })
    }

    fn read_tendon(&self, expected: &Tendon, robot: &Robot) -> Result<Tendon, MjcfError> {
        let Some(element) = self.tendon(&tendon_name(expected)) else {
            return Ok(Tendon { armature: 0.0, damping: 0.0, friction_loss: 0.0, ..expected.clone() });
        };
        self.require_same_tendon(element, expected, robot)?;
        let number = |key: &str| element.number(key).map(|value| value.unwrap_or(0.0));
        let [armature, damping, friction_loss] = [number("armature")?, number("damping")?, number("frictionloss")?];
        Ok(Tendon { armature, damping, friction_loss, ..expected.clone() })
    }

    /// The fixed tendon of a name.
    pub(super) fn tendon(&self, name: &str) -> Option<Element<'a>> {
        let mut tendons = self.root.named("tendon").flat_map(|section| section.named("fixed"));
        tendons.find(|tendon| tendon.attribute("name") == Some(name))
    }

    /// A tendon that is there must turn with the motor's joints.
    pub(super) fn require_same_tendon(
        &self,
        element: Element<'_>,
        expected: &Tendon,
        robot: &Robot,
    ) -> Result<(), MjcfError> {
        let mut found = Vec::new();
        for joint in element.named("joint") {
            found.push((joint.attribute("joint").unwrap_or_default(), joint.number("coef")?.unwrap_or(0.0)));
        }
        let name = |(joint, weight): &(usize, f64)| (robot.joints[*joint].name.as_str(), *weight);
        if found == expected.joints.iter().map(name).collect::<Vec<_>>() {
            return Ok(());
        }
        Err(MjcfError::OtherTendon { place: element.place() })
    }
}
