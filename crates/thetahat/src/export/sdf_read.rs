//! An SDF that an export has written, read back.

use std::path::Path;

use roxmltree::{Document, Node};

use super::{editor, error::ExportError, frames::link_name, read_back::ReadLink, represented::RepresentedRobot};
use thetahat_ground::vector::{IDENTITY, Mat3, norm, scale, transpose, with_z};
use thetahat_model::robot::{Frame, Joint, RigidBody, parse_xml, roll_pitch_yaw};

/// The links of the exported robot as the file has them.
pub(super) fn read(text: &str, represented: &RepresentedRobot) -> Result<Vec<ReadLink>, ExportError> {
    let document: Document<'_> = parse_xml(text, Path::new("the export")).map_err(|e| missing(&e.to_string()))?;
    let model = child(document.root_element(), "model")?;
    let robot = &represented.robot;
    let root = robot.root_joint().map(link_name).unwrap_or_default();
    let of_joint = |(k, joint): (usize, &Joint)| match (joint.of_base, Some(k) == robot.root_joint()) {
        (false, _) => Link::read(model, joint),
        (true, is_root) => Link::of_base(model, joint, is_root.then_some(root.as_str())),
    };
    let links: Vec<Link<'_>> = robot.joints.iter().enumerate().map(of_joint).collect::<Result<_, _>>()?;
    let read = |(link, joint): (&Link<'_>, &Joint)| {
        if joint.of_base {
            return Ok(link.read_of_base(joint));
        }
        let before = joint.parent.map(|parent| &links[parent]);
        if link.carrier != before.map_or("world", |before| before.name) {
            return Err(missing(&format!("joint `{}` on the link that carries it", joint.name)));
        }
        let to_joint = |link: &Link<'_>| Frame { rotation: link.axes, origin: [0.0; 3] };
        let from = before.map_or(Frame::SAME, |before| to_joint(before).inverse());
        Ok(ReadLink {
            joint: from.then(&link.frame).then(&to_joint(link)),
            in_joint: link.body.seen_in(&to_joint(link).inverse()).parameters(),
            in_link: link.body.parameters(),
            armature: 0.0,
            damping: link.damping,
            friction: link.friction,
        })
    };
    links.iter().zip(&represented.robot.joints).map(read).collect()
}

/// A link with the joint in front of it.
struct Link<'a> {
    name: &'a str,
    /// The link on which its joint stands.
    carrier: &'a str,
    /// Its frame in that of the link that carries it.
    frame: Frame,
    /// From a frame with z along the joint's axis.
    axes: Mat3,
    body: RigidBody,
    damping: f64,
    friction: f64,
}

impl<'a> Link<'a> {
    fn read(model: Node<'a, 'a>, joint: &Joint) -> Result<Self, ExportError> {
        let element = named(model, "joint", &joint.name)?;
        let name = text(child(element, "child")?);
        let link = named(model, "link", name)?;
        let body = body_of(link)?;
        let axis = child(element, "axis")?;
        let dynamics = child(axis, "dynamics")?;
        let direction: [f64; 3] = numbers(child(axis, "xyz")?)?;
        Ok(Self {
            name,
            carrier: text(child(element, "parent")?),
            frame: pose(link)?,
            axes: with_z(scale(1.0 / norm(direction), direction)),
            body,
            damping: number(dynamics, "damping")?,
            friction: number(dynamics, "friction")?,
        })
    }

    /// One of a base that floats, which has no joint in the file: the root body by its name, or a massless one.
    fn of_base(model: Node<'a, 'a>, joint: &Joint, root: Option<&'a str>) -> Result<Self, ExportError> {
        let body = root.map(|name| body_of(named(model, "link", name)?)).transpose()?.unwrap_or_default();
        let axes = transpose(&joint.link_axes.unwrap_or(IDENTITY));
        let name = root.unwrap_or_default();
        Ok(Self { name, carrier: "", frame: Frame::SAME, axes, body, damping: 0.0, friction: 0.0 })
    }

    fn read_of_base(&self, joint: &Joint) -> ReadLink {
        let to_link = Frame { rotation: transpose(&self.axes), origin: [0.0; 3] };
        ReadLink {
            joint: Frame { rotation: joint.placement.rotation(), origin: joint.placement.origin },
            in_joint: self.body.seen_in(&to_link).parameters(),
            in_link: self.body.parameters(),
            armature: 0.0,
            damping: 0.0,
            friction: 0.0,
        }
    }
}

/// The body of a link.
fn body_of(link: Node<'_, '_>) -> Result<RigidBody, ExportError> {
    let inertial = child(link, "inertial")?;
    let inertia = child(inertial, "inertia")?;
    let entry = |tag| number(inertia, tag);
    let (xx, xy, xz) = (entry("ixx")?, entry("ixy")?, entry("ixz")?);
    let (yy, yz, zz) = (entry("iyy")?, entry("iyz")?, entry("izz")?);
    let inertia = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
    let body = RigidBody { m: number(inertial, "mass")?, ms: [0.0; 3], inertia };
    Ok(body.seen_in(&pose(inertial)?))
}

fn missing(what: &str) -> ExportError {
    ExportError::ReadBack { missing: what.to_owned() }
}

fn child<'a>(node: Node<'a, 'a>, tag: &str) -> Result<Node<'a, 'a>, ExportError> {
    editor::child(node, tag).ok_or_else(|| missing(&format!("<{tag}> in <{}>", node.tag_name().name())))
}

fn named<'a>(model: Node<'a, 'a>, tag: &str, name: &str) -> Result<Node<'a, 'a>, ExportError> {
    let mut elements = model.children().filter(|node| node.tag_name().name() == tag);
    let found = elements.find(|node| node.attribute("name") == Some(name));
    found.ok_or_else(|| missing(&format!("<{tag} name=\"{name}\">")))
}

fn text<'a>(node: Node<'a, 'a>) -> &'a str {
    node.text().unwrap_or_default().trim()
}

fn numbers<const N: usize>(node: Node<'_, '_>) -> Result<[f64; N], ExportError> {
    let all: Result<Vec<f64>, _> = node.text().unwrap_or_default().split_ascii_whitespace().map(str::parse).collect();
    let all = all.ok().and_then(|all| all.try_into().ok());
    all.ok_or_else(|| missing(&format!("{N} numbers in <{}>", node.tag_name().name())))
}

fn number(node: Node<'_, '_>, tag: &str) -> Result<f64, ExportError> {
    let element = editor::child(node, tag).ok_or_else(|| missing(&format!("<{tag}>")))?;
    let [number] = numbers(element)?;
    Ok(number)
}

/// The `<pose>` of an element.
fn pose(node: Node<'_, '_>) -> Result<Frame, ExportError> {
    let element = editor::child(node, "pose").ok_or_else(|| missing("<pose>"))?;
    let [x, y, z, roll, pitch, yaw] = numbers(element)?;
    Ok(Frame { rotation: roll_pitch_yaw([roll, pitch, yaw]), origin: [x, y, z] })
}
