use super::{super::column_names, error::ProposalError, offer::Offer, source::Source};

/// The files of one recording, by their numbers among the offers.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Group {
    pub(super) position: usize,
    /// None if no file has torques, and one has a reference.
    pub(super) torque: Option<usize>,
    /// Files with velocities, references or times.
    pub(super) others: Vec<usize>,
}

impl Group {
    /// Its files, that of the positions first.
    pub(super) fn files(&self) -> impl Iterator<Item = usize> {
        let torque = self.torque.filter(|torque| *torque != self.position);
        [self.position].into_iter().chain(torque).chain(self.others.iter().copied())
    }
}

/// The files of each recording: a file with positions and torques is a recording by itself; files with one signal each are matched by
/// the words that their names have in common, or because there are no others.
pub(super) fn groups(offers: &[Offer<'_>], joints: usize) -> Result<Vec<Group>, ProposalError> {
    let (mut positions, mut torques, mut others) = (Vec::new(), Vec::new(), Vec::new());
    for (number, offer) in offers.iter().enumerate() {
        match (&offer.position, &offer.torque) {
            (Ok(_), _) => positions.push(number),
            (Err(_), Ok(_)) => torques.push(number),
            (Err(_), Err(_)) => others.push(number),
        }
    }
    if positions.is_empty() {
        return Err(no_signal(offers, joints, "position", |o| &o.position));
    }
    let partners = Partners { offers, positions: &positions };
    let has_torques = offers.iter().any(|offer| offer.torque.is_ok());
    let is_unclear = offers.iter().any(|offer| offer.has_unclear_torques(joints));
    let has_reference = offers.iter().any(|offer| offer.reference.is_some());
    let mut groups = Vec::new();
    for &position in &positions {
        let torque = match offers[position].torque {
            Ok(_) => Some(position),
            Err(_) if !has_torques && has_reference && !is_unclear => None,
            Err(_) if torques.is_empty() => return Err(no_signal(offers, joints, "torque", |o| &o.torque)),
            Err(_) => Some(partners.torque_of(position, &torques)?),
        };
        groups.push(Group { position, torque, others: Vec::new() });
    }
    partners.all_torques_used(&groups, &torques)?;
    for other in others {
        let group = partners.group_of(other, &groups)?;
        groups[group].others.push(other);
    }
    for group in &groups {
        same_lengths(offers, group)?;
    }
    Ok(groups)
}

struct Partners<'p, 'a> {
    offers: &'p [Offer<'a>],
    positions: &'p [usize],
}

impl Partners<'_, '_> {
    fn torque_of(&self, position: usize, torques: &[usize]) -> Result<usize, ProposalError> {
        let lacking = self.positions.iter().filter(|&&p| self.offers[p].torque.is_err()).count();
        let related = torques.iter().filter(|&&t| self.are_related(position, t)).copied().collect::<Vec<_>>();
        match (torques, &related[..]) {
            ([only], _) if lacking == 1 => Ok(*only),
            (_, [only]) => Ok(*only),
            _ => Err(self.no_partner(position, "positions")),
        }
    }

    fn all_torques_used(&self, groups: &[Group], torques: &[usize]) -> Result<(), ProposalError> {
        let users = |torque: usize| groups.iter().filter(|g| g.torque == Some(torque)).count();
        torques.iter().find(|&&t| users(t) != 1).map_or(Ok(()), |&t| Err(self.no_partner(t, "torques")))
    }

    /// The recording of a file that has neither positions nor torques.
    fn group_of(&self, other: usize, groups: &[Group]) -> Result<usize, ProposalError> {
        let offer = &self.offers[other];
        let has_time = offer.source.table.is_some_and(|t| !t.times.is_empty());
        if offer.is_empty() && !has_time {
            let (file, columns) = (offer.source.file.to_owned(), offer.source.listed());
            return Err(ProposalError::UnclearFile { file, columns });
        }
        let related: Vec<usize> = (0..groups.len()).filter(|&g| self.are_related(other, groups[g].position)).collect();
        match related[..] {
            _ if groups.len() == 1 => Ok(0),
            [only] => Ok(only),
            _ => Err(self.no_partner(other, if offer.is_empty() { "times" } else { "references or velocities" })),
        }
    }

    fn are_related(&self, a: usize, b: usize) -> bool {
        let [a, b] = [a, b].map(|n| key(&self.offers[n].source));
        a == b
    }

    fn no_partner(&self, number: usize, holds: &'static str) -> ProposalError {
        ProposalError::NoPartner { file: self.offers[number].source.file.to_owned(), holds }
    }
}

/// What the names of files of one recording have in common.
fn key(source: &Source<'_>) -> Vec<String> {
    let mut words = column_names::without_signal(&source.folder());
    words.extend(column_names::without_signal(&source.stem()));
    words
}

/// Why no file has a signal: the reason of the file that looks most like a recording.
fn no_signal<'a, 'o>(
    offers: &'o [Offer<'a>],
    joints: usize,
    signal: &'static str,
    of: impl Fn(&'o Offer<'a>) -> &'o Result<Vec<super::source::SelectedColumn<'a>>, String>,
) -> ProposalError {
    let without_signal =
        |o: &&Offer<'_>| o.is_empty() && o.source.table.is_none_or(|t| t.times.is_empty() || t.columns.len() > 1);
    if let (true, Some(offer)) = (offers.len() > 1, offers.iter().find(without_signal)) {
        return ProposalError::UnclearFile { file: offer.source.file.to_owned(), columns: offer.source.listed() };
    }
    let offer = offers.iter().find(|o| !o.is_empty()).or(offers.first());
    let source = offer.map(|o| o.source);
    ProposalError::UnclearColumns {
        file: source.map(|s| s.file.to_owned()).unwrap_or_default(),
        signal,
        problem: offer.and_then(|o| of(o).as_ref().err().cloned()).unwrap_or_default(),
        joints,
        columns: source.map(|s| s.listed()).unwrap_or_default(),
    }
}

fn same_lengths(offers: &[Offer<'_>], group: &Group) -> Result<(), ProposalError> {
    let first = &offers[group.position].source;
    let different = group.files().map(|f| &offers[f].source).find(|s| s.samples() != first.samples());
    different.map_or(Ok(()), |other| {
        Err(ProposalError::DifferentLengths {
            file: first.place_name(),
            samples: first.samples(),
            other: other.place_name(),
            other_samples: other.samples(),
        })
    })
}
