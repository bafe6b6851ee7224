//! The runs of a campaign, by several threads.

use std::{collections::BTreeMap, path::PathBuf};

use super::{
    Store,
    bench::Bench,
    description::{Campaign, Subset},
    error::CampaignError,
    facts::Facts,
    row::{Key, Row},
};
use crate::scheduling::SIDE_BY_SIDE;
use thetahat_ground::pool::as_finished;

/// The runs of a campaign.
#[derive(Debug, Clone)]
pub struct CampaignRuns {
    /// What they have in common.
    pub facts: Facts,
    /// The rows, by noise level, start, seed, case and method.
    pub rows: Vec<Row>,
    /// The files that hold them.
    pub files: Vec<PathBuf>,
}

/// Progress of a campaign in recordings, each with all its cases and methods.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// Recordings done by earlier commands.
    pub before: usize,
    /// Recordings done now.
    pub done: usize,
    /// Recordings to do now.
    pub to_do: usize,
}

impl Campaign {
    /// Runs what is not in the store yet and returns all rows; each of `threads` runs four recordings at a time. Rows are the same for any
    /// number of threads, and with or without a store.
    ///
    /// A run that fails is a row with its status and reason.
    ///
    /// # Errors
    /// [`CampaignError`] for input that cannot be used, and for a store that cannot be read or written.
    pub fn run(
        &self,
        limits: Subset,
        threads: usize,
        store: Option<&Store>,
        progress: &mut dyn FnMut(Progress),
    ) -> Result<CampaignRuns, CampaignError> {
        self.run_on(&Bench::new(self, limits)?, limits, threads, store, progress)
    }

    /// The same on a bench that was made for these limits.
    ///
    /// # Errors
    /// As [`Campaign::run`].
    pub fn run_on(
        &self,
        bench: &Bench,
        limits: Subset,
        threads: usize,
        store: Option<&Store>,
        progress: &mut dyn FnMut(Progress),
    ) -> Result<CampaignRuns, CampaignError> {
        let (mut recordings, missing) = self.done_and_missing(bench, limits, store)?;
        let before = recordings.len();
        let progress_of = |done| Progress { before, done, to_do: missing.len() };
        progress(progress_of(0));
        let found = run_all(bench, &missing, threads, store, &mut |done| progress(progress_of(done)))?;
        recordings.extend(found);
        let rows: Vec<Row> = recordings.into_values().flatten().collect();
        let files = store.map(|s| s.finish(&rows, &bench.facts)).transpose()?.unwrap_or_default();
        Ok(CampaignRuns { facts: bench.facts.clone(), rows, files })
    }

    /// The recordings within the limits that a store does not have, in the order of the rows.
    ///
    /// # Errors
    /// [`CampaignError`] for a store that cannot be read.
    pub fn missing(&self, bench: &Bench, limits: Subset, store: &Store) -> Result<Vec<Key>, CampaignError> {
        Ok(self.done_and_missing(bench, limits, Some(store))?.1)
    }

    fn done_and_missing(
        &self,
        bench: &Bench,
        limits: Subset,
        store: Option<&Store>,
    ) -> Result<(RowsByKey, Vec<Key>), CampaignError> {
        let recordings = store.map(|s| s.finished(self, &bench.facts)).transpose()?.unwrap_or_default();
        let missing = self.keys(limits).into_iter().filter(|key| !recordings.contains_key(key)).collect();
        Ok((recordings, missing))
    }

    /// Every recording within the limits, in the order of the rows.
    #[must_use]
    pub fn keys(&self, limits: Subset) -> Vec<Key> {
        let starts = limits.starts.unwrap_or(u32::MAX).min(self.file.starts.count);
        let seeds = limits.seeds.unwrap_or(u32::MAX).min(self.file.seeds);
        let levels = 0..u32::try_from(self.file.noise.len()).unwrap_or(u32::MAX);
        let of_level =
            |level| (0..starts).flat_map(move |start| (0..seeds).map(move |seed| Key { level, start, seed }));
        levels.flat_map(of_level).collect()
    }
}

type RowsByKey = BTreeMap<Key, Vec<Row>>;

/// Runs the recordings in small groups on `threads` threads, which store the rows as soon as a group is done. The first error stops
/// all.
fn run_all(
    bench: &Bench,
    keys: &[Key],
    threads: usize,
    store: Option<&Store>,
    progress: &mut dyn FnMut(usize),
) -> Result<RowsByKey, CampaignError> {
    let groups: Vec<&[Key]> = keys.chunks(SIDE_BY_SIDE).collect();
    let work = |place: usize| {
        let of_recordings = bench.run(groups[place])?;
        let mut each = groups[place].iter().zip(&of_recordings);
        each.try_for_each(|(key, rows)| store.map_or(Ok(()), |s| s.keep(*key, rows, &bench.facts)))?;
        Ok::<_, CampaignError>(of_recordings)
    };
    let mut recordings = RowsByKey::new();
    as_finished(groups.len(), threads, work, |place, of_recordings| {
        recordings.extend(groups[place].iter().copied().zip(of_recordings?));
        progress(recordings.len());
        Ok::<(), CampaignError>(())
    })?;
    Ok(recordings)
}
