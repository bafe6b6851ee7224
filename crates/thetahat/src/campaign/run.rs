//! The runs of a campaign, by several threads.

use std::{collections::BTreeMap, path::PathBuf};

use super::{
    Store,
    description::{Campaign, Subset},
    error::CampaignError,
    facts::Facts,
    record::Bench,
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

/// How far a campaign is: records, each with all its cases and methods.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// Records done by earlier commands.
    pub before: usize,
    /// Records done now.
    pub done: usize,
    /// Records to do now.
    pub to_do: usize,
}

impl Campaign {
    /// Runs what is not in the store yet and returns all rows; each of `threads` takes four records at a time. Rows are the same for any
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
        let (mut records, missing) = self.done_and_missing(bench, limits, store)?;
        let before = records.len();
        let tell = |done| Progress { before, done, to_do: missing.len() };
        progress(tell(0));
        let found = run_all(bench, &missing, threads, store, &mut |done| progress(tell(done)))?;
        records.extend(found);
        let rows: Vec<Row> = records.into_values().flatten().collect();
        let files = store.map(|s| s.finish(&rows, &bench.facts)).transpose()?.unwrap_or_default();
        Ok(CampaignRuns { facts: bench.facts.clone(), rows, files })
    }

    /// The records within the limits that a store does not have, in the order of the rows.
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
    ) -> Result<(Records, Vec<Key>), CampaignError> {
        let records = store.map(|s| s.finished(self, &bench.facts)).transpose()?.unwrap_or_default();
        let missing = self.keys(limits).into_iter().filter(|key| !records.contains_key(key)).collect();
        Ok((records, missing))
    }

    /// Every record within the limits, in the order of the rows.
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

type Records = BTreeMap<Key, Vec<Row>>;

/// Runs the records in small groups, so many of these at a time; whoever ran them keeps their rows. The first error stops
/// all.
fn run_all(
    bench: &Bench,
    keys: &[Key],
    threads: usize,
    store: Option<&Store>,
    progress: &mut dyn FnMut(usize),
) -> Result<Records, CampaignError> {
    let groups: Vec<&[Key]> = keys.chunks(SIDE_BY_SIDE).collect();
    let work = |place: usize| {
        let of_records = bench.run(groups[place])?;
        let mut each = groups[place].iter().zip(&of_records);
        each.try_for_each(|(key, rows)| store.map_or(Ok(()), |s| s.keep(*key, rows, &bench.facts)))?;
        Ok::<_, CampaignError>(of_records)
    };
    let mut records = Records::new();
    as_finished(groups.len(), threads, work, |place, of_records| {
        records.extend(groups[place].iter().copied().zip(of_records?));
        progress(records.len());
        Ok::<(), CampaignError>(())
    })?;
    Ok(records)
}
