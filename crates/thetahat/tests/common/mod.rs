//! What the tests share: where recorded data and reference values lie, and small helpers.
#![allow(dead_code)]

use std::path::{Path, PathBuf};

use libtest_mimic::{Arguments, Failed, Trial};

/// The checkout's root.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The folder of data sets and reference values: `shared` beside the checkout, or `THETAHAT_SHARED`.
pub fn shared() -> PathBuf {
    std::env::var_os("THETAHAT_SHARED").map_or_else(|| root().join("../shared"), PathBuf::from)
}

/// The data sets.
pub fn data() -> PathBuf {
    shared().join("datasets")
}

/// A test by name.
pub type Named = (&'static str, fn() -> Result<(), Failed>);

/// Runs tests that need the shared data; where it is absent they count as ignored, and a line says so.
pub fn run_with_shared_data(tests: Vec<Named>) -> ! {
    let absent = !shared().is_dir();
    if absent {
        eprintln!(
            "\n*** SKIPPED: {} tests need the shared data, which is not at {} (set THETAHAT_SHARED) ***\n",
            tests.len(),
            shared().display()
        );
    }
    let trials = tests.into_iter().map(|(name, run)| Trial::test(name, run).with_ignored_flag(absent)).collect();
    libtest_mimic::run(&Arguments::from_args(), trials).exit()
}

/// Fails unless `|a - b| <= tolerance * max(1, |b|)`.
pub fn assert_close(a: f64, b: f64, tolerance: f64, what: &str) {
    assert!((a - b).abs() <= tolerance * b.abs().max(1.0), "{what}: {a} against {b}");
}

/// Fails with a message unless the condition holds.
pub fn ensure(holds: bool, message: impl Into<String>) -> Result<(), Failed> {
    if holds { Ok(()) } else { Err(message.into().into()) }
}

/// Fails unless `value` is the printed number, to half a unit of its last digit.
pub fn ensure_printed(value: f64, printed: &str, what: &str) -> Result<(), Failed> {
    let decimals = printed.split_once('.').map_or(0, |(_, d)| d.len() as i32);
    let number: f64 = printed.parse()?;
    let half_digit = 0.5 * 10f64.powi(-decimals) * (1.0 + 1e-9);
    ensure((value - number).abs() <= half_digit, format!("{what}: {value} is not {printed}"))
}
