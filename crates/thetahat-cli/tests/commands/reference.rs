//! The tables of `docs/reference` between `<!-- generated: NAME -->` and `<!-- end -->` are those that the sources give: keys, codes,
//! units and columns with their doc comments. `UPDATE_REFERENCE=1 cargo test -p thetahat-cli --test commands reference` writes them.

#[path = "reference/facts.rs"]
mod facts;
#[path = "reference/keys.rs"]
mod keys;
#[path = "reference/lists.rs"]
mod lists;
#[path = "reference/markdown.rs"]
mod markdown;
#[path = "reference/source.rs"]
mod source;

use std::{collections::BTreeMap, fs};

use keys::{Form, Keys, Root};
use source::Sources;
use thetahat_testing::project;

const DOCUMENTS: [&str; 6] = ["checks.md", "experiments.md", "recordings.md", "results.md", "robots.md", "verdict.md"];

/// The files with keys: types that an earlier one has are linked to from the later ones.
const ROOTS: [Root; 8] = [
    Root {
        block: "signal",
        document: "recordings.md",
        heading: "Keys of a signal",
        word: "",
        form: Form::Toml,
        of: ["ChannelSource", "recording/source"],
    },
    Root {
        block: "driver",
        document: "recordings.md",
        heading: "Keys of a driver file",
        word: "Driver",
        form: Form::Toml,
        of: ["Driver", "driver/file"],
    },
    Root {
        block: "robot",
        document: "robots.md",
        heading: "Keys of a robot file",
        word: "",
        form: Form::Toml,
        of: ["RobotFile", "robot/toml_file/file"],
    },
    Root {
        block: "experiment",
        document: "experiments.md",
        heading: "Keys of an experiment file",
        word: "",
        form: Form::Toml,
        of: ["Tables", "experiment/description"],
    },
    Root {
        block: "campaign",
        document: "experiments.md",
        heading: "Keys of a campaign file",
        word: "Campaign",
        form: Form::Toml,
        of: ["CampaignFile", "campaign/description"],
    },
    Root {
        block: "design",
        document: "experiments.md",
        heading: "Keys of a design file",
        word: "Design",
        form: Form::Toml,
        of: ["DesignFile", "design/text/description"],
    },
    Root {
        block: "results",
        document: "results.md",
        heading: "Keys of results.json",
        word: "",
        form: Form::Json,
        of: ["Results", "results/content"],
    },
    Root {
        block: "campaign rows",
        document: "results.md",
        heading: "Columns of a campaign's runs",
        word: "Run",
        form: Form::Json,
        of: ["Row", "campaign/row"],
    },
];

/// Every block by its name.
fn blocks(sources: &Sources) -> BTreeMap<&'static str, String> {
    let mut keys = Keys::new(sources);
    let tables: Vec<_> = ROOTS.iter().map(|root| (root.block, keys.tables(root))).collect();
    let lists = [
        ("findings", lists::findings(sources)),
        ("severities", lists::names(sources, ["Severity", "checks/finding"])),
        ("verdicts", lists::names(sources, ["Verdict", "results/verdict"])),
        ("reasons", lists::reasons(sources)),
        ("grades", lists::names(sources, ["Grade", "results/grade"])),
        ("comparisons", lists::names(sources, ["Comparison", "results/diagnosis"])),
        ("statuses", lists::names(sources, ["Status", "identification/outcome"])),
        ("units", lists::units(sources)),
        ("spellings", lists::spellings(sources)),
        ("drivers", lists::drivers()),
        ("column names", lists::column_names(sources)),
        ("formats", lists::names(sources, ["Format", "recording/format"])),
        ("parameters", lists::parameters(sources)),
        ("methods", lists::methods(sources)),
        ("parameters.csv", lists::parameter_columns(sources)),
    ];
    tables.into_iter().chain(lists).collect()
}

/// A document with its blocks as they are to be, and the names of these.
fn with_blocks<'t>(text: &'t str, blocks: &BTreeMap<&str, String>) -> (String, Vec<&'t str>) {
    let (mut document, mut names, mut rest) = (String::new(), Vec::new(), text);
    while let Some((before, after)) = rest.split_once("<!-- generated: ") {
        let (name, after) = after.split_once(" -->").expect("a marker ends with -->");
        let (_, after) = after.split_once("<!-- end -->").unwrap_or_else(|| panic!("the block {name} has no end"));
        let block = blocks.get(name).unwrap_or_else(|| panic!("no block is called {name}"));
        document += &format!("{before}<!-- generated: {name} -->\n\n{}\n\n<!-- end -->", block.trim_end());
        names.push(name);
        rest = after;
    }
    (document + rest, names)
}

/// The first line that differs.
fn difference(document: &str, found: &str, expected: &str) -> String {
    let lines = found.lines().zip(expected.lines()).enumerate();
    let (number, (found, expected)) = lines.into_iter().find(|(_, (a, b))| a != b).unwrap_or((0, ("", "")));
    format!("docs/reference/{document}:{}: is\n  {found}\nexpected\n  {expected}", number + 1)
}

#[test]
fn tables_are_those_of_the_sources() {
    let blocks = blocks(&Sources::read());
    let (mut stale, mut shown) = (Vec::new(), Vec::new());
    for document in DOCUMENTS {
        let path = project("docs/reference").join(document);
        let text = fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        let (expected, names) = with_blocks(&text, &blocks);
        shown.extend(names.into_iter().map(str::to_owned));
        if expected != text && std::env::var_os("UPDATE_REFERENCE").is_some() {
            fs::write(&path, expected).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        } else if expected != text {
            stale.push(difference(document, &text, &expected));
        }
    }
    let how = "UPDATE_REFERENCE=1 cargo test -p thetahat-cli --test commands reference writes the tables";
    assert!(stale.is_empty(), "{}\n{how}", stale.join("\n"));
    let missing: Vec<&&str> = blocks.keys().filter(|name| !shown.iter().any(|s| s == *name)).collect();
    assert!(missing.is_empty(), "no document shows {missing:?}");
}

/// The headings above the blocks are those that links from other tables lead to.
#[test]
fn blocks_stand_below_their_headings() {
    for root in ROOTS {
        let text = fs::read_to_string(project("docs/reference").join(root.document)).expect("the document is there");
        let (before, _) = text.split_once(&format!("<!-- generated: {} -->", root.block)).expect("the block is there");
        let heading = before
            .lines()
            .rev()
            .find_map(|line| line.trim_start_matches('#').strip_prefix(' ').filter(|_| line.starts_with("##")));
        assert_eq!(heading, Some(root.heading), "{}", root.document);
    }
}
