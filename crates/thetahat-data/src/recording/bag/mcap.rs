//! Bags in MCAP: consecutive records, in compressed chunks or not. They are read piece by piece, so that the images of a bag are not loaded
//! into memory.

use std::collections::HashMap;
use std::io::Read;
use std::path::Path;

use mcap::McapError;
use mcap::records::{Channel, Record, op};
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};

use super::super::error::RecordingError;
use super::super::panic_guard::panics_as_damage;
use super::super::place::{file_length, open, unreadable};
use super::other_topic::OtherTopic;
use super::topic::{JOINT_STATE, Topics};

/// Longest record that is read: images and point clouds in a bag are shorter.
const LONGEST_RECORD: usize = 1 << 26;
/// Longest name of a topic or a type.
const LONGEST_NAME: usize = 1024;
/// Decompressed bytes that any file may contain, and the number for each byte of a larger file.
const ANY_FILE: u64 = 1 << 30;
const EXPANSION: u64 = 32;

/// The joint states of a bag: of one topic, or of all.
pub(super) fn read(path: &Path, topic: Option<&str>) -> Result<Topics, RecordingError> {
    let length = file_length(path)?;
    read_from(open(path)?, length, path, topic)
}

/// The joint states of a bag that is read piece by piece.
pub(super) fn read_from(
    input: impl Read,
    length: u64,
    path: &Path,
    topic: Option<&str>,
) -> Result<Topics, RecordingError> {
    panics_as_damage(path, "MCAP", || {
        let left = ANY_FILE.max(length.saturating_mul(EXPANSION));
        let topics = Topics::new(path, length);
        Bag { path, topic, left, schemas: HashMap::new(), places: HashMap::new(), topics }.read(input)
    })
}

struct Bag<'a> {
    path: &'a Path,
    /// The topic to read.
    topic: Option<&'a str>,
    /// Bytes of records still allowed.
    left: u64,
    /// Names of types by their numbers.
    schemas: HashMap<u16, String>,
    /// Indices in the list of topics by channel number: none for channels that are not read.
    places: HashMap<u16, Option<usize>>,
    topics: Topics,
}

impl Bag<'_> {
    fn read(mut self, mut input: impl Read) -> Result<Topics, RecordingError> {
        let options =
            LinearReaderOptions::default().with_record_length_limit(LONGEST_RECORD).with_validate_chunk_crcs(true);
        let mut reader = LinearReader::new_with_options(options);
        while let Some(event) = reader.next_event() {
            match event.map_err(|e| self.damaged(&e))? {
                LinearReadEvent::ReadRequest(bytes) => {
                    let read = input.read(reader.insert(bytes)).map_err(|e| unreadable(self.path, e))?;
                    reader.notify_read(read);
                }
                LinearReadEvent::Record { opcode, data } => self.add(opcode, data)?,
            }
        }
        Ok(self.topics)
    }

    fn damaged(&self, error: &McapError) -> RecordingError {
        RecordingError::damaged(self.path, format!("MCAP: {error}"))
    }

    fn add(&mut self, opcode: u8, data: &[u8]) -> Result<(), RecordingError> {
        let limit = (ANY_FILE / 8) as usize;
        self.left = self.left.checked_sub(data.len() as u64 + 9).ok_or_else(|| RecordingError::TooLarge {
            file: self.path.to_owned(),
            what: "what its chunks hold".to_owned(),
            limit,
        })?;
        if !matches!(opcode, op::SCHEMA | op::CHANNEL | op::MESSAGE) {
            return Ok(());
        }
        let record = mcap::parse_record(opcode, data).map_err(|e| self.damaged(&e))?;
        if let Record::Schema { header, .. } = record {
            return self.add_schema(header.id, header.name);
        }
        if let Record::Channel(channel) = record {
            return self.add_channel(channel);
        }
        if let Record::Message { header, data } = record
            && let Some(Some(place)) = self.places.get(&header.channel_id)
        {
            self.topics.add_message(*place, header.log_time.cast_signed(), &data)?;
        }
        Ok(())
    }

    fn add_schema(&mut self, number: u16, name: String) -> Result<(), RecordingError> {
        self.check_name(&name)?;
        self.schemas.insert(number, name);
        Ok(())
    }

    fn add_channel(&mut self, channel: Channel) -> Result<(), RecordingError> {
        self.check_name(&channel.topic)?;
        if self.places.contains_key(&channel.id) {
            return Ok(());
        }
        let kind = self.schemas.get(&channel.schema_id).cloned().unwrap_or_default();
        let place = if kind == JOINT_STATE && channel.message_encoding == "cdr" {
            let is_asked = self.topic.is_none_or(|topic| topic == channel.topic);
            let place = self.topics.add_topic(channel.topic);
            is_asked.then_some(place)
        } else {
            self.topics.others.push(OtherTopic { name: channel.topic, kind });
            None
        };
        self.places.insert(channel.id, place);
        Ok(())
    }

    fn check_name(&self, name: &str) -> Result<(), RecordingError> {
        if name.len() <= LONGEST_NAME {
            return Ok(());
        }
        let reason = format!("the name of a topic or type has {} bytes", name.len());
        Err(RecordingError::damaged(self.path, reason))
    }
}
