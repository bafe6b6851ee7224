//! NumPy archives: `.npz`, a zip file of arrays, stored or deflated.

use std::io::{self, Cursor, Read, Seek, SeekFrom};
use std::path::Path;

use zip::read::ZipFile;
use zip::{CompressionMethod, ZipArchive};

use super::budget::Budget;
use super::error::RecordingError;
use super::npy::{self, ArrayPieces};
use super::place::open;
use super::table::{Column, RequestedColumns, Table};

/// The arrays of an archive by their keys. Arrays that are not requested have a name and no values.
pub(super) fn read(bytes: &[u8], path: &Path, wanted: RequestedColumns<'_>) -> Result<Table, RecordingError> {
    let damaged = |reason: String| RecordingError::damaged(path, reason);
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(|e| damaged(e.to_string()))?;
    if repeats_a_name(&archive, Cursor::new(bytes)) {
        return Err(damaged("two entries of the archive have the same name".to_owned()));
    }
    let mut budget = Budget::of(path, bytes.len() as u64);
    let mut table = Table::default();
    for index in 0..archive.len() {
        let entry = archive.by_index(index).map_err(|e| damaged(format!("entry {index} of the archive: {e}")))?;
        let name = String::from_utf8_lossy(entry.name_raw()).into_owned();
        let Some(key) = name.strip_suffix(".npy") else { continue };
        let column = if wanted.includes(key) {
            array(key, entry, path, &mut budget)?
        } else {
            Column::of_numbers(key.to_owned(), 0, Vec::new())
        };
        table.columns.push(column);
    }
    Ok(table)
}

/// Whether entries have the same name: the archive knows the last of them only, its directory has all.
fn repeats_a_name<R: Read + Seek>(archive: &ZipArchive<R>, mut file: impl Read + Seek) -> bool {
    let mut next = archive.central_directory_start();
    let mut entries = 0;
    let mut entry = [0; DIRECTORY_ENTRY];
    while file.seek(SeekFrom::Start(next)).is_ok()
        && file.read_exact(&mut entry).is_ok()
        && entry.starts_with(b"PK\x01\x02")
    {
        let length = |at: usize| u64::from(u16::from_le_bytes([entry[at], entry[at + 1]]));
        next += DIRECTORY_ENTRY as u64 + length(28) + length(30) + length(32);
        entries += 1;
    }
    entries > archive.len()
}

/// Bytes of an entry of the directory before its name, its extra field and its comment, whose lengths are at 28, 30 and 32 (APPNOTE 4.3.12).
const DIRECTORY_ENTRY: usize = 46;

fn array(
    key: &str,
    entry: ZipFile<'_, Cursor<&[u8]>>,
    path: &Path,
    budget: &mut Budget,
) -> Result<Column, RecordingError> {
    let what = format!("array {key:?}");
    let bytes = budget.decompress(&what, entry).map_err(|e| e.at(path, &what))?;
    npy::column(key.to_owned(), &bytes, path, budget)
}

/// The requested arrays of an archive, if all are stored uncompressed; none otherwise.
pub(super) fn stored_arrays(
    path: &Path,
    wanted: RequestedColumns<'_>,
) -> Result<Option<Vec<ArrayPieces>>, RecordingError> {
    let Ok(mut archive) = ZipArchive::new(open(path)?) else { return Ok(None) };
    if repeats_a_name(&archive, open(path)?) {
        return Ok(None);
    }
    let mut arrays = Vec::new();
    for index in 0..archive.len() {
        let Ok(mut entry) = archive.by_index(index) else { return Ok(None) };
        let name = String::from_utf8_lossy(entry.name_raw()).into_owned();
        let Some(key) = name.strip_suffix(".npy").filter(|key| wanted.includes(key)) else { continue };
        let start = entry.data_start().filter(|_| entry.compression() == CompressionMethod::Stored);
        // To the end, where the checksum is compared; the reader of whole files reports what is wrong.
        if start.is_some() && io::copy(&mut entry, &mut io::sink()).is_err() {
            return Ok(None);
        }
        let array = match start {
            Some(start) => ArrayPieces::open(path, key.to_owned(), start, entry.size())?,
            None => None,
        };
        let Some(array) = array else { return Ok(None) };
        arrays.push(array);
    }
    Ok(Some(arrays))
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use zip::write::SimpleFileOptions;
    use zip::{CompressionMethod, ZipWriter};

    use super::super::test_files::npy;
    use super::*;

    const FILE: &str = "q.npz";

    fn archive(method: CompressionMethod, entries: &[(&str, &[u8])]) -> Vec<u8> {
        let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
        for (name, bytes) in entries {
            writer.start_file(*name, SimpleFileOptions::default().compression_method(method)).unwrap();
            writer.write_all(bytes).unwrap();
        }
        writer.finish().unwrap().into_inner()
    }

    fn valid(method: CompressionMethod) -> Vec<u8> {
        let (q, t) = (npy("|u1", false, "(2, 2)", &[1, 2, 3, 4]), npy("|u1", false, "(2,)", &[0, 1]));
        archive(method, &[("q.npy", &q), ("t.npy", &t), ("notes.txt", b"run 3")])
    }

    fn loaded(bytes: &[u8]) -> Result<Table, RecordingError> {
        read(bytes, Path::new(FILE), RequestedColumns::All)
    }

    #[test]
    fn arrays_by_their_keys_stored_and_deflated() {
        for method in [CompressionMethod::Stored, CompressionMethod::Deflated] {
            let table = loaded(&valid(method)).unwrap();
            let names: Vec<_> = table.columns.iter().map(|c| c.name.as_str()).collect();
            assert_eq!(names, ["q", "t"]);
            assert_eq!(table.columns[0].values, [1.0, 3.0, 2.0, 4.0]);
        }
    }

    #[test]
    fn two_entries_of_one_name_are_refused() {
        let (q, p) = (npy("|u1", false, "(2,)", &[1, 2]), npy("|u1", false, "(2,)", &[8, 9]));
        let mut bytes = archive(CompressionMethod::Stored, &[("q.npy", &q), ("p.npy", &p)]);
        for at in memchr::memmem::find_iter(&bytes.clone(), b"p.npy") {
            bytes[at] = b'q';
        }
        let error = loaded(&bytes).unwrap_err().to_string();
        assert!(error.contains("two entries of the archive have the same name"), "{error}");
        let folder = thetahat_testing::Folder::with(FILE, &bytes);
        assert!(stored_arrays(&folder.path().join(FILE), RequestedColumns::All).unwrap().is_none());
    }

    #[test]
    fn arrays_that_are_not_wanted_are_not_decompressed() {
        let bytes = archive(CompressionMethod::Stored, &[("q.npy", b"not an array")]);
        let asked = ["t".to_owned()];
        assert_eq!(read(&bytes, Path::new(FILE), RequestedColumns::Named(&asked)).unwrap().columns[0].channels, 0);
    }

    /// The reader of pieces leaves a file with a wrong checksum to the reader of whole files, which names the array.
    #[test]
    fn a_wrong_checksum_is_found_by_both_readers() {
        let mut bytes = valid(CompressionMethod::Stored);
        let folder = thetahat_testing::Folder::with(FILE, &bytes);
        assert_eq!(stored_arrays(&folder.path().join(FILE), RequestedColumns::All).unwrap().unwrap().len(), 2);
        let place = bytes.windows(4).position(|w| w == [1, 2, 3, 4]).unwrap();
        bytes[place] = 9;
        let folder = thetahat_testing::Folder::with(FILE, &bytes);
        assert!(stored_arrays(&folder.path().join(FILE), RequestedColumns::All).unwrap().is_none());
        let error = loaded(&bytes).unwrap_err().to_string();
        assert!(error.contains("array \"q\"") && error.to_lowercase().contains("checksum"), "{error}");
    }

    #[test]
    fn array_that_expands_without_end() {
        let zeros = npy("|u1", false, "(200000000,)", &vec![0; 200_000_000]);
        let bytes = archive(CompressionMethod::Deflated, &[("q.npy", &zeros)]);
        assert!(bytes.len() < 1 << 20);
        assert!(matches!(loaded(&bytes), Err(RecordingError::TooLarge { .. })));
    }

    #[test]
    fn file_cut_short() {
        let whole = valid(CompressionMethod::Deflated);
        for length in 0..whole.len() {
            assert!(matches!(loaded(&whole[..length]), Err(RecordingError::Damaged { .. })), "{length}");
        }
    }

    #[test]
    fn damaged_bytes_never_panic() {
        let whole = valid(CompressionMethod::Deflated);
        for place in 0..whole.len() {
            for damage in [0x00, 0x01, 0x7f, 0x80, 0xff] {
                let mut bytes = whole.clone();
                bytes[place] = damage;
                let _ = loaded(&bytes);
            }
        }
    }
}
