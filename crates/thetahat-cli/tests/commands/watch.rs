//! `thetahat watch`: a slider whose friction grows, from a file, a pipe, and a file that is being written.

use std::{
    fs::OpenOptions,
    io::Write,
    process::{Command, Output, Stdio},
    sync::LazyLock,
    thread,
    time::Duration,
};

use thetahat_testing::{Folder, refused, run, shown, succeeded};

const PROGRAM: &str = env!("CARGO_BIN_EXE_thetahat");

const ROBOT: &str = "name = \"slider\"\n[[joint]]\nname = \"slide\"\nkind = \"prismatic\"\nalpha_deg = 90\n\
                     [transmission]\nmatrix = [[1]]\n[parameters]\nm1 = 10\n";
const EXPERIMENT: &str = r#"title = "a slider"
robot = "robot.toml"
[recording]
time = { file = "log.csv", columns = ["t"], unit = "s" }
position = { file = "log.csv", columns = ["q"], unit = "mm" }
torque = { file = "log.csv", columns = ["f"], unit = "N" }
[signal]
cutoff_hz = 15
decimation = 5
[estimation]
methods = ["idim-ls"]
"#;
/// The rate of a pipe is the mean of its first steps, that of a file of all of them.
const ROUNDED_S: f64 = 1e-6;
/// Time at which friction grows, s.
const CHANGE_S: f64 = 20.0;

/// So many seconds at 200 Hz of 20 kg with friction, which grows by a part.
fn record(seconds: f64, part: f64) -> String {
    let mut noise = thetahat_testing::noise();
    let mut row = |k: usize| {
        let t = k as f64 / 200.0;
        let sum = |f: &dyn Fn(f64, f64) -> f64| f(200.0, 2.0) + f(100.0, 5.3);
        let q = sum(&|a, w| a * (w * t).sin());
        let v = 1e-3 * sum(&|a, w| a * w * (w * t).cos());
        let a = 1e-3 * sum(&|a, w| -a * w * w * (w * t).sin());
        let friction = if t < CHANGE_S { 1.0 } else { 1.0 + part };
        format!("{t:.3},{q},{}\n", 20.0 * a + friction * (30.0 * v + 5.0 * v.signum()) + 2.0 + 0.5 * noise())
    };
    format!("t,q,f\n{}", (0..(200.0 * seconds) as usize).map(&mut row).collect::<String>())
}

static IDENTIFIED: LazyLock<Folder> = LazyLock::new(|| {
    let folder = Folder::with("robot.toml", ROBOT);
    folder.write("experiment.toml", EXPERIMENT);
    folder.write("log.csv", record(18.0, 0.0));
    folder.write("same.csv", record(30.0, 0.0));
    folder.write("more.csv", record(35.0, 0.1));
    let identified = run(PROGRAM, folder.path(), ["identify", "experiment.toml", "--out", "out"]);
    assert!(folder.path().join("out/results.json").exists(), "{}", shown(&identified));
    folder
});

fn watch(arguments: &[&str]) -> Output {
    let command = ["watch", "out", "--settle", "10", "--recording"];
    run(PROGRAM, IDENTIFIED.path(), command.into_iter().chain(arguments.iter().copied()))
}

#[test]
fn a_file_without_change_ends_with_nothing_found() {
    let text = succeeded(&watch(&["same.csv", "--every", "5"]));
    assert!(text.contains("watching: ") && text.contains("nothing found") && text.contains("residual: "), "{text}");
    assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
}

#[test]
fn a_change_is_said_and_is_the_exit_code() {
    let output = watch(&["more.csv"]);
    let text = shown(&output);
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(text.contains("changed: friction of joint 1 (slide): fv1 "), "{text}");
    assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
}

fn lines(output: &Output) -> Vec<serde_json::Value> {
    let text = String::from_utf8_lossy(&output.stdout);
    text.lines().map(|line| serde_json::from_str(line).expect("each line is JSON")).collect()
}

#[test]
fn a_pipe_gives_what_the_file_gives() {
    let from_file = lines(&watch(&["more.csv", "--json"]));
    let mut child = Command::new(PROGRAM)
        .current_dir(IDENTIFIED.path())
        .args(["watch", "out", "--settle", "10", "--json", "--recording", "-"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut pipe = child.stdin.take().unwrap();
    for piece in IDENTIFIED.bytes("more.csv").chunks(1000) {
        pipe.write_all(piece).unwrap();
    }
    drop(pipe);
    let from_pipe = lines(&child.wait_with_output().unwrap());
    let kinds = |lines: &[serde_json::Value]| -> Vec<String> {
        lines.iter().map(|line| line["kind"].as_str().unwrap().to_owned()).collect()
    };
    assert_eq!(kinds(&from_pipe), kinds(&from_file));
    let place = kinds(&from_file).iter().position(|kind| kind == "drift").unwrap();
    for key in ["time_s", "cause", "began_s"] {
        let [piped, read] = [&from_pipe, &from_file].map(|lines| &lines[place][key]);
        let is_same = piped == read || (piped.as_f64().unwrap() - read.as_f64().unwrap()).abs() < ROUNDED_S;
        assert!(is_same, "{key}: {piped} and {read}");
    }
}

/// The alarm comes while the file still grows: the program is ended after it.
#[test]
fn a_file_is_followed_while_it_grows() {
    let text = String::from_utf8(IDENTIFIED.bytes("more.csv")).unwrap();
    let (before, after) = text.split_at(text.len() / 2);
    IDENTIFIED.write("growing.csv", before);
    let mut child = Command::new(PROGRAM)
        .current_dir(IDENTIFIED.path())
        .args(["watch", "out", "--settle", "10", "--follow", "--json", "--recording", "growing.csv"])
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    thread::sleep(Duration::from_millis(300));
    let mut file = OpenOptions::new().append(true).open(IDENTIFIED.at("growing.csv")).unwrap();
    file.write_all(after.as_bytes()).unwrap();
    let mut lines = std::io::BufRead::lines(std::io::BufReader::new(child.stdout.take().unwrap()));
    let mut next = || lines.next().unwrap().unwrap();
    assert!(next().starts_with("{\"kind\":\"settled\""));
    assert!((0..2).any(|_| next().starts_with("{\"kind\":\"drift\"")));
    child.kill().unwrap();
    child.wait().unwrap();
}

#[test]
fn what_cannot_be_watched_is_refused_with_a_remedy() {
    let says = |arguments: &[&str], words: &[&str]| {
        let message = refused(&watch(arguments));
        assert!(words.iter().all(|word| message.contains(word)), "{message}");
    };
    says(&["absent.csv"], &["absent.csv", "no such file"]);
    says(&["absent.csv", "--follow"], &["absent.csv", "cannot be read"]);
    says(&["same.csv", "--alarms-per-hour", "0"], &["--alarms-per-hour is 0, expected above 0"]);
    says(&["same.csv", "--torque", "force"], &["same.csv", "force", "\"t\", \"q\", \"f\""]);
    IDENTIFIED.write("short.csv", record(4.0, 0.0));
    says(&["short.csv"], &["short.csv: ended after 4.0 s", "--settle"]);
    let text = record(4.0, 0.0).replace("\n2.000,", "\nlate,");
    IDENTIFIED.write("word.csv", text);
    says(&["word.csv", "--follow"], &["word.csv", "line 402", "late"]);
    let still: String = (0..4000).map(|k| format!("{},100,2\n", f64::from(k) / 200.0)).collect();
    IDENTIFIED.write("still.csv", format!("t,q,f\n{still}"));
    says(&["still.csv"], &["still.csv: no joint moves", "--settle"]);
}
