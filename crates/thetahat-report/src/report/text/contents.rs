//! The content of a recording, for the terminal.

use crate::{
    report::{
        number::{rate, significant},
        table::Table,
        wrap::{TextWidth, wrap},
    },
    results::{ChannelSummary, ColumnSummary, Contents, TableSummary, TimeSummary},
};

/// Largest number of channels of a matrix with a row each.
const MOST_ROWS: usize = 40;
/// Longest list of gaps that is shown.
const GAPS: usize = 5;

/// Format, columns with their ranges, rate, jitter and gaps.
#[must_use]
pub fn contents_text(contents: &Contents, width: TextWidth) -> String {
    let mut text = wrap(&format!("{}: {}", contents.file.display(), contents.format), "", width);
    if contents.dialect.is_some_and(|d| d.drop_cut_line) {
        text += &wrap(
            "the last line is incomplete and was left out; to read the file, set drop_cut_line = true",
            "",
            width,
        );
    }
    contents.notes.iter().for_each(|note| text += &wrap(note, "", width));
    for table in &contents.tables {
        text += "\n";
        text += &columns(table).to_text(width);
        table.times.iter().take(1).for_each(|time| text += &times(time, width));
    }
    for topic in &contents.other_topics {
        text += &wrap(&format!("not read: topic {} ({})", topic.name, topic.kind), "", width);
    }
    text
}

fn columns(table: &TableSummary) -> Table {
    let rows = table.columns.iter().flat_map(rows).collect();
    let title = match table.name.as_str() {
        "" => format!("{} samples", table.samples),
        topic => format!("{topic}: {} samples", table.samples),
    };
    Table {
        title,
        lead: 1,
        head: ["column", "min", "max", "rms", "step", "note"].map(str::to_owned).to_vec(),
        rows,
        notes: vec!["step: the smallest difference between successive values.".to_owned()],
        ..Table::default()
    }
}

/// One row for each channel; the channels of a matrix have the names that a description uses.
fn rows(column: &ColumnSummary) -> Vec<Vec<String>> {
    if let Some(kind) = &column.not_numeric {
        return vec![vec![
            column.name.clone(),
            String::new(),
            String::new(),
            String::new(),
            String::new(),
            kind.clone(),
        ]];
    }
    let number = |value: Option<f64>, digits| value.map_or_else(|| "-".to_owned(), |v| significant(v, digits));
    let row = |(i, s): (usize, &ChannelSummary)| {
        let name = if column.channels > 1 { format!("{}[{}]", column.name, i + 1) } else { column.name.clone() };
        let missing = (s.not_finite > 0).then(|| format!("{} not numbers", s.not_finite));
        let note = missing.or_else(|| s.constant.then(|| "constant".to_owned())).unwrap_or_default();
        vec![name, number(s.min, 5), number(s.max, 5), number(s.rms, 4), number(s.resolution, 3), note]
    };
    if column.statistics.len() > MOST_ROWS {
        let ends = |of: fn(&ChannelSummary) -> Option<f64>, choose: fn(f64, f64) -> f64| {
            column.statistics.iter().filter_map(of).reduce(choose)
        };
        let (least, most) = (ends(|s| s.min, f64::min), ends(|s| s.max, f64::max));
        let note = format!("{} columns", column.channels);
        return vec![vec![column.name.clone(), number(least, 5), number(most, 5), String::new(), String::new(), note]];
    }
    let mut rows: Vec<Vec<String>> = column.statistics.iter().enumerate().map(row).collect();
    if column.in_rows {
        rows.iter_mut().for_each(|row| row[5] = format!("a row {}", row[5]).trim_end().to_owned());
    }
    rows
}

fn times(time: &TimeSummary, width: TextWidth) -> String {
    let [rms, largest] = [time.jitter_rms, time.jitter_max].map(|j| significant(100.0 * j, 3));
    let mut text = wrap(
        &format!(
            "time: {:?} in {}, {} Hz; steps deviate by {rms} % rms, at most {largest} %",
            time.column,
            time.unit.symbol(),
            rate(time.rate_hz),
        ),
        "",
        width,
    );
    let places: Vec<String> = time.gaps.iter().take(GAPS).map(|g| format!("sample {}", g.sample)).collect();
    if !places.is_empty() {
        text += &wrap(&format!("gaps: {}, at {} ...", time.gaps.len(), places.join(", ")), "", width);
    }
    if time.repeated + time.backwards > 0 {
        text +=
            &wrap(&format!("times repeated: {}; times that decrease: {}", time.repeated, time.backwards), "", width);
    }
    text
}
