//! Which layouts of a topic are read: several publishers may share it.

use std::collections::HashMap;

use super::topic::{Layout, Topic};

/// Messages with more signals are those to read if there is one of them for this many messages with fewer.
const RATIO: usize = 10;

/// For each layout of a topic, whether its messages are read.
///
/// Messages that lack signals of joints that other messages have, and have none that those lack, are of a second publisher that says less,
/// and are left out, so that all signals of a recording come from the same messages. Arrays without names may be longer or shorter.
pub(super) fn is_read(topic: &Topic) -> Vec<bool> {
    let mut counts = vec![0_usize; topic.layouts.len()];
    topic.messages.iter().for_each(|message| counts[message.layout] += 1);
    let sets: Vec<Vec<&str>> = topic.layouts.iter().map(signals).collect();
    let mut of_sets: HashMap<&[&str], usize> = HashMap::new();
    sets.iter().zip(&counts).for_each(|(set, count)| *of_sets.entry(set.as_slice()).or_default() += count);
    let is_left_out = |set: &[&str]| {
        let own = of_sets.get(set).copied().unwrap_or(0);
        let mut wider = of_sets.iter().filter(|(other, _)| other.len() > set.len() && holds(other, set));
        wider.any(|(_, &count)| count > 0 && RATIO * count >= own)
    };
    sets.iter().zip(&counts).map(|(set, &count)| count > 0 && !is_left_out(set)).collect()
}

/// The sorted names of the signals of joints.
fn signals(layout: &Layout) -> Vec<&str> {
    let of_joints = layout.columns.iter().filter(|column| column.joint.is_some());
    let mut names: Vec<&str> = of_joints.map(|column| column.name.as_str()).collect();
    names.sort_unstable();
    names
}

/// Whether one sorted list holds another.
fn holds(list: &[&str], other: &[&str]) -> bool {
    let mut rest = list.iter();
    other.iter().all(|name| rest.any(|known| known == name))
}

/// The layouts that are read, by the joints that they name.
pub(super) fn groups(topic: &Topic) -> Vec<Vec<usize>> {
    let mut groups: Vec<(Vec<&str>, Vec<usize>)> = Vec::new();
    for (place, _) in is_read(topic).into_iter().enumerate().filter(|(_, is_read)| *is_read) {
        let mut joints = topic.layouts[place].joints();
        joints.sort_unstable();
        match groups.iter_mut().find(|(of, _)| *of == joints) {
            Some((_, places)) => places.push(place),
            None => groups.push((joints, vec![place])),
        }
    }
    groups.into_iter().map(|(_, places)| places).collect()
}

/// A joint by which the times of a group are asked for: one that no other group names, if there is any.
pub(super) fn example<'a>(topic: &'a Topic, group: &[usize], groups: &[Vec<usize>]) -> Option<&'a str> {
    let joints = topic.layouts[*group.first()?].joints();
    let is_elsewhere = |joint: &str| {
        let others = groups.iter().filter(|other| other.as_slice() != group).flatten();
        others.into_iter().any(|&place| topic.layouts[place].joints().contains(&joint))
    };
    joints.iter().find(|joint| !is_elsewhere(joint)).or(joints.first()).copied()
}
