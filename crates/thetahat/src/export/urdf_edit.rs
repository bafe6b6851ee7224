//! A URDF with other inertias and friction: bytes that do not say these stay as they are.

use std::{collections::BTreeMap, path::Path};

use roxmltree::{Document, Node};

use super::{
    body::Body,
    editor::{Edited, Editor, child},
    represented::RepresentedRobot,
    split::split,
    xml::{number, numbers},
};
use thetahat_model::robot::{JointQuantity, LinkPart, RobotError};

/// One step of indentation that is added.
const STEP: &str = "  ";

/// The URDF `text`, from which the robot was read, with the inertias and the friction of `represented`.
pub(super) fn edited(text: &str, represented: &RepresentedRobot) -> Result<Edited, RobotError> {
    let parts = represented.robot.parts_of_urdf(text, Path::new("the URDF of the results"))?;
    let (bodies, notes) = bodies(represented, &parts);
    let document = Document::parse(text)
        .map_err(|e| RobotError::Unreadable { path: "the URDF of the results".into(), reason: e.to_string() })?;
    let mut editor = Editor::new(text);
    for child in document.root_element().children().filter(Node::is_element) {
        let name = child.attribute("name").map(str::trim).unwrap_or_default();
        match child.tag_name().name() {
            "link" => bodies.get(name).into_iter().for_each(|body| editor.set_body(child, body)),
            "joint" => {
                let own = represented.robot.joints.iter().position(|joint| joint.name == name);
                own.into_iter().for_each(|joint| editor.set_friction(child, represented, joint));
            }
            _ => {}
        }
    }
    Ok(Edited { text: editor.finished(), notes })
}

/// The bodies of the links that change, by name.
fn bodies(represented: &RepresentedRobot, parts: &[LinkPart]) -> (BTreeMap<String, Body>, Vec<String>) {
    let (mut bodies, mut notes) = (BTreeMap::new(), Vec::new());
    for k in 0..represented.robot.joints.len() {
        let own = |part: &&LinkPart| part.carrier == Some(k);
        let fixed: Vec<&LinkPart> =
            parts.iter().filter(own).filter(|p| !p.is_carrier && p.own.iter().any(|v| *v != 0.0)).collect();
        let Some(carrier) = parts.iter().filter(own).find(|part| part.is_carrier) else { continue };
        let shares = split(represented.inertial_of(k), &fixed.iter().map(|part| part.in_carrier).collect::<Vec<_>>());
        bodies.insert(carrier.name.clone(), Body::new(shares.carrier));
        if fixed.is_empty() {
            continue;
        }
        if shares.factor != 1.0 {
            let scaled = fixed.iter().map(|p| (p.name.clone(), Body::new(p.own.map(|v| shares.factor * v))));
            bodies.extend(scaled);
        }
        let names: Vec<&str> = fixed.iter().map(|part| part.name.as_str()).collect();
        notes.push(shares.in_words(&names, &carrier.name));
    }
    (bodies, notes)
}

impl Editor<'_> {
    fn set_body(&mut self, link: Node<'_, '_>, body: &Body) {
        let Some(inertial) = child(link, "inertial") else {
            let own = self.indentation(link);
            self.insert_first(link, &inertial_lines(body, &own, self.line_end()));
            return;
        };
        let [xyz, values] = [numbers(&body.centre), number(body.mass)];
        match child(inertial, "origin") {
            Some(origin) => {
                self.set(origin, "xyz", &xyz);
                if origin.has_attribute("rpy") {
                    self.set(origin, "rpy", "0 0 0");
                }
            }
            None => {
                let first = inertial.children().find(Node::is_element);
                let before = first.map_or_else(String::new, |first| self.space_before(first));
                let at = first.map_or(inertial.range().end, |first| first.range().start);
                self.insert(at, format!("<origin xyz=\"{xyz}\" rpy=\"0 0 0\"/>{before}"));
            }
        }
        child(inertial, "mass").into_iter().for_each(|mass| self.set(mass, "value", &values));
        if let Some(inertia) = child(inertial, "inertia") {
            let keys = ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"];
            keys.into_iter().zip(body.six()).for_each(|(key, value)| self.set(inertia, key, &number(value)));
        }
    }

    fn set_friction(&mut self, joint: Node<'_, '_>, represented: &RepresentedRobot, index: usize) {
        let [damping, friction] = [JointQuantity::Fv, JointQuantity::Fc].map(|q| represented.of_joint(q, index));
        let [viscous, coulomb] = [number(damping), number(friction)];
        if let Some(dynamics) = child(joint, "dynamics") {
            self.set(dynamics, "damping", &viscous);
            self.set(dynamics, "friction", &coulomb);
        } else if damping != 0.0 || friction != 0.0 {
            let element = format!("<dynamics damping=\"{viscous}\" friction=\"{coulomb}\"/>");
            let last = joint.children().rfind(Node::is_element);
            if let Some(last) = last {
                let before = self.space_before(last);
                self.insert(last.range().end, format!("{before}{element}"));
            }
        }
    }
}

/// An `<inertial>` in lines, each after the indentation of its link.
pub(super) fn inertial_lines(body: &Body, own: &str, line_end: &str) -> String {
    let [xx, xy, xz, yy, yz, zz] = body.six().map(number);
    let lines = [
        format!("{own}{STEP}<inertial>"),
        format!("{own}{STEP}{STEP}<origin xyz=\"{}\" rpy=\"0 0 0\"/>", numbers(&body.centre)),
        format!("{own}{STEP}{STEP}<mass value=\"{}\"/>", number(body.mass)),
        format!(
            "{own}{STEP}{STEP}<inertia ixx=\"{xx}\" ixy=\"{xy}\" ixz=\"{xz}\" iyy=\"{yy}\" iyz=\"{yz}\" izz=\"{zz}\"/>"
        ),
        format!("{own}{STEP}</inertial>"),
    ];
    lines.join(line_end)
}
