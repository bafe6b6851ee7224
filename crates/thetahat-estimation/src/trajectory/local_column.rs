//! Columns of a matrix over the samples that differ from zero in one stretch of them only.

use std::ops::Range;

use thetahat_ground::linear_algebra::dot;

/// A column that is zero outside one stretch of the samples.
pub(super) struct LocalColumn {
    first: usize,
    values: Vec<f64>,
}

impl LocalColumn {
    /// The column with `value` of each sample in `stretch`.
    pub fn new(stretch: Range<usize>, value: impl FnMut(usize) -> f64) -> Self {
        Self { first: stretch.start, values: stretch.map(value).collect() }
    }

    /// The samples outside which the column is zero.
    pub fn stretch(&self) -> Range<usize> {
        self.first..self.first + self.values.len()
    }

    /// Product with a column of all samples.
    pub fn times(&self, all: &[f64]) -> f64 {
        dot(&self.values, &all[self.stretch()])
    }

    /// Product with another such column.
    pub fn dot(&self, other: &Self) -> f64 {
        let (from, to) = (self.first.max(other.first), self.stretch().end.min(other.stretch().end));
        if from >= to {
            return 0.0;
        }
        dot(&self.values[from - self.first..to - self.first], &other.values[from - other.first..to - other.first])
    }

    /// Adds a multiple of this column to one of all samples.
    pub fn add_to(&self, factor: f64, all: &mut [f64]) {
        all[self.stretch()].iter_mut().zip(&self.values).for_each(|(sum, value)| *sum += factor * value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_count_the_common_samples_only() {
        let [a, b, far] = [2..5, 4..7, 9..9].map(|stretch| LocalColumn::new(stretch, |i| i as f64));
        assert_eq!((a.dot(&b), b.dot(&a), a.dot(&far)), (16.0, 16.0, 0.0));
        assert_eq!(a.times(&[1.0; 9]), 9.0);
        let mut sum = vec![1.0; 7];
        b.add_to(2.0, &mut sum);
        assert_eq!(sum, [1.0, 1.0, 1.0, 1.0, 9.0, 11.0, 13.0]);
    }
}
