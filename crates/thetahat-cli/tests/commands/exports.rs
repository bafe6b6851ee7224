//! `thetahat export` and `thetahat sample`, as their users run them.

use std::path::Path;

use thetahat_testing::{Folder, project, refused, run, shown, succeeded, users_mjcf};

fn thetahat<'a>(folder: &Path, arguments: impl IntoIterator<Item = &'a str>) -> std::process::Output {
    run(env!("CARGO_BIN_EXE_thetahat"), folder, arguments)
}

/// A folder with the results of the two-joint twin by LS.
fn identified() -> Folder {
    let text = std::fs::read_to_string(project("experiments/two_joint.toml")).expect("the experiment is there");
    let text = text.split("[[case]]").next().unwrap_or_default().replace("../robots/", "");
    let folder = Folder::with("two_joint.toml.experiment", format!("{text}\n[estimation]\nmethods = [\"idim-ls\"]\n"));
    folder.copy(&project("robots/two_joint.toml"));
    let arguments = ["identify", "two_joint.toml.experiment", "--out", ".", "--quiet"];
    assert!(thetahat(folder.path(), arguments).status.code().is_some_and(|code| code < 2));
    folder
}

#[test]
fn a_robot_is_exported_checked_and_sampled() {
    let folder = identified();
    let export = |arguments: &[&str]| {
        thetahat(folder.path(), ["export", "results.json"].into_iter().chain(arguments.iter().copied()))
    };
    let said = succeeded(&export(&["--to", "urdf", "--out", "arm.urdf", "--check", "--data", "."]));
    for word in [
        "every base parameter is at its estimate",
        "ia1 = ",
        "read back",
        "written: arm.urdf",
        "arm.urdf.covariance.json",
    ] {
        assert!(said.contains(word), "{word}: {said}");
    }
    assert_eq!(folder.json("arm.urdf.covariance.json")["method"], "model");
    for (format, root) in [("mjcf", "<mujoco"), ("sdf", "<sdf"), ("json", "\"parameters\"")] {
        let output = export(&["--to", format]);
        assert!(String::from_utf8_lossy(&output.stdout).contains(root), "{}", shown(&output));
        assert_eq!(output.status.code(), Some(0));
    }
    // Its own file is replaced, and again has the same bytes.
    let before = folder.bytes("arm.urdf");
    succeeded(&export(&["--to", "urdf", "--out", "arm.urdf"]));
    assert_eq!(folder.bytes("arm.urdf"), before);
    // Samples: by number, with the seed, the same again.
    let sample = ["sample", "results.json", "--to", "mjcf", "--count", "12", "--seed", "3", "--out", "samples"];
    let said = succeeded(&thetahat(folder.path(), sample));
    assert!(said.contains("12 samples") && said.contains("000012.xml"), "{said}");
    let first = folder.text("samples/000001.xml");
    assert!(first.contains("seed 3") && first != folder.text("samples/000012.xml"));
    succeeded(&thetahat(folder.path(), sample));
    assert_eq!(folder.text("samples/000001.xml"), first);
}

#[test]
fn what_cannot_be_exported_is_refused() {
    let folder = identified();
    let export = |results: &str, arguments: &[&str]| {
        let all = ["export", results, "--to", "urdf"].into_iter().chain(arguments.iter().copied());
        refused(&thetahat(folder.path(), all))
    };
    folder.write("theirs.urdf", "<robot name=\"theirs\"/>");
    assert!(export("results.json", &["--out", "theirs.urdf"]).contains("--force"));
    assert!(export("results.json", &["--out", "results.json"]).contains("is read as an input"));
    assert_eq!(folder.text("theirs.urdf"), "<robot name=\"theirs\"/>");
    assert!(export("results.json", &["--method", "didim"]).contains("there are nominal idim-ls"));
    let unread = refused(&thetahat(folder.path(), ["export", "results.json", "--to", "json", "--check"]));
    assert!(unread.contains("holds the parameters as they are"), "{unread}");
    let unknown = refused(&thetahat(folder.path(), ["export", "results.json", "--to", "dae"]));
    assert!(unknown.contains("urdf, mjcf, sdf, json, pace, isaac, bam"), "{unknown}");
    assert!(export("two_joint.toml", &[]).contains("is not the results.json"));
    folder.replace("results.json", "\"verdict\": \"", "\"verdict\": \"do-not-use\", \"was\": \"", "bad.json");
    let untrusted = export("bad.json", &["--out", "bad.urdf", "--force"]);
    assert!(untrusted.contains("do-not-use") && untrusted.contains("--untrusted"), "{untrusted}");
    assert!(!folder.at("bad.urdf").exists());
    folder.replace("two_joint.toml", "a_m = 0.4", "a_m = 0.5", "two_joint.toml");
    let changed = export("results.json", &["--data", "."]);
    assert!(changed.contains("has changed since the identification"), "{changed}");
    let another = project("robots/tx40.toml");
    let another = export("results.json", &["--robot", another.to_str().unwrap_or_default()]);
    assert!(another.contains("is not the robot of these results"), "{another}");
    let untrusted = ["export", "bad.json", "--to", "urdf", "--out", "bad.urdf", "--untrusted"];
    assert_eq!(thetahat(folder.path(), untrusted).status.code(), Some(1), "exported, and not to be trusted");
    // Each flag permits one thing.
    let both = ["export", "bad.json", "--to", "urdf", "--out", "theirs.urdf", "--untrusted"];
    assert!(refused(&thetahat(folder.path(), both)).contains("--force"));
    let replaced = export_forced(&folder);
    assert!(folder.text("theirs.urdf").contains("thetahat export"), "{replaced}");
}

fn export_forced(folder: &Folder) -> String {
    let arguments = ["export", "results.json", "--to", "urdf", "--out", "theirs.urdf", "--force"];
    succeeded(&thetahat(folder.path(), arguments))
}

/// A MuJoCo model of the user's own: written anew elsewhere, never replaced, and refused with what is wrong with it.
#[test]
fn a_robot_goes_into_a_users_own_model() {
    let folder = identified();
    let run_with = |arguments: &[&str]| thetahat(folder.path(), arguments.iter().copied());
    succeeded(&run_with(&["export", "results.json", "--to", "mjcf", "--out", "written.xml"]));
    let mine = users_mjcf(&folder.text("written.xml"));
    folder.write("mine.xml", &mine);
    let into = |model: &str, more: &[&str]| {
        run_with(&[&["export", "results.json", "--to", "mjcf", "--into", model], more].concat())
    };
    let said = succeeded(&into("mine.xml", &["--out", "arm.xml", "--check"]));
    for words in ["cover_1 keep their inertia", "read back", "written: arm.xml"] {
        assert!(said.contains(words), "{words}: {said}");
    }
    let text = folder.text("arm.xml");
    assert!(
        text.contains("<!-- my own -->") && text.contains("thetahat export") && text.contains("<light pos='0 0 3'/>")
    );
    assert!(refused(&into("mine.xml", &["--out", "mine.xml", "--force"])).contains("is read as an input"));
    assert_eq!(folder.text("mine.xml"), mine);
    let sample = ["sample", "results.json", "--to", "mjcf", "--into", "mine.xml", "--count", "2", "--out", "samples"];
    succeeded(&run_with(&sample));
    assert!(folder.text("samples/000002.xml").contains("<light pos='0 0 3'/>"));
    let urdf = ["export", "results.json", "--to", "urdf", "--into", "mine.xml"];
    assert!(refused(&run_with(&urdf)).contains("--to mjcf"));
    assert!(refused(&into("absent.xml", &[])).contains("absent.xml"));
    for (from, to, words) in [
        (
            "name='elbow'",
            "name='knee'",
            "no body has the joint `elbow` of the identified robot; it has the joints shoulder, knee",
        ),
        ("<default><joint", "<default><joint name='elbow2'", "written: "),
        ("<light", "<include file='lights.xml'/><light", "takes in another file"),
        ("boundmass='1e-12'", "boundmass='30'", "boundmass = 30 would change `my_link_"),
        ("boundmass='1e-12'", "inertiafromgeom='true'", "replaces every <inertial>"),
        ("boundmass='1e-12'", "settotalmass='4'", "scales every mass"),
        ("boundmass='1e-12'", "coordinate='global'", "in that of the world"),
        ("angle='degree'", "angle='radian'", "its axis differs by"),
        ("<mujoco", "<robot name='a'><mujoco", "is not XML"),
    ] {
        folder.write("changed.xml", mine.replacen(from, to, 1));
        let output = into("changed.xml", &["--out", "changed_arm.xml"]);
        assert!(shown(&output).contains(words), "{from} to {to}: {}", shown(&output));
        assert_eq!(output.status.success(), words == "written: ", "{}", shown(&output));
    }
}

/// Nothing of an earlier export stays beside another one, and nothing that was read is replaced.
#[test]
fn what_lies_beside_is_of_this_export() {
    let folder = identified();
    let run_with = |arguments: &[&str]| thetahat(folder.path(), arguments.iter().copied());
    let export = |results: &str, more: &[&str]| {
        run_with(&[&["export", results, "--to", "urdf", "--out", "arm.urdf"], more].concat())
    };
    succeeded(&export("results.json", &[]));
    let mut without = folder.json("results.json");
    without["model"] = serde_json::Value::Null;
    without["runs"][0]["covariance"] = Vec::<f64>::new().into();
    for parameter in without["runs"][0]["parameters"].as_array_mut().expect("it holds estimates") {
        for key in ["standard_deviation", "standard_deviation_robust", "interval_95"] {
            parameter[key] = serde_json::Value::Null;
        }
    }
    folder.write("without.json", without.to_string());
    let said = succeeded(&export("without.json", &[]));
    assert!(said.contains("no covariance: without.json: holds no standard deviations"), "{said}");
    assert!(said.contains("removed: arm.urdf.covariance.json"), "{said}");
    assert!(!folder.at("arm.urdf.covariance.json").exists());
    // The description that was compared is an input.
    let description = ["export", "results.json", "--to", "json", "--data", ".", "--out", "two_joint.toml", "--force"];
    assert!(refused(&run_with(&description)).contains("is read as an input"));
    // Samples of another call.
    let sample = |count| run_with(&["sample", "results.json", "--to", "json", "--out", "samples", "--count", count]);
    succeeded(&sample("4"));
    let fewer = refused(&sample("2"));
    assert!(fewer.contains("000003.json") && fewer.contains("--out"), "{fewer}");
    succeeded(&sample("5"));
}

/// Results of arrays, as Python writes them, go the same ways.
#[test]
fn results_of_arrays_are_exported_and_generated_and_not_predicted_from() {
    let folder = identified();
    let mut results = folder.json("results.json");
    results["experiment_description"] = "".into();
    results.as_object_mut().unwrap().remove("digest");
    folder.write("arrays.json", results.to_string());
    let run_with = |arguments: &[&str]| thetahat(folder.path(), arguments.iter().copied());
    succeeded(&run_with(&["export", "arrays.json", "--to", "urdf", "--out", "arm.urdf", "--check"]));
    let of = |results: &str| {
        let output = run_with(&["generate", results, "--model", "idm", "--to", "python", "--robot", "two_joint.toml"]);
        succeeded(&output);
        output.stdout
    };
    assert_eq!(of("arrays.json"), of("results.json"));
    let predicted = refused(&run_with(&["predict", "arrays.json", "--recording", "log.csv"]));
    assert!(predicted.contains("arrays.json") && predicted.contains("holds no experiment"), "{predicted}");
    folder.replace("two_joint.toml", "m1 = 4", "m1 = 5", "two_joint.toml");
    let changed = ["generate", "arrays.json", "--model", "idm", "--to", "c", "--robot", "two_joint.toml"];
    assert!(refused(&run_with(&changed)).contains("has changed since the identification"));
}

/// The commands of docs/manual/use_the_result.md run unchanged.
#[test]
fn the_commands_of_the_page_run() {
    let page = std::fs::read_to_string(project("docs/manual/use_the_result.md")).expect("the page is there");
    let folder = Folder::new();
    for file in ["experiments/two_joint.toml", "robots/two_joint.toml"] {
        folder.write(file, std::fs::read(project(file)).expect("the file is there"));
    }
    let commands: Vec<&str> = page.lines().filter_map(|line| line.strip_prefix("$ thetahat ")).collect();
    assert!(commands.len() > 4, "{commands:?}");
    for command in commands {
        succeeded(&thetahat(folder.path(), command.split(' ')));
    }
    for file in ["arm.urdf", "arm.xml", "arm.sdf", "arm.json", "arm.urdf.covariance.json", "samples/000100.xml"] {
        assert!(folder.at(file).is_file(), "{file}");
    }
}
