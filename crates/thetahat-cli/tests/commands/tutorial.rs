//! README.md, and pages of docs/manual: their commands run unchanged, end as the page says, and
//! print what it shows. With `UPDATE=1` the shown lines become the printed lines that are most like them.
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
/// What begins a block of commands, and what ends it.
const CONSOLE: &str = "```console";
const FENCE: &str = "```";

/// A command of a page.
struct Step {
    command: String,
    /// Lines of its output, some left out.
    shown: Vec<Shown>,
    exit_code: i32,
}

impl Step {
    fn new(command: &str) -> Self {
        Self { command: command.to_owned(), shown: Vec::new(), exit_code: 0 }
    }
}

/// A line of output in a page.
struct Shown {
    /// Which line of the page it is.
    number: usize,
    text: String,
}

impl Shown {
    fn is_left_out(&self) -> bool {
        self.text == LEFT_OUT
    }
}

/// The lines of a page's `console` blocks, with their numbers.
fn console_lines(page: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut inside = false;
    page.lines().enumerate().filter(move |(_, line)| {
        let is_fence = line.starts_with(FENCE);
        if is_fence {
            inside = *line == CONSOLE;
        }
        inside && !is_fence
    })
}

/// The commands of a page.
fn steps(page: &str) -> Vec<Step> {
    let mut steps: Vec<Step> = Vec::new();
    let mut asked = false;
    for (number, line) in console_lines(page) {
        match (line.strip_prefix("$ "), steps.last_mut()) {
            (Some(EXIT_CODE), _) => asked = true,
            (Some(command), _) => steps.push(Step::new(command)),
            (None, Some(step)) if std::mem::take(&mut asked) => step.exit_code = line.parse().expect("an exit code"),
            (None, Some(step)) => step.shown.push(Shown { number, text: line.to_owned() }),
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
fn missing<'a>(shown: &'a [Shown], output: &str) -> Option<&'a str> {
    let mut rest = output.lines();
    let mut gap = false;
    for line in shown {
        if line.is_left_out() {
            gap = true;
        } else if gap && rest.any(|found| found.trim_end() == line.text) {
            gap = false;
        } else if gap || rest.next().map(str::trim_end) != Some(&line.text) {
            return Some(&line.text);
        }
    }
    (!gap && !shown.is_empty() && rest.next().is_some()).then_some("(the end)")
}

/// The page with what the commands print in the place of what it shows.
fn updated(page: &str, steps: &[Step], outputs: &[(String, i32)]) -> String {
    let mut lines: Vec<&str> = page.lines().collect();
    for (step, (output, _)) in steps.iter().zip(outputs) {
        let mut rest: Vec<&str> = output.lines().map(str::trim_end).collect();
        for shown in step.shown.split(Shown::is_left_out).filter(|shown| !shown.is_empty()) {
            let Some(place) = most_alike(shown, &rest) else { continue };
            shown.iter().zip(&rest[place..]).for_each(|(line, found)| lines[line.number] = found);
            rest.drain(..place + shown.len());
        }
    }
    lines.join("\n") + "\n"
}

/// Where the first of the printed lines begin that share most words with the shown ones, if any share a word.
fn most_alike(shown: &[Shown], printed: &[&str]) -> Option<usize> {
    let common = |found: &[&str]| -> usize { shown.iter().zip(found).map(|(a, b)| common_words(&a.text, b)).sum() };
    let places = printed.windows(shown.len()).enumerate().rev().map(|(place, found)| (common(found), place));
    places.max_by_key(|(common, _)| *common).filter(|(common, _)| *common > 0).map(|(_, place)| place)
}

fn words(line: &str) -> impl Iterator<Item = &str> {
    line.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty())
}

fn common_words(a: &str, b: &str) -> usize {
    words(a).filter(|word| words(b).any(|other| other == *word)).count()
}

#[test]
fn the_commands_of_the_readme_print_what_it_shows() {
    compare("README.md", 4);
}

#[test]
fn the_commands_print_what_the_page_shows() {
    compare("docs/manual/tutorial.md", 10);
}

#[test]
fn the_commands_of_the_design_print_what_the_page_shows() {
    compare("docs/manual/design.md", 2);
}

#[test]
fn the_commands_of_the_loops_print_what_the_page_shows() {
    compare("docs/manual/loops.md", 2);
}

/// A folder with the examples that the pages take.
fn example() -> Folder {
    let folder = Folder::new();
    let copy = |file: &str| _ = folder.write(file, fs::read(project(file)).expect("it is readable"));
    for entry in fs::read_dir(project("examples/arm")).expect("the example is there") {
        let name = entry.expect("it is readable").file_name();
        copy(&format!("examples/arm/{}", name.display()));
    }
    let robots = ["robots/five_bar.toml", "robots/quadruped.urdf", "robots/quadruped_floating.toml"];
    robots.into_iter().chain(["experiments/five_bar.toml"]).for_each(copy);
    folder
}

/// Runs the commands of a page that has more than `fewest`.
fn compare(page: &str, fewest: usize) {
    let file = project(page);
    let page = fs::read_to_string(&file).expect("the page is there");
    let steps = steps(&page);
    assert!(steps.len() > fewest, "{} commands", steps.len());
    let folder = example();
    let outputs = outputs(folder.path(), &steps);
    assert_eq!(steps.len(), outputs.len());
    if std::env::var_os("UPDATE").is_some() {
        let page = updated(&page, &steps, &outputs);
        fs::write(&file, &page).expect("the page can be written");
        require_shown(&self::steps(&page), &outputs);
    } else {
        require_shown(&steps, &outputs);
    }
}

/// Fails where a command ended or printed otherwise than the page says.
fn require_shown(steps: &[Step], outputs: &[(String, i32)]) {
    let faults: Vec<String> = steps.iter().zip(outputs).filter_map(|(step, output)| fault(step, output)).collect();
    assert!(faults.is_empty(), "{}", faults.join("\n\n"));
}

fn fault(step: &Step, (output, exit_code): &(String, i32)) -> Option<String> {
    let Step { command, shown, exit_code: expected } = step;
    if exit_code != expected {
        return Some(format!("$ {command}\nends with {exit_code}, the page says {expected}\n{output}"));
    }
    missing(shown, output).map(|line| format!("$ {command}\ndoes not print in its place: {line}\n{output}"))
}
