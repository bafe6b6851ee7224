use std::{collections::BTreeSet, path::Path};

use super::*;
use thetahat_testing::{Folder, project};

/// The presets are the files of the folder, and each names its public source in a comment.
#[test]
fn presets_are_the_files_of_the_folder() {
    let folder = project("crates/thetahat/drivers");
    let stem = |path: &Path| path.file_stem().unwrap().to_string_lossy().into_owned();
    let files: BTreeSet<String> = std::fs::read_dir(&folder).unwrap().map(|file| stem(&file.unwrap().path())).collect();
    let names: Vec<String> = Driver::names().map(str::to_owned).collect();
    assert_eq!(names, files.into_iter().collect::<Vec<_>>(), "presets.rs lists the files of {}", folder.display());
    for driver in Driver::presets().unwrap() {
        let text = std::fs::read_to_string(folder.join(format!("{}.toml", driver.name))).unwrap();
        assert!(text.starts_with("# ") && !driver.effort.is_empty(), "{}", driver.name);
        assert!(driver.torque.is_some() && !driver.source.is_empty(), "{}", driver.name);
    }
}

#[test]
fn a_name_that_is_unknown_is_refused_with_those_that_are() {
    let error = Driver::find("abb").unwrap_err().to_string();
    assert!(error.contains("there is no driver \"abb\"; the drivers are cia402, doosan,"), "{error}");
    let error = Driver::find("dynamixel").unwrap_err().to_string();
    assert!(error.contains("say which of dynamixel-330, dynamixel-x it is"), "{error}");
    assert!(Driver::find("none.toml").unwrap_err().to_string().starts_with("none.toml: cannot be read"));
}

/// A part of a name that one preset alone has, and other spellings.
#[test]
fn a_part_of_a_name_is_enough_where_it_is_one_preset_s() {
    for (name, expected) in [("go2", "unitree-go2"), ("UR_RTDE", "ur-rtde"), ("fri", "kuka-fri"), ("kinova", "kinova")]
    {
        assert_eq!(Driver::find(name).unwrap().name, expected);
    }
    assert!(["ur", "ros2", "r", "", "-"].into_iter().all(|name| Driver::find(name).is_err()));
}

#[test]
fn values_that_cannot_be_meant_are_refused_with_their_key() {
    let folder = Folder::new();
    let head = "title = 'a'\neffort = 'b'\n";
    for (text, expected) in [
        ("[position]\ncolumns = ['q_*']\nunit = 'A'", "[position] unit: expected a unit of an angle or a length"),
        ("[position]\ncolumns = ['*']\nunit = 'rad'", "[position] columns: expected a name of columns, with one *"),
        ("[position]\ncolumns = []\nunit = 'rad'", "[position] columns: expected at least one name, found none"),
        (
            "[position]\ncolumns = ['q']\nunit = 'rad'\nscale = 0",
            "[position] scale: expected a finite number other than zero",
        ),
        ("[position]\ncolumns = ['q']\nunit = 'rad'\ngain = 2", "[position] gain: expected no gain"),
        ("rate_hz = -1\n[position]\ncolumns = ['q']\nunit = 'rad'", "rate_hz: expected a positive number, found -1"),
        ("joints = ['*']\n[position]\ncolumns = ['q']\nunit = 'rad'", "joints: expected names of joints"),
        ("[position]\ncolumns = ['q']\nunit = 'rad'\nfactor = 1", "unknown field `factor`"),
        (
            "[position]\ncolumns = ['q']\nunit = 'rad'\n[torque]\ncolumns = ['i']\nunit = 'A'\ngain = [1, nan]",
            "[torque] gain: expected finite numbers other than zero, found NaN",
        ),
    ] {
        folder.write("mine.toml", format!("{head}{text}\n"));
        let error = Driver::find(&folder.at("mine.toml").display().to_string()).unwrap_err().to_string();
        assert!(error.contains("mine.toml") && error.contains(expected), "{error}");
    }
}
