//! Bad input to the command line: one valid case, one defect per test.
//!
//! Each defect ends with exit code 2, a message that names the place, what was expected and what was found, and no file
//! written. The library's own tests match the variants; here it is the words that a user reads.

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Output},
};

use thetahat_testing::{Folder, run, shown};

const PROGRAM: &str = env!("CARGO_BIN_EXE_thetahat");

const ROBOT: &str = r#"
name = "slider"

[[joint]]
name = "slide"
kind = "prismatic"
alpha_deg = 90

[transmission]
matrix = [[1]]

[parameters]
m1 = 10
"#;

const EXPERIMENT: &str = r#"
title = "a slider"
robot = "robot.toml"

[recording]
sample_rate_hz = 1000
position = { file = "record.csv", columns = ["q1"], unit = "m" }
torque = { file = "record.csv", columns = ["tau1"], unit = "N" }

[signal]
cutoff_hz = 50
decimation = 10

[parameters]
estimate = "base"

[estimation]
methods = ["idim-ls"]
"#;

/// Rest, then back-to-back moves between these points, in m, then rest.
const POINTS: [f64; 8] = [0.0, 0.2, -0.1, 0.15, 0.05, -0.2, 0.1, 0.0];
const MOVE_S: f64 = 0.4;
const REST_S: f64 = 0.3;
const STEP_S: f64 = 1e-3;
const SAMPLES: usize = 3400;
/// Mass, viscous and Coulomb friction, offset.
const TRUTH: [f64; 4] = [20.0, 30.0, 5.0, 2.0];

/// Position, velocity and acceleration at a time.
fn motion(t: f64) -> [f64; 3] {
    let place = ((t - REST_S) / MOVE_S).clamp(0.0, (POINTS.len() - 1) as f64);
    let k = (place as usize).min(POINTS.len() - 2);
    let (u, step) = (place - k as f64, POINTS[k + 1] - POINTS[k]);
    let s = u.powi(3) * (10.0 - 15.0 * u + 6.0 * u * u);
    let ds = 30.0 * u * u * (1.0 - u).powi(2);
    let dds = 60.0 * u * (1.0 - u) * (1.0 - 2.0 * u);
    [POINTS[k] + step * s, step * ds / MOVE_S, step * dds / MOVE_S.powi(2)]
}

fn force([_, v, a]: [f64; 3]) -> f64 {
    let sign = if v == 0.0 { 0.0 } else { v.signum() };
    TRUTH[0] * a + TRUTH[1] * v + TRUTH[2] * sign + TRUTH[3]
}

fn record() -> String {
    let row = |k: usize| {
        let t = k as f64 * STEP_S;
        let state = motion(t);
        format!("{t:.3},{},{}\n", state[0], force(state))
    };
    format!("t,q1,tau1\n{}", (0..SAMPLES).map(row).collect::<String>())
}

/// A folder with a case.
struct Case {
    folder: Folder,
}

impl Case {
    /// The valid case.
    fn valid() -> Self {
        let case = Self { folder: Folder::new() };
        case.write("robot.toml", ROBOT);
        case.write("experiment.toml", EXPERIMENT);
        case.write("record.csv", &record());
        case
    }

    fn path(&self, file: &str) -> PathBuf {
        self.folder.at(file)
    }

    fn write(&self, file: &str, text: &str) {
        self.folder.write(file, text);
    }

    fn read(&self, file: &str) -> String {
        self.folder.text(file)
    }

    /// Puts a defect into a file.
    fn with(self, file: &str, from: &str, to: &str) -> Self {
        self.folder.replace(file, from, to, file);
        self
    }

    /// Puts a defect into the experiment.
    fn experiment(self, from: &str, to: &str) -> Self {
        self.with("experiment.toml", from, to)
    }

    /// Puts a defect into a line of the record, counted from 1.
    fn record_line(self, line: usize, change: impl Fn(&str) -> String) -> Self {
        let text = self.read("record.csv");
        let changed = |(i, l): (usize, &str)| if i + 1 == line { change(l) } else { l.to_owned() };
        let lines: Vec<String> = text.lines().enumerate().map(changed).collect();
        self.write("record.csv", &(lines.join("\n") + "\n"));
        self
    }

    fn run(&self, arguments: &[&str]) -> Output {
        run(PROGRAM, self.folder.path(), arguments.iter().copied())
    }

    fn identify(&self) -> Output {
        self.run(&["identify", "experiment.toml", "--out", "out"])
    }

    /// Asserts that the case is refused as it should be, with these words in the message.
    fn is_refused(&self, words: &[&str]) {
        refused(&self.identify(), words);
        assert!(is_missing_or_empty(&self.path("out")), "something was written");
    }

    /// Identifies, and asserts that a prediction is refused and writes nothing.
    fn prediction_is_refused(&self, arguments: &[&str], words: &[&str]) {
        let all = [&["predict", "out/results.json", "--out", "prediction.csv"], arguments].concat();
        refused(&self.run(&all), words);
        assert!(!self.path("prediction.csv").exists(), "something was written");
    }
}

fn refused(output: &Output, words: &[&str]) {
    let message = thetahat_testing::refused(output);
    for word in words {
        assert!(message.contains(word), "no {word:?} in: {message}");
    }
    for word in ["panicked", "Some(", "None", "Err("] {
        assert!(!message.contains(word), "{word:?} in: {message}");
    }
}

fn is_missing_or_empty(folder: &Path) -> bool {
    fs::read_dir(folder).map_or(true, |mut entries| entries.next().is_none())
}

fn is_identified(case: &Case) {
    is_written(case, &case.identify(), 0);
}

fn is_written(case: &Case, output: &Output, code: i32) {
    assert_eq!(output.status.code(), Some(code), "{}", shown(output));
    for file in ["results.json", "parameters.csv", "report.html"] {
        assert!(case.path("out").join(file).is_file(), "{file}");
    }
}

// The valid case, and what looks bad and is not.

#[test]
fn the_valid_case_is_identified() {
    let case = Case::valid();
    is_identified(&case);
    let parameters = case.read("out/parameters.csv");
    let mass = parameters.lines().find(|l| l.contains(",m1r,")).unwrap();
    let estimate: f64 = mass.split(',').nth(3).unwrap().parse().unwrap();
    assert!((estimate / TRUTH[0] - 1.0).abs() < 0.01, "{mass}");
}

#[test]
fn a_byte_order_mark_and_carriage_returns_do_no_harm() {
    let case = Case::valid();
    case.write("record.csv", &format!("\u{feff}{}", record().replace('\n', "\r\n")));
    is_identified(&case);
}

#[test]
fn a_reader_that_has_gone_away_does_not_stop_the_files() {
    let case = Case::valid();
    let mut child = Command::new(PROGRAM)
        .current_dir(case.folder.path())
        .args(["identify", "experiment.toml", "--out", "out"])
        .stdout(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    assert_eq!(child.wait().unwrap().code(), Some(0));
    assert!(case.path("out").join("results.json").is_file());
}

// The data.

#[test]
fn missing_data_file() {
    Case::valid().experiment("record.csv", "absent.csv").is_refused(&["absent.csv", "no such file"]);
}

#[test]
fn missing_data_folder() {
    let case = Case::valid();
    refused(&case.run(&["identify", "experiment.toml", "--data", "absent"]), &["absent", "record.csv", "no such file"]);
}

#[test]
fn missing_column() {
    Case::valid().experiment("\"tau1\"", "\"tau7\"").is_refused(&[
        "record.csv",
        "\"tau7\"",
        "the columns are \"t\", \"q1\", \"tau1\"",
    ]);
}

#[test]
fn doubled_column() {
    Case::valid().with("record.csv", "t,q1,tau1", "t,q1,q1").experiment("\"tau1\"", "\"q1\"").is_refused(&[
        "record.csv",
        "\"q1\"",
        "2 times",
        "q1#2",
    ]);
}

#[test]
fn an_infinity_in_the_data() {
    Case::valid().record_line(40, |l| l.rsplit_once(',').unwrap().0.to_owned() + ",inf").is_refused(&[
        "record.csv",
        "line 40",
        "\"tau1\"",
        "finite",
        "inf",
    ]);
}

#[test]
fn text_instead_of_a_number() {
    Case::valid().record_line(41, |l| l.rsplit_once(',').unwrap().0.to_owned() + ",fault").is_refused(&[
        "record.csv",
        "line 41",
        "\"tau1\"",
        "expected a number",
        "fault",
    ]);
}

#[test]
fn decimal_commas() {
    Case::valid().record_line(2, |_| "0,0,0,0,0,0".to_owned()).is_refused(&[
        "record.csv",
        "line 2",
        "expected 3 values",
        "found 6",
    ]);
}

#[test]
fn positions_and_torques_of_different_length() {
    let case = Case::valid().experiment("torque = { file = \"record.csv\"", "torque = { file = \"torque.csv\"");
    let lines: Vec<String> = record().lines().take(SAMPLES - 4).map(str::to_owned).collect();
    case.write("torque.csv", &(lines.join("\n") + "\n"));
    case.is_refused(&["record.csv", "torque.csv", "3400 samples", "3395"]);
}

/// What is expected is said in words, not as a type of the program.
#[test]
fn values_of_another_kind() {
    for (line, words) in [
        ("cutoff_hz = \"x\"", "expected a number, found the text \"x\""),
        ("cutoff_hz = [1]", "expected a number, found a list"),
    ] {
        let case = Case::valid().experiment("cutoff_hz = 50", line);
        case.is_refused(&["experiment.toml", "line", words]);
    }
}

#[test]
fn one_row() {
    let case = Case::valid();
    case.write("record.csv", "t,q1,tau1\n0,0,1\n");
    case.is_refused(&["experiment.toml", "[signal]", "cutoff_hz", "periods fit into"]);
}

#[test]
fn no_rows() {
    let case = Case::valid();
    case.write("record.csv", "t,q1,tau1\n");
    case.is_refused(&["record.csv", "at least one sample"]);
}

#[test]
fn a_recording_without_motion() {
    let case = Case::valid();
    let rows: String = (0..SAMPLES).map(|k| format!("{:.3},0.1,2\n", k as f64 * STEP_S)).collect();
    case.write("record.csv", &format!("t,q1,tau1\n{rows}"));
    case.is_refused(&["experiment.toml", "nothing moves", "peak velocity"]);
}

#[test]
fn torques_that_were_not_recorded() {
    let case = Case::valid();
    let rows: String = (0..SAMPLES).map(|k| format!("0,{},0\n", motion(k as f64 * STEP_S)[0])).collect();
    case.write("record.csv", &format!("t,q1,tau1\n{rows}"));
    case.is_refused(&["record.csv", "torque is zero at every sample"]);
}

#[test]
fn a_file_of_another_format() {
    Case::valid().experiment("record.csv", "record.xlsx").is_refused(&["record.xlsx", ".csv or .mat", "xlsx"]);
}

#[test]
fn a_mat_file_that_is_none() {
    let case = Case::valid().experiment("record.csv", "record.mat");
    case.write("record.mat", &record());
    case.is_refused(&["record.mat", "MAT file of version 5", "save -v7"]);
}

#[test]
fn a_filter_of_what_is_no_torque() {
    let torque = "unit = \"N\" }";
    let zero = Case::valid().experiment(torque, "unit = \"N\", low_pass_s = 0 }");
    zero.is_refused(&["experiment.toml", "low_pass_s", "above 0"]);
    let of_position = Case::valid().experiment("unit = \"m\" }", "unit = \"m\", low_pass_s = 0.01 }");
    of_position.is_refused(&["experiment.toml", "low_pass_s", "for the torque alone"]);
    is_identified(&Case::valid().experiment(torque, "unit = \"N\", low_pass_s = 0.001 }"));
}

#[test]
fn sizes_that_were_estimated_are_of_this_robot() {
    let stated = |size: &str| {
        let model = format!("[model]\nestimated = [\"{size}\"]\n\n[parameters]\nestimate");
        Case::valid().experiment("[parameters]\nestimate", &model)
    };
    stated("gear-ratio").is_refused(&["experiment.toml", "gear-ratio-2", "\"gear-ratio\""]);
    stated("gear-ratio-2").is_refused(&["experiment.toml", "[model] estimated", "gear-ratio-2"]);
    let case = stated("gear-ratio-1");
    is_identified(&case);
    refused(&case.run(&["reduce", "experiment.toml", "--out", "reduced"]), &["[model] estimated", "thetahat identify"]);
}

// Time.

const TIME: &str = "time = { file = \"record.csv\", columns = [\"t\"], unit = \"s\" }";

#[test]
fn a_time_column_gives_the_rate() {
    is_identified(&Case::valid().experiment("sample_rate_hz = 1000", TIME));
}

#[test]
fn time_that_goes_back() {
    Case::valid()
        .experiment("sample_rate_hz = 1000", TIME)
        .record_line(100, |l| format!("0.01,{}", l.split_once(',').unwrap().1))
        .is_refused(&["record.csv", "\"t\"", "sample 98", "later than 0.097 s", "found 0.01 s"]);
}

#[test]
fn sample_rate_and_time() {
    Case::valid().experiment("sample_rate_hz = 1000", &format!("sample_rate_hz = 1000\n{TIME}")).is_refused(&[
        "experiment.toml",
        "sample_rate_hz",
        "time",
        "either",
    ]);
}

#[test]
fn neither_sample_rate_nor_time() {
    Case::valid().experiment("sample_rate_hz = 1000", "").is_refused(&[
        "experiment.toml",
        "sample_rate_hz",
        "time",
        "missing",
    ]);
}

#[test]
fn time_of_another_record() {
    let case = Case::valid().experiment("sample_rate_hz = 1000", &TIME.replace("record", "time"));
    case.write("time.csv", "t\n0\n0.001\n0.002\n");
    case.is_refused(&["record.csv", "time.csv", "3400 samples", "has 3"]);
}

#[test]
fn several_columns_of_time() {
    Case::valid().experiment("sample_rate_hz = 1000", &TIME.replace("[\"t\"]", "[]")).is_refused(&[
        "record.csv",
        "one channel of time",
        "found 3",
    ]);
}

// Units and joints.

#[test]
fn unknown_unit() {
    Case::valid().experiment("unit = \"N\"", "unit = \"lbf\"").is_refused(&[
        "experiment.toml",
        "line 8",
        "lbf",
        "\"N m\"",
    ]);
}

#[test]
fn position_of_a_slide_as_an_angle() {
    Case::valid().experiment("unit = \"m\"", "unit = \"rad\"").is_refused(&[
        "record.csv",
        "position is a length",
        "\"rad\"",
        "an angle",
    ]);
}

#[test]
fn more_columns_than_joints() {
    Case::valid().experiment("[\"q1\"]", "[\"q1\", \"t\"]").is_refused(&[
        "record.csv",
        "number of channels is 2",
        "expected 1, one for each coordinate of the robot",
    ]);
}

#[test]
fn more_joints_than_columns() {
    Case::valid()
        .with("robot.toml", "[transmission]", "[[joint]]\nname = \"second\"\nkind = \"prismatic\"\n[transmission]")
        .with("robot.toml", "[[1]]", "[[1, 0], [0, 1]]")
        .is_refused(&["record.csv", "number of channels is 1", "expected 2"]);
}

// The robot.

#[test]
fn missing_robot_file() {
    Case::valid().experiment("robot.toml", "absent.toml").is_refused(&["absent.toml", "cannot be read"]);
}

#[test]
fn a_singular_coupling_matrix() {
    Case::valid().with("robot.toml", "[[1]]", "[[0]]").is_refused(&[
        "robot.toml",
        "line 10",
        "matrix is singular",
        "row 1",
    ]);
}

#[test]
fn a_coupling_matrix_that_is_not_finite() {
    Case::valid().with("robot.toml", "[[1]]", "[[inf]]").is_refused(&["robot.toml", "[transmission]", "inf"]);
}

#[test]
fn an_offset_in_degrees_of_a_slide() {
    Case::valid().with("robot.toml", "[[1]]", "[[1]]\noffset_deg = [90]").is_refused(&[
        "robot.toml",
        "offset_deg",
        "offset_m",
    ]);
}

#[test]
fn parents_in_a_cycle() {
    Case::valid().with("robot.toml", "alpha_deg = 90", "parent = \"slide\"").is_refused(&[
        "robot.toml",
        "line 4",
        "cycle",
        "slide -> slide",
    ]);
}

#[test]
fn two_joints_of_one_name() {
    Case::valid()
        .with("robot.toml", "[transmission]", "[[joint]]\nname = \"slide\"\nkind = \"prismatic\"\n[transmission]")
        .is_refused(&["robot.toml", "line 9", "`slide`", "name of another joint"]);
}

#[test]
fn an_unknown_a_priori_parameter() {
    Case::valid().with("robot.toml", "m1 = 10", "mass = 10").is_refused(&[
        "robot.toml",
        "[parameters] mass",
        "joint 1 has",
        "m1",
    ]);
}

// The experiment.

#[test]
fn missing_experiment_file() {
    let case = Case::valid();
    refused(&case.run(&["identify", "absent.toml", "--out", "out"]), &["absent.toml", "cannot be read"]);
    assert!(is_missing_or_empty(&case.path("out")));
}

#[test]
fn an_unknown_key() {
    Case::valid().experiment("cutoff_hz", "cutof_hz").is_refused(&[
        "experiment.toml",
        "line 11",
        "cutof_hz",
        "`cutoff_hz`",
    ]);
}

#[test]
fn an_unknown_method() {
    Case::valid().experiment("idim-ls", "idim-ols").is_refused(&[
        "experiment.toml",
        "line 18",
        "idim-ols",
        "idim-ls",
        "didim",
    ]);
}

#[test]
fn a_method_listed_twice() {
    Case::valid().experiment("[\"idim-ls\"]", "[\"idim-ls\", \"idim-ls\"]").is_refused(&[
        "experiment.toml",
        "methods",
        "idim-ls twice",
    ]);
}

#[test]
fn no_method() {
    Case::valid().experiment("[\"idim-ls\"]", "[]").is_refused(&["experiment.toml", "methods", "empty"]);
}

#[test]
fn no_controller_for_didim() {
    Case::valid().experiment("idim-ls", "didim").is_refused(&["experiment.toml", "[controller] is missing", "didim"]);
}

#[test]
fn a_cut_off_above_nyquist() {
    Case::valid().experiment("cutoff_hz = 50", "cutoff_hz = 600").is_refused(&[
        "experiment.toml",
        "[signal]",
        "600 Hz",
        "Nyquist",
        "500 Hz",
    ]);
}

#[test]
fn a_cut_off_that_is_no_number() {
    for (found, word) in [("nan", "NaN"), ("inf", "inf"), ("0", "0"), ("-5", "-5")] {
        Case::valid().experiment("cutoff_hz = 50", &format!("cutoff_hz = {found}")).is_refused(&[
            "experiment.toml",
            "[signal] cutoff_hz",
            word,
            "above zero",
        ]);
    }
}

#[test]
fn a_cut_off_slower_than_the_record() {
    Case::valid().experiment("cutoff_hz = 50", "cutoff_hz = 1e-9").is_refused(&[
        "experiment.toml",
        "[signal] cutoff_hz",
        "at least",
        "periods",
    ]);
}

#[test]
fn a_filter_of_no_or_absurd_order() {
    for order in ["0", "50", "1000000000"] {
        Case::valid().experiment("cutoff_hz", &format!("filter_order = {order}\ncutoff_hz")).is_refused(&[
            "experiment.toml",
            "[signal] filter_order",
            order,
            "from 1 to 20",
        ]);
    }
}

#[test]
fn a_decimation_that_leaves_too_few_rows() {
    for factor in ["1000", "1000000000000000000"] {
        Case::valid().experiment("decimation = 10", &format!("decimation = {factor}")).is_refused(&[
            "experiment.toml",
            "[signal] decimation",
            factor,
            "rows are left for 4 parameters",
        ]);
    }
}

#[test]
fn a_window_beyond_the_record() {
    Case::valid().experiment("[parameters]", "window_end_s = 9\n[parameters]").is_refused(&[
        "experiment.toml",
        "window_end_s",
        "9 s",
        "3.4000 s",
    ]);
}

#[test]
fn times_to_leave_out_beyond_the_recording() {
    let late = "sample_rate_hz = 1000\nleft_out_s = [[0.5, 0.6], [3.9, 9.0]]";
    Case::valid().experiment("sample_rate_hz = 1000", late).is_refused(&[
        "experiment.toml",
        "left_out_s is [3.9, 9]",
        "expected intervals that start before the recording ends",
    ]);
}

#[test]
fn a_window_that_ends_before_it_starts() {
    Case::valid().experiment("[parameters]", "window_start_s = 2\nwindow_end_s = 1\n[parameters]").is_refused(&[
        "experiment.toml",
        "window_end_s",
        "later than window_start_s",
    ]);
}

#[test]
fn an_unknown_parameter_to_estimate() {
    Case::valid().experiment("\"base\"", "[\"m1r\", \"fv7\"]").is_refused(&[
        "experiment.toml",
        "[parameters]",
        "`fv7`",
        "m1r fv1 fc1 off1",
    ]);
}

#[test]
fn a_choice_of_parameters_that_is_none() {
    Case::valid().experiment("\"base\"", "\"basic\"").is_refused(&[
        "experiment.toml",
        "line 15",
        "\"base\"",
        "\"essential\"",
        "list",
    ]);
}

#[test]
fn no_parameter_to_estimate() {
    Case::valid().experiment("\"base\"", "[]").is_refused(&["experiment.toml", "estimate", "empty"]);
}

#[test]
fn an_unknown_parameter_to_show() {
    Case::valid().experiment("estimate = \"base\"", "show = [\"fv7\"]").is_refused(&[
        "experiment.toml",
        "[parameters]",
        "`fv7`",
        "m1r fv1 fc1 off1",
    ]);
}

#[test]
fn an_unknown_parameter_to_exclude() {
    Case::valid().experiment("estimate = \"base\"", "exclude = [\"fv7\"]").is_refused(&[
        "experiment.toml",
        "[parameters]",
        "`fv7`",
        "exclude",
    ]);
}

#[test]
fn every_parameter_excluded() {
    Case::valid()
        .experiment("estimate = \"base\"", "exclude = [\"m1\", \"ia1\", \"fv1\", \"fc1\", \"off1\"]")
        .is_refused(&["experiment.toml", "[parameters]", "exclude", "leaves no parameter"]);
}

#[test]
fn two_cases_of_one_name() {
    let case = "[[case]]\nname = \"other\"\n";
    Case::valid().experiment("[parameters]", &format!("{case}{case}[parameters]")).is_refused(&[
        "experiment.toml",
        "[[case]] name",
        "other",
    ]);
}

const TWIN: &str = r#"[twin]
sample_rate_hz = 1000
points = [[0], [200], [-100], [0]]
max_velocity = [500]
acceleration_time_s = 0.2
smoothing_time_s = 0.04
rest_s = 0.3
parameters = { m1r = 20, fv1 = 30, fc1 = 5, off1 = 2 }
sensors = { encoder_counts_per_turn = 1e6, torque_noise = [0.1], torque_ripple = [0], ripple_per_turn = 6, seed = 1 }

[controller]
law = "pd"
bandwidth_hz = [20]

[signal]"#;

fn twin() -> Case {
    let case = Case::valid();
    let (before, recording) = EXPERIMENT.split_once("[recording]").unwrap();
    let after = recording.split_once("[signal]").unwrap().1;
    case.write("experiment.toml", &format!("{before}{TWIN}{after}"));
    case
}

#[test]
fn a_twin_is_identified() {
    is_identified(&twin());
}

#[test]
fn a_twin_without_a_controller() {
    twin().experiment("[controller]\nlaw = \"pd\"\nbandwidth_hz = [20]", "").is_refused(&[
        "experiment.toml",
        "[controller] is missing",
        "twin",
    ]);
}

#[test]
fn a_twin_with_numbers_that_are_none() {
    for (from, to, key) in [
        ("[200]", "[inf]", "points"),
        ("m1r = 20", "m1r = nan", "[twin.parameters] m1r"),
        ("torque_noise = [0.1]", "torque_noise = [nan]", "torque_noise"),
        ("ripple_per_turn = 6", "ripple_per_turn = nan", "ripple_per_turn"),
        ("smoothing_time_s = 0.04", "smoothing_time_s = nan", "[twin] smoothing_time_s"),
        ("max_velocity = [500]", "max_velocity = [0]", "[twin] max_velocity"),
        ("sample_rate_hz = 1000", "sample_rate_hz = 1e-9", "[twin] duration of the moves times sample_rate_hz"),
        ("[200]", "[1e15]", "[twin] duration of the moves times sample_rate_hz"),
    ] {
        twin().experiment(from, to).is_refused(&["experiment.toml", key, "expected"]);
    }
}

#[test]
fn a_twin_that_cannot_be_simulated() {
    twin().experiment("[20]", "[1e9]").is_refused(&["experiment.toml", "[twin]", "too stiff", "bandwidth"]);
}

#[test]
fn recording_and_twin() {
    let case = twin();
    let recording = EXPERIMENT.split_once("[recording]").unwrap().1.split_once("[signal]").unwrap().0;
    case.experiment("[signal]", &format!("[recording]{recording}[signal]")).is_refused(&[
        "experiment.toml",
        "[recording] or [twin]",
        "exactly one",
    ]);
}

#[test]
fn a_missing_table_of_published_figures() {
    Case::valid()
        .experiment("[recording]", "published = \"absent.csv\"\n[recording]")
        .is_refused(&["absent.csv", "cannot be read"]);
}

#[test]
fn a_malformed_table_of_published_figures() {
    let case = Case::valid().experiment("[recording]", "published = \"table.csv\"\n[recording]");
    let header = "case,method,parameter,estimate,relative_standard_deviation_percent";
    case.write("table.csv", &format!("{header}\nnominal,idim-ls,m1r,twenty,\n"));
    case.is_refused(&["table.csv", "line 2", "expected a number", "twenty"]);
}

// What is not bad input: a motion that does not identify everything.

#[test]
fn a_joint_that_does_not_move_is_named() {
    let case = Case::valid()
        .with("robot.toml", "[transmission]", "[[joint]]\nname = \"second\"\nkind = \"prismatic\"\n[transmission]")
        .with("robot.toml", "[[1]]", "[[1, 0], [0, 1]]")
        .experiment("[\"q1\"]", "[\"q1\", \"q2\"]")
        .experiment("[\"tau1\"]", "[\"tau1\", \"tau2\"]");
    let lines = record().lines().skip(1).map(|l| format!("{l},0.3,9\n")).collect::<String>();
    case.write("record.csv", &format!("t,q1,tau1,q2,tau2\n{lines}"));
    let output = case.identify();
    assert_eq!(output.status.code(), Some(1));
    let text = String::from_utf8_lossy(&output.stdout);
    let of_moving_joint = |name: &str| text.lines().any(|line| line.contains(name) && line.contains('\u{b1}'));
    assert!(text.contains("converged") && ["m1r", "fv1", "fc1"].into_iter().all(of_moving_joint), "{text}");
    let not_identified = text.split_once("not identified by the recordings\n").unwrap().1;
    assert!(not_identified.lines().next().unwrap().ends_with("fv2 fc2"), "{text}");
    let results: serde_json::Value = serde_json::from_str(&case.read("out/results.json")).unwrap();
    let left_out: Vec<&str> =
        results["not_separated"].as_array().unwrap().iter().filter_map(|p| p["parameter"].as_str()).collect();
    assert!(left_out.contains(&"fv2") && left_out.contains(&"fc2"), "{left_out:?}");
    assert!(case.read("out/report.html").contains("Left out: fv2, which has no effect in this motion."));
}

/// What the second recording would eliminate is no matter: it is predicted with the parameters of the first.
#[test]
fn essential_parameters_are_validated_on_another_recording() {
    let recording = EXPERIMENT.split_once("[recording]").unwrap().1.split_once("[signal]").unwrap().0;
    let validation = format!("[validation]{}[signal]", recording.replace("record.csv", "other.csv"));
    let case = Case::valid().experiment("\"base\"", "\"essential\"").experiment("[signal]", &validation);
    let row = |k: usize| {
        let [q, _, a] = motion(k as f64 * STEP_S);
        format!("0,{q},{}\n", TRUTH[0] * a + 9.0 * (78.233 * k as f64).sin())
    };
    case.write("other.csv", &format!("t,q1,tau1\n{}", (0..SAMPLES).map(row).collect::<String>()));
    // Half of its torques is noise, which no model predicts: the recordings disagree.
    is_identified(&case);
    let results: serde_json::Value = serde_json::from_str(&case.read("out/results.json")).unwrap();
    assert_eq!(results["verdict"], "care");
    assert!(results["model"]["held_back"]["percent"].as_f64().unwrap() > 10.0, "{}", results["model"]["held_back"]);
    assert!(!case.read("out/results.json").contains("\"cross_validation_relative_error_percent\": null"));
}

/// A locked joint without torque has no relative error, and its results can still be read.
#[test]
fn results_with_a_locked_joint_are_predicted_from() {
    let case = Case::valid()
        .with("robot.toml", "[transmission]", "[[joint]]\nname = \"second\"\nkind = \"prismatic\"\n[transmission]")
        .with("robot.toml", "[[1]]", "[[1, 0], [0, 1]]")
        .experiment("\"base\"", "[\"fv1\", \"fc1\", \"off1\"]")
        .experiment("[\"q1\"]", "[\"q1\", \"q2\"]")
        .experiment("[\"tau1\"]", "[\"tau1\", \"tau2\"]");
    let lines = record().lines().skip(1).map(|l| format!("{l},0.3,0\n")).collect::<String>();
    case.write("record.csv", &format!("t,q1,tau1,q2,tau2\n{lines}"));
    // Without the mass, least squares explains next to nothing; the model has it.
    is_identified(&case);
    let predict = ["predict", "out/results.json", "--recording", "record.csv"];
    for method in [&[][..], &["--method", "idim-ls"]] {
        let output = case.run(&[&predict[..], method].concat());
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
        assert!(String::from_utf8_lossy(&output.stdout).contains("not measured"));
    }
}

// The output.

#[test]
fn an_output_folder_that_is_a_file() {
    let case = Case::valid();
    case.write("out", "kept");
    refused(&case.identify(), &["out", "expected a folder, found a file"]);
    assert_eq!(case.read("out"), "kept");
}

#[test]
fn an_output_folder_below_a_file() {
    let case = Case::valid();
    let output = case.run(&["identify", "experiment.toml", "--out", "robot.toml/out"]);
    refused(&output, &["robot.toml", "expected a folder, found a file"]);
}

// Predictions.

#[test]
fn results_are_predicted_from() {
    let case = Case::valid();
    is_identified(&case);
    let output = case.run(&["predict", "out/results.json", "--recording", "record.csv", "--out", "prediction.csv"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(case.read("prediction.csv").lines().count(), SAMPLES + 1);
}

/// A prediction is worth what the results are from which it is made; those of before the verdict are judged.
#[test]
fn a_prediction_carries_the_verdict() {
    let case = Case::valid();
    is_identified(&case);
    let mut results: serde_json::Value = serde_json::from_str(&case.read("out/results.json")).unwrap();
    let predict = |results: &serde_json::Value, code| {
        case.write("out/results.json", &results.to_string());
        let output = case.run(&["predict", "out/results.json", "--recording", "record.csv"]);
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        assert_eq!(output.status.code(), Some(code), "{text}");
        text
    };
    results["runs"][0]["status"] = "stalled".into();
    results.as_object_mut().unwrap().retain(|key, _| !key.starts_with("verdict") && key != "model" && key != "digest");
    let text = predict(&results, 1);
    assert!(text.contains("DO NOT USE the numbers") && text.contains("[not-converged] idim-ls"), "{text}");
    results["verdict"] = "good".into();
    assert!(predict(&results, 0).contains("verdict on its results: good"));
}

#[test]
fn results_that_are_none() {
    let case = Case::valid();
    fs::create_dir(case.path("out")).unwrap();
    for text in ["{}", "t,q1\n", ""] {
        case.write("out/results.json", text);
        case.prediction_is_refused(&["--recording", "record.csv"], &["out/results.json", "is not the results.json"]);
    }
}

#[test]
fn missing_results() {
    let case = Case::valid();
    case.prediction_is_refused(&["--recording", "record.csv"], &["out/results.json", "cannot be read"]);
}

#[test]
fn a_case_and_a_method_without_results() {
    let case = Case::valid();
    is_identified(&case);
    let recording = ["--recording", "record.csv"];
    case.prediction_is_refused(&[&recording[..], &["--case", "absent"]].concat(), &["absent", "nominal idim-ls"]);
    case.prediction_is_refused(&[&recording[..], &["--method", "didim"]].concat(), &["didim", "nominal idim-ls"]);
    case.prediction_is_refused(&[&recording[..], &["--method", "wls"]].concat(), &["wls", "idim-ls", "didim"]);
}

#[test]
fn a_recording_to_predict_for_that_is_missing() {
    let case = Case::valid();
    is_identified(&case);
    case.prediction_is_refused(&["--recording", "absent.csv"], &["absent.csv", "no such file"]);
}

#[test]
fn a_prediction_from_a_twin() {
    let case = twin();
    is_identified(&case);
    case.prediction_is_refused(&["--recording", "record.csv"], &["out/results.json", "[recording] is missing"]);
}
