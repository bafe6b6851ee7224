//! A step of a remedy as changes of keys of the experiment file.

use std::path::Path;

use toml::{Table, Value};

use super::{
    channels::{Channels, Entry, one_or_list},
    text::{Change, with_table_of_array},
};
use crate::{
    experiment::description::{ExperimentFile, RecordingDescription, parse},
    preparation::EstimatedSize,
};
use thetahat_data::recording::ChannelSource;
use thetahat_model::robot::{Robot, TermDescription};
use thetahat_report::results::{RecordingStep, RemedySignal, RemedyStep, SettingChange};

/// An experiment's text while steps change it.
pub(super) struct Draft<'a> {
    pub(super) text: String,
    pub(super) file: ExperimentFile,
    pub(super) robot: &'a Robot,
    pub(super) changes: Vec<SettingChange>,
}

/// A recording of the file.
struct Target<'f> {
    table: &'static str,
    index: usize,
    count: usize,
    description: &'f RecordingDescription,
}

impl Draft<'_> {
    /// Makes the changes of a step; none if this file has no place for them, or has them already.
    pub(super) fn make(&mut self, step: &RecordingStep) -> Option<()> {
        if let RemedyStep::AddTerm { term, joints } = &step.step {
            self.add_term(term, joints)?;
            return self.read_again();
        }
        if let RemedyStep::Estimated { size } = &step.step {
            self.count_as_estimated(size)?;
            return self.read_again();
        }
        let (changes, count) = self.changes_of(step)?;
        let mut has_changed = false;
        for change in &changes {
            let before = change.before(&self.text);
            if before == change.value {
                continue;
            }
            self.text = change.made_in(&self.text)?;
            has_changed = true;
            let [before, after] = [&before, &change.value].map(|value| value.as_ref().map(ToString::to_string));
            self.changes.push(SettingChange { key: change.key(count), before, after });
        }
        self.read_again().filter(|()| has_changed)
    }

    /// Reads the text again, so that the next step finds what this one has written.
    fn read_again(&mut self) -> Option<()> {
        self.file = parse(&self.text, Path::new("")).ok()?.0;
        Some(())
    }

    fn add_term(&mut self, kind: &str, joints: &[String]) -> Option<()> {
        let is_there =
            self.file.terms.iter().chain(&self.robot.term_descriptions).any(|term| acts_on(term, kind, joints));
        let mut table: Table = [("kind".to_owned(), Value::from(kind))].into_iter().collect();
        if !joints.is_empty() {
            table.insert("joints".to_owned(), Value::from(joints.to_vec()));
        }
        self.text = with_table_of_array(&self.text, "term", &table).filter(|_| !is_there)?;
        let after = Some(Value::from(kind).to_string());
        self.changes.push(SettingChange { key: "term.kind".to_owned(), before: None, after });
        Some(())
    }

    /// Adds a size to those that were estimated from the recordings, unless it is there.
    fn count_as_estimated(&mut self, size: &str) -> Option<()> {
        let mut all: Vec<String> = self.estimated()?.iter().map(ToString::to_string).collect();
        if all.iter().any(|other| other == size) {
            return Some(());
        }
        all.push(size.to_owned());
        let change = Change::new(&["model", "estimated"], 0, Value::from(all));
        let before = change.before(&self.text).map(|value| value.to_string());
        self.text = change.made_in(&self.text)?;
        let after = change.value.as_ref().map(ToString::to_string);
        self.changes.push(SettingChange { key: change.key(1), before, after });
        Some(())
    }

    /// The sizes that were estimated from the recordings.
    fn estimated(&self) -> Option<Vec<EstimatedSize>> {
        Some(parse(&self.text, Path::new("")).ok()?.1.model.estimated)
    }

    /// The time constant of the filter of a torque, where it was estimated from the recordings.
    fn estimated_filter(&self, torque: &ChannelSource) -> Option<f64> {
        torque.low_pass_s.filter(|_| self.estimated().is_some_and(|sizes| sizes.contains(&EstimatedSize::TorqueFilter)))
    }

    /// The changes, and the number of tables in the array that they are in.
    fn changes_of(&self, step: &RecordingStep) -> Option<(Vec<Change>, usize)> {
        match &step.step {
            RemedyStep::Cutoff { cutoff_hz } => {
                Some((vec![Change::new(&["signal", "cutoff_hz"], 0, Value::from(*cutoff_hz))], 1))
            }
            RemedyStep::LeaveOutRests => Some((vec![Change::new(&["signal", "mask"], 0, Value::from("near-rest"))], 1)),
            RemedyStep::Essential { .. } => {
                Some((vec![Change::new(&["parameters", "estimate"], 0, Value::from("essential"))], 1))
            }
            RemedyStep::LockJoint { joint, name, value } => {
                Some((self.locked(joint.checked_sub(1)?, name, *value)?, 1))
            }
            RemedyStep::Gravity { gravity } => {
                Some((vec![Change::new(&["gravity"], 0, Value::from(gravity.to_vec()))], 1))
            }
            RemedyStep::AddTerm { .. } | RemedyStep::Estimated { .. } => None,
            RemedyStep::OrderJoints { .. }
            | RemedyStep::Scale { .. }
            | RemedyStep::Side { .. }
            | RemedyStep::Delay { .. }
            | RemedyStep::Hold
            | RemedyStep::LowPass { .. }
            | RemedyStep::EqualSteps { .. }
            | RemedyStep::LeaveOutTimes { .. }
            | RemedyStep::CorrectReference { .. } => {
                let target = self.target(step)?;
                Some((self.in_recording(&target, step)?, target.count))
            }
        }
    }

    /// A joint locked, and its channels left out of every recording; none if other keys have a value for each joint.
    fn locked(&self, joint: usize, name: &str, value: f64) -> Option<Vec<Change>> {
        let table: Table = toml::from_str(&self.text).ok()?;
        if self.robot.coordinate_count() < 2 || table.contains_key("controller") || table.contains_key("simulation") {
            return None;
        }
        let mut changes = vec![Change::new(&["locked", name], 0, Value::from(value))];
        for (table, all) in [("recording", &self.file.recording), ("validation", &self.file.validation)] {
            for (index, d) in all.iter().enumerate() {
                if d.reference_correction.is_some() || d.added_signal.is_some() || !d.channels.is_empty() {
                    return None;
                }
                let signals = [
                    ("position", Some(&d.position)),
                    ("torque", d.torque.as_ref()),
                    ("velocity", d.velocity.as_ref()),
                    ("reference", d.reference.as_ref()),
                ];
                for (signal, source) in signals {
                    let Some(source) = source else { continue };
                    let channels = Channels { source, robot: self.robot, is_position: signal != "torque" };
                    let of = |(key, value): Entry| Change::new(&[table, signal, key], index, value);
                    changes.extend(channels.without(joint)?.into_iter().map(of));
                }
            }
        }
        Some(changes)
    }

    fn target(&self, step: &RecordingStep) -> Option<Target<'_>> {
        let (table, all) =
            if step.held_back { ("validation", &self.file.validation) } else { ("recording", &self.file.recording) };
        let name = step.recording.as_ref()?;
        let is_meant = |(i, d): (usize, &RecordingDescription)| {
            d.name.as_ref().map_or_else(|| (i + 1).to_string() == *name, |own| own == name)
        };
        let index = all.iter().enumerate().position(is_meant)?;
        Some(Target { table, index, count: all.len(), description: &all[index] })
    }

    fn in_recording(&self, target: &Target<'_>, step: &RecordingStep) -> Option<Vec<Change>> {
        let torque = || target.description.torque.as_ref();
        match &step.step {
            RemedyStep::OrderJoints { signal, order } => {
                let order: Vec<usize> = order.iter().map(|joint| joint.checked_sub(1)).collect::<Option<_>>()?;
                self.of_signals(target, step, *signal, &|channels| channels.in_order(&order))
            }
            RemedyStep::Scale { position, torque } => self.scaled(target, step, position, torque),
            RemedyStep::Side { signal, at_motor } => {
                self.of_signals(target, step, *signal, &|channels| channels.at_side(*at_motor))
            }
            RemedyStep::Delay { delay_s, joints } => match self.estimated_filter(torque()?) {
                // What is late after a filter that is estimated is of the filter.
                Some(filter_s) if joints.is_empty() => {
                    let filter_s = (1e6 * (filter_s + delay_s)).round() / 1e6;
                    Some(vec![target.change(&["torque", "low_pass_s"], Value::from(filter_s))])
                }
                Some(_) | None => {
                    Some(vec![target.change(&["torque", "delay_s"], self.delayed(torque()?, *delay_s, joints))])
                }
            },
            RemedyStep::Hold => {
                torque()?;
                Some(vec![target.change(&["torque", "held"], Value::from(true))])
            }
            RemedyStep::LowPass { time_constant_s } => {
                let before_s = torque()?.low_pass_s.unwrap_or(0.0);
                let filter = (*time_constant_s > 0.0).then(|| Value::from(*time_constant_s));
                let delay = self.delayed(torque()?, before_s - time_constant_s, &[]);
                let changes = [("low_pass_s", filter), ("delay_s", Some(delay))];
                Some(changes.map(|(key, value)| target.change(&["torque", key], value)).to_vec())
            }
            RemedyStep::EqualSteps { sample_rate_hz } => Some(vec![
                target.change(&["time"], None),
                target.change(&["sample_rate_hz"], Value::from(*sample_rate_hz)),
            ]),
            RemedyStep::LeaveOutTimes { times } => {
                let mut all: Vec<[f64; 2]> = target.description.left_out_s.iter().chain(times).copied().collect();
                all.sort_by(|a, b| a[0].total_cmp(&b[0]));
                let all = all.into_iter().map(|time| Value::from(time.to_vec())).collect();
                Some(vec![target.change(&["left_out_s"], Value::Array(all))])
            }
            RemedyStep::CorrectReference { delay_s, scale, offset } => {
                let is_new =
                    target.description.reference.is_some() && target.description.reference_correction.is_none();
                let of = |values: &[f64]| one_or_list(values.iter().map(|v| Value::from(*v)).collect());
                let entries = [("delay_s", of(delay_s)), ("scale", of(scale)), ("offset", of(offset))];
                let table: Table = entries.into_iter().map(|(key, value)| (key.to_owned(), value)).collect();
                is_new.then(|| vec![target.change(&["reference_correction"], Value::Table(table))])
            }
            RemedyStep::Cutoff { .. }
            | RemedyStep::LeaveOutRests
            | RemedyStep::Essential { .. }
            | RemedyStep::LockJoint { .. }
            | RemedyStep::AddTerm { .. }
            | RemedyStep::Gravity { .. }
            | RemedyStep::Estimated { .. } => None,
        }
    }

    /// Positions and torques times a factor for each joint.
    fn scaled(
        &self,
        target: &Target<'_>,
        step: &RecordingStep,
        position: &[f64],
        torque: &[f64],
    ) -> Option<Vec<Change>> {
        let mut changes = Vec::new();
        for (signal, factors) in [(RemedySignal::Position, position), (RemedySignal::Torque, torque)] {
            if factors.is_empty() {
                continue;
            }
            let scaled = |channels: &Channels<'_>| {
                let mut entries = channels.scaled(factors)?;
                // Masses do not distinguish mN m from mA.
                let is_guess = signal == RemedySignal::Torque && entries.iter().any(|(key, _)| *key == "unit");
                entries.extend(is_guess.then(|| ("unit_guessed", Some(Value::from(true)))));
                Some(entries)
            };
            changes.extend(self.of_signals(target, step, signal, &scaled)?);
        }
        Some(changes)
    }

    /// The delays of a torque of which some joints, or all if none is named, are later by `delay_s`.
    fn delayed(&self, torque: &ChannelSource, delay_s: f64, joints: &[usize]) -> Value {
        let is_late = |k: usize| joints.is_empty() || joints.contains(&(k + 1));
        let own = torque.delay_s.to_list(self.robot.coordinate_count()).into_iter().enumerate();
        let delays = own.map(|(k, own)| own + if is_late(k) { delay_s } else { 0.0 });
        one_or_list(delays.map(|delay| Value::from((1e6 * delay).round() / 1e6)).collect())
    }

    /// The entries of the signals that a step changes, with the recorded reference and velocities where they have the same fault.
    fn of_signals(
        &self,
        target: &Target<'_>,
        step: &RecordingStep,
        signal: RemedySignal,
        entries: &dyn Fn(&Channels<'_>) -> Option<Vec<Entry>>,
    ) -> Option<Vec<Change>> {
        let d = target.description;
        let follows = |is_meant: bool| signal.has_position() && is_meant;
        let torque = d.torque.as_ref();
        if signal.has_torque() && torque.is_none() {
            return None;
        }
        let signals: [(&'static str, Option<&ChannelSource>); 4] = [
            ("position", Some(&d.position).filter(|_| signal.has_position())),
            ("torque", torque.filter(|_| signal.has_torque())),
            ("reference", d.reference.as_ref().filter(|_| follows(step.with_reference))),
            ("velocity", d.velocity.as_ref().filter(|_| follows(step.with_velocity))),
        ];
        let mut changes = Vec::new();
        for (name, source) in signals {
            let Some(source) = source else { continue };
            let is_position = matches!(name, "position" | "reference");
            let channels = Channels { source, robot: self.robot, is_position };
            changes.extend(entries(&channels)?.into_iter().map(|(key, value)| target.change(&[name, key], value)));
        }
        Some(changes)
    }
}

impl Target<'_> {
    fn change(&self, path: &[&str], value: impl Into<Option<Value>>) -> Change {
        let path: Vec<&str> = [self.table].into_iter().chain(path.iter().copied()).collect();
        Change::new(&path, self.index, value)
    }
}

/// Whether a term is of a kind and acts on joints; none means any.
fn acts_on(term: &TermDescription, kind: &str, joints: &[String]) -> bool {
    let has_all = term.joints().is_none_or(|own| joints.iter().all(|joint| own.contains(joint)));
    term.kind() == kind && has_all
}
