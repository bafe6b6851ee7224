use std::path::Path;

use super::*;
use thetahat_data::recording::{Format, Side, Unit, inspect_with_time};
use thetahat_estimation::identification::Method;
use thetahat_ground::one_or_each::OneOrEach;
use thetahat_model::robot::RobotSource;

const ARM: &str = "name = 'arm'\n[[joint]]\nname = 'a'\nkind = 'revolute'\n[[joint]]\nname = 'b'\nkind = 'revolute'\n";

/// A proposal for a log with this first line, or why there is none.
fn proposed(header: &str, request: ProposalRequest) -> Result<String, ProposalError> {
    let columns = header.split(',').count();
    let row = |k: usize| {
        let value = |c: usize| if c == 0 { k as f64 * 1e-3 } else { (0.1 * k as f64 + c as f64).sin() };
        (0..columns).map(|c| value(c).to_string()).collect::<Vec<_>>().join(",") + "\n"
    };
    let folder = thetahat_testing::Folder::new();
    folder.write("log.csv", format!("{header}\n{}", (0..300).map(row).collect::<String>()));
    let contents = inspect_with_time(&folder.at("log.csv"), request.time.as_deref()).unwrap();
    let robot = RobotSource::from_text(ARM.to_owned(), Path::new("arm.toml")).unwrap();
    propose(&request, &robot, &[contents]).map(|p| p.text())
}

fn request() -> ProposalRequest {
    ProposalRequest {
        robot_file: "arm.toml".into(),
        recording_files: vec!["log.csv".into()],
        ..ProposalRequest::default()
    }
}

#[test]
fn the_proposal_is_an_experiment_that_can_be_read() {
    let text = proposed("t,q1,q2,tau1,tau2", request()).unwrap();
    let experiment = super::super::Experiment::from_texts(Path::new("e.toml"), text, ARM.to_owned()).unwrap();
    let recording = &experiment.file.recording[0];
    assert_eq!(recording.position.columns, ["q1", "q2"]);
    assert_eq!(recording.torque.as_ref().unwrap().columns, ["tau1", "tau2"]);
    assert_eq!(recording.time.as_ref().unwrap().columns, ["t"]);
    assert_eq!(experiment.settings.signal.decimation, 20);
}

#[test]
fn columns_are_ordered_by_the_names_of_the_joints() {
    let text = proposed("t,b.position,a.position,b.effort,a.effort", request()).unwrap();
    assert!(text.contains(r#"columns = ["a.position", "b.position"]"#), "{text}");
    assert!(text.contains(r#"columns = ["a.effort", "b.effort"]"#), "{text}");
}

#[test]
fn references_and_velocities_are_taken_along() {
    let text = proposed("t,q1,q2,q1_ref,q2_ref,dq1,dq2,tau1,tau2", request()).unwrap();
    assert!(text.contains("reference = {") && text.contains(r#"unit = "rad/s""#), "{text}");
}

#[test]
fn names_that_are_not_clear_are_not_guessed() {
    let error = proposed("t,q1,q2,c1,c2", request()).unwrap_err();
    assert!(matches!(error, ProposalError::UnclearColumns { signal: "torque", joints: 2, .. }));
    let named = ProposalRequest { torque: vec!["c1".into(), "c2".into()], ..request() };
    assert!(proposed("t,q1,q2,c1,c2", named).is_ok());
}

#[test]
fn the_columns_that_look_like_a_signal_are_counted() {
    let said = |header| proposed(header, request()).unwrap_err().to_string();
    let none = said("t,q1,q2,c1,c2");
    assert!(none.contains("are not clear: no column looks like it; expected"), "{none}");
    let one = said("t,q1,q2,tau1,c2");
    assert!(one.contains("1 column looks like it (tau1); "), "{one}");
    let three = said("t,q1,q2,tau1,tau2,tau3");
    assert!(three.contains("3 columns look like it (tau1 tau2 tau3); "), "{three}");
}

#[test]
fn a_column_that_is_not_there_is_named() {
    let named = ProposalRequest { torque: vec!["c1".into(), "c9".into()], ..request() };
    let error = proposed("t,q1,q2,c1,c2", named).unwrap_err();
    assert!(matches!(error, ProposalError::NoSuchColumn { name, .. } if name == "c9"));
}

#[test]
fn too_many_columns_of_a_kind_are_not_chosen_from() {
    let error = proposed("t,q1,q2,qm1,qm2,tau1,tau2", request()).unwrap_err();
    assert!(matches!(error, ProposalError::UnclearColumns { signal: "position", .. }));
}

/// A folder with files of these first lines, 300 samples each, and what is proposed for them.
fn proposed_from(files: &[(&str, &str)], request: ProposalRequest, robot: &str) -> Result<Proposal, ProposalError> {
    let folder = thetahat_testing::Folder::new();
    let row = |header: &str, k: usize| {
        let value = |c: usize, name: &str| match name {
            "t" => k as f64 * 1e-3,
            "time_s" => k as f64 * 2.0,
            "time" => k as f64,
            _ => (0.1 * k as f64 + c as f64).sin(),
        };
        header.split(',').enumerate().map(|(c, name)| value(c, name).to_string()).collect::<Vec<_>>().join(",") + "\n"
    };
    for (name, header) in files {
        let body: String = (0..300).map(|k| row(header, k)).collect();
        folder.write(name, format!("{header}\n{body}"));
    }
    let names: Vec<std::path::PathBuf> = files.iter().map(|(name, _)| name.into()).collect();
    let contents: Vec<_> =
        names.iter().map(|n| inspect_with_time(&folder.path().join(n), request.time.as_deref()).unwrap()).collect();
    let robot = RobotSource::from_text(robot.to_owned(), Path::new("arm.toml")).unwrap();
    propose(&ProposalRequest { recording_files: names, ..request }, &robot, &contents)
}

/// The files of the signals of each recording, in the order of the text.
fn files_of(proposal: &Proposal) -> Vec<Vec<(&'static str, String)>> {
    let of = |r: &ProposedRecording| {
        let time = r.clock.time.iter().map(|t| ("time", t));
        time.chain(r.channels.iter().map(|(n, c)| (*n, c))).map(|(n, c)| (n, c.file.display().to_string())).collect()
    };
    proposal.recordings.iter().map(of).collect()
}

#[test]
fn time_positions_and_torques_in_three_files_are_one_recording() {
    let files = [("tau.csv", "Joint_1,Joint_2"), ("time.csv", "t"), ("q.csv", "Joint_1,Joint_2")];
    let proposal = proposed_from(&files, request(), ARM).unwrap();
    let expected = [("time", "time.csv"), ("position", "q.csv"), ("torque", "tau.csv")];
    assert_eq!(files_of(&proposal), [expected.map(|(s, f)| (s, f.to_owned()))]);
    assert!(proposal.text().contains("[recording]\n"), "{}", proposal.text());
}

#[test]
fn recordings_of_one_kind_are_several() {
    let files = [("b.csv", "t,q1,q2,tau1,tau2"), ("a.csv", "t,q1,q2,tau1,tau2")];
    let proposal = proposed_from(&files, request(), ARM).unwrap();
    assert_eq!(proposal.recordings.iter().map(|r| r.name.as_deref()).collect::<Vec<_>>(), [Some("b"), Some("a")]);
    let text = proposal.text();
    let experiment = super::super::Experiment::from_texts(Path::new("e.toml"), text, ARM.to_owned()).unwrap();
    assert_eq!(experiment.file.recording.len(), 2);
}

#[test]
fn files_of_several_recordings_find_each_other_by_their_names() {
    let files = [
        ("run1_q.csv", "t,j1,j2"),
        ("tau_run2.csv", "j1,j2"),
        ("tau_run1.csv", "j1,j2"),
        ("run2_q.csv", "t,j1,j2"),
        ("run2_q_ref.csv", "j1,j2"),
    ];
    let found = files_of(&proposed_from(&files, request(), ARM).unwrap());
    assert_eq!(
        found[0].iter().map(|(_, f)| f.as_str()).collect::<Vec<_>>(),
        ["run1_q.csv", "run1_q.csv", "tau_run1.csv"]
    );
    let second: Vec<&str> = found[1].iter().map(|(_, f)| f.as_str()).collect();
    assert_eq!(second, ["run2_q.csv", "run2_q.csv", "tau_run2.csv", "run2_q_ref.csv"]);
}

#[test]
fn files_without_a_clear_partner_are_refused() {
    let files = [("q_a.csv", "t,j1,j2"), ("q_b.csv", "t,j1,j2"), ("tau_c.csv", "j1,j2"), ("tau_d.csv", "j1,j2")];
    let error = proposed_from(&files, request(), ARM).unwrap_err();
    assert_eq!(
        error.to_string(),
        "q_a.csv: it holds positions, and the names do not show which of the other files belong to the \
         same recording; give the files of one recording at a time"
    );
}

#[test]
fn a_file_that_says_nothing_is_asked_for() {
    let files = [("q.csv", "t,j1,j2"), ("b.csv", "j1,j2")];
    let error = proposed_from(&files, request(), ARM).unwrap_err();
    assert_eq!(
        error.to_string(),
        "b.csv: neither its name nor its columns say which signal it holds; the columns are: j1 j2"
    );
    let named = ProposalRequest { torque: vec!["b.csv".into()], ..request() };
    let found = files_of(&proposed_from(&files, named, ARM).unwrap());
    assert_eq!(found[0][2], ("torque", "b.csv".to_owned()));
}

#[test]
fn columns_of_a_file_are_named_with_it() {
    let files = [("a.csv", "t,j1,j2"), ("b.csv", "j1,j2")];
    let named = ProposalRequest {
        position: vec!["a.csv:j2".into(), "j1".into()],
        torque: vec!["b.csv:j1".into(), "j2".into()],
        ..request()
    };
    let proposal = proposed_from(&files, named, ARM).unwrap();
    assert_eq!(proposal.recordings[0].channels[0].1.columns, ["j2", "j1"]);
    assert_eq!(proposal.recordings[0].channels[1].1.columns, ["j1", "j2"]);
}

const SAME: &str = "log.csv: column \"tau1\" is taken for the positions and for the torques";

#[test]
fn too_few_columns_and_the_torque_s_are_refused_at_once() {
    let named = ProposalRequest { position: vec!["q1".into()], ..request() };
    let error = proposed("t,q1,q2,tau1,tau2", named).unwrap_err();
    let expected = "1 columns are named for the position; arm has 2 joints, and one is needed for each of them";
    assert_eq!(error.to_string(), expected);
    let same = vec!["tau1".to_owned(), "tau2".to_owned()];
    let named = ProposalRequest { position: same.clone(), torque: same, ..request() };
    let error = proposed("t,q1,q2,tau1,tau2", named).unwrap_err();
    assert_eq!(error.to_string(), SAME);
    let named = ProposalRequest { position: vec!["tau1".into(), "tau2".into()], ..request() };
    let error = proposed("t,q1,q2,tau1,tau2", named).unwrap_err();
    assert_eq!(error.to_string(), SAME);
}

/// The column that is named as the time is taken, though another has the name of a time.
#[test]
fn the_time_that_is_named_is_taken() {
    let files = [("log.csv", "t,counter,q1,q2,tau1,tau2")];
    let named = |time: &str| ProposalRequest { time: Some(time.into()), ..request() };
    let error = proposed_from(&files, named("q1"), ARM).map(|p| p.text());
    assert!(error.is_ok_and(|text| text.contains("time = { file = \"log.csv\", columns = [\"q1\"]")));
    let error = proposed_from(&files, named("clock"), ARM).unwrap_err();
    assert!(matches!(error, ProposalError::NoSuchColumn { name, .. } if name == "clock"));
}

#[test]
fn a_rate_that_the_times_contradict_is_refused() {
    let stated = ProposalRequest { sample_rate_hz: Some(500.0), ..request() };
    let error = proposed("t,q1,q2,tau1,tau2", stated).unwrap_err();
    assert_eq!(
        error.to_string(),
        "log.csv: a rate of 500 Hz is stated, but the times in column \"t\" say 1000.000000 Hz"
    );
}

#[test]
fn files_of_different_lengths_are_not_of_one_recording() {
    let folder = thetahat_testing::Folder::new();
    folder.write("q.csv", "t,j1,j2\n0,1,2\n0.1,2,3\n0.2,3,4\n");
    folder.write("tau.csv", "j1,j2\n1,2\n2,3\n");
    let contents = ["q.csv", "tau.csv"].map(|n| inspect_with_time(&folder.at(n), None).unwrap());
    let robot = RobotSource::from_text(ARM.to_owned(), Path::new("arm.toml")).unwrap();
    let request = ProposalRequest { recording_files: vec!["q.csv".into(), "tau.csv".into()], ..request() };
    let error = propose(&request, &robot, &contents).unwrap_err();
    assert_eq!(error.to_string(), "q.csv has 3 samples, tau.csv has 2: they are not of one recording");
}

/// Angles of motors are recognised by the gears of the robot.
#[test]
fn motors_are_recognised_by_their_range_and_the_robot_s_gears() {
    let geared = format!("{ARM}[transmission]\nmatrix = [[40, 0], [0, 50]]\n");
    let folder = thetahat_testing::Folder::new();
    let row = |k: usize| format!("{},{},{},1,2\n", 1e-3 * k as f64, 60.0 * (0.1 * k as f64).sin(), 0.3 * k as f64);
    folder.write("log.csv", format!("t,q1,q2,tau1,tau2\n{}", (0..300).map(row).collect::<String>()));
    let contents = [inspect_with_time(&folder.at("log.csv"), None).unwrap()];
    let text = |robot: &str| {
        propose(&request(), &RobotSource::from_text(robot.to_owned(), Path::new("arm.toml")).unwrap(), &contents)
            .unwrap()
            .text()
    };
    assert!(text(&geared).contains("unit = \"rad\", side = \"motor\" }\n# From 1 to 2"), "{}", text(&geared));
    assert!(text(&geared).contains("unit = \"N m\", unit_guessed = true, side = \"motor\""));
    assert!(text(ARM).contains("unit = \"deg\" }") && !text(ARM).contains("motor"), "{}", text(ARM));
}

/// A reference of another unit is not taken for one of the positions.
#[test]
fn a_reference_of_another_scale_is_left_out() {
    let folder = thetahat_testing::Folder::new();
    let row = |k: usize| {
        format!("{},{q},{q},{r},{r},1,2\n", 1e-3 * k as f64, q = (0.1 * k as f64).sin(), r = 0.02 * k as f64 / 300.0)
    };
    folder.write("log.csv", format!("t,q1,q2,q1_ref,q2_ref,tau1,tau2\n{}", (0..300).map(row).collect::<String>()));
    let contents = [inspect_with_time(&folder.at("log.csv"), None).unwrap()];
    let text = propose(&request(), &RobotSource::from_text(ARM.to_owned(), Path::new("arm.toml")).unwrap(), &contents)
        .unwrap()
        .text();
    assert!(text.contains("\n# reference = {") && text.contains("Left out"), "{text}");
}

const LIFT: &str = "name = 'lift'\n[[joint]]\nname = 'lift_joint'\nkind = 'prismatic'\n[[joint]]\nname = 'arm_joint'\nkind = 'revolute'\n\
                    [[joint]]\nname = 'head_joint'\nkind = 'revolute'\n";

#[test]
fn joints_that_the_log_lacks_are_locked_and_others_left_out() {
    let header = "t,arm_joint.position,lift_pos,wheel.position,arm_joint.effort,lift_effort,wheel.effort";
    let proposal = proposed_from(&[("log.csv", header)], request(), LIFT).unwrap();
    let locked: Vec<_> = proposal.locks.iter().map(|lock| (lock.joint.as_str(), lock.value)).collect();
    assert_eq!(
        (locked, proposal.unused.join(" ")),
        (vec![("head_joint", 0.0)], "wheel.position wheel.effort".to_owned())
    );
    let (_, position) = &proposal.recordings[0].channels[0];
    assert_eq!(position.columns, ["lift_pos", "arm_joint.position"]);
    let text = proposal.text();
    assert!(text.contains(r#"unit = ["m", "rad"]"#) && text.contains(r#"unit = ["N", "N m"]"#), "{text}");
    let experiment = super::super::Experiment::from_texts(Path::new("e.toml"), text, LIFT.to_owned()).unwrap();
    assert_eq!((experiment.robot.coordinate_count(), experiment.robot.locked.len()), (2, 1));
}

#[test]
fn a_joint_that_moves_without_a_torque_is_refused() {
    let header = "t,arm_joint.position,lift_joint.position,head_joint.position,arm_joint.effort,lift_joint.effort";
    let error = proposed_from(&[("log.csv", header)], request(), LIFT).unwrap_err();
    assert!(matches!(&error, ProposalError::MovesWithoutTorque { joint, .. } if joint == "head_joint"), "{error}");
}

#[test]
fn joints_may_be_named_where_columns_are_not() {
    let named = ProposalRequest { joints: vec!["lift_joint".into(), "arm_joint".into()], ..request() };
    let proposal = proposed_from(&[("log.csv", "t,q1,q2,tau1,tau2")], named, LIFT).unwrap();
    assert_eq!(proposal.locks.len(), 1);
    let error = proposed_from(&[("log.csv", "t,q1,q2,tau1,tau2")], request(), LIFT).unwrap_err();
    assert!(matches!(error, ProposalError::UnclearColumns { signal: "position", joints: 3, .. }), "{error}");
    let wrong = ProposalRequest { joints: vec!["arm".into()], ..request() };
    let message = proposed_from(&[("log.csv", "t,q1,q2,tau1,tau2")], wrong, LIFT).unwrap_err().to_string();
    assert_eq!(message, "joints arm: expected joints of the robot, in its order: lift_joint,arm_joint,head_joint");
}

/// What is stated of side and window stands in the file, also where the range would suggest another side.
#[test]
fn side_and_window_may_be_stated() {
    let header = "t,q1,q2,tau1,tau2";
    let stated = ProposalRequest { side: Some(Side::Motor), window_s: [Some(0.05), Some(0.25)], ..request() };
    let geared = format!("{ARM}[transmission]\nmatrix = [[40, 0], [0, 50]]\n");
    let text = proposed_from(&[("log.csv", header)], stated, &geared).unwrap().text();
    assert_eq!(text.matches("side = \"motor\"").count(), 2, "{text}");
    let experiment = super::super::Experiment::from_texts(Path::new("e.toml"), text, geared).unwrap();
    let signal = &experiment.settings.signal;
    assert_eq!((signal.window_start_s, signal.window_end_s), (Some(0.05), Some(0.25)));
}

#[test]
fn a_stated_joint_side_makes_large_angles_degrees() {
    let geared = format!("{ARM}[transmission]\nmatrix = [[40, 0], [0, 50]]\n");
    let folder = thetahat_testing::Folder::new();
    let row = |k: usize| format!("{},{},{},1,2\n", 1e-3 * k as f64, 60.0 * (0.1 * k as f64).sin(), 0.3 * k as f64);
    folder.write("log.csv", format!("t,q1,q2,tau1,tau2\n{}", (0..300).map(row).collect::<String>()));
    let contents = [inspect_with_time(&folder.at("log.csv"), None).unwrap()];
    let robot = RobotSource::from_text(geared, Path::new("arm.toml")).unwrap();
    let stated = ProposalRequest { side: Some(Side::Joint), ..request() };
    let text = propose(&stated, &robot, &contents).unwrap().text();
    assert!(text.contains("unit = \"deg\" }") && !text.contains("motor"), "{text}");
}

/// The log has columns of all joints; those of the locked one are left out, named by joints, by numbers, or in a matrix.
#[test]
fn a_joint_may_be_locked_that_the_log_has() {
    let locked = || ProposalRequest { locked: [("head_joint".to_owned(), 0.2)].into(), ..request() };
    let headers = [
        "t,lift_joint.position,arm_joint.position,head_joint.position,lift_joint.effort,arm_joint.effort,head_joint.effort",
        "t,q1,q2,q3,tau1,tau2,tau3",
    ];
    for header in headers {
        let proposal = proposed_from(&[("log.csv", header)], locked(), LIFT).unwrap();
        assert_eq!(proposal.locks[0], ProposedLock { joint: "head_joint".into(), value: 0.2, why: "as stated".into() });
        for (signal, channels) in &proposal.recordings[0].channels {
            assert_eq!(channels.columns.len(), 2, "{signal} {header}");
        }
        let experiment =
            super::super::Experiment::from_texts(Path::new("e.toml"), proposal.text(), LIFT.to_owned()).unwrap();
        assert_eq!(experiment.robot.coordinate_count(), 2);
    }
    let named = ProposalRequest { torque: vec!["c1".into(), "c2".into(), "c3".into()], ..locked() };
    let proposal = proposed_from(&[("log.csv", "t,q1,q2,q3,c1,c2,c3")], named, LIFT).unwrap();
    assert_eq!(proposal.recordings[0].channels[1].1.columns, ["c1", "c2"]);
}

#[test]
fn a_lock_of_no_joint_or_of_a_named_one_is_refused() {
    let locked = |joint: &str| ProposalRequest { locked: [(joint.to_owned(), 0.0)].into(), ..request() };
    let error = proposed_from(&[("log.csv", "t,q1,q2,tau1,tau2")], locked("elbow"), LIFT).unwrap_err();
    assert!(matches!(&error, ProposalError::NoSuchJoint { joint, .. } if joint == "elbow"), "{error}");
    let both = ProposalRequest { joints: vec!["arm_joint".into()], ..locked("arm_joint") };
    let error = proposed_from(&[("log.csv", "t,q1,tau1")], both, LIFT).unwrap_err();
    assert!(matches!(&error, ProposalError::LockedAndNamed { joint } if joint == "arm_joint"), "{error}");
}

#[test]
fn guesses_are_listed() {
    let proposal = proposed_from(&[("log.csv", "t,q1,q2,tau1,tau2")], request(), ARM).unwrap();
    let guesses = proposal.guesses();
    assert!(
        guesses.len() == 2 && guesses[0].starts_with("position: ") && guesses[1].contains("we assumed N m"),
        "{guesses:?}"
    );
    let stated = ProposalRequest {
        position_unit: Some(Unit::Radian.into()),
        torque_unit: Some(Unit::NewtonMetre.into()),
        ..request()
    };
    assert!(proposed_from(&[("log.csv", "t,q1,q2,tau1,tau2")], stated, ARM).unwrap().guesses().is_empty());
}

/// Half a sample a second is no rate of a moving robot: the times are in ms, whatever their name says.
#[test]
fn a_unit_in_the_name_of_a_time_that_cannot_be_is_a_guess() {
    let proposal = proposed_from(&[("log.csv", "time_s,q1,q2,tau1,tau2")], request(), ARM).unwrap();
    let [time, ..] = &proposal.guesses()[..] else { panic!("no guess") };
    assert!(time.starts_with("time: we assumed ms (the name says s, by which the rate is 0.500 Hz)"), "{time}");
    assert!((proposal.recordings[0].clock.rate_hz - 500.0).abs() < 1e-9);
}

/// Times that count by one may be ms, or samples.
#[test]
fn the_unit_of_times_that_count_is_a_guess() {
    let guesses = |header: &str| proposed_from(&[("log.csv", header)], request(), ARM).unwrap().guesses();
    let [time, ..] = &guesses("time,q1,q2,tau1,tau2")[..] else { panic!("no guess") };
    assert!(time.starts_with("time: we assumed ms (the times count by one; if they count samples"), "{time}");
    assert!(!guesses("t,q1,q2,tau1,tau2")[0].starts_with("time"));
}

const SCARA: &str = "name = 'scara'\n[[joint]]\nname = 'a'\nkind = 'revolute'\n[[joint]]\nname = 'b'\nkind = 'prismatic'\n\
                     [[joint]]\nname = 'c'\nkind = 'revolute'\n";

/// The unit of a signal as it is proposed for one file with this first line.
fn unit_of(signal: &str, header: &str, robot: &str) -> Vec<Unit> {
    let proposal = proposed_from(&[("log.csv", header)], request(), robot).unwrap();
    let channels = &proposal.recordings[0].channels;
    channels.iter().find(|(name, _)| *name == signal).map(|(_, c)| c.unit.given().to_vec()).unwrap()
}

/// Each joint has the unit of its own column, whatever that of the first is.
#[test]
fn units_are_read_of_each_column() {
    let header = "t,q1 [deg],q2 [mm],q3 [rad],dq1 [deg/s],dq2 [m/s],dq3 [rpm],tau1 [mNm],tau2 [kN],tau3 [Nm]";
    assert_eq!(unit_of("position", header, SCARA), [Unit::Degree, Unit::Millimetre, Unit::Radian]);
    assert_eq!(unit_of("torque", header, SCARA), [Unit::MillinewtonMetre, Unit::Kilonewton, Unit::NewtonMetre]);
    let velocity = [Unit::DegreePerSecond, Unit::MetrePerSecond, Unit::RevolutionPerMinute];
    assert_eq!(unit_of("velocity", header, SCARA), velocity);
    let header = "t,q1 [deg],q2 [mm],q3 [deg],q1_ref [rad],q2_ref [mm],q3_ref [rad],tau1,tau2,tau3";
    assert_eq!(unit_of("position", header, SCARA), [Unit::Degree, Unit::Millimetre, Unit::Degree]);
    assert_eq!(unit_of("reference", header, SCARA), [Unit::Radian, Unit::Millimetre, Unit::Radian]);
    assert_eq!(
        unit_of("position", "t,q1 [deg],q2,q3 [deg],tau1,tau2,tau3", SCARA),
        [Unit::Degree, Unit::Metre, Unit::Degree]
    );
}

#[test]
fn a_unit_that_was_filled_is_a_guess() {
    let proposal = |header| proposed_from(&[("log.csv", header)], request(), SCARA).unwrap();
    let filled = proposal("t,q1 [deg],q2,q3 [deg],tau1 [Nm],tau2 [N],tau3 [Nm]").guesses();
    assert!(matches!(&filled[..], [one] if one.contains("a guess where they have none")), "{filled:?}");
    let named = proposal("t,q1 [deg],q2 [mm],q3 [deg],tau1 [Nm],tau2 [N],tau3 [Nm]").guesses();
    assert!(named.is_empty(), "{named:?}");
}

/// A stated unit is that of the joints that have such; the others keep the one in their names.
#[test]
fn a_stated_unit_leaves_joints_of_the_other_kind_theirs() {
    let stated = ProposalRequest { position_unit: Some(Unit::Radian.into()), ..request() };
    let header = "t,q1 [deg],q2 [mm],q3 [deg],tau1,tau2,tau3";
    let proposal = proposed_from(&[("log.csv", header)], stated, SCARA).unwrap();
    let units = proposal.recordings[0].channels[0].1.unit.given();
    assert_eq!(units, [Unit::Radian, Unit::Millimetre, Unit::Radian]);
}

#[test]
fn a_unit_that_is_none_is_refused_and_not_replaced() {
    let error = |header| proposed_from(&[("log.csv", header)], request(), SCARA).unwrap_err().to_string();
    assert_eq!(
        error("t,q1,q2,q3,tau1 [Nm],tau2 [N],tau3 [Nm/rad]"),
        "log.csv: column \"tau3 [Nm/rad]\" is written in \"Nm/rad\", which is no unit of a torque that thetahat knows"
    );
    assert_eq!(
        error("t,q1 [deg],q2 [deg],q3 [deg],tau1,tau2,tau3"),
        "log.csv: column \"q2 [deg]\" is written in deg, an angle, and joint `b` slides"
    );
    assert!(error("t,q1,q2 [A],q3,tau1,tau2,tau3").contains("\"A\", which is no unit of a position"));
    let stated = ProposalRequest { torque_unit: Some(Unit::NewtonMetre.into()), ..request() };
    assert!(proposed_from(&[("log.csv", "t,q1,q2,q3,tau1,tau2,tau3 [Nm/rad]")], stated, SCARA).is_ok());
    let text = proposed("t,q1,q2,dq1 [g],dq2 [g],tau1,tau2", request()).unwrap();
    assert!(text.contains("\n# velocity = {") && text.contains("is written in \"g\""), "{text}");
}

/// What no unit turns into torques or positions has a gain to be filled in, and the next command asks for it by its name.
#[test]
fn a_gain_is_asked_for_where_a_unit_is_no_torque() {
    for (columns, unit, asked, per) in [
        ("tau1 [%],tau2 [%]", "%", "written in %, which is no torque", "the torque at the joint at 100 %"),
        ("current_1,current_2", "A", "written in A, which is no torque", "the torque at the joint per A"),
        ("tau1 [mA],tau2 [mA]", "mA", "written in mA, which is no torque", "the torque at the joint per A"),
        ("tau1 [inc],tau2 [inc]", "1", "written in inc, which is no torque", "the torque at the joint per count"),
    ] {
        let header = format!("t,q1,q2,{columns}");
        let proposal = proposed_from(&[("log.csv", &header)], request(), ARM).unwrap();
        assert!(matches!(&proposal.to_fill_in()[..], [one] if one.contains(asked) && one.contains(per)), "{columns}");
        let text = proposal.text();
        assert!(text.contains(&format!("unit = \"{unit}\", gain = [] }}")) && text.contains(asked), "{text}");
        let folder = thetahat_testing::Folder::new();
        folder.write("log.csv", format!("{header}\n0,1,2,3,4\n0.001,1,2,3,4\n0.002,1,2,3,4\n"));
        let read = |text| super::super::Experiment::from_texts(Path::new("e.toml"), text, ARM.to_owned()).unwrap();
        let error = read(text.clone()).recordings(folder.path()).unwrap_err().to_string();
        assert!(
            error.contains("gain = []") && error.contains(&format!("a number for each channel, 2 in all: {per}")),
            "{error}"
        );
        assert!(read(text.replace("gain = []", "gain = [10, 20]")).recordings(folder.path()).is_ok());
    }
    let positions = proposed("t,q1 [counts],q2 [counts],tau1,tau2", request()).unwrap();
    assert!(positions.contains("unit = \"rad\", gain = [] }") && positions.contains("rad (m of"), "{positions}");
}

/// Files of torques are called currents too: their name alone asks for no gain, and says how to give one.
#[test]
fn the_name_of_a_file_alone_makes_no_current() {
    let files = [("pos_data.csv", "Joint_1,Joint_2"), ("curr_data.csv", "Joint_1,Joint_2")];
    let at_a_rate = ProposalRequest { sample_rate_hz: Some(1000.0), ..request() };
    let proposal = proposed_from(&files, at_a_rate, ARM).unwrap();
    assert!(proposal.to_fill_in().is_empty());
    let guess =
        "a guess: only the name of the file says a current; where they are in A, write unit = \"A\" and gain = [...]";
    assert!(proposal.text().contains(guess) && proposal.text().contains("unit = \"N m\""), "{}", proposal.text());
}

/// At the motors the robot's drive gains turn currents into torques, and no other gain is needed.
#[test]
fn drive_gains_of_the_robot_are_the_gains_of_currents() {
    let geared = |gains: &str| format!("{ARM}[transmission]\nmatrix = [[40, 0], [0, 50]]\n{gains}");
    let side = || ProposalRequest { side: Some(Side::Motor), ..request() };
    let to_fill_in = |robot: &str| {
        proposed_from(&[("log.csv", "t,q1,q2,i_curr_1,i_curr_2")], side(), robot).unwrap().to_fill_in().join(" ")
    };
    assert_eq!(to_fill_in(&geared("drive_gain = [0.1, 0.2]\n")), "");
    assert!(to_fill_in(&geared("")).contains("the torque of the motor per A"), "{}", to_fill_in(&geared("")));
}

/// The columns of a signal as they are proposed for one file with this first line.
fn columns_of(signal: &str, header: &str) -> Vec<String> {
    let proposal = proposed_from(&[("log.csv", header)], request(), ARM).unwrap();
    let channels = &proposal.recordings[0].channels;
    channels.iter().find(|(name, _)| *name == signal).map(|(_, c)| c.columns.clone()).unwrap_or_default()
}

/// The names of a Franka log: what ends with `d` is desired, and the measured values are taken.
#[test]
fn desired_values_are_separate_from_measured_ones() {
    let header = "t,q_0,q_1,dq_0,dq_1,tau_J_0,tau_J_1,tau_J_d_0,tau_J_d_1,q_d_0,q_d_1,control_command_success_rate";
    assert_eq!(columns_of("position", header), ["q_0", "q_1"]);
    assert_eq!(columns_of("torque", header), ["tau_J_0", "tau_J_1"]);
    assert_eq!(columns_of("reference", header), ["q_d_0", "q_d_1"]);
}

#[test]
fn references_are_known_by_words_for_wanted_values() {
    for reference in ["q_des", "q_soll", "Soll J", "joint_command"] {
        let header = format!("t,q1,q2,{reference}1,{reference}2,tau1,tau2");
        assert_eq!(columns_of("reference", &header), [format!("{reference}1"), format!("{reference}2")]);
    }
}

#[test]
fn a_file_of_commands_is_the_reference_and_unused_columns_are_listed() {
    let files = [
        ("left_positions.csv", "t,a,b"),
        ("left_efforts.csv", "t,a,b"),
        ("left_command.csv", "t,a,b"),
        ("left_temperature.csv", "t,a,b"),
    ];
    let proposal = proposed_from(&files, request(), ARM).unwrap();
    let reference = &proposal.recordings[0].channels[2];
    assert_eq!((reference.0, reference.1.file.to_str()), ("reference", Some("left_command.csv")));
    assert!(
        proposal.guesses().iter().any(|guess| guess.contains("but not of which signal")),
        "{:?}",
        proposal.guesses()
    );
    let expected = "Not used, as no signal of a joint that is identified: left_temperature.csv.";
    assert_eq!(proposal.not_used(), [expected]);
    assert!(proposal.text().contains(&format!("\n# {expected}\n")));
}

/// Files whose columns have the names of joints alone, and not of all.
#[test]
fn joints_are_found_by_columns_whose_file_names_the_signal() {
    let files = [("positions.csv", "t,lift_joint,arm_joint"), ("efforts.csv", "t,lift_joint,arm_joint")];
    let proposal = proposed_from(&files, request(), LIFT).unwrap();
    assert_eq!(proposal.locks.iter().map(|lock| lock.joint.as_str()).collect::<Vec<_>>(), ["head_joint"]);
    assert_eq!(proposal.recordings[0].channels[1].1.columns, ["lift_joint", "arm_joint"]);
}

/// Positions and commands without torques are for CLOE, with the gains that are stated, or to be filled in.
#[test]
fn a_log_without_torques_is_for_cloe() {
    let header = "t,q1,q2,q1_des,q2_des,des_torque_1,des_torque_2";
    let stated = ProposalRequest { position_gain: vec![60.0], velocity_gain: vec![2.0, 3.0], ..request() };
    let text = proposed(header, stated).unwrap();
    let experiment = super::super::Experiment::from_texts(Path::new("e.toml"), text.clone(), ARM.to_owned()).unwrap();
    assert!(experiment.file.recording[0].torque.is_none() && text.contains("methods = [\"cloe\"]"), "{text}");
    assert!(text.contains("position_gain = 60\n") && text.contains("velocity_gain = [2, 3]\n"), "{text}");
    assert!(text.contains("des_torque_1 des_torque_2: desired torques"), "{text}");
    let open = proposed_from(&[("log.csv", header)], request(), ARM).unwrap();
    let open = open.with_chosen_filter(ARM.to_owned(), Path::new("."), 1).unwrap();
    assert!(open.to_fill_in().join(" ").contains("Fill in position_gain"), "{:?}", open.to_fill_in());
    let error = proposed("t,q1,q2,target_moment_1,target_moment_2", request()).unwrap_err().to_string();
    assert!(error.contains("target_moment_1 target_moment_2 hold desired torques"), "{error}");
}

/// Gains of the torques, methods and a controller that are stated stand in the text, and it is an experiment.
#[test]
fn what_is_stated_of_the_estimation_is_written() {
    let stated = ProposalRequest {
        torque_gain: vec![0.5, 0.25],
        methods: vec![Method::IDIM_WLS, Method::DIDIM],
        position_gain: vec![60.0],
        velocity_gain: vec![2.0, 3.0],
        ..request()
    };
    let header = "t,q1,q2,i1 [A],i2 [A]";
    let text = proposed(header, ProposalRequest { torque: vec!["i1 [A]".into(), "i2 [A]".into()], ..stated }).unwrap();
    let experiment = super::super::Experiment::from_texts(Path::new("e.toml"), text.clone(), ARM.to_owned()).unwrap();
    assert_eq!(experiment.settings.estimation.methods, [Method::IDIM_WLS, Method::DIDIM]);
    assert!(text.contains("gain = [0.5, 0.25]") && !text.contains("Fill in"), "{text}");
    assert!(text.contains("[controller]\nlaw = \"pd\"\nposition_gain = 60\nvelocity_gain = [2, 3]\n"), "{text}");
    let half = ProposalRequest { position_gain: vec![60.0], ..request() };
    let half = proposed_from(&[("log.csv", "t,q1,q2,tau1,tau2")], half, ARM).unwrap();
    assert!(half.to_fill_in().join(" ").contains("both gains"), "{:?}", half.to_fill_in());
}

/// Links are taken as described where the description gives them.
#[test]
fn without_torques_described_links_are_not_estimated() {
    let header = "t,q1,q2,q1_des,q2_des";
    let text = |robot: &str| {
        let stated = ProposalRequest { position_gain: vec![60.0], velocity_gain: vec![2.0], ..request() };
        proposed_from(&[("log.csv", header)], stated, robot).unwrap().text()
    };
    let link = |j: usize| format!("m{j} = 2\nxx{j} = 0.1\nyy{j} = 0.1\nzz{j} = 0.1\n");
    let described = format!("{ARM}[parameters]\n{}{}", link(1), link(2));
    assert!(text(&described).contains("[parameters]\nestimate = \"drives\"\n"), "{}", text(&described));
    assert!(!text(ARM).contains("drives"), "{}", text(ARM));
}

/// A torque whose unit the log does not say is a guess where the description has no masses that would contradict it.
#[test]
fn the_unit_of_a_torque_is_a_guess_without_masses() {
    let torque = |header: &str, robot: &str| {
        let text = proposed_from(&[("log.csv", header)], request(), robot).unwrap().text();
        text.lines().find(|line| line.starts_with("torque")).unwrap().to_owned()
    };
    let described = format!("{ARM}[parameters]\nm1 = 2\nxx1 = 0.1\nyy1 = 0.1\nzz1 = 0.1\n");
    assert!(torque("t,q1,q2,tau1,tau2", ARM).contains("unit_guessed = true"));
    assert!(!torque("t,q1,q2,tau1_Nm,tau2_Nm", ARM).contains("unit_guessed"));
    assert!(!torque("t,q1,q2,tau1,tau2", &described).contains("unit_guessed"));
}

/// The name of a file is no unit, and drive signals are no torques where the robot has drive gains.
#[test]
fn drive_signals_and_names_of_files_are_not_taken_for_torques() {
    let driven = format!("{ARM}[transmission]\nmatrix = [[1, 0], [0, 1]]\ndrive_gain = [35, 20]\n");
    let text = |header: &str| proposed_from(&[("log.csv", header)], request(), &driven).unwrap().text();
    assert!(text("t,q1,q2,vir1,vir2").contains("unit = \"V\", side = \"motor\""), "{}", text("t,q1,q2,vir1,vir2"));
    assert!(text("t,q1,q2,u1,u2").contains("unit = \"V\", side = \"motor\""), "{}", text("t,q1,q2,u1,u2"));
    assert!(
        text("t,q1,q2,tau1,tau2").contains("unit = \"N m\", unit_guessed = true }"),
        "{}",
        text("t,q1,q2,tau1,tau2")
    );
    let files = [("q_deg.csv", "t,a,b"), ("tau_mNm.csv", "a,b")];
    let text = proposed_from(&files, request(), ARM).unwrap().text();
    assert!(text.contains("unit = \"rad\"") && text.contains("the name of the file says deg"), "{text}");
    assert!(text.contains("unit = \"N m\"") && text.contains("only the name of the file says mN m"), "{text}");
}

/// Positions that a name says to be of motors, in the range of the joints, are of joints.
#[test]
fn the_side_is_that_of_the_values() {
    let geared = format!("{ARM}[transmission]\nmatrix = [[100, 0], [0, 100]]\n");
    let text = proposed_from(&[("log.csv", "t,mot_pos_1,mot_pos_2,tau1,tau2")], request(), &geared).unwrap().text();
    assert!(!text.contains("side = \"motor\""), "{text}");
}

/// The first columns of positions, torques and references of a log with this first line.
fn picked(header: &str) -> [Option<String>; 3] {
    let proposal = proposed_from(&[("log.csv", header)], request(), ARM).unwrap();
    let channels = &proposal.recordings[0].channels;
    let first = |signal: &str| channels.iter().find(|(name, _)| *name == signal).map(|(_, c)| c.columns[0].clone());
    ["position", "torque", "reference"].map(first)
}

#[test]
fn columns_next_to_the_measurement_are_set_aside() {
    let two = |names: &[&str]| {
        let each = names.iter().flat_map(|name| [1, 2].map(|number| name.replace('#', &number.to_string())));
        format!("t,{}", each.collect::<Vec<_>>().join(","))
    };
    for (names, position, torque) in [
        (&["q_#", "q_des_#", "tau_#", "tau_ext_#"][..], "q_1", "tau_1"),
        (&["q_#", "measured_torque_#", "external_torque_#"], "q_1", "measured_torque_1"),
        (&["q_#", "q_min_#", "q_max_#", "tau_#", "tau_max_#"], "q_1", "tau_1"),
        (&["q_#", "q_error_#", "q_std_#", "tau_#", "tau_std_#"], "q_1", "tau_1"),
        (&["q_#", "torque_#", "current_#", "voltage_#"], "q_1", "torque_1"),
        (&["q_#", "current_#", "voltage_#"], "q_1", "current_1"),
        (&["pos_#", "pos_raw_#", "effort_#", "effort_raw_#"], "pos_1", "effort_1"),
        (&["q_raw_#", "q_filtered_#", "tau_#"], "q_raw_1", "tau_1"),
        (&["x_#", "q_#", "tau_#", "tau_model_#", "tau_friction_#"], "q_1", "tau_1"),
    ] {
        let found = picked(&two(names));
        assert_eq!((found[0].as_deref(), found[1].as_deref()), (Some(position), Some(torque)), "{names:?}");
    }
}

/// The shorter names of commands hold those of the joints as well.
#[test]
fn the_state_is_the_position_and_the_action_its_reference() {
    let header = "t,action.a.pos,action.b.pos,observation.state.a.pos,observation.state.b.pos,a.effort,b.effort";
    let [position, _, reference] = picked(header);
    assert_eq!(position.as_deref(), Some("observation.state.a.pos"));
    assert_eq!(reference.as_deref(), Some("action.a.pos"));
}

#[test]
fn what_is_set_aside_is_said() {
    let header = "t,q_1,q_2,tau_1,tau_2,tau_ext_1,tau_ext_2";
    let proposal = proposed_from(&[("log.csv", header)], request(), ARM).unwrap();
    let said = "Not used, as external torques, without those of the robot's own dynamics: tau_ext_1 tau_ext_2.";
    assert_eq!(proposal.not_used(), [said]);
    assert!(proposal.text().contains(&format!("\n# {said}\n")));
    let alone = proposed_from(&[("log.csv", "t,q_1,q_2,tau_ext_1,tau_ext_2")], request(), ARM).unwrap();
    assert!(alone.guesses().iter().any(|guess| guess.contains("The names say external torques")));
}

/// A word that a joint's name has sets no column aside.
#[test]
fn a_joint_s_name_is_none_of_a_kind() {
    let robot = ARM.replace("'a'", "'finger_ext'").replace("'b'", "'thumb_ext'");
    let header = "t,finger_ext.pos,thumb_ext.pos,finger_ext.tau,thumb_ext.tau,wrist.tau,palm.tau";
    let proposal = proposed_from(&[("log.csv", header)], request(), &robot).unwrap();
    assert_eq!(proposal.recordings[0].channels[1].1.columns, ["finger_ext.tau", "thumb_ext.tau"]);
}

/// A log whose torques are not clear has torques: it is none of positions and commands.
#[test]
fn torques_that_are_not_clear_are_asked_for() {
    let error = proposed("t,q1,q2,q1_ref,q2_ref,tau_a1,tau_a2,tau_b1,tau_b2", request()).unwrap_err();
    assert!(matches!(error, ProposalError::UnclearColumns { signal: "torque", .. }), "{error}");
    assert!(error.to_string().contains("4 columns look like it"), "{error}");
}

#[test]
fn a_group_of_columns_is_named_by_what_their_names_begin_with() {
    let named = ProposalRequest { position: vec!["state".into()], torque: vec!["cur".into()], ..request() };
    let proposal = proposed_from(&[("log.csv", "t,cmd.b,cmd.a,state.b,state.a,cur1,cur2")], named, ARM).unwrap();
    let columns = |n: usize| proposal.recordings[0].channels[n].1.columns.clone();
    assert_eq!(
        (columns(0), columns(1)),
        (vec!["state.a".into(), "state.b".into()], vec!["cur1".into(), "cur2".into()])
    );
    let other = ProposalRequest { position: vec!["stat".into()], ..request() };
    let error = proposed("t,state.a,state.b,tau1,tau2", other).unwrap_err();
    assert!(matches!(error, ProposalError::NoSuchColumn { .. }), "{error}");
}

/// The file takes a list of units, and so does the request.
#[test]
fn units_may_be_stated_for_each_joint() {
    let header = "t,q1,q2,q3,tau1,tau2,tau3";
    let stated = |units: Vec<Unit>| ProposalRequest { position_unit: Some(OneOrEach::Each(units)), ..request() };
    let of_each = vec![Unit::Degree, Unit::Millimetre, Unit::Radian];
    let proposal = proposed_from(&[("log.csv", header)], stated(of_each.clone()), SCARA).unwrap();
    assert_eq!(proposal.recordings[0].channels[0].1.unit, OneOrEach::Each(of_each));
    let error = proposed_from(&[("log.csv", header)], stated(vec![Unit::Degree; 2]), SCARA).unwrap_err();
    assert_eq!(
        error.to_string(),
        "2 units are stated for the position; expected one for all, or one for each of 3 joints"
    );
}

/// An array of motors of which not all are connected.
#[test]
fn motors_that_are_always_zero_are_left_out() {
    let folder = thetahat_testing::Folder::new();
    let row = |k: usize| {
        let [a, b] = [0.1, 0.13].map(|w: f64| (w * k as f64).sin());
        format!("{},{a},{b},0,{b},{a},0\n", 1e-3 * k as f64)
    };
    let header = "t,m[0].q,m[1].q,m[2].q,m[0].tau,m[1].tau,m[2].tau\n";
    folder.write("log.csv", header.to_owned() + &(0..300).map(row).collect::<String>());
    let contents = [inspect_with_time(&folder.at("log.csv"), None).unwrap()];
    let robot = RobotSource::from_text(ARM.to_owned(), Path::new("arm.toml")).unwrap();
    let proposal = propose(&request(), &robot, &contents).unwrap();
    assert_eq!(proposal.recordings[0].channels[0].1.columns, ["m[0].q", "m[1].q"]);
}

/// Two takes in one file have no clock.
#[test]
fn times_that_start_again_are_two_recordings() {
    let folder = thetahat_testing::Folder::new();
    let row = |k: usize| format!("{},{q},{q},{q},{q}\n", 1e-3 * (k % 300) as f64, q = (0.1 * k as f64).sin());
    folder.write("log.csv", "t,q1,q2,tau1,tau2\n".to_owned() + &(0..600).map(row).collect::<String>());
    let contents = [inspect_with_time(&folder.at("log.csv"), None).unwrap()];
    let robot = RobotSource::from_text(ARM.to_owned(), Path::new("arm.toml")).unwrap();
    let error = propose(&request(), &robot, &contents).unwrap_err();
    assert!(
        error.to_string().contains("start again at sample 300 counted from 0: these are two recordings"),
        "{error}"
    );
}

#[test]
fn a_driver_that_has_the_names_of_a_log_is_named() {
    let of = |signal: &str| (0..2).map(|j| format!("{signal}_{j}")).collect::<Vec<_>>().join(",");
    let header = ["q", "q_d", "tau_J", "tau_J_d", "theta", "tau_ext_hat_filtered"].map(of).join(",");
    let proposal = proposed_from(&[("log.csv", &format!("t,{header}"))], request(), ARM).unwrap();
    assert_eq!(proposal.recordings[0].channels[0].1.columns, ["q_0", "q_1"]);
    assert!(proposal.of_driver().iter().any(|line| line.contains("--from franka")), "{:?}", proposal.of_driver());
    let unclear = header.replace("theta", "pos");
    let error = proposed(&format!("t,{unclear}"), request()).unwrap_err().to_string();
    assert!(error.contains("--from franka"), "{error}");
}

/// Values of encoders by which joints with limits would turn without end, in rad and in deg.
#[test]
fn a_gain_is_asked_for_where_joints_with_limits_would_turn_many_times() {
    let text = "<robot name='arm'><link name='base'/><link name='upper'/>\
                <joint name='a' type='revolute'><parent link='base'/><child link='upper'/><axis xyz='0 0 1'/>\
                <limit lower='-2' upper='2' effort='9' velocity='9'/></joint></robot>";
    let robot = RobotSource::from_text(text.to_owned(), Path::new("arm.urdf")).unwrap();
    let to_fill_in = |counts_per_rad: f64| {
        let wave = |k: usize| (0.1 * k as f64).sin();
        let row = |k: usize| format!("{},{},{}\n", k as f64 * 1e-3, (counts_per_rad * wave(k)).round(), wave(k + 5));
        let folder = thetahat_testing::Folder::new();
        folder.write("log.csv", format!("t,q1,tau1\n{}", (0..300).map(row).collect::<String>()));
        let contents = inspect_with_time(&folder.at("log.csv"), None).unwrap();
        propose(&request(), &robot, &[contents]).unwrap().to_fill_in().join(" ")
    };
    assert!(to_fill_in(83_443.0).contains("The position is written in counts"), "{}", to_fill_in(83_443.0));
    assert_eq!(to_fill_in(57.3), "");
}

/// A bag with two topics of arrays without names, of 300 samples and of this many.
fn proposed_from_topics(names: [&str; 2], samples: usize, request: ProposalRequest) -> Result<String, ProposalError> {
    let folder = thetahat_testing::Folder::new();
    let topic = |name: &str, samples: usize| {
        let row = |k: usize| format!("{},{},{}\n", k as f64 * 1e-3, (0.1 * k as f64).sin(), (0.13 * k as f64).cos());
        folder.write("log.csv", format!("t,data[0],data[1]\n{}", (0..samples).map(row).collect::<String>()));
        let mut contents = inspect_with_time(&folder.at("log.csv"), None).unwrap();
        contents.tables[0].name = name.to_owned();
        contents
    };
    let (mut bag, other) = (topic(names[0], 300), topic(names[1], samples));
    bag.tables.extend(other.tables);
    bag.format = Format::Ros1;
    let robot = RobotSource::from_text(ARM.to_owned(), Path::new("arm.toml")).unwrap();
    propose(&ProposalRequest { recording_files: vec!["run.bag".into()], ..request }, &robot, &[bag]).map(|p| p.text())
}

#[test]
fn topics_hold_one_signal_each() {
    let by_name = proposed_from_topics(["/arm/meas_q", "/arm/meas_tau"], 300, request()).unwrap();
    let columns = r#"columns = ["data[0]", "data[1]"]"#;
    for (signal, topic) in [("position", "/arm/meas_q"), ("torque", "/arm/meas_tau")] {
        let line = format!(r#"{signal} = {{ file = "run.bag", topic = "{topic}", {columns}"#);
        assert!(by_name.contains(&line), "{by_name}");
    }
    let (position, torque) = (vec!["/a".to_owned()], vec!["/b:data".to_owned()]);
    let named = proposed_from_topics(["/a", "/b"], 300, ProposalRequest { position, torque, ..request() }).unwrap();
    assert_eq!(by_name.replace("/arm/meas_q", "/a").replace("/arm/meas_tau", "/b"), named);
    let unclear = proposed_from_topics(["/a", "/b"], 300, request()).unwrap_err();
    assert!(matches!(unclear, ProposalError::UnclearColumns { .. }), "{unclear}");
    let commanded = proposed_from_topics(["/arm/meas_q", "/effort_controller/commands"], 300, request()).unwrap_err();
    assert!(matches!(commanded, ProposalError::UnclearColumns { .. }), "{commanded}");
    let error = proposed_from_topics(["/arm/meas_q", "/arm/meas_tau"], 299, request()).unwrap_err().to_string();
    let said = "run.bag, topic /arm/meas_q has 300 samples, run.bag, topic /arm/meas_tau has 299";
    assert!(error.contains(said), "{error}");
}

#[test]
fn columns_that_say_a_unit_and_nothing_else_are_what_it_measures() {
    let text = proposed("t,a_deg,b_deg,a_kNm,b_kNm", request()).unwrap();
    assert!(text.contains(r#"columns = ["a_deg", "b_deg"], unit = "deg""#), "{text}");
    assert!(text.contains(r#"columns = ["a_kNm", "b_kNm"], unit = "kN m""#), "{text}");
    let error = proposed("t,a_deg,b_deg,a_A,b_A", request()).unwrap_err();
    assert!(matches!(error, ProposalError::UnclearColumns { signal: "torque", .. }), "{error}");
}

#[test]
fn a_table_with_a_line_for_each_joint_is_refused_with_what_is_expected() {
    let columns = |text: &str| ["time", "position", "effort", text].map(str::to_owned).to_vec();
    let error = |columns| ProposalError::UnclearColumns {
        file: "log.csv".into(),
        signal: "position",
        problem: "1 column looks like it (position)".to_owned(),
        joints: 2,
        columns,
    };
    let said = error(columns("`joint` (text, such as \"a\" in line 2)")).to_string();
    assert!(said.contains("a line for each joint") && said.contains("table.pivot(index=\"time\""), "{said}");
    let said = error(columns("`state` (a column compressed by GZIP)")).to_string();
    assert!(said.contains("to_parquet(OTHER, compression=\"zstd\")"), "{said}");
    let said = error(columns("`note` (text, such as \"ok\" in line 2)")).to_string();
    assert!(!said.contains("pandas"), "{said}");
}
