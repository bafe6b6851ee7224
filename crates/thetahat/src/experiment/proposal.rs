//! An experiment file proposed from what is in a recording.

use std::{fmt::Write as _, path::PathBuf};

use super::column_names::{self, Reading, Signal};
use crate::{
    recording::{ColumnSummary, Contents, TableSummary, Unit},
    robot::{JointKind, Robot},
    visible::visible,
};

/// What a proposal is made for, and what is known already.
#[derive(Debug, Clone, Default)]
pub struct ProposalRequest {
    /// The robot description, as the experiment file is to name it.
    pub robot_file: PathBuf,
    /// The recording, as the experiment file is to name it.
    pub recording_file: PathBuf,
    /// Columns of the positions; none looks for them by their names.
    pub position: Vec<String>,
    /// Columns of the torques; none looks for them by their names.
    pub torque: Vec<String>,
    /// The time column; none looks for it.
    pub time: Option<String>,
    /// Samples per second, where there is no time column.
    pub sample_rate_hz: Option<f64>,
    /// The unit of the positions; none takes it from the names or the range.
    pub position_unit: Option<Unit>,
    /// The unit of the torques; none takes it from the names.
    pub torque_unit: Option<Unit>,
}

/// Why no experiment can be proposed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ProposalError {
    /// The columns of a signal cannot be told.
    #[error(
        "{}: the columns of the {signal} cannot be told from their names: {problem}; name them with --{signal} \
         NAME,NAME,... (one for each of {joints} joints); the columns are: {}",
        file.display(), columns.join(" ")
    )]
    UnclearColumns {
        /// The recording.
        file: PathBuf,
        /// `position` or `torque`.
        signal: &'static str,
        /// What was found instead.
        problem: String,
        /// Number of joints.
        joints: usize,
        /// The columns of the recording.
        columns: Vec<String>,
    },
    /// There is no time column and no rate.
    #[error("{}: no time column is found; name it with --time NAME or state --rate HZ; the columns are: {}",
        file.display(), columns.join(" "))]
    NoTime {
        /// The recording.
        file: PathBuf,
        /// The columns of the recording.
        columns: Vec<String>,
    },
    /// A column that was named is not there.
    #[error("{}: there is no column {name:?}; the columns are: {}", file.display(), columns.join(" "))]
    NoSuchColumn {
        /// The recording.
        file: PathBuf,
        /// The name.
        name: String,
        /// The columns of the recording.
        columns: Vec<String>,
    },
}

/// The dynamics of robots of this size: their motion and torques lie below, in Hz (the paper's section V-A).
const DYNAMICS_HZ: f64 = 10.0;
/// Cut-off of the position filter and of the parallel filter, in multiples of the dynamics' (section V-A).
const CUT_OFFS: [f64; 2] = [5.0, 2.0];
/// Part of the sample rate above which no position filter is proposed.
const HIGHEST_CUT_OFF: f64 = 0.2;
/// The parallel filter cuts at this part of the sample rate over the factor.
const DECIMATION_CUT_OFF: f64 = 0.4;
/// Joint angles beyond this, rad, are no joint angles in rad: more than two turns.
const LARGEST_ANGLE: f64 = 4.0 * std::f64::consts::PI;

/// The text of an experiment file for a robot and a recording, with what was guessed in its comments.
///
/// Least squares alone is proposed: the other methods need the controller, which no recording tells.
///
/// # Errors
/// [`ProposalError`] where columns cannot be told from their names; nothing is guessed from the order of columns.
pub fn propose(request: &ProposalRequest, robot: &Robot, contents: &Contents) -> Result<String, ProposalError> {
    let finder = Finder { request, robot, contents, table: chosen_table(request, contents) };
    let position = finder.signal(Signal::Position, "position", &request.position)?;
    let torque = finder.signal(Signal::Torque, "torque", &request.torque)?;
    let [velocity, reference] = [Signal::Velocity, Signal::Reference].map(|s| finder.by_name(s).ok());
    let clock = finder.clock()?;
    let rate = clock.rate_hz;
    let cutoff = (CUT_OFFS[0] * DYNAMICS_HZ).min(HIGHEST_CUT_OFF * rate);
    let decimation = (DECIMATION_CUT_OFF * rate / (CUT_OFFS[1] * DYNAMICS_HZ)).round().max(1.0);
    let mut text = String::new();
    let file = request.recording_file.display();
    // Writing to a string does not fail.
    let _ = write!(
        text,
        "# Proposed from {}. Read every line, then run `thetahat check`: it examines the units and signs.\n\
         title = {}\nrobot = {}\n\n[recording]\n{}",
        visible(&file.to_string()),
        quoted(&format!("{}: {file}", robot.name)),
        quoted(&request.robot_file.display().to_string()),
        clock.line,
    );
    let unit = finder.position_unit(&position);
    text += &finder.line("position", &position, unit);
    text += &finder.line("torque", &torque, finder.torque_unit(&torque));
    if let Some(reference) = reference {
        let unit = (finder.position_unit(&reference).0, "as the positions");
        text += &finder.line("reference", &reference, unit);
    }
    if let Some(velocity) = velocity {
        text += &finder.line("velocity", &velocity, velocity_unit(unit.0, robot));
    }
    let _ = write!(
        text,
        "\n# Cut-offs for motion and torques below {DYNAMICS_HZ} Hz: 5 times that for the positions, 2 times for the \
         rows.\n[signal]\ncutoff_hz = {cutoff}\ndecimation = {decimation}\n\n\
         # IDIM-IV and DIDIM simulate the closed loop: with the controller's law in [controller] (docs/experiments.md) \
         add\n# \"idim-iv\" and \"didim\".\n[estimation]\nmethods = [\"idim-ls\"]\n",
    );
    Ok(text)
}

/// The table with the most columns of the signals needed, the first of equals.
fn chosen_table<'a>(request: &ProposalRequest, contents: &'a Contents) -> Option<&'a TableSummary> {
    let wanted = |c: &&ColumnSummary| {
        let named = request.position.iter().chain(&request.torque).any(|name| name == &c.name);
        named || matches!(column_names::read(&c.name), Some(r) if matches!(r.signal, Signal::Position | Signal::Torque))
    };
    let score = |t: &&TableSummary| t.columns.iter().filter(wanted).count();
    contents.tables.iter().rev().max_by_key(score)
}

struct Finder<'a> {
    request: &'a ProposalRequest,
    robot: &'a Robot,
    contents: &'a Contents,
    table: Option<&'a TableSummary>,
}

struct ProposedClock {
    rate_hz: f64,
    line: String,
}

impl<'a> Finder<'a> {
    /// The columns of a signal: those named in the request, or those that their names tell.
    fn signal(
        &self,
        signal: Signal,
        word: &'static str,
        named: &[String],
    ) -> Result<Vec<&'a ColumnSummary>, ProposalError> {
        if !named.is_empty() {
            return named.iter().map(|name| self.column(name)).collect();
        }
        self.by_name(signal).map_err(|problem| ProposalError::UnclearColumns {
            file: self.request.recording_file.clone(),
            signal: word,
            problem,
            joints: self.robot.coordinate_count(),
            columns: self.names(),
        })
    }

    fn column(&self, name: &str) -> Result<&'a ColumnSummary, ProposalError> {
        let found = self.columns().find(|c| c.name == name);
        found.ok_or_else(|| ProposalError::NoSuchColumn {
            file: self.request.recording_file.clone(),
            name: name.to_owned(),
            columns: self.names(),
        })
    }

    /// The columns of numbers of the chosen table.
    fn columns(&self) -> impl Iterator<Item = &'a ColumnSummary> {
        self.table.iter().flat_map(|t| &t.columns).filter(|c| c.not_numeric.is_none())
    }

    fn names(&self) -> Vec<String> {
        self.columns().map(|c| c.name.clone()).collect()
    }

    /// The columns whose names say that they hold a signal, one channel for each joint, in the order of the joints.
    fn by_name(&self, signal: Signal) -> Result<Vec<&'a ColumnSummary>, String> {
        let joints = self.robot.coordinate_count();
        let reading = |c: &'a ColumnSummary| column_names::read(&c.name).filter(|r| r.signal == signal).map(|r| (c, r));
        let mut found: Vec<(&ColumnSummary, Reading)> = self.columns().filter_map(reading).collect();
        let channels: usize = found.iter().map(|(c, _)| c.channels).sum();
        if channels != joints {
            let names: Vec<&str> = found.iter().map(|(c, _)| c.name.as_str()).collect();
            return Err(format!("{channels} columns look like it ({})", names.join(" ")));
        }
        if let [(only, _)] = &found[..] {
            return Ok(vec![only]);
        }
        if let Some(ordered) = self.in_order_of_joints(&found) {
            return Ok(ordered);
        }
        found.sort_by_key(|(_, r)| r.number);
        let numbers: Vec<Option<usize>> = found.iter().map(|(_, r)| r.number).collect();
        let consecutive = numbers.windows(2).all(|n| matches!(n, [Some(a), Some(b)] if b - a == 1));
        if consecutive {
            return Ok(found.into_iter().map(|(c, _)| c).collect());
        }
        Err("their names have neither the joints' names nor consecutive numbers".to_owned())
    }

    /// The columns by the names of the joints, where each joint's name is in exactly one of them.
    fn in_order_of_joints(&self, found: &[(&'a ColumnSummary, Reading)]) -> Option<Vec<&'a ColumnSummary>> {
        let of_joint = |name: &str| {
            let matching: Vec<_> = found.iter().filter(|(c, _)| contains_name(&c.name, name)).collect();
            match matching[..] {
                [(only, _)] => Some(*only),
                _ => None,
            }
        };
        self.robot.coordinates().map(|joint| of_joint(&joint.name)).collect()
    }

    fn position_unit(&self, columns: &[&ColumnSummary]) -> (Unit, &'static str) {
        let [least, most] = range(columns);
        let largest = least.abs().max(most.abs());
        let prismatic = self.robot.coordinates().all(|j| j.kind == JointKind::Prismatic);
        let named = columns.first().and_then(|c| column_names::read(&c.name)).and_then(|r| r.unit);
        match (self.request.position_unit, named) {
            (Some(unit), _) => (unit, "as stated"),
            (None, Some(unit)) => (unit, "from the names"),
            _ if prismatic => (Unit::Metre, "a guess: linear joints"),
            _ if largest > LARGEST_ANGLE => (Unit::Degree, "a guess: too large for rad on the joint side"),
            _ => (Unit::Radian, "a guess from the range"),
        }
    }

    fn torque_unit(&self, columns: &[&ColumnSummary]) -> (Unit, &'static str) {
        let prismatic = self.robot.coordinates().all(|j| j.kind == JointKind::Prismatic);
        let named = columns.first().and_then(|c| column_names::read(&c.name)).and_then(|r| r.unit);
        match (self.request.torque_unit, named) {
            (Some(unit), _) => (unit, "as stated"),
            (None, Some(unit @ (Unit::Ampere | Unit::Milliampere | Unit::Volt))) => {
                (unit, "from the names; add gain = [...], torque per unit, one for each joint")
            }
            (None, Some(unit)) => (unit, "from the names"),
            _ if prismatic => (Unit::Newton, "a guess: nothing says it"),
            _ => (Unit::NewtonMetre, "a guess: nothing says it"),
        }
    }

    /// `name = { file, columns, unit }`, with the range and the source of the unit in a comment above.
    fn line(&self, name: &str, columns: &[&ColumnSummary], (unit, why): (Unit, &str)) -> String {
        let [least, most] = range(columns);
        let names: Vec<String> = columns.iter().map(|c| quoted(&c.name)).collect();
        format!(
            "# From {least:.4} to {most:.4}; unit {why}.\n{name} = {{ {}, columns = [{}], unit = \"{}\" }}\n",
            self.place(),
            names.join(", "),
            unit.symbol(),
        )
    }

    fn clock(&self) -> Result<ProposedClock, ProposalError> {
        if let Some(rate_hz) = self.request.sample_rate_hz {
            return Ok(ProposedClock { rate_hz, line: format!("sample_rate_hz = {rate_hz}\n") });
        }
        if let Some(name) = &self.request.time {
            self.column(name)?;
        }
        let chosen = |name: &str| self.request.time.as_deref().is_none_or(|wanted| wanted == name);
        let mut times = self.table.iter().flat_map(|t| &t.times).filter(|t| chosen(&t.column));
        let time = times.next().ok_or_else(|| ProposalError::NoTime {
            file: self.request.recording_file.clone(),
            columns: self.names(),
        })?;
        let [rms, largest] = [time.jitter_rms, time.jitter_max].map(|j| 100.0 * j);
        let line = format!(
            "# {:.6} Hz; its steps deviate by {rms:.2} % rms, {largest:.2} % at most; {} gaps.\n\
             time = {{ {}, columns = [{}], unit = \"{}\" }}\n",
            time.rate_hz,
            time.gaps.len(),
            self.place(),
            quoted(&time.column),
            time.unit.symbol(),
        );
        Ok(ProposedClock { rate_hz: time.rate_hz, line })
    }

    /// `file = ...`, and the topic where there are several.
    fn place(&self) -> String {
        let file = format!("file = {}", quoted(&self.request.recording_file.display().to_string()));
        match self.table {
            Some(table) if self.contents.tables.len() > 1 && !table.name.is_empty() => {
                format!("{file}, topic = {}", quoted(&table.name))
            }
            _ => file,
        }
    }
}

/// The least and the largest value of some columns.
fn range(columns: &[&ColumnSummary]) -> [f64; 2] {
    let channels = || columns.iter().flat_map(|c| &c.statistics);
    let least = channels().filter_map(|c| c.min).fold(f64::INFINITY, f64::min);
    let most = channels().filter_map(|c| c.max).fold(f64::NEG_INFINITY, f64::max);
    [least, most]
}

/// The unit of velocities that goes with the unit of the positions.
fn velocity_unit(position: Unit, robot: &Robot) -> (Unit, &'static str) {
    let prismatic = robot.coordinates().all(|j| j.kind == JointKind::Prismatic);
    let unit = if position == Unit::Degree {
        Unit::DegreePerSecond
    } else if position == Unit::Millimetre {
        Unit::MillimetrePerSecond
    } else if prismatic {
        Unit::MetrePerSecond
    } else {
        Unit::RadianPerSecond
    };
    (unit, "as the positions")
}

/// A TOML string.
fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

/// Whether a column's name holds a joint's name as a word of its own.
fn contains_name(column: &str, joint: &str) -> bool {
    let boundary = |c: Option<char>| c.is_none_or(|c| !c.is_alphanumeric());
    column.match_indices(joint).any(|(start, found)| {
        boundary(column[..start].chars().next_back()) && boundary(column[start + found.len()..].chars().next())
    })
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::recording::inspect;

    const ARM: &str =
        "name = 'arm'\n[[joint]]\nname = 'a'\nkind = 'revolute'\n[[joint]]\nname = 'b'\nkind = 'revolute'\n";

    /// A proposal for a log with this first line, or why there is none.
    fn proposed(header: &str, request: ProposalRequest) -> Result<String, ProposalError> {
        let columns = header.split(',').count();
        let row = |k: usize| {
            let value = |c: usize| if c == 0 { k as f64 * 1e-3 } else { (0.1 * k as f64 + c as f64).sin() };
            (0..columns).map(|c| value(c).to_string()).collect::<Vec<_>>().join(",") + "\n"
        };
        let folder = thetahat_testing::Folder::new();
        folder.write("log.csv", format!("{header}\n{}", (0..300).map(row).collect::<String>()));
        let contents = inspect(&folder.at("log.csv")).unwrap();
        let robot = Robot::parse(ARM, Path::new("arm.toml")).unwrap();
        propose(&request, &robot, &contents)
    }

    fn request() -> ProposalRequest {
        ProposalRequest {
            robot_file: "arm.toml".into(),
            recording_file: "log.csv".into(),
            ..ProposalRequest::default()
        }
    }

    #[test]
    fn the_proposal_is_an_experiment_that_can_be_read() {
        let text = proposed("t,q1,q2,tau1,tau2", request()).unwrap();
        let experiment = super::super::Experiment::from_texts(Path::new("e.toml"), text, ARM.to_owned()).unwrap();
        let recording = &experiment.file.recording[0];
        assert_eq!(recording.position.columns, ["q1", "q2"]);
        assert_eq!(recording.torque.as_ref().unwrap().columns, ["tau1", "tau2"]);
        assert_eq!(recording.time.as_ref().unwrap().columns, ["t"]);
        assert_eq!(experiment.settings.signal.decimation, 20);
    }

    #[test]
    fn columns_are_ordered_by_the_names_of_the_joints() {
        let text = proposed("t,b.position,a.position,b.effort,a.effort", request()).unwrap();
        assert!(text.contains(r#"columns = ["a.position", "b.position"]"#), "{text}");
        assert!(text.contains(r#"columns = ["a.effort", "b.effort"]"#), "{text}");
    }

    #[test]
    fn references_and_velocities_are_taken_along() {
        let text = proposed("t,q1,q2,q1_ref,q2_ref,dq1,dq2,tau1,tau2", request()).unwrap();
        assert!(text.contains("reference = {") && text.contains(r#"unit = "rad/s""#), "{text}");
    }

    #[test]
    fn names_that_do_not_tell_are_not_guessed() {
        let error = proposed("t,q1,q2,c1,c2", request()).unwrap_err();
        assert!(matches!(error, ProposalError::UnclearColumns { signal: "torque", joints: 2, .. }));
        let named = ProposalRequest { torque: vec!["c1".into(), "c2".into()], ..request() };
        assert!(proposed("t,q1,q2,c1,c2", named).is_ok());
    }

    #[test]
    fn a_column_that_is_not_there_is_named() {
        let named = ProposalRequest { torque: vec!["c1".into(), "c9".into()], ..request() };
        let error = proposed("t,q1,q2,c1,c2", named).unwrap_err();
        assert!(matches!(error, ProposalError::NoSuchColumn { name, .. } if name == "c9"));
    }

    #[test]
    fn too_many_columns_of_a_kind_are_not_chosen_from() {
        let error = proposed("t,q1,q2,qm1,qm2,tau1,tau2", request()).unwrap_err();
        assert!(matches!(error, ProposalError::UnclearColumns { signal: "position", .. }));
    }
}
