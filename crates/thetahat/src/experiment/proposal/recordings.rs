use super::{
    super::column_names::{self, Signal},
    clock::clock,
    error::ProposalError,
    grouping::{Group, groups},
    joints::JointsOfLog,
    offer::{Offer, offers, sources},
    request::ProposalRequest,
    source::{Chosen, Source},
    text::{Proposal, ProposedChannels, ProposedRecording, ProposedSignal},
    units::{Measured, Units, range},
};
use crate::{
    one_or_each::OneOrEach,
    recording::{Contents, Dimension, Unit},
    robot::{JointKind, Robot, RobotSource},
};

/// A reference whose range is beyond this many times the positions', or below the inverse, is in another unit.
const REFERENCE_RANGE: f64 = 3.0;

/// An experiment proposed for a robot and its recordings, one [`Contents`] for each file of the request.
///
/// Least squares alone is proposed: the other methods need the controller, which no recording tells.
///
/// # Errors
/// [`ProposalError`] where columns or files cannot be told from their names; nothing is guessed from the order of columns.
pub fn propose(
    request: &ProposalRequest,
    description: &RobotSource,
    contents: &[Contents],
) -> Result<Proposal, ProposalError> {
    let sources = sources(request, contents);
    let joints = JointsOfLog::find(request, description, &sources)?;
    let robot = &joints.robot;
    let offers = offers(request, &joints, &sources)?;
    let groups = groups(&offers, robot.coordinate_count())?;
    let proposed = |group: &Group| Describer { request, robot, offers: &offers, group }.recording(groups.len() > 1);
    let recordings = groups.iter().map(proposed).collect::<Result<Vec<_>, _>>()?;
    let rate_hz = recordings.iter().map(|r| r.clock.rate_hz).fold(f64::INFINITY, f64::min);
    let first = offers[groups[0].position].source.file.display();
    let more = if contents.len() > 1 { format!(" and {} more", contents.len() - 1) } else { String::new() };
    Ok(Proposal {
        title: format!("{}: {first}{more}", robot.name),
        robot_file: request.robot_file.clone(),
        locks: joints.locks.clone(),
        unused: unused(&sources, &recordings),
        recordings,
        signal: ProposedSignal::usual(rate_hz).with_window(request.window_s),
    })
}

/// Positions and torques that belong to no joint of the proposal.
fn unused(sources: &[Source<'_>], recordings: &[ProposedRecording]) -> Vec<String> {
    let is_used = |name: &String| {
        let used = recordings.iter().flat_map(|r| &r.channels).flat_map(|(_, channels)| &channels.columns);
        used.into_iter()
            .any(|column| column == name || column.strip_prefix(name.as_str()).is_some_and(|i| i.starts_with('[')))
    };
    let is_signal =
        |name: &String| column_names::read(name).is_some_and(|r| matches!(r.signal, Signal::Position | Signal::Torque));
    sources.iter().flat_map(|source| source.names()).filter(|name| is_signal(name) && !is_used(name)).collect()
}

struct Describer<'d, 'a> {
    request: &'d ProposalRequest,
    robot: &'d Robot,
    offers: &'d [Offer<'a>],
    group: &'d Group,
}

impl<'a> Describer<'_, 'a> {
    fn recording(&self, named: bool) -> Result<ProposedRecording, ProposalError> {
        let (p, t) = (&self.offers[self.group.position], &self.offers[self.group.torque]);
        let (position, torque) = (p.position.as_deref().unwrap_or_default(), t.torque.as_deref().unwrap_or_default());
        let unit = self.units(p).of_position(position);
        let mut channels = vec![
            ("position", self.described(&p.source, position, &unit)),
            ("torque", self.described(&t.source, torque, &self.units(t).of_torque(torque, &unit))),
        ];
        if let Some((offer, reference)) = self.other(|o| o.reference.as_deref()) {
            channels.push(("reference", self.reference_of(&offer.source, reference, position, &unit)));
        }
        if let Some((offer, velocity)) = self.other(|o| o.velocity.as_deref()) {
            channels.push(("velocity", self.described(&offer.source, velocity, &self.units(offer).of_velocity(&unit))));
        }
        let clock = clock(self.request, self.offers, self.group)?;
        Ok(ProposedRecording { name: named.then(|| p.source.stem()), clock, channels })
    }

    fn units(&self, offer: &Offer<'a>) -> Units<'_, 'a> {
        Units { request: self.request, robot: self.robot, source: offer.source }
    }

    /// The first of the files that has a signal.
    fn other<'o>(
        &'o self,
        of: impl Fn(&'o Offer<'a>) -> Option<&'o [Chosen<'a>]>,
    ) -> Option<(&'o Offer<'a>, &'o [Chosen<'a>])> {
        self.group.files().map(|file| &self.offers[file]).find_map(|offer| Some((offer, of(offer)?)))
    }

    fn described(&self, source: &Source<'_>, columns: &[Chosen<'_>], measured: &Measured) -> ProposedChannels {
        let [least, most] = range(columns);
        ProposedChannels {
            file: source.file.to_owned(),
            topic: source.topic().map(str::to_owned),
            columns: columns.iter().map(|c| c.name.clone()).collect(),
            unit: of_joints(self.robot, measured.unit),
            side: measured.side,
            drop_cut_line: source.is_cut(),
            channels_in_rows: columns.iter().any(|c| c.in_rows),
            comment: format!("From {least:.4} to {most:.4}; unit {}.", measured.why),
            left_out: false,
        }
    }

    /// The reference in the unit of the positions; left out where its range says that it is in another.
    fn reference_of(
        &self,
        source: &Source<'_>,
        reference: &[Chosen<'_>],
        position: &[Chosen<'_>],
        unit: &Measured,
    ) -> ProposedChannels {
        let channels =
            self.described(source, reference, &Measured { why: "as the positions".to_owned(), ..unit.clone() });
        let [of_position, of_reference] = [position, reference].map(|c| range(c)).map(|[least, most]| most - least);
        let ratio = of_position / of_reference;
        if (1.0 / REFERENCE_RANGE..REFERENCE_RANGE).contains(&ratio) {
            return channels;
        }
        let why =
            format!("Left out: the positions' range is {ratio:.4} times its range; add gain = [...] to put it right.");
        ProposedChannels { comment: format!("{} {why}", channels.comment), left_out: true, ..channels }
    }
}

/// A unit for each joint, where some of them turn and others slide.
fn of_joints(robot: &Robot, unit: Unit) -> OneOrEach<Unit> {
    let kinds: Vec<JointKind> = robot.coordinates().map(|j| j.kind).collect();
    if kinds.windows(2).all(|pair| pair[0] == pair[1]) {
        return OneOrEach::One(unit);
    }
    let (angular, linear) = match unit.dimension() {
        Dimension::Angle => (unit, Unit::Metre),
        Dimension::Length => (Unit::Radian, unit),
        Dimension::AngularVelocity => (unit, Unit::MetrePerSecond),
        Dimension::LinearVelocity => (Unit::RadianPerSecond, unit),
        Dimension::Torque => (unit, Unit::Newton),
        Dimension::Force => (Unit::NewtonMetre, unit),
        Dimension::AngularAcceleration
        | Dimension::LinearAcceleration
        | Dimension::Current
        | Dimension::Voltage
        | Dimension::Time
        | Dimension::Dimensionless => return OneOrEach::One(unit),
    };
    let of_kind = |kind: &JointKind| match kind {
        JointKind::Revolute => angular,
        JointKind::Prismatic => linear,
    };
    OneOrEach::Each(kinds.iter().map(of_kind).collect())
}
