//! The order of the rooms: a room imports only rooms above it, and the files of a room import each other without a circle.
//!
//! Both are read from the sources, with re-exports followed to the file that defines what is imported.

mod imports;
mod tokens;

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::path::{Path, PathBuf};

use imports::{Module, Sources};

/// The library's crates that have rooms, in the order of building.
const CRATES: [&str; 8] = ["ground", "robot", "model", "symbolic", "data", "estimation", "report", ""];

/// The folder of the crates: a checkout has all of them.
fn crates() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The sources of a crate.
fn sources_of(name: &str) -> PathBuf {
    let folder = if name.is_empty() { "thetahat".to_owned() } else { format!("thetahat-{name}") };
    crates().join(folder).join("src")
}

#[test]
fn a_room_imports_only_rooms_above_it() {
    let mut report = String::new();
    for name in CRATES {
        let sources = Sources::read(&sources_of(name));
        let rooms = sources.rooms();
        let place = |module: &Module| module.first().and_then(|room| rooms.iter().position(|name| name == room));
        for (from, to) in sources.imports() {
            if !from.is_empty() && place(&from) < place(&to) {
                let _ = writeln!(report, "{name}: {} imports {}", sources.file_name(&from), sources.file_name(&to));
            }
        }
    }
    assert!(report.is_empty(), "imports of rooms below:\n{report}");
}

#[test]
fn files_of_a_room_import_each_other_without_a_circle() {
    let all = CRATES.into_iter().chain(["cli"]);
    let report: String = all.map(|name| circles_of(&Sources::read(&sources_of(name)))).collect();
    assert!(report.is_empty(), "files that import each other in a circle:\n{report}");
}

#[test]
fn no_function_is_allowed_too_many_arguments() {
    for name in CRATES {
        let sources = Sources::read(&sources_of(name));
        let hits: Vec<_> = sources.files_with("too_many_arguments").collect();
        assert!(hits.is_empty(), "a type for arguments that belong together is missing: {hits:?}");
    }
}

/// A page in a browser has no files: the library reads through the room `files`, which has them in memory there. The files that
/// are written are judged and replaced by `output`.
#[test]
fn files_are_read_through_one_room() {
    const READ: [&str; 7] = [
        "fs::read(",
        "fs::read_to_string(",
        "fs::metadata(",
        "File::open(",
        ".canonicalize(",
        ".exists()",
        ".is_file()",
    ];
    let is_read = |line: &str| !line.trim_start().starts_with("//") && READ.iter().any(|word| line.contains(word));
    let of_library = |text: &str| text.split("#[cfg(test)]\nmod ").next().unwrap_or_default().lines().any(is_read);
    let own = |name: &str| name.starts_with("files/") || name.starts_with("output/") || name.ends_with("tests.rs");
    for name in CRATES {
        let folder = sources_of(name);
        let sources = Sources::read(&folder);
        let reads = |name: &&str| of_library(&std::fs::read_to_string(folder.join(name)).unwrap());
        let found: Vec<&str> = sources.files_with("fn").filter(|name| !own(name)).filter(reads).collect();
        assert!(found.is_empty(), "files that read by themselves: {found:?}");
    }
    let place = sources_of("ground").join("files/system.rs");
    assert!(
        of_library(&std::fs::read_to_string(place).unwrap()),
        "the words that are looked for are not those of the room"
    );
}

/// The circles of a crate, a line each.
fn circles_of(sources: &Sources) -> String {
    let mut imported: BTreeMap<_, BTreeSet<_>> = BTreeMap::new();
    for (from, to) in sources.imports() {
        imported.entry(from).or_default().insert(to);
    }
    let mut report = String::new();
    for circle in &circles(&imported) {
        let names: Vec<_> = circle.iter().map(|module| sources.file_name(module)).collect();
        let _ = writeln!(report, "{}", names.join(", "));
    }
    report
}

/// Sets of modules each of which imports, over any number of steps, every other one of its set.
fn circles(imported: &BTreeMap<Module, BTreeSet<Module>>) -> BTreeSet<Vec<Module>> {
    let reached: BTreeMap<_, _> = imported.keys().map(|module| (module, reached_from(module, imported))).collect();
    let back = |from: &Module, to: &Module| reached.get(to).is_some_and(|modules| modules.contains(from));
    let circle = |(from, modules): (&&Module, &BTreeSet<Module>)| {
        modules.iter().filter(|to| back(from, to)).cloned().collect::<Vec<_>>()
    };
    reached.iter().map(circle).filter(|circle| !circle.is_empty()).collect()
}

/// Every module that `module` imports over any number of steps.
fn reached_from(module: &Module, imported: &BTreeMap<Module, BTreeSet<Module>>) -> BTreeSet<Module> {
    let mut reached = BTreeSet::new();
    let mut next = vec![module];
    while let Some(module) = next.pop() {
        for target in imported.get(module).into_iter().flatten() {
            if reached.insert(target.clone()) {
                next.push(target);
            }
        }
    }
    reached
}
