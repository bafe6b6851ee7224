#![no_main]

use std::{
    fs,
    path::{Path, PathBuf},
    process,
    sync::LazyLock,
};

use thetahat_model::robot::{RobotSource, XacroOptions};

/// A folder of this process: an expansion reads from files, and may include the file itself, `parts.xacro` and `sizes.yaml`.
static FOLDER: LazyLock<PathBuf> = LazyLock::new(|| {
    let folder = std::env::temp_dir().join(format!("thetahat-fuzz-{}", process::id()));
    let parts = "<robot xmlns:xacro=\"http://ros.org/wiki/xacro\"><xacro:property name=\"size\" value=\"2\"/></robot>";
    fs::create_dir_all(&folder).expect("a temporary folder can be made");
    fs::write(folder.join("parts.xacro"), parts).expect("a temporary file can be written");
    fs::write(folder.join("sizes.yaml"), "a: {b: [1, 2]}\n").expect("a temporary file can be written");
    folder
});

fn expanded(path: &Path) {
    if let Ok(source) = RobotSource::read_with_xacro(path, &XacroOptions::default()) {
        let _ = source.robot();
    }
}

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let path = FOLDER.join("robot.xacro");
    fs::write(&path, bytes).expect("a temporary file can be written");
    expanded(&path);
});
