//! No generated model takes more operations than `counts.toml` says.
//!
//! `THETAHAT_UPDATE_COUNTS=1 cargo test --release -p thetahat --test suite operation_counts` writes the file anew.

mod counted;

use std::{collections::BTreeMap, path::PathBuf};

use counted::{MODELS, ROBOTS, count};

/// Multiplications, additions and divisions, by model and robot.
type Counts = BTreeMap<String, BTreeMap<String, [usize; 3]>>;

fn file() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/suite/operation_counts/counts.toml")
}

fn found() -> Counts {
    let of_model = |file: &str, (name, model)| {
        let count = count(file, model);
        (String::from(name), [count.multiplications, count.additions, count.divisions])
    };
    let of_robot = |(name, file): &(&str, &str)| {
        ((*name).to_owned(), MODELS.iter().map(|(name, model)| of_model(file, (*name, *model))).collect())
    };
    ROBOTS.iter().map(of_robot).collect()
}

#[test]
fn no_model_takes_more_operations() {
    let found = found();
    if std::env::var_os("THETAHAT_UPDATE_COUNTS").is_some() {
        let head = "# Multiplications, additions and divisions in each state: see main.rs.\n";
        std::fs::write(file(), head.to_owned() + &toml::to_string(&found).unwrap()).unwrap();
        return;
    }
    let stored: Counts = toml::from_str(&std::fs::read_to_string(file()).unwrap()).unwrap();
    for (robot, models) in &found {
        for (model, count) in models {
            let limit = stored[robot][model];
            let more = count.iter().zip(limit).any(|(found, limit)| *found > limit);
            assert!(!more, "{robot} {model}: {count:?} operations, {limit:?} are stored");
        }
    }
}

/// What the models of the TX40 must not exceed whatever is stored, with additions and divisions.
#[test]
fn the_tx40_meets_its_limits() {
    const LIMITS: [[usize; 3]; 4] = [[240, 236, 0], [130, 130, 0], [440, 410, 6], [349, 261, 0]];
    for ((name, model), limit) in MODELS.into_iter().zip(LIMITS) {
        let count = count("robots/tx40.toml", model);
        let found = [count.multiplications, count.additions, count.divisions];
        assert!(found.iter().zip(limit).all(|(found, limit)| *found <= limit), "{name}: {found:?} of {limit:?}");
    }
}
