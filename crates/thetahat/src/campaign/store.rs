//! A folder with the results of a campaign: a part for each recording while it runs, and two files at its end.

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
};

use serde::{Deserialize, Serialize};

use super::{
    Campaign, CampaignError, Key, Row,
    bench::Bench,
    facts::Facts,
    files::{refuse, replace_file},
    parquet_file::{self, Content},
};
use thetahat_ground::{
    files,
    output::{FileLock, TEMPORARY},
};

const MANIFEST: &str = "campaign.json";
const RUNS: &str = "runs.parquet";
const TIMING: &str = "timing.parquet";
const PARTS: &str = "parts";

/// A folder of results, checked to belong to one campaign.
#[derive(Debug, Clone)]
pub struct Store {
    folder: PathBuf,
    /// Holds the folder's lock: other campaigns are refused there.
    _lock: FileLock,
}

/// What the runs of a folder were made from.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct Manifest {
    thetahat: String,
    campaign: String,
    experiment: String,
    robot: String,
    /// SHA-256 of the file that the twin follows, where it follows one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    reference_sha256: Option<String>,
}

impl Manifest {
    fn of(campaign: &Campaign) -> Result<Self, CampaignError> {
        Ok(Self {
            thetahat: env!("CARGO_PKG_VERSION").to_owned(),
            campaign: campaign.text.clone(),
            experiment: campaign.experiment.text.clone(),
            robot: campaign.experiment.robot_text.clone(),
            reference_sha256: campaign.experiment.reference_sha256()?,
        })
    }

    /// What differs from another one.
    fn change(&self, other: &Self) -> Option<&'static str> {
        [
            ("the version of thetahat", self.thetahat == other.thetahat),
            ("the campaign file", self.campaign == other.campaign),
            ("the experiment file", self.experiment == other.experiment),
            ("the robot description", self.robot == other.robot),
            ("the file of [twin] reference", self.reference_sha256 == other.reference_sha256),
        ]
        .into_iter()
        .find_map(|(what, same)| (!same).then_some(what))
    }
}

impl Store {
    /// Opens a folder, or makes it; it must be new or empty, or hold runs of this very campaign. Until the store and its clones are
    /// dropped, another one cannot open the folder.
    ///
    /// # Errors
    /// [`CampaignError`] for a folder of another campaign or of other files, or one that cannot be written.
    pub fn open(folder: &Path, campaign: &Campaign) -> Result<Self, CampaignError> {
        let parts = folder.join(PARTS);
        let (path, manifest) = (folder.join(MANIFEST), Manifest::of(campaign)?);
        if !files::exists(&path) {
            require_empty(folder)?;
            fs::create_dir_all(folder).map_err(|e| refuse(folder, &e))?;
            let text = serde_json::to_string_pretty(&manifest).map_err(|e| refuse(&path, &e))?;
            replace_file(&path, text.as_bytes())?;
        }
        fs::create_dir_all(&parts).map_err(|e| refuse(&parts, &e))?;
        let text = files::read_to_string(&path)
            .map_err(|e| CampaignError::Unreadable { path: path.clone(), reason: e.to_string() })?;
        let found: Manifest = serde_json::from_str(&text)
            .map_err(|e| CampaignError::Damaged { path: path.clone(), problem: e.to_string() })?;
        let _lock = locked(folder, &path)?;
        match manifest.change(&found) {
            None => Ok(Self { folder: folder.to_owned(), _lock }),
            Some(what) => Err(CampaignError::OtherCampaign { folder: folder.to_owned(), changed: what.to_owned() }),
        }
    }

    /// The rows of the recordings that are done.
    pub(super) fn finished(
        &self,
        campaign: &Campaign,
        facts: &Facts,
    ) -> Result<BTreeMap<Key, Vec<Row>>, CampaignError> {
        let mut recordings = BTreeMap::new();
        for row in self.merged(facts)? {
            let key = key_of(campaign, &row).ok_or_else(|| self.unknown(&row))?;
            recordings.entry(key).or_insert_with(Vec::new).push(row);
        }
        for path in self.part_files()? {
            recordings.extend(part(campaign, &path, facts)?);
        }
        Ok(recordings)
    }

    /// Stores the rows of one recording.
    pub(super) fn keep(&self, key: Key, rows: &[Row], facts: &Facts) -> Result<(), CampaignError> {
        let name = format!("{:02}-{:05}-{:05}.parquet", key.level + 1, key.start + 1, key.seed + 1);
        parquet_file::write(&self.parts().join(name), rows, facts, Content::Everything)
    }

    /// Writes the two files of all rows, then deletes the parts. Returns the paths of the two.
    pub(super) fn finish(&self, rows: &[Row], facts: &Facts) -> Result<Vec<PathBuf>, CampaignError> {
        let paths = [self.folder.join(TIMING), self.folder.join(RUNS)];
        parquet_file::write(&paths[0], rows, facts, Content::Timing)?;
        parquet_file::write(&paths[1], rows, facts, Content::Results)?;
        for path in self.part_files()? {
            fs::remove_file(&path).map_err(|e| refuse(&path, &e))?;
        }
        Ok(paths.into())
    }

    /// The rows of earlier commands, with their times.
    fn merged(&self, facts: &Facts) -> Result<Vec<Row>, CampaignError> {
        let [timing, runs] = [self.folder.join(TIMING), self.folder.join(RUNS)];
        if !files::exists(&runs) {
            return Ok(Vec::new());
        }
        let mut rows = parquet_file::read(&runs, facts)?;
        let seconds = if files::exists(&timing) { parquet_file::read_seconds(&timing)? } else { Vec::new() };
        // A run killed between the two files leaves more times than rows; the parts, still there, hold everything.
        if seconds.len() == rows.len() {
            rows.iter_mut().zip(seconds).for_each(|(row, s)| row.seconds = s);
        }
        Ok(rows)
    }

    fn parts(&self) -> PathBuf {
        self.folder.join(PARTS)
    }

    /// The parts in the order of their names; incomplete files of a killed program are deleted.
    fn part_files(&self) -> Result<Vec<PathBuf>, CampaignError> {
        let parts = self.parts();
        let entries = fs::read_dir(&parts).map_err(|e| refuse(&parts, &e))?;
        let mut files = Vec::new();
        for entry in entries {
            let path = entry.map_err(|e| refuse(&parts, &e))?.path();
            if path.extension().is_some_and(|e| e == "parquet") {
                files.push(path);
            } else if is_temporary(&path) {
                fs::remove_file(&path).map_err(|e| refuse(&path, &e))?;
            }
        }
        files.sort();
        Ok(files)
    }

    fn unknown(&self, row: &Row) -> CampaignError {
        let problem = format!("the noise level {:?} is not one of the campaign", row.noise);
        CampaignError::Damaged { path: self.folder.join(RUNS), problem }
    }
}

/// The rows of a part, by recording.
fn part(campaign: &Campaign, path: &Path, facts: &Facts) -> Result<BTreeMap<Key, Vec<Row>>, CampaignError> {
    let damaged =
        || CampaignError::Damaged { path: path.to_owned(), problem: "holds no run of the campaign".to_owned() };
    let mut recordings = BTreeMap::new();
    for row in parquet_file::read(path, facts)? {
        let key = key_of(campaign, &row).ok_or_else(damaged)?;
        recordings.entry(key).or_insert_with(Vec::new).push(row);
    }
    if recordings.is_empty() { Err(damaged()) } else { Ok(recordings) }
}

impl Bench {
    /// Runs recordings, and packs their rows as a file of the folder `parts` of the campaign's store, whatever its name: so that
    /// recordings can be run elsewhere.
    ///
    /// # Errors
    /// As [`Bench::run`].
    pub fn part(&self, keys: &[Key]) -> Result<Vec<u8>, CampaignError> {
        let rows = self.run(keys)?.concat();
        parquet_file::bytes(&rows, &self.facts, Content::Everything).map_err(|e| refuse(Path::new(PARTS), &e))
    }
}

/// The lock of a folder, by its manifest.
fn locked(folder: &Path, manifest: &Path) -> Result<FileLock, CampaignError> {
    let lock = FileLock::of(manifest).map_err(|e| refuse(manifest, &e))?;
    lock.ok_or_else(|| CampaignError::Busy { folder: folder.to_owned() })
}

/// Refuses a folder with files of others; incomplete files of a killed program do not count.
fn require_empty(folder: &Path) -> Result<(), CampaignError> {
    let Ok(mut entries) = fs::read_dir(folder) else { return Ok(()) };
    match entries.find(|entry| entry.as_ref().is_ok_and(|entry| !is_temporary(&entry.path()))) {
        None => Ok(()),
        Some(_) => Err(CampaignError::NoCampaign { folder: folder.to_owned(), manifest: MANIFEST }),
    }
}

/// Whether a file is one that was being written.
fn is_temporary(path: &Path) -> bool {
    let hidden = path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'));
    hidden && path.extension().is_some_and(|e| e == TEMPORARY)
}

fn key_of(campaign: &Campaign, row: &Row) -> Option<Key> {
    let level = campaign.file.noise.iter().position(|n| n.name == row.noise)?;
    Some(Key { level: u32::try_from(level).ok()?, start: row.start - 1, seed: row.seed - 1 })
}
