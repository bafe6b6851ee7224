//! What `identify` shows in a terminal: the verdict, and no line wider than the terminal.
#![cfg(unix)]

use std::process::Command;

use thetahat_testing::{Folder, project, run, succeeded};

const PROGRAM: &str = env!("CARGO_BIN_EXE_thetahat");
/// Columns of a terminal.
const COLUMNS: usize = 80;
/// Columns of terminals, experiments and their verdicts.
const RUNS: [(usize, &str, &str); 4] = [
    (40, "experiment.toml", "good"),
    (40, "swapped.toml", "do not use"),
    (COLUMNS, "swapped.toml", "do not use"),
    (130, "experiment.toml", "good"),
];
/// What begins a sequence that colours text or moves the cursor.
const ESCAPE: char = '\u{1b}';

/// A folder with an experiment in order, and one whose first two torques are exchanged.
fn experiments() -> Folder {
    let folder = Folder::new();
    for file in ["arm.urdf", "twin.toml"] {
        folder.copy(&project("examples/arm").join(file));
    }
    let program = |arguments: &str| succeeded(&run(PROGRAM, folder.path(), arguments.split(' ')));
    program("simulate twin.toml --out log.csv");
    program("init --robot arm.urdf --recording log.csv");
    folder.replace("experiment.toml", r#""torque_1", "torque_2""#, r#""torque_2", "torque_1""#, "swapped.toml");
    folder
}

/// What a terminal of so many columns shows of a run; none where there is no `script` to make one.
fn captured(folder: &Folder, width: usize, environment: &str, arguments: &str) -> Option<String> {
    let command = format!("stty rows 24 cols {width}; {environment} {PROGRAM} {arguments} 2>/dev/null");
    let output = Command::new("script").args(["-qec", &command, "/dev/null"]).current_dir(folder.path()).output();
    let Ok(output) = output else {
        eprintln!("*** SKIPPED: there is no `script` to make a terminal ***");
        return None;
    };
    Some(String::from_utf8(output.stdout).expect("a terminal shows text").replace('\r', ""))
}

/// The columns that a line takes: its characters without what only colours them.
fn columns(line: &str) -> usize {
    let mut parts = line.split(ESCAPE);
    let plain = parts.next().map_or(0, |text| text.chars().count());
    let coloured = parts.map(|part| part.split_once('m').map_or(0, |(_, text)| text.chars().count()));
    plain + coloured.sum::<usize>()
}

/// A command to copy is not broken.
fn is_command(line: &str) -> bool {
    line.contains("thetahat identify ")
}

#[test]
fn the_terminal_shows_the_verdict_in_its_width() {
    let folder = experiments();
    for (width, experiment, verdict) in RUNS {
        let Some(shown) = captured(&folder, width, "", &format!("identify {experiment}")) else { return };
        assert!(shown.to_lowercase().contains(verdict), "{shown}");
        let wide: Vec<&str> = shown.lines().filter(|line| columns(line) > width && !is_command(line)).collect();
        assert!(wide.is_empty(), "wider than {width} columns:\n{}", wide.join("\n"));
    }
}

#[test]
fn without_a_terminal_or_with_no_color_nothing_is_coloured() {
    let folder = experiments();
    let piped = succeeded(&run(PROGRAM, folder.path(), ["identify", "experiment.toml"]));
    assert!(!piped.contains(ESCAPE), "{piped}");
    let Some(shown) = captured(&folder, COLUMNS, "NO_COLOR=1", "identify experiment.toml") else { return };
    assert!(shown.contains("GOOD") && !shown.contains(ESCAPE), "{shown}");
}
