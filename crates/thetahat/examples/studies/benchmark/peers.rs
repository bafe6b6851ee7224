//! What the peers take: Pinocchio through its Python package, less the way there and back, and the stages of a baseline.

use std::{collections::BTreeMap, error::Error, path::Path, process::Command};

/// Seconds of each call and stage; empty where there is no Python.
pub struct Peers {
    calls: BTreeMap<String, f64>,
    stages: BTreeMap<String, f64>,
}

impl Peers {
    /// Nobody to race against.
    pub fn none() -> Self {
        Self { calls: BTreeMap::new(), stages: BTreeMap::new() }
    }

    /// Runs both.
    pub fn run(python: &str, baseline: &Path, data: &Path) -> Result<Self, Box<dyn Error>> {
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/benchmark/pinocchio_calls.py");
        let urdf = data.join("tx40/tx40_mdh_modified.urdf");
        let calls = output(Command::new(python).arg(script).arg(urdf))?;
        let stages = output(Command::new(python).arg(baseline).arg("--simulate"))?;
        Ok(Self { calls: calls.lines().filter_map(call).collect(), stages: stages.lines().filter_map(stage).collect() })
    }

    /// Seconds of a call of Pinocchio.
    pub fn call(&self, name: &str) -> Option<f64> {
        self.calls.get(name).copied()
    }

    /// Sum over stages of the baseline, or a count that it prints.
    pub fn stages(&self, names: &[&str]) -> Option<f64> {
        names.iter().map(|name| self.stages.get(*name)).sum()
    }
}

fn output(command: &mut Command) -> Result<String, Box<dyn Error>> {
    let output = command.output()?;
    if !output.status.success() {
        return Err(format!("{command:?}: {}", String::from_utf8_lossy(&output.stderr)).into());
    }
    Ok(String::from_utf8(output.stdout)?)
}

/// Name, seconds, and seconds of a call that computes nothing.
fn call(line: &str) -> Option<(String, f64)> {
    let mut words = line.split_whitespace();
    let name = words.next()?;
    let (seconds, overhead): (f64, f64) = (words.next()?.parse().ok()?, words.next()?.parse().ok()?);
    eprintln!("Pinocchio {name}: {:.2} us, of which {:.2} us are the call from Python", seconds * 1e6, overhead * 1e6);
    Some((name.to_owned(), seconds - overhead))
}

fn stage(line: &str) -> Option<(String, f64)> {
    let (name, seconds) = line.trim_end().rsplit_once(' ')?;
    Some((name.trim().to_owned(), seconds.parse().ok()?))
}
