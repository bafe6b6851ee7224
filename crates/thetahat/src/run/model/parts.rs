//! The parts of a recording that are left out in turn to choose and judge the model.

/// Parts that are left out in turn.
pub(crate) const FOLDS: usize = 5;
/// Numbers of stretches of time into which a recording is divided, tried in this order.
pub(crate) const STRETCHES: [usize; 4] = [10, 20, 40, 80];

/// For each division of its recording into stretches, the part to which a row belongs; none near a border between parts,
/// where rows know of both.
pub type Parts = [Option<u8>; STRETCHES.len()];

/// The parts of the rows of a recording, joint by joint the same.
#[derive(Debug, Clone)]
pub(crate) struct RowParts {
    /// Where each row lies, from zero to one: in the recording, or in the period of a motion that repeats.
    places: Vec<f64>,
    /// Rows on either side of a border that belong to no part.
    reach: [usize; STRETCHES.len()],
}

impl RowParts {
    /// Rows within `memory` of a border belong to no part, at most a quarter of a stretch on either side.
    pub(crate) fn new(places: Vec<f64>, memory: usize) -> Self {
        let unbounded = Self { places, reach: [0; STRETCHES.len()] };
        let rows = unbounded.places.len();
        let borders = |division: usize| {
            (1..rows).filter(|&k| unbounded.part(division, k) != unbounded.part(division, k - 1)).count()
        };
        let reach = std::array::from_fn(|division| memory.min(rows / (4 * (borders(division) + 1))));
        Self { reach, ..unbounded }
    }

    /// The part of a row whether or not a border is near; of a motion that repeats, the same stretch of each period.
    pub(crate) fn part(&self, division: usize, row: usize) -> usize {
        (self.places[row] * STRETCHES[division] as f64) as usize % FOLDS
    }

    pub(crate) fn of_row(&self, row: usize) -> Parts {
        std::array::from_fn(|division| {
            let (part, reach) = (self.part(division, row), self.reach[division]);
            let around = row.saturating_sub(reach)..(row + reach + 1).min(self.places.len());
            around.clone().all(|k| self.part(division, k) == part).then_some(part as u8)
        })
    }
}

/// Rows that the filters of a recording remember.
pub(crate) fn memory(sample_rate_hz: f64, cutoff_hz: f64, decimation: usize) -> usize {
    (sample_rate_hz / (cutoff_hz * decimation as f64)).ceil() as usize + 1
}

/// Where rows of a recording lie, from the time of each, s: in the period of a motion that repeats, or else in the recording.
pub(crate) fn places(times_s: impl ExactSizeIterator<Item = f64>, frequency_hz: Option<f64>) -> Vec<f64> {
    let count = times_s.len() as f64;
    let place = |(row, time_s): (usize, f64)| match frequency_hz {
        Some(frequency_hz) => (time_s * frequency_hz).fract(),
        None => row as f64 / count,
    };
    times_s.enumerate().map(place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_near_a_border_belong_to_no_part() {
        let rows = |count: usize| places((0..count).map(|k| k as f64), None);
        let parts = RowParts::new(rows(80), 9);
        let tenths: Vec<Option<u8>> = (0..20).map(|k| parts.of_row(k)[0]).collect();
        let none_near = |border: usize, k: usize| k + 2 >= border && k < border + 2;
        for (k, found) in tenths.into_iter().enumerate() {
            let part = (k / 8) as u8;
            assert_eq!(found, (!none_near(8, k) && !none_near(16, k)).then_some(part), "{k}");
        }
        assert_eq!(RowParts::new(rows(80), 1).reach, [1, 1, 0, 0]);
    }

    #[test]
    fn a_motion_that_repeats_has_the_same_part_in_each_period() {
        // No row lies on a border, where rounding decides.
        let times_s = (0..40).map(|k| (f64::from(k) + 0.3) / 20.0);
        let parts = RowParts::new(places(times_s, Some(1.0)), 0);
        let [first, second] = [0, 20].map(|from| (from..from + 20).map(|k| parts.of_row(k)).collect::<Vec<_>>());
        assert_eq!(first, second);
    }
}
