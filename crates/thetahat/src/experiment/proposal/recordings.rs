use std::{collections::BTreeMap, path::PathBuf};

use super::{
    super::column_names::Signal,
    clock::clock,
    columns,
    control::control,
    error::ProposalError,
    grouping::{Group, groups},
    joints::{JointsOfLog, rounded},
    named::with_groups,
    of_driver::{self, joint_names, likely_drivers, with_drivers},
    offer::{Offer, offers, sources, tables},
    request::ProposalRequest,
    set_aside::SetAside,
    source::{SelectedColumn, Source},
    standing::standing,
    stated::Stated,
    text::{Proposal, ProposedChannels, ProposedRecording, ProposedSignal},
    unit_names::Misfit,
    units::{Measured, Units, range},
};
use thetahat_data::recording::Contents;
use thetahat_ground::{one_or_each::OneOrEach, visible::visible};
use thetahat_model::robot::{Robot, RobotSource};

/// A reference whose range is beyond this many times the positions', or below the inverse, is in another unit.
const REFERENCE_RANGE: f64 = 3.0;

/// An experiment proposed for a robot and its recordings, one [`Contents`] for each file of the request.
///
/// Methods that fit torques are proposed; of a log without torques, but with a reference, CLOE, which fits positions and takes the
/// gains of the controller.
///
/// # Errors
/// [`ProposalError`] where columns or files are not clear from their names; nothing is guessed from the order of columns.
pub fn propose(
    request: &ProposalRequest,
    description: &RobotSource,
    contents: &[Contents],
) -> Result<Proposal, ProposalError> {
    let proposed = proposed(request, description, contents);
    Ok(proposed.map_err(|error| with_drivers(error, &likely_drivers(request, contents)))?.0)
}

/// [`propose`] with the joints locked that stand in all recordings: nothing of their own can be identified.
///
/// # Errors
/// As [`propose`].
pub fn propose_for_motion(
    request: &ProposalRequest,
    description: &RobotSource,
    contents: &[Contents],
) -> Result<Proposal, ProposalError> {
    let proposed_of = |request: &ProposalRequest| proposed(request, description, contents);
    let (proposal, standing) =
        proposed_of(request).map_err(|error| with_drivers(error, &likely_drivers(request, contents)))?;
    if standing.is_empty() {
        return Ok(proposal);
    }
    let mut locked = request.locked.clone();
    locked.extend(standing.iter().map(|(joint, [least, most])| (joint.clone(), rounded(0.5 * (least + most)))));
    // A robot that cannot be locked there is proposed as a whole.
    let Ok((mut with_locks, _)) = proposed_of(&ProposalRequest { locked, ..request.clone() }) else {
        return Ok(proposal);
    };
    for lock in &mut with_locks.locks {
        if let Some([least, most]) = standing.get(&lock.joint) {
            lock.why = format!("a guess, as it moves by {} in the log", short(most - least));
        }
    }
    Ok(with_locks)
}

/// The proposal, and the joints that stand, with least and largest position.
fn proposed(
    request: &ProposalRequest,
    description: &RobotSource,
    contents: &[Contents],
) -> Result<(Proposal, BTreeMap<String, [f64; 2]>), ProposalError> {
    let tables = tables(request, contents, &joint_names(request, description)?);
    let sources = sources(request, contents, &tables);
    of_driver::require_columns(request, &sources)?;
    let whole = description.robot_without_transmission();
    let whole = whole.map_err(|error| ProposalError::Robot { problem: error.to_string() })?;
    let request = &with_groups(request, &sources, &whole);
    let joints = JointsOfLog::find(request, description, &sources)?;
    let robot = &joints.robot;
    let offers = offers(request, &joints, &sources)?;
    let groups = groups(&offers, robot.coordinate_count())?;
    let proposed = |group: &Group| Describer { request, robot, offers: &offers, group }.recording(groups.len() > 1);
    let recordings = groups.iter().map(proposed).collect::<Result<Vec<_>, _>>()?;
    let rate_hz = recordings.iter().map(|r| r.clock.rate_hz).fold(f64::INFINITY, f64::min);
    let set_aside = set_aside(request, &sources, robot, &recordings);
    let first = offers[groups[0].position].source.file.display();
    let more = if contents.len() > 1 { format!(" and {} more", contents.len() - 1) } else { String::new() };
    let proposal = Proposal {
        title: format!("{}: {first}{more}", robot.name),
        robot_file: request.robot_file.clone(),
        locks: joints.locks.clone(),
        unused: unused(&sources, &recordings, &set_aside),
        set_aside,
        unused_files: unused_files(&sources, &recordings),
        control: groups.iter().any(|g| g.torque.is_none()).then(|| control(request, &sources, robot)),
        driver: of_driver::proposed(request, &sources, &recordings),
        likely_drivers: likely_drivers(request, contents),
        recordings,
        stated: Stated::of(request),
        signal: ProposedSignal::usual(rate_hz).with_window(request.window_s),
    };
    Ok((proposal, standing(request, &joints, &offers, &groups)))
}

/// Columns that were set aside in the files that are used, by why.
fn set_aside(
    request: &ProposalRequest,
    sources: &[Source<'_>],
    robot: &Robot,
    recordings: &[ProposedRecording],
) -> Vec<SetAside> {
    let of_signal = |source: &Source<'_>, signal: Signal, named: &[String]| match named {
        [] => columns::measured(source, robot, signal).1,
        [..] => Vec::new(),
    };
    let of_source = |source: &Source<'_>| {
        let position = of_signal(source, Signal::Position, &request.position);
        [position, of_signal(source, Signal::Torque, &request.torque)].concat()
    };
    let mut found: Vec<SetAside> = Vec::new();
    for one in sources.iter().filter(|source| uses(recordings, source)).flat_map(of_source) {
        match found.iter_mut().find(|known| known.why == one.why) {
            Some(known) => known.columns.extend(one.columns),
            None => found.push(one),
        }
    }
    found
}

/// Columns of signals that are not used in the proposal, of the files that are.
fn unused(sources: &[Source<'_>], recordings: &[ProposedRecording], set_aside: &[SetAside]) -> Vec<String> {
    let used: Vec<&ProposedChannels> = recordings.iter().flat_map(used_channels).collect();
    let is_used = |name: &String| {
        let mut columns = used.iter().flat_map(|channels| &channels.columns);
        columns.any(|column| column == name || column.strip_prefix(name.as_str()).is_some_and(|i| i.starts_with('[')))
    };
    let of_source = |source: &Source<'_>| {
        let is_signal = |name: &String| source.reading(name).is_some_and(|r| r.signal != Signal::Time);
        let is_set_aside = |name: &String| set_aside.iter().any(|set_aside| set_aside.columns.contains(name));
        let of_signals = source.names().into_iter().filter(is_signal);
        of_signals.filter(|name| !is_used(name) && !is_set_aside(name)).collect::<Vec<_>>()
    };
    sources.iter().filter(|source| uses(recordings, source)).flat_map(of_source).collect()
}

/// Files of which nothing is used.
fn unused_files(sources: &[Source<'_>], recordings: &[ProposedRecording]) -> Vec<PathBuf> {
    sources.iter().filter(|source| !uses(recordings, source)).map(|source| source.file.to_owned()).collect()
}

fn uses(recordings: &[ProposedRecording], source: &Source<'_>) -> bool {
    recordings.iter().flat_map(used_channels).any(|channels| {
        channels.file == source.file && (!source.is_one_topic || channels.topic.as_deref() == source.topic())
    })
}

/// A number with at most four decimals, without trailing zeros.
fn short(value: f64) -> String {
    let text = format!("{value:.4}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

fn used_channels(recording: &ProposedRecording) -> impl Iterator<Item = &ProposedChannels> {
    recording.channels.iter().map(|(_, channels)| channels).chain(&recording.clock.time)
}

struct Describer<'d, 'a> {
    request: &'d ProposalRequest,
    robot: &'d Robot,
    offers: &'d [Offer<'a>],
    group: &'d Group,
}

impl<'a> Describer<'_, 'a> {
    fn recording(&self, named: bool) -> Result<ProposedRecording, ProposalError> {
        let p = &self.offers[self.group.position];
        let position = p.position.as_deref().unwrap_or_default();
        let unit = self.units(p).of_position(position)?;
        let mut channels = vec![("position", self.described(Signal::Position, p, position, &unit))];
        if let Some(t) = self.group.torque.map(|torque| &self.offers[torque]) {
            let torque = t.torque.as_deref().unwrap_or_default();
            let of_torque = self.units(t).of_torque(torque, &unit)?;
            let described = self.described(Signal::Torque, t, torque, &of_torque);
            channels.push(("torque", with_torque_gain(self.request, described)));
        }
        if let Some((offer, reference)) = self.other(|o| o.reference.as_deref()) {
            channels.push(("reference", self.reference_of(offer, reference, position, &unit)));
        }
        if let Some((offer, velocity)) = self.other(|o| o.velocity.as_deref()) {
            channels.push(("velocity", self.described_as(Signal::Velocity, offer, velocity, &unit).0));
        }
        let clock = clock(self.request, self.offers, self.group)?;
        Ok(ProposedRecording { name: named.then(|| p.source.stem()), clock, channels })
    }

    fn units(&self, offer: &Offer<'a>) -> Units<'_, 'a> {
        let joints = self.robot.coordinates().collect();
        Units { request: self.request, robot: self.robot, source: offer.source, joints }
    }

    /// The first of the files that has a signal.
    fn other<'o>(
        &'o self,
        of: impl Fn(&'o Offer<'a>) -> Option<&'o [SelectedColumn<'a>]>,
    ) -> Option<(&'o Offer<'a>, &'o [SelectedColumn<'a>])> {
        self.group.files().map(|file| &self.offers[file]).find_map(|offer| Some((offer, of(offer)?)))
    }

    fn described(
        &self,
        signal: Signal,
        offer: &Offer<'a>,
        columns: &[SelectedColumn<'_>],
        measured: &Measured,
    ) -> ProposedChannels {
        let [least, most] = range(columns);
        let source = &offer.source;
        ProposedChannels {
            file: source.file.to_owned(),
            topic: source.topic().map(str::to_owned),
            columns: columns.iter().map(|c| c.name.clone()).collect(),
            unit: measured.unit(),
            side: measured.side,
            drop_cut_line: source.is_cut(),
            channels_in_rows: columns.iter().any(|c| c.in_rows),
            comment: format!("From {} to {}; unit {}.", short(least), short(most), measured.why),
            gain: measured.gain.clone(),
            factor: measured.factor.clone(),
            unit_guessed: measured.unit_guessed,
            contradiction: self.units(offer).contradiction(signal, columns, measured),
            left_out: false,
        }
    }

    /// A signal that is not needed, and its units; left out where its names have a unit that cannot be its own.
    fn described_as(
        &self,
        signal: Signal,
        offer: &Offer<'a>,
        columns: &[SelectedColumn<'_>],
        position: &Measured,
    ) -> (ProposedChannels, Option<Measured>) {
        match self.units(offer).of_other(signal, columns, position) {
            Ok(measured) => (self.described(signal, offer, columns, &measured), Some(measured)),
            Err(Misfit { column, problem, .. }) => {
                let channels = self.described(signal, offer, columns, position);
                let why = format!("Left out: column {column:?} is {problem}.");
                (ProposedChannels { comment: visible(&why).into_owned(), left_out: true, ..channels }, None)
            }
        }
    }

    /// The reference; left out where its range says that it is in another unit.
    fn reference_of(
        &self,
        offer: &Offer<'a>,
        reference: &[SelectedColumn<'_>],
        position: &[SelectedColumn<'_>],
        of_position: &Measured,
    ) -> ProposedChannels {
        let (channels, measured) = self.described_as(Signal::Reference, offer, reference, of_position);
        let Some(measured) = measured else { return channels };
        let ratio = travel(position, of_position) / travel(reference, &measured);
        if (1.0 / REFERENCE_RANGE..REFERENCE_RANGE).contains(&ratio) {
            return channels;
        }
        let why =
            format!("Left out: the positions' range is {ratio:.4} times its range; add gain = [...] to put it right.");
        ProposedChannels { comment: format!("{} {why}", channels.comment), left_out: true, ..channels }
    }
}

/// The channels of torques with the gains that are stated, in place of those that were found or are to be filled in.
fn with_torque_gain(request: &ProposalRequest, channels: ProposedChannels) -> ProposedChannels {
    let factor = match &request.torque_gain[..] {
        [] => return channels,
        [one] => OneOrEach::One(*one),
        several => OneOrEach::Each(several.to_vec()),
    };
    ProposedChannels { gain: None, factor: Some(factor), ..channels }
}

/// From the least to the largest value, in SI units.
fn travel(columns: &[SelectedColumn<'_>], measured: &Measured) -> f64 {
    let channels = columns.iter().flat_map(|c| c.channels).enumerate();
    let ends = channels.flat_map(|(number, channel)| [channel.min, channel.max].map(|end| (number, end)));
    let ends = ends.map(|(number, end)| end.map(|end| end * measured.to_si(number)));
    let (least, most) =
        ends.flatten().fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), v| (v.min(least), v.max(most)));
    most - least
}
