//! Edits of texts in every form that a user may write, judged by what a parser reads.

use toml::{Table, Value};

use crate::experiment::remedies::text::{Change, with_table_of_array};

/// The text with a change, and its values.
fn made(text: &str, path: &[&str], index: usize, value: impl Into<Option<Value>>) -> (String, Table) {
    let edited = Change::new(path, index, value).made_in(text).unwrap_or_else(|| panic!("not edited: {text}"));
    let table = toml::from_str(&edited).unwrap();
    (edited, table)
}

const GAIN: [&str; 3] = ["recording", "torque", "gain"];

#[test]
fn every_form_of_a_table_gets_a_key() {
    let inline = "# own\n[recording]\ntorque = { file = \"a\" } # mine\n";
    let (edited, _) = made(inline, &GAIN, 0, Value::from(-1.0));
    assert_eq!(edited, "# own\n[recording]\ntorque = { file = \"a\", gain = -1.0 } # mine\n");
    for text in [
        inline,
        "[recording]\ntorque={file=\"a\"}",
        "[recording]\ntorque = {}",
        "recording = { torque = { file = 'a' } }",
        "[recording]\n[recording.torque] # mine\nfile = \"a\"\n\n[signal]\n",
        "[recording.torque]\nfile = \"a\"",
        "[recording]\ntorque.file = \"a\"\n  torque.unit = \"N m\" # mine\nname = \"b\"\n",
        "recording.torque.file = \"a\"\n[signal]",
        "[[recording]]\ntorque = { file = \"a\" }\n",
        "[recording]\r\ntorque = { file = \"a\" }\r\n",
    ] {
        let (edited, table) = made(text, &GAIN, 0, Value::from(-1.0));
        let recording = &table["recording"];
        let recording = recording.as_array().map_or(recording, |all| &all[0]);
        assert_eq!(recording["torque"]["gain"].as_float(), Some(-1.0), "{edited}");
        assert!(!text.contains("# mine") || edited.contains("# mine"), "{edited}");
        let (removed, _) = made(&edited, &GAIN, 0, None);
        let [was, is] = [text, &removed].map(|t| toml::from_str::<Table>(t).unwrap());
        assert_eq!(was, is, "{removed}");
    }
}

#[test]
fn the_second_of_several_tables_is_meant() {
    let text = "[[recording]]\nname = \"a\"\n\n[[recording]]\nname = \"b\"\n[recording.torque]\nfile = \"b\"\n";
    let change = Change::new(&GAIN, 1, Value::from(2.0));
    assert_eq!(change.key(2), "recording[2].torque.gain");
    let edited = change.made_in(text).unwrap();
    let table: Table = toml::from_str(&edited).unwrap();
    assert_eq!(table["recording"][1]["torque"]["gain"].as_float(), Some(2.0));
}

#[test]
fn a_table_that_is_not_there_is_added_and_a_key_that_is_there_replaced() {
    let (edited, _) = made("title = \"a\"", &["signal", "mask"], 0, Value::from("near-rest"));
    assert_eq!(edited, "title = \"a\"\n\n[signal]\nmask = \"near-rest\"\n");
    let (edited, _) = made("[signal]\ncutoff_hz = 5 # low\n", &["signal", "cutoff_hz"], 0, Value::from(40.0));
    assert_eq!(edited, "[signal]\ncutoff_hz = 40.0 # low\n");
    let term: Table = [("kind".to_owned(), Value::from("load-friction"))].into_iter().collect();
    let edited = with_table_of_array("title = \"a\"\n", "term", &term).unwrap();
    assert_eq!(edited, "title = \"a\"\n\n[[term]]\nkind = \"load-friction\"\n");
    assert_eq!(with_table_of_array("term = 1\n", "term", &term), None);
}

#[test]
fn what_cannot_be_edited_is_left_alone() {
    let of = |text: &str| Change::new(&GAIN, 0, Value::from(1.0)).made_in(text);
    assert_eq!(of("recording = 1"), None);
    assert_eq!(of("[recording]\nname = \"a\"\n"), None);
    assert_eq!(of("not toml"), None);
    assert_eq!(Change::new(&GAIN, 3, Value::from(1.0)).made_in("[[recording]]\ntorque = {}\n"), None);
}
