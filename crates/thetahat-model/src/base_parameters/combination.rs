use std::collections::BTreeMap;

/// Columns with their factors.
pub(super) type Combination = BTreeMap<usize, f64>;
