//! Folders of packages, and the files that may be read.

use std::{
    collections::BTreeMap,
    path::{Component, Path, PathBuf},
};

use super::XacroOptions;
use crate::robot::text_file::read_text;
use thetahat_ground::files;

/// Most folders above the file in which packages are looked for.
const MOST_ABOVE: usize = 10;
/// Folders of a workspace that hold packages.
const INSIDE: [&str; 3] = ["", "src", "share"];

/// The folders of packages, and those whose files may be read.
#[derive(Debug)]
pub(super) struct Folders {
    /// The folder of the file, and those above it.
    above: Vec<PathBuf>,
    packages: BTreeMap<String, PathBuf>,
    allowed: Vec<PathBuf>,
}

impl Folders {
    /// The folders of the file at `path`: it may read its package, or without one its own folder and the one above, and the
    /// packages that `options` name.
    pub(super) fn new(path: &Path, options: &XacroOptions) -> Self {
        // A workspace may hold links to the files of its packages.
        let folder = folder_of(&absolute(path.to_owned()));
        let above: Vec<PathBuf> = folder.ancestors().take(MOST_ABOVE).map(Path::to_owned).collect();
        let package = above.iter().find(|folder| is_package(folder));
        // The folder of all files would be no limit.
        let next = above.get(1).filter(|folder| folder.parent().is_some());
        let own = package.or(next).or(above.first()).cloned();
        let named = |(name, folder): &(String, PathBuf)| (name.clone(), absolute(folder.clone()));
        let packages: BTreeMap<String, PathBuf> = options.packages.iter().map(named).collect();
        let allowed = own.into_iter().chain(packages.values().cloned()).collect();
        Self { above, packages, allowed }
    }

    /// The folder of a package: as named, or a folder with a `package.xml` of that name among those above the file and what
    /// they hold.
    pub(super) fn package(&mut self, name: &str) -> Option<PathBuf> {
        if let Some(known) = self.packages.get(name) {
            return Some(known.clone());
        }
        let is_name = matches!(Path::new(name).components().collect::<Vec<_>>()[..], [Component::Normal(_)]);
        let found = self.above.iter().filter(|_| is_name).find_map(|folder| package_near(folder, name))?;
        let found = absolute(found);
        self.allowed.push(found.clone());
        self.packages.insert(name.to_owned(), found.clone());
        Some(found)
    }

    /// Whether a file may be read. A missing one may: reading it names it.
    pub(super) fn may_read(&self, path: &Path) -> bool {
        let real = absolute(path.to_owned());
        !files::exists(path) || self.allowed.iter().any(|folder| real.starts_with(folder))
    }
}

/// The absolute path, links followed: `$(find)` stands for it wherever the file is that says it.
fn absolute(path: PathBuf) -> PathBuf {
    // Files in memory have no root in their paths.
    Path::new("/").join(files::real(&path).unwrap_or(path))
}

/// The path of a file that the file at `from` names.
pub(super) fn relative_to(from: &Path, name: &str) -> PathBuf {
    folder_of(from).join(name)
}

/// The folder of a file.
pub(super) fn folder_of(path: &Path) -> PathBuf {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new(".")).to_owned()
}

fn package_near(folder: &Path, name: &str) -> Option<PathBuf> {
    let inside = INSIDE.iter().map(|between| folder.join(between).join(name));
    std::iter::once(folder.to_owned()).chain(inside).find(|candidate| is_package_of_name(candidate, name))
}

fn is_package(folder: &Path) -> bool {
    files::is_file(&folder.join("package.xml"))
}

fn is_package_of_name(folder: &Path, name: &str) -> bool {
    let found = is_package(folder).then(|| read_text(&folder.join("package.xml")).ok()).flatten();
    let stated = found.as_deref().and_then(|text| text.split_once("<name>")?.1.split_once("</name>"));
    stated.is_some_and(|(stated, _)| stated.trim() == name)
}
