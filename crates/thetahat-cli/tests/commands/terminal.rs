//! What the commands print: one screen that ends with the verdict card, the whole report, the card alone, or JSON.

use std::{fs, process::Output};

use serde_json::Value;
use thetahat_testing::{Folder, project, run};

const PROGRAM: &str = env!("CARGO_BIN_EXE_thetahat");

/// Columns where there is no terminal.
const COLUMNS: usize = 80;

/// Most lines of the default output for the demonstration's 60 parameters and two cases.
const LINES: usize = 62;

/// The two-joint arm and its twin, which is `twin.toml`.
fn two_joint_arm() -> Folder {
    let folder = Folder::new();
    folder.copy(&project("robots/two_joint.toml"));
    let twin = fs::read_to_string(project("experiments/two_joint.toml")).unwrap();
    folder.write("twin.toml", twin.replace("../robots/", ""));
    folder
}

fn printed(folder: &Folder, arguments: &str, code: i32) -> String {
    let Output { status, stdout, stderr } = run(PROGRAM, folder.path(), arguments.split(' '));
    assert_eq!(status.code(), Some(code), "{arguments}: {}", String::from_utf8_lossy(&stderr));
    let text = String::from_utf8(stdout).unwrap();
    assert!(!text.contains('\u{1b}'), "{arguments}: no colours where there is no terminal");
    text
}

/// The lines behind the last rule.
fn card(text: &str) -> &str {
    text.rsplit_once(&format!("{}\n", "-".repeat(COLUMNS))).unwrap().1
}

#[test]
fn one_screen_begins_and_ends_with_the_verdict() {
    let folder = Folder::new();
    let text = printed(&folder, "demo", 0);
    assert!(text.lines().count() <= LINES, "{} lines\n{text}", text.lines().count());
    assert!(text.lines().all(|line| line.chars().count() <= COLUMNS), "{text}");
    assert!(text.starts_with("\u{2713} GOOD: use the model"), "{text}");
    let card = card(&text);
    assert!(card.ends_with("\n\u{2713} GOOD: use the model\n"), "{card}");
    for what in ["error ", "on data not used", "worst joint ", "precise, ", "not identified of 60", "to improve  "] {
        assert!(card.contains(what), "{what}: {card}");
    }
    assert!(text.contains("nominal         idim-iv  converged"), "{text}");
    for absent in ["Convergence, every iteration", "Levene", "written:"] {
        assert!(!text.contains(absent), "{absent}: {text}");
    }
}

#[test]
fn the_whole_report_ends_with_the_same_card() {
    let folder = two_joint_arm();
    let full = printed(&folder, "identify twin.toml --full", 0);
    assert!(full.contains("Convergence, every iteration") && full.contains("Levene"), "{full}");
    assert_eq!(card(&full), printed(&folder, "identify twin.toml --quiet", 0));
}

#[test]
fn json_is_the_file_and_nothing_else() {
    let folder = two_joint_arm();
    let text = printed(&folder, "identify twin.toml --json --out out", 0);
    let printed: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(printed["verdict"], "good");
    assert_eq!(text, String::from_utf8(folder.bytes("out/results.json")).unwrap());
}

/// The torque of the other joint in each column: nothing of it may look like a result.
#[test]
fn a_broken_record_cannot_be_taken_for_good() {
    let folder = two_joint_arm();
    printed(&folder, "simulate twin.toml --out record.csv", 0);
    printed(&folder, "init --robot two_joint.toml --recording record.csv --torque torque_2,torque_1", 0);
    let text = printed(&folder, "identify experiment.toml", 1);
    assert!(text.starts_with("\u{2717} DO NOT USE these numbers\n"), "{text}");
    let card = card(&text);
    assert!(card.ends_with("\n\u{2717} DO NOT USE these numbers\n") && card.contains("[check-problem]"), "{card}");
    assert!(!card.contains("use idim") && !text.contains("GOOD"), "{text}");
    assert!(card.contains("next        1. "), "{card}");
    assert_eq!(printed(&folder, "identify experiment.toml --quiet", 1), card);
}

#[test]
fn results_are_compared_by_settings_and_in_deviations() {
    let folder = two_joint_arm();
    folder.replace("twin.toml", "seed = 1\n", "seed = 78\n", "b.toml");
    printed(&folder, "identify twin.toml --quiet --out a", 0);
    printed(&folder, "identify b.toml --quiet --out b", 0);
    let text = printed(&folder, "compare a/results.json b/results.json --out compared.html", 0);
    assert!(text.contains("Settings that differ") && text.contains("78"), "{text}");
    assert!(text.contains("B against A: 0 of "), "{text}");
    assert!(text.lines().all(|line| line.chars().count() <= COLUMNS), "{text}");
    let page = String::from_utf8(folder.bytes("compared.html")).unwrap();
    assert!(page.contains("Settings that differ") && page.trim_end().ends_with("</html>"), "{page}");
    let same = printed(&folder, "compare a/results.json a/results.json", 0);
    assert!(same.contains("No setting differs.") && same.contains("most "), "{same}");
    let refused = run(PROGRAM, folder.path(), "compare a/results.json b/results.json --method cloe".split(' '));
    let message = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert_eq!(refused.status.code(), Some(2));
    assert!(message.contains("cloe has no estimate in case nominal; there are nominal idim-ls"), "{message}");
}
