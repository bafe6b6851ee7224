//! The report of a design: tables for the terminal, the trajectory as CSV and for ROS 2, the experiment for its recording, and a
//! page.

pub(in crate::report) mod figures;
pub(in crate::report) mod move_programs;
mod points;
pub(in crate::report) mod tables;

use std::path::{Component, Path, PathBuf};

use super::{error::ReportError, files};
use super::{
    page::{Page, render},
    section::Section,
    series::trajectory_csv,
    wrap::{TextWidth, wrap},
};
use crate::results::{DesignResults, TrajectoryPoints};
use figures::{distance, motions, robot, searches, spectrum};
use move_programs::{MOVE_FILES, move_programs};
pub use points::POINT_FILES;
use points::point_programs;
use tables::{conclusions, distances, facts, frequencies, limits, nearness, predicted};
use thetahat_ground::{
    output::{DESIGNED_EXPERIMENT, FileKind, TRAJECTORY_JSON, TRAJECTORY_YAML},
    visible::{cell, visible},
};

/// The files of every design.
pub const DESIGN_FILES: [(&str, FileKind); 7] = [
    ("trajectory.csv", FileKind::Trajectory),
    ("trajectory.yaml", FileKind::TrajectoryYaml),
    ("trajectory.json", FileKind::TrajectoryJson),
    ("predicted.csv", FileKind::PredictedIntervals),
    ("experiment.toml", FileKind::DesignedExperiment),
    ("rehearsal.toml", FileKind::DesignedExperiment),
    ("design.html", FileKind::Page(GENERATOR)),
];

const GENERATOR: &str = "thetahat design";

/// The predicted intervals, the limits and the searches, for the terminal.
#[must_use]
pub fn design_text(results: &DesignResults, width: TextWidth) -> String {
    let lines: String = conclusions(results).iter().map(|line| wrap(line, "", width)).collect();
    let tables = [predicted(results), limits(results)].map(|table| table.to_text(width));
    format!("{}\n{}\n{lines}", wrap(&visible(&results.title), "", width), tables.join("\n"))
}

/// Writes [`DESIGN_FILES`], and [`MOVE_FILES`] if the motion consists of moves or else [`POINT_FILES`], into a folder, all of them or none.
/// Returns their paths.
///
/// # Errors
/// [`ReportError`] for what cannot be rendered or written.
pub fn write_design(results: &DesignResults, directory: &Path) -> Result<Vec<PathBuf>, ReportError> {
    let csv = |source| ReportError::Csv { source };
    let contents = [
        trajectory_csv(results).map_err(csv)?,
        joint_trajectory(results).into_bytes(),
        joint_trajectory_json(results).into_bytes(),
        predicted_csv(results).map_err(csv)?,
        experiment(results, directory, &results.experiment.recording).into_bytes(),
        experiment(results, directory, &results.experiment.twin).into_bytes(),
        page(results)?.into_bytes(),
    ];
    let programs: Vec<_> = match &results.moves {
        Some(moves) => MOVE_FILES.into_iter().zip(move_programs(results, moves)).collect(),
        None => POINT_FILES.into_iter().zip(point_programs(results)).collect(),
    };
    let programs = programs.into_iter().map(|(file, program)| (file, program.into_bytes()));
    let files = DESIGN_FILES.into_iter().zip(contents).chain(programs);
    files::write_files(directory, files.map(|((name, _), content)| (name, content)).collect())
}

fn page(results: &DesignResults) -> Result<String, ReportError> {
    let mut sections = vec![
        Section {
            id: "prediction",
            title: "Predicted intervals",
            lines: conclusions(results),
            forests: super::figures::predicted_forest(results).into_iter().collect(),
            folded: vec![predicted(results)],
            ..Section::default()
        },
        Section {
            id: "motion",
            title: "The motion and its limits",
            figures: robot(results).into_iter().chain([motions(results)]).collect(),
            tables: vec![limits(results)],
            ..Section::default()
        },
        Section {
            id: "spectrum",
            title: "Frequencies of the motion",
            lines: frequencies(results),
            figures: vec![spectrum(results)],
            ..Section::default()
        },
        Section {
            id: "distances",
            title: "Distances between shapes",
            lines: results.collision.iter().flat_map(nearness).collect(),
            figures: results.collision.iter().map(distance).collect(),
            tables: results.collision.iter().map(distances).collect(),
            ..Section::default()
        },
        Section { id: "search", title: "The searches", figures: vec![searches(results)], ..Section::default() },
    ];
    sections.retain(|section| section.id != "distances" || results.collision.is_some());
    render(&Page {
        title: &results.title,
        generator: GENERATOR,
        facts: facts(results),
        sections,
        footer: "The a-priori values are those of the robot's description; predicted intervals of the closed loop depend on them.",
        ..Page::default()
    })
}

fn predicted_csv(results: &DesignResults) -> Result<Vec<u8>, csv::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record([
        "predicted",
        "a_priori",
        "standard_deviation",
        "half_width_95",
        "seconds",
        "unit",
        "expression",
        "method",
        "rows",
        "joint",
        "residual_rms",
        "torque_rms",
    ])?;
    for p in &results.predicted {
        let numbers = [p.a_priori, p.standard_deviation, p.half_width_95].map(|v| v.to_string());
        let seconds = p.seconds.map(|s| s.to_string()).unwrap_or_default();
        let rows = &results.rows;
        let joint = p.coordinate.map_or_else(String::new, |c| cell(&results.joints[c].name).into_owned());
        let rms = |of: &[f64]| p.coordinate.and_then(|c| of.get(c)).map(f64::to_string).unwrap_or_default();
        let texts = [
            seconds,
            cell(&p.unit).into_owned(),
            cell(&p.expression).into_owned(),
            results.method.clone(),
            rows.count.to_string(),
            joint,
            rms(&rows.residual_rms),
            rms(&rows.torque_rms),
        ];
        writer.write_record([cell(&p.name).into_owned()].iter().chain(&numbers).chain(&texts))?;
    }
    writer.into_inner().map_err(|e| e.into_error().into())
}

/// A ROS 2 `trajectory_msgs/msg/JointTrajectory` as YAML; names and points are JSON, a subset of YAML.
fn joint_trajectory(results: &DesignResults) -> String {
    let names: Vec<&str> = results.joints.iter().map(|j| j.name.as_str()).collect();
    let mut text = format!("{TRAJECTORY_YAML}joint_names: {}\npoints:\n", serde_json::Value::from(names));
    let [points, _] = &results.points;
    for k in 0..points.q.len() {
        let nanoseconds = nanoseconds(points, k);
        let (sec, nanosec) = (nanoseconds / 1_000_000_000, nanoseconds % 1_000_000_000);
        let [q, dq, ddq] = [&points.q, &points.dq, &points.ddq].map(|s| serde_json::Value::from(s.sample(k)));
        text += &format!(
            "- {{positions: {q}, velocities: {dq}, accelerations: {ddq}, time_from_start: {{sec: {sec}, nanosec: {nanosec}}}}}\n"
        );
    }
    text
}

fn nanoseconds(points: &TrajectoryPoints, k: usize) -> u64 {
    (1e9 * k as f64 / points.rate_hz).round() as u64
}

/// The same as JSON.
fn joint_trajectory_json(results: &DesignResults) -> String {
    let names: Vec<&str> = results.joints.iter().map(|j| j.name.as_str()).collect();
    let [points, _] = &results.points;
    let point = |k: usize| {
        let nanoseconds = nanoseconds(points, k);
        serde_json::json!({
            "positions": points.q.sample(k),
            "velocities": points.dq.sample(k),
            "accelerations": points.ddq.sample(k),
            "time_from_start": { "sec": nanoseconds / 1_000_000_000, "nanosec": nanoseconds % 1_000_000_000 },
        })
    };
    let points: Vec<String> = (0..points.q.len()).map(|k| point(k).to_string()).collect();
    format!(
        "{TRAJECTORY_JSON}\"joint_names\":{},\"points\":[\n{}\n]}}\n",
        serde_json::Value::from(names),
        points.join(",\n")
    )
}

/// An experiment file in a folder.
fn experiment(results: &DesignResults, directory: &Path, motion: &str) -> String {
    let text = &results.experiment;
    let robot = relative(&text.robot, directory);
    format!(
        "{DESIGNED_EXPERIMENT}title = {}\nrobot = {}\n\n{motion}\n{}",
        toml::Value::from(text.title.clone()),
        toml::Value::from(robot.to_string_lossy().replace('\\', "/")),
        text.settings
    )
}

/// The path of a file relative to a folder.
fn relative(file: &Path, folder: &Path) -> PathBuf {
    let absolute = |path: &Path| std::path::absolute(path).map(|p| normal(&p)).unwrap_or_else(|_| path.to_owned());
    let (file, folder) = (absolute(file), absolute(folder));
    let common = file.components().zip(folder.components()).take_while(|(a, b)| a == b).count();
    let up = folder.components().skip(common).map(|_| Component::ParentDir);
    up.chain(file.components().skip(common)).collect()
}

/// A path without `.` and `..`.
fn normal(path: &Path) -> PathBuf {
    let mut normal = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => _ = normal.pop(),
            Component::CurDir => {}
            Component::Prefix(_) | Component::RootDir | Component::Normal(_) => normal.push(part),
        }
    }
    normal
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_named_from_the_folder() {
        let named = |file: &str, folder: &str| relative(Path::new(file), Path::new(folder));
        assert_eq!(named("/a/robots/r.urdf", "/a/out"), Path::new("../robots/r.urdf"));
        assert_eq!(named("/a/./x/../r.urdf", "/a"), Path::new("r.urdf"));
    }
}
