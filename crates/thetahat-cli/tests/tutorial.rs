//! docs/tutorial.md and docs/design.md: their commands run as they stand, end as the page says, and print what it shows.
#![cfg(unix)]

use std::fs;
use std::path::Path;
use std::process::Command;

use thetahat_testing::{Folder, project};

const PROGRAM: &str = env!("CARGO_BIN_EXE_thetahat");
/// What stands between the output of a command and its exit code, and what ends both.
const EXIT: char = '\u{1f}';
const END: char = '\u{1e}';
/// What a page writes for lines that it leaves out.
const LEFT_OUT: &str = "...";
/// What asks for the exit code of the command before.
const EXIT_CODE: &str = "echo $?";

/// A command of a page.
struct Step {
    command: String,
    /// Lines of its output, some left out.
    shown: Vec<String>,
    exit_code: i32,
}

impl Step {
    fn new(command: &str) -> Self {
        Self { command: command.to_owned(), shown: Vec::new(), exit_code: 0 }
    }
}

/// The commands of a page's `console` blocks.
fn steps(page: &str) -> Vec<Step> {
    let mut steps: Vec<Step> = Vec::new();
    let mut asked = false;
    for line in page.split("```console\n").skip(1).flat_map(|block| block.split("```").next()).flat_map(str::lines) {
        match (line.strip_prefix("$ "), steps.last_mut()) {
            (Some(EXIT_CODE), _) => asked = true,
            (Some(command), _) => steps.push(Step::new(command)),
            (None, Some(step)) if std::mem::take(&mut asked) => step.exit_code = line.parse().expect("an exit code"),
            (None, Some(step)) => step.shown.push(line.to_owned()),
            (None, None) => panic!("a console block begins with a command: {line}"),
        }
    }
    steps
}

/// What the commands print in one shell, and their exit codes.
fn outputs(folder: &Path, steps: &[Step]) -> Vec<(String, i32)> {
    let script: String =
        steps.iter().map(|step| format!("{}\nprintf '{EXIT}%s{END}' \"$?\"\n", step.command)).collect();
    let programs = Path::new(PROGRAM).parent().expect("the program lies in a folder").display();
    let path = std::env::var("PATH").unwrap_or_default();
    let output =
        Command::new("sh").args(["-c", &script]).env("PATH", format!("{programs}:{path}")).current_dir(folder).output();
    let printed = String::from_utf8(output.expect("a shell starts").stdout).expect("the output is text");
    printed.split_terminator(END).map(with_exit_code).collect()
}

fn with_exit_code(printed: &str) -> (String, i32) {
    let (output, code) = printed.rsplit_once(EXIT).expect("the shell prints the exit code");
    (output.to_owned(), code.parse().expect("it is a number"))
}

/// The first shown line that the output does not have in its place: adjacent to the one before, unless lines are left out.
fn missing<'a>(shown: &'a [String], output: &str) -> Option<&'a str> {
    let mut rest = output.lines();
    let mut gap = false;
    for line in shown {
        if line == LEFT_OUT {
            gap = true;
        } else if gap && rest.any(|found| found.trim_end() == line) {
            gap = false;
        } else if gap || rest.next().map(str::trim_end) != Some(line) {
            return Some(line);
        }
    }
    (!gap && !shown.is_empty() && rest.next().is_some()).then_some("(the end)")
}

#[test]
fn the_commands_print_what_the_page_shows() {
    compare("docs/tutorial.md", 10);
}

#[test]
fn the_commands_of_the_design_print_what_the_page_shows() {
    compare("docs/design.md", 2);
}

/// Runs the commands of a page that has more than `fewest`.
fn compare(page: &str, fewest: usize) {
    let page = fs::read_to_string(project(page)).expect("the page is there");
    let folder = Folder::new();
    for entry in fs::read_dir(project("examples/arm")).expect("the example is there") {
        let file = entry.expect("it is readable");
        folder.write(Path::new("examples/arm").join(file.file_name()), fs::read(file.path()).expect("it is readable"));
    }
    let steps = steps(&page);
    assert!(steps.len() > fewest, "{} commands", steps.len());
    let outputs = outputs(folder.path(), &steps);
    let mut faults = Vec::new();
    for (step, (output, exit_code)) in steps.iter().zip(&outputs) {
        if *exit_code != step.exit_code {
            faults
                .push(format!("$ {}\nends with {exit_code}, the page says {}\n{output}", step.command, step.exit_code));
        } else if let Some(line) = missing(&step.shown, output) {
            faults.push(format!("$ {}\ndoes not print in its place: {line}\n{output}", step.command));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n\n"));
    assert_eq!(steps.len(), outputs.len());
}
