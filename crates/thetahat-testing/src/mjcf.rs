//! A MuJoCo model as a user might write it, of the same robot as a model that thetahat has written.

use std::fmt::Write;

use roxmltree::{Document, Node};

type Vector = [f64; 3];
/// Rotation and origin.
type Frame = ([Vector; 3], Vector);

/// A model of the same mechanism in another notation: the base is mounted at an angle in the world, bodies have other frames, angles are in
/// degrees, poses use every notation, with classes, references and bodies fixed to links; inertias, armatures and friction are not those of
/// the robot.
///
/// # Panics
/// For a text that is not an MJCF of thetahat.
#[must_use]
pub fn users_mjcf(text: &str) -> String {
    let document = Document::parse(text).expect("an MJCF");
    let root = document.root_element();
    let child = |tag: &str| root.children().find(|node| node.tag_name().name() == tag);
    let gravity: Vector = numbers(child("option").expect("gravity"), "gravity");
    let mount = (turn([0.6, 0.0, 0.8], 40f64.to_radians()), [0.3, -0.2, 0.9]);
    let mut user = User { out: String::new(), count: 0 };
    let gravity = listed(&rotated(&mount.0, gravity));
    write!(
        user.out,
        "<mujoco model='mine'><!-- my own -->\r\n <compiler angle='degree' eulerseq='ZYx' boundmass='1e-12'/>\r\n\
         \t<option gravity=\"{gravity}\"  integrator='implicitfast'/>\r\n <default><joint damping='3'/><default class='arm'>\
         <joint armature='9' type='slide'/><geom density='0'/></default></default>\r\n <worldbody>\r\n  <light pos='0 0 3'/>\r\n  \
         <body name='mount' pos='0.3 -0.2 0.9' axisangle='0.6 0 0.8 40'><geom name='plate' size='0.1'/>\r\n"
    )
    .expect("a text");
    let identity = (turn([0.0, 0.0, 1.0], 0.0), [0.0; 3]);
    for body in bodies(child("worldbody").expect("bodies")) {
        user.body(body, &identity, 2);
    }
    user.out += "  </body>\r\n </worldbody>\r\n <actuator><!-- none --></actuator>\r\n</mujoco>\r\n";
    user.out
}

struct User {
    out: String,
    count: usize,
}

impl User {
    /// Writes a body with its children; `around` is the parent's frame relative to the frame that thetahat gave the parent.
    fn body(&mut self, body: Node<'_, '_>, around: &Frame, depth: usize) {
        self.count += 1;
        let (k, space) = (self.count, " ".repeat(depth));
        let amount = |scale: f64| (1.7 * k as f64 + scale).sin();
        let joint = body.children().find(|node| node.tag_name().name() == "joint").expect("a joint");
        let slides = joint.attribute("type") == Some("slide");
        let axis: Vector = numbers(joint, "axis");
        let own =
            (turn(unit([amount(1.0), amount(2.0), 0.4]), amount(3.0)), [0.1 * amount(4.0), 0.02, 0.1 * amount(5.0)]);
        // In the reference configuration the joint has another value.
        let reference = 20.0 * amount(6.0);
        let moved = if slides {
            (turn(axis, 0.0), axis.map(|a| 0.01 * reference * a))
        } else {
            (turn(axis, reference.to_radians()), [0.0; 3])
        };
        let given = (quaternion(numbers(body, "quat")), numbers(body, "pos"));
        let (rotation, origin) = after(&inverse(around), &after(&after(&given, &moved), &own));
        let [axis, place] = [rotated(&transposed(&own.0), axis), inverse(&own).1].map(|v| listed(&v));
        let name = body.attribute("name").expect("a name");
        let (x, y) = ([0, 1, 2].map(|i| rotation[i][0]), [0, 1, 2].map(|i| rotation[i][1]));
        let pose = format!("pos=\"{}\" xyaxes=\"{} {}\"", listed(&origin), listed(&x), listed(&y));
        // In the parent's element, or in a frame element.
        let (open, close) = if k.is_multiple_of(2) {
            (format!("{space}<frame {pose}><body childclass='arm' name='my_{name}'>"), "</body></frame>")
        } else {
            (format!("{space}<body {pose} name='my_{name}' childclass='arm'>"), "</body>")
        };
        let inertial = match k % 3 {
            0 => "",
            1 => "<inertial mass='3' pos='0 0 0.1' diaginertia='1 2 2.5' quat='0.8 0.6 0 0'/>",
            _ => "<inertial diaginertia='.1 .1 .1' pos='1 1 1' euler='10 20 30' mass='2'><!-- CAD --></inertial>",
        };
        let reference = if slides { 0.01 * reference } else { reference };
        let joint_name = joint.attribute("name").expect("a name");
        let kind = if slides { "" } else { " type='hinge'" };
        let fixed = "<body name='cover_";
        let askew = if k.is_multiple_of(2) { "zaxis='1 1 0'" } else { "euler='10 20 30'" };
        write!(
            self.out,
            "{open}\r\n{space}  {inertial}<joint ref='{reference}' name='{joint_name}'{kind} axis=\"{axis}\" pos=\"{place}\" />\r\n\
             {space}  {fixed}{k}' {askew} pos='.01 0 0'><inertial pos='0 .01 0' mass='1e-4' fullinertia='1e-7 1e-7 2e-7 0 0 0'/>\
             <geom size='.1'/></body>\r\n"
        )
        .expect("a text");
        bodies(body).for_each(|inner| self.body(inner, &own, depth + 2));
        self.out += &format!("{space}{close}\r\n");
    }
}

fn bodies<'a>(node: Node<'a, 'a>) -> impl Iterator<Item = Node<'a, 'a>> {
    node.children().filter(|child| child.tag_name().name() == "body")
}

fn numbers<const N: usize>(node: Node<'_, '_>, key: &str) -> [f64; N] {
    let values = node.attribute(key).unwrap_or_default().split(' ').map(|v| v.parse().expect("a number"));
    values.collect::<Vec<f64>>().try_into().expect("as many numbers")
}

fn listed(values: &[f64]) -> String {
    values.iter().map(f64::to_string).collect::<Vec<_>>().join(" ")
}

fn unit(v: Vector) -> Vector {
    let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
    v.map(|x| x / length)
}

fn rotated(r: &[Vector; 3], v: Vector) -> Vector {
    r.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

fn transposed(r: &[Vector; 3]) -> [Vector; 3] {
    [0, 1, 2].map(|j| [r[0][j], r[1][j], r[2][j]])
}

fn after(a: &Frame, b: &Frame) -> Frame {
    let columns = transposed(&b.0).map(|column| rotated(&a.0, column));
    let origin = rotated(&a.0, b.1);
    (transposed(&columns), [0, 1, 2].map(|i| a.1[i] + origin[i]))
}

fn inverse(a: &Frame) -> Frame {
    let back = transposed(&a.0);
    (back, rotated(&back, a.1).map(|x| -x))
}

fn turn([x, y, z]: Vector, angle: f64) -> [Vector; 3] {
    let (s, c) = (0.5 * angle).sin_cos();
    quaternion([c, s * x, s * y, s * z])
}

fn quaternion([w, x, y, z]: [f64; 4]) -> [Vector; 3] {
    [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ]
}
