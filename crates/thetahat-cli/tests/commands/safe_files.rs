//! What `--out` never replaces, and what names cannot do to a terminal or a spreadsheet.

use std::{fs, process::Output};

use thetahat_testing::{Folder, project, refused, run, shown, succeeded};

const PROGRAM: &str = env!("CARGO_BIN_EXE_thetahat");

const ROBOT: &str = "name = \"slider\"\n[[joint]]\nname = \"slide\"\nkind = \"prismatic\"\nalpha_deg = 90\n\
                     [transmission]\nmatrix = [[1]]\n[parameters]\nm1 = 10\n";

const EXPERIMENT: &str = "title = \"a slider\"\nrobot = \"robot.toml\"\n[recording]\nsample_rate_hz = 500\n\
                          position = { file = \"record.csv\", columns = [\"q1\"], unit = \"m\" }\n\
                          torque = { file = \"record.csv\", columns = [\"tau1\"], unit = \"N\" }\n\
                          [signal]\ncutoff_hz = 50\ndecimation = 10\n\
                          [estimation]\nmethods = [\"idim-ls\"]\n";

/// Files of others.
const FOREIGN: &str = "not a file of thetahat\n";

/// 20 kg, viscous and Coulomb friction and an offset over two sines, 10 s at 500 Hz; columns `t,q1,tau1`.
fn record() -> String {
    let row = |k: usize| {
        let t = k as f64 / 500.0;
        let sum = |f: &dyn Fn(f64, f64) -> f64| f(0.2, 2.0) + f(0.1, 5.3);
        let q = sum(&|a, w| a * (w * t).sin());
        let v = sum(&|a, w| a * w * (w * t).cos());
        let a = sum(&|a, w| -a * w * w * (w * t).sin());
        format!("{t:.3},{q},{}\n", 20.0 * a + 30.0 * v + 5.0 * v.signum() + 2.0)
    };
    format!("t,q1,tau1\n{}", (0..5000).map(row).collect::<String>())
}

/// A folder with a robot, a record and an experiment.
fn case() -> Folder {
    let folder = Folder::with("robot.toml", ROBOT);
    folder.write("experiment.toml", EXPERIMENT).write("record.csv", record());
    folder
}

fn thetahat(folder: &Folder, arguments: &str) -> Output {
    run(PROGRAM, folder.path(), arguments.split(' '))
}

fn succeeds(folder: &Folder, arguments: &str) -> String {
    succeeded(&thetahat(folder, arguments))
}

/// Asserts that a command ends with an error of these words.
fn is_refused(folder: &Folder, arguments: &str, words: &[&str]) {
    let message = refused(&thetahat(folder, arguments));
    for word in words {
        assert!(message.contains(word), "{arguments}: no {word:?} in: {message}");
    }
}

/// Asserts that a command does not touch a file of others, does with `--force`, and then without it again.
fn keeps_files_of_others(folder: &Folder, command: &str, file: &str) {
    folder.write(file, FOREIGN);
    is_refused(folder, command, &[file, "exists and", "--force"]);
    assert_eq!(folder.text(file), FOREIGN, "{command}");
    succeeds(folder, &format!("{command} --force"));
    assert_ne!(folder.bytes(file), FOREIGN.as_bytes(), "{command}");
    succeeds(folder, command);
}

/// What a xacro includes, and a driver of one's own, are inputs too.
#[test]
fn what_a_description_includes_and_a_driver_are_inputs() {
    let folder = Folder::new();
    let links = |inertia: &str| format!("<robot xmlns:xacro=\"http://ros.org/wiki/xacro\">{inertia}</robot>");
    folder.write("mass.xacro", links("<xacro:property name=\"mass\" value=\"2\"/>"));
    folder.write(
        "arm.xacro",
        "<robot name=\"arm\" xmlns:xacro=\"http://ros.org/wiki/xacro\"><xacro:include filename=\"mass.xacro\"/>\
         <link name=\"base\"/><link name=\"bar\"><inertial><mass value=\"${mass}\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" \
         iyz=\"0\" izz=\"1\"/></inertial></link><joint name=\"q1\" type=\"continuous\"><parent link=\"base\"/><child link=\"bar\"/>\
         <axis xyz=\"0 1 0\"/></joint></robot>",
    );
    folder
        .write("record.csv", record())
        .write("mine.toml", "title = 'a'\neffort = 'b'\n[position]\ncolumns = ['q*']\nunit = 'rad'\n");
    for (command, input) in [
        ("model arm.xacro --expand", "mass.xacro"),
        ("generate arm.xacro --model idm --to python --out", "mass.xacro"),
        ("init --robot arm.xacro --recording record.csv --out", "mass.xacro"),
        ("init --from mine.toml --robot arm.xacro --recording record.csv --out", "mine.toml"),
    ] {
        let before = folder.text(input);
        is_refused(
            &folder,
            &format!("{command} {input} --force"),
            &[input, "is read as an input, and is not replaced"],
        );
        assert_eq!(folder.text(input), before, "{command}");
    }
}

/// A twin of the two-joint arm, and its campaign.
fn arm() -> Folder {
    let folder = Folder::new();
    for file in ["campaigns/two_joint.toml", "experiments/two_joint.toml", "robots/two_joint.toml"] {
        folder.write(file, fs::read(project(file)).unwrap());
    }
    folder
}

#[test]
fn files_of_others_are_replaced_with_force_only() {
    let folder = case();
    for file in ["results.json", "parameters.csv", "report.html"] {
        let out = format!("out_{}", file.len());
        keeps_files_of_others(&folder, &format!("identify experiment.toml --out {out}"), &format!("{out}/{file}"));
    }
    keeps_files_of_others(&folder, "reduce experiment.toml --out a.reduction", "a.reduction");
    keeps_files_of_others(&folder, "solve a.reduction --out solved", "solved/results.json");
    keeps_files_of_others(&folder, "solve a.reduction --merged merged.reduction", "merged.reduction");
    let predict = "predict out_12/results.json --recording record.csv --out predicted.csv";
    keeps_files_of_others(&folder, predict, "predicted.csv");
    keeps_files_of_others(&folder, "man --out pages", "pages/thetahat-demo.1");
}

#[test]
fn a_proposal_replaces_an_experiment_with_force_only() {
    let folder = case();
    let init = "init --robot robot.toml --recording record.csv --out experiment.toml";
    is_refused(&folder, init, &["experiment.toml", "exists and", "--force"]);
    assert_eq!(folder.text("experiment.toml"), EXPERIMENT);
    succeeds(&folder, &format!("{init} --force"));
    assert!(folder.text("experiment.toml").starts_with("# Proposed by thetahat from"));
    is_refused(&folder, init, &["exists and may contain your changes", "--force"]);
    let over = |input: &str| format!("init --robot robot.toml --recording record.csv --out {input} --force");
    is_refused(&folder, &over("record.csv"), &["record.csv", "is read as an input"]);
    is_refused(&folder, &over("robot.toml"), &["robot.toml", "is read as an input"]);
}

/// The columns of a simulated record are those of any record: ours is known by the quotes of a name.
#[test]
fn a_record_is_replaced_with_force_only() {
    let folder = arm();
    let simulate = "simulate experiments/two_joint.toml --out log.csv";
    folder.write("log.csv", "time_s,position_1,position_2,torque_1,torque_2\n0,1,2,3,4\n");
    is_refused(&folder, simulate, &["log.csv", "exists and"]);
    assert_eq!(folder.text("log.csv").lines().count(), 2);
    succeeds(&folder, &format!("{simulate} --force"));
    let text = folder.text("log.csv");
    assert!(text.starts_with("time_s,\"position_1\",position_2,torque_1,torque_2\n0,"), "{}", &text[..80]);
    succeeds(&folder, simulate);
    assert!(succeeds(&folder, "inspect log.csv").contains("time: \"time_s\" in s"));
}

#[test]
fn inputs_are_never_replaced() {
    let folder = case();
    succeeds(&folder, "identify experiment.toml --out out");
    succeeds(&folder, "reduce experiment.toml --out a.reduction");
    let reads = "is read as an input";
    for command in [
        "reduce experiment.toml --out record.csv",
        "reduce experiment.toml --out experiment.toml",
        "reduce experiment.toml --out ./sub/../robot.toml",
        "solve a.reduction --merged a.reduction",
        "predict out/results.json --recording record.csv --out record.csv",
        "predict out/results.json --recording record.csv --out out/results.json",
    ] {
        fs::create_dir_all(folder.at("sub")).unwrap();
        is_refused(&folder, &format!("{command} --force"), &[reads]);
    }
    assert_eq!(folder.text("record.csv"), record());
    assert_eq!(folder.text("experiment.toml"), EXPERIMENT);
}

#[cfg(unix)]
#[test]
fn pipes_devices_links_and_folders_stay() {
    let folder = case();
    assert!(std::process::Command::new("mkfifo").arg(folder.at("pipe")).status().unwrap().success());
    fs::create_dir(folder.at("sub")).unwrap();
    std::os::unix::fs::symlink("record.csv", folder.at("link")).unwrap();
    let reduce = |out: &str| format!("reduce experiment.toml --out {out} --force");
    is_refused(&folder, &reduce("pipe"), &["pipe", "expected a file, found a pipe or a device"]);
    is_refused(&folder, &reduce("/dev/null"), &["/dev/null", "expected a file, found a pipe or a device"]);
    is_refused(&folder, &reduce("sub"), &["sub", "expected a file, found a folder"]);
    is_refused(&folder, &reduce("link"), &["link", "is a link to record.csv, and is not replaced", "--out"]);
    is_refused(&folder, &reduce("absent/a"), &["absent", "there is no such folder"]);
    let identify = |out: &str| format!("identify experiment.toml --out {out} --force");
    is_refused(&folder, &identify("pipe"), &["pipe", "expected a folder, found a pipe or a device"]);
    is_refused(&folder, &identify("record.csv/out"), &["record.csv", "expected a folder, found a file"]);
    fs::create_dir_all(folder.at("out/results.json")).unwrap();
    is_refused(&folder, &identify("out"), &["results.json", "expected a file, found a folder"]);
    assert_eq!(fs::read_dir(folder.at("out")).unwrap().count(), 1, "something was written");
}

/// A file that holds the name of this program, a file of another kind, and results of another robot.
#[test]
fn only_files_of_the_same_kind_and_robot_are_replaced() {
    let folder = case();
    let package = "{ \"name\": \"mine\", \"dependencies\": { \"thetahat\": \"^0.1\" } }\n";
    for notes in
        [package, "{\"thetahat\": \"0.1.0\"}", "# thetahat design of mine\n", "Generated by thetahat, I think\n"]
    {
        folder.write("notes", notes);
        for command in [
            "reduce experiment.toml --out",
            "generate robot.toml --model idm --to python --out",
            "model robot.toml --expand",
            "simulate experiment.toml --out",
        ] {
            is_refused(
                &folder,
                &format!("{command} notes"),
                &["notes: exists and is not a file of this kind that thetahat wrote"],
            );
        }
        assert_eq!(folder.text("notes"), notes);
    }
    succeeds(&folder, "identify experiment.toml --out out");
    succeeds(&folder, "identify experiment.toml --out out");
    let results = folder.bytes("out/results.json");
    is_refused(
        &folder,
        "reduce experiment.toml --out out/results.json",
        &["out/results.json", "exists and", "--force"],
    );
    is_refused(
        &folder,
        "compare out/results.json out/results.json --out out/report.html",
        &["report.html", "exists and"],
    );
    folder.replace("robot.toml", "name = \"slider\"", "name = \"another\"", "robot.toml");
    is_refused(
        &folder,
        "identify experiment.toml --out out",
        &["results.json: is of another robot than another", "--force"],
    );
    assert_eq!(folder.bytes("out/results.json"), results);
    succeeds(&folder, "identify experiment.toml --out out --force");
}

/// What a killed program left is removed by the next one, and links under predictable names lead nowhere.
#[cfg(unix)]
#[test]
fn unfinished_files_are_removed_and_never_followed() {
    let folder = case();
    folder.write("victim", FOREIGN).write(".a.reduction.killed.part", "half");
    std::os::unix::fs::symlink("victim", folder.at(".a.reduction.planted.part")).unwrap();
    succeeds(&folder, "reduce experiment.toml --out a.reduction");
    assert_eq!(folder.text("victim"), FOREIGN);
    assert!(!folder.at(".a.reduction.killed.part").exists());
}

#[test]
fn changed_results_are_read_and_not_trusted() {
    let folder = case();
    succeeds(&folder, "identify experiment.toml --out out");
    let text = folder.text("out/results.json");
    let key = "\"estimate\": ";
    let at = text.find(key).unwrap() + key.len();
    folder.write("changed.json", format!("{}1{}", &text[..at], &text[at..]));
    let predict = |file: &str| succeeds(&folder, &format!("predict {file} --recording record.csv"));
    assert!(predict("changed.json").contains("was changed after thetahat wrote it"));
    assert!(!predict("out/results.json").contains("was changed"));
    folder.write("changed.json", format!("{}1e999{}", &text[..at], &text[text[at..].find(',').unwrap() + at..]));
    is_refused(&folder, "predict changed.json --recording record.csv", &["changed.json: is not the results.json"]);
}

#[test]
fn a_campaign_goes_into_a_folder_of_its_own() {
    let folder = arm();
    let campaign = "campaign campaigns/two_joint.toml --starts 1 --seeds 1 --out runs";
    folder.write("runs/notes.txt", FOREIGN);
    is_refused(&folder, campaign, &["runs", "holds files but no campaign.json", "another folder"]);
    fs::remove_file(folder.at("runs/notes.txt")).unwrap();
    succeeds(&folder, campaign);
    folder.write("runs/campaign.html", FOREIGN);
    is_refused(&folder, campaign, &["campaign.html", "exists and"]);
}

/// One byte of a kept record, in the middle of its values, is another one.
#[test]
#[ignore = "long, each night"]
fn a_damaged_part_of_a_campaign_is_named() {
    let folder = arm();
    let campaign = "campaign campaigns/two_joint.toml --starts 1 --seeds 1 --out runs";
    let told = thetahat(&folder, campaign).stdout;
    let whole = folder.bytes("runs/runs.parquet");
    let mut named = 0;
    for place in (4..whole.len() - 8).step_by(97) {
        let mut bytes = whole.clone();
        bytes[place] ^= 0x10;
        folder.write("runs/runs.parquet", &bytes);
        let output = thetahat(&folder, campaign);
        let message = shown(&output);
        if output.status.code() == Some(2) && message.contains("runs.parquet") {
            named += 1;
        } else {
            // A byte that says nothing of the values, such as the name of the program that wrote them.
            assert_eq!(output.stdout, told);
        }
    }
    assert!(named > 100, "{named} named");
    folder.write("runs/runs.parquet", &whole);
    succeeds(&folder, campaign);
}

#[test]
fn results_that_do_not_match_their_robot_are_not_predicted_from() {
    let folder = case();
    succeeds(&folder, "identify experiment.toml --out out");
    let mut mass: serde_json::Value = folder.json("out/results.json");
    mass["model"] = serde_json::Value::Null;
    let names: Vec<String> = mass["runs"][0]["parameters"]
        .as_array()
        .unwrap()
        .iter()
        .map(|p| p["name"].as_str().unwrap().to_owned())
        .collect();
    let predict = "predict changed.json --recording record.csv";
    let mut changed = mass.clone();
    changed["runs"][0]["parameters"].as_array_mut().unwrap().pop();
    folder.write("changed.json", changed.to_string());
    is_refused(&folder, predict, &["changed.json", "not those of its robot", names.last().unwrap(), "is missing"]);
    let mut changed = mass.clone();
    changed["runs"][0]["parameters"][0]["name"] = "zz9r".into();
    folder.write("changed.json", changed.to_string());
    is_refused(&folder, predict, &["the robot has no zz9r", "identify again"]);
    let mut changed = mass.clone();
    changed["runs"][0]["parameters"][0]["expression"] = "m1".into();
    folder.write("changed.json", changed.to_string());
    is_refused(&folder, predict, &["not those of its robot"]);
}

#[test]
fn a_prediction_takes_the_window_and_columns_that_it_is_told() {
    let folder = case();
    let window = "sample_rate_hz = 500\nwindow_start_s = 2\nwindow_end_s = 6";
    folder.replace("experiment.toml", "sample_rate_hz = 500", window, "window.toml");
    succeeds(&folder, "identify window.toml --out out");
    let predict = |rest: &str| succeeds(&folder, &format!("predict out/results.json --recording {rest}"));
    assert!(predict("record.csv").contains("window 2.000 s to 6.000 s"));
    assert!(predict("record.csv --window-s 1 3").contains("window 1.000 s to 3.000 s"));
    folder.write("other.csv", record().replace("t,q1,tau1", "clock,angle,effort"));
    let other = predict("other.csv --position angle --torque effort --time clock");
    assert!(other.contains("slide") && !other.contains("not measured"), "{other}");
    is_refused(
        &folder,
        "predict out/results.json --recording other.csv --position angle --torque absent",
        &["other.csv", "\"absent\"", "\"clock\", \"angle\", \"effort\""],
    );
}

/// The time of a log may be in ms and that of the next one in s.
#[test]
fn a_prediction_takes_the_unit_of_the_time() {
    let folder = case();
    succeeds(&folder, "identify experiment.toml --out out");
    let with_time_times = |factor: f64| {
        let scaled = |line: &str| {
            let (time, rest) = line.split_once(',')?;
            Some(format!("{},{rest}", time.parse::<f64>().ok()? * factor))
        };
        let lines = record().lines().map(|line| scaled(line).unwrap_or_else(|| line.to_owned())).collect::<Vec<_>>();
        lines.join("\n")
    };
    folder.write("short.csv", with_time_times(1e-3));
    folder.write("ms.csv", with_time_times(1e3));
    let predict = "predict out/results.json --recording short.csv --time t";
    is_refused(&folder, predict, &["short.csv", "with its time in s, as in the experiment", "time_unit"]);
    let predicted = |rest: &str| succeeds(&folder, &format!("predict out/results.json --recording {rest}"));
    let errors = |text: &str| text.lines().skip(2).map(str::to_owned).collect::<Vec<_>>();
    let [ms, s] = [predicted("ms.csv --time t --time-unit ms"), predicted("record.csv --time t")];
    assert_eq!(errors(&ms), errors(&s));
}

#[test]
fn a_prediction_takes_the_method_that_is_advised() {
    let folder = case();
    succeeds(&folder, "identify experiment.toml --out out");
    let mut results: serde_json::Value = folder.json("out/results.json");
    let mut other = results["runs"][0].clone();
    other["method"] = "idim-iv".into();
    results["runs"].as_array_mut().unwrap().push(other);
    results["advice"][0]["recommended"] = "idim-iv".into();
    results["model"] = serde_json::Value::Null;
    folder.write("advised.json", results.to_string());
    let predict = |rest: &str| succeeds(&folder, &format!("predict advised.json --recording record.csv{rest}"));
    assert!(predict("").contains("idim-iv"));
    assert!(predict(" --method idim-ls").contains("idim-ls"));
}

/// Sets the title of a terminal, and clears it.
const ESCAPE: &str = "\u{1b}]0;owned\u{7}\u{9b}2J";

fn is_harmless(output: &Output, place: &str) {
    let text = shown(output);
    let control = text.chars().find(|c| c.is_control() && !matches!(c, '\n' | '\t'));
    assert_eq!(control, None, "{place}: {text:?}");
}

#[test]
fn names_cannot_steer_the_terminal() {
    let folder = case();
    let escaped = ESCAPE.chars().flat_map(char::escape_default).collect::<String>();
    // The columns of a recording, in its contents, in a proposal and in errors.
    folder.write("record.csv", record().replace("t,q1,tau1", &format!("t,q1,tau{ESCAPE}")));
    let output = thetahat(&folder, "inspect record.csv");
    is_harmless(&output, "columns");
    assert!(shown(&output).contains(&escaped[..6]), "{}", shown(&output));
    is_harmless(&thetahat(&folder, "init --robot robot.toml --recording record.csv"), "an error that lists columns");
    let init = "init --robot robot.toml --recording record.csv --position q1 --time t --out proposed.toml --torque";
    let torque = format!("tau{ESCAPE}");
    let output = run(PROGRAM, folder.path(), init.split(' ').chain([torque.as_str()]));
    is_harmless(&output, "a proposal");
    succeeded(&output);
    assert!(!folder.text("proposed.toml").contains('\u{1b}'));
    // Titles and joints.
    folder.write("record.csv", record());
    let toml = ESCAPE.chars().map(|c| if c.is_control() { format!("\\u{:04x}", c as u32) } else { c.to_string() });
    let name = toml.collect::<String>();
    folder.replace("robot.toml", "name = \"slider\"", &format!("name = \"slider{name}\""), "robot.toml");
    folder.replace("experiment.toml", "a slider", &format!("a slider{name}"), "experiment.toml");
    for command in ["check experiment.toml", "identify experiment.toml --out out", "model robot.toml"] {
        is_harmless(&thetahat(&folder, command), command);
    }
    is_harmless(&thetahat(&folder, "predict out/results.json --recording record.csv"), "a prediction");
    let model = shown(&thetahat(&folder, "model robot.toml"));
    assert!(model.contains("slider\\u{1b}"), "{model}");
    // Joints have no such names.
    folder.replace("robot.toml", "name = \"slide\"", &format!("name = \"slide{name}\\nline\""), "robot.toml");
    let output = thetahat(&folder, "model robot.toml");
    is_harmless(&output, "a joint");
    assert!(refused(&output).contains("control characters"));
    // File names.
    let file = format!("absent{ESCAPE}.toml");
    let output = run(PROGRAM, folder.path(), ["check", &file]);
    assert!(refused(&output).contains("absent\\u{1b}"));
    is_harmless(&output, "a file name");
    is_harmless(&run(PROGRAM, folder.path(), [ESCAPE]), "an argument");
}

#[test]
fn formulas_are_texts_in_csv() {
    let folder = case();
    let case = "[[case]]\nname = \"=1+1\\u001b\"\n[estimation]";
    folder.replace("experiment.toml", "[estimation]", case, "experiment.toml");
    succeeds(&folder, "identify experiment.toml --out out");
    let text = folder.text("out/parameters.csv");
    assert!(text.contains("\n'=1+1\\u{1b},idim-ls,"), "{text}");
    assert!(text.lines().all(|line| !line.starts_with(['=', '+', '-', '@'])), "{text}");
    // 2 N less than the friction: a negative offset stays a number.
    folder.write("record.csv", record().lines().map(negative).collect::<String>());
    succeeds(&folder, "identify experiment.toml --out out");
    let text = folder.text("out/parameters.csv");
    let offset = text.lines().find(|line| line.contains(",off1,")).unwrap();
    assert!(offset.contains(",-"), "{offset}");
    assert!(!text.contains("'-"), "{text}");
}

/// A line of the record with 4 N less.
fn negative(line: &str) -> String {
    match line.rsplit_once(',').map(|(rest, force)| (rest, force.parse::<f64>())) {
        Some((rest, Ok(force))) => format!("{rest},{}\n", force - 4.0),
        _ => format!("{line}\n"),
    }
}
