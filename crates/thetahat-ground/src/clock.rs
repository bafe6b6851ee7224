//! //! Elapsed time, where the machine has a clock.

/// Measures elapsed time.
///
/// `wasm32-unknown-unknown` has no clock, and the standard library panics there: its stopwatches show 0.
#[derive(Debug, Clone, Copy)]
pub struct Stopwatch {
    #[cfg(not(all(target_family = "wasm", target_os = "unknown")))]
    started: std::time::Instant,
}

impl Stopwatch {
    /// A stopwatch that starts now.
    pub fn start() -> Self {
        Self {
            #[cfg(not(all(target_family = "wasm", target_os = "unknown")))]
            started: std::time::Instant::now(),
        }
    }

    /// Seconds since the start; 0 where there is no clock.
    #[cfg(not(all(target_family = "wasm", target_os = "unknown")))]
    pub fn seconds(&self) -> f64 {
        self.started.elapsed().as_secs_f64()
    }

    /// Seconds since the start; 0 where there is no clock.
    #[cfg(all(target_family = "wasm", target_os = "unknown"))]
    pub fn seconds(&self) -> f64 {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use std::{thread, time::Duration};

    use super::*;

    #[test]
    fn a_stopwatch_shows_what_has_passed() {
        let stopwatch = Stopwatch::start();
        thread::sleep(Duration::from_millis(5));
        let first = stopwatch.seconds();
        assert!(first >= 0.005 && stopwatch.seconds() >= first);
    }
}
