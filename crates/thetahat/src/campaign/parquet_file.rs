//! Rows as Parquet: columns of texts, whole numbers and numbers, each value present or absent.

use std::{fs::File, path::Path, sync::Arc};

use parquet::{
    basic::Compression,
    column::writer::ColumnWriter,
    data_type::ByteArray,
    errors::ParquetError,
    file::{
        properties::WriterProperties,
        reader::{FileReader, SerializedFileReader},
        writer::SerializedFileWriter,
    },
    record::{Field, Row as Record},
    schema::{parser::parse_message_type, types::Type},
};

use super::{CampaignError, Row, facts::Facts, files::replace_file, row::status_name};
use crate::identification::Status;

/// Which columns a file has beside those that say which run a row is.
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

/// Names of the columns that say which run a row is.
const TEXTS: [&str; 3] = ["case", "noise", "method"];
const WHOLES: [&str; 2] = ["start", "seed"];
const SECONDS: &str = "seconds";

/// Writes the rows to a temporary file and renames it: the file is there as a whole or not at all.
pub(super) fn write(path: &Path, rows: &[Row], facts: &Facts, content: Content) -> Result<(), CampaignError> {
    let refuse = |e: ParquetError| CampaignError::Write { path: path.to_owned(), reason: e.to_string() };
    let bytes = encode(&columns(rows, facts, content)).map_err(refuse)?;
    replace_file(path, &bytes)
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
    let properties = WriterProperties::builder().set_compression(Compression::SNAPPY).build();
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
    let damaged = |problem: String| CampaignError::Damaged { path: path.to_owned(), problem };
    let file =
        File::open(path).map_err(|e| CampaignError::Unreadable { path: path.to_owned(), reason: e.to_string() })?;
    let reader = SerializedFileReader::new(file).map_err(|e| damaged(e.to_string()))?;
    let records = reader.get_row_iter(None).map_err(|e| damaged(e.to_string()))?;
    let row = |(number, record): (usize, Result<Record, ParquetError>)| {
        let record = record.map_err(|e| damaged(e.to_string()))?;
        row(&record, facts).ok_or_else(|| damaged(format!("row {} is not that of a run", number + 1)))
    };
    records.enumerate().map(row).collect()
}

/// The row of a record; its parameters stand in the order of the facts.
fn row(record: &Record, facts: &Facts) -> Option<Row> {
    let fields: std::collections::BTreeMap<&str, &Field> =
        record.get_column_iter().map(|(name, field)| (name.as_str(), field)).collect();
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
    let damaged = |e: ParquetError| CampaignError::Damaged { path: path.to_owned(), problem: e.to_string() };
    let file =
        File::open(path).map_err(|e| CampaignError::Unreadable { path: path.to_owned(), reason: e.to_string() })?;
    let reader = SerializedFileReader::new(file).map_err(damaged)?;
    let seconds = |record: Result<Record, ParquetError>| {
        let record = record.map_err(damaged)?;
        let field = record.get_column_iter().find(|(name, _)| *name == SECONDS).map(|(_, field)| field.clone());
        Ok(if let Some(Field::Double(value)) = field { Some(value) } else { None })
    };
    reader.get_row_iter(None).map_err(damaged)?.map(seconds).collect()
}

fn status_named(name: &str) -> Option<Status> {
    use Status::{Converged, Diverged, IterationLimit, NotIdentifiable, Stalled};
    [Converged, Stalled, IterationLimit, Diverged, NotIdentifiable].into_iter().find(|s| status_name(*s) == name)
}
