//! How arrays are interpreted as channels.

/// Samples and channels of an array: a row or column vector is one channel; a matrix has one for each column.
pub(super) fn samples_and_channels(shape: &[usize]) -> Option<(usize, usize)> {
    match *shape {
        [1, columns] => Some((columns, 1)),
        [rows, columns] => Some((rows, columns)),
        _ => None,
    }
}
