//! A MuJoCo model with other inertias, armatures and friction: all other bytes stay unchanged.

use super::{
    element::Element,
    error::MjcfError,
    matched::{other_gravity, other_joints},
    model::{MjcfModel, ModelParts},
    written::{coupled_motors, inertial, tendon_name},
};
use crate::export::{
    body::Body,
    coupling::drive_without_tendons,
    editor::{Edited, Editor},
    represented::RepresentedRobot,
    split::{Shares, split},
    xml::{number, numbers},
};
use thetahat_model::{
    consistency::Symmetric,
    robot::{JointQuantity, RigidBody},
};

/// Attributes of an orientation, which must not accompany a full inertia tensor.
const ORIENTATIONS: [&str; 5] = ["quat", "axisangle", "xyaxes", "zaxis", "euler"];
/// Difference of axes that is rounding.
const ROUNDING: f64 = 1e-12;
/// MuJoCo's gravity if a model states none, m/s^2.
const USUAL_GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];

/// The model with the inertias and the drives of `represented`.
pub(in crate::export) fn edited(model: &MjcfModel, represented: &RepresentedRobot) -> Result<Edited, MjcfError> {
    model.with_robot(&represented.robot, |found| {
        let mut edit = Edit { editor: Editor::new(model.text()), found: &found, represented, notes: Vec::new() };
        for k in 0..represented.robot.joints.len() {
            edit.set_link(k)?;
            edit.set_joint(k);
        }
        edit.set_tendons()?;
        edit.note_differences()?;
        Ok(Edited { text: edit.editor.finished(), notes: edit.notes })
    })
}

struct Edit<'a, 'f> {
    editor: Editor<'a>,
    found: &'f ModelParts<'f>,
    represented: &'f RepresentedRobot,
    notes: Vec<String>,
}

/// A body that is fixed to another, with its inertial parameters there.
struct Fixed<'a> {
    inertial: Element<'a>,
    name: String,
    parameters: [f64; 10],
}

impl<'f> Edit<'_, 'f> {
    fn set_link(&mut self, k: usize) -> Result<(), MjcfError> {
        let found = self.found;
        let matched = &found.matched;
        let link = RigidBody::from_parameters(self.represented.inertial_of(k));
        let whole = link.seen_in(&matched.link_in_body(&self.represented.robot, k)).parameters();
        let fixed = self.fixed(k)?;
        let shares = split(whole, &fixed.iter().map(|part| part.parameters).collect::<Vec<_>>());
        let body = Body::new(shares.carrier);
        let element = matched.tree.bodies[matched.body(k)].element;
        self.require_above_bounds(element, &body)?;
        self.set_body(matched.tree.bodies[matched.body(k)].inertial, element, &body);
        if !fixed.is_empty() {
            self.note_split(&shares, &fixed, element);
        }
        Ok(())
    }

    /// The bodies that move with link `k` and have inertia.
    fn fixed(&self, k: usize) -> Result<Vec<Fixed<'f>>, MjcfError> {
        let ModelParts { matched, settings, .. } = self.found;
        let joint = || self.represented.robot.joints[k].name.clone();
        if let Some(made) = matched.tree.bodies[matched.body(k)].made {
            return Err(MjcfError::Made { place: made.place(), joint: joint() });
        }
        let mut fixed = Vec::new();
        for (b, frame) in matched.moving_with(k) {
            let body = &matched.tree.bodies[b];
            match (body.inertial, body.heavy, body.made) {
                (_, _, Some(made)) => return Err(MjcfError::Made { place: made.place(), joint: joint() }),
                (None, Some(_), None) => {
                    return Err(MjcfError::NoInertial { place: body.element.place(), joint: joint() });
                }
                (None, None, None) => {}
                (Some(inertial), _, None) => {
                    let parameters = settings.body(inertial)?.seen_in(&frame).parameters();
                    fixed.push(Fixed { inertial, name: body.element.name(), parameters });
                }
            }
        }
        Ok(fixed)
    }

    fn note_split(&mut self, shares: &Shares, fixed: &[Fixed<'_>], body: Element<'_>) {
        if shares.factor != 1.0 {
            for part in fixed {
                for key in ["mass", "diaginertia", "fullinertia"] {
                    let Some(values) = part.inertial.attribute(key) else { continue };
                    let scaled: Vec<f64> =
                        values.split_ascii_whitespace().flat_map(str::parse).map(|v: f64| shares.factor * v).collect();
                    self.editor.set(part.inertial.node, key, &numbers(&scaled));
                }
            }
        }
        let names: Vec<&str> = fixed.iter().map(|part| part.name.as_str()).collect();
        self.notes.push(shares.in_words(&names, &body.name()));
    }

    fn set_body(&mut self, inertial_element: Option<Element<'_>>, of: Element<'_>, body: &Body) {
        let Some(element) = inertial_element else {
            let line = format!("{}  {}", self.editor.indentation(of.node), inertial(body));
            self.editor.insert_first(of.node, &line);
            return;
        };
        let [xx, xy, xz, yy, yz, zz] = body.six();
        let full = numbers(&[xx, yy, zz, xy, xz, yz]);
        self.editor.set(element.node, "pos", &numbers(&body.centre));
        self.editor.set(element.node, "mass", &number(body.mass));
        if element.attribute("fullinertia").is_some() {
            self.editor.set(element.node, "fullinertia", &full);
            self.editor.remove(element.node, "diaginertia");
        } else if element.attribute("diaginertia").is_some() {
            self.editor.replace(element.node, "diaginertia", &format!("fullinertia=\"{full}\""));
        } else {
            self.editor.set(element.node, "fullinertia", &full);
        }
        ORIENTATIONS.iter().for_each(|key| self.editor.remove(element.node, key));
    }

    /// Refuses values that the compiler would raise to a bound: that would be another robot.
    fn require_above_bounds(&self, element: Element<'_>, body: &Body) -> Result<(), MjcfError> {
        let mut inertia = Symmetric::zeros(3);
        for (i, row) in body.inertia.iter().enumerate() {
            row.iter().enumerate().take(i + 1).for_each(|(j, entry)| inertia.add(i, j, *entry));
        }
        let smallest = inertia.eigenvalues().first().copied().unwrap_or(0.0);
        for (key, bound, compiler) in &self.found.settings.bounds {
            let found = if *key == "boundmass" { body.mass } else { smallest };
            if found < *bound {
                let (place, key, bound, body) = (compiler.place(), *key, *bound, element.name());
                return Err(MjcfError::Bound { place, key, bound, body, found });
            }
        }
        Ok(())
    }

    fn set_joint(&mut self, k: usize) {
        let RepresentedRobot { robot, parameters, tendons, .. } = self.represented;
        let [armature, damping] = drive_without_tendons(robot, parameters, tendons, k);
        let friction = self.represented.of_joint(JointQuantity::Fc, k);
        let matched = &self.found.matched;
        let joint = matched.tree.joints[matched.joints[k]].element.node;
        for (key, value) in [("armature", armature), ("damping", damping), ("frictionloss", friction)] {
            self.editor.set(joint, key, &number(value));
        }
    }

    /// Coupled motors: tendons of an earlier export are set, others are added at the end.
    fn set_tendons(&mut self) -> Result<(), MjcfError> {
        let mut added = self.represented.clone();
        added.tendons.clear();
        for tendon in &self.represented.tendons {
            let name = tendon_name(tendon);
            let Some(element) = self.found.tendon(&name) else {
                added.tendons.push(tendon.clone());
                continue;
            };
            self.found.require_same_tendon(element, tendon, &self.represented.robot)?;
            let [armature, damping, friction] = [tendon.armature, tendon.damping, tendon.friction_loss].map(number);
            for (key, value) in [("armature", armature), ("damping", damping), ("frictionloss", friction)] {
                self.editor.set(element.node, key, &value);
            }
        }
        let lines = coupled_motors(&added);
        if !lines.is_empty() {
            self.editor.insert_last(self.found.root.node, &lines);
        }
        Ok(())
    }

    fn note_differences(&mut self) -> Result<(), MjcfError> {
        let ModelParts { matched, root, .. } = self.found;
        let robot = &self.represented.robot;
        self.notes.extend(other_joints(matched, robot));
        if matched.difference > ROUNDING {
            self.notes.push(format!(
                "the axes of the model are within {:.1e} rad and m of the axes of the identified robot",
                matched.difference
            ));
        }
        let mut gravity = USUAL_GRAVITY;
        for option in root.named("option") {
            gravity = option.numbers("gravity")?.unwrap_or(gravity);
        }
        if other_gravity(matched, robot, gravity) {
            let [found, expected] = [matched.in_base(gravity), robot.gravity].map(|g| numbers(&g));
            self.notes.push(format!(
                "the gravity of the model stays; in the robot's base it is {found} m/s^2, and the robot was identified with {expected}"
            ));
        }
        Ok(())
    }
}
