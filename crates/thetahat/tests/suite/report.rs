//! The report of hand-made results.

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
};

use thetahat::{
    Results,
    report::{Published, ReportError, write_all},
    results::{
        JointResult, ParameterResult, ReasonCode, RecordingFindings, ResultsError, RunResult, Verdict, VerdictReason,
    },
    statistics::chi_squared_test,
};
use thetahat_report::{
    report::{self, Agreement, TextWidth, text},
    results::{
        Advice, Bandwidth, BiasExplanation, BiasKind, BiasedSimulatorResult, Bin, CaseDiagnosis, Code, Comparison,
        EliminationResult, EndogeneityResult, FTest, Finding, Frame, HeldBackPlots, HiddenBias, HiddenError, Influence,
        IterationResult, JointKind, JointResidual, Method, NotSeparated, ParameterDifference, Plots, ReasonSubject,
        RecordStart, RecordingResult, ReferenceResult, ResidualCurves, ResidualResult, RunPlots, SCHEMA, Severity,
        Skeleton, Status, Weighting,
    },
};

/// Of a terminal that does not tell.
const WIDTH: TextWidth = TextWidth::DEFAULT;

const METHODS: [Method; 3] = [Method::IDIM_LS, Method::IDIM_IV, Method::DIDIM];
const LONG_CASE: &str = "controller_bandwidth_of_the_second_motor_0.5";
const TITLE: &str = "<b>& of a title that goes on and on until it is longer than a line of a terminal of 80 columns";

const FIGURES: &str = "# Somebody, \"A title\"
case,method,parameter,estimate,relative_standard_deviation_percent
nominal,idim-ls,zz1r,1.25,1.04
nominal,idim-ls,fc1,6.9,0.1
nominal,idim-ls,off1,0.3,
nominal,idim-ls,fv9,1.0,
nominal,idim-ls,relative_error_percent,5.75,
";

fn parameter(name: &str, estimate: f64, deviation: f64, truth: f64) -> ParameterResult {
    ParameterResult {
        name: name.to_owned(),
        estimate,
        standard_deviation: Some(deviation),
        relative_standard_deviation_percent: Some(100.0 * deviation / estimate.abs()),
        true_value: Some(truth),
        unit: "N m s/rad".to_owned(),
        expression: "zz1 + ia1 + 0.05185*m3, as it is".to_owned(),
        shown: name != "xy2",
        standard_deviation_robust: Some(1.2 * deviation),
        interval_95: Some([estimate - 2.4 * deviation, estimate + 2.4 * deviation]),
    }
}

/// `zz1r` errs by 1, `fc1` by 4, `off1` by 0 and `xy2` by 2 standard deviations.
fn parameters() -> Vec<ParameterResult> {
    vec![
        parameter("zz1r", 1.26, 0.01, 1.25),
        parameter("fc1", 7.1, 0.05, 6.9),
        parameter("off1", 0.398, 0.065, 0.398),
        parameter("xy2", -0.000_12, 0.000_01, -0.000_1),
    ]
}

fn f_test() -> FTest {
    FTest { statistic: 12.5, numerator_freedom: 32, denominator_freedom: 2148, p_value: 1e-40 }
}

fn run(case: &str, method: Method) -> RunResult {
    let iteration = |error| IterationResult {
        relative_error_percent: error,
        parameter_change: Some(1e-3),
        error_change: None,
        estimates: parameters().iter().map(|p| p.estimate).collect(),
    };
    RunResult {
        findings: Vec::new(),
        case: case.to_owned(),
        method,
        weighting: Some(if method == Method::DIDIM { Weighting::PerJoint } else { Weighting::None }),
        status: Status::Converged,
        notes: Vec::new(),
        physical: None,
        reason: None,
        iterations: 2,
        simulations: 3,
        relative_error_percent: Some(5.53),
        joint_relative_error_percent: vec![Some(4.6), Some(5.1)],
        cross_validation_relative_error_percent: None,
        cross_validation_interval_95_percent: Some([5.1, 6.9]),
        influence: Some(Influence { part: "move 10".to_owned(), parameter: "zz1r".to_owned(), change: -4.7 }),
        hidden_bias: hidden_bias(),
        residual: Some(residual()),
        validation_condition_number: None,
        condition_number: Some(975.4),
        seconds: 1.25,
        simulation_relative_error_percent: Some(BTreeMap::from([("position".to_owned(), 0.2)])),
        validation_simulation_relative_error_percent: None,
        f_test: Some(f_test()),
        convergence: vec![iteration(6.0), iteration(5.53)],
        loop_parameters: Vec::new(),
        covariance: Vec::new(),
        parameters: parameters(),
        plots: RunPlots {
            predicted: vec![vec![1.0, 2.0, 3.0], vec![0.0, 0.0, 0.0]],
            simulated_position: vec![vec![0.1, 0.2, 0.3], vec![0.0, 0.0, f64::NAN]],
            ..RunPlots::default()
        },
    }
}

/// Of the two joints the second moves a parameter further.
fn hidden_bias() -> Vec<HiddenBias> {
    let of = |error, joint, size_interval_95, deviations| HiddenBias {
        error,
        joint,
        size_interval_95,
        parameter: "zz1r".to_owned(),
        deviations,
        others: Vec::new(),
    };
    vec![
        of(HiddenError::LateTorque, None, [-0.00134, 0.00029], -1.2),
        of(HiddenError::FrictionNearRest, Some(1), [-0.5, 0.5], 0.4),
        of(HiddenError::FrictionNearRest, Some(2), [-5.5, -4.2], -9.2),
    ]
}

fn residual() -> ResidualResult {
    let test = |statistic, freedom| chi_squared_test(statistic, freedom);
    let joint = |joint| JointResidual {
        joint,
        rms: 1.5,
        autocorrelation: 0.62,
        whiteness: test(170.0, 10),
        normality: test(1.3, 2),
        explained: None,
    };
    ResidualResult { joints: vec![joint(1), joint(2)], homoscedasticity: Some(f_test()) }
}

fn reason() -> VerdictReason {
    VerdictReason {
        code: ReasonCode::CheckProblem,
        verdict: Verdict::DoNotUse,
        numbers: BTreeMap::from([("value".to_owned(), 2.4)]),
        subject: ReasonSubject {
            recording: Some("1".to_owned()),
            finding: Some(Code::Lag),
            ..ReasonSubject::default()
        },
        text: "recording 1 has a problem for joint 2, lag: the torque is 2.4 samples later; shift it.".to_owned(),
        remedy: "shift it".to_owned(),
        remedies: Vec::new(),
    }
}

/// DIDIM differs by nearly 4 standard deviations, and gear ratios at 90 % explain it; LS differs by chance.
fn diagnosis(case: &str) -> CaseDiagnosis {
    let parameters = vec![ParameterDifference { name: "fv1".to_owned(), difference: -0.8, deviations: -8.4 }];
    CaseDiagnosis {
        case: case.to_owned(),
        approximation: None,
        endogeneity: Some(EndogeneityResult {
            classical: f_test(),
            robust: chi_squared_test(3.2, 4).unwrap(),
            average_difference: 0.19,
            parameters: parameters.clone(),
            verdict: Comparison::Agree,
        }),
        instruments: None,
        biased_simulator: Some(BiasedSimulatorResult {
            statistic: 12_855.0,
            freedom: 4,
            threshold: 116.2,
            p_value: 0.005,
            draws: 199,
            seed: 1,
            average_difference: 3.76,
            residual_ratio: 1.08,
            harmless_below: 0.5,
            verdict: Comparison::Alarm,
            parameters,
            joint_percent: vec![70.0, 30.0],
            explanations: vec![BiasExplanation {
                kind: BiasKind::GearRatio,
                simulator_to_true: Some(0.8999),
                standard_deviation: Some(0.0011),
                explained_percent: 99.1,
            }],
        }),
    }
}

fn advice(case: &str) -> Advice {
    Advice {
        case: case.to_owned(),
        recommended: Some(Method::IDIM_IV),
        distrust: vec![Method::DIDIM],
        text: "Take idim-iv. Distrust didim: it differs by 3.76 standard deviations on average.".to_owned(),
    }
}

fn diverged(case: &str) -> RunResult {
    RunResult {
        status: Status::Diverged,
        reason: Some("the simulation failed at 0.25 s".to_owned()),
        relative_error_percent: None,
        joint_relative_error_percent: Vec::new(),
        condition_number: None,
        simulation_relative_error_percent: None,
        f_test: None,
        residual: None,
        influence: None,
        hidden_bias: Vec::new(),
        convergence: Vec::new(),
        parameters: Vec::new(),
        plots: RunPlots::default(),
        ..run(case, Method::DIDIM)
    }
}

fn finding() -> Finding {
    Finding {
        code: Code::Lag,
        severity: Severity::Problem,
        joint: Some(2),
        joint_name: Some("elbow".to_owned()),
        value: 2.4,
        unit: "samples".to_owned(),
        limit: Some(1.0),
        message: "the torque is 2.4 samples later".to_owned(),
        remedy: "shift it".to_owned(),
        parameters: Vec::new(),
        step: None,
    }
}

fn joint(name: &str, kind: JointKind, [position_unit, torque_unit]: [&str; 2]) -> JointResult {
    let [position_unit, torque_unit] = [position_unit, torque_unit].map(str::to_owned);
    JointResult { name: name.to_owned(), kind, position_unit, torque_unit }
}

fn results() -> Results {
    let runs = ["nominal", LONG_CASE].into_iter().flat_map(|case| METHODS.map(|method| run(case, method)));
    Results {
        schema: SCHEMA,
        thetahat: "0.1.0".to_owned(),
        robot: "A robot".to_owned(),
        title: TITLE.to_owned(),
        verdict: Some(Verdict::DoNotUse),
        verdict_reasons: vec![reason()],
        remedies: Vec::new(),
        not_examined: Vec::new(),
        robot_joints: vec![
            joint("shoulder", JointKind::Revolute, ["rad", "N m"]),
            joint("elbow", JointKind::Prismatic, ["m", "N"]),
        ],
        robot_locked: Vec::new(),
        excluded_parameters: Vec::new(),
        fixed_parameters: BTreeMap::new(),
        samples_used: 300,
        decimated_rows: 6,
        recordings: vec![RecordingResult {
            name: "1".to_owned(),
            weight: 1.0,
            samples_used: 300,
            sample_rate_hz: 1000.0,
            window_s: [0.05, 0.35],
            resampling: None,
            notes: Vec::new(),
            torque_bandwidth_hz: None,
            torque_hold_s: 0.0,
            near_rest: None,
            reference: Some(ReferenceResult {
                origin: "reconstructed".to_owned(),
                moves: Some(13),
                periodic: None,
                smoothing_cutoff_hz: None,
                rms_deviation: vec![0.000_4, 0.001_24],
            }),
        }],
        validation_recordings: Vec::new(),
        bandwidth: Bandwidth {
            position_cutoff_hz: 50.0,
            position_measured_hz: Some(44.787),
            acceleration_measured_hz: None,
            decimation_cutoff_hz: 20.0,
            decimation_measured_hz: Some(20.98),
        },
        seed: Some(1),
        findings: vec![RecordingFindings { recording: "1".to_owned(), held_back: false, findings: vec![finding()] }],
        unmasked_comparison: None,
        profiled_terms: Vec::new(),
        term_comparison: None,
        not_separated: vec![NotSeparated { parameter: "ia2".to_owned(), with: vec!["mx2".to_owned()] }],
        elimination: Some(EliminationResult {
            kept: vec!["zz1r".to_owned()],
            eliminated: vec!["fc6".to_owned(); 40],
            f_test: Some(f_test()),
        }),
        advice: ["nominal", LONG_CASE].map(advice).into(),
        diagnostics: ["nominal", LONG_CASE].map(diagnosis).into(),
        runs: runs.collect(),
        user_runs: Vec::new(),
        model: None,
        no_model: None,
        payloads: Vec::new(),
        drive_gains: Vec::new(),
        experiment_description: "title = \"<i>\"\n".to_owned(),
        robot_description: "name = \"A robot\"\n".to_owned(),
        robot_files: Vec::new(),
        plots: Plots {
            time_s: vec![0.1, 0.2, 0.3],
            measured: vec![vec![1.1, 2.1, 2.9], vec![0.0, 0.0, 0.0]],
            position: vec![vec![0.1, 0.2, 0.3], vec![0.0, 0.0, 0.0]],
            ..Plots::default()
        },
    }
}

/// A folder of a test's own.
fn folder(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("report").join(name);
    let _ = fs::remove_dir_all(&path);
    fs::create_dir_all(&path).unwrap();
    path
}

fn published(name: &str, content: &str) -> Result<Published, ReportError> {
    let path = folder(name).join("figures.csv");
    fs::write(&path, content).unwrap();
    Published::read(&path)
}

/// What the report wrote, by file name.
fn written(name: &str, results: &Results) -> BTreeMap<String, String> {
    let directory = folder(name).join("out");
    let published = published(&format!("{name}_published"), FIGURES).unwrap();
    let files = write_all(results, Some(&published), &directory).unwrap();
    assert_eq!(fs::read_dir(&directory).unwrap().count(), files.len(), "nothing temporary is left");
    let named = |f: &PathBuf| (f.file_name().unwrap().to_str().unwrap().to_owned(), fs::read_to_string(f).unwrap());
    files.iter().map(named).collect()
}

#[test]
fn no_line_of_the_terminal_is_too_long() {
    let mut results = results();
    results.runs.push(diverged("last"));
    let published = published("width", FIGURES).unwrap();
    for columns in [40, 57, 80, 133, 200] {
        let width = TextWidth::new(columns);
        let texts = [
            text::all(&results, Some(&published), width),
            report::brief(&results, width),
            report::card_text(&results, width),
            report::headline(&results),
        ];
        let too_long = |line: &&str| line.chars().count() > columns;
        for text in texts {
            assert_eq!(text.lines().find(too_long), None, "{columns}: {text}");
        }
    }
    assert_eq!([0, 39, 201, usize::MAX].map(|columns| TextWidth::new(columns).columns()), [40, 40, 200, 200]);
}

#[test]
fn the_terminal_shows_only_the_parameters_asked_for() {
    let text = text::parameters(&results(), "nominal", WIDTH);
    assert!(text.contains("1.260 (0.794 %)") && !text.contains("xy2"), "{text}");
}

#[test]
fn the_truth_is_counted() {
    let text = text::truth(&results(), "nominal", WIDTH);
    assert!(text.contains("within 3 standard deviations: idim-ls 2 of 3, idim-iv 2 of 3"), "{text}");
    assert!(text.contains("of all parameters: idim-ls 3 of 4"), "{text}");
}

#[test]
fn tests_are_told_where_they_reject() {
    let text = text::tests(&results(), WIDTH);
    assert!(text.contains("F(32, 2148) = 12.50, p = 1.0e-40: rejected"), "{text}");
}

#[test]
fn json_has_the_fixed_keys_and_reads_back() {
    let results = results();
    let files = written("json", &results);
    let json: serde_json::Value = serde_json::from_str(&files["results.json"]).unwrap();
    assert!(files["results.json"].starts_with("{\n  \"schema\": 2,\n  \"thetahat\""));
    for key in ["thetahat", "robot", "robot_joints", "samples_used", "decimated_rows", "advice", "diagnostics", "runs"]
    {
        assert!(json.get(key).is_some(), "{key}");
    }
    let run = &json["runs"][0];
    for key in [
        "case",
        "method",
        "status",
        "iterations",
        "simulations",
        "relative_error_percent",
        "cross_validation_relative_error_percent",
        "condition_number",
        "seconds",
        "simulation_relative_error_percent",
        "parameters",
    ] {
        assert!(run.get(key).is_some(), "{key}");
    }
    for key in [
        "name",
        "estimate",
        "standard_deviation",
        "relative_standard_deviation_percent",
        "true_value",
        "unit",
        "expression",
        "standard_deviation_robust",
        "interval_95",
    ] {
        assert!(run["parameters"][0].get(key).is_some(), "{key}");
    }
    assert_eq!((run["method"].as_str(), run["status"].as_str()), (Some("idim-ls"), Some("converged")));
    let back = Results::from_json(Path::new("results.json"), &files["results.json"]).unwrap();
    assert_eq!(serde_json::from_str::<serde_json::Value>(&back.to_json().unwrap()).unwrap(), json);
}

/// Files of before the key `schema` have neither the joints nor the weightings.
#[test]
fn results_without_a_schema_are_read_and_reported() {
    let mut json: serde_json::Value = serde_json::from_str(&results().to_json().unwrap()).unwrap();
    let object = json.as_object_mut().unwrap();
    assert!(object.remove("schema").is_some() && object.remove("robot_joints").is_some());
    for run in object["runs"].as_array_mut().unwrap() {
        assert!(run.as_object_mut().unwrap().remove("weighting").is_some());
    }
    let old = Results::from_json(Path::new("old.json"), &json.to_string()).unwrap();
    assert_eq!((old.schema, old.robot_joints.len(), old.runs[0].weighting), (0, 0, None));
    let page = &written("old", &old)["report.html"];
    assert!(page.contains("worst rms deviation 1.24 mrad, joint 2") && !page.contains("<dt>weights</dt>"));
}

#[test]
fn results_of_a_later_version_are_refused() {
    // Nothing but the schema is asked of a later file: its other keys may be of any form.
    let later = "{ \"schema\": 3, \"runs\": 7 }";
    let error = Results::from_json(Path::new("later.json"), later).unwrap_err();
    assert!(matches!(error, ResultsError::NewerSchema { found: 3, supported: SCHEMA, .. }), "{error}");
    let text = error.to_string();
    for words in ["later.json", "schema 3", "up to 2", "update thetahat"] {
        assert!(text.contains(words), "no {words:?} in: {text}");
    }
}

#[test]
fn a_text_that_is_no_results_file_is_refused() {
    for text in ["", "7", "{}", "{ \"schema\": -1 }", "{ \"schema\": 1 }"] {
        let error = Results::from_json(Path::new("text.json"), text).unwrap_err();
        assert!(matches!(error, ResultsError::Malformed { .. }), "{text}: {error}");
        assert!(error.to_string().contains("text.json: is not the results.json"), "{error}");
    }
    let error = Results::read(Path::new("no such file.json")).unwrap_err();
    assert!(matches!(error, ResultsError::Unreadable { .. }), "{error}");
}

/// The report uses the rooms `results` and `series` and no room that computes.
#[test]
fn the_report_knows_results_only() {
    let mut folders = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join("../thetahat-report/src/report")];
    let mut files = 0;
    while let Some(folder) = folders.pop() {
        for path in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "rs") {
                files += 1;
                assert_eq!(rooms_of(&fs::read_to_string(&path).unwrap()), Vec::<String>::new(), "{}", path.display());
            }
        }
    }
    assert!(files > 20, "{files}");
    assert_eq!(
        rooms_of("use crate::{\n    results::{A, b::C},\n    robot::Robot,\n};\ncrate::checks::f()"),
        ["robot", "checks"]
    );
}

/// The rooms that a source text names, but for `results`, the ground below it, and `report` itself.
fn rooms_of(source: &str) -> Vec<String> {
    let room = |path: &str| path.split(|c: char| !(c.is_alphanumeric() || c == '_')).next().unwrap_or("").to_owned();
    let mut rooms: Vec<String> = Vec::new();
    for text in source.split("crate::").skip(1) {
        match text.strip_prefix('{') {
            Some(list) => rooms.extend(top_level(list).iter().map(|path| room(path.trim()))),
            None => rooms.push(room(text)),
        }
    }
    rooms.retain(|room| {
        !["results", "series", "number", "files", "output", "visible", "report", ""].contains(&room.as_str())
    });
    rooms
}

/// The paths of a list, up to the brace that closes it; an inner list stays together as one path.
fn top_level(list: &str) -> Vec<String> {
    let (mut depth, mut paths) = (1, vec![String::new()]);
    for c in list.chars() {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            _ => {}
        }
        match (depth, c) {
            (0, _) => break,
            (1, ',') => paths.push(String::new()),
            _ => paths.last_mut().unwrap().push(c),
        }
    }
    paths
}

#[test]
fn csv_has_one_row_for_each_parameter_and_run() {
    let results = results();
    let files = written("csv", &results);
    let mut reader = csv::Reader::from_reader(files["parameters.csv"].as_bytes());
    let header: Vec<String> = reader.headers().unwrap().iter().map(str::to_owned).collect();
    let expected = "case,method,name,estimate,standard_deviation,relative_standard_deviation_percent,true_value,unit,\
                    expression,standard_deviation_robust,interval_95_low,interval_95_high";
    assert_eq!(header.join(","), expected);
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    assert_eq!(rows.len(), 2 * 3 * 4);
    assert_eq!((&rows[0][2], &rows[0][3], &rows[0][8]), ("zz1r", "1.26", "zz1 + ia1 + 0.05185*m3, as it is"));
    let end: Vec<f64> = (9..12).map(|c| rows[0][c].parse().unwrap()).collect();
    assert_eq!(end, [1.2 * 0.01, 1.26 - 2.4 * 0.01, 1.26 + 2.4 * 0.01]);
}

#[test]
fn the_page_is_whole_escaped_and_needs_nothing_else() {
    let page = &written("html", &results())["report.html"];
    assert!(page.starts_with("<!DOCTYPE html>") && page.trim_end().ends_with("</html>"));
    assert!(page.contains("&lt;b&gt;&amp;") && !page.contains("<b>") && !page.contains("<i>"));
    for reference in ["http://", "https://", "<link", "src=", "@import", "url("] {
        assert!(!page.contains(reference), "{reference}");
    }
    let script = between(page, "<script>", "</script>");
    assert!(page.matches("<script").count() == 1 && script.len() < 20_000, "{}", script.len());
    let charts = page.matches("<svg class=\"chart\"").count();
    assert_eq!(
        charts,
        2 + 2 * (2 + 5),
        "torques with residuals of two joints once, since the other case repeats them; tracking of two joints and five of \
         convergence for each case"
    );
    let drawn = page.replace(script, "").replace(between(page, "<style>", "</style>"), "").replace("influence", "");
    assert!(!drawn.contains("NaN") && !drawn.contains("inf"), "a value that is none is not drawn");
}

/// The text between two marks, the first time they occur.
fn between<'a>(text: &'a str, start: &str, end: &str) -> &'a str {
    let rest = &text[text.find(start).unwrap_or_else(|| panic!("no {start}")) + start.len()..];
    &rest[..rest.find(end).unwrap_or_else(|| panic!("no {end}"))]
}

/// The order in which it is read: verdict, torques, estimates; then everything else on demand.
#[test]
fn the_page_opens_with_the_verdict_then_the_torques_then_the_estimates() {
    let page = &written("order", &results())["report.html"];
    let places =
        ["class=\"verdict\"", "<section id=\"torques\"", "<section id=\"estimates\"", "<details class=\"section\""];
    let places = places.map(|mark| page.find(mark).unwrap_or_else(|| panic!("no {mark}")));
    assert!(places.is_sorted(), "{places:?}");
    let opened = page[places[0]..].matches("<section id=").count();
    assert_eq!(opened, 2, "nothing but torques and estimates is open");
    assert!(between(page, "<style>", "</style>").contains("details:not([open])"), "print opens folds");
}

/// A broken run says so in red before anything else, and nothing in it looks like advice or success.
#[test]
fn a_broken_run_cannot_be_taken_for_good() {
    let page = &written("broken", &results())["report.html"];
    assert!(page.contains("<body class=\"is-do-not-use"));
    let card = between(page, "<section class=\"card\"", "</section>");
    let verdict = card.find("Do not use").expect("the word");
    let reason = card.find("Recording 1 has a problem for joint 2, lag").expect("the first reason");
    assert!(verdict < reason, "{card}");
    assert!(card.contains("none; the numbers below are those of idim-iv"), "{card}");
    for praise in
        ["Take idim", "use the recommended numbers", "Recommended method", "Use with care", "recommended</span>"]
    {
        assert!(!page.contains(praise), "{praise}");
    }
    assert!(between(page, "<style>", "</style>").contains(".is-do-not-use { --good: var(--ink)"), "no green");
}

#[test]
fn a_good_run_names_the_method_and_what_its_parameters_are_worth() {
    let good = Results { verdict: Some(Verdict::Good), verdict_reasons: Vec::new(), ..results() };
    let page = &written("good", &good)["report.html"];
    assert!(
        page.contains("<body class=\"is-good recommends-idim-iv\">") && page.contains("<dd>idim-iv (nominal)</dd>")
    );
    let card = between(page, "<section class=\"card\"", "</section>");
    // Half of the interval of off1, 0.398, is 0.156; of xy2 it is a fifth of the estimate at most.
    assert!(card.contains("3 precise") && card.contains("1 rough") && card.contains("0 not identified"), "{card}");
    assert!(page.contains("Take idim-iv. Distrust didim"), "the advice stands in the diagnosis");
}

/// The curves of two recordings, of which the second begins in the third of four rows, and of one that was held back.
fn with_records() -> Results {
    let mut results = results();
    let rows = || vec![vec![1.0, 2.0, 3.0, 4.0], vec![0.5, 0.0, 0.5, 1.0]];
    let start = |name: &str, row| RecordStart { name: name.to_owned(), row };
    results.plots = Plots {
        time_s: vec![0.0, 1.0, 5.0, 10.0],
        measured: rows(),
        position: rows(),
        recordings: vec![start("first", 0), start("second", 2)],
        held_back: HeldBackPlots { time_s: vec![0.0, 2.0], measured: rows(), recordings: vec![start("third", 0)] },
        skeleton: Some(Skeleton {
            frames: [[0.0, 0.0, 0.4], [0.3, 0.0, 0.4]]
                .into_iter()
                .zip([None, Some(0)])
                .map(|(origin, parent)| Frame { parent, origin, axis: [0.0, 1.0, 0.0] })
                .collect(),
            tool_path: vec![[0.3, 0.0, 0.4], [0.2, 0.0, 0.5]],
            gravity: [0.0, 0.0, -9.81],
        }),
    };
    let bins = vec![Bin { at: -1.0, mean: -0.5, spread: [-0.6, -0.4] }, Bin { at: 1.0, mean: 0.5, spread: [0.4, 0.6] }];
    for run in results.runs.iter_mut().filter(|r| !r.parameters.is_empty()) {
        let curves = ResidualCurves {
            autocorrelation: vec![0.8, 0.4, 0.1],
            band: 0.3,
            spectrum: vec![[1.0, 1e-3], [10.0, 1e-5]],
            over_velocity: bins.clone(),
            over_position: bins.clone(),
            over_torque: bins.clone(),
        };
        run.plots = RunPlots {
            predicted: rows(),
            held_back: rows(),
            residual: vec![curves.clone(), curves],
            correlation: (0..4).map(|i| (0..4).map(|j| if i == j { 1.0 } else { -0.95 }).collect()).collect(),
            numbers: vec![1, 1, 2, 2],
            a_priori: vec![Some(1.0), None, None, None],
            ..RunPlots::default()
        };
    }
    results
}

#[test]
fn the_figures_show_borders_held_back_records_misfits_and_confounded_pairs() {
    let page = &written("figures", &with_records())["report.html"];
    // The panels are 324 pixels wide: 5 s of 10 s lies at 1620 tenths.
    assert!(page.contains("class=\"border\" d=\"M1620 0v"), "the border of the second recording");
    assert!(page.contains(">second</text>") && page.contains("held back, not used for the estimate"));
    assert!(page.contains("Adjacent rows of the residual are correlated at 2 of 2 joints (up to 0.80)"));
    assert!(page.contains("The residual depends most on velocity at Joint"), "a step in the velocity is friction");
    assert!(page.contains("zz1r and fc1 are confounded (correlation -0.95): only their weighted sum is known well"));
    assert!(page.contains("One more pair is correlated by 0.9 or more."));
    assert!(page.contains("class=\"a-priori\"") && page.contains("class=\"truth\"") && page.contains("class=\"link\""));
    assert!(page.contains(">Joint 2</th>"), "estimates are grouped by joint");
    let wide = page.contains("The cut-off of the position filter, 50.0 Hz, is beyond the chart.");
    assert!(wide, "a cut-off beyond the chart is mentioned");
}

/// Screen readers list regions and pictures by their labels.
#[test]
fn labels_are_unique_and_headers_have_a_scope() {
    let page = &written("labels", &with_records())["report.html"];
    let mut labels: Vec<&str> =
        page.split(" aria-label=\"").skip(1).map(|rest| &rest[..rest.find('"').unwrap()]).collect();
    let count = labels.len();
    labels.sort_unstable();
    let twice: Vec<_> = labels.windows(2).filter(|w| w[0] == w[1]).map(|w| w[0]).collect();
    assert!(count > 30 && twice.is_empty(), "{twice:?}");
    let headers = page.matches("<th ").count();
    assert_eq!(page.matches("<th>").count() + headers, page.matches("<th ").count());
    let scoped = page.split("<th ").skip(1).filter(|rest| rest[..rest.find('>').unwrap()].contains("scope=")).count();
    assert_eq!(scoped, headers);
    let boxes = page.matches("class=\"scroll").count();
    assert_eq!(
        page.matches("tabindex=\"0\" role=\"region\" aria-label=").count() - page.matches("<pre ").count(),
        boxes
    );
}

#[test]
fn the_page_says_what_was_done() {
    let page = &written("method", &results())["report.html"];
    assert!(page.contains("idim-ls none, idim-iv none, didim per-joint"));
    assert!(page.contains("reconstructed, 13 moves; worst rms deviation 1.24 mm, joint 2"));
    assert!(page.contains("Joint 1 (shoulder): rms ") && page.contains("Joint 2 (elbow), mm"));
}

#[test]
fn advice_stands_in_the_head_and_the_tests_behind_it_follow() {
    let results = results();
    let head = text::head(&results, WIDTH);
    assert!(head.contains("advice           nominal: Take idim-iv. Distrust didim"), "{head}");
    let diagnosis = text::diagnosis(&results, WIDTH);
    assert!(diagnosis.contains("* alarm") && diagnosis.contains("fv1 -8.4"), "{diagnosis}");
    assert!(diagnosis.contains("gear ratios") && diagnosis.contains("0.8999"), "{diagnosis}");
    assert!(diagnosis.contains("move 10") && diagnosis.contains("zz1r"), "{diagnosis}");
    let page = &written("advice", &results)["report.html"];
    assert!(page.contains("Residuals of each joint") && page.contains("idim-iv with 95 % intervals"));
}

#[test]
fn a_diverged_run_has_a_status_and_no_numbers() {
    let mut results = results();
    results.runs[2] = diverged("nominal");
    let table = text::parameters(&results, "nominal", WIDTH);
    let row = table.lines().find(|l| l.starts_with("fc1")).unwrap();
    assert!(row.ends_with("diverged"), "{table}");
    assert!(table.contains("didim diverged: the simulation failed at 0.25 s"), "{table}");
    let summary = text::summary(&results, WIDTH);
    let row = summary.lines().find(|l| l.contains("diverged")).unwrap();
    let cells: Vec<&str> = row.split_whitespace().collect();
    assert_eq!(cells[5..8], ["-", "-", "-"], "{summary}");
    assert!(written("diverged", &results)["report.html"].contains("the simulation failed at 0.25 s"));
}

#[test]
fn results_without_runs_are_a_report_too() {
    let mut results = results();
    results.runs.clear();
    assert!(text::all(&results, None, WIDTH).starts_with("<b>&"));
    assert!(written("no_runs", &results)["report.html"].contains("</html>"));
}

#[test]
fn a_folder_that_cannot_be_made_is_an_error() {
    let file = folder("no_folder").join("file");
    fs::write(&file, "").unwrap();
    let error = write_all(&results(), None, &file.join("out")).unwrap_err();
    assert!(matches!(error, ReportError::Directory { path, .. } if path == file.join("out")));
}

#[test]
fn a_file_that_cannot_be_replaced_leaves_nothing_in_part() {
    let directory = folder("blocked");
    fs::create_dir(directory.join("report.html")).unwrap();
    let error = write_all(&results(), None, &directory).unwrap_err();
    assert!(matches!(error, ReportError::Write { path, .. } if path == directory.join("report.html")));
    assert_eq!(fs::read_dir(&directory).unwrap().count(), 1);
}

/// `zz1r` 1.26 lies within 3 * 1.04 % of 1.25. `fc1` 7.1 lies 0.2 from 6.9, outside 3 * 0.1 % and outside the 0.1 of its
/// last digit. `off1` 0.398 lies within the 0.1 of 0.3. `fv9` is not ours, and `xy2` is not printed.
#[test]
fn agreement_is_counted() {
    let results = results();
    let published = published("agreement", FIGURES).unwrap();
    assert_eq!(published.source, "Somebody, \"A title\"");
    assert_eq!(published.agreement(&results.runs[0]), Agreement { within: 2, compared: 3 });
    assert_eq!(published.agreement(&results.runs[1]), Agreement { within: 0, compared: 0 });
    let text = text::published(&results, &published, "nominal", WIDTH);
    assert!(text.contains("idim-ls 2 of 3") && text.contains("* +29.0"), "{text}");
    assert!(text::published_runs(&results, &published, WIDTH).contains("5.75  5.530"));
}

/// The delay, and of the joints that whose friction moves a parameter furthest.
#[test]
fn bias_that_no_interval_holds_is_a_table_with_the_error_and_its_size() {
    let text = text::diagnosis(&results(), WIDTH);
    let table = between(&text, "Possible bias outside the intervals", "rest friction: friction at");
    assert!(table.contains("torque delay"), "{table}");
    let row = table.lines().find(|line| line.contains("torque delay")).unwrap();
    let cells: Vec<&str> = row.split_whitespace().rev().take(5).collect();
    assert_eq!(cells, ["-1.2", "zz1r", "0.29", "-1.3", "ms"]);
    assert!(table.contains("rest friction, joint 2"), "{table}");
    assert!(!table.contains("rest friction, joint 1"), "{table}");
}

#[test]
fn the_last_digit_is_that_of_the_text() {
    let decimals = |text: &str| {
        let content = FIGURES.replace("6.9,", &format!("{text},"));
        published("digits", &content).unwrap().value("nominal", Method::IDIM_LS, "fc1").unwrap().decimals()
    };
    assert_eq!(["7", "6.90", "6.90e-3", "1.2E2"].map(decimals), [0, 2, 5, -1]);
}

#[test]
fn defects_of_published_figures_name_file_and_line() {
    let defects = [
        ("case,method,parameter,estimate,", "case,method,parameter,value,", 2),
        ("6.9,", "6.9 N m,", 4),
        ("nominal,idim-ls,off1", "nominal,ls,off1", 5),
        ("0.3,\n", "0.3\n", 5),
        ("idim-ls,fc1", "idim-ls,zz1r", 4),
        ("1.04", "NaN", 3),
    ];
    for (k, (right, wrong, expected)) in defects.into_iter().enumerate() {
        let error = published(&format!("defect_{k}"), &FIGURES.replace(right, wrong)).unwrap_err();
        let ReportError::PublishedLine { path, line, .. } = &error else { panic!("{error}") };
        assert!(*line == expected && path.ends_with("figures.csv"), "{error}");
        assert!(error.to_string().contains(&format!("figures.csv: line {expected}: expected")));
    }
}

#[test]
fn published_figures_that_are_not_there_are_an_error() {
    let error = Published::read(Path::new("no such file.csv")).unwrap_err();
    assert!(matches!(error, ReportError::PublishedUnreadable { .. }));
}

#[test]
fn the_published_tables_of_the_project_can_be_read() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../experiments/published");
    let paper = Published::read(&folder.join("tx40.csv")).unwrap();
    assert_eq!(paper.values.len(), 6 * 29);
    assert_eq!(paper.value("gear_ratio_0.9", Method::DIDIM, "zz1r").unwrap().text, "1.08");
    let emps = Published::read(&folder.join("emps.csv")).unwrap();
    assert_eq!(emps.value("nominal", Method::IDIM_LS, "m1r").unwrap().decimals(), 4);
}

#[test]
fn findings_are_said_with_their_joint_and_remedy() {
    let text = report::findings_text(&results().findings, WIDTH);
    for words in ["Checks: 1 problem", "PROBLEM [lag] joint 2 (elbow): the torque is 2.4 samples later", "-> shift it"]
    {
        assert!(text.contains(words), "no {words:?} in: {text}");
    }
    // Only a reduction gives a list without recordings: no checks are made on it.
    assert_eq!(report::findings_text(&[], WIDTH), "Checks: none made\n");
}

/// The verdict is the first thing that is said, and its reasons follow before the advice.
#[test]
fn the_verdict_comes_first() {
    let head = text::head(&results(), WIDTH);
    let [verdict, because, advice] =
        ["verdict", "because", "advice"].map(|label| head.find(&format!("\n{label} ")).unwrap());
    assert!(verdict < because && because < advice, "{head}");
    assert!(head.contains("DO NOT USE the numbers, for one reason"), "{head}");
    assert!(head.contains("PROBLEM [check-problem] recording 1 has a problem"), "{head}");
    let without = Results { verdict: None, verdict_reasons: Vec::new(), ..results() };
    assert!(!text::head(&without, WIDTH).contains("\nverdict "));
}
