//! The paths that the files of a crate name, resolved to the files that define what is named.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use crate::tokens::{Token, tokens};

/// A module's path below the crate's root: `["recording", "csv", "read"]`.
pub type Module = Vec<String>;

/// The source files of a crate.
pub struct Sources {
    files: BTreeMap<Module, File>,
}

/// One file: its tokens and the names that its `use` declarations bind.
struct File {
    tokens: Vec<Token>,
    bound: BTreeMap<String, Vec<String>>,
    globs: Vec<Vec<String>>,
    name: String,
}

impl Sources {
    /// Reads every file of the folder `src`, except modules that exist only in tests.
    pub fn read(src: &Path) -> Self {
        let mut files = BTreeMap::new();
        let root = ["lib.rs", "main.rs"].map(|name| src.join(name)).into_iter().find(|path| path.is_file());
        read_module(&root.expect("a crate has lib.rs or main.rs"), src, &Module::new(), &mut files);
        Self { files }
    }

    /// The crate's top-level modules, in the order in which its root declares them.
    pub fn rooms(&self) -> Vec<String> {
        declared(&self.files[&Module::new()].tokens)
    }

    /// The file of a module, below `src`.
    pub fn file_name(&self, module: &Module) -> &str {
        &self.files[module].name
    }

    /// The files whose code holds a word.
    pub fn files_with(&self, word: &str) -> impl Iterator<Item = &str> {
        let with = move |file: &&File| file.tokens.iter().any(|token| token == word);
        self.files.values().filter(with).map(|file| file.name.as_str())
    }

    /// Every import: the importing module and the module that defines what it imports. `mod.rs` files pass on.
    pub fn imports(&self) -> Vec<(Module, Module)> {
        let mut imports = Vec::new();
        for (module, file) in &self.files {
            let mut named: Vec<_> = file.globs.clone();
            if !self.is_folder(module) {
                named.extend(file.bound.values().cloned());
            }
            named.extend(paths(&file.tokens, module, &file.bound));
            let defined = named.iter().filter_map(|path| self.defining(path));
            imports.extend(defined.filter(|target| target != module).map(|target| (module.clone(), target)));
        }
        imports.sort();
        imports.dedup();
        imports
    }

    /// Whether a module's file is a `mod.rs` or the crate's root.
    fn is_folder(&self, module: &Module) -> bool {
        module.is_empty() || self.files[module].name.ends_with("/mod.rs")
    }

    /// The module that defines what `path` names; none for a folder itself and for what no module of the crate holds.
    fn defining(&self, path: &[String]) -> Option<Module> {
        let mut module = Module::new();
        for (depth, name) in path.iter().enumerate() {
            let mut child = module.clone();
            child.push(name.clone());
            if self.files.contains_key(&child) {
                module = child;
            } else if let Some(target) = self.files[&module].bound.get(name).filter(|_| self.is_folder(&module)) {
                let target: Vec<_> = target.iter().chain(&path[depth + 1..]).cloned().collect();
                return self.defining(&target);
            } else {
                return Some(module);
            }
        }
        (!self.is_folder(&module)).then_some(module)
    }
}

/// Reads a module's file and the files of the modules it declares.
fn read_module(path: &Path, src: &Path, module: &Module, files: &mut BTreeMap<Module, File>) {
    let tokens = tokens(&fs::read_to_string(path).expect("a module's file is readable"));
    let folder = path.with_extension("");
    let folder = match folder.file_name().and_then(|name| name.to_str()) {
        Some("mod" | "lib" | "main") => path.parent().expect("a file lies in a folder").to_owned(),
        _ => folder,
    };
    for name in declared(&tokens) {
        let mut child = module.clone();
        child.push(name.clone());
        let flat = folder.join(format!("{name}.rs"));
        let nested = folder.join(&name).join("mod.rs");
        read_module(if flat.is_file() { &flat } else { &nested }, src, &child, files);
    }
    let name = path.strip_prefix(src).expect("sources lie in src").to_string_lossy().into_owned();
    let (bound, globs) = uses(&tokens, module);
    files.insert(module.clone(), File { tokens, bound, globs, name });
}

/// The modules that `mod name;` declares.
fn declared(tokens: &[Token]) -> Vec<String> {
    let triples = tokens.windows(3).filter(|triple| triple[0] == "mod" && triple[2] == ";");
    triples.map(|triple| triple[1].clone()).collect()
}

/// What the `use` declarations of a file bind (name to absolute path), and the paths behind its globs.
fn uses(tokens: &[Token], module: &Module) -> (BTreeMap<String, Vec<String>>, Vec<Vec<String>>) {
    let (mut bound, mut globs) = (BTreeMap::new(), Vec::new());
    for (at, _) in tokens.iter().enumerate().filter(|(_, token)| *token == "use") {
        let mut leaves = Vec::new();
        tree(tokens, at + 1, &[], &mut leaves);
        for (path, name) in leaves {
            let Some(path) = absolute(&path, module, tokens) else { continue };
            if name == "*" {
                globs.push(path);
            } else {
                bound.insert(name, path);
            }
        }
    }
    (bound, globs)
}

/// Walks over a `use` tree from `at`: its leaves as (path, bound name), and where it ends.
fn tree(tokens: &[Token], mut at: usize, prefix: &[String], leaves: &mut Vec<(Vec<String>, String)>) -> usize {
    let mut path = prefix.to_vec();
    let mut name = None;
    while at < tokens.len() {
        match tokens[at].as_str() {
            "{" => loop {
                at = tree(tokens, at + 1, &path, leaves);
                if tokens[at] == "}" {
                    return at + 1;
                }
            },
            ";" | "," | "}" => break,
            "::" => {}
            "as" => {
                at += 1;
                name = Some(tokens[at].clone());
            }
            "*" => name = Some("*".to_owned()),
            "self" if !path.is_empty() => {}
            word => path.push(word.to_owned()),
        }
        at += 1;
    }
    if path.len() > prefix.len() || name.is_some() || tokens[at - 1] == "self" {
        let name = name.or_else(|| path.last().cloned()).unwrap_or_default();
        leaves.push((path, name));
    }
    at
}

/// The path below the crate's root of a path named in `module`; none where it belongs to another crate.
fn absolute(path: &[String], module: &Module, tokens: &[Token]) -> Option<Vec<String>> {
    let first = path.first()?;
    if first == "crate" {
        return Some(path[1..].to_vec());
    }
    let ups = path.iter().take_while(|segment| *segment == "super").count();
    let own = ups > 0 || first == "self" || declared(tokens).contains(first);
    let base = &module[..module.len().checked_sub(ups)?];
    let rest = path[ups..].iter().skip(usize::from(first == "self"));
    own.then(|| base.iter().chain(rest).cloned().collect())
}

/// The paths named outside `use` declarations, with the names that these bind put in.
fn paths(tokens: &[Token], module: &Module, bound: &BTreeMap<String, Vec<String>>) -> Vec<Vec<String>> {
    let mut found = Vec::new();
    let mut at = 0;
    while at < tokens.len() {
        if tokens[at] == "use" {
            at += tokens[at..].iter().position(|token| token == ";").unwrap_or(1);
            continue;
        }
        let mut path = vec![tokens[at].clone()];
        while tokens.get(at + 1).is_some_and(|token| token == "::") && tokens.get(at + 2).is_some_and(|t| word(t)) {
            path.push(tokens[at + 2].clone());
            at += 2;
        }
        at += 1;
        if path.len() > 1 {
            let named = bound.get(&path[0]).map(|start| start.iter().chain(&path[1..]).cloned().collect());
            found.extend(named.or_else(|| absolute(&path, module, tokens)));
        }
    }
    found
}

/// Whether a token is an identifier.
fn word(token: &str) -> bool {
    token.starts_with(|first: char| first == '_' || first.is_ascii_alphabetic())
}
