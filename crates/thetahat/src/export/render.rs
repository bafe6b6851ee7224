//! The file of a robot in each format.

use super::{
    actuators::{self, Written},
    editor::Edited,
    error::ExportError,
    format::{ActuatorFormat, ExportFormat},
    header,
    json::json,
    mjcf::{self, MjcfModel, Servos},
    pd_loop::PdLoop,
    represented::{RepresentedRobot, represented},
    sdf::sdf,
    urdf_edit::edited,
    urdf_new,
};
use thetahat_model::robot::Robot;

/// What an export is made of.
#[derive(Debug, Clone, Copy)]
pub enum Target<'a> {
    /// A file of a format: for URDF the one that the robot was read from, edited, and else a new one.
    File(ExportFormat),
    /// A MuJoCo model of the user's own, edited.
    Into(&'a MjcfModel),
}

impl From<ExportFormat> for Target<'_> {
    fn from(format: ExportFormat) -> Self {
        Self::File(format)
    }
}

impl Target<'_> {
    /// The format of the file.
    #[must_use]
    pub fn format(self) -> ExportFormat {
        match self {
            Self::File(format) => format,
            Self::Into(_) => ExportFormat::Mjcf,
        }
    }
}

/// An exported robot.
#[derive(Debug, Clone, PartialEq)]
pub struct Export {
    /// The format.
    pub format: ExportFormat,
    /// The content of the file.
    pub text: String,
    /// What the format cannot represent of the robot, a sentence each; it is in the file as well.
    pub not_represented: Vec<String>,
    /// What else was done, such as how bodies were split; it is in the file as well.
    pub notes: Vec<String>,
    pub(super) represented: RepresentedRobot,
    /// Whether it is a file of the user's own with its own kinematics.
    pub(super) is_edited_model: bool,
}

impl Export {
    /// The robot as the format represents it: the torques of the file are those of this robot.
    #[must_use]
    pub fn robot(&self) -> &Robot {
        &self.represented.robot
    }

    /// Its standard parameters, SI, in the order of its table.
    #[must_use]
    pub fn parameters(&self) -> &[f64] {
        &self.represented.parameters
    }
}

/// A robot with these standard parameters, SI and in the order of its table, as a file. `urdf` is the text of the URDF that
/// it was read from: it is edited, and all that is no inertia and no friction stays byte for byte; so is a MuJoCo model that the
/// robot goes into. `about` are lines for the comment at the start of the file.
///
/// Links need a mass above zero; whether they are bodies is not checked.
///
/// # Errors
/// [`ExportError::Robot`] for a URDF that is not that of the robot, and [`ExportError::Mjcf`] for a model that is not; for formats of
/// drives alone that such a format cannot hold the robot's.
pub fn export_robot<'t>(
    robot: &Robot,
    urdf: Option<&str>,
    parameters: &[f64],
    target: impl Into<Target<'t>>,
    about: &[String],
) -> Result<Export, ExportError> {
    export_with_loop(robot, urdf, parameters, target.into(), about, None)
}

/// As [`export_robot`], with the controller that was fitted.
pub(super) fn export_with_loop(
    robot: &Robot,
    urdf: Option<&str>,
    parameters: &[f64],
    target: Target<'_>,
    about: &[String],
    pd: Option<&PdLoop>,
) -> Result<Export, ExportError> {
    let keeps_the_file = matches!((target, urdf), (Target::File(ExportFormat::Urdf), Some(_)));
    require_one_leader(robot, target.format(), keeps_the_file)?;
    require_loops(robot, target)?;
    require_base(robot, target)?;
    let servos = match target {
        Target::File(ExportFormat::Mjcf) => pd.map(|pd| Servos::of(pd, robot, parameters)),
        Target::File(
            ExportFormat::Urdf
            | ExportFormat::Sdf
            | ExportFormat::Json
            | ExportFormat::Pace
            | ExportFormat::Isaac
            | ExportFormat::Bam,
        )
        | Target::Into(_) => None,
    };
    let represented = represented(robot, parameters, target.format(), servos.is_some());
    let header = |notes: &[String]| header::comment(robot, &represented, about, notes);
    let drives =
        |format| actuators::text(&Written { format, robot, represented: &represented, pd, about: about.to_vec() });
    let whole = |edited: Edited| (edited.with_header(&header(&edited.notes)), edited.notes);
    let (text, notes) = match (target, urdf) {
        (Target::Into(model), _) => whole(mjcf::edited(model, &represented)?),
        (Target::File(ExportFormat::Urdf), Some(text)) => whole(edited(text, &represented)?),
        (Target::File(ExportFormat::Urdf), None) => {
            (urdf_new::urdf(&represented, &header(&[]), robot.transmission.ratios().as_deref()), Vec::new())
        }
        (Target::File(ExportFormat::Mjcf), _) => {
            let notes = servos.as_ref().map(|servos| servos.about.clone()).unwrap_or_default();
            (mjcf::mjcf(&represented, &header(&notes), servos.as_ref()), notes)
        }
        (Target::File(ExportFormat::Sdf), _) => (sdf(&represented, &header(&[])), Vec::new()),
        (Target::File(ExportFormat::Json), _) => (json(&represented, about)?, Vec::new()),
        (Target::File(ExportFormat::Pace), _) => drives(ActuatorFormat::Pace)?,
        (Target::File(ExportFormat::Isaac), _) => drives(ActuatorFormat::Isaac)?,
        (Target::File(ExportFormat::Bam), _) => drives(ActuatorFormat::Bam)?,
    };
    let is_edited_model = matches!(target, Target::Into(_));
    Ok(Export {
        format: target.format(),
        text,
        not_represented: represented.not_represented.clone(),
        notes,
        represented,
        is_edited_model,
    })
}

/// That the base is fixed, where the format has no other.
fn require_base(robot: &Robot, target: Target<'_>) -> Result<(), ExportError> {
    if robot.base_coordinates() == 0 {
        return Ok(());
    }
    match target {
        Target::Into(_) => Err(ExportError::FloatingBase { format: None }),
        Target::File(ExportFormat::Mjcf) if robot.transmission.coupled_motors().is_empty() => Ok(()),
        Target::File(ExportFormat::Urdf | ExportFormat::Sdf | ExportFormat::Json) => Ok(()),
        Target::File(format @ (ExportFormat::Mjcf | ExportFormat::Pace | ExportFormat::Isaac | ExportFormat::Bam)) => {
            Err(ExportError::FloatingBase { format: Some(format) })
        }
    }
}

/// That the robot is a tree, where the format has no loops.
fn require_loops(robot: &Robot, target: Target<'_>) -> Result<(), ExportError> {
    match target {
        Target::Into(_) | Target::File(ExportFormat::Json | ExportFormat::Mjcf) => Ok(()),
        Target::File(format) if !robot.loops.is_empty() => Err(ExportError::Loops { format }),
        Target::File(_) => Ok(()),
    }
}

/// That no joint follows several others, where the format has no such joint.
fn require_one_leader(robot: &Robot, format: ExportFormat, keeps_the_file: bool) -> Result<(), ExportError> {
    let of_several = robot.joints.iter().find(|joint| !joint.also_follows.is_empty());
    match (of_several, format) {
        (Some(joint), ExportFormat::Urdf | ExportFormat::Mjcf | ExportFormat::Sdf) if !keeps_the_file => {
            Err(ExportError::FollowsSeveral { joint: joint.name.clone(), format })
        }
        (
            Some(_) | None,
            ExportFormat::Urdf
            | ExportFormat::Mjcf
            | ExportFormat::Sdf
            | ExportFormat::Json
            | ExportFormat::Pace
            | ExportFormat::Isaac
            | ExportFormat::Bam,
        ) => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    const URDF: &str = "<robot name='r'><link name='base'/>\
        <link name='a'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link>\
        <link name='b'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link>\
        <link name='c'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link>\
        <joint name='ja' type='continuous'><parent link='base'/><child link='a'/><axis xyz='0 1 0'/></joint>\
        <joint name='jb' type='continuous'><parent link='a'/><child link='b'/><axis xyz='0 1 0'/></joint>\
        <joint name='jc' type='continuous'><parent link='b'/><child link='c'/><axis xyz='0 1 0'/>\
        <mimic joint='ja' multiplier='-1'/><mimic joint='jb' multiplier='-1'/></joint></robot>";

    /// A format without joints that follow several others is refused; JSON has them, and an edited URDF keeps its own.
    #[test]
    fn a_joint_that_follows_several_is_written_where_the_format_has_it() {
        let robot = thetahat_model::robot::RobotSource::from_text(URDF.to_owned(), Path::new("r.urdf")).unwrap();
        let robot = robot.robot_without_transmission().unwrap();
        let parameters = robot.a_priori_parameters();
        let written = |urdf: Option<&str>, format: ExportFormat| export_robot(&robot, urdf, &parameters, format, &[]);
        for format in [ExportFormat::Urdf, ExportFormat::Mjcf, ExportFormat::Sdf] {
            let error = written(None, format).unwrap_err().to_string();
            assert!(error.contains("joint `jc` follows several others") && error.contains("JSON has it"), "{error}");
        }
        let json = written(None, ExportFormat::Json).unwrap().text;
        assert!(json.contains("also_follows") && json.matches("\"ratio\": -1").count() == 2, "{json}");
        let edited = written(Some(URDF), ExportFormat::Urdf).unwrap();
        assert_eq!(edited.text.matches("<mimic ").count(), 2);
        assert!(edited.not_represented.iter().any(|line| line.contains("take the first <mimic>")));
    }
}
