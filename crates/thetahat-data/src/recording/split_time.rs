//! Times in two columns of whole numbers: seconds, and the nanoseconds beyond them.

use super::table::{Column, Table, is_other_spelling, parts_of_time};

const NANOSECONDS_PER_SECOND: f64 = 1e9;
/// Seconds since 1970 of the dates of recordings: after 1973 and before 2286.
const EPOCH: std::ops::Range<f64> = 1e8..1e10;
/// A nanosecond of a recording is likely to be larger at some sample.
const LIKELY_NANOSECONDS: f64 = 1e8;
/// Fraction of steps within one second.
const WITHIN_A_SECOND: f64 = 0.5;

/// Adds the times that are asked for as `sec+nanosec`.
pub(super) fn add_requested(table: &mut Table, asked: &[String]) {
    for name in asked {
        if table.columns.iter().any(|column| column.name == *name) {
            continue;
        }
        let find = |part: &str| {
            let named = table.columns.iter().find(|c| c.name == part || is_other_spelling(part, &c.name));
            let numbered = part.parse::<usize>().ok().and_then(|number| table.columns.get(number.checked_sub(1)?));
            named.or(numbered)
        };
        let parts = parts_of_time(name).find_map(|(a, b)| find(a).zip(find(b)));
        if let Some(column) = parts.and_then(|(seconds, rest)| joined(name.clone(), seconds, rest)) {
            table.columns.push(column);
        }
    }
}

/// Adds the times of neighbouring columns that are seconds and nanoseconds.
pub(super) fn add_evident(table: &mut Table) {
    let found: Vec<Column> = table.columns.windows(2).filter_map(|pair| evident(&pair[0], &pair[1])).collect();
    table.columns.extend(found);
}

fn evident(seconds: &Column, rest: &Column) -> Option<Column> {
    if !are_seconds(seconds) || !are_nanoseconds(rest) {
        return None;
    }
    let name = format!("{}+{}", seconds.name, rest.name);
    joined(name, seconds, rest).filter(|time| time.values.is_sorted() && time.values.last() > time.values.first())
}

fn are_whole_numbers(column: &Column) -> bool {
    column.channels == 1
        && column.flaw.is_none()
        && !column.in_seconds
        && column.values.iter().all(|v| v.fract() == 0.0)
}

/// Whole numbers near the epoch or growing, and equal at most steps.
fn are_seconds(column: &Column) -> bool {
    let (Some(first), Some(last)) = (column.values.first(), column.values.last()) else { return false };
    let equal = column.values.windows(2).filter(|pair| pair[0] == pair[1]).count();
    let are_equal = equal as f64 >= WITHIN_A_SECOND * (column.values.len() - 1) as f64 && equal > 0;
    are_whole_numbers(column) && are_equal && (EPOCH.contains(first) || last > first)
}

fn are_nanoseconds(column: &Column) -> bool {
    let largest = column.values.iter().copied().fold(0.0, f64::max);
    let name = column.name.to_ascii_lowercase();
    let is_likely = largest >= LIKELY_NANOSECONDS || name.contains("nsec") || name.contains("nanosec");
    are_whole_numbers(column) && is_likely && column.values.iter().all(|v| (0.0..NANOSECONDS_PER_SECOND).contains(v))
}

/// The times in seconds from the first, before a difference of large numbers could be rounded.
fn joined(name: String, seconds: &Column, rest: &Column) -> Option<Column> {
    let (first, first_rest) = (seconds.values.first()?, rest.values.first()?);
    let differ = seconds.values.len() != rest.values.len();
    if differ || seconds.channels != 1 || rest.channels != 1 || seconds.in_seconds || rest.in_seconds {
        return None;
    }
    let time = |(second, rest): (&f64, &f64)| (second - first) + (rest - first_rest) / NANOSECONDS_PER_SECOND;
    let values = seconds.values.iter().zip(&rest.values).map(time).collect();
    let flaw = seconds.flaw.clone().or_else(|| rest.flaw.clone());
    Some(Column { flaw, in_seconds: true, ..Column::of_numbers(name, 1, values) })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn column(name: &str, values: &[f64]) -> Column {
        Column::of_numbers(name.to_owned(), 1, values.to_vec())
    }

    fn table(seconds: &[f64], rest: &[f64]) -> Table {
        Table { name: String::new(), columns: vec![column("1", seconds), column("2", rest)] }
    }

    #[test]
    fn seconds_and_nanoseconds_are_joined_without_rounding() {
        let mut found =
            table(&[1_695_196_914.0, 1_695_196_914.0, 1_695_196_915.0], &[999_000_000.0, 999_000_001.0, 3.0]);
        add_evident(&mut found);
        let time = found.columns.last().unwrap();
        assert_eq!((time.name.as_str(), time.in_seconds), ("1+2", true));
        assert!((time.values[1] - 1e-9).abs() < 1e-18 && (time.values[2] - 1_000_003e-9).abs() < 1e-15);
        let mut asked = table(&[5.0, 6.0], &[0.0, 0.0]);
        add_requested(&mut asked, &["1+2".to_owned(), "1+3".to_owned()]);
        assert_eq!((asked.columns.len(), &asked.columns[2].values), (3, &vec![0.0, 1.0]));
    }

    #[test]
    fn other_whole_numbers_are_not_joined() {
        for (seconds, rest) in [
            ([1.0, 2.0, 3.0], [2e8, 1e8, 3e8]),
            ([1.0, 1.0, 2.0], [2.0, 1.0, 5.0]),
            ([1.0, 1.0, 2.0], [2e8, 1e8, 3e8]),
            ([1.0, 1.0, 2.0], [2e8, 3e8, 1e9]),
            ([1.0, 1.0, 1.0], [2e8, 3e8, 4e8]),
        ] {
            let mut found = table(&seconds, &rest);
            add_evident(&mut found);
            assert_eq!(found.columns.len(), 2, "{seconds:?} {rest:?}");
        }
    }
}
