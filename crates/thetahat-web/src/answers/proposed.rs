//! The proposed experiment.

use serde::Serialize;
use thetahat::{
    Experiment, OneOrEach, Recording,
    experiment::{Proposal, ProposedChannels},
    recording::{Side, Unit},
};

/// The text of the experiment, and the choices in it.
#[derive(Serialize)]
pub(super) struct ProposalAnswer {
    toml: String,
    guesses: Vec<String>,
    /// The joints that move.
    joints: Vec<String>,
    window_s: [f64; 2],
    rate_hz: f64,
    time: Option<String>,
    position: Columns,
    torque: Columns,
    locked: Vec<Lock>,
    /// Torque for 1 A, 1 V or 100 % where it is known, one for all joints or one for each.
    gain: Vec<f64>,
}

/// The columns of a signal, one for each joint.
#[derive(Serialize)]
struct Columns {
    columns: Vec<String>,
    unit: OneOrEachUnit,
    side: &'static str,
}

#[derive(Serialize)]
#[serde(untagged)]
enum OneOrEachUnit {
    One(Unit),
    Each(Vec<Unit>),
}

#[derive(Serialize)]
struct Lock {
    name: String,
    value: f64,
}

impl ProposalAnswer {
    /// A proposal with its experiment and its first recording.
    pub(super) fn of(
        proposal: &Proposal,
        experiment: &Experiment,
        recording: &Recording,
        window_s: Option<[f64; 2]>,
    ) -> Self {
        let first = &proposal.recordings[0];
        let joints: Vec<String> = experiment.robot.coordinates().map(|joint| joint.name.clone()).collect();
        let signal = |name: &str| {
            let channels = first.channels.iter().find(|(signal, _)| *signal == name).map(|(_, channels)| channels);
            channels.map(|channels| Columns::of(channels, joints.len())).unwrap_or_else(Columns::none)
        };
        let whole = [0.0, recording.position.len() as f64 / recording.sample_rate_hz];
        Self {
            toml: proposal.text(),
            guesses: proposal.guesses(),
            window_s: window_s.unwrap_or(whole),
            rate_hz: recording.sample_rate_hz,
            time: first.clock.time.as_ref().and_then(|time| time.columns.first().cloned()),
            position: signal("position"),
            torque: signal("torque"),
            gain: first.channels.iter().find(|(signal, _)| *signal == "torque").map(gain_of).unwrap_or_default(),
            locked: proposal.locks.iter().map(|l| Lock { name: l.joint.clone(), value: l.value }).collect(),
            joints,
        }
    }
}

fn gain_of((_, channels): &(&str, ProposedChannels)) -> Vec<f64> {
    channels.factor.as_ref().map(|factor| factor.given().to_vec()).unwrap_or_default()
}

impl Columns {
    /// The columns, a matrix as its channels.
    fn of(channels: &ProposedChannels, joints: usize) -> Self {
        let columns = match &channels.columns[..] {
            [matrix] if joints > 1 => (1..=joints).map(|number| format!("{matrix}[{number}]")).collect(),
            columns => columns.to_vec(),
        };
        let unit = match &channels.unit {
            OneOrEach::One(unit) => OneOrEachUnit::One(*unit),
            OneOrEach::Each(units) => OneOrEachUnit::Each(units.clone()),
        };
        let side = match channels.side {
            Side::Joint => "joint",
            Side::Motor => "motor",
        };
        Self { columns, unit, side }
    }

    fn none() -> Self {
        Self { columns: Vec::new(), unit: OneOrEachUnit::Each(Vec::new()), side: "joint" }
    }
}
