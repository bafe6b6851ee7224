//! A column of stamps as seconds from its first.

use super::stamp::{Date, Stamp};

const DAY: i128 = 86_400_000_000_000;
const NANOSECONDS_PER_SECOND: f64 = 1e9;

/// Seconds from the first stamp on; none if the dates change and the order of day and month is neither stated nor evident.
///
/// Times of day alone go on after midnight. Missing stamps are NaN.
pub(super) fn seconds(stamps: &[Option<Stamp>], day_first: Option<bool>) -> Option<Vec<f64>> {
    let day_first = order(stamps, day_first)?;
    let mut midnights = 0;
    let (mut first, mut last) = (None, None);
    let second = |stamp: &Option<Stamp>| {
        let Some(stamp) = stamp else { return f64::NAN };
        let days = stamp.date.map_or(0, |date| date.days(day_first));
        let of_clock = i128::from(days) * DAY + i128::from(stamp.nanoseconds);
        let falls_by_half_a_day = last.is_some_and(|last: i128| of_clock + midnights * DAY < last - DAY / 2);
        if stamp.date.is_none() && falls_by_half_a_day {
            midnights += 1;
        }
        let time = of_clock + midnights * DAY;
        last = Some(time);
        (time - *first.get_or_insert(time)) as f64 / NANOSECONDS_PER_SECOND
    };
    Some(stamps.iter().map(second).collect())
}

/// Whether days come before months; none if that matters and is not evident, or contradicts what is stated. Of equal dates only the
/// difference counts, which is zero; of others, the order whose steps are all shorter than a day is evident, as a recording goes on after
/// midnight.
fn order(stamps: &[Option<Stamp>], stated: Option<bool>) -> Option<bool> {
    let of_numbers = |stamp: &Stamp| match stamp.date {
        Some(Date::TwoNumbers { first, second, .. }) => Some((first, second)),
        Some(Date::Days(_)) | None => None,
    };
    let dates = || stamps.iter().flatten().filter_map(of_numbers);
    let (day_first, month_first) = (dates().any(|(first, _)| first > 12), dates().any(|(_, second)| second > 12));
    let first = stamps.iter().flatten().find_map(|stamp| stamp.date);
    let are_equal = || stamps.iter().flatten().all(|stamp| stamp.date == first);
    match (day_first, month_first) {
        (true, true) => None,
        (true, false) => Some(true).filter(|_| stated != Some(false)),
        (false, true) => Some(false).filter(|_| stated != Some(true)),
        (false, false) if stated.is_some() => stated,
        (false, false) if dates().next().is_none() || are_equal() => Some(true),
        (false, false) => match [true, false].map(|day_first| longest_step(stamps, day_first) <= DAY) {
            [true, false] => Some(true),
            [false, true] => Some(false),
            [true, true] | [false, false] => None,
        },
    }
}

fn longest_step(stamps: &[Option<Stamp>], day_first: bool) -> i128 {
    let time = |stamp: &Stamp| {
        let days = stamp.date.map_or(0, |date| date.days(day_first));
        i128::from(days) * DAY + i128::from(stamp.nanoseconds)
    };
    let times: Vec<i128> = stamps.iter().flatten().map(time).collect();
    times.windows(2).map(|pair| (pair[1] - pair[0]).abs()).max().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(texts: &[&str], day_first: Option<bool>) -> Option<Vec<f64>> {
        seconds(&texts.iter().map(|text| Stamp::parse(text)).collect::<Vec<_>>(), day_first)
    }

    #[test]
    fn times_of_day_go_on_after_midnight() {
        assert_eq!(read(&["23:59:59.5", "0:00:00.5", "0:00:01"], None).unwrap(), [0.0, 1.0, 1.5]);
        assert_eq!(read(&["2026-12-31 23:59:59", "2027-01-01 00:00:01"], None).unwrap(), [0.0, 2.0]);
    }

    #[test]
    fn the_order_of_day_and_month_is_evident_or_stated() {
        let (evident, unclear) = (["25.11.2026", "26.11.2026"], ["03.05.2024", "07.05.2024"]);
        assert_eq!(read(&evident, None).unwrap(), [0.0, 86_400.0]);
        assert_eq!(read(&unclear, None), None);
        assert_eq!(read(&unclear, Some(true)).unwrap(), [0.0, 4.0 * 86_400.0]);
        assert_eq!(read(&unclear, Some(false)).unwrap(), [0.0, 122.0 * 86_400.0]);
        assert_eq!(read(&["03.05.2024 23:59:59", "04.05.2024 0:00:01"], None).unwrap(), [0.0, 2.0]);
        assert_eq!(read(&["05/03/2024 23:59:59", "05/04/2024 0:00:01"], None).unwrap(), [0.0, 2.0]);
        assert_eq!(read(&["03.05.2024 1:00:00", "03.05.2024 1:00:01"], None).unwrap(), [0.0, 1.0]);
        assert_eq!(read(&["25.11.2026", "11.25.2026"], None), None);
        assert_eq!(read(&evident, Some(false)), None);
    }

    #[test]
    fn nanoseconds_are_kept() {
        let found = read(&["2026-11-25 10:00:00.000000001", "2026-11-25 10:00:00.000000003"], None).unwrap();
        assert_eq!(found, [0.0, 2e-9]);
    }
}
