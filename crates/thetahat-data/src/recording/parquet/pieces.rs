//! A Parquet file of which any rows can be read: only the groups and pages that contain them.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use bytes::Bytes;

use super::super::error::RecordingError;
use super::super::panic_guard::panics_as_damage;
use super::super::place::{file_length, open};
use super::super::table::{RequestedColumns, Table};
use super::guard::Source;
use super::lerobot::DatasetInfo;
use super::read::Described;

/// Most rows of a group that is read in pieces. A page may be as large as its group.
const MOST_ROWS: usize = 1 << 22;

/// The description of a file, which is opened for each piece.
pub(in super::super) struct GroupPieces {
    path: PathBuf,
    described: Described,
    /// The origins of the stamps of columns.
    first_stamps: BTreeMap<usize, i64>,
}

impl GroupPieces {
    /// Reads the description; none if a group is too large, or begins without a stamp: the reader of whole files then reports what is
    /// wrong.
    pub(in super::super) fn open(
        path: &Path,
        info: DatasetInfo,
        wanted: RequestedColumns<'_>,
    ) -> Result<Option<Self>, RecordingError> {
        Self::of_source(path, &source(path)?, info, wanted)
    }

    /// [`Self::open`] for bytes from any source.
    pub(super) fn of_source(
        path: &Path,
        source: &Source,
        info: DatasetInfo,
        wanted: RequestedColumns<'_>,
    ) -> Result<Option<Self>, RecordingError> {
        panics_as_damage(path, "Parquet", || {
            let described = Described::new(path, source, info)?;
            if described.samples == 0 || described.largest_group() > MOST_ROWS || described.has_episodes() {
                return Ok(None);
            }
            described.require_room(path, source.length(), described.samples, wanted)?;
            let first_stamps = first_stamps(&described, source, wanted);
            Ok(first_stamps.map(|first_stamps| Self { path: path.to_owned(), described, first_stamps }))
        })
    }

    pub(in super::super) fn samples(&self) -> usize {
        self.described.samples
    }

    /// These rows of the columns.
    pub(in super::super) fn read(
        &self,
        rows: Range<usize>,
        wanted: RequestedColumns<'_>,
    ) -> Result<Table, RecordingError> {
        self.read_source(&source(&self.path)?, rows, wanted)
    }

    /// [`Self::read`] for bytes from any source.
    pub(super) fn read_source(
        &self,
        source: &Source,
        rows: Range<usize>,
        wanted: RequestedColumns<'_>,
    ) -> Result<Table, RecordingError> {
        let first = |index: usize| self.first_stamps.get(&index).copied();
        panics_as_damage(&self.path, "Parquet", || self.described.table(&self.path, source, rows, wanted, first))
    }
}

/// The first stamp of each column of stamps; none if one is missing.
fn first_stamps(described: &Described, source: &Source, wanted: RequestedColumns<'_>) -> Option<BTreeMap<usize, i64>> {
    let is_stamps = |&index: &usize| described.is_read(index, wanted) && described.is_stamps(index);
    let first = |index| {
        let values = described.values(index, source, 0..1, None).ok()?;
        values.first_stamp().map(|stamp| (index, stamp))
    };
    described.indices().filter(is_stamps).map(first).collect()
}

fn source(path: &Path) -> Result<Source, RecordingError> {
    Ok(Source::File(Arc::new(Mutex::new(open(path)?)), file_length(path)?))
}

/// Reads the second half of a file in memory.
pub(in super::super) fn fuzz_pieces(bytes: &[u8]) {
    let source = Source::Memory(Bytes::copy_from_slice(bytes));
    let (path, info) = (Path::new("fuzz.parquet"), DatasetInfo::default());
    if let Ok(Some(pieces)) = GroupPieces::of_source(path, &source, info, RequestedColumns::All) {
        let _ = pieces.read_source(&source, pieces.samples() / 2..pieces.samples(), RequestedColumns::All);
    }
}
