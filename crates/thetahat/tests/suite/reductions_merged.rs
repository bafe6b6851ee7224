//! Reductions as values: merged in any order, refused where they do not belong together, read from files that may be
//! damaged. On a joint whose torque is known in closed form: tau = ia ddq + fv dq + fc sign(dq) + off.

use std::{fmt::Write as _, path::Path};

use thetahat::{
    Experiment, Results,
    experiment::ExperimentError,
    preparation::PreparationError,
    reduction::{ReduceOptions, Reduction, ReductionError},
    results::{ParameterResult, ReasonCode, Verdict},
    signal::SignalError,
};
use thetahat_estimation::checks::Finding;
use thetahat_testing::Folder;

const ROBOT: &str = "name = 'joint'\n[[joint]]\nname = 'a'\nkind = 'revolute'\n";
const SIGNAL: &str = "[signal]\ncutoff_hz = 60\ndecimation = 10\nmask = 'none'\n";
const METHODS: &str = "[estimation]\nmethods = ['idim-ls']\n";
const RATE: f64 = 1000.0;
/// Between ways to one estimate, in the larger of the estimate and its standard deviation.
const EQUAL: f64 = 1e-9;
const EQUAL_ORDERS: f64 = 1e-10;
/// Between ways to one model: its solver stops at 1e-10 of the objective, which is flat there.
const EQUAL_MODEL: f64 = 1e-6;

/// A folder of recordings.
struct Recordings(Folder);

impl Recordings {
    fn new() -> Self {
        Self(Folder::new())
    }

    /// Writes a motion of two sines with noise in the torque.
    fn write(&self, name: &str, samples: usize, slow_hz: f64) {
        let mut text = "t,q,tau\n".to_owned();
        for k in 0..samples {
            let [q, tau] = motion(k, slow_hz);
            writeln!(text, "{:.6},{q},{tau}", k as f64 / RATE).unwrap();
        }
        self.0.write(name, text);
    }

    fn experiment(&self, recordings: &str, signal: &str) -> Experiment {
        let text = format!("title = 't'\nrobot = 'joint.toml'\n{recordings}{signal}{METHODS}");
        Experiment::from_texts(Path::new("merged.toml"), text, ROBOT.to_owned()).unwrap()
    }

    /// Reduces recordings to their rows.
    fn reduce(&self, recordings: &str, signal: &str) -> Result<Reduction, ReductionError> {
        self.reduce_to(recordings, signal, true)
    }

    fn reduce_to(&self, recordings: &str, signal: &str, rows_only: bool) -> Result<Reduction, ReductionError> {
        let options = ReduceOptions { threads: 2, piece_samples: 1500, rows_only };
        self.experiment(recordings, signal).reduce(self.0.path(), options, &mut |_| {})
    }
}

fn motion(k: usize, slow_hz: f64) -> [f64; 2] {
    let t = k as f64 / RATE;
    let (w, v) = (2.0 * std::f64::consts::PI * slow_hz, 2.0 * std::f64::consts::PI * 1.7);
    let q = (w * t).sin() + 0.3 * (v * t).cos();
    let dq = w * (w * t).cos() - 0.3 * v * (v * t).sin();
    let ddq = -w * w * (w * t).sin() - 0.3 * v * v * (v * t).cos();
    let noise = 0.3 * (12.9898 * k as f64 * slow_hz).sin() * (0.37 * k as f64).cos();
    [q, 0.7 * ddq + 3.0 * dq + 1.5 * dq.signum() + 0.2 + noise]
}

fn recording(file: &str, more: &str) -> String {
    format!(
        "[[recording]]\n{more}\ntime = {{ file = '{file}', columns = ['t'], unit = 's' }}\nposition = {{ file = \
         '{file}', columns = ['q'], unit = 'rad' }}\ntorque = {{ file = '{file}', columns = ['tau'], unit = 'N m' }}\n"
    )
}

fn three() -> (Recordings, [String; 3]) {
    let folder = Recordings::new();
    folder.write("a.csv", 8000, 0.5);
    folder.write("b.csv", 6000, 0.7);
    folder.write("c.csv", 9000, 0.3);
    (folder, ["a.csv", "b.csv", "c.csv"].map(|file| recording(file, "")))
}

fn parameters(results: &Results) -> &[ParameterResult] {
    &results.runs[0].parameters
}

fn assert_same(found: &Results, expected: &Results, tolerance: f64) {
    assert_eq!(parameters(found).len(), parameters(expected).len());
    for (f, e) in parameters(found).iter().zip(parameters(expected)) {
        let deviation = e.standard_deviation.unwrap();
        assert!((f.estimate - e.estimate).abs() <= tolerance * e.estimate.abs().max(deviation), "{}", e.name);
        assert!((f.standard_deviation.unwrap() / deviation - 1.0).abs() <= tolerance, "sd of {}", e.name);
    }
    let [f, e] = [found, expected].map(|r| r.runs[0].relative_error_percent.unwrap());
    assert!((f / e - 1.0).abs() <= tolerance, "{f} {e}");
}

#[test]
fn merged_in_any_order_they_are_the_identification_of_all() {
    let (folder, recordings) = three();
    let weighted = recording("c.csv", "weight = 0.5");
    let all = [recordings[0].clone(), recordings[1].clone(), weighted];
    let expected = folder.experiment(&all.concat(), SIGNAL).run(folder.0.path(), &mut |_| {}).unwrap();
    let together = folder.reduce(&all.concat(), SIGNAL).unwrap().solve().unwrap();
    assert_same(&together.results, &expected, EQUAL);
    let own: Vec<Reduction> = all.iter().map(|r| folder.reduce(r, SIGNAL).unwrap()).collect();
    for order in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
        let merged = Reduction::merge_all(order.map(|i| own[i].clone())).unwrap();
        let nested = own[order[0]].clone().merge(own[order[1]].clone().merge(own[order[2]].clone()).unwrap()).unwrap();
        for reduction in [merged, nested] {
            let solution = reduction.solve().unwrap();
            assert_same(&solution.results, &together.results, EQUAL_ORDERS);
            assert_eq!(solution.intervals, together.intervals);
            for (m, t) in parameters(&solution.results).iter().zip(parameters(&together.results)) {
                let [m, t] = [m, t].map(|p| p.standard_deviation_robust.unwrap());
                assert!((m / t - 1.0).abs() < 1e-8);
            }
        }
    }
}

/// Recordings reduced by themselves merge to what the reduction of all solves to, and stretches of their time to nearly that.
#[test]
fn parts_of_an_experiment_merge_to_the_whole() {
    let (folder, recordings) = three();
    let experiment = folder.experiment(&recordings.concat(), SIGNAL);
    let reduce = |e: &Experiment| e.reduce(folder.0.path(), ReduceOptions::default(), &mut |_| {}).unwrap();
    let whole = reduce(&experiment);
    let parts = (0..3).map(|number| reduce(&experiment.part(number, None).unwrap()));
    let merged = Reduction::merge_all(parts).unwrap();
    let sorted = Reduction::merge_all([whole.clone()]).unwrap();
    let names = |r: &Reduction| r.recordings.iter().map(|r| r.name.clone()).collect::<std::collections::BTreeSet<_>>();
    assert_eq!(names(&merged), names(&sorted));
    assert_same(&merged.solve().unwrap().results, &whole.solve().unwrap().results, EQUAL_ORDERS);

    // 5 periods of the cut-off are the filter's edge: 84 samples.
    let spans = experiment.recording_spans_s(folder.0.path()).unwrap();
    assert_eq!(spans, [[0.084, 7.916], [0.084, 5.916], [0.084, 8.916]]);
    let halves = [[0.084, 4.0], [4.0, 7.916]].map(|window| reduce(&experiment.part(0, Some(window)).unwrap()));
    let halves = Reduction::merge_all(halves).unwrap();
    assert_eq!(halves.recordings.iter().map(|r| r.samples).sum::<usize>(), 7832);
    let expected = reduce(&experiment.part(0, Some([0.084, 7.916])).unwrap());
    for (f, e) in
        parameters(&halves.solve().unwrap().results).iter().zip(parameters(&expected.solve().unwrap().results))
    {
        assert!((f.estimate - e.estimate).abs() < 0.5 * e.standard_deviation.unwrap(), "{}", e.name);
    }
    assert!(
        experiment.part(3, None).unwrap_err().to_string().contains("number of recordings is 3, expected at least 4")
    );
}

#[test]
fn a_recording_counts_once_whatever_its_file_is_called() {
    let (folder, recordings) = three();
    folder.0.write("copy.csv", folder.0.bytes("a.csv"));
    let copy = recording("copy.csv", "name = 'copy'");
    let error = folder.reduce(&(recordings[0].clone() + &copy), SIGNAL).unwrap_err();
    assert!(matches!(error, ReductionError::SameRecording { .. }), "{error}");
    let [first, copy] = [&recordings[0], &copy].map(|r| folder.reduce(r, SIGNAL).unwrap());
    assert!(matches!(first.merge(copy), Err(ReductionError::SameRecording { .. })));
}

#[test]
fn unlike_reductions_are_refused_with_what_differs() {
    let (folder, recordings) = three();
    let first = folder.reduce(&recordings[0], SIGNAL).unwrap();
    for (signal, expected) in [
        (SIGNAL.replace("60", "61"), "cut-off"),
        (SIGNAL.replace("10", "20"), "decimation"),
        (SIGNAL.replace("cutoff", "filter_order = 5\ncutoff"), "order"),
        (format!("[parameters]\nexclude = ['off1']\n{SIGNAL}"), "base parameters"),
        (SIGNAL.replace("mask = 'none'", "derivative = 'central'\nmask = 'none'"), "derivative"),
        (SIGNAL.replace("'none'", "'near-rest'"), "mask"),
        (SIGNAL.replace("'none'", "{ velocity = 0.1, widened_s = 0 }"), "mask"),
    ] {
        let other = folder.reduce(&recordings[1], &signal).unwrap();
        match first.clone().merge(other) {
            Err(ReductionError::Unlike { what, .. }) => assert!(what.contains(expected), "{what}"),
            other => panic!("{expected}: {other:?}"),
        }
    }
    // Below four of its scales the simulator's sign is not known, which is what the mask near rest begins with.
    let near_rest = SIGNAL.replace("'none'", "'near-rest'");
    let finer = format!("{near_rest}[simulation]\nsign_velocity_scale = 0.001\n");
    let [first, other] = [&near_rest, &finer].map(|signal| signal.as_str());
    let [first, other] = [(0, first), (1, other)].map(|(i, signal)| folder.reduce(&recordings[i], signal).unwrap());
    assert!(matches!(first.merge(other), Err(ReductionError::Unlike { what: "the mask near rest", .. })));
    assert!(matches!(Reduction::merge_all([]), Err(ReductionError::Nothing)));
}

/// Short recordings are kept whole: merged, they have the model, the verdict and the estimates of an identification.
#[test]
fn recordings_whose_samples_are_kept_are_identified() {
    let (folder, recordings) = three();
    let identified = folder.experiment(&recordings.concat(), SIGNAL).run(folder.0.path(), &mut |_| {}).unwrap();
    let own = recordings.each_ref().map(|r| folder.reduce_to(r, SIGNAL, false).unwrap());
    let solved = Reduction::merge_all(own.clone()).unwrap().solve().unwrap().results;
    assert_same(&solved, &identified, EQUAL);
    let reasons = |r: &Results| r.verdict_reasons.iter().map(|r| (r.code, r.verdict)).collect::<Vec<_>>();
    assert_eq!((solved.verdict, reasons(&solved)), (identified.verdict, reasons(&identified)));
    let model = |r: &Results| r.model.as_ref().unwrap().parameters.iter().map(|p| p.value).collect::<Vec<_>>();
    for (found, expected) in model(&solved).iter().zip(model(&identified)) {
        assert!((found - expected).abs() < EQUAL * expected.abs().max(1.0), "{found} {expected}");
    }
    assert!(solved.not_examined.is_empty());
    let [first, ..] = own;
    let with_rows = first.merge(folder.reduce(&recordings[1], SIGNAL).unwrap()).unwrap();
    assert!(with_rows.recordings.iter().all(|r| r.samples_kept.is_none()));
    let results = with_rows.solve().unwrap().results;
    assert!(results.model.is_some() && results.not_examined.iter().any(|n| n.code == ReasonCode::Cause));
}

/// Of four recordings one is left out whole: reduced one by one, and merged in any order, they have the model of their identification.
#[test]
#[ignore = "long, each night"]
fn the_model_of_four_recordings_does_not_depend_on_how_they_are_reduced() {
    let (folder, recordings) = three();
    folder.write("d.csv", 7000, 0.4);
    let all: Vec<String> = recordings.into_iter().chain([recording("d.csv", "")]).collect();
    let identified = folder.experiment(&all.concat(), SIGNAL).run(folder.0.path(), &mut |_| {}).unwrap();
    let own: Vec<Reduction> = all.iter().map(|r| folder.reduce(r, SIGNAL).unwrap()).collect();
    let together = folder.reduce(&all.concat(), SIGNAL).unwrap();
    let merged = Reduction::merge_all(own.clone()).unwrap();
    let other = Reduction::merge_all(own.into_iter().rev()).unwrap();
    let expected = identified.model.unwrap();
    for reduction in [together, merged, other] {
        let found = reduction.solve().unwrap().results.model.unwrap();
        assert_eq!(found.friction_transition, expected.friction_transition);
        assert_eq!(found.belief_weight, expected.belief_weight);
        for (f, e) in found.parameters.iter().zip(&expected.parameters) {
            assert!((f.value - e.value).abs() < EQUAL_MODEL * e.value.abs(), "{}: {} {}", e.name, f.value, e.value);
        }
        let [f, e] = [&found, &expected].map(|model| model.unseen.as_ref().unwrap().percent);
        assert!((f / e - 1.0).abs() < EQUAL_MODEL, "{f} {e}");
    }
}

#[test]
fn a_file_is_read_as_it_was_written_or_refused() {
    for (rows_only, step) in [(true, 53), (false, 997)] {
        file_is_read_or_refused(rows_only, step);
    }
}

fn file_is_read_or_refused(rows_only: bool, step: usize) {
    let (folder, recordings) = three();
    let reduction = folder.reduce_to(&recordings[0], SIGNAL, rows_only).unwrap();
    let path = folder.0.at("a.reduction");
    reduction.write(&path).unwrap();
    assert_eq!(Reduction::read(&path).unwrap(), reduction);
    let bytes = std::fs::read(&path).unwrap();
    let refused = |bytes: &[u8]| {
        std::fs::write(&path, bytes).unwrap();
        Reduction::read(&path).unwrap_err()
    };
    for length in (0..bytes.len()).step_by(2 * step) {
        assert!(matches!(refused(&bytes[..length]), ReductionError::Damaged { .. }), "{length}");
    }
    for place in (0..bytes.len()).step_by(step) {
        let mut damaged = bytes.clone();
        damaged[place] ^= 0x10;
        let error = refused(&damaged);
        assert!(matches!(error, ReductionError::Damaged { .. } | ReductionError::Version { .. }), "{place}: {error}");
    }
    let next = [b"thetahat reduction 6\n", &bytes[21..]].concat();
    assert!(matches!(refused(&next), ReductionError::Version { form: 5, .. }));
    assert!(matches!(refused(b"a,b\n1,2\n"), ReductionError::Damaged { .. }));
    assert!(matches!(Reduction::read(&folder.0.at("none")), Err(ReductionError::Unreadable { .. })));
    assert!(matches!(reduction.write(folder.0.path()), Err(ReductionError::Unwritable { .. })));
}

/// A file that was written before findings were kept is refused with that reason.
#[test]
fn a_file_of_form_1_is_refused() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/suite/forms/form_1.reduction");
    let error = Reduction::read(&path).unwrap_err();
    assert!(matches!(&error, ReductionError::Version { found, form: 5, .. } if found == "1"), "{error}");
    let words = ["a reduction of form 1", "reads form 5 alone", "reduce the recordings again"];
    words.iter().for_each(|word| assert!(error.to_string().contains(word), "no {word:?} in: {error}"));
}

/// Windows that overlap are refused in one reduction and in two, whatever the files are called, and with one number changed.
#[test]
fn samples_that_two_recordings_share_are_refused() {
    let (folder, _) = three();
    let window =
        |file: &str, from: f64, to: f64| recording(file, &format!("window_start_s = {from}\nwindow_end_s = {to}"));
    let error = folder.reduce(&(window("a.csv", 1.0, 5.0) + &window("a.csv", 3.5, 7.0)), SIGNAL).unwrap_err();
    let ReductionError::Overlap { first, other } = &error else { panic!("{error}") };
    assert_eq!((first.file.as_str(), first.span_s, other.span_s), ("a.csv", [3.5, 5.0], [3.5, 5.0]));
    assert!(
        error.to_string().contains("recordings 1 (a.csv) and 2 (a.csv) share samples: 3.5000 to 5.0000 s"),
        "{error}"
    );
    folder.reduce(&(window("a.csv", 1.0, 3.5) + &window("a.csv", 3.5, 7.0)), SIGNAL).unwrap();

    // The same record from its second second on, with a number changed.
    let text = folder.0.text("a.csv");
    let lines: Vec<&str> = text.lines().collect();
    let changed = format!("{}1", lines[1500]);
    let later = [&lines[..1], &lines[1001..1500], &[&changed], &lines[1501..]].concat();
    folder.0.write("later.csv", later.join("\n") + "\n");
    let [whole, later] = ["a.csv", "later.csv"].map(|file| folder.reduce(&recording(file, ""), SIGNAL).unwrap());
    let Err(ReductionError::Overlap { first, other }) = whole.merge(later) else { panic!("they are merged") };
    let shift = first.span_s[0] - other.span_s[0];
    assert!((shift - 1.0).abs() < 1e-6 && first.span_s[1] - first.span_s[0] > 5.0, "{first:?} {other:?}");
}

/// Fixed parameters are taken off the torques in pieces as in the whole record, and reductions with others are not merged.
#[test]
fn parameters_at_a_value_are_those_of_the_identification() {
    let (folder, recordings) = three();
    let fixed = format!("[parameters]\nfix = {{ fv1 = 2.9 }}\n{SIGNAL}");
    let expected = folder.experiment(&recordings.concat(), &fixed).run(folder.0.path(), &mut |_| {}).unwrap();
    let own = recordings.each_ref().map(|r| folder.reduce(r, &fixed).unwrap());
    let solved = Reduction::merge_all(own.clone()).unwrap().solve().unwrap().results;
    assert_same(&solved, &expected, EQUAL);
    assert_eq!((solved.fixed_parameters["fv1"], parameters(&solved).len()), (2.9, 3));
    let other = folder.reduce(&recordings[1], SIGNAL).unwrap();
    assert!(matches!(own[0].clone().merge(other), Err(ReductionError::Unlike { .. })));
}

/// What the checks find in samples is kept, merged and judged, and what they need all samples for is listed.
#[test]
fn findings_travel_through_the_file_to_the_verdict() {
    let (folder, recordings) = three();
    let text = folder.0.text("a.csv");
    let negate = |line: &str| {
        let values: Vec<&str> = line.split(',').collect();
        values[2].parse::<f64>().map_or(line.to_owned(), |tau| format!("{},{},{}", values[0], values[1], -tau))
    };
    folder.0.write("negated.csv", text.lines().map(|line| negate(line) + "\n").collect::<String>());
    let negated = recording("negated.csv", "");
    let identified = folder.experiment(&negated, SIGNAL).run(folder.0.path(), &mut |_| {}).unwrap();
    assert_eq!(identified.verdict, Some(Verdict::DoNotUse));
    let reduction = folder.reduce(&negated, SIGNAL).unwrap();
    reduction.write(&folder.0.at("negated.reduction")).unwrap();
    let read = Reduction::read(&folder.0.at("negated.reduction")).unwrap();
    let solved = read.solve().unwrap().results;
    // The reasons of the recordings are the same; causes of the model's error are named there alone.
    let of_checks = |r: &Results| r.verdict_reasons.iter().any(|r| r.code == ReasonCode::CheckProblem);
    assert_eq!((solved.verdict, of_checks(&solved)), (identified.verdict, of_checks(&identified)));
    // A step of a remedy changes an experiment file, which a reduction has not.
    let without_step = |finding: &Finding| Finding { step: None, ..finding.clone() };
    let findings = |r: &Results| r.findings.iter().flat_map(|r| &r.findings).map(without_step).collect::<Vec<_>>();
    let missing = |r: &Results| r.not_examined.iter().map(|n| n.code).collect::<Vec<ReasonCode>>();
    assert_eq!((findings(&solved), missing(&solved)), (findings(&identified), vec![ReasonCode::Cause]));
    let merged = reduction.merge(folder.reduce(&recordings[1], SIGNAL).unwrap()).unwrap().solve().unwrap().results;
    assert_eq!(merged.verdict, Some(Verdict::DoNotUse));
    assert_eq!(missing(&merged), [ReasonCode::RecordingsDisagree, ReasonCode::Cause]);
    let together = folder.reduce(&(negated + &recordings[1]), SIGNAL).unwrap().solve().unwrap().results;
    assert_eq!((missing(&together), together.verdict), (vec![ReasonCode::Cause], Some(Verdict::DoNotUse)));
}

/// Torques that hold are centred in pieces as in the whole record; the same samples are known again, held or not.
#[test]
#[ignore = "long, each night"]
fn torques_that_hold_are_centred_in_pieces() {
    let (folder, recordings) = three();
    let held = recordings[0].replace("unit = 'N m' }", "unit = 'N m', held = true }");
    for signal in [SIGNAL.to_owned(), SIGNAL.replace("'none'", "'near-rest'")] {
        let expected = folder.experiment(&held, &signal).run(folder.0.path(), &mut |_| {}).unwrap();
        let solution = folder.reduce(&held, &signal).unwrap().solve().unwrap();
        assert_same(&solution.results, &expected, EQUAL);
        assert_eq!(solution.results.recordings[0].torque_hold_s, expected.recordings[0].torque_hold_s);
        let instant = folder.reduce(&recordings[0], &signal).unwrap();
        let [with, without] =
            [&solution.results, &instant.solve().unwrap().results].map(|results| parameters(results)[1].estimate);
        assert!((with / without - 1.0).abs() > 1e-4, "{with} {without}");
        let held = folder.reduce(&held, &signal).unwrap();
        assert!(matches!(held.merge(instant), Err(ReductionError::SameRecording { .. })));
    }
}

/// Merged, recordings without their samples near rest are the identification of all.
#[test]
fn masked_reductions_are_merged() {
    let (folder, recordings) = three();
    let signal = SIGNAL.replace("'none'", "'near-rest'");
    let expected = folder.experiment(&recordings.concat(), &signal).run(folder.0.path(), &mut |_| {}).unwrap();
    let own = recordings.each_ref().map(|r| folder.reduce(r, &signal).unwrap());
    let merged = Reduction::merge_all(own).unwrap();
    assert_same(&merged.solve().unwrap().results, &expected, EQUAL);
    let counted: f64 =
        merged.recordings.iter().flat_map(|r| r.kept.segments().into_owned()).map(|s| s.counted[0]).sum();
    let rows: usize = merged.recordings.iter().map(|r| r.rows).sum();
    assert!(counted > 0.5 * rows as f64 && counted < 0.95 * rows as f64, "{counted} of {rows}");
}

#[test]
fn records_that_say_nothing_are_refused() {
    let (folder, _) = three();
    let write = |name: &str, line: &dyn Fn(usize) -> String| {
        let body: String = (0..8000).map(line).collect();
        folder.0.write(name, format!("t,q,tau\n{body}"));
    };
    write("still.csv", &|k| format!("{:.3},0.5,1.5\n", k as f64 / RATE));
    write("dead.csv", &|k| format!("{:.3},{},0.0\n", k as f64 / RATE, motion(k, 0.5)[0]));
    write("bad.csv", &|k| {
        format!("{:.3},{},{}\n", k as f64 / RATE, motion(k, 0.5)[0], if k == 7000 { "x" } else { "1.5" })
    });
    for window in ["", "window_start_s = 1\nwindow_end_s = 7.5\n"] {
        let of = |file: &str| folder.reduce(&recording(file, ""), &format!("{SIGNAL}{window}")).unwrap_err();
        let still = of("still.csv");
        assert!(
            matches!(
                still,
                ReductionError::Experiment(ExperimentError::Preparation {
                    source: PreparationError::Signal { source: SignalError::NoMotion { .. } },
                    ..
                })
            ),
            "{still}"
        );
        assert!(matches!(of("dead.csv"), ReductionError::NoTorque { .. }));
        let bad = of("bad.csv").to_string();
        assert!(bad.contains("7002") && bad.contains("tau"), "{bad}");
    }
}

/// A short record with uneven steps is read whole and brought to equal ones; a long one is refused.
#[test]
fn uneven_steps() {
    let (folder, _) = three();
    let jitter = |k: usize| if k % 7 == 3 { 1e-4 } else { 0.0 };
    let body: String = (0..8000)
        .map(|k| format!("{:.6},{},{}\n", k as f64 / RATE + jitter(k), motion(k, 0.5)[0], motion(k, 0.5)[1]))
        .collect();
    folder.0.write("jitter.csv", format!("t,q,tau\n{body}"));
    let recording = recording("jitter.csv", "");
    let expected = folder.experiment(&recording, SIGNAL).run(folder.0.path(), &mut |_| {}).unwrap();
    let solution = folder.reduce(&recording, SIGNAL).unwrap().solve().unwrap();
    assert_same(&solution.results, &expected, EQUAL);
    let kept = folder.reduce_to(&recording, SIGNAL, false).unwrap();
    kept.write(&folder.0.at("kept.reduction")).unwrap();
    let read = Reduction::read(&folder.0.at("kept.reduction")).unwrap();
    assert!(read.recordings[0].samples_kept.is_some());
    assert_eq!(read.recordings[0].samples_kept, kept.recordings[0].samples_kept);
    assert_same(&read.solve().unwrap().results, &expected, EQUAL);
    let samples = (1 << 20) + 10;
    for (name, value) in [
        ("t", &(|k: usize| k as f64 / RATE + jitter(k)) as &dyn Fn(usize) -> f64),
        ("q", &|k| motion(k, 0.5)[0]),
        ("tau", &|k| motion(k, 0.5)[1]),
    ] {
        let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({samples},), }}\n");
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend(u16::try_from(header.len()).unwrap().to_le_bytes());
        bytes.extend(header.bytes());
        (0..samples).for_each(|k| bytes.extend(value(k).to_le_bytes()));
        folder.0.write(format!("{name}.npy"), bytes);
    }
    let long = "[recording]\ntime = { file = 't.npy', unit = 's' }\nposition = { file = 'q.npy', unit = 'rad' }\ntorque \
                = { file = 'tau.npy', unit = 'N m' }\n";
    for window in ["", "window_start_s = 500\nwindow_end_s = 510\n"] {
        let error = folder.reduce(long, &format!("{SIGNAL}{window}")).unwrap_err();
        assert!(matches!(error, ReductionError::UnequalSteps { sample: 3, .. }), "{error}");
    }
}
