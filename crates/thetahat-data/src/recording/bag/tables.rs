//! All columns of a topic.

use super::super::table::{Column, Table};
use super::topic::{Field, Message, Topic, seconds};

/// A table for each set of joints in the messages, usually one for each publisher.
pub(super) fn of(topic: &Topic) -> Vec<Table> {
    let mut sets: Vec<Vec<&String>> = Vec::new();
    for joints in &topic.joints {
        let set = sorted(joints);
        if !sets.contains(&set) {
            sets.push(set);
        }
    }
    let has_several = sets.len() > 1;
    sets.iter().map(|set| table(topic, set, has_several)).collect()
}

fn sorted(joints: &[String]) -> Vec<&String> {
    let mut sorted: Vec<&String> = joints.iter().collect();
    sorted.sort();
    sorted
}

fn table(topic: &Topic, set: &[&String], is_one_of_several: bool) -> Table {
    let lists: Vec<bool> = topic.joints.iter().map(|joints| sorted(joints) == set).collect();
    let messages: Vec<&Message> = topic.messages.iter().filter(|message| lists[message.joints]).collect();
    let in_first_order = lists.iter().position(|of_set| *of_set).map_or(&[][..], |place| &topic.joints[place]);
    let prefix = match in_first_order.first() {
        Some(joint) if is_one_of_several => format!("{joint}."),
        _ => String::new(),
    };
    let mut columns = vec![
        time(topic, &messages, format!("{prefix}stamp"), |message| message.stamp_ns),
        time(topic, &messages, format!("{prefix}log_time"), |message| message.log_time_ns),
    ];
    for joint in in_first_order {
        columns.extend(Field::ALL.iter().filter_map(|field| values(topic, &messages, joint, *field)));
    }
    Table { name: topic.name.clone(), columns }
}

fn time(topic: &Topic, messages: &[&Message], name: String, of: fn(&Message) -> i64) -> Column {
    let first = topic.messages.first().map_or(0, of);
    let values = messages.iter().map(|message| seconds(of(message), first)).collect();
    Column::of_numbers(name, 1, values)
}

/// A field of a joint; NaN in messages without it, and none if no message has it.
fn values(topic: &Topic, messages: &[&Message], joint: &str, field: Field) -> Option<Column> {
    let value = |message: &&Message| {
        let place = topic.joints_of(message).iter().position(|known| known == joint)?;
        topic.value(message, place, field)
    };
    let values: Vec<Option<f64>> = messages.iter().map(value).collect();
    if values.iter().all(Option::is_none) {
        return None;
    }
    let values = values.into_iter().map(|value| value.unwrap_or(f64::NAN)).collect();
    Some(Column::of_numbers(format!("{joint}.{}", field.name()), 1, values))
}
