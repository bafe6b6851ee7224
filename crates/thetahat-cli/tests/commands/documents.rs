//! The links of all documents lead somewhere, on a code host and in the book of the documentation.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Component, Path, PathBuf};

use pulldown_cmark::{Event, Options, Parser, Tag, TagEnd};
use thetahat_testing::{project, root};

/// A document with what it links to and what can be linked to in it.
struct Document {
    path: PathBuf,
    links: Vec<String>,
    headings: Vec<String>,
}

impl Document {
    fn read(path: &Path) -> Self {
        let text = fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        Self { path: path.to_owned(), links: links(&text), headings: headings(&text) }
    }

    /// The names that code hosts and mdBook give the headings; the second of the same name has `-1` behind it.
    fn anchors(&self) -> Vec<String> {
        let names: Vec<String> = self.headings.iter().map(|heading| anchor_of(heading)).collect();
        let before = |i: usize| names[..i].iter().filter(|name| **name == names[i]).count();
        let numbered = |(i, name): (usize, &String)| match before(i) {
            0 => name.clone(),
            count => format!("{name}-{count}"),
        };
        names.iter().enumerate().map(numbered).collect()
    }

    /// Links into the checkout, as file and anchor.
    fn own_links(&self) -> impl Iterator<Item = (PathBuf, Option<&str>, &str)> {
        self.links.iter().filter(|link| !link.contains("://")).map(|link| {
            let (file, anchor) = link.split_once('#').map_or((link.as_str(), None), |(f, a)| (f, Some(a)));
            let folder = self.path.parent().expect("a document lies in a folder");
            (if file.is_empty() { self.path.clone() } else { direct(&folder.join(file)) }, anchor, link.as_str())
        })
    }
}

fn events(text: &str) -> Parser<'_> {
    Parser::new_ext(text, Options::ENABLE_TABLES)
}

fn links(text: &str) -> Vec<String> {
    let link = |event| {
        if let Event::Start(Tag::Link { dest_url, .. } | Tag::Image { dest_url, .. }) = event {
            Some(dest_url.into_string())
        } else {
            None
        }
    };
    events(text).filter_map(link).collect()
}

fn headings(text: &str) -> Vec<String> {
    let mut headings = Vec::new();
    let mut heading: Option<String> = None;
    for event in events(text) {
        if let Event::Start(Tag::Heading { .. }) = event {
            heading = Some(String::new());
        } else if let Event::End(TagEnd::Heading(_)) = event {
            headings.extend(heading.take());
        } else if let (Event::Text(part) | Event::Code(part), Some(heading)) = (event, &mut heading) {
            heading.push_str(&part);
        }
    }
    headings
}

fn anchor_of(heading: &str) -> String {
    let kept = |c: &char| c.is_alphanumeric() || ['-', '_', ' '].contains(c);
    heading.trim().to_lowercase().chars().filter(kept).collect::<String>().replace(' ', "-")
}

/// The files and folders of a folder of the checkout.
fn entries(folder: &Path) -> impl Iterator<Item = PathBuf> {
    fs::read_dir(folder).expect("the folder is there").map(|entry| entry.expect("it is readable").path())
}

/// The Markdown files of a folder of the checkout.
fn documents(folder: &Path) -> Vec<Document> {
    entries(folder)
        .filter(|file| file.extension().is_some_and(|e| e == "md"))
        .map(|file| Document::read(&file))
        .collect()
}

fn docs() -> PathBuf {
    direct(&project("docs"))
}

/// The documents of `docs` and of its folders.
fn book() -> Vec<Document> {
    let docs = docs();
    let folders = entries(&docs).filter(|entry| entry.is_dir());
    folders.chain([docs.clone()]).flat_map(|folder| documents(&folder)).collect()
}

/// A path without the parts that lead back, such as `manual/../theory`.
fn direct(path: &Path) -> PathBuf {
    let mut direct = PathBuf::new();
    for part in path.components() {
        if part == Component::ParentDir {
            direct.pop();
        } else {
            direct.push(part);
        }
    }
    direct
}

/// What is wrong with a link, where something is.
fn fault(file: &Path, anchor: Option<&str>) -> Option<&'static str> {
    if !file.exists() {
        return Some("leads to no file");
    }
    let known = |anchor: &str| Document::read(file).anchors().iter().any(|a| a == anchor);
    anchor.is_some_and(|a| !known(a)).then_some("leads to no heading")
}

#[test]
fn links_lead_to_files_and_headings() {
    let mut faults = Vec::new();
    for document in documents(&root()).iter().chain(&book()) {
        let wrong = document.own_links().filter_map(|(file, anchor, link)| Some((link, fault(&file, anchor)?)));
        faults.extend(wrong.map(|(link, fault)| format!("{}: {link} {fault}", document.path.display())));
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// The book holds `docs` alone.
#[test]
fn links_of_the_book_stay_in_it() {
    let docs = docs();
    for document in book() {
        for (file, _, link) in document.own_links() {
            assert!(file.starts_with(&docs), "{}: {link} leaves the book", document.path.display());
        }
    }
}

#[test]
fn every_document_is_one_chapter_of_the_book() {
    let all: BTreeSet<PathBuf> = book().into_iter().map(|d| d.path).collect();
    let summary = docs().join("SUMMARY.md");
    let chapters: Vec<PathBuf> = Document::read(&summary).own_links().map(|(file, ..)| file).collect();
    let listed: BTreeSet<PathBuf> = chapters.iter().cloned().chain([summary]).collect();
    assert_eq!(all, listed, "docs/SUMMARY.md lists the documents");
    assert_eq!(listed.len(), chapters.len() + 1, "a chapter is listed twice");
}
