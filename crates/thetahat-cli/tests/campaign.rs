//! A campaign that is killed goes on where it was, and ends with the same file.

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Stdio},
    thread::sleep,
    time::{Duration, Instant},
};

/// Long enough for a slow machine to finish two records.
const PATIENCE: Duration = Duration::from_secs(120);
/// Records: many more than are done when the program is killed.
const SEEDS: usize = 60;

struct Folder(PathBuf);

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// The small campaign of the project with more seeds, in a folder of its own.
fn campaign(name: &str) -> Folder {
    let folder = std::env::temp_dir().join(format!("thetahat-campaign-cli-{name}-{}", std::process::id()));
    let _ = fs::remove_dir_all(&folder);
    let project = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    for part in ["campaigns", "experiments", "robots"] {
        fs::create_dir_all(folder.join(part)).unwrap();
        fs::copy(project.join(part).join("two_joint.toml"), folder.join(part).join("two_joint.toml")).unwrap();
    }
    let file = folder.join("campaigns/two_joint.toml");
    let text = fs::read_to_string(&file).unwrap();
    fs::write(&file, text.replacen("seeds = 2", &format!("seeds = {SEEDS}"), 1)).unwrap();
    Folder(folder)
}

fn command(folder: &Folder, out: &str, threads: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_thetahat"));
    command
        .current_dir(&folder.0)
        .args(["campaign", "campaigns/two_joint.toml", "--starts", "1", "--out", out, "--threads", threads])
        .stdout(Stdio::null());
    command
}

/// Records whose rows are kept.
fn parts(folder: &Folder, out: &str) -> usize {
    let finished = |entry: &fs::DirEntry| entry.path().extension().is_some_and(|e| e == "parquet");
    fs::read_dir(folder.0.join(out).join("parts")).map_or(0, |all| all.flatten().filter(finished).count())
}

#[test]
fn a_killed_campaign_goes_on_and_ends_with_the_same_file() {
    let folder = campaign("killed");
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
    let runs = |out: &str| folder.0.join(out).join("runs.parquet");
    assert!(!runs("killed").exists(), "it had finished before it was killed");
    // What a kill in the middle of a write leaves behind.
    fs::write(folder.0.join("killed/parts/.01-00001-00060.parquet.1.part"), b"PAR1").unwrap();
    let output = command(&folder, "killed", "2").output().unwrap();
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{told}");
    assert!(told.contains(&format!("{kept} there before")), "{told}");
    assert_eq!(fs::read(runs("whole")).unwrap(), fs::read(runs("killed")).unwrap());
    assert!(folder.0.join("killed/campaign.html").is_file());
    assert_eq!(fs::read_dir(folder.0.join("killed/parts")).unwrap().count(), 0);
}

#[test]
fn another_campaign_in_the_same_folder_is_refused() {
    let folder = campaign("other");
    assert!(command(&folder, "out", "2").args(["--seeds", "1"]).status().unwrap().success());
    let file = folder.0.join("robots/two_joint.toml");
    fs::write(&file, fs::read_to_string(&file).unwrap().replace("m2 = 2", "m2 = 3")).unwrap();
    let output = command(&folder, "out", "2").args(["--seeds", "1"]).output().unwrap();
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("robot description") && message.contains("another folder"), "{message}");
}

#[test]
fn a_bad_value_is_refused_with_file_and_line() {
    let folder = campaign("value");
    let file = folder.0.join("campaigns/two_joint.toml");
    fs::write(&file, fs::read_to_string(&file).unwrap().replace("noise = 0.05", "noise = \"much\"")).unwrap();
    let output = command(&folder, "out", "1").output().unwrap();
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("two_joint.toml") && message.contains("line"), "{message}");
    assert!(!folder.0.join("out").exists());
}
