//! `thetahat export` and `thetahat sample`, as their users run them.

use std::path::Path;

use thetahat_testing::{Folder, project, refused, run, shown, succeeded};

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
    assert_eq!(folder.json("arm.urdf.covariance.json")["method"], "idim-ls");
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
    assert!(said.contains("12 samples") && said.contains("12.xml"), "{said}");
    let first = folder.text("samples/01.xml");
    assert!(first.contains("seed 3") && first != folder.text("samples/12.xml"));
    succeeded(&thetahat(folder.path(), sample));
    assert_eq!(folder.text("samples/01.xml"), first);
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
    assert!(export("results.json", &["--out", "results.json"]).contains("reads this file"));
    assert_eq!(folder.text("theirs.urdf"), "<robot name=\"theirs\"/>");
    assert!(export("results.json", &["--method", "didim"]).contains("those it holds: idim-ls"));
    let unread = refused(&thetahat(folder.path(), ["export", "results.json", "--to", "mjcf", "--check"]));
    assert!(unread.contains("thetahat reads URDF alone"), "{unread}");
    let unknown = refused(&thetahat(folder.path(), ["export", "results.json", "--to", "dae"]));
    assert!(unknown.contains("urdf, mjcf, sdf, json"), "{unknown}");
    assert!(export("two_joint.toml", &[]).contains("is not the results.json"));
    folder.replace("results.json", "\"verdict\": \"", "\"verdict\": \"do-not-use\", \"was\": \"", "bad.json");
    assert!(export("bad.json", &["--out", "bad.urdf"]).contains("do-not-use"));
    assert!(!folder.at("bad.urdf").exists());
    folder.replace("two_joint.toml", "a_m = 0.4", "a_m = 0.5", "two_joint.toml");
    let changed = export("results.json", &["--data", "."]);
    assert!(changed.contains("has changed since the identification"), "{changed}");
    let another = project("robots/tx40.toml");
    let another = export("results.json", &["--robot", another.to_str().unwrap_or_default()]);
    assert!(another.contains("is not the robot of these results"), "{another}");
    let forced = ["export", "bad.json", "--to", "urdf", "--out", "bad.urdf", "--force"];
    assert_eq!(thetahat(folder.path(), forced).status.code(), Some(1), "exported, and not to be trusted");
}

/// The commands of docs/use_the_result.md run as they stand.
#[test]
fn the_commands_of_the_page_run() {
    let page = std::fs::read_to_string(project("docs/use_the_result.md")).expect("the page is there");
    let folder = Folder::new();
    for file in ["experiments/two_joint.toml", "robots/two_joint.toml"] {
        folder.write(file, std::fs::read(project(file)).expect("the file is there"));
    }
    let commands: Vec<&str> = page.lines().filter_map(|line| line.strip_prefix("$ thetahat ")).collect();
    assert!(commands.len() > 4, "{commands:?}");
    for command in commands {
        succeeded(&thetahat(folder.path(), command.split(' ')));
    }
    for file in ["arm.urdf", "arm.xml", "arm.sdf", "arm.json", "arm.urdf.covariance.json", "samples/100.xml"] {
        assert!(folder.at(file).is_file(), "{file}");
    }
}
