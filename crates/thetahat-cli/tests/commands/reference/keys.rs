//! The keys of files: of each struct that a file is read into or written from, key by key what stands there, its default and its
//! meaning, from fields, types and doc comments.

use std::collections::{BTreeMap, VecDeque};

use super::{
    facts,
    markdown::{anchor, code, plural, prose, table},
    source::{Holds, Item, Member, Sources, split},
};

/// What a file's keys are shown as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// A file that is read: keys have defaults, tables are headed `[a.b]`.
    Toml,
    /// A file that is written: what is not there is null or left out, tables are headed `a.b[]`.
    Json,
}

/// A file, and the document in which its keys stand.
#[derive(Debug, Clone, Copy)]
pub struct Root {
    /// The name of the block.
    pub block: &'static str,
    pub document: &'static str,
    /// The heading above the block.
    pub heading: &'static str,
    /// What the headings of its tables begin with, where other files of the document have tables of the same name.
    pub word: &'static str,
    pub form: Form,
    /// The struct and its file.
    pub of: [&'static str; 2],
}

/// Where the keys of a type stand.
struct Home {
    document: &'static str,
    heading: String,
}

/// The keys of all files: what an earlier file describes, a later one links to.
pub struct Keys<'s> {
    sources: &'s Sources,
    homes: BTreeMap<String, Home>,
}

/// A table of keys that is to be written.
struct Section<'s> {
    item: &'s Item,
    path: Vec<Step>,
}

/// A key on the way to a table.
#[derive(Debug, Clone)]
struct Step {
    key: String,
    /// Whether it holds several tables.
    several: bool,
}

impl<'s> Keys<'s> {
    pub fn new(sources: &'s Sources) -> Self {
        Self { sources, homes: BTreeMap::new() }
    }

    /// All tables of a file.
    pub fn tables(&mut self, root: &Root) -> String {
        let [name, file] = root.of;
        let item = self.sources.item(name, file);
        self.homes.insert(name.to_owned(), Home { document: root.document, heading: root.heading.to_owned() });
        let mut waiting = VecDeque::from([Section { item, path: Vec::new() }]);
        let mut text = String::new();
        while let Some(section) = waiting.pop_front() {
            let children = self.children(&section);
            let new: Vec<Section<'s>> = children.into_iter().filter(|c| self.settle(root, c)).collect();
            text += &self.section(root, &section);
            new.into_iter().rev().for_each(|child| waiting.push_front(child));
        }
        text.trim_end().to_owned()
    }

    /// Notes where a table stands; whether it is the first of its type.
    fn settle(&mut self, root: &Root, child: &Section<'_>) -> bool {
        if self.homes.contains_key(&child.item.name) {
            return false;
        }
        let home = Home { document: root.document, heading: title(root, &child.path) };
        self.homes.insert(child.item.name.clone(), home);
        true
    }

    /// The tables that a table's keys hold.
    fn children(&self, section: &Section<'s>) -> Vec<Section<'s>> {
        let mut children = Vec::new();
        for member in section.item.members.iter().filter(|m| m.attributes.serde("skip").is_none()) {
            match &member.holds {
                Holds::Nothing => {}
                // The value of a variant stands in the place of the whole.
                Holds::One(of) => {
                    let key = (!section.item.is_enum()).then(|| key(member));
                    self.add_tables(of, key, section, &mut children);
                }
                Holds::Fields(fields) => fields.iter().for_each(|field| self.add_field(field, section, &mut children)),
            }
        }
        children
    }

    fn add_field(&self, field: &Member, section: &Section<'s>, children: &mut Vec<Section<'s>>) {
        let Holds::One(of) = &field.holds else { panic!("{}.rs: {} is no field", section.item.file, field.name) };
        self.add_tables(of, Some(key(field)), section, children);
    }

    fn add_tables(&self, of: &str, key: Option<String>, section: &Section<'s>, children: &mut Vec<Section<'s>>) {
        let (of, several) = unwrapped(of);
        if facts::named(of).is_some() {
            return;
        }
        let mut path = section.path.clone();
        path.extend(key.map(|key| Step { key, several }));
        if let Some([_, values]) = map(of) {
            path.push(Step { key: "NAME".to_owned(), several: unwrapped(&values).1 });
            return self.add_tables(&values, None, &Section { item: section.item, path }, children);
        }
        let Some(item) = self.sources.find(of, &section.item.file) else { return };
        if item.attributes.serde("untagged").is_some() {
            children.extend(self.children(&Section { item, path }));
        } else if !item.is_of_names() {
            children.push(Section { item, path });
        }
    }

    fn section(&self, root: &Root, section: &Section<'_>) -> String {
        let table =
            if section.item.is_enum() { self.kinds(root, section.item) } else { self.fields(root, section.item) };
        if section.path.is_empty() {
            return table + "\n";
        }
        let docs = &section.item.docs;
        format!("### {}\n\n{}\n\n{table}\n", title(root, &section.path), prose(docs))
    }

    /// The keys of a struct.
    fn fields(&self, root: &Root, item: &Item) -> String {
        table(&columns(root.form, "key"), &self.rows(root, item))
    }

    fn rows(&self, root: &Root, item: &Item) -> Vec<Vec<String>> {
        let shown = item.members.iter().filter(|m| m.attributes.serde("skip").is_none());
        shown.flat_map(|member| self.rows_of(root, item, member)).collect()
    }

    fn rows_of(&self, root: &Root, item: &Item, member: &Member) -> Vec<Vec<String>> {
        match &member.holds {
            Holds::One(of) if member.attributes.serde("flatten").is_some() => {
                self.rows(root, self.sources.item(of, &item.file))
            }
            Holds::One(_) | Holds::Nothing | Holds::Fields(_) => vec![self.row(root, item, member)],
        }
    }

    fn row(&self, root: &Root, item: &Item, member: &Member) -> Vec<String> {
        let Holds::One(of) = &member.holds else { panic!("{}.rs: {} is no field", item.file, member.name) };
        let value = self.value_of(root, item, member, of);
        let docs = self.shared_docs(item, member).unwrap_or_else(|| member.docs.clone());
        let meaning = [prose(&docs), self.names_in(of, &item.file)].join(" ").trim().to_owned();
        let mut row = vec![code(&key(member)), value];
        if root.form == Form::Toml {
            row.push(self.default(item, member, of));
        }
        row.push(meaning);
        row
    }

    /// The doc comment of the same field of another struct, for a field without one.
    fn shared_docs(&self, item: &Item, member: &Member) -> Option<String> {
        if !member.docs.is_empty() && !is_ignored(member) {
            return None;
        }
        let key = key(member);
        let found = facts::same_keys(&item.name).iter().find_map(|other| {
            let other = self.sources.item(other, &item.file);
            other.members.iter().find(|m| self::key(m) == key || m.name == format!("{key}s"))
        });
        let found = found.unwrap_or_else(|| panic!("{}.rs: `{key}` of {} has no doc comment", item.file, item.name));
        Some(found.docs.clone())
    }

    fn value_of(&self, root: &Root, item: &Item, member: &Member, of: &str) -> String {
        let value = self.value(root, of, &item.file);
        let helper = member.attributes.serde("deserialize_with").unwrap_or_default();
        let value = match (helper.ends_with("one_or_each::list"), value.strip_prefix("list of ")) {
            (true, Some(each)) => format!("{}, or a list of {each}", singular(each)),
            (true, None) | (false, _) => value,
        };
        match (root.form, of.starts_with("Option<"), member.attributes.serde("skip_serializing_if")) {
            (Form::Json, _, Some(_)) => format!("{value}; left out where there is none"),
            (Form::Json, true, None) => format!("{value} or `null`"),
            (Form::Json, false, None) | (Form::Toml, ..) => value,
        }
    }

    /// What a value of a type is.
    fn value(&self, root: &Root, of: &str, file: &str) -> String {
        let list = |of: &str| {
            let null = if root.form == Form::Json && of.starts_with("Option<") { " or `null`" } else { "" };
            format!("list of {}{null}", plural(&self.value(root, of, file)))
        };
        if let Some(text) = facts::named(of) {
            return text.to_owned();
        }
        for (wrapper, is_list) in WRAPPERS {
            if let Some(of) = of.strip_prefix(wrapper).and_then(|of| of.strip_suffix('>')) {
                let one = self.value(root, of, file);
                return match (is_list, wrapper) {
                    (true, _) => list(of),
                    (false, "OneOrEach<") => format!("{one}, or a list of {}", plural(&one)),
                    (false, _) => one,
                };
            }
        }
        if let Some([names, values]) = map(of) {
            let by = if names == "String" { "name".to_owned() } else { self.value(root, &names, file) };
            return format!("table of {} by {by}", plural(&self.value(root, &values, file)));
        }
        if let Some((of, count)) = of.strip_prefix('[').and_then(|a| a.strip_suffix(']')?.split_once("; ")) {
            return format!("{count} {}", plural(&self.value(root, of, file)));
        }
        self.value_of_item(root, self.sources.item(of, file))
    }

    fn value_of_item(&self, root: &Root, item: &Item) -> String {
        if item.attributes.serde("untagged").is_some() {
            let expected = item.attributes.serde("expecting").unwrap_or_default().replace("\\\"", "\"");
            return expected.trim_start_matches("expected ").to_owned();
        }
        if item.is_of_names() {
            return self.names(item).iter().map(|(name, _)| code(&quoted(name))).collect::<Vec<_>>().join(", ");
        }
        let Home { document, heading } =
            self.homes.get(&item.name).unwrap_or_else(|| panic!("the keys of {} stand nowhere", item.name));
        let document = if *document == root.document { "" } else { document };
        format!("[table]({document}#{})", anchor(heading))
    }

    /// The names that a value may be, with their meanings, where it is one of some names.
    fn names_in(&self, of: &str, file: &str) -> String {
        let (of, _) = unwrapped(of);
        let of = map(of).map_or_else(|| of.to_owned(), |[_, values]| values);
        if facts::named(&of).is_some() {
            return String::new();
        }
        let Some(item) = self.sources.find(&of, file) else { return String::new() };
        if item.is_of_names() {
            let meaning = |(name, docs): &(String, String)| format!("{}: {}", code(&quoted(name)), prose(docs));
            return self.names(item).iter().map(meaning).collect::<Vec<_>>().join(" ");
        }
        if item.attributes.serde("untagged").is_none() {
            return String::new();
        }
        let held = item.members.iter().filter_map(|variant| match &variant.holds {
            Holds::One(of) => Some(self.names_in(of, &item.file)),
            Holds::Nothing | Holds::Fields(_) => None,
        });
        held.filter(|names| !names.is_empty()).collect::<Vec<_>>().join(" ")
    }

    /// The variants of an enum of names, as files have them, with their doc comments.
    pub fn names(&self, item: &Item) -> Vec<(String, String)> {
        item.members.iter().map(|variant| (self.name(item, variant), variant.docs.clone())).collect()
    }

    /// A variant as files name it.
    fn name(&self, item: &Item, variant: &Member) -> String {
        let own = variant.attributes.serde("rename").map(str::to_owned);
        own.unwrap_or_else(|| match item.attributes.serde("rename_all") {
            Some("kebab-case") => words(&variant.name).join("-"),
            Some("snake_case") => words(&variant.name).join("_"),
            Some("lowercase") => variant.name.to_lowercase(),
            Some(other) => panic!("{}.rs: {} has rename_all = {other}", item.file, item.name),
            None => {
                let text = self.sources.file(&item.file).text_of(&variant.name);
                text.unwrap_or_else(|| panic!("{}.rs: how is {} written?", item.file, variant.name)).to_owned()
            }
        })
    }

    /// The kinds of a table with their keys.
    fn kinds(&self, root: &Root, item: &Item) -> String {
        let tag = item.attributes.serde("tag");
        let mut rows = Vec::new();
        for variant in &item.members {
            let fields: &[Member] = match &variant.holds {
                Holds::Fields(fields) => fields,
                Holds::Nothing => &[],
                Holds::One(_) => panic!("{}.rs: {} has no keys", item.file, variant.name),
            };
            let name = self.name(item, variant);
            let name = if tag.is_some() { quoted(&name) } else { name };
            let blank = vec![String::new(); columns(root.form, "").len() - 1];
            rows.push([vec![code(&name)], blank, vec![prose(&variant.docs)]].concat());
            let keys = fields.iter().map(|field| [vec![String::new()], self.row(root, item, field)].concat());
            rows.extend(keys);
        }
        let kind = tag.map_or_else(|| "kind".to_owned(), code);
        let columns = [vec![kind.as_str()], columns(root.form, "key")].concat();
        table(&columns, &rows)
    }

    /// The default of a key, or that there is none.
    fn default(&self, item: &Item, member: &Member, of: &str) -> String {
        if let Some(shown) = self.default_of_container(item, member, of) {
            return shown;
        }
        match member.attributes.serde("default") {
            Some("") => self.default_of_type(of, &item.file),
            Some(function) => {
                let expression = self.sources.file(&item.file).function(function);
                self.shown(expression, of, &item.file)
            }
            None if of.starts_with("Option<") => "none".to_owned(),
            None => "required".to_owned(),
        }
    }

    /// Where the whole struct has a default, that of one of its fields.
    fn default_of_container(&self, item: &Item, member: &Member, of: &str) -> Option<String> {
        item.attributes.serde("default").filter(|value| value.is_empty())?;
        if item.attributes.derives("Default") {
            return Some(self.default_of_type(of, &item.file));
        }
        let fields = self.default_fields(item);
        let own = fields.iter().find_map(|field| field.split_once(": ").filter(|(name, _)| *name == member.name));
        let (_, expression) = own.unwrap_or_else(|| panic!("{}.rs: no default of {}", item.file, member.name));
        Some(self.shown(expression, of, &item.file))
    }

    /// `field: expression` of each field of a struct's default.
    fn default_fields(&self, item: &Item) -> Vec<String> {
        let file = self.sources.file(&item.file);
        let expression = file.default(&item.name).unwrap_or_else(|| panic!("{} has no default", item.name));
        let expression = expression.strip_prefix("Self::").map_or(expression, |name| file.constant(name));
        let inside = expression.strip_prefix("Self {").and_then(|e| e.strip_suffix('}'));
        split(inside.unwrap_or_else(|| panic!("{}: {expression}", item.name)), ',')
    }

    fn default_of_type(&self, of: &str, file: &str) -> String {
        match of {
            "f64" | "usize" | "u8" | "u32" | "u64" => return code("0"),
            "bool" => return code("false"),
            _ => {}
        }
        if let Some((_, count)) = of.strip_prefix('[').and_then(|a| a.strip_suffix(']')?.split_once("; ")) {
            let count: usize = count.parse().expect("a length");
            return code(&format!("[{}]", vec!["0"; count].join(", ")));
        }
        if map(of).is_some() || unwrapped(of) != (of, false) {
            return "none".to_owned();
        }
        let Some(item) = self.sources.find(of, file) else { return "none".to_owned() };
        if let Some(variant) = item.members.iter().find(|m| m.attributes.is_default()) {
            return code(&quoted(&self.default_name(item, variant)));
        }
        match self.sources.file(&item.file).default(of).filter(|_| item.is_enum()) {
            Some(expression) => self.shown(expression, of, &item.file),
            None => "optional".to_owned(),
        }
    }

    /// The name of a variant that is a default; of one that is not read, that in its place.
    fn default_name(&self, item: &Item, variant: &Member) -> String {
        if item.attributes.serde("untagged").is_some() { variant.name.to_lowercase() } else { self.name(item, variant) }
    }

    /// A default's expression as a file has it.
    fn shown(&self, expression: &str, of: &str, file: &str) -> String {
        match (expression, expression.strip_suffix("::default()")) {
            ("None" | "Vec::new()" | "BTreeMap::new()" | "String::new()", _) => "none".to_owned(),
            (_, Some(of)) => self.default_of_type(of, file),
            (_, None) => code(&self.literal(expression, of, file)),
        }
    }

    fn literal(&self, expression: &str, of: &str, file: &str) -> String {
        let inside = |start: &str, end: &str| expression.strip_prefix(start)?.strip_suffix(end);
        if expression == "true" || expression == "false" || expression.parse::<f64>().is_ok() {
            return expression.trim_end_matches(".0").to_owned();
        }
        if let Some(values) = inside("vec![", "]") {
            let values: Vec<String> = split(values, ',').iter().map(|v| self.literal(v, of, file)).collect();
            return format!("[{}]", values.join(", "));
        }
        if let Some(one) = inside("OneOrEach::One(", ")") {
            return self.literal(one, of, file);
        }
        if let Some((name, place)) = expression.split_once('[').filter(|(name, _)| is_constant(name)) {
            let list = self.sources.file(file).constant(name).trim_matches(['[', ']']);
            let place: usize = place.trim_end_matches(']').parse().expect("a place");
            return self.literal(&split(list, ',')[place], of, file);
        }
        if is_constant(expression) {
            return self.literal(self.sources.file(file).constant(expression), of, file);
        }
        self.variant(expression, of, file)
    }

    /// A variant or a method as a default.
    fn variant(&self, expression: &str, of: &str, file: &str) -> String {
        let Some((name, variant)) = expression.split_once("::") else {
            panic!("{file}.rs: how is the default {expression} written?")
        };
        if is_constant(variant) {
            return quoted(&variant.to_lowercase().replace('_', "-"));
        }
        let name = if name == "Self" { of } else { name };
        let item = self.sources.item(name, file);
        let bare = variant.split(['(', ' ']).next().unwrap_or(variant);
        if let Some(value) = variant.strip_prefix(bare).and_then(|v| v.strip_prefix('(')?.strip_suffix(')')) {
            return self.literal(value, of, file);
        }
        let member = item.members.iter().find(|m| m.name == bare);
        let found = self.name(item, member.unwrap_or_else(|| panic!("{file}.rs: {expression}")));
        if variant == bare { quoted(&found) } else { format!("{{ {found} = {{}} }}") }
    }
}

const WRAPPERS: [(&str, bool); 4] = [("Option<", false), ("Vec<", true), ("OneOrEach<", false), ("Spanned<", false)];

/// A type without what wraps it, and whether it is one of several.
fn unwrapped(of: &str) -> (&str, bool) {
    for (wrapper, is_list) in WRAPPERS {
        if let Some(of) = of.strip_prefix(wrapper).and_then(|of| of.strip_suffix('>')) {
            let (of, several) = unwrapped(of);
            return (of, several || is_list);
        }
    }
    (of, false)
}

/// The types of names and values of a map.
fn map(of: &str) -> Option<[String; 2]> {
    split(of.strip_prefix("BTreeMap<")?.strip_suffix('>')?, ',').try_into().ok()
}

/// Whether it stands in its struct only so that its key is known.
pub fn is_ignored(member: &Member) -> bool {
    matches!(&member.holds, Holds::One(of) if of.contains("IgnoredAny"))
}

fn key(member: &Member) -> String {
    member.attributes.serde("rename").unwrap_or(&member.name).to_owned()
}

fn columns(form: Form, key: &str) -> Vec<&str> {
    match form {
        Form::Toml => vec![key, "value", "default", "meaning"],
        Form::Json => vec![key, "value", "meaning"],
    }
}

/// The heading of a table.
fn title(root: &Root, path: &[Step]) -> String {
    let name = match root.form {
        Form::Toml => toml_title(path),
        Form::Json => {
            let step = |step: &Step| [step.key.as_str(), if step.several { "[]" } else { "" }].concat();
            path.iter().map(step).collect::<Vec<_>>().join(".")
        }
    };
    format!("{} {}", root.word, code(&name)).trim().to_owned()
}

fn toml_title(path: &[Step]) -> String {
    let name = path.iter().map(|step| step.key.as_str()).collect::<Vec<_>>().join(".");
    if path.last().is_some_and(|last| last.several) { format!("[[{name}]]") } else { format!("[{name}]") }
}

fn quoted(name: &str) -> String {
    format!("\"{name}\"")
}

fn singular(plural: &str) -> String {
    plural.strip_suffix('s').unwrap_or(plural).to_owned()
}

fn is_constant(name: &str) -> bool {
    !name.is_empty() && name.chars().all(|c| c.is_ascii_uppercase() || c.is_ascii_digit() || c == '_')
}

/// The words of a name in capitals and small letters, lower case.
fn words(name: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    for c in name.chars() {
        match words.last_mut().filter(|_| !c.is_uppercase()) {
            Some(word) => word.push(c),
            None => words.push(c.to_lowercase().collect()),
        }
    }
    words
}

impl Item {
    /// Whether it is an enum. A struct's members all hold a value, and its attributes rename no variants.
    fn is_enum(&self) -> bool {
        self.members.iter().any(|m| m.name.starts_with(char::is_uppercase))
    }

    /// Whether it is an enum of names alone.
    pub fn is_of_names(&self) -> bool {
        self.members.iter().all(|m| matches!(m.holds, Holds::Nothing))
    }
}
