//! What is refused of a design file.

use std::path::Path;

use thetahat::design::{Design, DesignError};
use thetahat_testing::{Folder, project};

use super::support::{DESIGN, key, key_of, parse, refused};

#[test]
fn values_that_cannot_be_used_are_named() {
    assert_eq!(key("torque = 0.1", "torque = 0"), "[noise] torque");
    assert_eq!(key("torque = 0.1", "torque = [0.1]"), "[noise] torque");
    assert_eq!(key("torque = 0.1", ""), "[noise]");
    assert_eq!(key("torque = 0.1", "torque = 0.1\nresults = 'results.json'"), "[noise]");
    assert_eq!(key("duration_s = 4", "duration_s = 0.2"), "duration_s");
    assert_eq!(key("duration_s = 4", "duration_s = -1"), "duration_s");
    assert_eq!(key("velocity = [250, 350]", "velocity = [250, 350, 1]"), "[limits] velocity");
    assert_eq!(key("acceleration = [1500, 2000]", "acceleration = 0"), "[limits] acceleration");
    assert_eq!(key("harmonics = 3", "harmonics = 0"), "[motion] harmonics");
    assert_eq!(key("harmonics = 3", "harmonics = 3\nstart = [0]"), "[motion] start");
    assert_eq!(key("harmonics = 3", "harmonics = 3\nstart = [0, 121]"), "[motion] start");
    // In the file's units, and with what the margin of 2 % leaves.
    let error = refused("harmonics = 3", "harmonics = 3\nstart = [0, 119]").to_string();
    assert!(
        error.contains("[motion] start is 119, expected from -117.6000 to 117.6000 degrees for joint elbow"),
        "{error}"
    );
    assert_eq!(key("[noise]", "[wanted]\ncriterion = 'chosen'\n[noise]"), "[wanted] parameters");
}

#[test]
fn limits_that_contradict_are_named_with_their_joint() {
    let error = refused("[[-90, 90]", "[[90, -90]");
    assert!(matches!(&*error, DesignError::Contradiction { joint, .. } if joint == "shoulder"), "{error}");
    let error = refused("[-120, 120]", "[30, 30]");
    assert!(matches!(&*error, DesignError::Contradiction { joint, .. } if joint == "elbow"), "{error}");
    let text = error.to_string();
    assert!(text.contains("runs from 30.0000 to 30.0000 degrees") && text.contains("[locked]"), "{error}");
}

#[test]
fn a_robot_without_limits_needs_them() {
    for (limit, quantity) in [
        ("position = [[-90, 90], [-120, 120]]\n", "position"),
        ("velocity = [250, 350]\n", "velocity"),
        ("acceleration = [1500, 2000]\n", "acceleration"),
    ] {
        let error = refused(limit, "");
        assert!(matches!(&*error, DesignError::NoLimit { quantity: found, .. } if *found == quantity), "{error}");
    }
}

#[test]
fn what_is_no_design_is_refused_with_its_line() {
    let error = refused("harmonics = 3", "harmonic = 3");
    assert!(matches!(&*error, DesignError::Syntax { .. }) && error.to_string().contains("harmonic"), "{error}");
    assert!(matches!(Design::read(Path::new("nowhere.toml")), Err(DesignError::Unreadable { .. })));
    let error =
        parse(&DESIGN.replace("starts = 2", "starts = 2\n[wanted]\ncriterion = 'chosen'\nparameters = ['zz9']"));
    assert!(matches!(error.unwrap().run(1), Err(DesignError::BaseParameters { .. })));
}

/// What the identification of the record could not do is refused before the search.
#[test]
fn what_cannot_be_identified_is_refused() {
    let settings = |estimate: &str| format!("[parameters]\nestimate = {estimate}\n[signal]");
    assert_eq!(key("[signal]", &settings("'essential'")), "[parameters] estimate");
    assert_eq!(key("[signal]", &settings("['zz1r', 'fc1']")), "[parameters] estimate");
    assert_eq!(key("cutoff_hz = 40", "cutoff_hz = 260"), "[signal] cutoff_hz");
    assert_eq!(key("duration_s = 4", "duration_s = 4.0009"), "duration_s times sample_rate_hz");
    assert_eq!(
        key("duration_s = 4\nsample_rate_hz = 500", "duration_s = 2000\nsample_rate_hz = 100"),
        "duration_s times sample_rate_hz"
    );
    let robot = std::fs::read_to_string(project("robots/two_joint.toml")).unwrap();
    let term = "[[term]]\nkind = 'channel-viscous'\njoints = ['shoulder']\nchannel = 'temperature'\nreference = 20\n";
    let folder = Folder::with("two_joint.toml", format!("{robot}\n{term}"));
    let error = Design::parse(DESIGN, &folder.path().join("design.toml")).unwrap_err();
    assert_eq!(key_of(error), "[[term]]");
}

#[test]
fn keys_of_the_other_kind_of_motion_are_refused() {
    assert_eq!(key("harmonics = 3", "harmonics = 3\nmoves = 4"), "[motion] moves");
    assert_eq!(key("harmonics = 3", "kind = 'moves'\nharmonics = 3"), "[motion] harmonics");
    assert_eq!(key("harmonics = 3", "kind = 'moves'\nmoves = 1"), "[motion] moves");
    let error = refused("harmonics = 3", "kind = 'postures'").to_string();
    assert!(error.contains("kind = 'postures'") && error.contains("criterion = \"chosen\""), "{error}");
    let error = refused("harmonics = 3", "kind = 'fourrier'").to_string();
    assert!(error.contains("expected fourier, splines or moves"), "{error}");
    assert_eq!(key("harmonics = 3", "kind = 'moves'\nsmoothing_s = 0"), "[motion] smoothing_s");
    assert_eq!(key("harmonics = 3", "kind = 'moves'\nrest_s = 1"), "duration_s");
}
