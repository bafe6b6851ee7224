//! The report of a design: tables for the terminal, the trajectory as CSV and for ROS 2, the experiment for its record, and a
//! page.

use std::path::{Component, Path, PathBuf};

use super::{
    design_figures::{motions, searches},
    error::ReportError,
    files,
    move_programs::{MOVE_FILES, move_programs},
    number::{NONE, estimate, significant},
    page::{Page, render},
    section::Section,
    series::trajectory_csv,
    table::Table,
    wrap::{TextWidth, wrap},
};
use crate::{
    results::{CollisionResults, DesignResults, Grade, LimitUse, PairDistance, PromisedParameter},
    visible::{cell, visible},
};

/// The files of every design.
pub const DESIGN_FILES: [&str; 7] = [
    "trajectory.csv",
    "trajectory.yaml",
    "trajectory.json",
    "promised.csv",
    "experiment.toml",
    "rehearsal.toml",
    "design.html",
];

/// The promised intervals, the limits and the searches, for the terminal.
#[must_use]
pub fn design_text(results: &DesignResults, width: TextWidth) -> String {
    let lines: String = conclusions(results).iter().map(|line| wrap(line, "", width)).collect();
    let tables = [promised(results), limits(results)].map(|table| table.to_text(width));
    format!("{}\n{}\n{lines}", wrap(&visible(&results.title), "", width), tables.join("\n"))
}

/// Writes [`DESIGN_FILES`], and [`MOVE_FILES`] where the motion is made of moves, into a folder, all of them or none. Returns their paths.
///
/// # Errors
/// [`ReportError`] for what cannot be rendered or written.
pub fn write_design(results: &DesignResults, directory: &Path) -> Result<Vec<PathBuf>, ReportError> {
    let csv = |source| ReportError::Csv { source };
    let contents = [
        trajectory_csv(results).map_err(csv)?,
        joint_trajectory(results).into_bytes(),
        joint_trajectory_json(results).into_bytes(),
        promised_csv(results).map_err(csv)?,
        experiment(results, directory, &results.experiment.recording).into_bytes(),
        experiment(results, directory, &results.experiment.twin).into_bytes(),
        page(results)?.into_bytes(),
    ];
    let programs = results.moves.iter().flat_map(|moves| move_programs(results, moves)).map(String::into_bytes);
    let files = DESIGN_FILES.into_iter().zip(contents).chain(MOVE_FILES.into_iter().zip(programs));
    files::write_files(directory, files.collect())
}

fn page(results: &DesignResults) -> Result<String, ReportError> {
    let mut sections = vec![
        Section {
            id: "promise",
            title: "What the record will tell",
            lines: conclusions(results),
            forests: super::figures::promised_forest(results).into_iter().collect(),
            folded: vec![promised(results)],
            ..Section::default()
        },
        Section {
            id: "motion",
            title: "The motion and its limits",
            figures: vec![motions(results)],
            tables: vec![limits(results)],
            ..Section::default()
        },
        Section {
            id: "distances",
            title: "How near shapes come",
            lines: results.collision.iter().flat_map(nearness).collect(),
            tables: results.collision.iter().map(distances).collect(),
            ..Section::default()
        },
        Section { id: "search", title: "The searches", figures: vec![searches(results)], ..Section::default() },
    ];
    sections.retain(|section| section.id != "distances" || results.collision.is_some());
    render(&Page {
        title: &results.title,
        facts: facts(results),
        sections,
        footer: "The a-priori values are those of the robot's description; intervals depend on them where the loop does.",
        ..Page::default()
    })
}

fn duration_s(results: &DesignResults) -> f64 {
    results.q.len().saturating_sub(1) as f64 / results.sample_rate_hz
}

fn facts(results: &DesignResults) -> Vec<(&'static str, String)> {
    let best = results.starts.first().map_or(f64::NAN, |s| s.found);
    vec![
        ("robot", results.robot.clone()),
        ("motion", motion(results)),
        ("criterion", format!("{}: {best:.2} nats, the best of {} starts", results.criterion, results.starts.len())),
        (
            "promised",
            format!(
                "{} on {}",
                results.method,
                if results.is_closed_loop { "the simulated loop" } else { "the motion as designed" }
            ),
        ),
    ]
}

fn motion(results: &DesignResults) -> String {
    let kind = results.moves.as_ref().map_or_else(String::new, |moves| format!(", {} moves", moves.moves().len()));
    format!("{} s at {} Hz{kind}, from rest to rest", significant(duration_s(results), 4), results.sample_rate_hz)
}

/// What the tables say, in sentences.
fn conclusions(results: &DesignResults) -> Vec<String> {
    let known = || results.promised.iter().filter(|p| p.a_priori != 0.0);
    let count = |grade: Grade| known().filter(|p| p.grade() == grade).count();
    let [sure, rough, lost] = [Grade::Sure, Grade::Rough, Grade::NotIdentified].map(count);
    let (all, known_ones) = (results.promised.len(), known().count());
    let mut lines = vec![format!(
        "{all} parameters are promised. Of the {known_ones} whose a-priori value is not zero, if that is right: {sure} sure, \
         {rough} rough, {lost} not told from zero."
    )];
    let unknown: Vec<&str> = known().filter(|p| p.grade() == Grade::NotIdentified).map(|p| p.name.as_str()).collect();
    if !unknown.is_empty() {
        lines.push(format!("Not told from zero: {}.", unknown.join(", ")));
    }
    lines.extend(results.limits.iter().max_by(|a, b| a.part.total_cmp(&b.part)).map(|worst| {
        format!(
            "No limit is exceeded at 1 kHz; the nearest is the {} of {}, used by {:.1} % at {:.3} s.",
            worst.quantity,
            visible(&worst.joint),
            100.0 * worst.part,
            worst.at_s
        )
    }));
    lines.extend(results.collision.iter().flat_map(nearness));
    lines.extend(results.compared.iter().map(|[title, method]| narrower(results, title, method)));
    let best = results.starts.first().map(|s| s.found);
    lines.extend(results.repeated.zip(best).map(|(repeated, best)| repetition(repeated, best)));
    lines
}

/// What the intervals say beside those of earlier results.
fn narrower(results: &DesignResults, title: &str, method: &str) -> String {
    let times: Vec<f64> = results.promised.iter().filter_map(PromisedParameter::times_smaller).collect();
    let mean = (times.iter().map(|t| t.ln()).sum::<f64>() / times.len() as f64).exp();
    let wider = results.promised.iter().filter(|p| p.times_smaller().is_some_and(|t| t < 1.0));
    let wider: Vec<&str> = wider.map(|p| p.name.as_str()).collect();
    let also = if wider.is_empty() { "none is wider".to_owned() } else { format!("wider: {}", wider.join(", ")) };
    format!(
        "Beside {method} of {}: of {} parameters the intervals are {} times as narrow in the geometric mean, {also}.",
        visible(title),
        times.len(),
        significant(mean, 3)
    )
}

/// Whether the motion adds more than the last recording does once more.
fn repetition(repeated: f64, best: f64) -> String {
    let gain = repeated - best;
    if gain >= 0.0 {
        format!("Repeating the last recording for as long would leave the criterion {gain:.2} nats higher.")
    } else {
        format!("Repeat the last recording instead: for as long it makes the criterion {:.2} nats lower.", -gain)
    }
}

/// What the distances of shapes say.
fn nearness(collision: &CollisionResults) -> Vec<String> {
    let mut lines = Vec::new();
    if let Some(nearest) = collision.pairs.first() {
        let at = nearest.at_s.map_or_else(|| "on the way from home".to_owned(), |at| format!("at {at:.3} s"));
        lines.push(format!(
            "No shapes come nearer to one another than {} mm at 1 kHz; the nearest are {} and {}, {} mm {at}.",
            significant(1e3 * collision.margin, 4),
            visible(&nearest.first),
            visible(&nearest.second),
            significant(1e3 * nearest.distance, 4)
        ));
    }
    if !collision.has_way {
        lines.push("The way to the first posture is not covered: give [collision] home.".to_owned());
    }
    if !collision.uncovered.is_empty() {
        let names: Vec<_> = collision.uncovered.iter().map(|name| visible(name)).collect();
        lines.push(format!(
            "Not covered, since their shapes are meshes: {}. Give [collision] capsules.",
            names.join(", ")
        ));
    }
    lines
}

fn distances(collision: &CollisionResults) -> Table {
    let row = |pair: &PairDistance| {
        vec![
            visible(&pair.first).into_owned(),
            visible(&pair.second).into_owned(),
            significant(1e3 * pair.distance, 4),
            pair.at_s.map_or_else(|| "from home".to_owned(), |at| format!("{at:.3}")),
        ]
    };
    Table {
        title: "Least distances at 1 kHz".to_owned(),
        lead: 2,
        head: strings(&["link", "from", "mm", "at, s"]),
        rows: collision.pairs.iter().map(row).collect(),
        ..Table::default()
    }
}

fn strings(texts: &[&str]) -> Vec<String> {
    texts.iter().map(|t| (*t).to_owned()).collect()
}

fn promised(results: &DesignResults) -> Table {
    let wanted = format!("s for {} %", significant(results.half_width_percent, 3));
    let row = |p: &PromisedParameter| {
        let percent = (p.a_priori != 0.0).then(|| 100.0 * p.half_width_95 / p.a_priori.abs());
        vec![
            p.name.clone(),
            p.unit.clone(),
            estimate(p.a_priori, Some(p.half_width_95)),
            significant(p.standard_deviation, 3),
            significant(p.half_width_95, 3),
            percent.map_or_else(|| NONE.to_owned(), |v| significant(v, 3)),
            p.seconds.map_or_else(|| NONE.to_owned(), |s| significant(s, 2)),
            if p.a_priori == 0.0 { NONE.to_owned() } else { p.grade().name().to_owned() },
        ]
        .into_iter()
        .chain(
            results
                .compared
                .iter()
                .map(|_| p.times_smaller().map_or_else(|| NONE.to_owned(), |times| significant(times, 3))),
        )
        .collect()
    };
    let mut head = strings(&["name", "unit", "a priori", "deviation", "half of 95 %", "in %", &wanted, "grade"]);
    head.extend(results.compared.iter().map(|_| "times as narrow".to_owned()));
    Table {
        title: "Promised intervals".to_owned(),
        lead: 1,
        head,
        rows: results.promised.iter().map(row).collect(),
        notes: vec![format!(
            "half of 95 %: expected half width of interval_95 by {}; {wanted}: record so long, by repeating the motion.",
            results.method
        )],
        ..Table::default()
    }
}

fn limits(results: &DesignResults) -> Table {
    let row = |l: &LimitUse| {
        let [low, high] = l.limit.map(|v| significant(v, 4));
        let [least, most] = l.reached.map(|v| significant(v, 4));
        let (used, at) = (format!("{:.1}", 100.0 * l.part), format!("{:.3}", l.at_s));
        vec![visible(&l.joint).into_owned(), l.quantity.to_owned(), low, high, least, most, used, at]
    };
    Table {
        title: "Limits at 1 kHz, SI".to_owned(),
        lead: 2,
        head: strings(&["joint", "quantity", "lower", "upper", "least", "most", "used, %", "at, s"]),
        rows: results.limits.iter().map(row).collect(),
        ..Table::default()
    }
}

fn promised_csv(results: &DesignResults) -> Result<Vec<u8>, csv::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record([
        "promised",
        "a_priori",
        "standard_deviation",
        "half_width_95",
        "seconds",
        "unit",
        "expression",
    ])?;
    for p in &results.promised {
        let numbers = [p.a_priori, p.standard_deviation, p.half_width_95].map(|v| v.to_string());
        let seconds = p.seconds.map(|s| s.to_string()).unwrap_or_default();
        let texts = [seconds, cell(&p.unit).into_owned(), cell(&p.expression).into_owned()];
        writer.write_record([cell(&p.name).into_owned()].iter().chain(&numbers).chain(&texts))?;
    }
    writer.into_inner().map_err(|e| e.into_error().into())
}

/// A ROS 2 `trajectory_msgs/msg/JointTrajectory` as YAML, which JSON is a part of: names and points are JSON.
fn joint_trajectory(results: &DesignResults) -> String {
    let names: Vec<&str> = results.joints.iter().map(|j| j.name.as_str()).collect();
    let mut text = format!(
        "# thetahat trajectory: trajectory_msgs/msg/JointTrajectory\njoint_names: {}\npoints:\n",
        serde_json::Value::from(names)
    );
    for k in 0..results.q.len() {
        let nanoseconds = (1e9 * k as f64 / results.sample_rate_hz).round() as u64;
        let (sec, nanosec) = (nanoseconds / 1_000_000_000, nanoseconds % 1_000_000_000);
        let [q, dq, ddq] = [&results.q, &results.dq, &results.ddq].map(|s| serde_json::Value::from(s.sample(k)));
        text += &format!(
            "- {{positions: {q}, velocities: {dq}, accelerations: {ddq}, time_from_start: {{sec: {sec}, nanosec: {nanosec}}}}}\n"
        );
    }
    text
}

/// The same as JSON.
fn joint_trajectory_json(results: &DesignResults) -> String {
    let names: Vec<&str> = results.joints.iter().map(|j| j.name.as_str()).collect();
    let point = |k: usize| {
        let nanoseconds = (1e9 * k as f64 / results.sample_rate_hz).round() as u64;
        serde_json::json!({
            "positions": results.q.sample(k),
            "velocities": results.dq.sample(k),
            "accelerations": results.ddq.sample(k),
            "time_from_start": { "sec": nanoseconds / 1_000_000_000, "nanosec": nanoseconds % 1_000_000_000 },
        })
    };
    let points: Vec<String> = (0..results.q.len()).map(|k| point(k).to_string()).collect();
    format!(
        "{{\"thetahat\":\"trajectory\",\"joint_names\":{},\"points\":[\n{}\n]}}\n",
        serde_json::Value::from(names),
        points.join(",\n")
    )
}

/// An experiment file in a folder.
fn experiment(results: &DesignResults, directory: &Path, motion: &str) -> String {
    let text = &results.experiment;
    let robot = relative(&text.robot, directory);
    format!(
        "# thetahat design: the experiment for the record of trajectory.csv.\ntitle = {}\nrobot = {}\n\n{motion}\n{}",
        toml::Value::from(text.title.clone()),
        toml::Value::from(robot.to_string_lossy().replace('\\', "/")),
        text.settings
    )
}

/// A file as it is named from a folder.
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
