//! The commands `reduce` and `solve` on records of the two-joint arm.

use std::{fs, path::PathBuf, process::Output, sync::OnceLock};

use serde_json::Value;
use thetahat_testing::{Folder, run, shown};

const PROGRAM: &str = env!("CARGO_BIN_EXE_thetahat");

/// Between ways to one estimate, in the larger of the estimate and its standard deviation.
const EQUAL: f64 = 1e-9;
const EQUAL_ORDERS: f64 = 1e-10;
/// IDIM-IV by steps of `reduce` and `solve` against IDIM-IV of `identify`, in standard deviations. The two stop at
/// different steps; 4e-5 were found.
const EQUAL_STEPS: f64 = 1e-3;
/// Times that a record is repeated to one of several pieces.
const REPETITIONS: usize = 90;

/// A folder with two records of the arm, an experiment for each, and one for both.
struct Records(Folder);

impl Records {
    fn new() -> Self {
        let folder = Self(Folder::new());
        folder.write("robot.toml", &project("robots/two_joint.toml"));
        let [a, b] = records();
        folder.write("a.csv", a);
        folder.write("b.csv", b);
        folder.write("a.toml", &experiment(&["a.csv"]));
        folder.write("b.toml", &experiment(&["b.csv"]));
        folder.write("both.toml", &experiment(&["a.csv", "b.csv"]));
        folder
    }

    fn path(&self, file: &str) -> PathBuf {
        self.0.at(file)
    }

    fn write(&self, file: &str, text: &str) {
        self.0.write(file, text);
    }

    fn bytes(&self, file: &str) -> Vec<u8> {
        self.0.bytes(file)
    }

    /// Writes a file with something changed.
    fn with(&self, file: &str, from: &str, to: &str, out: &str) {
        self.0.replace(file, from, to, out);
    }

    fn run(&self, arguments: &str) -> Output {
        run(PROGRAM, self.0.path(), arguments.split(' '))
    }

    /// Runs a command that ends well, and says what it printed.
    fn succeeds(&self, arguments: &str) -> String {
        let output = self.run(arguments);
        assert_eq!(output.status.code(), Some(0), "{arguments}: {}", shown(&output));
        shown(&output)
    }

    /// Runs a command that is refused with these words and leaves the folder as it was.
    fn refuses(&self, arguments: &str, words: &[&str]) {
        let before = self.files();
        let output = self.run(arguments);
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments}: {}", shown(&output));
        words.iter().for_each(|word| assert!(message.contains(word), "no {word:?} in: {message}"));
        ["panicked", "Some(", "Err("].iter().for_each(|w| assert!(!message.contains(w), "{w:?} in: {message}"));
        assert_eq!(self.files(), before, "{arguments}: something was written");
    }

    /// The names of all files, and those in folders.
    fn files(&self) -> Vec<PathBuf> {
        let mut found = Vec::new();
        let mut folders = vec![self.0.path().to_owned()];
        while let Some(folder) = folders.pop() {
            for path in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
                if path.is_dir() { folders.push(path) } else { found.push(path) }
            }
        }
        found.sort();
        found
    }

    /// The estimates in the results of a command.
    fn estimates(&self, out: &str, method: &str) -> Vec<Estimate> {
        let results = self.0.json(format!("{out}/results.json"));
        let runs = results["runs"].as_array().unwrap();
        let run = runs.iter().find(|r| r["method"] == method && r["case"] == "nominal").unwrap();
        assert_eq!(run["status"], "converged", "{run}");
        run["parameters"].as_array().unwrap().iter().map(Estimate::of).collect()
    }
}

fn project(file: &str) -> String {
    fs::read_to_string(thetahat_testing::project(file)).unwrap()
}

/// Two records of the twin with noise of their own, simulated once.
fn records() -> &'static [String; 2] {
    static RECORDS: OnceLock<[String; 2]> = OnceLock::new();
    RECORDS.get_or_init(|| {
        let folder = Records(Folder::new());
        folder.write("robot.toml", &project("robots/two_joint.toml"));
        let twin = project("experiments/two_joint.toml").replace("../robots/two_joint.toml", "robot.toml");
        [1, 2].map(|seed| {
            folder.write("twin.toml", &twin.replace("seed = 1", &format!("seed = {seed}")));
            folder.succeeds("simulate twin.toml --out record.csv");
            folder.0.text("record.csv")
        })
    })
}

/// The experiment of the twin with recordings in place of the twin.
fn experiment(files: &[&str]) -> String {
    let twin = project("experiments/two_joint.toml");
    let (_, rest) = twin.split_once("[signal]").unwrap();
    let (rest, _) = rest.split_once("[[case]]").unwrap();
    let channels = |file: &str, name: &str, unit: &str| {
        format!("{name} = {{ file = \"{file}\", columns = [\"{name}_1\", \"{name}_2\"], unit = \"{unit}\" }}\n")
    };
    let recording = |file: &&str| {
        let time = format!("time = {{ file = \"{file}\", columns = [\"time_s\"], unit = \"s\" }}\n");
        format!("[[recording]]\n{time}{}{}", channels(file, "position", "rad"), channels(file, "torque", "N m"))
    };
    let recordings: String = files.iter().map(recording).collect();
    format!(
        "title = \"arm\"\nrobot = \"robot.toml\"\n{recordings}\n[signal]{rest}\n\
         [estimation]\nmethods = [\"idim-ls\", \"idim-iv\"]\n"
    )
}

struct Estimate {
    name: String,
    value: f64,
    deviation: f64,
}

impl Estimate {
    fn of(parameter: &Value) -> Self {
        let number = |key: &str| parameter[key].as_f64().unwrap();
        let name = parameter["name"].as_str().unwrap().to_owned();
        Self { name, value: number("estimate"), deviation: number("standard_deviation") }
    }

    /// How far it is from another one, in standard deviations.
    fn from(&self, other: &Self) -> f64 {
        assert_eq!(self.name, other.name);
        (self.value - other.value).abs() / other.deviation
    }
}

fn assert_same(found: &[Estimate], expected: &[Estimate], tolerance: f64) {
    assert_eq!(found.len(), expected.len());
    for (f, e) in found.iter().zip(expected) {
        let size = (e.value.abs() / e.deviation).max(1.0);
        assert!(f.from(e) <= tolerance * size, "{}: {} against {}", e.name, f.value, e.value);
        assert!((f.deviation / e.deviation - 1.0).abs() <= tolerance, "deviation of {}", e.name);
    }
}

#[test]
fn a_reduction_solved_is_the_identification() {
    let folder = Records::new();
    folder.succeeds("identify a.toml --out identified");
    let told = folder.succeeds("reduce a.toml --out a.reduction");
    let words =
        ["1536 samples at 500", "samples near rest left out (up to ", "samples kept", "thetahat solve a.reduction"];
    words.iter().for_each(|word| assert!(told.contains(word), "no {word:?} in: {told}"));
    let told = folder.succeeds("solve a.reduction --full --out solved");
    assert!(!told.contains("stretches of time") && told.contains("near rest "), "{told}");
    for method in ["idim-ls", "idim-iv"] {
        assert_same(&folder.estimates("solved", method), &folder.estimates("identified", method), EQUAL);
    }
    let [solved, identified] = ["solved", "identified"].map(|out| folder.0.json(format!("{out}/results.json")));
    assert_eq!((&solved["verdict"], reasons(&solved)), (&identified["verdict"], reasons(&identified)));
    let model = |results: &Value| {
        let parameters = results["model"]["parameters"].as_array().unwrap();
        parameters.iter().map(|p| p["value"].as_f64().unwrap()).collect::<Vec<f64>>()
    };
    let apart = |(a, b): (f64, f64)| (a - b).abs() / b.abs().max(1e-3);
    let worst = model(&solved).into_iter().zip(model(&identified)).map(apart).fold(0.0, f64::max);
    assert!(worst < EQUAL, "{worst}");
    folder.succeeds("export solved/results.json --to urdf --out solved.urdf");
    for file in ["parameters.csv", "report.html"] {
        assert!(folder.path("solved").join(file).is_file(), "{file}");
    }
}

/// The torque of a line in the place of the recorded one.
type Change = fn(usize, f64) -> f64;

/// Torques that mean nothing are not to be used, by `solve` as by `identify`.
#[test]
fn torques_that_mean_nothing_have_the_verdict_of_the_identification() {
    let folder = Records::new();
    let changes: [(&str, Change); 3] =
        [("negated", |_, tau| -tau), ("ramp", |k, _| k as f64 / 500.0), ("noise", |k, _| 5.0 * ((k * k) as f64).sin())];
    for (name, change) in changes {
        let changed = |(k, line): (usize, &str)| {
            let values: Vec<&str> = line.split(',').collect();
            let is_torque = |c: usize| torque_columns().contains(&c) && k > 0;
            let value = |(c, v): (usize, &&str)| {
                if is_torque(c) { change(k, v.parse().unwrap()).to_string() } else { (*v).to_owned() }
            };
            values.iter().enumerate().map(value).collect::<Vec<_>>().join(",") + "\n"
        };
        folder.write(&format!("{name}.csv"), &records()[0].lines().enumerate().map(changed).collect::<String>());
        folder.write(&format!("{name}.toml"), &experiment(&[&format!("{name}.csv")]).replace(", \"idim-iv\"", ""));
        folder.succeeds(&format!("reduce {name}.toml --out {name}.reduction"));
        let codes =
            [format!("identify {name}.toml --out {name}"), format!("solve {name}.reduction --out {name}_solved")]
                .map(|command| folder.run(&command).status.code());
        assert_eq!(codes, [Some(1), Some(1)], "{name}");
        let [identified, solved] = ["", "_solved"].map(|end| folder.0.json(format!("{name}{end}/results.json")));
        assert_eq!(solved["verdict"], "do-not-use", "{name}");
        assert_eq!(reasons(&solved), reasons(&identified), "{name}");
    }
}

/// Code, subject and verdict of each reason.
fn reasons(results: &Value) -> Vec<[String; 3]> {
    let reasons = results["verdict_reasons"].as_array().unwrap();
    reasons.iter().map(|r| ["code", "subject", "verdict"].map(|key| r[key].to_string())).collect()
}

/// The columns of the records that hold torques.
fn torque_columns() -> Vec<usize> {
    let names = records()[0].lines().next().unwrap().split(',');
    names.enumerate().filter(|(_, name)| name.starts_with("torque_")).map(|(c, _)| c).collect()
}

#[test]
fn windows_that_overlap() {
    let folder = Records::new();
    let window = |from: f64, to: f64| format!("[[recording]]\nwindow_start_s = {from}\nwindow_end_s = {to}\n");
    for (name, from, to) in [("first", 0.5, 2.0), ("second", 1.5, 3.0)] {
        folder.with("a.toml", "[[recording]]\n", &window(from, to), &format!("{name}.toml"));
        folder.succeeds(&format!("reduce {name}.toml --out {name}.reduction"));
    }
    let words = ["first.reduction", "second.reduction", "a.csv", "1.5000 to 2.0000 s", "do not overlap"];
    folder.refuses("solve first.reduction second.reduction --out out", &words);
}

#[test]
fn two_reductions_are_merged_in_any_order() {
    let folder = Records::new();
    folder.succeeds("identify both.toml --out identified");
    folder.succeeds("reduce a.toml --out a.reduction");
    folder.succeeds("reduce b.toml --out b.reduction");
    folder.succeeds("reduce both.toml --out both.reduction");
    folder.succeeds("solve a.reduction b.reduction --merged ab.reduction --out ab");
    folder.succeeds("solve b.reduction a.reduction --merged ba.reduction --out ba");
    folder.succeeds("solve ab.reduction --out again");
    folder.succeeds("solve both.reduction --out both");
    let [ab, identified] = ["ab", "identified"].map(|out| folder.estimates(out, "idim-ls"));
    assert_same(&ab, &identified, EQUAL);
    ["ba", "again", "both"].iter().for_each(|out| assert_same(&folder.estimates(out, "idim-ls"), &ab, EQUAL_ORDERS));
    let triangles = |file: &str| {
        let bytes = folder.bytes(file);
        let header = bytes.iter().enumerate().filter(|(_, b)| **b == b'\n').nth(1).unwrap().0;
        bytes[header..bytes.len() - 8].to_vec()
    };
    assert_eq!(triangles("ab.reduction"), triangles("ba.reduction"));
}

#[test]
fn threads_change_no_byte() {
    let folder = Records::new();
    // The arm ends where it began.
    let mut lines = records()[0].lines();
    let names = lines.next().unwrap().strip_prefix("time_s,").unwrap();
    let values: String = lines.map(|line| line.split_once(',').unwrap().1.to_owned() + "\n").collect();
    folder.write("a.csv", &format!("{names}\n{}", values.repeat(REPETITIONS)));
    let time = "time = { file = \"a.csv\", columns = [\"time_s\"], unit = \"s\" }";
    folder.with("a.toml", time, "sample_rate_hz = 500", "long.toml");
    let files = [1, 2, 5].map(|threads| {
        folder.succeeds(&format!("reduce long.toml --threads {threads} --out {threads}.reduction"));
        folder.bytes(&format!("{threads}.reduction"))
    });
    assert!(files[0] == files[1] && files[0] == files[2], "the bytes differ");
}

/// Repeats `reduce` and `solve` until the estimates equal the parameters with which the instruments were simulated.
#[test]
fn instruments_from_results_are_steps_of_iv() {
    let folder = Records::new();
    folder.succeeds("identify a.toml --out identified");
    folder.succeeds("reduce a.toml --rows-only --out 0.reduction");
    folder.succeeds("solve 0.reduction --out 0");
    let mut steps = 0;
    loop {
        let (last, next) = (steps, steps + 1);
        let instruments = format!("--instruments-from {last}/results.json");
        folder.succeeds(&format!("reduce a.toml --rows-only {instruments} --out {next}.reduction"));
        let output = folder.run(&format!("solve {next}.reduction --out {next}"));
        steps = next;
        let results = folder.0.json(format!("{steps}/results.json"));
        let iv = results["runs"].as_array().unwrap().iter().find(|r| r["method"] == "idim-iv").unwrap().clone();
        if iv["status"] == "converged" {
            break;
        }
        assert!(iv["reason"].as_str().unwrap().contains("reduce again"), "{}", shown(&output));
        assert!(steps < 10, "{}", shown(&output));
    }
    let found = folder.estimates(&steps.to_string(), "idim-iv");
    let apart = found.iter().zip(folder.estimates("identified", "idim-iv")).map(|(f, e)| f.from(&e));
    let worst = apart.fold(0.0, f64::max);
    println!("after {steps} steps {worst:.1e} standard deviations at the most");
    assert!(steps > 1 && worst < EQUAL_STEPS, "{steps} {worst}");
    let ls = folder.estimates(&steps.to_string(), "idim-ls");
    assert_same(&ls, &folder.estimates("0", "idim-ls"), EQUAL_ORDERS);
}

// Bad input to `solve`.

#[test]
fn a_file_that_is_no_reduction() {
    let folder = Records::new();
    folder.refuses("solve a.csv --out out", &["a.csv", "not a reduction", "reduce the recordings again"]);
    folder.refuses("solve missing.reduction --out out", &["missing.reduction", "cannot be read"]);
    fs::create_dir(folder.path("folder")).unwrap();
    folder.refuses("solve folder --out out", &["folder", "cannot be read"]);
}

#[test]
fn a_damaged_reduction() {
    let folder = Records::new();
    folder.succeeds("reduce a.toml --out a.reduction");
    let whole = folder.bytes("a.reduction");
    let again = "reduce the recordings again";
    for length in [0, 10, 21, whole.len() / 2, whole.len() - 1] {
        fs::write(folder.path("short.reduction"), &whole[..length]).unwrap();
        folder.refuses("solve short.reduction --out out --merged m", &["short.reduction", "not a reduction", again]);
    }
    for place in [25, whole.len() / 2, whole.len() - 20, whole.len() - 1] {
        let mut damaged = whole.clone();
        damaged[place] ^= 1;
        fs::write(folder.path("flipped.reduction"), damaged).unwrap();
        let solve = "solve a.reduction flipped.reduction --out out --merged m";
        folder.refuses(solve, &["flipped.reduction", "checksum", again]);
    }
}

#[test]
fn the_same_recording_twice() {
    let folder = Records::new();
    folder.succeeds("reduce a.toml --out a.reduction");
    folder.succeeds("reduce b.toml --out b.reduction");
    fs::copy(folder.path("a.csv"), folder.path("copy.csv")).unwrap();
    folder.write("copy.toml", &experiment(&["copy.csv"]));
    folder.succeeds("reduce copy.toml --out copy.reduction");
    let words = ["a.reduction", "copy.reduction", "the same samples", "leave one out"];
    folder.refuses("solve a.reduction b.reduction copy.reduction --out out --merged m", &words);
    folder.refuses("solve a.reduction a.reduction", &["a.reduction, a.reduction", "the same samples"]);
    folder.write("copies.toml", &experiment(&["a.csv", "copy.csv"]));
    folder.refuses("reduce copies.toml --out out", &["recordings 1 and 2", "leave one out"]);
}

#[test]
fn reductions_of_other_robots_and_filters() {
    let folder = Records::new();
    folder.succeeds("reduce a.toml --out a.reduction");
    folder.with("robot.toml", "a_m = 0.4", "a_m = 0.5", "longer.toml");
    folder.with("robot.toml", "name = \"elbow\"", "name = \"wrist\"", "renamed.toml");
    folder.with("b.toml", "robot.toml", "longer.toml", "geometry.toml");
    folder.with("b.toml", "robot.toml", "renamed.toml", "joint.toml");
    folder.with("b.toml", "cutoff_hz = 40", "cutoff_hz = 50", "cutoff.toml");
    folder.with("b.toml", "decimation = 10", "decimation = 5", "decimation.toml");
    folder.with("b.toml", "[signal]", "[signal]\nmask = 'none'", "mask.toml");
    for (name, what) in [
        ("geometry", "formula"),
        ("joint", "joints"),
        ("cutoff", "cut-off in Hz differs: 40 in the first, 50 in the other"),
        ("decimation", "decimation differs: 10"),
        (
            "mask",
            "mask near rest differs: near-rest, sign_velocity_scale 0.05, zero beyond the window in the first, none in the other",
        ),
    ] {
        folder.succeeds(&format!("reduce {name}.toml --out {name}.reduction"));
        let solve = format!("solve a.reduction {name}.reduction --out out --merged m");
        folder.refuses(&solve, &["a.reduction", &format!("{name}.reduction"), what, "reduce both"]);
    }
}

#[test]
fn reductions_with_and_without_instruments() {
    let folder = Records::new();
    folder.succeeds("reduce a.toml --out a.reduction");
    folder.succeeds("solve a.reduction --out first");
    folder.succeeds("reduce b.toml --instruments-from first/results.json --out b.reduction");
    let words = ["a.reduction", "b.reduction", "instruments differs: none", "reduce both"];
    folder.refuses("solve a.reduction b.reduction --out out", &words);
}

#[test]
fn places_where_no_file_can_be() {
    let folder = Records::new();
    folder.refuses("reduce a.toml --out none/a.reduction", &["none", "make it"]);
    folder.refuses("reduce a.toml --out .", &["folder", "the name of a file"]);
    folder.succeeds("reduce a.toml --out a.reduction");
    folder.refuses("solve a.reduction --merged none/m --out out", &["none", "make it"]);
    folder.refuses("solve a.reduction --out a.csv", &["a.csv"]);
}

// Bad input to `reduce`.

#[test]
fn instruments_from_files_without_estimates() {
    let folder = Records::new();
    let of = |file: &str| format!("reduce a.toml --instruments-from {file} --out out");
    folder.refuses(&of("missing.json"), &["missing.json", "cannot be read"]);
    folder.write("text.json", "{}");
    folder.refuses(&of("text.json"), &["text.json", "give one that an identification wrote"]);
    folder.succeeds("reduce a.toml --out a.reduction");
    folder.succeeds("solve a.reduction --out first");
    folder.with("first/results.json", "\"runs\": [", "\"runs\": [], \"others\": [", "empty.json");
    folder.refuses(&of("empty.json"), &["empty.json", "no nominal estimate"]);
    let text = fs::read_to_string(folder.path("first/results.json")).unwrap();
    folder.write("other.json", &text.replace("\"fv1\"", "\"fv7\""));
    folder.refuses(&of("other.json"), &["other.json", "fv7"]);
}

#[test]
fn a_bad_record_names_its_place() {
    let folder = Records::new();
    let line = records()[0].lines().nth(1000).unwrap().to_owned();
    folder.with("a.csv", &line, &line.replacen(',', ",x", 1), "a.csv");
    folder.refuses("reduce a.toml --out out", &["a.csv", "1001", "position_1"]);
}
