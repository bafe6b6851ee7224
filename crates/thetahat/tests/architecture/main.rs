//! The order of the rooms: a room imports only rooms above it, and the files of a room import each other without a circle.
//!
//! Both are read from the sources, with re-exports followed to the file that defines what is imported.

mod imports;
mod tokens;

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::path::{Path, PathBuf};

use imports::{Module, Sources};

/// Rooms that do not pass yet, and the command line: a list that only shrinks.
const NOT_YET_CLEAN: &[&str] = &[];

/// The library's sources.
fn library() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

/// The command line's sources, which lie beside the library's in a checkout and not in a package.
fn command_line() -> Option<PathBuf> {
    Some(library().join("../../thetahat-cli/src")).filter(|src| src.is_dir())
}

#[test]
fn a_room_imports_only_rooms_above_it() {
    let sources = Sources::read(&library());
    let rooms = sources.rooms();
    let place = |module: &Module| module.first().and_then(|room| rooms.iter().position(|name| name == room));
    let mut report = String::new();
    for (from, to) in sources.imports() {
        if !from.is_empty() && place(&from) < place(&to) && !NOT_YET_CLEAN.contains(&from[0].as_str()) {
            let _ = writeln!(report, "{} imports {}", sources.file_name(&from), sources.file_name(&to));
        }
    }
    assert!(report.is_empty(), "imports of rooms below:\n{report}");
}

#[test]
fn files_of_a_room_import_each_other_without_a_circle() {
    let sources = Sources::read(&library());
    let room = |circle: &[Module]| circle[0].first().cloned().unwrap_or_default();
    let mut report = circles_but(&sources, |circle| NOT_YET_CLEAN.contains(&room(circle).as_str()));
    if let Some(src) = command_line() {
        report += &circles_but(&Sources::read(&src), |_| NOT_YET_CLEAN.contains(&"thetahat-cli"));
    }
    assert!(report.is_empty(), "files that import each other in a circle:\n{report}");
}

#[test]
fn no_function_is_allowed_too_many_arguments() {
    let sources = Sources::read(&library());
    let hits = sources.files_with("too_many_arguments");
    let hits: Vec<_> = hits.filter(|name| !NOT_YET_CLEAN.iter().any(|room| name.starts_with(room))).collect();
    assert!(hits.is_empty(), "a type for arguments that belong together is missing: {hits:?}");
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
    let sources = Sources::read(&library());
    let own = |name: &str| name.starts_with("files/") || name == "output.rs" || name.ends_with("tests.rs");
    let reads = |name: &&str| of_library(&std::fs::read_to_string(library().join(name)).unwrap());
    let found: Vec<&str> = sources.files_with("fn").filter(|name| !own(name)).filter(reads).collect();
    assert!(found.is_empty(), "files that read by themselves: {found:?}");
    let place = library().join("files/system.rs");
    assert!(
        of_library(&std::fs::read_to_string(place).unwrap()),
        "the words that are looked for are not those of the room"
    );
}

/// The circles of a crate, a line each, without those that are passed over.
fn circles_but(sources: &Sources, passed_over: impl Fn(&[Module]) -> bool) -> String {
    let mut imported: BTreeMap<_, BTreeSet<_>> = BTreeMap::new();
    for (from, to) in sources.imports() {
        imported.entry(from).or_default().insert(to);
    }
    let mut report = String::new();
    for circle in circles(&imported).iter().filter(|circle| !passed_over(circle)) {
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
