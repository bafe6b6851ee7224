//! Exported robots read back: the torques of the file are those of the robot, and what is no inertia and no friction stays.

use std::{ops::Range, path::Path, sync::OnceLock};

use thetahat::{
    Experiment, Identification, Method, Recording, Results, Robot, Settings,
    consistency::completed_a_priori,
    experiment::{EstimateRequest, ExperimentError, IdentifiedRobot},
    export::{
        Export, ExportError, ExportFormat, IdentifiedModel, MjcfError, MjcfModel, Provenance, Target, export_robot,
    },
    results::{NOMINAL, ProfiledTerm, Verdict},
    robot::{Locks, RobotError, RobotSource},
    run::with_constants,
};
use thetahat_model::robot::TermDescription;
use thetahat_report::results::{NoEstimate, Status};
use thetahat_testing::{Folder, data, project, shared, users_mjcf};

/// The robots of the checkout: of tables, with prismatic joints, trees, followers, motors that are coupled.
const ROBOTS: [&str; 9] = [
    "two_joint.toml",
    "tx40.toml",
    "ur10.toml",
    "scara.toml",
    "emps.toml",
    "branching.urdf",
    "seven_axes.urdf",
    "mobile_manipulator.urdf",
    "quadruped.urdf",
];

/// The URDF of a robot with other parameters than its file has.
fn urdf_of(source: &RobotSource, robot: &Robot) -> Export {
    let parameters: Vec<f64> = completed_a_priori(robot, None).iter().map(|v| 1.25 * v).collect();
    export_robot(robot, source.urdf_text(), &parameters, ExportFormat::Urdf, &["a test".to_owned()]).unwrap()
}

fn require_round_trip(source: &RobotSource, robot: &Robot) {
    let worst = urdf_of(source, robot).check().unwrap_or_else(|e| panic!("{}: {e}", robot.name));
    println!("{}: {worst:.1e}", robot.name);
}

#[test]
fn urdf_of_the_robots_of_the_checkout_comes_back() {
    for name in ROBOTS {
        let source = RobotSource::read(&project("robots").join(name)).unwrap();
        require_round_trip(&source, &source.robot_without_transmission().unwrap());
    }
}

#[test]
fn urdf_of_recorded_robots_comes_back() {
    let files = [
        data().join("kuka_lwr4/kuka_lwr4.urdf"),
        data().join("tx40/tx40_mdh_modified.urdf"),
        shared().join("reference/tree8.urdf"),
    ];
    for file in files {
        let Ok(source) = RobotSource::read(&file) else {
            println!("*** SKIPPED: {} is not there ***", file.display());
            continue;
        };
        require_round_trip(&source, &source.robot().unwrap());
    }
}

#[test]
fn locked_joints_carry_their_links() {
    let source = RobotSource::read(&project("robots/branching.urdf")).unwrap();
    let locked = [("lift".to_owned(), 0.1), ("left_elbow".to_owned(), 0.7), ("right_slide".to_owned(), -0.1)];
    let locks = Locks { locked: locked.into_iter().collect(), until: Vec::new() };
    require_round_trip(&source, &source.robot_with_locks(&locks, Path::new("here")).unwrap());
}

#[test]
fn a_file_that_says_something_else_is_found() {
    let source = RobotSource::read(&project("robots/seven_axes.urdf")).unwrap();
    let mut export = urdf_of(&source, &source.robot().unwrap());
    let at = export.text.find("<mass value=\"").unwrap() + "<mass value=\"".len();
    export.text.insert(at, '1');
    assert!(matches!(export.check(), Err(ExportError::RoundTrip { .. })));
}

/// A robot of the checkout with friction and motor inertia everywhere, and links that are bodies.
fn whole(file: &str) -> (Robot, Vec<f64>) {
    let source = RobotSource::read(&project("robots").join(file)).unwrap();
    let robot =
        if file.ends_with("urdf") { source.robot_without_transmission().unwrap() } else { source.robot().unwrap() };
    let parameters = identified(&robot);
    (robot, parameters)
}

#[test]
fn mjcf_and_sdf_come_back() {
    for file in ROBOTS {
        let (robot, parameters) = whole(file);
        for format in [ExportFormat::Mjcf, ExportFormat::Sdf] {
            let export = export_robot(&robot, None, &parameters, format, &[]).unwrap();
            let worst = export.check().unwrap_or_else(|e| panic!("{format} of {file}: {e}"));
            assert!(worst < 1e-12, "{format} of {file}: {worst:e}");
        }
    }
    let (robot, parameters) = whole("two_joint.toml");
    let json = export_robot(&robot, None, &parameters, ExportFormat::Json, &[]).unwrap();
    assert!(matches!(json.check(), Err(ExportError::NoReader { format: ExportFormat::Json })));
}

/// A digit more, or a value that is not there: the file is another robot, or none.
#[test]
fn an_mjcf_or_sdf_that_says_something_else_is_found() {
    let (robot, parameters) = whole("tx40.toml");
    // The inertias of the first link do not all move anything: the last place is changed.
    let changed = |format, from: &str, to: &str| {
        let mut export = export_robot(&robot, None, &parameters, format, &[]).unwrap();
        let at = export.text.rfind(from).unwrap_or_else(|| panic!("{from}"));
        export.text.replace_range(at..at + from.len(), to);
        export.check().expect_err(from)
    };
    for (format, from, to) in [
        (ExportFormat::Mjcf, "mass=\"", "mass=\"1"),
        (ExportFormat::Mjcf, "fullinertia=\"", "fullinertia=\"1"),
        (ExportFormat::Mjcf, "armature=\"", "armature=\"1"),
        (ExportFormat::Mjcf, "damping=\"", "damping=\"1"),
        (ExportFormat::Mjcf, "frictionloss=\"", "frictionloss=\"1"),
        (ExportFormat::Sdf, "<mass>", "<mass>1"),
        (ExportFormat::Sdf, "<ixy>", "<ixy>1"),
        (ExportFormat::Sdf, "<damping>", "<damping>1"),
        (ExportFormat::Sdf, "<friction>", "<friction>1"),
        (ExportFormat::Sdf, "<xyz>0 0 1", "<xyz>0 1 1"),
    ] {
        let error = changed(format, from, to);
        assert!(matches!(error, ExportError::RoundTrip { .. }), "{from}: {error}");
    }
    assert!(matches!(
        changed(ExportFormat::Sdf, "<mass>", "<weight>"),
        ExportError::Robot(_) | ExportError::ReadBack { .. }
    ));
    let elsewhere = changed(ExportFormat::Mjcf, " axis=\"0 0 1\"", " axis=\"0 0.1 1\"");
    assert!(
        matches!(&elsewhere, ExportError::Mjcf(error) if matches!(**error, MjcfError::OtherAxis { .. })),
        "{elsewhere}"
    );
}

/// A MuJoCo model of a user's own, with other frames, notations and bodies beside, gets the robot's torques.
#[test]
fn a_users_own_mjcf_gets_the_identified_robot() {
    for file in ROBOTS {
        let (robot, parameters) = whole(file);
        let written = export_robot(&robot, None, &parameters, ExportFormat::Mjcf, &[]).unwrap().text;
        let model = MjcfModel::from_text(users_mjcf(&written), Path::new("mine.xml"));
        let export = export_robot(&robot, None, &parameters, Target::Into(&model), &["a test".to_owned()]).unwrap();
        let worst = export.check().unwrap_or_else(|e| panic!("{file}: {e}"));
        println!("{file}: {worst:.1e}");
        assert!(
            !export.notes.iter().any(|note| note.contains("axes") || note.contains("gravity")),
            "{:?}",
            export.notes
        );
        assert!(
            export.notes.iter().any(|note| note.contains("cover_1 keep their inertia; `my_link_1`")),
            "{:?}",
            export.notes
        );
        require_same_but_values(model.text(), &export.text);
        // Once more into what it has written: the same bytes.
        let again = MjcfModel::from_text(export.text.clone(), Path::new("mine.xml"));
        let again = export_robot(&robot, None, &parameters, Target::Into(&again), &["a test".to_owned()]).unwrap();
        assert!(again.text == export.text, "{file}");
    }
}

/// Nothing differs but inertials, values of joints, and the tendons at the end.
fn require_same_but_values(before: &str, after: &str) {
    let rest = |text: &str| -> String {
        let body = &text[text.find("<mujoco").unwrap()..text.find(" <actuator>").unwrap()];
        body.split('<').map(unchanged).collect()
    };
    let (before_rest, after_rest) = (rest(before), rest(after));
    assert!(before_rest == after_rest, "{before_rest}\n{after_rest}");
    let end = |text: &str| text[text.find(" <actuator>").unwrap()..].replace("</mujoco>\r\n", "");
    assert!(end(after).starts_with(&end(before)));
}

/// A tag and what follows it without what an export may change.
fn unchanged(tag: &str) -> String {
    const VALUES: [&str; 3] = ["armature", "damping", "frictionloss"];
    let behind = |tag: &str| tag.split_once('>').unwrap().1.trim().to_owned();
    if tag.starts_with("inertial") || tag.starts_with("/inertial") {
        return behind(tag);
    }
    if !tag.starts_with("joint ref") {
        return format!("<{}", tag.trim_end());
    }
    // Key, value, key, value.
    let parts: Vec<&str> = tag.split_once('>').unwrap().0.split(['"', '\'']).collect();
    let pairs = parts.chunks(2).map(|pair| (pair[0].trim().trim_end_matches('='), pair.get(1)));
    let kept: Vec<String> = pairs.filter(|(key, _)| !VALUES.contains(key)).map(|pair| format!("{pair:?}")).collect();
    format!("<{}>{}", kept.join(" "), behind(tag))
}

/// Everything that an edit must leave alone, written as nobody would: Windows line ends, single quotes, comments within elements,
/// attributes in other orders, a link without inertia, another without children, a rotated inertia, a mesh.
const ODD: &str = "<?xml version='1.0'?>\r\n<!-- by hand -->\r\n<robot  name='odd' >\r\n\t<link name='base'/>\r\n\t<link name = 'a' >\
    <!-- mesh --><visual><geometry><mesh filename='package://x/a.dae' scale='1 1 1'/></geometry></visual>\r\n\t\t<inertial>\
    <mass  value='2' /><!-- CAD --><origin rpy='0.3 0 0.1' xyz='0.1 0 0.2'/>\r\n\t\t\t<inertia izz='0.02' iyy='0.02' ixx='0.02' \
    ixy='0' ixz='0' iyz='0'/></inertial>\r\n\t</link>\r\n\t<link name='b'/>\r\n\t<link name='c'>\r\n\t\t<visual/>\r\n\t</link>\r\n\
    \t<link name='tool'><inertial><mass value='0.3'/><inertia ixx='0.001' ixy='0' ixz='0' iyy='0.001' iyz='0' izz='0.001'/>\
    </inertial></link>\r\n\t<joint name='j1' type='continuous'>\r\n\t\t<parent link='base'/><child link='a'/><axis xyz='0 1 0'/>\r\n\
    \t\t<dynamics friction='0.1'/></joint>\r\n\t<joint name='j2' type='prismatic'><parent link='a'/><child link='b'/>\
    <origin xyz='0 0 0.5'/><limit lower='0' upper='1' effort='1' velocity='1'/></joint>\r\n\t<joint name='j3' type='continuous'>\r\n\
    \t\t<parent link='b'/>\r\n\t\t<child link='c'/>\r\n\t\t<axis xyz='1 0 0'/>\r\n\t</joint>\r\n\t<joint name='f' type='fixed'>\
    <parent link='c'/><child link='tool'/><origin xyz='0 0 0.2' rpy='0 0 1'/></joint>\r\n\t<gazebo reference='a'/>\r\n</robot>\r\n";

fn odd() -> (RobotSource, Robot) {
    let source = RobotSource::from_text(ODD.to_owned(), Path::new("odd.urdf")).unwrap();
    let robot = source.robot().unwrap();
    (source, robot)
}

/// A robot as it would be identified: friction everywhere, and links that are bodies.
fn identified(robot: &Robot) -> Vec<f64> {
    let mut parameters = completed_a_priori(robot, None);
    for (value, parameter) in parameters.iter_mut().zip(robot.parameter_table().iter()) {
        *value = match parameter.name().trim_end_matches(char::is_numeric) {
            "fv" => 0.25,
            "fc" => 0.125,
            _ => 1.5 * *value,
        };
    }
    parameters
}

#[test]
fn an_odd_file_comes_back() {
    let (source, robot) = odd();
    let export = export_robot(&robot, source.urdf_text(), &identified(&robot), ExportFormat::Urdf, &[]).unwrap();
    export.check().unwrap();
    assert!(export.notes.iter().any(|note| note.contains("tool keep their inertia")), "{:?}", export.notes);
}

/// The ranges of the elements of a text that an export may change.
fn changeable(text: &str) -> Vec<Range<usize>> {
    let document = roxmltree::Document::parse(text).unwrap();
    let inside = |node: &roxmltree::Node<'_, '_>| matches!(node.tag_name().name(), "inertial" | "dynamics");
    document.descendants().filter(inside).map(|node| node.range()).collect()
}

/// A text without some ranges.
fn without(text: &str, ranges: &[Range<usize>]) -> String {
    (0..text.len()).filter(|at| ranges.iter().all(|r| !r.contains(at))).map(|at| text.as_bytes()[at] as char).collect()
}

#[test]
fn all_that_is_no_inertia_and_no_friction_stays() {
    let files = [project("robots/branching.urdf"), project("robots/seven_axes.urdf"), project("robots/quadruped.urdf")];
    let texts = files.map(|file| std::fs::read_to_string(file).unwrap());
    for text in texts.iter().map(String::as_str).chain([ODD]) {
        let source = RobotSource::from_text(text.to_owned(), Path::new("robot.urdf")).unwrap();
        let robot = source.robot_without_transmission().unwrap();
        let export = export_robot(&robot, Some(text), &identified(&robot), ExportFormat::Urdf, &[]).unwrap().text;
        let header = export.find("<!--\n").or(export.find("<!--\r\n")).unwrap();
        let end = header + export[header..].find("-->").unwrap() + "-->".len();
        let behind = end + export[end..].find('\n').unwrap() + 1;
        let stripped = format!("{}{}", &export[..header], &export[behind..]);
        // Space about elements that were added is added as well.
        let words = |text: String| text.split_whitespace().map(str::to_owned).collect::<Vec<_>>().join(" ");
        let opened = |text: String| words(text).replace("<link name='b'> </link>", "<link name='b'/>");
        let spaceless = |text: String| opened(text).replace("> <", "><");
        let (before, after) = (without(text, &changeable(text)), without(&stripped, &changeable(&stripped)));
        assert_eq!(spaceless(before), spaceless(after));
        if text != ODD && changeable(text).len() == changeable(&stripped).len() {
            assert_eq!(without(text, &changeable(text)), without(&stripped, &changeable(&stripped)));
        }
    }
}

#[test]
fn what_a_format_cannot_say_is_listed_with_its_values() {
    let source = RobotSource::read(&project("robots/tx40.toml")).unwrap();
    let robot = source.robot().unwrap();
    let of = |format| export_robot(&robot, None, &robot.a_priori_parameters(), format, &[]).unwrap();
    let urdf = of(ExportFormat::Urdf);
    assert!(
        urdf.not_represented.iter().any(|line| line.contains("motor inertia") && line.contains("ia1 = ")),
        "{:?}",
        urdf.not_represented
    );
    let escaped = |line: &String| urdf.text.contains(&line.replace("--", "- -"));
    assert!(urdf.not_represented.iter().all(escaped));
    assert!(of(ExportFormat::Json).not_represented.is_empty());
}

/// The experiment of the two-joint twin with LS alone, and with further tables.
fn two_joint_experiment(tables: &str, robot: &str) -> Experiment {
    let text = std::fs::read_to_string(project("experiments/two_joint.toml")).unwrap();
    let nominal = text.split("[[case]]").next().unwrap();
    let text = format!("{nominal}[estimation]\nmethods = [\"idim-ls\"]\n{tables}");
    Experiment::from_texts(Path::new("two_joint.toml"), text, robot.to_owned()).unwrap()
}

fn two_joint_robot() -> String {
    std::fs::read_to_string(project("robots/two_joint.toml")).unwrap()
}

/// Its results with other parameters.
/// Results with the free estimates alone: those of the model are exported as they are (`suite/model.rs`).
fn free(results: Results) -> Results {
    Results { model: None, ..results }
}

fn two_joint_with(tables: &str) -> Results {
    free(two_joint_experiment(tables, &two_joint_robot()).run(Path::new(""), &mut |_| {}).unwrap())
}

/// The nominal estimate of the two-joint twin by LS.
fn two_joint() -> &'static Results {
    static RESULTS: OnceLock<Results> = OnceLock::new();
    RESULTS.get_or_init(|| {
        let mut experiment = Experiment::read(&project("experiments/two_joint.toml"), Path::new("")).unwrap();
        experiment.settings.cases.clear();
        experiment.settings.estimation.methods = vec![Method::IDIM_LS];
        free(experiment.run(Path::new(""), &mut |_| {}).unwrap())
    })
}

fn forced() -> EstimateRequest {
    EstimateRequest { untrusted: true, ..EstimateRequest::default() }
}

/// The value of a standard parameter.
fn value(model: &IdentifiedModel, name: &str) -> f64 {
    model.standard[model.identified.robot.parameter_table().index_of(name).unwrap()]
}

fn provenance(model: &IdentifiedModel, name: &str) -> Provenance {
    model.provenance()[model.identified.robot.parameter_table().index_of(name).unwrap()]
}

/// Why an experiment's results are not taken.
fn refusal(found: Result<IdentifiedModel, ExportError>) -> ExperimentError {
    match found {
        Err(ExportError::Experiment(error)) => *error,
        other => panic!("{other:?}"),
    }
}

fn model(results: &Results, request: &EstimateRequest) -> Result<IdentifiedModel, ExportError> {
    IdentifiedModel::of_results(Path::new("results.json"), results, request)
}

#[test]
fn the_exported_parameters_have_the_estimates() {
    let results = two_joint();
    let model = model(results, &EstimateRequest::default()).unwrap();
    assert!(model.moved.is_empty(), "{:?}", model.moved);
    assert!(model.identified.robot.parameter_table().check_physical(&model.standard).is_ok());
    model.export(ExportFormat::Urdf).unwrap().check().unwrap();
    let of = |name: &str| model.provenance()[model.identified.robot.parameter_table().index_of(name).unwrap()];
    assert_eq!([of("fv1"), of("m2"), of("m1")], [Provenance::Identified, Provenance::InSums, Provenance::APriori]);
    let run = results.run(NOMINAL, Method::IDIM_LS).unwrap();
    let fv1 = run.parameter("fv1").unwrap().estimate;
    let found = model.standard[model.identified.robot.parameter_table().index_of("fv1").unwrap()];
    assert!((found - fv1).abs() < 1e-9, "{found} {fv1}");
}

#[test]
fn results_say_how_estimates_vary_together() {
    let results = two_joint();
    let run = results.run(NOMINAL, Method::IDIM_LS).unwrap();
    let n = run.parameters.len();
    assert_eq!(run.covariance.len(), n * (n + 1) / 2);
    for (i, parameter) in run.parameters.iter().enumerate() {
        let deviation = run.covariance[i * (i + 1) / 2 + i].sqrt();
        assert!((deviation / parameter.standard_deviation_robust.unwrap() - 1.0).abs() < 1e-12);
    }
    // They come back from results.json, and the files are named with their hashes.
    let back = Results::from_json(Path::new("results.json"), &results.to_json().unwrap()).unwrap();
    assert_eq!(back.runs[0].covariance, run.covariance);
    assert_eq!(back.robot_files[0].name, "two_joint.toml");
    assert_eq!(back.robot_files[0].sha256.len(), 64);
}

/// The sampled base parameters have the mean and the covariance of the estimates where the set does not bind.
#[test]
#[ignore = "long, each night"]
fn samples_have_the_covariance_of_the_estimates() {
    const COUNT: u32 = 2000;
    let results = two_joint();
    let model = model(results, &EstimateRequest::default()).unwrap();
    let run = results.run(NOMINAL, Method::IDIM_LS).unwrap();
    let samples: Vec<_> = (1..=COUNT).map(|number| model.sample(number, 7).unwrap()).collect();
    let base: Vec<Vec<f64>> = samples.iter().map(|sample| model.base_parameters_of(sample)).collect();
    let n = run.parameters.len();
    // 4.5 standard errors of an estimated covariance, over some hundred of them.
    let bound = 4.5 * (2.0 / f64::from(COUNT)).sqrt();
    for i in 0..n {
        let mean = |i: usize| base.iter().map(|b| b[i]).sum::<f64>() / f64::from(COUNT);
        let variance = |i: usize| run.covariance[i * (i + 1) / 2 + i];
        let off = (mean(i) - run.parameters[i].estimate).abs() / variance(i).sqrt();
        assert!(off < 4.5 / f64::from(COUNT).sqrt(), "mean of {}: {off}", run.parameters[i].name);
        for j in 0..=i {
            let sum: f64 = base.iter().map(|b| (b[i] - mean(i)) * (b[j] - mean(j))).sum();
            let difference = sum / f64::from(COUNT - 1) - run.covariance[i * (i + 1) / 2 + j];
            let relative = difference / (variance(i) * variance(j)).sqrt();
            assert!(relative.abs() < bound, "{i} {j}: {relative}");
        }
    }
    for sample in samples.iter().take(50) {
        assert!(model.identified.robot.parameter_table().check_physical(&sample.standard).is_ok());
    }
    // A sample is its number and seed, whatever the others.
    assert_eq!(model.sample(5, 7).unwrap(), samples[4]);
    assert_ne!(model.sample(5, 8).unwrap().drawn, samples[4].drawn);
    let text = model.export_sample(&samples[4], ExportFormat::Urdf).unwrap().text;
    assert!(text.contains("identified by idim-ls") && text.contains("sample 5 of the estimates, seed 7"));
}

#[test]
fn the_sidecar_has_the_covariance_of_base_and_standard_parameters() {
    let model = model(two_joint(), &EstimateRequest::default()).unwrap();
    let sidecar: serde_json::Value = serde_json::from_str(&model.covariance_json().unwrap()).unwrap();
    let standard = sidecar["standard_parameters"].as_array().unwrap();
    let deviation =
        |name: &str| standard.iter().find(|p| p["name"] == name).unwrap()["standard_deviation"].as_f64().unwrap();
    let run = two_joint().run(NOMINAL, Method::IDIM_LS).unwrap();
    let of_base = run.parameter("fv2").unwrap().standard_deviation_robust.unwrap();
    assert!((deviation("fv2") / of_base - 1.0).abs() < 1e-9);
    // What is regrouped varies together such that the sum has its own variance.
    let base = sidecar["base_parameters"].as_array().unwrap().iter().find(|p| p["name"] == "zz1r").unwrap();
    assert_eq!(base["expression"], "zz1 + ia1 + 0.16*m2");
    let place = |name: &str| standard.iter().position(|p| p["name"] == name).unwrap();
    let covariance = |a: &str, b: &str| {
        let (row, column) = (place(a).max(place(b)), place(a).min(place(b)));
        sidecar["standard_covariance"][row][column].as_f64().unwrap()
    };
    let sum = [("zz1", 1.0), ("ia1", 1.0), ("m2", 0.16)];
    let covariance = &covariance;
    let variance: f64 = sum.iter().flat_map(|a| sum.iter().map(move |b| a.1 * b.1 * covariance(a.0, b.0))).sum();
    let of_base = base["standard_deviation"].as_f64().unwrap();
    assert!((variance.sqrt() / of_base - 1.0).abs() < 1e-6, "{variance} {of_base}");
    assert_eq!(sidecar["standard_covariance"].as_array().unwrap().len(), standard.len());
}

/// An estimate that no robot has is moved within its intervals, or refused.
#[test]
#[ignore = "long, each night"]
fn estimates_that_no_robot_has_are_moved_within_their_intervals_or_refused() {
    let mut experiment = Experiment::demo().unwrap();
    experiment.settings.cases.clear();
    experiment.settings.estimation.methods = vec![Method::IDIM_LS];
    let mut results = free(experiment.run(Path::new(""), &mut |_| {}).unwrap());
    let found = model(&results, &forced()).unwrap();
    let run = results.run(NOMINAL, Method::IDIM_LS).unwrap().clone();
    assert!(!run.physical.as_ref().unwrap().consistent, "the seed of the demonstration is fixed");
    assert!(!found.moved.is_empty());
    for moved in &found.moved {
        let [low, high] = run.parameter(&moved.name).unwrap().interval_95.unwrap();
        assert!((low..=high).contains(&moved.exported), "{moved:?} {low} {high}");
    }
    found.export(ExportFormat::Urdf).unwrap().check().unwrap();
    // Friction that drives, and is sure of it.
    let place = run.parameters.iter().position(|p| p.name == "fv3").unwrap();
    for run in &mut results.runs {
        let parameter = &mut run.parameters[place];
        parameter.estimate = -parameter.estimate;
        parameter.interval_95 = parameter.interval_95.map(|[low, high]| [-high, -low]);
    }
    let refused = model(&results, &forced()).unwrap_err();
    let ExportError::NotConsistent { conflicting, .. } = &refused else { panic!("{refused}") };
    assert!(conflicting.iter().any(|c| c.contains("fv3")), "{conflicting:?}");
}

#[test]
fn results_that_are_not_to_be_used_are_refused() {
    let mut results = two_joint().clone();
    results.verdict = Some(Verdict::DoNotUse);
    assert!(matches!(refusal(model(&results, &EstimateRequest::default())), ExperimentError::NotTrusted { .. }));
    assert!(model(&results, &forced()).is_ok());
}

#[test]
fn a_method_without_an_estimate_is_refused() {
    let request = EstimateRequest { method: Some(Method::DIDIM), ..EstimateRequest::default() };
    let refused = refusal(model(two_joint(), &request));
    let ExperimentError::NoEstimate { source: NoEstimate::Absent { runs, .. }, .. } = &refused else {
        panic!("{refused}")
    };
    assert_eq!(runs, &["nominal idim-ls"]);
    let no_advice = |results: &Results| {
        let refused = refusal(model(results, &EstimateRequest::default()));
        matches!(refused, ExperimentError::NoEstimate { source: NoEstimate::NotAdvised { .. }, .. })
    };
    let mut none = two_joint().clone();
    none.runs.iter_mut().for_each(|run| run.parameters.clear());
    assert!(matches!(refusal(model(&none, &EstimateRequest::default())), ExperimentError::NoEstimate { .. }));
    // Where the advice takes none, somebody must choose.
    let mut not_advised = two_joint().clone();
    not_advised.advice.iter_mut().for_each(|advice| advice.recommended = None);
    assert!(no_advice(&not_advised));
    let chosen = EstimateRequest { method: Some(Method::IDIM_LS), ..EstimateRequest::default() };
    assert!(model(&not_advised, &chosen).is_ok());
    let mut without_robot = two_joint().clone();
    without_robot.robot_description.clear();
    assert!(matches!(refusal(model(&without_robot, &EstimateRequest::default())), ExperimentError::NoRobot { .. }));
}

#[test]
fn a_description_that_changed_or_is_of_another_robot_is_refused() {
    let text = std::fs::read_to_string(project("robots/two_joint.toml")).unwrap();
    let folder = Folder::with("two_joint.toml", &text);
    let request = || EstimateRequest { data: Some(folder.path().to_owned()), ..EstimateRequest::default() };
    assert!(model(two_joint(), &request()).is_ok());
    folder.write("two_joint.toml", text.replace("a_m = 0.4", "a_m = 0.41"));
    assert!(matches!(refusal(model(two_joint(), &request())), ExperimentError::RobotChanged { .. }));
    let another = EstimateRequest { robot: Some(project("robots/tx40.toml")), ..EstimateRequest::default() };
    assert!(matches!(refusal(model(two_joint(), &another)), ExperimentError::AnotherRobot { .. }));
    // Results of before the hashes are compared by the text.
    let mut old = two_joint().clone();
    old.robot_files.clear();
    assert!(matches!(refusal(model(&old, &request())), ExperimentError::RobotChanged { .. }));
    folder.write("two_joint.toml", &text);
    assert!(model(&old, &request()).is_ok());
}

/// What the identified model has at zero is zero in the export, where some robot has it there.
#[test]
fn base_parameters_that_were_not_estimated_are_zero_or_named() {
    let names: Vec<&str> = two_joint().runs[0].parameters.iter().map(|p| p.name.as_str()).collect();
    let without = |left_out: &str| {
        assert!(names.contains(&left_out), "{names:?}");
        let kept: Vec<&str> = names.iter().copied().filter(|name| *name != left_out).collect();
        let results = two_joint_with(&format!("[parameters]\nestimate = {kept:?}\n"));
        model(&results, &forced()).unwrap()
    };
    let found = without("mx2");
    assert!(found.moved.is_empty(), "{:?}", found.moved);
    assert!(value(&found, "mx2").abs() < 1e-12, "{}", value(&found, "mx2"));
    assert_eq!(provenance(&found, "mx2"), Provenance::Zero);
    assert!(value(&found, "m2") > 0.0 && provenance(&found, "fv1") == Provenance::Identified);
    let sample = found.sample(1, 1).unwrap();
    assert!(sample.standard[found.identified.robot.parameter_table().index_of("mx2").unwrap()].abs() < 1e-12);
    // No link has no inertia: it is free, and named.
    let found = without("zz2");
    assert!(found.moved.iter().any(|m| m.name == "zz2" && m.estimate == 0.0 && m.exported > 0.0), "{:?}", found.moved);
    let estimated = |m: &&thetahat::export::AdjustedParameter| m.name != "zz2";
    assert_eq!(found.moved.iter().filter(estimated).count(), 0, "{:?}", found.moved);
}

/// Results whose consistent estimate was not found.
fn without_consistent_estimate(mut results: Results) -> Results {
    results.runs.iter_mut().filter_map(|run| run.physical.as_mut()).for_each(|physical| physical.estimate = None);
    results
}

#[test]
fn what_is_known_holds_in_exports_samples_and_their_covariance() {
    let free = two_joint().runs[0].parameter("fv1").unwrap();
    let given = free.estimate + 0.3 * free.farther_end().unwrap();
    // A friction that a data sheet gives, and a link that is symmetric.
    let with = two_joint_with(&format!(
        "[parameters]\nphysical = true\n[[parameters.known]]\nkind = \"parameter\"\nname = \"fv1\"\nvalue = {given}\n\
         [[parameters.known]]\nkind = \"mirror-plane\"\nlink = 2\nnormal = \"y\"\n"
    ));
    for results in [with.clone(), without_consistent_estimate(with)] {
        let found = model(&results, &forced()).unwrap();
        assert_eq!(value(&found, "fv1"), given);
        assert_eq!(provenance(&found, "fv1"), Provenance::Given);
        assert!(value(&found, "my2").abs() < 1e-12);
        for number in 1..=5 {
            let sample = found.sample(number, 3).unwrap();
            let table = found.identified.robot.parameter_table();
            assert_eq!(sample.standard[table.index_of("fv1").unwrap()], given);
            assert!(sample.standard[table.index_of("my2").unwrap()].abs() < 1e-12);
        }
        let sidecar: serde_json::Value = serde_json::from_str(&found.covariance_json().unwrap()).unwrap();
        let deviation = |key: &str, name: &str| {
            let all = sidecar[key].as_array().unwrap();
            all.iter().find(|p| p["name"] == name).unwrap()["standard_deviation"].as_f64().unwrap()
        };
        for key in ["base_parameters", "standard_parameters"] {
            assert!(deviation(key, "fv1") < 1e-9 && deviation(key, "my2") < 1e-9, "{key}");
            // Knowing others makes no estimate less sure.
            let free = two_joint().runs[0].parameter("fv2").unwrap().standard_deviation_robust.unwrap();
            assert!(deviation(key, "fv2") > 0.5 * free && deviation(key, "fv2") < 1.001 * free, "{key}");
        }
    }
}

#[test]
fn what_is_known_against_the_data_is_refused() {
    let known = "[[parameters.known]]\nkind = \"parameter\"\nname = \"fv1\"\nvalue = 20\n";
    let results = two_joint_with(&format!("[parameters]\nphysical = true\n{known}"));
    assert_eq!(value(&model(&results, &forced()).unwrap(), "fv1"), 20.0, "the results have a consistent estimate");
    let refused = model(&without_consistent_estimate(results), &forced()).unwrap_err();
    let ExportError::NotConsistent { conflicting, .. } = &refused else { panic!("{refused}") };
    assert!(conflicting.iter().any(|c| c.contains("fv1")), "{conflicting:?}");
}

/// Results of arrays with a parameter that is given and one that is left out; they come back from their JSON.
#[test]
fn results_of_arrays_know_what_was_fixed_and_excluded() {
    let experiment = two_joint_experiment("", &two_joint_robot());
    let record = experiment.record_twin().unwrap();
    let recording = Recording::new(record.sample_rate_hz, record.position, record.torque);
    let mut settings = Settings::new(40.0, 10);
    settings.parameters.fix.insert("fv1".to_owned(), 2.0);
    settings.parameters.exclude = vec!["off1".to_owned()];
    let mut results = free(Identification::new(&experiment.robot, vec![recording], settings).unwrap().run().unwrap());
    results.robot_description = two_joint_robot();
    let back = Results::from_json(Path::new("results.json"), &results.to_json().unwrap()).unwrap();
    let found = model(&back, &forced()).unwrap();
    assert_eq!((value(&found, "fv1"), value(&found, "off1")), (2.0, 0.0));
    assert_eq!([provenance(&found, "fv1"), provenance(&found, "off1")], [Provenance::Given, Provenance::Zero]);
    let about = found.about().join("\n");
    assert!(about.contains("given by the experiment: fv1\n"), "{about}");
    assert!(about.contains("not in the identified model, zero: off1\n"), "{about}");
    let fv1 = found.identified.robot.parameter_table().index_of("fv1").unwrap();
    assert_eq!(found.identified.theta()[fv1], 2.0);
}

#[test]
fn results_of_before_the_verdict_are_judged() {
    let mut results = two_joint().clone();
    results.verdict = None;
    results.verdict_reasons.clear();
    let found = model(&results, &EstimateRequest::default()).unwrap();
    assert_eq!(Some(found.identified.verdict), two_joint().verdict);
    results.runs[0].status = Status::Stalled;
    let refused = refusal(model(&results, &EstimateRequest::default()));
    assert!(matches!(&refused, ExperimentError::NotTrusted { reasons, .. } if !reasons.is_empty()), "{refused}");
    let about = model(&results, &forced()).unwrap().about();
    assert!(about[0].ends_with("verdict: do-not-use; status: stalled"), "{about:?}");
}

#[test]
fn a_sample_says_its_verdict_and_where_its_parameters_come_from() {
    let found = model(two_joint(), &EstimateRequest::default()).unwrap();
    let text = found.export_sample(&found.sample(1, 1).unwrap(), ExportFormat::Mjcf).unwrap().text;
    for words in ["verdict: ", "identified by themselves: ", "not identified, chosen near the a-priori values: "] {
        assert!(text.contains(words), "{words}: {text}");
    }
}

#[test]
fn results_without_deviations_or_with_a_singular_covariance_say_so() {
    let mut singular = two_joint().clone();
    singular.runs[0].covariance.iter_mut().for_each(|c| *c = 0.0);
    let sampled = model(&singular, &EstimateRequest::default()).unwrap().sample(1, 1);
    assert!(matches!(sampled, Err(ExportError::SingularCovariance { .. })), "{sampled:?}");
    let mut uncorrelated = two_joint().clone();
    uncorrelated.runs[0].covariance.clear();
    let sidecar = model(&uncorrelated, &EstimateRequest::default()).unwrap().covariance_json().unwrap();
    assert!(sidecar.contains("no correlations"), "{sidecar}");
    let mut without = uncorrelated;
    for parameter in &mut without.runs[0].parameters {
        (parameter.standard_deviation, parameter.standard_deviation_robust, parameter.interval_95) = (None, None, None);
    }
    let sidecar = model(&without, &EstimateRequest::default()).unwrap().covariance_json();
    assert!(matches!(sidecar, Err(ExportError::NoDeviations { .. })), "{sidecar:?}");
}

const STRIBECK: &str = "\n[[term]]\nkind = \"exponential-stribeck\"\nvelocity = 0.05\nprofile = true\n\
                        [[term]]\nkind = \"load-friction\"\n";

/// The JSON model has the constants that were found, and the masses that load friction is of.
#[test]
fn the_json_model_has_all_that_its_terms_need() {
    let robot = Robot::parse(&(two_joint_robot() + STRIBECK), Path::new("two_joint.toml")).unwrap();
    let constants = |joint: &str, velocity: f64, exponent: f64| ProfiledTerm {
        term: 0,
        joint: joint.to_owned(),
        velocity,
        exponent,
        at_limit: false,
    };
    let found = with_constants(&robot, &[constants("shoulder", 0.00875, 4.0), constants("elbow", 2.42, 0.5)]);
    let export = export_robot(&found, None, &found.a_priori_parameters(), ExportFormat::Json, &[]).unwrap();
    let json: serde_json::Value = serde_json::from_str(&export.text).unwrap();
    let terms: Vec<TermDescription> = serde_json::from_value(json["terms"].clone()).unwrap();
    assert_eq!(robot.with_terms(&terms).unwrap().terms, found.terms);
    assert_eq!(json["terms"][0]["velocity"], 0.00875);
    assert!(terms.iter().all(|term| !term.is_profiled()), "{terms:?}");
    assert_eq!(json["parameters"]["m2"]["a_priori"], 2.0);
}

#[test]
fn a_file_with_other_joints_is_found() {
    let source = RobotSource::read(&project("robots/two_joint.toml")).unwrap();
    let mut export = urdf_of(&source, &source.robot().unwrap());
    export.text = export.text.replace("\"elbow\"", "\"wrist\"");
    assert!(matches!(export.check(), Err(ExportError::OtherJoints { .. })));
    for name in [" elbow", "elbow\\u0007"] {
        let text = two_joint_robot().replace("\"elbow\"", &format!("\"{name}\""));
        let refused = Robot::parse(&text, Path::new("two_joint.toml")).unwrap_err();
        assert!(matches!(refused, RobotError::Joint { .. }), "{refused}");
    }
}

#[test]
fn each_joint_has_the_reduction_of_its_own_motor() {
    let text = two_joint_robot().replace("[[50, 0], [0, 50]]", "[[0, 50], [40, 0]]");
    let robot = Robot::parse(&text, Path::new("two_joint.toml")).unwrap();
    let export = export_robot(&robot, None, &robot.a_priori_parameters(), ExportFormat::Urdf, &[]).unwrap();
    let back = Robot::parse(&export.text, Path::new("two_joint.urdf")).unwrap();
    assert_eq!(back.transmission.ratios(), Some(vec![40.0, 50.0]));
    // Other formats list them.
    let sdf = export_robot(&robot, None, &robot.a_priori_parameters(), ExportFormat::Sdf, &[]).unwrap();
    assert!(sdf.not_represented.iter().any(|line| line.contains("[0 50; 40 0]")), "{:?}", sdf.not_represented);
}

#[test]
fn locked_joints_with_followers_are_locked_again() {
    let source = RobotSource::read(&project("robots/mobile_manipulator.urdf")).unwrap();
    let whole = source.robot_without_transmission().unwrap();
    let leader = whole.joints.iter().find_map(|j| j.mimic).map(|m| whole.joints[m.of].name.clone()).unwrap();
    let locks = Locks { locked: [(leader, 0.02)].into(), until: Vec::new() };
    let robot = whole.with_locks(&locks).unwrap();
    assert!(robot.locked.len() > 1, "{:?}", robot.locked);
    assert_eq!(Locks::restating(&robot.locked, &whole.joints), locks);
}

#[test]
fn the_files_that_were_read_are_known() {
    let request = EstimateRequest { data: Some(project("robots")), ..EstimateRequest::default() };
    let found = IdentifiedRobot::of_results(Path::new("results.json"), two_joint(), &request).unwrap();
    assert_eq!(found.files, [Path::new("results.json").to_owned(), project("robots/two_joint.toml")]);
}
