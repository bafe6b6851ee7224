use std::{borrow::Cow, ops::Range};

use thetahat_estimation::{identification::share_of_row, signal::Decimator};
use thetahat_ground::{linear_algebra::Matrix, series::Series};

/// Numbers of a recording's rows up to which all rows are kept: of more, triangular factors.
const MOST_NUMBERS: usize = 1 << 21;

/// Segments of one recording, of which none is shorter than [`SHORTEST`] rows where there are several.
pub(super) const MOST_SEGMENTS: usize = 32;
const SHORTEST: usize = 16;

/// What is kept of the rows of a recording.
#[derive(Debug, Clone, PartialEq)]
pub enum KeptRows {
    /// Every row of a short recording.
    All(JointRows),
    /// The triangular factors of a longer one, stretch by stretch of time.
    Factors(Vec<Segment>),
}

/// The rows of each joint of a recording in time order.
#[derive(Debug, Clone, PartialEq)]
pub struct JointRows {
    /// `[X y]` of each joint, with instruments `[Z X y]`: a column for each base parameter that acts on the joint, and one
    /// for y.
    pub rows: Vec<Matrix>,
    /// The part of each row of each joint that a mask leaves; none without a mask.
    pub shares: Option<Vec<Vec<f64>>>,
}

impl KeptRows {
    /// The same of a mask that leaves every sample.
    pub(super) fn without_mask(self) -> Self {
        match self {
            Self::All(rows) => Self::All(JointRows { shares: None, ..rows }),
            Self::Factors(segments) => Self::Factors(segments),
        }
    }

    /// The triangular factors, stretch by stretch.
    #[must_use]
    pub fn segments(&self) -> Cow<'_, [Segment]> {
        match self {
            Self::All(rows) => Cow::Owned(rows.segments()),
            Self::Factors(segments) => Cow::Borrowed(segments),
        }
    }
}

impl JointRows {
    fn segments(&self) -> Vec<Segment> {
        let rows = self.rows.first().map_or(0, Matrix::rows);
        let length = rows_of_segment(rows);
        let starts = (0..rows).step_by(length);
        starts.map(|start| self.segment(start..(start + length).min(rows))).collect()
    }

    fn segment(&self, range: Range<usize>) -> Segment {
        let squares = |shares: &Vec<f64>| shares[range.clone()].iter().map(|s| s * s).sum();
        Segment {
            rows: range.len(),
            counted: match &self.shares {
                Some(shares) => shares.iter().map(squares).collect(),
                None => vec![range.len() as f64; self.rows.len()],
            },
            factors: self.rows.iter().map(|rows| rows.row_range(range.clone()).triangular_factor()).collect(),
        }
    }
}

/// Rows of each segment but the last.
pub(super) fn rows_of_segment(rows: usize) -> usize {
    let mut length = SHORTEST;
    while rows.div_ceil(length) > MOST_SEGMENTS {
        length *= 2;
    }
    length
}

/// A stretch of time of one recording: for each joint the upper triangular factor of its rows of `[X y]`.
#[derive(Debug, Clone, PartialEq)]
pub struct Segment {
    /// Rows of each joint.
    pub rows: usize,
    /// The same of each joint, each row counted by the square of the part of it that a mask leaves.
    pub counted: Vec<f64>,
    /// R of each joint, with a column for each base parameter that acts on the joint and one for y: as many rows as the
    /// segment has, but no more than columns.
    pub factors: Vec<Matrix>,
}

impl Segment {
    /// Two segments that follow one another, as one.
    pub(super) fn joined(&self, next: &Self) -> Self {
        let factor = |(a, b): (&Matrix, &Matrix)| Matrix::stack(&[a, b]).triangular_factor();
        Self {
            rows: self.rows + next.rows,
            counted: self.counted.iter().zip(&next.counted).map(|(a, b)| a + b).collect(),
            factors: self.factors.iter().zip(&next.factors).map(factor).collect(),
        }
    }
}

/// Neighbours joined two by two, until there are no more than so many segments.
pub(super) fn coarsened(mut segments: Vec<Segment>, most: usize) -> Vec<Segment> {
    while segments.len() > most.max(1) {
        let pair = |pair: &[Segment]| match pair {
            [first, second] => first.joined(second),
            [first, ..] => first.clone(),
            [] => Segment { rows: 0, counted: Vec::new(), factors: Vec::new() },
        };
        segments = segments.chunks(2).map(pair).collect();
    }
    segments
}

/// Which channels of the decimated series make up the columns of each joint.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct JointColumns {
    /// For each joint: the channel of each base parameter that acts on it, and last the channel of its torque.
    pub channels: Vec<Vec<usize>>,
    /// The channel of the first joint's mask, before those of the others; none if every sample makes rows.
    pub mask: Option<usize>,
}

impl JointColumns {
    /// The part of a joint's row that the mask leaves.
    fn share(&self, row: &[f64], joint: usize, decimator: &Decimator) -> f64 {
        self.mask.map_or(1.0, |first| share_of_row(row[first + joint], decimator))
    }

    /// Numbers of one row of all joints.
    fn numbers(&self) -> usize {
        self.channels.iter().map(Vec::len).sum()
    }
}

/// Takes the rows of a recording as they come.
pub(super) enum RowCollector<'a> {
    All(RowStore<'a>),
    Factors(Accumulator<'a>),
}

impl<'a> RowCollector<'a> {
    /// For the rows that a decimator leaves of a recording.
    pub(super) fn new(columns: JointColumns, decimator: &'a Decimator) -> Self {
        if decimator.rows() * columns.numbers() > MOST_NUMBERS {
            return Self::Factors(Accumulator::new(columns, decimator));
        }
        let none = vec![Vec::new(); columns.channels.len()];
        Self::All(RowStore { columns, decimator, values: none.clone(), shares: none })
    }

    /// Takes rows: for each, all channels.
    pub(super) fn take(&mut self, rows: &Series) {
        match self {
            Self::All(store) => store.take(rows),
            Self::Factors(accumulator) => accumulator.take(rows),
        }
    }

    pub(super) fn finish(self) -> KeptRows {
        match self {
            Self::All(store) => KeptRows::All(store.finish()),
            Self::Factors(accumulator) => KeptRows::Factors(accumulator.finish()),
        }
    }
}

/// Keeps every row.
pub(super) struct RowStore<'a> {
    columns: JointColumns,
    decimator: &'a Decimator,
    /// The rows of each joint, one after the other.
    values: Vec<Vec<f64>>,
    shares: Vec<Vec<f64>>,
}

impl RowStore<'_> {
    fn take(&mut self, rows: &Series) {
        let Self { columns, decimator, values, shares } = self;
        for row in (0..rows.len()).map(|k| rows.sample(k)) {
            for (joint, channels) in columns.channels.iter().enumerate() {
                values[joint].extend(channels.iter().map(|c| row[*c]));
                shares[joint].push(columns.share(row, joint, decimator));
            }
        }
    }

    fn finish(self) -> JointRows {
        let matrix = |(values, channels): (&Vec<f64>, &Vec<usize>)| {
            let n = channels.len();
            Matrix::from_fn(values.len() / n, n, |i, j| values[i * n + j])
        };
        JointRows {
            rows: self.values.iter().zip(&self.columns.channels).map(matrix).collect(),
            shares: self.columns.mask.map(|_| self.shares),
        }
    }
}

/// Keeps the factors of the rows.
pub(super) struct Accumulator<'a> {
    columns: JointColumns,
    /// What the rows were decimated by.
    decimator: &'a Decimator,
    /// Rows of each segment but the last.
    rows: usize,
    current: Segment,
    finished: Vec<Segment>,
}

impl<'a> Accumulator<'a> {
    /// For a recording's rows after its decimator. The length of the segments follows from their number.
    pub(super) fn new(columns: JointColumns, decimator: &'a Decimator) -> Self {
        let length = rows_of_segment(decimator.rows());
        let current = Self::empty(&columns);
        Self { columns, decimator, rows: length, current, finished: Vec::new() }
    }

    fn empty(columns: &JointColumns) -> Segment {
        let factors = columns.channels.iter().map(|channels| Matrix::zeros(0, channels.len())).collect();
        Segment { rows: 0, counted: vec![0.0; columns.channels.len()], factors }
    }

    /// Takes rows: for each, all channels.
    pub(super) fn take(&mut self, rows: &Series) {
        let mut first = 0;
        while first < rows.len() {
            let count = (self.rows - self.current.rows).min(rows.len() - first);
            for (factor, channels) in self.current.factors.iter_mut().zip(&self.columns.channels) {
                let block = Matrix::from_fn(count, channels.len(), |i, j| rows.sample(first + i)[channels[j]]);
                *factor = Matrix::stack(&[factor, &block]).triangular_factor();
            }
            for (joint, counted) in self.current.counted.iter_mut().enumerate() {
                *counted += (first..first + count)
                    .map(|k| self.columns.share(rows.sample(k), joint, self.decimator).powi(2))
                    .sum::<f64>();
            }
            self.current.rows += count;
            first += count;
            if self.current.rows == self.rows {
                let empty = Self::empty(&self.columns);
                self.finished.push(std::mem::replace(&mut self.current, empty));
            }
        }
    }

    pub(super) fn finish(mut self) -> Vec<Segment> {
        if self.current.rows > 0 {
            self.finished.push(self.current);
        }
        self.finished
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use thetahat_ground::linear_algebra::PivotedQr;

    const ROWS: usize = 2000;
    const COLUMNS: usize = 12;
    /// Digits are counted up to the precision of a double.
    const ALL: f64 = 16.0;

    /// Powers of t, rounded so that y is exact in double precision: the estimates are known exactly.
    fn ill_conditioned() -> (Series, Vec<f64>) {
        let grid = (1_u64 << 30) as f64;
        let power = |k: usize, j: i32| ((k as f64 / ROWS as f64).powi(j) * grid).round() / grid;
        let theta: Vec<f64> = (0..COLUMNS).map(|j| (j * j % 7) as f64 - 3.0).collect();
        let mut values = Vec::new();
        for k in 0..ROWS {
            let row: Vec<f64> = (0..COLUMNS as i32).map(|j| power(k, j)).collect();
            let y: f64 = row.iter().zip(&theta).map(|(x, t)| x * t).sum();
            values.extend(row);
            values.push(y);
        }
        (Series::shaped(COLUMNS + 1, values), theta)
    }

    fn digits(found: &[f64], exact: &[f64]) -> f64 {
        let error = |(f, e): (&f64, &f64)| (f - e).abs() / e.abs().max(1.0);
        (-found.iter().zip(exact).map(error).fold(0.0, f64::max).log10()).min(ALL)
    }

    /// At a condition number of 1e8 factors of factors keep as many digits as all rows at once, 7 or more; the product
    /// `X^T X`, whose condition number is the square, keeps two at the most.
    #[test]
    fn factors_keep_the_digits_that_products_lose() {
        let (rows, exact) = ill_conditioned();
        let all: Vec<usize> = (0..COLUMNS).collect();
        let x = Matrix::from_fn(ROWS, COLUMNS, |k, j| rows.sample(k)[j]);
        let y = rows.channel(COLUMNS);
        let condition = x.condition_number();
        let decimator = Decimator::new(1, ROWS).unwrap();
        let mut accumulator =
            Accumulator::new(JointColumns { channels: vec![(0..=COLUMNS).collect()], mask: None }, &decimator);
        (0..ROWS).step_by(50).for_each(|k| accumulator.take(&rows.window(k..k + 50)));
        let merged = coarsened(accumulator.finish(), 1);
        let r = &merged[0].factors[0];
        let of_factors = digits(&PivotedQr::new(&r.select_columns(&all)).solve(r.column(COLUMNS)), &exact);
        let of_rows = digits(&PivotedQr::new(&x).solve(&y), &exact);
        let products = PivotedQr::new(&x.transposed_times(&x)).solve(&x.transpose().times(&y));
        let of_products = digits(&products, &exact);
        println!(
            "condition {condition:.1e}: digits {of_factors:.1} factors, {of_rows:.1} rows, {of_products:.1} products"
        );
        assert!((1e7..1e9).contains(&condition), "{condition:e}");
        assert!(of_factors > 7.0 && of_factors > of_rows - 1.5, "{of_factors} {of_rows}");
        assert!(of_products < 2.5, "{of_products}");
    }

    /// The second joint's mask leaves a half of each row, and a ring above one counts as one.
    #[test]
    fn rows_count_by_the_square_of_what_a_mask_leaves() {
        let decimator = Decimator::new(1, 40).unwrap();
        let columns = JointColumns { channels: vec![vec![0], vec![0]], mask: Some(1) };
        let mut accumulator = Accumulator::new(columns, &decimator);
        accumulator.take(&Series::side_by_side(&[vec![1.0; 40], vec![1.02; 40], vec![0.5; 40]]));
        let segments = accumulator.finish();
        assert_eq!(segments.iter().map(|s| s.rows).collect::<Vec<_>>(), [16, 16, 8]);
        assert_eq!(segments[0].counted, [16.0, 4.0]);
        assert_eq!(coarsened(segments, 1)[0].counted, [40.0, 10.0]);
    }

    #[test]
    fn segments_are_few_and_hold_all_rows() {
        for rows in [1, 15, 16, 17, 368, 512, 513, 100_000] {
            let decimator = Decimator::new(1, rows).unwrap();
            let columns = JointColumns { channels: vec![vec![0, 1]], mask: None };
            let mut accumulator = Accumulator::new(columns, &decimator);
            let series = Series::shaped(2, (0..2 * rows).map(|k| (k as f64).sin()).collect());
            for first in (0..rows).step_by(37) {
                accumulator.take(&series.window(first..(first + 37).min(rows)));
            }
            let segments = accumulator.finish();
            assert_eq!(segments.iter().map(|s| s.rows).sum::<usize>(), rows);
            assert_eq!(segments.iter().map(|s| s.counted[0]).sum::<f64>(), rows as f64);
            assert!(segments.len() <= MOST_SEGMENTS && (rows < 272 || segments.len() > 16), "{rows}");
        }
    }
}
