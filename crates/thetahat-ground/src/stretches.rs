//! Stretches of samples that are alike.

use std::ops::Range;

/// The longest stretches of indices in a range for all of which a condition holds.
#[must_use]
pub fn stretches_where(within: Range<usize>, condition: impl Fn(usize) -> bool) -> Vec<Range<usize>> {
    let mut stretches: Vec<Range<usize>> = Vec::new();
    for k in within.filter(|&k| condition(k)) {
        match stretches.last_mut().filter(|last| last.end == k) {
            Some(last) => last.end = k + 1,
            None => stretches.push(k..k + 1),
        }
    }
    stretches
}

/// The stretches of equal values, one after the other.
#[must_use]
pub fn stretches_of_equal<T: PartialEq>(values: &[T]) -> Vec<Range<usize>> {
    let mut start = 0;
    let equal = values.chunk_by(|a, b| a == b);
    equal
        .map(|chunk| {
            start += chunk.len();
            start - chunk.len()..start
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stretches_end_with_their_range() {
        let ones = [3, 4, 5, 8, 9, 11];
        assert_eq!(stretches_where(4..12, |k| ones.contains(&k)), [4..6, 8..10, 11..12]);
        assert!(stretches_where(0..3, |k| ones.contains(&k)).is_empty());
    }

    #[test]
    fn equal_values_are_one_stretch() {
        assert_eq!(stretches_of_equal(&[1, 1, 2, 1, 1, 1]), [0..2, 2..3, 3..6]);
        assert!(stretches_of_equal::<f64>(&[]).is_empty());
    }
}
