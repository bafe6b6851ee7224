use std::{ops::Range, path::Path};

use super::file::RobotFile;
use crate::robot::{
    Friction, Locks, Parameter, Robot, RobotError, Transmission,
    body::RigidBody,
    floating::Base,
    locking::{LocksOf, merged, resolve_all},
    mjcf, urdf,
};

/// Default acceleration of gravity, m/s^2.
const GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];

/// The URDF or MJCF that a TOML stands on.
#[derive(Clone, Copy)]
pub(in crate::robot) struct Underlying<'a> {
    pub(in crate::robot) path: &'a Path,
    pub(in crate::robot) text: &'a str,
    /// The files of an MJCF.
    pub(in crate::robot) origins: &'a mjcf::Origins,
}

/// The robot of a TOML description, which refers to the text `below` if it names one, with the joints locked that it names
/// and then those `stated` elsewhere.
pub(in crate::robot) fn read(
    text: &str,
    path: &Path,
    below: Option<Underlying<'_>>,
    transmissions: urdf::Transmissions,
    stated: &[LocksOf<'_>],
) -> Result<Robot, RobotError> {
    let mut file: RobotFile = toml::from_str(text).map_err(|e| RobotError::of_toml(&e, path))?;
    let locks = Locks { locked: std::mem::take(&mut file.locked), until: std::mem::take(&mut file.until) };
    let locks: Vec<LocksOf<'_>> = [LocksOf { path, locks: &locks }].into_iter().chain(stated.iter().copied()).collect();
    let reader = Reader { path, text };
    let below = match below {
        Some(below) => reader.on_file(&file, &below, transmissions, &locks)?,
        None => reader.alone(&file)?,
    };
    let whole = reader.with_additions(below, file)?;
    let values = resolve_all(&whole.joints, &locks)?;
    merged(&whole, &values).map_err(|source| RobotError::lock(path, source))
}

/// Converts the parsed file to a robot; knows the positions of its entries.
pub(super) struct Reader<'a> {
    pub(super) path: &'a Path,
    pub(super) text: &'a str,
}

impl Reader<'_> {
    fn alone(&self, file: &RobotFile) -> Result<Robot, RobotError> {
        let name = file.name.clone().ok_or_else(|| self.value("name", "the robot's name", "missing"))?;
        let joints = self.joints(&file.joint, file.convention.unwrap_or_default())?;
        let coordinates = joints.iter().filter(|j| j.has_coordinate()).count();
        let robot = Robot {
            name,
            gravity: GRAVITY,
            joints,
            transmission: Transmission::direct(coordinates),
            friction: Friction::default(),
            a_priori: std::collections::BTreeMap::new(),
            loops: Vec::new(),
            locked: Vec::new(),
            doubts: Vec::new(),
            term_descriptions: Vec::new(),
            terms: Vec::new(),
        };
        Ok(match Base::of(file.floating_base) {
            Base::Fixed => robot,
            Base::Floating => robot.on_floating_base(&RigidBody::default()),
        })
    }

    fn on_file(
        &self,
        file: &RobotFile,
        below: &Underlying<'_>,
        transmissions: urdf::Transmissions,
        locks: &[LocksOf<'_>],
    ) -> Result<Robot, RobotError> {
        if !file.joint.is_empty() {
            return Err(self.value("joint", "none if urdf gives the joints", "[[joint]]"));
        }
        if file.convention.is_some() {
            return Err(self.value("convention", "none if urdf gives the joints", "a Denavit-Hartenberg convention"));
        }
        let own = file.transmission.as_ref().is_some_and(|t| t.matrix.is_some());
        let transmissions = if own { urdf::Transmissions::Ignored } else { transmissions };
        let base = Base::of(file.floating_base);
        match mjcf::is_mjcf(below.text) {
            true => mjcf::read(below.text, below.path, below.origins, transmissions, base),
            false => urdf::read(below.text, below.path, transmissions, locks, base),
        }
    }

    /// The settings of the file other than the joints, which override those of `robot`.
    fn with_additions(&self, mut robot: Robot, file: RobotFile) -> Result<Robot, RobotError> {
        let RobotFile { name, gravity, friction, transmission, parameters, term, loops, .. } = file;
        self.close_loops(&mut robot, loops)?;
        self.check_finite("gravity", gravity.into_iter().flatten())?;
        for (name, value) in &parameters {
            self.check_finite(&format!("[parameters] {name}"), [*value])?;
        }
        robot.name = name.unwrap_or(robot.name);
        robot.gravity = gravity.unwrap_or(robot.gravity);
        self.check_gravity(robot.gravity)?;
        if let Some(entry) = transmission {
            let base = robot.base_coordinates();
            let own = robot.transmission.without_base(base);
            robot.transmission = self.transmission(entry, &robot.joints[base..], &own)?.after_base(base);
        }
        robot.set_friction(friction.unwrap_or(robot.friction));
        // Terms may need a-priori values, and a-priori values may belong to terms.
        let mut described = robot.clone();
        described.a_priori.extend(parameters.clone());
        described
            .add_terms(&term)
            .map_err(|source| RobotError::Term { path: self.path.to_owned(), source: Box::new(source) })?;
        self.check_parameter_names(&described, parameters.keys())?;
        self.check_parameters(&described, &parameters)?;
        Ok(described)
    }

    fn check_parameter_names<'n>(
        &self,
        robot: &Robot,
        mut names: impl Iterator<Item = &'n String>,
    ) -> Result<(), RobotError> {
        let table = robot.parameter_table();
        let Some(name) = names.find(|name| table.index_of(name).is_none()) else { return Ok(()) };
        let known = table.iter().filter(|p| p.number == 1).map(Parameter::name).collect();
        Err(RobotError::UnknownParameter { path: self.path.to_owned(), name: name.clone(), known })
    }

    pub(super) fn check_finite(&self, key: &str, values: impl IntoIterator<Item = f64>) -> Result<(), RobotError> {
        match values.into_iter().find(|v| !v.is_finite()) {
            Some(found) => Err(RobotError::NotFinite { path: self.path.to_owned(), key: key.to_owned(), found }),
            None => Ok(()),
        }
    }

    pub(super) fn count(&self, key: &str, expected: usize, found: usize) -> Result<(), RobotError> {
        if expected == found {
            return Ok(());
        }
        Err(RobotError::WrongCount { path: self.path.to_owned(), key: key.to_owned(), expected, found })
    }

    pub(super) fn value(&self, key: &str, expected: &'static str, found: &str) -> RobotError {
        RobotError::Value { path: self.path.to_owned(), key: key.to_owned(), expected, found: found.to_owned() }
    }

    pub(super) fn line(&self, span: Range<usize>) -> usize {
        self.text[..span.start].matches('\n').count() + 1
    }
}
