//! Bags in SQLite: rosbag2's `.db3`, with a table of topics and one of messages.
//!
//! Views, triggers and generated columns of a database run when it is read. Therefore the file is opened read-only, its schema is not
//! trusted, nothing may replace the two tables, and a query that runs longer than the size of the file justifies is stopped.

use std::{
    io::Read,
    path::{Path, PathBuf},
};

use rusqlite::config::DbConfig;
use rusqlite::types::ValueRef;
use rusqlite::{Connection, Row};

use super::super::error::RecordingError;
use super::super::place::{file_length, unreadable};
use super::built_in;
use super::definition::{Language, schema};
use super::error::BagError;
use super::schema::{Encoding, Schema};
use super::topics::Topics;
use super::zstd;
use thetahat_ground::files;

/// The table of definitions.
const DEFINITIONS: &str = "message_definitions";
/// Steps of SQLite's virtual machine between two checks of their number.
const STEPS_AT_A_TIME: i32 = 10_000;
/// Steps allowed for any file, and more for each byte. A message takes about ten.
const STEPS: u64 = 10_000_000;
const STEPS_A_BYTE: u64 = 2;

/// The messages of a bag: of one topic, or of all.
pub(super) fn read(path: &Path, topic: Option<&str>, topics: &mut Topics) -> Result<(), RecordingError> {
    let length = file_length(path)?;
    if zstd::is_compressed_file(path) {
        return read_bytes(&zstd::decompress_file(path)?, topic, topics);
    }
    if let Some(ending) = second_file(path) {
        return Err(topics.refuse(BagError::NotClosed { ending }));
    }
    Bag { connection: open(path)?, topics }.read(length, topic)
}

/// Opens a file of the file system for reading.
#[cfg(not(all(target_family = "wasm", target_os = "unknown")))]
fn open(path: &Path) -> Result<Connection, RecordingError> {
    use rusqlite::OpenFlags;
    let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_URI | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    Connection::open_with_flags(address(path)?, flags).map_err(|e| damaged(path, &e))
}

/// Copies a file in memory into SQLite, which itself opens files of the file system only.
#[cfg(all(target_family = "wasm", target_os = "unknown"))]
fn open(path: &Path) -> Result<Connection, RecordingError> {
    let bytes = files::read(path).map_err(|e| unreadable(path, e))?;
    in_memory(&bytes).map_err(|e| damaged(path, &e))
}

/// The messages of a bag in memory.
pub(super) fn read_bytes(bytes: &[u8], topic: Option<&str>, topics: &mut Topics) -> Result<(), RecordingError> {
    let connection = in_memory(bytes).map_err(|e| damaged(&topics.path, &e))?;
    Bag { connection, topics }.read(bytes.len() as u64, topic)
}

fn in_memory(bytes: &[u8]) -> rusqlite::Result<Connection> {
    let mut connection = Connection::open_in_memory()?;
    connection.deserialize_read_exact("main", bytes, bytes.len(), true)?;
    Ok(connection)
}

/// Beginning of a journal whose transaction SQLite would undo; that of a finished one is empty or zero.
const HOT_JOURNAL: [u8; 8] = [0xd9, 0xd5, 0x05, 0xf9, 0x20, 0xa1, 0x63, 0xd7];

/// The end of the name of a second file, without which the database is not whole: changes that are not yet in it, or what a transaction
/// that was not finished replaced in it.
fn second_file(path: &Path) -> Option<&'static str> {
    let second = |ending: &str| {
        let mut name = path.file_name()?.to_owned();
        name.push(ending);
        Some(path.with_file_name(name))
    };
    let is_filled = |path: PathBuf| files::length(&path).is_ok_and(|length| length > 0);
    let is_hot = |path: PathBuf| {
        let mut beginning = [0; 8];
        files::open(&path).is_ok_and(|mut file| file.read_exact(&mut beginning).is_ok()) && beginning == HOT_JOURNAL
    };
    let log = second("-wal").is_some_and(is_filled).then_some("-wal");
    log.or_else(|| second("-journal").is_some_and(is_hot).then_some("-journal"))
}

/// The address of a file declared immutable, so that SQLite writes no file next to it.
#[cfg(not(all(target_family = "wasm", target_os = "unknown")))]
fn address(path: &Path) -> Result<String, RecordingError> {
    let path = files::real(path).map_err(|e| unreadable(path, e))?;
    let mut address = "file:".to_owned();
    for &byte in path.as_os_str().as_encoded_bytes() {
        match byte {
            b'/' | b'-' | b'_' | b'.' | b'0'..=b'9' | b'a'..=b'z' | b'A'..=b'Z' => address.push(byte.into()),
            _ => address.push_str(&format!("%{byte:02X}")),
        }
    }
    Ok(address + "?immutable=1")
}

fn damaged(path: &Path, error: &rusqlite::Error) -> RecordingError {
    RecordingError::damaged(path, format!("SQLite: {error}"))
}

struct Bag<'a> {
    connection: Connection,
    topics: &'a mut Topics,
}

/// A topic of the table of topics.
struct TopicRow {
    id: i64,
    name: String,
    kind: String,
    serialization: String,
}

impl Bag<'_> {
    fn read(mut self, length: u64, topic: Option<&str>) -> Result<(), RecordingError> {
        self.distrust(length).map_err(|e| self.damaged(&e))?;
        let tables = self.tables()?;
        let definitions =
            if tables.iter().any(|table| table == DEFINITIONS) { self.definitions()? } else { Vec::new() };
        for row in self.rows()? {
            let schemas = if row.serialization == "cdr" { schemas(&row.kind, &definitions) } else { Vec::new() };
            if let Some(place) = self.topics.add_topic(row.name, row.kind, schemas, topic) {
                self.read_messages(row.id, place)?;
            }
        }
        Ok(())
    }

    fn damaged(&self, error: &rusqlite::Error) -> RecordingError {
        damaged(&self.topics.path, error)
    }

    /// Disables unsafe features of the schema and limits the time of queries.
    fn distrust(&mut self, length: u64) -> rusqlite::Result<()> {
        self.connection.set_db_config(DbConfig::SQLITE_DBCONFIG_TRUSTED_SCHEMA, false)?;
        self.connection.set_db_config(DbConfig::SQLITE_DBCONFIG_DEFENSIVE, true)?;
        let mut left = STEPS.saturating_add(length.saturating_mul(STEPS_A_BYTE));
        let is_over = move || {
            left = left.saturating_sub(STEPS_AT_A_TIME.unsigned_abs().into());
            left == 0
        };
        self.connection.progress_handler(STEPS_AT_A_TIME, Some(is_over))
    }

    /// The tables, without views and virtual tables; checks that those of a bag are among them.
    fn tables(&self) -> Result<Vec<String>, RecordingError> {
        let mut found = Vec::new();
        let sql = "SELECT name FROM sqlite_schema WHERE type = 'table' AND rootpage > 0";
        self.each(sql, &[], |row| {
            found.push(text(row, 0)?);
            Ok(Ok(()))
        })?;
        match ["topics", "messages"].into_iter().find(|table| !found.iter().any(|name| name == table)) {
            None => Ok(found),
            Some(table) => {
                let reason = format!("it has no table {table:?}, as a bag of ROS 2 has");
                Err(RecordingError::damaged(&self.topics.path, reason))
            }
        }
    }

    /// The definitions of types, which bags hold from Iron on.
    fn definitions(&self) -> Result<Vec<Definition>, RecordingError> {
        let mut found = Vec::new();
        let sql = "SELECT topic_type, encoding, encoded_message_definition FROM message_definitions";
        self.each(sql, &[], |row| {
            let language = if text(row, 1)? == "ros2idl" { Language::Idl } else { Language::Msg };
            found.push(Definition { kind: text(row, 0)?, language, text: text(row, 2)? });
            Ok(Ok(()))
        })?;
        Ok(found)
    }

    fn rows(&self) -> Result<Vec<TopicRow>, RecordingError> {
        let mut found = Vec::new();
        self.each("SELECT id, name, type, serialization_format FROM topics", &[], |row| {
            found.push(TopicRow {
                id: row.get(0)?,
                name: text(row, 1)?,
                kind: text(row, 2)?,
                serialization: text(row, 3)?,
            });
            Ok(Ok(()))
        })?;
        Ok(found)
    }

    fn read_messages(&mut self, topic: i64, place: usize) -> Result<(), RecordingError> {
        let empty = Topics::new(&self.topics.path, 0);
        let mut topics = std::mem::replace(self.topics, empty);
        let sql = "SELECT timestamp, data FROM messages WHERE topic_id = ?1 ORDER BY rowid";
        let read = self.each(sql, &[topic], |row| {
            let ValueRef::Blob(message) = row.get_ref(1)? else { return Err(rusqlite::Error::InvalidQuery) };
            Ok(topics.add_message(place, row.get(0)?, message))
        });
        *self.topics = topics;
        read
    }

    /// Runs a query and a closure on each of its rows. An error of the closure ends it, as an error of SQLite does.
    fn each(
        &self,
        sql: &str,
        parameters: &[i64],
        mut row: impl FnMut(&Row<'_>) -> rusqlite::Result<Result<(), RecordingError>>,
    ) -> Result<(), RecordingError> {
        let mut statement = self.connection.prepare(sql).map_err(|e| self.damaged(&e))?;
        let mut rows = statement.query(rusqlite::params_from_iter(parameters)).map_err(|e| self.damaged(&e))?;
        while let Some(next) = rows.next().map_err(|e| self.damaged(&e))? {
            row(next).map_err(|e| self.damaged(&e))??;
        }
        Ok(())
    }
}

fn text(row: &Row<'_>, place: usize) -> rusqlite::Result<String> {
    row.get(place)
}

/// The definition of a type in a bag.
struct Definition {
    kind: String,
    language: Language,
    text: String,
}

/// The schema of a type by its definition, or the forms known here.
fn schemas(kind: &str, definitions: &[Definition]) -> Vec<Schema> {
    let of_kind = definitions.iter().filter(|definition| definition.kind == kind && !definition.text.trim().is_empty());
    let mut schemas = of_kind.filter_map(|d| schema(kind, &d.text, d.language, Encoding::Cdr).ok());
    schemas.next().map_or_else(|| built_in::schemas(kind), |schema| vec![schema])
}
