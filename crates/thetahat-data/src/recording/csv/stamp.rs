//! Dates and times of day in cells: `2026-11-25T10:00:00.123Z`, `25.11.2026 10:00:00`, `10:00:00.123`.

/// A date, a time of day, or both.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Stamp {
    pub(super) date: Option<Date>,
    /// Since midnight, or since the start of an elapsed time.
    pub(super) nanoseconds: i64,
}

/// A date as it is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Date {
    /// Days since 1970-01-01, of a date whose order is evident.
    Days(i64),
    /// Two numbers before a year: day and month, or month and day.
    TwoNumbers { first: u8, second: u8, year: i64 },
}

impl Date {
    /// Days since 1970-01-01.
    pub(super) fn days(self, day_first: bool) -> i64 {
        match self {
            Self::Days(days) => days,
            Self::TwoNumbers { first, second, year } if day_first => days_since_1970(year, second, first),
            Self::TwoNumbers { first, second, year } => days_since_1970(year, first, second),
        }
    }
}

const MONTHS: [&str; 12] = ["jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec"];
const HOUR: i64 = 3_600_000_000_000;
/// Longest text that is examined.
const LONGEST: usize = 48;

impl Stamp {
    /// The stamp in a cell; none if the cell is something else.
    pub(super) fn parse(text: &str) -> Option<Self> {
        let text = text.trim();
        if text.len() > LONGEST || !text.starts_with(|c: char| c.is_ascii_digit()) || !text.is_ascii() {
            return None;
        }
        let extended = extended(text);
        let (elapsed_days, text) = without_days(extended.as_deref().unwrap_or(text));
        let (mut date, mut time, mut afternoon, mut zone) = (None, None, None, 0);
        for part in parts(text) {
            match part.to_ascii_lowercase().as_str() {
                "am" if time.is_some() => afternoon = Some(false),
                "pm" if time.is_some() => afternoon = Some(true),
                "utc" | "gmt" | "z" if time.is_some() => {}
                _ if part.contains(':') && time.is_none() => {
                    let (of_day, offset) = zoned(part)?;
                    time = Some(time_of_day(of_day)?);
                    zone = offset;
                }
                _ if part.starts_with(['+', '-']) && time.is_some() => zone = zone_offset(part)?,
                _ if date.is_none() && elapsed_days.is_none() => date = Some(parse_date(part)?),
                _ => return None,
            }
        }
        let seconds = time.filter(|_| date.is_none()).is_none_or(|time| time.has_seconds);
        if date.is_none() && time.is_none() || !seconds {
            return None;
        }
        let of_day = time.map_or(Some(0), |time| hours_of_half(time, afternoon))?;
        let nanoseconds = of_day.checked_add(elapsed_days.unwrap_or(0) * 24 * HOUR)? - zone;
        Some(Self { date, nanoseconds })
    }
}

/// `20261125T100000.5` with signs between its fields.
fn extended(text: &str) -> Option<String> {
    let (date, time) = text.split_once('T').filter(|(date, time)| date.len() == 8 && time.len() >= 6)?;
    if !date.bytes().chain(time.bytes().take(6)).all(|b| b.is_ascii_digit()) {
        return None;
    }
    let (year, month, day) = (&date[..4], &date[4..6], &date[6..]);
    Some(format!("{year}-{month}-{day}T{}:{}:{}", &time[..2], &time[2..4], &time[4..]))
}

/// The days before an elapsed time, as in `0 days 00:00:01.5`.
fn without_days(text: &str) -> (Option<i64>, &str) {
    let after = text.split_once(" days ").or_else(|| text.split_once(" day "));
    match after.map(|(days, rest)| (days.parse::<u16>(), rest)) {
        Some((Ok(days), rest)) => (Some(days.into()), rest),
        Some((Err(_), _)) | None => (None, text),
    }
}

/// The parts between spaces, or at a `T` between digits.
fn parts(text: &str) -> impl Iterator<Item = &str> {
    let is_digit = |byte: Option<&u8>| byte.is_some_and(u8::is_ascii_digit);
    let bytes = text.as_bytes();
    let is_t = |i: usize| i > 0 && bytes[i] == b'T' && is_digit(bytes.get(i - 1)) && is_digit(bytes.get(i + 1));
    let place = (0..bytes.len()).find(|&i| is_t(i));
    let (before, after) = place.map_or((text, ""), |i| (&text[..i], &text[i + 1..]));
    before.split_ascii_whitespace().chain(after.split_ascii_whitespace())
}

#[derive(Clone, Copy)]
struct TimeOfDay {
    nanoseconds: i64,
    has_seconds: bool,
}

fn hours_of_half(time: TimeOfDay, afternoon: Option<bool>) -> Option<i64> {
    let hours = time.nanoseconds / HOUR;
    match afternoon {
        None => Some(time.nanoseconds),
        Some(_) if !(1..=12).contains(&hours) => None,
        Some(afternoon) => {
            Some(time.nanoseconds + HOUR * (if afternoon { 12 } else { 0 } - if hours == 12 { 12 } else { 0 }))
        }
    }
}

/// A time and the offset of its zone.
fn zoned(text: &str) -> Option<(&str, i64)> {
    if let Some(time) = text.strip_suffix(['Z', 'z']) {
        return Some((time, 0));
    }
    match text.rfind(['+', '-']) {
        Some(place) => Some((&text[..place], zone_offset(&text[place..])?)),
        None => Some((text, 0)),
    }
}

fn zone_offset(text: &str) -> Option<i64> {
    let (sign, digits) = text.split_at_checked(1)?;
    let digits = digits.replace(':', "");
    let (hours, minutes) = digits.split_at_checked(2)?;
    let minutes = if minutes.is_empty() { 0 } else { number(minutes, 59)? };
    let offset = number(hours, 24)? * HOUR + minutes * HOUR / 60;
    Some(if sign == "-" { -offset } else { offset })
}

/// Hours, minutes, seconds, and milliseconds after a fourth colon, as some controllers write.
fn time_of_day(text: &str) -> Option<TimeOfDay> {
    let fields: Vec<&str> = text.split(':').collect();
    let (hours, minutes, seconds, thousandths) = match fields[..] {
        [hours, minutes] => (hours, minutes, None, None),
        [hours, minutes, seconds] => (hours, minutes, Some(seconds), None),
        [hours, minutes, seconds, thousandths] => (hours, minutes, Some(seconds), Some(thousandths)),
        _ => return None,
    };
    let whole = number(hours, 9999)? * HOUR + number(minutes, 59)? * HOUR / 60;
    let (seconds_text, fraction) =
        seconds.unwrap_or("0").split_once(['.', ',']).unwrap_or((seconds.unwrap_or("0"), ""));
    let fraction = match thousandths {
        Some(thousandths) if fraction.is_empty() && thousandths.len() == 3 => thousandths,
        Some(_) => return None,
        None => fraction,
    };
    let nanoseconds = whole + number(seconds_text, 60)? * HOUR / 3600 + nanoseconds(fraction)?;
    Some(TimeOfDay { nanoseconds, has_seconds: seconds.is_some() })
}

/// The digits after the decimal sign of seconds.
fn nanoseconds(fraction: &str) -> Option<i64> {
    if !fraction.bytes().all(|b| b.is_ascii_digit()) {
        return None;
    }
    let digits = fraction.bytes().chain(std::iter::repeat(b'0')).take(9);
    Some(digits.fold(0, |sum, digit| 10 * sum + i64::from(digit - b'0')))
}

fn parse_date(text: &str) -> Option<Date> {
    let sign = text.chars().find(|c| !c.is_ascii_digit()).filter(|c| matches!(c, '-' | '/' | '.'))?;
    let fields: Vec<&str> = text.split(sign).collect();
    let [first, second, third] = fields[..] else { return None };
    let year = |text: &str| number(text, 9999).filter(|_| text.len() == 4);
    let small = |text: &str, most| number(text, most).filter(|n| *n >= 1).and_then(|n| u8::try_from(n).ok());
    if let Some(year) = year(first) {
        return Some(Date::Days(days_since_1970(year, small(second, 12)?, small(third, 31)?)));
    }
    let of_century = |text: &str| number(text, 99).filter(|_| text.len() == 2 && sign != '-').map(|year| 2000 + year);
    let year = year(third).or_else(|| of_century(third))?;
    if let Some(month) = MONTHS.iter().position(|name| second.eq_ignore_ascii_case(name)) {
        return Some(Date::Days(days_since_1970(year, month as u8 + 1, small(first, 31)?)));
    }
    let (first, second) = (small(first, 31)?, small(second, 31)?);
    (first <= 12 || second <= 12).then_some(Date::TwoNumbers { first, second, year })
}

fn number(text: &str, most: i64) -> Option<i64> {
    let digits = (1..=4).contains(&text.len()) && text.bytes().all(|b| b.is_ascii_digit());
    text.parse().ok().filter(|n| digits && *n <= most)
}

/// Days of the Gregorian calendar; years begin in March, so that the day of a leap year is their last.
fn days_since_1970(year: i64, month: u8, day: u8) -> i64 {
    let (month, day) = (i64::from(month), i64::from(day));
    let (year, month) = if month <= 2 { (year - 1, month + 9) } else { (year, month - 3) };
    let before_month = (153 * month + 2) / 5;
    365 * year + year.div_euclid(4) - year.div_euclid(100) + year.div_euclid(400) + before_month + day - 1 - 719_468
}

#[cfg(test)]
mod tests {
    use super::*;

    fn days(text: &str) -> i64 {
        Stamp::parse(text).unwrap().date.unwrap().days(true)
    }

    fn seconds(text: &str) -> f64 {
        Stamp::parse(text).unwrap_or_else(|| panic!("{text}")).nanoseconds as f64 * 1e-9
    }

    /// Days by Python 3.11: `(datetime.date(y, m, d) - datetime.date(1970, 1, 1)).days`.
    #[test]
    fn dates_in_several_notations() {
        for text in ["2026-11-25", "2026/11/25", "25.11.2026", "25/11/2026", "25-Nov-2026", "25.11.26"] {
            assert_eq!(days(text), 20_782, "{text}");
        }
        assert_eq!((days("1970-01-01"), days("2000-02-29"), days("2024-03-01")), (0, 11_016, 19_783));
        assert_eq!(Stamp::parse("11/25/2026").unwrap().date.unwrap().days(false), 20_782);
    }

    #[test]
    fn times_of_day_with_and_without_a_date() {
        let expected = 36_000.123;
        for text in [
            "10:00:00.123",
            "10:00:00,123",
            "10:00:00:123",
            "10:00:00.123 AM",
            "2026-11-25 10:00:00.123",
            "2026-11-25T10:00:00.123Z",
            "20261125T100000.123Z",
            "2026-11-25T12:00:00.123+02:00",
            "2026-11-25 12:00:00.123 +0200",
            "25-Oct-2026 10:00:00.123",
            "0 days 10:00:00.123000000",
        ] {
            assert!((seconds(text) - expected).abs() < 1e-9, "{text}");
        }
        assert_eq!((seconds("12:00:01 AM"), seconds("12:00:01 PM"), seconds("1:00:00 PM")), (1.0, 43_201.0, 46_800.0));
        assert_eq!(seconds("25.11.2026 10:00"), 36_000.0);
    }

    #[test]
    fn what_is_no_stamp() {
        for text in [
            "",
            "on",
            "10",
            "1.5",
            "1.234.567",
            "10:00",
            "10:60:00",
            "10:00:00.1x",
            "2026-13-01",
            "32.12.2026",
            "13.13.2026",
        ] {
            assert_eq!(Stamp::parse(text), None, "{text}");
        }
    }

    #[test]
    fn damaged_stamps_never_panic() {
        let whole = b"2026-11-25T10:00:00.123+01:00 pm";
        for place in 0..whole.len() {
            for damage in 0..=127 {
                let mut bytes = whole.to_vec();
                bytes[place] = damage;
                let _ = Stamp::parse(str::from_utf8(&bytes).unwrap());
                let _ = Stamp::parse(str::from_utf8(&bytes[..place]).unwrap());
            }
        }
    }
}
