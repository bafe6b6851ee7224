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

/// Tests that read these files of the shared data; if one is absent they count as ignored, and a line says so.
#[must_use]
pub fn trials_on_shared_data(files: &[&str], tests: Vec<Named>) -> Vec<Trial> {
    let absent = first_absent(files);
    if let Some(file) = &absent {
        say_skipped(&tests, file);
    }
    tests.into_iter().map(|(name, run)| Trial::test(name, run).with_ignored_flag(absent.is_some())).collect()
}

/// Slow tests (minutes) on the shared data: run only with `--ignored`, as the nightly script does.
#[must_use]
pub fn slow_trials(files: &[&str], tests: Vec<Named>) -> Vec<Trial> {
    if let Some(file) = first_absent(files) {
        say_skipped(&tests, &file);
        return Vec::new();
    }
    tests.into_iter().map(|(name, run)| Trial::test(name, run).with_ignored_flag(true)).collect()
}

/// Every twelfth of some cases, or all of them with `THETAHAT_ALL_TRIALS`, as each night. Groups of the same cases take others of them by
/// their number.
pub fn thinned<T>(cases: Vec<T>, group: usize) -> impl Iterator<Item = T> {
    const STRIDE: usize = 12;
    let stride = if all_are_wanted() { 1 } else { STRIDE };
    cases.into_iter().skip(group % stride).step_by(stride)
}

/// Trials that take long and check what others check as well: they run with `THETAHAT_ALL_TRIALS`, as each night.
#[must_use]
pub fn each_night(trials: Vec<Trial>) -> Vec<Trial> {
    if all_are_wanted() {
        return trials;
    }
    trials.into_iter().map(|trial| trial.with_ignored_flag(true)).collect()
}

fn all_are_wanted() -> bool {
    std::env::var_os("THETAHAT_ALL_TRIALS").is_some()
}

/// Whether the shared data has the file or folder.
#[must_use]
pub fn has_shared(file: &str) -> bool {
    shared().join(file).exists()
}

/// The trials of a module.
pub type Module = (&'static str, fn() -> Vec<Trial>);

/// Runs the trials of all modules. A filter `MODULE` or `MODULE::TEXT` takes those of one module.
pub fn run_modules(arguments: Arguments, modules: &[Module]) -> ! {
    let (module, arguments) = module_of(arguments, modules);
    let wanted = modules.iter().filter(|(name, _)| module.as_deref().is_none_or(|module| module == *name));
    let trials = wanted.flat_map(|(name, trials)| trials().into_iter().map(|trial| trial.with_kind(*name))).collect();
    libtest_mimic::run(&arguments, trials).exit()
}

/// The module that the filter names, and the arguments without it.
fn module_of(mut arguments: Arguments, modules: &[Module]) -> (Option<String>, Arguments) {
    let filter = arguments.filter.clone().unwrap_or_default();
    let (first, rest) = filter.split_once("::").map_or((filter.as_str(), None), |(first, rest)| (first, Some(rest)));
    if !modules.iter().any(|(name, _)| *name == first) {
        return (None, arguments);
    }
    arguments.filter = rest.map(str::to_owned);
    (Some(first.to_owned()), arguments)
}

fn first_absent(files: &[&str]) -> Option<PathBuf> {
    files.iter().map(|file| shared().join(file)).find(|path| !path.exists())
}

fn say_skipped(tests: &[Named], file: &Path) {
    eprintln!(
        "\n*** SKIPPED: {} tests need {}, which is absent (set THETAHAT_SHARED) ***\n",
        tests.len(),
        file.display()
    );
}
