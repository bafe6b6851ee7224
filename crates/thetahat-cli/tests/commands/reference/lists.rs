//! Tables of codes, units, formats, words and methods.

use super::{
    facts::{FINDINGS, LINK_QUANTITIES, REASONS},
    keys::Keys,
    markdown::{code, prose, table},
    source::{Item, Sources, split},
};

/// A text with the constants that it names in braces.
fn filled(sources: &Sources, text: &str) -> String {
    let mut filled = String::new();
    let mut rest = text;
    while let Some((before, (inside, after))) = rest.split_once('{').map(|(b, r)| (b, r.split_once('}').expect("}"))) {
        let (file, name) = inside.split_once(' ').unwrap_or_else(|| panic!("{{{inside}}} names no file and constant"));
        filled += &format!("{before}{}", sources.file(file).constant(name).trim_end_matches(".0"));
        rest = after;
    }
    filled + rest
}

/// Rows of facts about the codes of an enum, with the enum's own meanings in the second place.
fn codes<const N: usize>(sources: &Sources, item: &Item, facts: &[[&str; N]]) -> Vec<Vec<String>> {
    let names = Keys::new(sources).names(item);
    let known: Vec<&str> = facts.iter().map(|fact| fact[0]).collect();
    let all: Vec<&str> = names.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(known, all, "facts.rs has the codes of {} in their order", item.name);
    let row = |((name, docs), fact): (&(String, String), &[&str; N])| {
        let others = fact[1..].iter().map(|text| filled(sources, text));
        [code(name), prose(docs)].into_iter().chain(others).collect()
    };
    names.iter().zip(facts).map(row).collect()
}

pub fn findings(sources: &Sources) -> String {
    let rows = codes(sources, sources.item("Code", "checks/finding"), &FINDINGS);
    table(&["code", "meaning", "severity", "evidence (limit)", "what to do"], &rows)
}

pub fn reasons(sources: &Sources) -> String {
    let rows = codes(sources, sources.item("ReasonCode", "results/verdict"), &REASONS);
    table(&["code", "meaning", "`care`", "`do-not-use`", "what to do"], &rows)
}

/// The names of an enum with their meanings.
pub fn names(sources: &Sources, [name, file]: [&str; 2]) -> String {
    let names = Keys::new(sources).names(sources.item(name, file));
    let rows: Vec<Vec<String>> = names.iter().map(|(name, docs)| vec![code(name), prose(docs)]).collect();
    table(&["name", "meaning"], &rows)
}

/// The units by what they measure.
pub fn units(sources: &Sources) -> String {
    let file = sources.file("recording/unit");
    let mut rows: Vec<Vec<String>> = Vec::new();
    for unit in &sources.item("Unit", "recording/unit").members {
        let values = file.values_of(&unit.name).unwrap_or_else(|| panic!("unit.rs: {}", unit.name));
        let [symbol, factor, dimension] = values.try_into().expect("symbol, factor and dimension");
        let dimension = file.text_of(dimension.trim_start_matches("Dimension::")).expect("it has words").to_owned();
        let factor = factor.replace(" * ", " ").replace(".0", "");
        let symbol = format!("{} ({factor})", code(symbol.trim_matches('"')));
        match rows.last_mut().filter(|row| row[0] == dimension) {
            Some(row) => row[1] += &format!(", {symbol}"),
            None => rows.push(vec![dimension, symbol]),
        }
    }
    table(&["what is measured", "units (factor to SI)"], &rows)
}

/// Other spellings of units in the names of columns.
pub fn spellings(sources: &Sources) -> String {
    let file = sources.file("experiment/unit_words");
    let units = sources.file("recording/unit");
    let mut rows: Vec<Vec<String>> = Vec::new();
    for pair in split(brackets(file.constant("SPELLINGS")), ',') {
        let pair = split(pair.trim_matches(['(', ')']), ',');
        let [spelling, unit] = pair.try_into().expect("a spelling and a unit");
        let symbol =
            units.values_of(unit.trim_start_matches("Unit::")).expect("a unit")[0].trim_matches('"').to_owned();
        let spelling = code(spelling.trim_matches('"'));
        match rows.last_mut().filter(|row| row[0] == code(&symbol)) {
            Some(row) => row[1] += &format!(" {spelling}"),
            None => rows.push(vec![code(&symbol), spelling]),
        }
    }
    let counts = words(file.constant("COUNTS"));
    rows.push(vec!["counts of a device".to_owned(), counts]);
    table(&["unit", "also written"], &rows)
}

/// The drivers that come with the program.
pub fn drivers() -> String {
    let drivers = thetahat::experiment::Driver::presets().expect("the presets are sound");
    let row = |d: &thetahat::experiment::Driver| vec![code(&d.name), d.title.clone(), d.effort.replace('|', "\\|")];
    table(&["name", "robots", "what effort means"], &drivers.iter().map(row).collect::<Vec<_>>())
}

/// The words by which columns are recognised.
pub fn column_names(sources: &Sources) -> String {
    let file = sources.file("experiment/column_names");
    let lists = [
        ("time", "TIME"),
        ("position", "POSITION"),
        ("velocity", "VELOCITY"),
        ("torque", "TORQUE"),
        ("reference of the position", "REFERENCE"),
        ("a position word with one of these is a reference", "DESIRED_WORDS"),
        ("not used", "OTHER"),
    ];
    let rows = lists.map(|(what, list)| vec![what.to_owned(), words(file.constant(list))]);
    table(&["signal", "words"], &rows)
}

/// A list of words in a source.
fn words(list: &str) -> String {
    let words = split(brackets(list), ',');
    words.iter().map(|word| code(word.trim_matches('"'))).collect::<Vec<_>>().join(" ")
}

fn brackets(list: &str) -> &str {
    list.trim().trim_start_matches('[').trim_end_matches(']')
}

/// The standard parameters with their units.
pub fn parameters(sources: &Sources) -> String {
    let mut rows: Vec<Vec<String>> = Vec::new();
    for item in ["LinkQuantity", "JointQuantity", "MotorQuantity"].map(|name| sources.item(name, "robot/quantity")) {
        rows.extend(item.members.iter().map(|quantity| parameter(sources, item, &quantity.name, &quantity.docs)));
    }
    let rows = merged(rows);
    table(&["names", "meaning", "unit, revolute", "unit, prismatic", "never negative"], &rows)
}

fn parameter(sources: &Sources, item: &Item, variant: &str, docs: &str) -> Vec<String> {
    let file = sources.file(&item.file);
    let values = file.values_of(variant).unwrap_or_else(|| panic!("{}.rs: no row of {variant}", item.file));
    let name = values[0].trim_matches('"').to_owned();
    let unit = file.constant(values.last().expect("a unit"));
    let of = |kind: &str| unit.split_once(&format!("{kind}: \"")).and_then(|(_, rest)| rest.split_once('"'));
    let [revolute, prismatic] = ["revolute", "prismatic"].map(|kind| of(kind).expect("a unit").0.to_owned());
    let link = LINK_QUANTITIES.iter().find(|(names, _)| names.split(' ').any(|n| n == name));
    let meaning = link.map_or_else(|| prose(docs), |(_, meaning)| (*meaning).to_owned());
    let is_bounded = values.iter().any(|v| v == "NotNegative") || item.name == "MotorQuantity";
    vec![code(&name), meaning, revolute, prismatic, if is_bounded { "yes" } else { "" }.to_owned()]
}

/// Rows that differ in their first cell alone are one.
fn merged(rows: Vec<Vec<String>>) -> Vec<Vec<String>> {
    let mut merged: Vec<Vec<String>> = Vec::new();
    for row in rows {
        match merged.last_mut().filter(|last| last[1..] == row[1..]) {
            Some(last) => last[0] += &format!(" {}", row[0]),
            None => merged.push(row),
        }
    }
    merged
}

/// The methods, and what each needs.
pub fn methods(sources: &Sources) -> String {
    let folder = "identification/estimators";
    let list = sources.file(&format!("{folder}/mod"));
    let names = ["Needs", "Response"].map(|name| sources.item(name, &format!("{folder}/estimator")));
    let docs = |item: &Item, value: &str| {
        let variant = value.rsplit("::").next().unwrap_or(value);
        let found = item.members.iter().find(|m| m.name == variant);
        found.unwrap_or_else(|| panic!("{} has no {variant}", item.name)).docs.clone()
    };
    let mut rows = Vec::new();
    for entry in split(brackets(list.constant("ESTIMATORS")), ',') {
        let (file, constant) = entry.trim_start_matches('&').split_once("::").expect("a file and a constant");
        let value = |key: &str| estimator_value(sources, folder, [file, constant], key);
        let meaning = documented_constant(&list.text, constant);
        let [needs, response] = [docs(names[0], &value("needs")), docs(names[1], &value("response"))];
        rows.push(vec![code(value("name").trim_matches('"')), prose(&meaning), needs, response]);
    }
    table(&["method", "estimate", "needs beyond the regression", "compares"], &rows)
}

/// The value of a key of an estimator, of its own or of the one that it starts from.
fn estimator_value(sources: &Sources, folder: &str, [file, constant]: [&str; 2], key: &str) -> String {
    let text = &sources.file(&format!("{folder}/{file}")).text;
    let start = format!("static {constant}: Estimator = Estimator {{");
    let (_, inside) = text.split_once(&start).unwrap_or_else(|| panic!("{file}.rs: no estimator {constant}"));
    let fields = split(inside.split_once("};").map_or(inside, |(inside, _)| inside), ',');
    let own = fields.iter().find_map(|field| field.strip_prefix(&format!("{key}: ")));
    own.map(str::to_owned).unwrap_or_else(|| {
        let base = fields.iter().find_map(|field| field.strip_prefix("..")).expect("an estimator that it starts from");
        let base = base.rsplit("::").next().unwrap_or(base);
        estimator_value(sources, folder, [&base.trim_start_matches("IDIM_").to_lowercase(), base], key)
    })
}

/// The doc comment of a constant of a type.
fn documented_constant(text: &str, name: &str) -> String {
    let (before, _) = text.split_once(&format!("pub const {name}: Self")).unwrap_or_else(|| panic!("no {name}"));
    let docs: Vec<&str> =
        before.trim_end().lines().rev().map_while(|line| line.trim().strip_prefix("///")).map(str::trim).collect();
    docs.into_iter().rev().collect::<Vec<_>>().join(" ")
}

/// The columns of `parameters.csv`, with the meanings of the keys of `results.json` that they hold.
pub fn parameter_columns(sources: &Sources) -> String {
    let columns = sources.file("report/outputs/parameters_csv").constant("PARAMETER_COLUMNS");
    let structs = [("RunResult", "results/run"), ("ParameterResult", "results/parameters")];
    let items = structs.map(|(name, file)| sources.item(name, file));
    let meaning = |column: &str| {
        let whole = column.trim_end_matches("_low").trim_end_matches("_high");
        let found = items.iter().rev().flat_map(|item| &item.members).find(|m| m.name == whole);
        let docs = &found.unwrap_or_else(|| panic!("what is column {column}?")).docs;
        let end = if column.ends_with("_low") {
            " The low end."
        } else if column.ends_with("_high") {
            " The high end."
        } else {
            ""
        };
        format!("{}{end}", prose(docs))
    };
    let rows = split(brackets(columns), ',').into_iter().map(|column| {
        let column = column.trim_matches('"').to_owned();
        vec![code(&column), meaning(&column)]
    });
    table(&["column", "meaning"], &rows.collect::<Vec<_>>())
}
