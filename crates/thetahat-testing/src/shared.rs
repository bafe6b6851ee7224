//! The checkout, and the shared data next to it.

use std::path::{Path, PathBuf};

use libtest_mimic::{Arguments, Failed, Trial};

/// The checkout's root.
#[must_use]
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// A file of the checkout.
#[must_use]
pub fn project(file: &str) -> PathBuf {
    root().join(file)
}

/// The folder of data sets and reference values: `shared` next to the checkout, or `THETAHAT_SHARED`.
#[must_use]
pub fn shared() -> PathBuf {
    std::env::var_os("THETAHAT_SHARED").map_or_else(|| root().join("../shared"), PathBuf::from)
}

/// The data sets.
#[must_use]
pub fn data() -> PathBuf {
    shared().join("datasets")
}

/// A test with its name.
pub type Named = (&'static str, fn() -> Result<(), Failed>);

/// Runs tests that need the shared data; if it is absent they count as ignored, and a line says so.
pub fn run_with_shared_data(tests: Vec<Named>) -> ! {
    let absent = !shared().is_dir();
    if absent {
        say_skipped(&tests);
    }
    let trials = tests.into_iter().map(|(name, run)| Trial::test(name, run).with_ignored_flag(absent)).collect();
    libtest_mimic::run(&Arguments::from_args(), trials).exit()
}

/// Slow tests (minutes) that need the shared data: run only with `--ignored`, as the nightly script does.
pub fn run_slow_with_shared_data(tests: Vec<Named>) -> ! {
    if !shared().is_dir() {
        say_skipped(&tests);
        std::process::exit(0);
    }
    let trials = tests.into_iter().map(|(name, run)| Trial::test(name, run).with_ignored_flag(true)).collect();
    libtest_mimic::run(&Arguments::from_args(), trials).exit()
}

fn say_skipped(tests: &[Named]) {
    eprintln!(
        "\n*** SKIPPED: {} tests need the shared data, which is not at {} (set THETAHAT_SHARED) ***\n",
        tests.len(),
        shared().display()
    );
}
