//! Bags of ROS 1, format 2.0: entries one after the other, in compressed chunks or not.
//!
//! An entry is a header of fields and data, each with its length before it. Connections hold the topic, the type and its definition;
//! messages name their connection. The index is not read, so that a bag that was not closed can be read as well.
//! Source: wiki.ros.org, Bags/Format/2.0.

use std::collections::HashMap;
use std::io::Read;
use std::path::Path;

use super::super::error::RecordingError;
use super::super::panic_guard::panics_as_damage;
use super::super::place::{file_length, open, unreadable};
use super::definition::{Language, schema};
use super::ros1_entry::{Entry, Header};
use super::schema::Encoding;
use super::topics::Topics;

/// The first line of a bag.
const FIRST_LINE: &[u8] = b"#ROSBAG V2.0\n";
/// Longest header of an entry: the one with a definition is in the data.
const LONGEST_HEADER: u64 = 1 << 20;
/// Longest data of an entry, compressed or not: chunks have about a megabyte, or one large image.
const LONGEST_ENTRY: u64 = 1 << 28;
/// Largest number of connections.
const MOST_CONNECTIONS: usize = 1 << 16;
/// Kinds of entries.
const MESSAGE: u8 = 2;
const CHUNK: u8 = 5;
const CONNECTION: u8 = 7;

/// The messages of a bag: of one topic, or of all.
pub(super) fn read(path: &Path, topic: Option<&str>, topics: &mut Topics) -> Result<(), RecordingError> {
    let length = file_length(path)?;
    read_from(std::io::BufReader::new(open(path)?), length, topic, topics)
}

/// The messages of a bag of this length in bytes.
pub(super) fn read_from(
    input: impl Read,
    length: u64,
    topic: Option<&str>,
    topics: &mut Topics,
) -> Result<(), RecordingError> {
    let path = topics.path.clone();
    panics_as_damage(&path, "bags of ROS 1", || {
        let bag = Bag { path: &path, topic, left: length, places: HashMap::new(), topics };
        bag.read(input)
    })
}

struct Bag<'a> {
    path: &'a Path,
    /// The topic to read.
    topic: Option<&'a str>,
    /// Bytes of the file that follow.
    left: u64,
    /// Indices in the list of topics by connection number: none for connections that are not read.
    places: HashMap<u32, Option<usize>>,
    topics: &'a mut Topics,
}

impl Bag<'_> {
    fn read(mut self, mut input: impl Read) -> Result<(), RecordingError> {
        let first = self.bytes(&mut input, FIRST_LINE.len() as u64, "its first line")?;
        if first != FIRST_LINE {
            return Err(self.damaged("it does not begin with #ROSBAG V2.0, as a bag of ROS 1 of format 2.0 does"));
        }
        while self.left > 0 {
            let header = self.part(&mut input, LONGEST_HEADER, "the header of an entry")?;
            let data = self.part(&mut input, LONGEST_ENTRY, "an entry")?;
            self.add(&Entry { header: Header(&header), data: &data }, true)?;
        }
        Ok(())
    }

    fn damaged(&self, reason: &str) -> RecordingError {
        RecordingError::damaged(self.path, reason.to_owned())
    }

    /// The bytes of a part with its length before it.
    fn part(&mut self, input: &mut impl Read, longest: u64, what: &str) -> Result<Vec<u8>, RecordingError> {
        let length = self.bytes(input, 4, what)?;
        let length = length.first_chunk().map_or(0, |bytes| u64::from(u32::from_le_bytes(*bytes)));
        if length > longest {
            return Err(self.damaged(&format!("{what} states {length} bytes, at most {longest} are read")));
        }
        self.bytes(input, length, what)
    }

    fn bytes(&mut self, input: &mut impl Read, length: u64, what: &str) -> Result<Vec<u8>, RecordingError> {
        let too_short = || RecordingError::damaged(self.path, format!("it ends within {what}"));
        self.left = self.left.checked_sub(length).ok_or_else(too_short)?;
        let mut bytes = Vec::new();
        input.take(length).read_to_end(&mut bytes).map_err(|e| unreadable(self.path, e))?;
        if bytes.len() as u64 == length { Ok(bytes) } else { Err(self.damaged(&format!("it ends within {what}"))) }
    }

    fn add(&mut self, entry: &Entry<'_>, may_be_chunk: bool) -> Result<(), RecordingError> {
        match entry.header.number("op") {
            Some(CHUNK) if may_be_chunk => self.add_chunk(entry),
            Some(CONNECTION) => self.add_connection(entry),
            Some(MESSAGE) => self.add_message(entry),
            // The header of the bag and the index.
            Some(_) => Ok(()),
            None => Err(self.damaged("an entry does not state its kind (op)")),
        }
    }

    fn add_chunk(&mut self, entry: &Entry<'_>) -> Result<(), RecordingError> {
        let size = entry.header.word("size").map(u64::from);
        let size = size.ok_or_else(|| self.damaged("a chunk does not state its size"))?;
        if size > LONGEST_ENTRY {
            return Err(self.damaged(&format!("a chunk states {size} bytes, at most {LONGEST_ENTRY} are read")));
        }
        let found = entry.header.text("compression").unwrap_or_default();
        let chunk = match found {
            "none" => entry.data.to_vec(),
            "bz2" => self.decompressed(bzip2_rs::DecoderReader::new(entry.data), size)?,
            "lz4" => {
                let decoder = lz4::Decoder::new(entry.data).map_err(|e| self.damaged(&format!("a chunk: {e}")))?;
                self.decompressed(decoder, size)?
            }
            other => {
                return Err(self.damaged(&format!("a chunk is compressed by {other:?}, expected none, bz2 or lz4")));
            }
        };
        if chunk.len() as u64 != size {
            return Err(self.damaged(&format!("a chunk states {size} bytes, but has {}", chunk.len())));
        }
        self.topics.count_bytes(chunk.len())?;
        let mut rest = chunk.as_slice();
        while !rest.is_empty() {
            let entry = Entry::first(&mut rest).ok_or_else(|| self.damaged("a chunk ends within an entry"))?;
            self.add(&entry, false)?;
        }
        Ok(())
    }

    /// Decompresses a chunk up to a byte more than the size that it states.
    fn decompressed(&self, reader: impl Read, size: u64) -> Result<Vec<u8>, RecordingError> {
        let mut chunk = Vec::new();
        let read = reader.take(size + 1).read_to_end(&mut chunk);
        read.map_err(|e| self.damaged(&format!("a chunk cannot be decompressed: {e}")))?;
        Ok(chunk)
    }

    fn add_connection(&mut self, entry: &Entry<'_>) -> Result<(), RecordingError> {
        let connection = entry.header.word("conn");
        let (of_entry, of_publisher) = (&entry.header, Header(entry.data));
        let (Some(number), Some(name), Some(kind)) = (connection, of_entry.text("topic"), of_publisher.text("type"))
        else {
            return Err(self.damaged("a connection does not state its number, topic and type"));
        };
        if self.places.contains_key(&number) {
            return Ok(());
        }
        if self.places.len() == MOST_CONNECTIONS {
            return Err(self.damaged(&format!("it has more than {MOST_CONNECTIONS} connections")));
        }
        let text = of_publisher.text("message_definition").unwrap_or_default();
        let schemas = schema(kind, text, Language::Msg, Encoding::Ros1).into_iter().collect();
        let place = self.topics.add_topic(name.to_owned(), kind.to_owned(), schemas, self.topic);
        self.places.insert(number, place);
        Ok(())
    }

    fn add_message(&mut self, entry: &Entry<'_>) -> Result<(), RecordingError> {
        let (connection, time) = (entry.header.word("conn"), entry.header.time_ns("time"));
        let (Some(connection), Some(time)) = (connection, time) else {
            return Err(self.damaged("a message does not state its connection and time"));
        };
        match self.places.get(&connection) {
            Some(Some(place)) => self.topics.add_message(*place, time, entry.data),
            Some(None) => Ok(()),
            None => Err(self.damaged("a message is of a connection that is not in the bag")),
        }
    }
}
