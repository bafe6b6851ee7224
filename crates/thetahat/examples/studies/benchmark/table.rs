//! The table: what, whose seconds, the ratio and the target.

/// One figure.
pub struct Row {
    name: String,
    seconds: f64,
    peer: Option<f64>,
    /// Times faster than the peer, or seconds where there is none.
    target: f64,
    limit: bool,
}

impl Row {
    /// To be `target` times faster than a peer.
    pub fn ratio(name: impl Into<String>, seconds: f64, peer: Option<f64>, target: f64) -> Self {
        Self { name: name.into(), seconds, peer, target, limit: false }
    }

    /// To take at most `target` seconds.
    pub fn limit(name: impl Into<String>, seconds: f64, target: f64) -> Self {
        Self { name: name.into(), seconds, peer: None, target, limit: true }
    }

    fn line(&self) -> String {
        let Self { name, seconds, peer, target, limit } = self;
        let start = format!("{name:<50}{:>12}", readable(*seconds));
        match peer {
            Some(peer) => {
                let (ratio, verdict) = (peer / seconds, verdict(peer / seconds >= *target));
                format!("{start}{:>12}{ratio:>9.2}{:>12}  {verdict}", readable(*peer), format!("{target} times"))
            }
            None if *limit => {
                let verdict = verdict(seconds <= target);
                format!("{start}{:>12}{:>9}{:>12}  {verdict}", "-", "-", format!("{target} s"))
            }
            None => format!("{start}{:>12}{:>9}{:>12}", "-", "-", format!("{target} times")),
        }
    }
}

/// Whether a target is met.
pub fn verdict(met: bool) -> &'static str {
    if met { "met" } else { "MISSED" }
}

fn readable(seconds: f64) -> String {
    if seconds < 1e-4 { format!("{:.3} us", seconds * 1e6) } else { format!("{seconds:.4} s") }
}

/// Prints all rows.
pub fn print(rows: &[Row]) {
    println!("{:<50}{:>12}{:>12}{:>9}{:>12}", "work", "thetahat", "peer", "ratio", "target");
    rows.iter().for_each(|row| println!("{}", row.line()));
}
