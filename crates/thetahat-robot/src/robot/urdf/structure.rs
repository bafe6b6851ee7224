use std::collections::{HashMap, HashSet};

use super::{
    UrdfError,
    element::{Element, shortened},
    joints::JointElement,
};
use crate::robot::tree;

/// Largest number of edits between two names that counts as a typing error.
const SLIP: usize = 2;

/// The two links of a joint, by their indices.
#[derive(Clone, Copy)]
pub(super) struct LinkPair {
    pub(super) parent: usize,
    pub(super) child: usize,
}

/// The links and joints of a file as a tree.
pub(super) struct Structure<'a> {
    pub(super) links: Vec<Element<'a>>,
    pub(super) joints: Vec<JointElement<'a>>,
    /// Parent and child link of each joint.
    pub(super) ends: Vec<LinkPair>,
    /// The joints, those nearer to the base first, depth first in the order of the file.
    pub(super) order: Vec<usize>,
    /// The link without a parent; the number of links if it is the implied base.
    pub(super) root: usize,
    /// The base that the file names as a parent without having it as a link.
    pub(super) implied: Option<ImpliedBase<'a>>,
}

/// A base, such as `world`, that joints name as their parent while the file has no such link.
#[derive(Clone, Copy)]
pub(super) struct ImpliedBase<'a> {
    pub(super) name: &'a str,
    /// The first `<parent>` that names it.
    pub(super) element: Element<'a>,
}

impl<'a> Structure<'a> {
    pub(super) fn read(robot: Element<'a>) -> Result<Self, UrdfError> {
        let links: Vec<Element<'a>> = robot.elements().filter(|e| e.tag() == "link").collect();
        let elements: Vec<Element<'a>> = robot.elements().filter(|e| e.tag() == "joint").collect();
        let mut link_names = names(&links)?;
        names(&elements)?;
        let joints = elements.into_iter().map(JointElement::read).collect::<Result<Vec<_>, _>>()?;
        let implied = implied_base(&links, &joints, &link_names)?;
        link_names.extend(implied.map(|base| (base.name, links.len())));
        let link = |joint: &JointElement<'a>, tag: &str, name: &str| match link_names.get(name) {
            Some(&index) => Ok(index),
            None => Err(unknown(joint.element.child(tag).unwrap_or(joint.element), "link", name, link_names.keys())),
        };
        let ends = joints
            .iter()
            .map(|j| Ok(LinkPair { parent: link(j, "parent", j.parent)?, child: link(j, "child", j.child)? }));
        let ends = ends.collect::<Result<Vec<_>, UrdfError>>()?;
        if joints.iter().all(|joint| joint.moving.is_none()) {
            return Err(UrdfError::NoMovingJoint { path: robot.path().to_owned() });
        }
        let parent_joint = parent_joints(link_names.len(), &joints, &ends)?;
        let parents: Vec<Option<usize>> = ends.iter().map(|pair| parent_joint[pair.parent]).collect();
        let order = tree::depth_first(&parents).map_err(|found| cycle(&joints, &found))?;
        let root = match implied {
            Some(_) => links.len(),
            None => only_root(&links, &parent_joint)?.unwrap_or(0),
        };
        Ok(Self { links, joints, ends, order, root, implied })
    }

    /// Number of links, the implied base included.
    pub(super) fn link_count(&self) -> usize {
        self.links.len() + usize::from(self.implied.is_some())
    }
}

/// The one missing link that can be the base: a parent that no joint has as its child, while every link of the file is the
/// child of a joint. Any other missing link is reported where it is looked up.
fn implied_base<'a>(
    links: &[Element<'a>],
    joints: &[JointElement<'a>],
    known: &HashMap<&str, usize>,
) -> Result<Option<ImpliedBase<'a>>, UrdfError> {
    let children: HashSet<&str> = joints.iter().map(|joint| joint.child).collect();
    let is_child = |link: &Element<'_>| link.attribute("name").is_some_and(|name| children.contains(name));
    if !links.iter().all(is_child) {
        return Ok(None);
    }
    let mut missing: Vec<ImpliedBase<'a>> = Vec::new();
    for joint in joints {
        let is_new = missing.iter().all(|base| base.name != joint.parent);
        if is_new && !known.contains_key(joint.parent) && !children.contains(joint.parent) {
            let element = joint.element.child("parent").unwrap_or(joint.element);
            missing.push(ImpliedBase { name: joint.parent, element });
        }
    }
    match missing[..] {
        [] => Ok(None),
        [only] => Ok(Some(only)),
        [first, ..] => Err(UrdfError::MissingBases { place: first.element.place(), names: listed(&missing) }),
    }
}

/// Names with their lines; a file may miss thousands.
fn listed(missing: &[ImpliedBase<'_>]) -> Vec<String> {
    const MOST_NAMED: usize = 10;
    let name = |base: &ImpliedBase<'_>| format!("{} (line {})", shortened(base.name), base.element.line());
    missing.iter().take(MOST_NAMED).map(name).collect()
}

/// The index of each name, which must be unique.
fn names<'a>(elements: &[Element<'a>]) -> Result<HashMap<&'a str, usize>, UrdfError> {
    let mut names = HashMap::new();
    for (index, element) in elements.iter().enumerate() {
        let name = element.required("name", "every link and joint has one")?;
        if let Some(first) = names.insert(name, index) {
            return Err(UrdfError::DuplicateName { place: element.place(), first_line: elements[first].line() });
        }
    }
    Ok(names)
}

/// The parent joint of each link.
fn parent_joints(
    links: usize,
    joints: &[JointElement<'_>],
    ends: &[LinkPair],
) -> Result<Vec<Option<usize>>, UrdfError> {
    let mut parent_joint: Vec<Option<usize>> = vec![None; links];
    for (joint, &LinkPair { child, .. }) in ends.iter().enumerate() {
        if let Some(other) = parent_joint[child].replace(joint) {
            let name = joints[other].name.to_owned();
            return Err(UrdfError::TwoParents {
                place: joints[joint].element.place(),
                link: joints[joint].child.to_owned(),
                other: name,
            });
        }
    }
    Ok(parent_joint)
}

fn only_root(links: &[Element<'_>], parent_joint: &[Option<usize>]) -> Result<Option<usize>, UrdfError> {
    let mut roots = (0..links.len()).filter(|&link| parent_joint[link].is_none());
    let first = roots.next();
    match (first, roots.next()) {
        (Some(first), Some(second)) => Err(UrdfError::TwoRoots {
            place: links[second].place(),
            first: links[first].attribute("name").unwrap_or_default().to_owned(),
            first_line: links[first].line(),
        }),
        _ => Ok(first),
    }
}

/// The error of a cycle, which is found from child to parent and reported from parent to child.
fn cycle(joints: &[JointElement<'_>], cycle: &[usize]) -> UrdfError {
    let first = cycle.first().copied().unwrap_or(0);
    let downward = cycle.first().into_iter().chain(cycle.iter().rev());
    let name = |&joint: &usize| joints[joint].name.to_owned();
    UrdfError::Cycle { place: joints[first].element.place(), joints: downward.map(name).collect() }
}

/// The error of a name that is not among the `known` ones.
pub(super) fn unknown<'n>(
    element: Element<'_>,
    kind: &'static str,
    name: &str,
    known: impl Iterator<Item = &'n &'n str>,
) -> UrdfError {
    let mut near: Vec<&str> = known.copied().filter(|other| edits(name, other) <= SLIP).collect();
    near.sort_unstable();
    let similar = near.first().map(|s| (*s).to_owned());
    UrdfError::UnknownName { place: element.place(), kind, name: shortened(name), similar }
}

/// Number of letters to change, insert or remove between two names; long names count as far apart.
fn edits(a: &str, b: &str) -> usize {
    const LONGEST: usize = 200;
    if a.len() > LONGEST || b.len() > LONGEST || a.len().abs_diff(b.len()) > SLIP {
        return LONGEST;
    }
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.bytes().enumerate() {
        let mut diagonal = std::mem::replace(&mut row[0], i + 1);
        for (j, y) in b.bytes().enumerate() {
            let changed = diagonal + usize::from(x != y);
            diagonal = row[j + 1];
            row[j + 1] = changed.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}
