use std::{
    collections::BTreeMap,
    ops::Range,
    path::{Path, PathBuf},
};

use serde::Deserialize;
use toml::Spanned;

use super::{Friction, ParameterTable, RobotError, Transmission};
use crate::linear_algebra::Matrix;

/// How a joint moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum JointKind {
    /// Turns about its z axis; its coordinate is an angle in rad.
    Revolute,
    /// Slides along its z axis; its coordinate is a length in m.
    Prismatic,
}

/// A joint and the placement of its frame in modified Denavit-Hartenberg form.
///
/// Frame j in frame j-1 is `Rot(x, alpha) Trans(x, a) Rot(z, theta) Trans(z, d)`, where the joint's coordinate is
/// added to `theta` (revolute) or to `d` (prismatic).
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// Its name.
    pub name: String,
    /// How it moves.
    pub kind: JointKind,
    /// Distance along x of frame j-1, m.
    pub a: f64,
    /// Angle about x of frame j-1, rad.
    pub alpha: f64,
    /// Distance along z of frame j, m.
    pub d: f64,
    /// Angle about z of frame j, rad.
    pub theta: f64,
}

/// A serial robot with its transmission, friction model and a-priori parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Robot {
    /// Its name.
    pub name: String,
    /// Acceleration of gravity in the base frame, m/s^2.
    pub gravity: [f64; 3],
    /// The joints, from the base to the tool.
    pub joints: Vec<Joint>,
    /// Motors to joints.
    pub transmission: Transmission,
    /// The friction model of the joints.
    pub friction: Friction,
    /// A-priori values by parameter name, as from CAD; what is not listed is zero.
    pub a_priori: BTreeMap<String, f64>,
}

impl Robot {
    /// Reads a robot description.
    ///
    /// # Errors
    /// [`RobotError`], with the file and the line or key.
    pub fn read(path: &Path) -> Result<Self, RobotError> {
        let text = std::fs::read_to_string(path)
            .map_err(|e| RobotError::Unreadable { path: path.to_owned(), reason: e.to_string() })?;
        Self::parse(&text, path)
    }

    /// Reads a robot description from its text; `path` is its name in messages.
    ///
    /// # Errors
    /// As [`Robot::read`].
    pub fn parse(text: &str, path: &Path) -> Result<Self, RobotError> {
        let file: RobotFile = toml::from_str(text)
            .map_err(|e| RobotError::Syntax { path: path.to_owned(), message: e.to_string().trim_end().to_owned() })?;
        Reader { path, text }.robot(file)
    }

    /// Number of joints.
    #[must_use]
    pub fn joint_count(&self) -> usize {
        self.joints.len()
    }

    /// The table of standard parameters.
    #[must_use]
    pub fn parameter_table(&self) -> ParameterTable {
        let kinds: Vec<JointKind> = self.joints.iter().map(|j| j.kind).collect();
        ParameterTable::new(&kinds, self.friction, &self.transmission.coupled_motors())
    }

    /// The a-priori values in the order of the robot's table, zero where nothing is given.
    #[must_use]
    pub fn a_priori_parameters(&self) -> Vec<f64> {
        self.a_priori_parameters_for(&self.parameter_table())
    }

    /// The a-priori values in the order of a table, as of the same robot with another friction model.
    #[must_use]
    pub fn a_priori_parameters_for(&self, table: &ParameterTable) -> Vec<f64> {
        table.iter().map(|p| self.a_priori.get(&p.name()).copied().unwrap_or(0.0)).collect()
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RobotFile {
    name: String,
    #[serde(default = "standard_gravity")]
    gravity: [f64; 3],
    #[serde(default)]
    friction: Friction,
    joint: Vec<Spanned<JointEntry>>,
    transmission: Option<TransmissionEntry>,
    #[serde(default)]
    parameters: BTreeMap<String, f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct JointEntry {
    name: String,
    parent: Option<String>,
    kind: JointKind,
    #[serde(default)]
    a_m: f64,
    #[serde(default)]
    alpha_deg: f64,
    #[serde(default)]
    d_m: f64,
    #[serde(default)]
    theta_deg: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TransmissionEntry {
    matrix: Spanned<Vec<Vec<f64>>>,
    offset_deg: Option<Vec<f64>>,
    offset_m: Option<Vec<f64>>,
    drive_gain: Option<Vec<f64>>,
}

fn standard_gravity() -> [f64; 3] {
    [0.0, 0.0, -9.81]
}

/// Turns the parsed file into a robot; knows where in the file things stand.
struct Reader<'a> {
    path: &'a Path,
    text: &'a str,
}

impl Reader<'_> {
    fn robot(&self, file: RobotFile) -> Result<Robot, RobotError> {
        self.check_joint_names(&file.joint)?;
        let order = self.serial_order(&file.joint)?;
        let joints: Vec<Joint> = order.iter().map(|&j| joint(file.joint[j].as_ref())).collect();
        self.check_finite(&file, &joints)?;
        let transmission = self.transmission(file.transmission, &joints)?;
        let robot = Robot {
            name: file.name,
            gravity: file.gravity,
            joints,
            transmission,
            friction: file.friction,
            a_priori: file.parameters,
        };
        self.check_parameter_names(&robot)?;
        Ok(robot)
    }

    /// The joints from base to tool. Without any `parent`, that is the order of the file.
    fn serial_order(&self, joints: &[Spanned<JointEntry>]) -> Result<Vec<usize>, RobotError> {
        if joints.is_empty() {
            return Err(self.value("joint", "at least one [[joint]]", "an empty list"));
        }
        if joints.iter().all(|j| j.as_ref().parent.is_none()) {
            return Ok((0..joints.len()).collect());
        }
        let parents = joints.iter().map(|j| self.parent_index(joints, j)).collect::<Result<Vec<_>, _>>()?;
        self.check_no_cycle(joints, &parents)?;
        let mut order = Vec::new();
        let mut last = None;
        while order.len() < joints.len() {
            let children: Vec<usize> = (0..joints.len()).filter(|&j| parents[j] == last).collect();
            match children[..] {
                [only] => order.push(only),
                [_, second, ..] => return Err(self.not_serial(&joints[second], "is a second child of its parent")),
                [] => return Err(self.not_serial(&joints[0], "does not continue the chain")),
            }
            last = order.last().copied();
        }
        Ok(order)
    }

    fn check_joint_names(&self, joints: &[Spanned<JointEntry>]) -> Result<(), RobotError> {
        let name = |j: usize| &joints[j].as_ref().name;
        match (1..joints.len()).find(|&j| (0..j).any(|i| name(i) == name(j))) {
            Some(j) => Err(self.not_serial(&joints[j], "has the name of another joint")),
            None => Ok(()),
        }
    }

    fn parent_index(
        &self,
        joints: &[Spanned<JointEntry>],
        joint: &Spanned<JointEntry>,
    ) -> Result<Option<usize>, RobotError> {
        let Some(parent) = &joint.as_ref().parent else { return Ok(None) };
        let found = joints.iter().position(|j| j.as_ref().name == *parent);
        found.map(Some).ok_or_else(|| self.not_serial(joint, &format!("has the unknown parent `{parent}`")))
    }

    fn check_no_cycle(&self, joints: &[Spanned<JointEntry>], parents: &[Option<usize>]) -> Result<(), RobotError> {
        for start in 0..joints.len() {
            let mut path = vec![start];
            let mut at = start;
            while let Some(parent) = parents[at] {
                if let Some(first) = path.iter().position(|&j| j == parent) {
                    let mut cycle: Vec<String> =
                        path[first..].iter().map(|&j| joints[j].as_ref().name.clone()).collect();
                    cycle.push(cycle[0].clone());
                    let line = self.line(joints[path[first]].span());
                    return Err(RobotError::Cycle { path: self.path.to_owned(), line, joints: cycle });
                }
                path.push(parent);
                at = parent;
            }
        }
        Ok(())
    }

    fn transmission(&self, entry: Option<TransmissionEntry>, joints: &[Joint]) -> Result<Transmission, RobotError> {
        let n = joints.len();
        let Some(entry) = entry else {
            return Ok(Transmission::direct(n));
        };
        let line = self.line(entry.matrix.span());
        let matrix = entry.matrix.into_inner();
        self.count("[transmission] matrix", n, matrix.len())?;
        for (i, row) in matrix.iter().enumerate() {
            self.count(&format!("[transmission] matrix, row {}", i + 1), n, row.len())?;
        }
        let offset_deg = entry.offset_deg.unwrap_or_else(|| vec![0.0; n]);
        let offset_m = entry.offset_m.unwrap_or_else(|| vec![0.0; n]);
        let drive_gain = entry.drive_gain.unwrap_or_else(|| vec![1.0; n]);
        self.count("[transmission] offset_deg", n, offset_deg.len())?;
        self.count("[transmission] offset_m", n, offset_m.len())?;
        self.count("[transmission] drive_gain", n, drive_gain.len())?;
        let numbers = matrix.iter().flatten().chain(&offset_deg).chain(&offset_m);
        if let Some(number) = numbers.into_iter().find(|v| !v.is_finite()) {
            return Err(self.value("[transmission] a number", "finite numbers", &number.to_string()));
        }
        let of_kind = |kind, offset: &[f64]| joints.iter().zip(offset).any(|(j, o)| j.kind == kind && *o != 0.0);
        if of_kind(JointKind::Prismatic, &offset_deg) {
            return Err(self.value(
                "[transmission] offset_deg",
                "zero for prismatic joints (use offset_m)",
                "not zero",
            ));
        }
        if of_kind(JointKind::Revolute, &offset_m) {
            return Err(self.value("[transmission] offset_m", "zero for revolute joints (use offset_deg)", "not zero"));
        }
        if let Some(gain) = drive_gain.iter().find(|g| !(g.is_finite() && **g != 0.0)) {
            return Err(self.value("[transmission] drive_gain", "numbers other than zero", &gain.to_string()));
        }
        let offset = offset_deg.iter().zip(&offset_m).map(|(deg, m)| deg.to_radians() + m).collect();
        let singular = |reason| RobotError::SingularTransmission { path: self.path.to_owned(), line, reason };
        if let Some(row) = matrix.iter().position(|row| row.iter().all(|v| *v == 0.0)) {
            return Err(singular(format!("row {} is zero", row + 1)));
        }
        Transmission::new(Matrix::from_fn(n, n, |i, j| matrix[i][j]), offset, drive_gain)
            .ok_or_else(|| singular("its rows depend on one another".to_owned()))
    }

    fn check_finite(&self, file: &RobotFile, joints: &[Joint]) -> Result<(), RobotError> {
        let geometry = joints.iter().flat_map(|j| [j.a, j.alpha, j.d, j.theta]);
        let values = geometry.chain(file.gravity).chain(file.parameters.values().copied());
        match values.into_iter().find(|v| !v.is_finite()) {
            Some(v) => Err(self.value("a number in the description", "finite numbers", &v.to_string())),
            None => Ok(()),
        }
    }

    fn check_parameter_names(&self, robot: &Robot) -> Result<(), RobotError> {
        let table = robot.parameter_table();
        let Some(name) = robot.a_priori.keys().find(|name| table.index_of(name).is_none()) else { return Ok(()) };
        let known = table.iter().filter(|p| p.number == 1).map(super::Parameter::name).collect();
        Err(RobotError::UnknownParameter { path: self.path.to_owned(), name: name.clone(), known })
    }

    fn count(&self, key: &str, expected: usize, found: usize) -> Result<(), RobotError> {
        if expected == found {
            return Ok(());
        }
        Err(RobotError::WrongCount { path: self.path.to_owned(), key: key.to_owned(), expected, found })
    }

    fn value(&self, key: &str, expected: &'static str, found: &str) -> RobotError {
        RobotError::Value { path: self.path.to_owned(), key: key.to_owned(), expected, found: found.to_owned() }
    }

    fn not_serial(&self, joint: &Spanned<JointEntry>, problem: &str) -> RobotError {
        RobotError::NotSerial {
            path: PathBuf::from(self.path),
            line: self.line(joint.span()),
            joint: joint.as_ref().name.clone(),
            problem: problem.to_owned(),
        }
    }

    fn line(&self, span: Range<usize>) -> usize {
        self.text[..span.start].matches('\n').count() + 1
    }
}

fn joint(entry: &JointEntry) -> Joint {
    Joint {
        name: entry.name.clone(),
        kind: entry.kind,
        a: entry.a_m,
        alpha: entry.alpha_deg.to_radians(),
        d: entry.d_m,
        theta: entry.theta_deg.to_radians(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TWO_JOINTS: &str = r#"
name = "arm"
[[joint]]
name = "shoulder"
kind = "revolute"
[[joint]]
name = "slide"
parent = "shoulder"
kind = "prismatic"
alpha_deg = 90
[transmission]
matrix = [[10, 0], [5, 5]]
offset_deg = [90, 0]
[parameters]
zz1 = 0.5
"#;

    fn parse(text: &str) -> Result<Robot, RobotError> {
        Robot::parse(text, Path::new("arm.toml"))
    }

    #[test]
    fn a_valid_description_is_read() {
        let robot = parse(TWO_JOINTS).unwrap();
        assert_eq!(robot.joint_count(), 2);
        assert_eq!(robot.joints[1].kind, JointKind::Prismatic);
        assert_eq!(robot.gravity, [0.0, 0.0, -9.81]);
        assert_eq!(robot.transmission.coupled_motors(), vec![1]);
        assert_eq!(robot.a_priori_parameters()[robot.parameter_table().index_of("zz1").unwrap()], 0.5);
    }

    #[test]
    fn joints_are_ordered_by_their_parents() {
        let text = r#"
name = "arm"
[[joint]]
name = "b"
parent = "a"
kind = "revolute"
[[joint]]
name = "a"
kind = "revolute"
"#;
        let names: Vec<String> = parse(text).unwrap().joints.into_iter().map(|j| j.name).collect();
        assert_eq!(names, ["a", "b"]);
    }

    #[test]
    fn a_cycle_is_refused_with_its_joints() {
        let text = TWO_JOINTS.replacen("kind = \"revolute\"", "kind = \"revolute\"\nparent = \"slide\"", 1);
        match parse(&text).unwrap_err() {
            RobotError::Cycle { line, joints, .. } => {
                assert_eq!(line, 3);
                assert_eq!(joints, ["shoulder", "slide", "shoulder"]);
            }
            other => panic!("{other}"),
        }
    }

    #[test]
    fn a_branch_is_refused() {
        let text = TWO_JOINTS.replace("parent = \"shoulder\"\n", "");
        let text = format!(
            "{}{}",
            text.replace(
                "[transmission]",
                "[[joint]]\nname = \"third\"\nparent = \"slide\"\nkind = \"revolute\"\n[transmission]"
            ),
            ""
        );
        assert!(matches!(parse(&text).unwrap_err(), RobotError::NotSerial { .. }));
    }

    #[test]
    fn a_singular_matrix_is_refused_with_its_line() {
        let text = TWO_JOINTS.replace("[[10, 0], [5, 5]]", "[[10, 10], [5, 5]]");
        match parse(&text).unwrap_err() {
            RobotError::SingularTransmission { line, .. } => assert_eq!(line, 12),
            other => panic!("{other}"),
        }
    }

    #[test]
    fn a_short_row_is_refused() {
        let text = TWO_JOINTS.replace("[5, 5]]", "[5]]");
        assert!(matches!(parse(&text).unwrap_err(), RobotError::WrongCount { expected: 2, found: 1, .. }));
    }

    #[test]
    fn an_unknown_key_is_refused_with_line_and_the_known_ones() {
        let message = parse(&TWO_JOINTS.replace("alpha_deg", "alpha")).unwrap_err().to_string();
        assert!(message.contains("line 10") && message.contains("alpha_deg"), "{message}");
    }

    #[test]
    fn an_unknown_parameter_is_refused() {
        let text = TWO_JOINTS.replace("zz1 = 0.5", "zz7 = 0.5");
        assert!(matches!(parse(&text).unwrap_err(), RobotError::UnknownParameter { .. }));
    }
}
