//! Rows as Parquet: columns of texts, whole numbers and numbers, each value present or absent.

use std::{path::Path, sync::Arc};

use bytes::Bytes;
use flate2::Crc;
use parquet::{
    basic::Compression,
    column::writer::ColumnWriter,
    data_type::ByteArray,
    errors::ParquetError,
    file::{
        metadata::KeyValue,
        properties::WriterProperties,
        reader::{FileReader, SerializedFileReader},
        writer::SerializedFileWriter,
    },
    record::{Field, Row as FileRow},
    schema::{parser::parse_message_type, types::Type},
};

use super::{CampaignError, Row, facts::Facts, files::replace_file, row::status_name};
use thetahat_estimation::identification::Status;
use thetahat_ground::files;

/// The columns of a file in addition to those that identify the run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Content {
    /// All columns.
    Everything,
    /// All but the time.
    Results,
    /// The time alone.
    Timing,
}

/// A column with its values.
enum Column {
    Text(Vec<Option<String>>),
    Whole(Vec<Option<i64>>),
    Number(Vec<Option<f64>>),
}

impl Column {
    fn len(&self) -> usize {
        match self {
            Self::Text(values) => values.len(),
            Self::Whole(values) => values.len(),
            Self::Number(values) => values.len(),
        }
    }
}

/// Names of the columns that say which run a row is.
const TEXTS: [&str; 3] = ["case", "noise", "method"];
const WHOLES: [&str; 2] = ["start", "seed"];
const SECONDS: &str = "seconds";
/// Key of the checksum of all values among the metadata of a file.
const CHECKSUM: &str = "thetahat.checksum";

/// Writes the rows to a temporary file and renames it: the file is there as a whole or not at all.
pub(super) fn write(path: &Path, rows: &[Row], facts: &Facts, content: Content) -> Result<(), CampaignError> {
    let refuse = |e: ParquetError| CampaignError::Write { path: path.to_owned(), reason: e.to_string() };
    replace_file(path, &bytes(rows, facts, content).map_err(refuse)?)
}

/// The rows as the content of a file.
pub(super) fn bytes(rows: &[Row], facts: &Facts, content: Content) -> Result<Vec<u8>, ParquetError> {
    encode(&columns(rows, facts, content))
}

fn columns(rows: &[Row], facts: &Facts, content: Content) -> Vec<(String, Column)> {
    let text = |f: &dyn Fn(&Row) -> Option<String>| Column::Text(rows.iter().map(f).collect());
    let whole = |f: &dyn Fn(&Row) -> usize| Column::Whole(rows.iter().map(|r| i64::try_from(f(r)).ok()).collect());
    let number = |f: &dyn Fn(&Row) -> Option<f64>| Column::Number(rows.iter().map(f).collect());
    let mut all = vec![
        (TEXTS[0].to_owned(), text(&|r| Some(r.case.clone()))),
        (TEXTS[1].to_owned(), text(&|r| Some(r.noise.clone()))),
        (WHOLES[0].to_owned(), whole(&|r| r.start as usize)),
        (WHOLES[1].to_owned(), whole(&|r| r.seed as usize)),
        (TEXTS[2].to_owned(), text(&|r| Some(r.method.clone()))),
    ];
    if content != Content::Timing {
        all.extend([
            ("status".to_owned(), text(&|r| Some(status_name(r.status).to_owned()))),
            ("reason".to_owned(), text(&|r| r.reason.clone())),
            ("iterations".to_owned(), whole(&|r| r.iterations)),
            ("simulations".to_owned(), whole(&|r| r.simulations)),
            ("relative_error_percent".to_owned(), number(&|r| r.relative_error_percent)),
            ("position_error_percent".to_owned(), number(&|r| r.position_error_percent)),
            ("torque_error_percent".to_owned(), number(&|r| r.torque_error_percent)),
            ("parameter_distance".to_owned(), number(&|r| r.parameter_distance)),
        ]);
        for (i, parameter) in facts.parameters.iter().enumerate() {
            all.push((format!("estimate_{}", parameter.name), number(&|r| r.estimates[i])));
            all.push((format!("deviation_{}", parameter.name), number(&|r| r.deviations[i])));
            all.push((format!("low_{}", parameter.name), number(&|r| r.intervals[i].map(|[low, _]| low))));
            all.push((format!("high_{}", parameter.name), number(&|r| r.intervals[i].map(|[_, high]| high))));
        }
    }
    if content != Content::Results {
        all.push((SECONDS.to_owned(), number(&|r| r.seconds)));
    }
    all
}

fn encode(columns: &[(String, Column)]) -> Result<Vec<u8>, ParquetError> {
    let sum = KeyValue::new(CHECKSUM.to_owned(), checksum_of_columns(columns).to_string());
    let properties = WriterProperties::builder()
        .set_compression(Compression::SNAPPY)
        .set_key_value_metadata(Some(vec![sum]))
        .build();
    let mut writer = SerializedFileWriter::new(Vec::new(), Arc::new(schema(columns)?), Arc::new(properties))?;
    let mut group = writer.next_row_group()?;
    for (_, column) in columns {
        let Some(mut place) = group.next_column()? else { break };
        write_column(place.untyped(), column)?;
        place.close()?;
    }
    group.close()?;
    writer.into_inner()
}

fn schema(columns: &[(String, Column)]) -> Result<Type, ParquetError> {
    let field = |(name, column): &(String, Column)| match column {
        Column::Text(_) => format!("optional binary {name} (UTF8);"),
        Column::Whole(_) => format!("optional int64 {name};"),
        Column::Number(_) => format!("optional double {name};"),
    };
    parse_message_type(&format!("message runs {{ {} }}", columns.iter().map(field).collect::<String>()))
}

fn write_column(place: &mut ColumnWriter<'_>, column: &Column) -> Result<(), ParquetError> {
    match (place, column) {
        (ColumnWriter::ByteArrayColumnWriter(writer), Column::Text(values)) => {
            let bytes: Vec<ByteArray> = values.iter().flatten().map(|v| ByteArray::from(v.as_str())).collect();
            writer.write_batch(&bytes, Some(&levels(values)), None)?;
        }
        (ColumnWriter::Int64ColumnWriter(writer), Column::Whole(values)) => {
            writer.write_batch(&present(values), Some(&levels(values)), None)?;
        }
        (ColumnWriter::DoubleColumnWriter(writer), Column::Number(values)) => {
            writer.write_batch(&present(values), Some(&levels(values)), None)?;
        }
        _ => return Err(ParquetError::General("a column of another type than its schema".to_owned())),
    }
    Ok(())
}

fn present<T: Copy>(values: &[Option<T>]) -> Vec<T> {
    values.iter().flatten().copied().collect()
}

fn levels<T>(values: &[Option<T>]) -> Vec<i16> {
    values.iter().map(|v| i16::from(v.is_some())).collect()
}

/// Reads rows back.
pub(super) fn read(path: &Path, facts: &Facts) -> Result<Vec<Row>, CampaignError> {
    let row = |(number, file_row): (usize, &FileRow)| {
        let problem = format!("row {} is not that of a run", number + 1);
        row(file_row, facts).ok_or_else(|| CampaignError::Damaged { path: path.to_owned(), problem })
    };
    rows_of_file(path)?.iter().enumerate().map(row).collect()
}

/// The rows of a file, whose checksum is that of their values.
fn rows_of_file(path: &Path) -> Result<Vec<FileRow>, CampaignError> {
    let damaged = |problem: String| CampaignError::Damaged { path: path.to_owned(), problem };
    let bytes =
        files::read(path).map_err(|e| CampaignError::Unreadable { path: path.to_owned(), reason: e.to_string() })?;
    let reader = SerializedFileReader::new(Bytes::from(bytes)).map_err(|e| damaged(e.to_string()))?;
    let rows = reader.get_row_iter(None).and_then(Iterator::collect::<Result<Vec<FileRow>, _>>);
    let rows = rows.map_err(|e| damaged(e.to_string()))?;
    let metadata = reader.metadata().file_metadata().key_value_metadata();
    let stated = metadata.and_then(|all| all.iter().find(|entry| entry.key == CHECKSUM)?.value.as_ref());
    let stated = stated.ok_or_else(|| damaged("it carries no checksum".to_owned()))?;
    if *stated != checksum_of_rows(&rows).to_string() {
        return Err(damaged("its checksum is not that of its values".to_owned()));
    }
    Ok(rows)
}

/// Adds a value with the name of its column to a checksum.
fn add_value(sum: &mut Crc, name: &str, bytes: Option<&[u8]>) {
    sum.update(name.as_bytes());
    sum.update(&[u8::from(bytes.is_some())]);
    sum.update(bytes.unwrap_or_default());
}

/// The checksum of columns, row by row.
fn checksum_of_columns(columns: &[(String, Column)]) -> u32 {
    let rows = columns.iter().map(|(_, column)| column.len()).max().unwrap_or(0);
    let mut sum = Crc::new();
    for row in 0..rows {
        for (name, column) in columns {
            match column {
                Column::Text(values) => add_value(&mut sum, name, values[row].as_ref().map(String::as_bytes)),
                Column::Whole(values) => {
                    add_value(&mut sum, name, values[row].map(i64::to_le_bytes).as_ref().map(|b| &b[..]))
                }
                Column::Number(values) => {
                    add_value(&mut sum, name, values[row].map(f64::to_le_bytes).as_ref().map(|b| &b[..]))
                }
            }
        }
    }
    sum.sum()
}

/// The same of rows that were read back.
fn checksum_of_rows(rows: &[FileRow]) -> u32 {
    let mut sum = Crc::new();
    for (name, field) in rows.iter().flat_map(FileRow::get_column_iter) {
        if let Field::Str(text) = field {
            add_value(&mut sum, name, Some(text.as_bytes()));
        } else if let Field::Long(value) = field {
            add_value(&mut sum, name, Some(&value.to_le_bytes()));
        } else if let Field::Double(value) = field {
            add_value(&mut sum, name, Some(&value.to_le_bytes()));
        } else {
            add_value(&mut sum, name, None);
        }
    }
    sum.sum()
}

/// The row of a run; its parameters are in the order of the facts.
fn row(file_row: &FileRow, facts: &Facts) -> Option<Row> {
    let fields: std::collections::BTreeMap<&str, &Field> =
        file_row.get_column_iter().map(|(name, field)| (name.as_str(), field)).collect();
    let text = |name: &str| match fields.get(name) {
        Some(Field::Str(text)) => Some(text.clone()),
        _ => None,
    };
    let whole = |name: &str| match fields.get(name) {
        Some(Field::Long(value)) => Some(*value),
        _ => None,
    };
    let number = |name: &str| match fields.get(name) {
        Some(Field::Double(value)) => Some(*value),
        _ => None,
    };
    let each = |what: &str| -> Vec<Option<f64>> {
        facts.parameters.iter().map(|p| number(&format!("{what}_{}", p.name))).collect()
    };
    let intervals = each("low").into_iter().zip(each("high"));
    let count = |name: &str| whole(name).and_then(|v| usize::try_from(v).ok());
    let place = |name: &str| whole(name).and_then(|v| u32::try_from(v).ok()).filter(|v| *v > 0);
    Some(Row {
        case: text(TEXTS[0])?,
        noise: text(TEXTS[1])?,
        start: place(WHOLES[0])?,
        seed: place(WHOLES[1])?,
        method: text(TEXTS[2])?,
        status: status_named(&text("status")?)?,
        reason: text("reason"),
        iterations: count("iterations")?,
        simulations: count("simulations")?,
        seconds: number(SECONDS),
        relative_error_percent: number("relative_error_percent"),
        position_error_percent: number("position_error_percent"),
        torque_error_percent: number("torque_error_percent"),
        parameter_distance: number("parameter_distance"),
        estimates: each("estimate"),
        deviations: each("deviation"),
        intervals: intervals.map(|(low, high)| Some([low?, high?])).collect(),
    })
}

/// The times of a file, in the order of its rows.
pub(super) fn read_seconds(path: &Path) -> Result<Vec<Option<f64>>, CampaignError> {
    let seconds = |file_row: &FileRow| {
        let field = file_row.get_column_iter().find(|(name, _)| *name == SECONDS).map(|(_, field)| field);
        if let Some(Field::Double(value)) = field { Some(*value) } else { None }
    };
    Ok(rows_of_file(path)?.iter().map(seconds).collect())
}

fn status_named(name: &str) -> Option<Status> {
    use Status::{Converged, Diverged, IterationLimit, NotIdentifiable, Stalled};
    [Converged, Stalled, IterationLimit, Diverged, NotIdentifiable].into_iter().find(|s| status_name(*s) == name)
}
