//! Bags in MCAP: consecutive records, in compressed chunks or not. They are read piece by piece, so that the images of a bag are not loaded
//! into memory.

use std::collections::HashMap;
use std::io::{self, Read};
use std::path::Path;

use mcap::McapError;
use mcap::records::{Channel, Record, SchemaHeader, op};
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};

use super::super::error::RecordingError;
use super::super::panic_guard::panics_as_damage;
use super::super::place::{open, unreadable};
use super::built_in;
use super::definition::{LONGEST_DEFINITION, Language, schema};
use super::schema::{Encoding, Schema};
use super::topics::Topics;
use super::zstd;

/// Longest record that is read: images and point clouds in a bag are shorter.
const LONGEST_RECORD: usize = 1 << 26;
/// Longest name of a topic or a type.
const LONGEST_NAME: usize = 1024;

/// The messages of a bag: of one topic, or of all.
pub(super) fn read(path: &Path, topic: Option<&str>, topics: &mut Topics) -> Result<(), RecordingError> {
    if zstd::is_compressed_file(path) {
        return read_all(zstd::open_file(path)?, zstd::damaged_file, topic, topics);
    }
    read_from(open(path)?, topic, topics)
}

/// The messages of a bag that is read piece by piece.
pub(super) fn read_from(input: impl Read, topic: Option<&str>, topics: &mut Topics) -> Result<(), RecordingError> {
    read_all(input, unreadable, topic, topics)
}

/// The messages of a bag; `failed` is the error where the input cannot be read.
fn read_all(
    input: impl Read,
    failed: fn(&Path, io::Error) -> RecordingError,
    topic: Option<&str>,
    topics: &mut Topics,
) -> Result<(), RecordingError> {
    let path = topics.path.clone();
    panics_as_damage(&path, "MCAP", || {
        Bag { path: &path, topic, failed, types: HashMap::new(), places: HashMap::new(), topics }.read(input)
    })
}

/// The type of messages: its name, and its definition in a known language.
struct Type {
    name: String,
    encoding: String,
    definition: Vec<u8>,
}

struct Bag<'a> {
    path: &'a Path,
    /// The error where the input cannot be read.
    failed: fn(&Path, io::Error) -> RecordingError,
    /// The topic to read.
    topic: Option<&'a str>,
    /// Types by their numbers.
    types: HashMap<u16, Type>,
    /// Indices in the list of topics by channel number: none for channels that are not read.
    places: HashMap<u16, Option<usize>>,
    topics: &'a mut Topics,
}

impl Bag<'_> {
    fn read(mut self, mut input: impl Read) -> Result<(), RecordingError> {
        let options =
            LinearReaderOptions::default().with_record_length_limit(LONGEST_RECORD).with_validate_chunk_crcs(true);
        let mut reader = LinearReader::new_with_options(options);
        while let Some(event) = reader.next_event() {
            match event.map_err(|e| self.damaged(&e))? {
                LinearReadEvent::ReadRequest(bytes) => {
                    let read = input.read(reader.insert(bytes)).map_err(|e| (self.failed)(self.path, e))?;
                    reader.notify_read(read);
                }
                LinearReadEvent::Record { opcode, data } => self.add(opcode, data)?,
            }
        }
        Ok(())
    }

    fn damaged(&self, error: &McapError) -> RecordingError {
        RecordingError::damaged(self.path, format!("MCAP: {error}"))
    }

    fn add(&mut self, opcode: u8, data: &[u8]) -> Result<(), RecordingError> {
        self.topics.count_bytes(data.len() + 9)?;
        if !matches!(opcode, op::SCHEMA | op::CHANNEL | op::MESSAGE) {
            return Ok(());
        }
        let record = mcap::parse_record(opcode, data).map_err(|e| self.damaged(&e))?;
        if let Record::Schema { header, data } = record {
            return self.add_type(header, data.into_owned());
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

    fn add_type(&mut self, header: SchemaHeader, mut definition: Vec<u8>) -> Result<(), RecordingError> {
        self.check_name(&header.name)?;
        if definition.len() > LONGEST_DEFINITION || !self.topics.has_room_for(&definition) {
            definition = Vec::new();
        }
        self.types.insert(header.id, Type { name: header.name, encoding: header.encoding, definition });
        Ok(())
    }

    fn add_channel(&mut self, channel: Channel) -> Result<(), RecordingError> {
        self.check_name(&channel.topic)?;
        if self.places.contains_key(&channel.id) {
            return Ok(());
        }
        let of_channel = self.types.get(&channel.schema_id);
        let schemas = of_channel.map(|kind| kind.schemas(&channel.message_encoding)).unwrap_or_default();
        let kind = of_channel.map(|kind| kind.name.clone()).unwrap_or_default();
        let place = self.topics.add_topic(channel.topic, kind, schemas, self.topic);
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

impl Type {
    /// The schemas of messages in an encoding; none if it cannot be read.
    fn schemas(&self, message_encoding: &str) -> Vec<Schema> {
        let encoding = match message_encoding {
            "cdr" => Encoding::Cdr,
            "ros1" => Encoding::Ros1,
            _ => return Vec::new(),
        };
        let is_idl = matches!(self.encoding.as_str(), "ros2idl" | "omgidl");
        let language = if is_idl { Language::Idl } else { Language::Msg };
        let text = str::from_utf8(&self.definition).unwrap_or_default();
        match schema(&self.name, text, language, encoding) {
            Ok(schema) if !text.trim().is_empty() => vec![schema],
            Ok(_) | Err(_) if encoding == Encoding::Cdr => built_in::schemas(&self.name),
            Ok(_) | Err(_) => Vec::new(),
        }
    }
}
