//! All columns of a topic.

use std::collections::{HashMap, HashSet};

use super::super::table::{Column, Table};
use super::layouts::{example, groups};
use super::topic::{Layout, Message, Topic, seconds};

/// A table for each set of joints in the messages, usually one for each publisher.
pub(super) fn of(topic: &Topic) -> Vec<Table> {
    let groups = groups(topic);
    groups.iter().map(|group| table(topic, group, &groups)).collect()
}

fn table(topic: &Topic, group: &[usize], groups: &[Vec<usize>]) -> Table {
    let messages: Vec<&Message> = topic.messages.iter().filter(|message| group.contains(&message.layout)).collect();
    let prefix = match example(topic, group, groups) {
        Some(joint) if groups.len() > 1 => format!("{joint}."),
        _ => String::new(),
    };
    let mut columns = Vec::new();
    if topic.has_stamp() {
        columns.push(time(topic, &messages, format!("{prefix}stamp"), |message| message.stamp_ns));
    }
    columns.push(time(topic, &messages, format!("{prefix}log_time"), |message| message.log_time_ns));
    let places: Vec<HashMap<&str, usize>> = topic.layouts.iter().map(Layout::places).collect();
    columns.extend(names(topic, group).into_iter().filter_map(|name| values(topic, &messages, &places, name)));
    Table { name: topic.name.clone(), columns }
}

/// The signals of some layouts; joint by joint, as the first layout names them.
fn names<'a>(topic: &'a Topic, group: &[usize]) -> Vec<&'a str> {
    let (mut names, mut known): (Vec<&str>, _) = (Vec::new(), HashSet::new());
    for &place in group {
        let layout = &topic.layouts[place];
        let places: HashMap<&str, usize> = layout.joints().into_iter().zip(1..).collect();
        let mut columns: Vec<_> = layout.columns.iter().collect();
        columns.sort_by_key(|column| column.joint.as_deref().map_or(0, |joint| places[joint]));
        names.extend(columns.iter().map(|column| column.name.as_str()).filter(|name| known.insert(*name)));
    }
    names
}

fn time(topic: &Topic, messages: &[&Message], name: String, of: fn(&Message) -> i64) -> Column {
    let first = topic.messages.first().map_or(0, of);
    let values = messages.iter().map(|message| seconds(of(message), first)).collect();
    Column::of_numbers(name, 1, values)
}

/// A signal; NaN in messages without it, and none if most messages lack it.
fn values(topic: &Topic, messages: &[&Message], places: &[HashMap<&str, usize>], name: &str) -> Option<Column> {
    let places: Vec<Option<usize>> = places.iter().map(|of_layout| of_layout.get(name).copied()).collect();
    let with = messages.iter().filter(|message| places[message.layout].is_some()).count();
    if 2 * with < messages.len() {
        return None;
    }
    let value = |message: &&Message| topic.value(message, places[message.layout]?);
    let values = messages.iter().map(|message| value(message).unwrap_or(f64::NAN)).collect();
    Some(Column::of_numbers(name.to_owned(), 1, values))
}
