//! Completions and manual pages name every command.

use std::{
    fs,
    process::{Command, Output},
};

const COMMANDS: [&str; 17] = [
    "campaign",
    "check",
    "compare",
    "completions",
    "demo",
    "export",
    "identify",
    "init",
    "inspect",
    "man",
    "model",
    "predict",
    "reduce",
    "sample",
    "sensitivity",
    "simulate",
    "solve",
];

fn thetahat(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_thetahat")).args(arguments).output().unwrap()
}

#[test]
fn completions_of_every_shell() {
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let output = thetahat(&["completions", shell]);
        assert!(output.status.success(), "{shell}");
        let script = String::from_utf8(output.stdout).unwrap();
        for command in COMMANDS {
            assert!(script.contains(command), "{shell}: {command}");
        }
    }
    assert_eq!(thetahat(&["completions", "cmd"]).status.code(), Some(2));
}

#[test]
fn a_manual_page_for_each_command() {
    let page = String::from_utf8(thetahat(&["man"]).stdout).unwrap();
    assert!(page.contains(".TH thetahat 1") && page.contains("Exit codes"), "{page}");
    let folder = std::env::temp_dir().join(format!("thetahat-man-{}", std::process::id()));
    assert!(thetahat(&["man", "--out", folder.to_str().unwrap()]).status.success());
    let page_of = |command: &str| fs::read_to_string(folder.join(format!("thetahat-{command}.1"))).unwrap();
    for command in COMMANDS {
        assert!(page_of(command).contains("SYNOPSIS"), "{command}");
    }
    fs::remove_dir_all(folder).unwrap();
}
