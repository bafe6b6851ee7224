use super::{
    clock::clock,
    error::ProposalError,
    grouping::{Group, groups},
    offer::{Offer, offers},
    request::ProposalRequest,
    source::{Chosen, Source},
    text::{Proposal, ProposedChannels, ProposedRecording, ProposedSignal},
    units::{Measured, Units, range},
};
use crate::{recording::Contents, robot::Robot};

/// A reference whose range is beyond this many times the positions', or below the inverse, is in another unit.
const REFERENCE_RANGE: f64 = 3.0;

/// An experiment proposed for a robot and its recordings, one [`Contents`] for each file of the request.
///
/// Least squares alone is proposed: the other methods need the controller, which no recording tells.
///
/// # Errors
/// [`ProposalError`] where columns or files cannot be told from their names; nothing is guessed from the order of columns.
pub fn propose(request: &ProposalRequest, robot: &Robot, contents: &[Contents]) -> Result<Proposal, ProposalError> {
    let offers = offers(request, robot, contents)?;
    let groups = groups(&offers, robot.coordinate_count())?;
    let proposed = |group: &Group| Describer { request, robot, offers: &offers, group }.recording(groups.len() > 1);
    let recordings = groups.iter().map(proposed).collect::<Result<Vec<_>, _>>()?;
    let rate_hz = recordings.iter().map(|r| r.clock.rate_hz).fold(f64::INFINITY, f64::min);
    let first = offers[groups[0].position].source.file.display();
    let more = if contents.len() > 1 { format!(" and {} more", contents.len() - 1) } else { String::new() };
    Ok(Proposal {
        title: format!("{}: {first}{more}", robot.name),
        robot_file: request.robot_file.clone(),
        recordings,
        signal: ProposedSignal::usual(rate_hz),
    })
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
            ("position", described(&p.source, position, &unit)),
            ("torque", described(&t.source, torque, &self.units(t).of_torque(torque, &unit))),
        ];
        if let Some((offer, reference)) = self.other(|o| o.reference.as_deref()) {
            channels.push(("reference", reference_of(&offer.source, reference, position, &unit)));
        }
        if let Some((offer, velocity)) = self.other(|o| o.velocity.as_deref()) {
            channels.push(("velocity", described(&offer.source, velocity, &self.units(offer).of_velocity(&unit))));
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
}

fn described(source: &Source<'_>, columns: &[Chosen<'_>], measured: &Measured) -> ProposedChannels {
    let [least, most] = range(columns);
    ProposedChannels {
        file: source.file.to_owned(),
        topic: source.topic().map(str::to_owned),
        columns: columns.iter().map(|c| c.name.clone()).collect(),
        unit: measured.unit,
        side: measured.side,
        comment: format!("From {least:.4} to {most:.4}; unit {}.", measured.why),
        left_out: false,
    }
}

/// The reference in the unit of the positions; left out where its range says that it is in another.
fn reference_of(
    source: &Source<'_>,
    reference: &[Chosen<'_>],
    position: &[Chosen<'_>],
    unit: &Measured,
) -> ProposedChannels {
    let channels = described(source, reference, &Measured { why: "as the positions".to_owned(), ..unit.clone() });
    let [of_position, of_reference] = [position, reference].map(|c| range(c)).map(|[least, most]| most - least);
    let ratio = of_position / of_reference;
    if (1.0 / REFERENCE_RANGE..REFERENCE_RANGE).contains(&ratio) {
        return channels;
    }
    let why =
        format!("Left out: the positions' range is {ratio:.4} times its range; add gain = [...] to put it right.");
    ProposedChannels { comment: format!("{} {why}", channels.comment), left_out: true, ..channels }
}
