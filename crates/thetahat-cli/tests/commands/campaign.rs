//! A campaign that is killed goes on where it was, and ends with the same file.

use std::{
    fs,
    process::{Command, Stdio},
    thread::sleep,
    time::{Duration, Instant},
};

use thetahat_testing::{Folder, project, refused};

/// Long enough for a slow machine to finish two records.
const PATIENCE: Duration = Duration::from_secs(120);
/// Records: many more than are done when the program is killed.
const SEEDS: usize = 60;
const CAMPAIGN: &str = "campaigns/two_joint.toml";

/// The small campaign of the project with more seeds, in a folder of its own.
fn campaign() -> Folder {
    let folder = Folder::new();
    for part in ["campaigns", "experiments", "robots"] {
        let file = format!("{part}/two_joint.toml");
        folder.write(&file, fs::read(project(&file)).unwrap());
    }
    folder.replace(CAMPAIGN, "seeds = 2", &format!("seeds = {SEEDS}"), CAMPAIGN);
    folder
}

fn command(folder: &Folder, out: &str, threads: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_thetahat"));
    command
        .current_dir(folder.path())
        .args(["campaign", CAMPAIGN, "--starts", "1", "--out", out, "--threads", threads])
        .stdout(Stdio::null());
    command
}

/// Records whose rows are kept.
fn parts(folder: &Folder, out: &str) -> usize {
    let finished = |entry: &fs::DirEntry| entry.path().extension().is_some_and(|e| e == "parquet");
    fs::read_dir(folder.at(out).join("parts")).map_or(0, |all| all.flatten().filter(finished).count())
}

#[test]
fn a_killed_campaign_goes_on_and_ends_with_the_same_file() {
    let folder = campaign();
    assert!(command(&folder, "whole", "2").status().unwrap().success());
    let mut child = command(&folder, "killed", "1").spawn().unwrap();
    let started = Instant::now();
    while parts(&folder, "killed") < 2 && started.elapsed() < PATIENCE {
        sleep(Duration::from_millis(2));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    let kept = parts(&folder, "killed");
    assert!(kept >= 2, "{kept} records were kept");
    let runs = |out: &str| folder.at(out).join("runs.parquet");
    assert!(!runs("killed").exists(), "it had finished before it was killed");
    // What a kill in the middle of a write leaves behind.
    fs::write(folder.at("killed/parts/.01-00001-00060.parquet.1.part"), b"PAR1").unwrap();
    let output = command(&folder, "killed", "2").output().unwrap();
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{told}");
    assert!(told.contains(&format!("{kept} already there")), "{told}");
    assert_eq!(fs::read(runs("whole")).unwrap(), fs::read(runs("killed")).unwrap());
    assert!(folder.at("killed/campaign.html").is_file());
    assert_eq!(fs::read_dir(folder.at("killed/parts")).unwrap().count(), 0);
}

#[test]
fn another_campaign_in_the_same_folder_is_refused() {
    let folder = campaign();
    assert!(command(&folder, "out", "2").args(["--seeds", "1"]).status().unwrap().success());
    folder.replace("robots/two_joint.toml", "m2 = 2", "m2 = 3", "robots/two_joint.toml");
    let message = refused(&command(&folder, "out", "2").args(["--seeds", "1"]).output().unwrap());
    assert!(message.contains("robot description") && message.contains("another folder"), "{message}");
}

#[test]
fn a_bad_value_is_refused_with_file_and_line() {
    let folder = campaign();
    folder.replace(CAMPAIGN, "noise = 0.05", "noise = \"much\"", CAMPAIGN);
    let message = refused(&command(&folder, "out", "1").output().unwrap());
    assert!(message.contains("two_joint.toml") && message.contains("line"), "{message}");
    assert!(!folder.at("out").exists());
}
