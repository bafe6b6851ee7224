//! What stands between the library and the bytes of a file.
//!
//! The library reserves memory for what a page or a dictionary is said to hold before it reads it. Here these sizes are
//! checked first: those of the file in [`check_footer`], of a page where the library asks for its header, of a dictionary
//! where it asks for its page.

use bytes::buf::Reader;
use bytes::{Buf, Bytes};
use parquet::basic::Encoding;
use parquet::column::page::{Page, PageMetadata, PageReader};
use parquet::errors::{ParquetError, Result};
use parquet::file::reader::{ChunkReader, Length};
use parquet::file::serialized_reader::SerializedPageReader;

use super::records::{FILE, PAGE, PAGE_HEADER, SCHEMA_ELEMENT};
use super::thrift::Thrift;

/// Columns and groups of columns of one file.
const MOST_COLUMNS: usize = 1 << 14;
/// Groups within groups.
const DEEPEST_GROUP: usize = 32;

/// Checks the description at the end of a file: counts of columns, and how deep they are nested.
pub(super) fn check_footer(bytes: &[u8]) -> std::result::Result<(), &'static str> {
    let ending = bytes.len().checked_sub(8).filter(|_| bytes.starts_with(b"PAR1") && bytes.ends_with(b"PAR1"));
    let ending = ending.ok_or("it does not begin and end as a Parquet file does")?;
    let length = bytes[ending..].first_chunk().map_or(0, |chunk| u32::from_le_bytes(*chunk) as usize);
    let start = ending.checked_sub(length).ok_or("its description is longer than the file")?;
    let (mut children, mut own) = (Vec::new(), 0_usize);
    let mut tell = |record, field, value| {
        match (record, field) {
            (SCHEMA_ELEMENT, 5) => own = usize::try_from(value).ok()?,
            (SCHEMA_ELEMENT, 0) => children.push(std::mem::take(&mut own)),
            _ => {}
        }
        (children.len() <= MOST_COLUMNS).then_some(())
    };
    let walked = Thrift::new(&bytes[start..ending]).record(&FILE, &mut tell);
    walked.filter(|()| is_tree(&children)).ok_or("its description is damaged")
}

/// Whether elements in the order of a walk, each with its number of children, are one tree that is not too deep.
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

/// The bytes of a file for the reader of pages.
pub(super) struct Guarded {
    pub(super) bytes: Bytes,
    /// Most bytes that a page may hold when it is decompressed.
    pub(super) limit: usize,
}

impl Guarded {
    /// Checks the header of a page, and its size when it is decompressed.
    fn check_page(&self, header: &[u8]) -> Option<()> {
        let limit = i64::try_from(self.limit).unwrap_or(i64::MAX);
        let mut tell = |record, field, value| match (record, field) {
            (PAGE_HEADER, 2) => (0..=limit).contains(&value).then_some(()),
            _ => Some(()),
        };
        Thrift::new(header).record(&PAGE, &mut tell)
    }
}

impl Length for Guarded {
    fn len(&self) -> u64 {
        self.bytes.len() as u64
    }
}

impl ChunkReader for Guarded {
    type T = Reader<Bytes>;

    fn get_read(&self, start: u64) -> Result<Self::T> {
        let start = usize::try_from(start).unwrap_or(usize::MAX);
        let header = self.bytes.get(start..).ok_or_else(|| wrong("a page begins behind the end of the file"))?;
        self.check_page(header).ok_or_else(|| wrong("the header of a page is damaged, or the page too large"))?;
        Ok(self.bytes.slice(start..).reader())
    }

    fn get_bytes(&self, start: u64, length: usize) -> Result<Bytes> {
        let start = usize::try_from(start).unwrap_or(usize::MAX);
        let range = start..start.saturating_add(length);
        if self.bytes.get(range.clone()).is_none() {
            return Err(wrong("a page ends behind the end of the file"));
        }
        Ok(self.bytes.slice(range))
    }
}

/// The pages of a column, of which dictionaries are not larger than the column, and come before they are used.
pub(super) struct Pages {
    pub(super) pages: SerializedPageReader<Guarded>,
    /// Most values that a dictionary may hold.
    pub(super) limit: usize,
    pub(super) has_dictionary: bool,
}

impl Pages {
    fn check(&mut self, page: &Page) -> Result<()> {
        match page {
            Page::DictionaryPage { num_values, .. } if *num_values as usize > self.limit => {
                Err(wrong("a dictionary is too large"))
            }
            Page::DictionaryPage { .. } => {
                self.has_dictionary = true;
                Ok(())
            }
            page if uses_dictionary(page.encoding()) && !self.has_dictionary => {
                Err(wrong("a page uses a dictionary that is not there"))
            }
            _ => Ok(()),
        }
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
