//! Orders and cycles of trees that are given by the parent of each node, without recursion.

use super::joint::{FollowedSum, LARGEST, Mimic, Share};

/// Parents before children, depth first, children of one parent in the order given.
///
/// # Errors
/// The nodes of a cycle, from parent's child to child's parent, if there is one.
pub(super) fn depth_first(parents: &[Option<usize>]) -> Result<Vec<usize>, Vec<usize>> {
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); parents.len()];
    let mut waiting = Vec::new();
    for (node, parent) in parents.iter().enumerate().rev() {
        match parent {
            Some(parent) => children[*parent].push(node),
            None => waiting.push(node),
        }
    }
    let mut order = Vec::with_capacity(parents.len());
    while let Some(node) = waiting.pop() {
        order.push(node);
        waiting.append(&mut children[node]);
    }
    if order.len() == parents.len() { Ok(order) } else { Err(cycle(parents, &order)) }
}

fn cycle(parents: &[Option<usize>], reached: &[usize]) -> Vec<usize> {
    let mut place = vec![None; parents.len()];
    reached.iter().for_each(|&node| place[node] = Some(0));
    let mut next = place.iter().position(Option::is_none);
    let mut path = Vec::new();
    while let Some(node) = next {
        if let Some(first) = place[node] {
            return path.split_off(first);
        }
        place[node] = Some(path.len());
        path.push(node);
        next = parents[node];
    }
    path
}

/// Makes joints that follow a follower follow its leader.
///
/// # Errors
/// The index of a joint that ultimately follows itself, or follows by a number beyond [`LARGEST`].
pub(super) fn resolve_mimics(mimics: &[Option<Mimic>]) -> Result<Vec<Option<Mimic>>, usize> {
    (0..mimics.len()).map(|joint| resolved(mimics, joint)).collect()
}

fn resolved(mimics: &[Option<Mimic>], joint: usize) -> Result<Option<Mimic>, usize> {
    let Some(mut found) = mimics[joint] else { return Ok(None) };
    for _ in 0..mimics.len() {
        if !(found.ratio.abs() <= LARGEST && found.offset.abs() <= LARGEST) {
            return Err(joint);
        }
        let Some(next) = mimics[found.of] else { return Ok(Some(found)) };
        let offset = found.ratio * next.offset + found.offset;
        found = Mimic { of: next.of, ratio: found.ratio * next.ratio, offset };
    }
    Err(joint)
}

/// The same of joints that follow sums: joints that follow a follower follow its leaders.
///
/// # Errors
/// The index of a joint that ultimately follows itself, or follows by a number beyond [`LARGEST`].
pub(super) fn resolve_sums(sums: &[Option<FollowedSum>]) -> Result<Vec<Option<FollowedSum>>, usize> {
    let mut resolved: Vec<Option<Option<FollowedSum>>> =
        sums.iter().map(|sum| if sum.is_none() { Some(None) } else { None }).collect();
    loop {
        let ready = |sum: &FollowedSum| sum.shares.iter().all(|share| resolved[share.of].is_some());
        let next = (0..sums.len()).find(|&j| resolved[j].is_none() && sums[j].as_ref().is_some_and(ready));
        let Some(joint) = next else { break };
        let Some(sum) = &sums[joint] else { break };
        resolved[joint] = Some(Some(substituted(sum, &resolved).ok_or(joint)?));
    }
    resolved.into_iter().enumerate().map(|(joint, sum)| sum.ok_or(joint)).collect()
}

/// A sum with the leaders of its joints in their place, each once; `None` if a number is beyond [`LARGEST`].
fn substituted(sum: &FollowedSum, resolved: &[Option<Option<FollowedSum>>]) -> Option<FollowedSum> {
    let mut found = FollowedSum { shares: Vec::new(), offset: sum.offset };
    for share in &sum.shares {
        match resolved[share.of].as_ref().and_then(Option::as_ref) {
            None => add(&mut found.shares, *share),
            Some(leader) => {
                found.offset += share.ratio * leader.offset;
                let scaled = |of: &Share| Share { of: of.of, ratio: share.ratio * of.ratio };
                leader.shares.iter().for_each(|of| add(&mut found.shares, scaled(of)));
            }
        }
    }
    without_zeros(&mut found.shares);
    let numbers = found.shares.iter().map(|share| share.ratio).chain([found.offset]);
    numbers.into_iter().all(|number| number.abs() <= LARGEST).then_some(found)
}

/// Leaves out the shares that cancel, but for one.
fn without_zeros(shares: &mut Vec<Share>) {
    let first = shares.first().copied();
    shares.retain(|share| share.ratio != 0.0);
    if shares.is_empty() {
        shares.extend(first);
    }
}

fn add(shares: &mut Vec<Share>, share: Share) {
    match shares.iter_mut().find(|known| known.of == share.of) {
        Some(known) => known.ratio += share.ratio,
        None => shares.push(share),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn children_come_after_their_parents_in_the_order_given() {
        let parents = [Some(3), None, Some(1), Some(1), Some(3), None];
        assert_eq!(depth_first(&parents), Ok(vec![1, 2, 3, 0, 4, 5]));
    }

    #[test]
    fn a_cycle_is_found_from_a_branch_that_leads_to_it() {
        let parents = [Some(1), Some(2), Some(3), Some(1), None];
        assert_eq!(depth_first(&parents), Err(vec![1, 2, 3]));
    }

    #[test]
    fn followers_of_sums_follow_the_joints_of_the_sum() {
        let sum = |shares: &[(usize, f64)], offset| {
            let shares = shares.iter().map(|&(of, ratio)| Share { of, ratio }).collect();
            Some(FollowedSum { shares, offset })
        };
        let given = [None, sum(&[(3, 2.0), (0, 1.0)], 0.5), None, sum(&[(0, -1.0), (2, 3.0)], 0.1)];
        let expected = [None, sum(&[(0, -1.0), (2, 6.0)], 0.7), None, given[3].clone()];
        assert_eq!(resolve_sums(&given).unwrap(), expected);
        // A tool that an arm and a forearm level: the shares of the arm cancel.
        let level = [None, None, sum(&[(1, 1.0), (0, -1.0)], 0.0), sum(&[(2, -1.0), (0, -1.0)], 0.0)];
        assert_eq!(resolve_sums(&level).unwrap()[3], sum(&[(1, -1.0)], 0.0));
        assert_eq!(resolve_sums(&[None, sum(&[(0, 0.0)], 0.2)]).unwrap()[1], sum(&[(0, 0.0)], 0.2));
        assert_eq!(resolve_sums(&[None, sum(&[(0, 1.0), (2, 1.0)], 0.0), sum(&[(1, 1.0)], 0.0)]), Err(1));
        assert_eq!(resolve_sums(&[None, sum(&[(0, 1e9)], 0.0), sum(&[(1, 2.0)], 0.0)]), Err(2));
    }

    #[test]
    fn followers_of_followers_follow_the_leader() {
        let mimic = |of, ratio, offset| Some(Mimic { of, ratio, offset });
        let resolved = resolve_mimics(&[None, mimic(0, 2.0, 0.5), mimic(1, -3.0, 1.0)]).unwrap();
        assert_eq!(resolved, [None, mimic(0, 2.0, 0.5), mimic(0, -6.0, -0.5)]);
        assert_eq!(resolve_mimics(&[mimic(1, 1.0, 0.0), mimic(0, 1.0, 0.0)]), Err(0));
    }
}
