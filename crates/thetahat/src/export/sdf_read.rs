//! An SDF that an export has written, read back.

use std::path::Path;

use roxmltree::{Document, Node};

use super::{editor, error::ExportError, read_back::ReadLink, represented::RepresentedRobot};
use thetahat_ground::vector::{Mat3, norm, scale, with_z};
use thetahat_model::robot::{Frame, Joint, RigidBody, parse_xml, roll_pitch_yaw};

/// The links of the exported robot as the file has them.
pub(super) fn read(text: &str, represented: &RepresentedRobot) -> Result<Vec<ReadLink>, ExportError> {
    let document: Document<'_> = parse_xml(text, Path::new("the export")).map_err(|e| missing(&e.to_string()))?;
    let model = child(document.root_element(), "model")?;
    let links: Vec<Link<'_>> =
        represented.robot.joints.iter().map(|joint| Link::read(model, joint)).collect::<Result<_, _>>()?;
    let read = |(link, joint): (&Link<'_>, &Joint)| {
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
        let axis = child(element, "axis")?;
        let dynamics = child(axis, "dynamics")?;
        let direction: [f64; 3] = numbers(child(axis, "xyz")?)?;
        let inertial = child(link, "inertial")?;
        let inertia = child(inertial, "inertia")?;
        let entry = |tag| number(inertia, tag);
        let (xx, xy, xz, yy, yz, zz) =
            (entry("ixx")?, entry("ixy")?, entry("ixz")?, entry("iyy")?, entry("iyz")?, entry("izz")?);
        let body = RigidBody {
            m: number(inertial, "mass")?,
            ms: [0.0; 3],
            inertia: [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]],
        };
        Ok(Self {
            name,
            carrier: text(child(element, "parent")?),
            frame: pose(link)?,
            axes: with_z(scale(1.0 / norm(direction), direction)),
            body: body.seen_in(&pose(inertial)?),
            damping: number(dynamics, "damping")?,
            friction: number(dynamics, "friction")?,
        })
    }
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
