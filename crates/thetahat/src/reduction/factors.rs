use crate::{linear_algebra::Matrix, series::Series};

/// Segments of one recording, of which none is shorter than [`SHORTEST`] rows where there are several.
pub(super) const MOST_SEGMENTS: usize = 32;
const SHORTEST: usize = 16;

/// A stretch of time of one recording: for each joint the upper triangular factor of its rows of [X y].
#[derive(Debug, Clone, PartialEq)]
pub struct Segment {
    /// Rows of each joint.
    pub rows: usize,
    /// R of each joint, with a column for each base parameter that acts on the joint and one for y: as many rows as the
    /// segment has, but no more than columns.
    pub factors: Vec<Matrix>,
}

impl Segment {
    /// Two segments that follow one another, as one.
    pub(super) fn joined(&self, next: &Self) -> Self {
        let factor = |(a, b): (&Matrix, &Matrix)| Matrix::stack(&[a, b]).triangular_factor();
        Self { rows: self.rows + next.rows, factors: self.factors.iter().zip(&next.factors).map(factor).collect() }
    }
}

/// Neighbours joined two by two, until there are no more than so many segments.
pub(super) fn coarsened(mut segments: Vec<Segment>, most: usize) -> Vec<Segment> {
    while segments.len() > most.max(1) {
        let pair = |pair: &[Segment]| match pair {
            [first, second] => first.joined(second),
            [first, ..] => first.clone(),
            [] => Segment { rows: 0, factors: Vec::new() },
        };
        segments = segments.chunks(2).map(pair).collect();
    }
    segments
}

/// Which channels of the decimated series make up the columns of each joint.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct JointColumns {
    /// For each joint: the channel of each base parameter that acts on it, and last that of its torque.
    pub channels: Vec<Vec<usize>>,
}

/// Takes the rows of a recording as they come and keeps their factors.
pub(super) struct Accumulator {
    columns: JointColumns,
    /// Rows of each segment but the last.
    rows: usize,
    current: Segment,
    finished: Vec<Segment>,
}

impl Accumulator {
    /// For a recording of so many rows per joint. The length of the segments follows from it.
    pub(super) fn new(columns: JointColumns, rows: usize) -> Self {
        let mut length = SHORTEST;
        while rows.div_ceil(length) > MOST_SEGMENTS {
            length *= 2;
        }
        let current = Self::empty(&columns);
        Self { columns, rows: length, current, finished: Vec::new() }
    }

    fn empty(columns: &JointColumns) -> Segment {
        let factors = columns.channels.iter().map(|channels| Matrix::zeros(0, channels.len())).collect();
        Segment { rows: 0, factors }
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
