//! Checks between the library and the bytes of a file.
//!
//! The library reserves memory for the stated size of a page or a dictionary before it reads it. These sizes are checked here first: sizes
//! in the file in [`description`], of a page where the library reads its header, of a dictionary where it requests its page.

use std::io::{self, Read, Seek, SeekFrom};
use std::sync::{Arc, Mutex, PoisonError};

use bytes::buf::Reader;
use bytes::{Buf, Bytes};
use parquet::basic::Encoding;
use parquet::column::page::{Page, PageMetadata, PageReader};
use parquet::errors::{ParquetError, Result};
use parquet::file::reader::{ChunkReader, Length};
use parquet::file::serialized_reader::SerializedPageReader;

use super::records::{FILE, PAGE, PAGE_HEADER, SCHEMA_ELEMENT};
use super::thrift::Thrift;
use thetahat_ground::files::File;

/// The first and last bytes of a file.
const MAGIC: &[u8] = b"PAR1";
/// Most columns and groups of columns of one file.
const MOST_COLUMNS: usize = 1 << 14;
/// Deepest nesting of groups.
const DEEPEST_GROUP: usize = 32;
/// Number of bytes in which the header of a page is searched; for columns of numbers it has less than a hundred.
const HEADER_SIZES: [u64; 2] = [1 << 10, 1 << 20];

/// The description at the end of a file, with its number of columns and its depth checked.
pub(super) fn description(source: &Source) -> Result<Bytes> {
    let ending = source.length().checked_sub(8).ok_or_else(|| wrong("it is too short for a Parquet file"))?;
    let last = source.bytes(ending, 8)?;
    if !last.ends_with(MAGIC) || source.bytes(0, MAGIC.len())? != MAGIC {
        return Err(wrong("it does not begin and end as a Parquet file does"));
    }
    let length = last.first_chunk().map_or(0, |chunk| u32::from_le_bytes(*chunk));
    let start = ending.checked_sub(length.into()).ok_or_else(|| wrong("its description is longer than the file"))?;
    let bytes = source.bytes(start, length as usize)?;
    check_description(&bytes).ok_or_else(|| wrong("its description is damaged"))?;
    Ok(bytes)
}

fn check_description(bytes: &[u8]) -> Option<()> {
    let (mut children, mut own) = (Vec::new(), 0_usize);
    let mut visit = |record, field, value| {
        match (record, field) {
            (SCHEMA_ELEMENT, 5) => own = usize::try_from(value).ok()?,
            (SCHEMA_ELEMENT, 0) => children.push(std::mem::take(&mut own)),
            _ => {}
        }
        (children.len() <= MOST_COLUMNS).then_some(())
    };
    let walked = Thrift::new(bytes).record(&FILE, &mut visit);
    walked.filter(|()| is_tree(&children))
}

/// Whether elements in the order of a walk, each with its number of children, are one tree of limited depth.
fn is_tree(children: &[usize]) -> bool {
    let mut open: Vec<usize> = vec![1];
    for &own in children {
        let Some(left) = open.last_mut().filter(|left| **left > 0) else { return false };
        *left -= 1;
        open.push(own);
        while open.last() == Some(&0) {
            open.pop();
        }
        if own > children.len() || open.len() > DEEPEST_GROUP {
            return false;
        }
    }
    open.is_empty()
}

/// The source of a file's bytes.
#[derive(Clone)]
pub(super) enum Source {
    Memory(Bytes),
    /// On disk, with its length.
    File(Arc<Mutex<File>>, u64),
}

impl Source {
    pub(super) fn length(&self) -> u64 {
        match self {
            Self::Memory(bytes) => bytes.len() as u64,
            Self::File(_, length) => *length,
        }
    }

    /// Bytes, which must all exist before memory is reserved for them.
    fn bytes(&self, start: u64, length: usize) -> Result<Bytes> {
        let end = start.checked_add(length as u64).filter(|end| *end <= self.length());
        let end = end.ok_or_else(|| wrong("a page ends after the end of the file"))?;
        match self {
            Self::Memory(bytes) => Ok(bytes.slice(start as usize..end as usize)),
            Self::File(file, _) => {
                let (mut file, mut bytes) = (file.lock().unwrap_or_else(PoisonError::into_inner), vec![0; length]);
                file.seek(SeekFrom::Start(start))?;
                file.read_exact(&mut bytes)?;
                Ok(bytes.into())
            }
        }
    }
}

/// The bytes of a file for the reader of pages.
#[derive(Clone)]
pub(super) struct Guarded {
    pub(super) source: Source,
    /// Most decompressed bytes of a page.
    pub(super) limit: usize,
}

impl Guarded {
    /// Bytes that begin with the whole header of a page. Its fields and its decompressed size are checked.
    fn header(&self, start: u64) -> Result<Bytes> {
        let left = self.source.length().checked_sub(start);
        let left = left.ok_or_else(|| wrong("a page begins after the end of the file"))?;
        for size in HEADER_SIZES {
            let bytes = self.source.bytes(start, size.min(left) as usize)?;
            if self.check_page(&bytes).is_some() {
                return Ok(bytes);
            }
        }
        Err(wrong("the header of a page is damaged, or the page too large"))
    }

    fn check_page(&self, header: &[u8]) -> Option<()> {
        let limit = i64::try_from(self.limit).unwrap_or(i64::MAX);
        let mut visit = |record, field, value| match (record, field) {
            (PAGE_HEADER, 2) => (0..=limit).contains(&value).then_some(()),
            _ => Some(()),
        };
        Thrift::new(header).record(&PAGE, &mut visit)
    }
}

impl Length for Guarded {
    fn len(&self) -> u64 {
        self.source.length()
    }
}

impl ChunkReader for Guarded {
    type T = Header;

    fn get_read(&self, start: u64) -> Result<Self::T> {
        Ok(Header { guarded: self.clone(), start, bytes: None })
    }

    fn get_bytes(&self, start: u64, length: usize) -> Result<Bytes> {
        if matches!(self.source, Source::File(..)) && length > self.limit.saturating_mul(2) {
            return Err(wrong("a page is too large"));
        }
        self.source.bytes(start, length)
    }
}

/// The header of a page, checked when it is read: the library also requests it where it then reads nothing.
pub(super) struct Header {
    guarded: Guarded,
    start: u64,
    bytes: Option<Reader<Bytes>>,
}

impl Read for Header {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let bytes = match self.bytes.take() {
            Some(bytes) => bytes,
            None => self.guarded.header(self.start).map_err(io::Error::other)?.reader(),
        };
        self.bytes.insert(bytes).read(buffer)
    }
}

/// The pages of a column: a dictionary must not be larger than the column, and must come before it is used.
pub(super) struct Pages {
    pub(super) pages: SerializedPageReader<Guarded>,
    /// Most values of a page or a dictionary.
    pub(super) limit: usize,
    pub(super) has_dictionary: bool,
}

impl Pages {
    fn check(&mut self, page: &Page) -> Result<()> {
        if page.num_values() as usize > self.limit {
            return Err(wrong("a page has more values than its column"));
        }
        if let Page::DictionaryPage { num_values, .. } = page {
            if *num_values as usize > self.limit {
                return Err(wrong("a dictionary is too large"));
            }
            self.has_dictionary = true;
        } else if uses_dictionary(page.encoding()) && !self.has_dictionary {
            return Err(wrong("a page uses a dictionary that is not there"));
        }
        Ok(())
    }
}

fn uses_dictionary(encoding: Encoding) -> bool {
    matches!(encoding, Encoding::RLE_DICTIONARY | Encoding::PLAIN_DICTIONARY)
}

impl Iterator for Pages {
    type Item = Result<Page>;

    fn next(&mut self) -> Option<Self::Item> {
        self.get_next_page().transpose()
    }
}

impl PageReader for Pages {
    fn get_next_page(&mut self) -> Result<Option<Page>> {
        let page = self.pages.get_next_page()?;
        page.as_ref().map_or(Ok(()), |page| self.check(page))?;
        Ok(page)
    }

    fn peek_next_page(&mut self) -> Result<Option<PageMetadata>> {
        self.pages.peek_next_page()
    }

    fn skip_next_page(&mut self) -> Result<()> {
        self.pages.skip_next_page()
    }
}

fn wrong(what: &str) -> ParquetError {
    ParquetError::General(what.to_owned())
}
