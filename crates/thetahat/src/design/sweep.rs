/// One way of a sweep: a joint moves alone.
#[derive(Debug, Clone)]
pub(super) struct Sweep {
    pub(super) joint: usize,
    /// Where it ends.
    pub(super) end: Vec<f64>,
    /// T1, T2 and T3.
    pub(super) widths: [f64; 3],
}

impl Sweep {
    pub(super) fn seconds(&self) -> f64 {
        self.widths.iter().sum()
    }
}
