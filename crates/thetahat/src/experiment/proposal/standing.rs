//! Joints that stand in all recordings: the proposal locks them where they stand.

use std::collections::BTreeMap;

use super::{
    grouping::Group, joints::JointsOfLog, offer::Offer, request::ProposalRequest, source::SelectedColumn, units::Units,
};
use thetahat_data::recording::{ChannelSummary, Side};
use thetahat_model::robot::{Joint, JointKind};

/// Travel up to which a joint stands, rad and m: the noise of an encoder, and what a brake or a controller lets through.
const STANDS: [f64; 2] = [2e-3, 1e-3];

/// Least and largest position, rad or m.
type Span = [f64; 2];

/// The joints that stand, with where; none if all move, none does, or positions are not those of the joints.
pub(super) fn standing(
    request: &ProposalRequest,
    joints: &JointsOfLog,
    offers: &[Offer<'_>],
    groups: &[Group],
) -> BTreeMap<String, Span> {
    let coordinates: Vec<&Joint> = joints.robot.coordinates().collect();
    let of_group = |group: &Group| spans(request, joints, &offers[group.position]);
    let spans = groups.iter().map(of_group);
    let Some(spans) = spans.collect::<Option<Vec<_>>>().filter(|spans| !spans.is_empty()) else {
        return BTreeMap::new();
    };
    let whole = |j: usize| spans.iter().map(|of| of[j]).reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]);
    let of_joint = |(j, joint): (usize, &&Joint)| {
        let [least, most] = whole(j)?;
        (most - least <= travel(joint.kind)).then(|| (joint.name.clone(), [least, most]))
    };
    let found: BTreeMap<String, Span> = coordinates.iter().enumerate().filter_map(of_joint).collect();
    if found.len() == coordinates.len() { BTreeMap::new() } else { found }
}

fn travel(kind: JointKind) -> f64 {
    let [angle, length] = STANDS;
    match kind {
        JointKind::Revolute => angle,
        JointKind::Prismatic => length,
    }
}

/// The spans of a recording's positions, joint by joint; none if they are those of motors, or their unit is not clear.
fn spans(request: &ProposalRequest, joints: &JointsOfLog, offer: &Offer<'_>) -> Option<Vec<Span>> {
    let columns = offer.position.as_deref().ok()?;
    let robot = &joints.robot;
    let units = Units { request, robot, source: offer.source, joints: robot.coordinates().collect() };
    let measured = units.of_position(columns).ok()?;
    if measured.side == Side::Motor || measured.gain.is_some() {
        return None;
    }
    let channels: Vec<&ChannelSummary> = columns.iter().flat_map(|c: &SelectedColumn<'_>| c.channels).collect();
    let span = |(j, channel): (usize, &&ChannelSummary)| {
        let ends = [channel.min?, channel.max?].map(|end| measured.to_si(j) * end);
        Some([ends[0].min(ends[1]), ends[0].max(ends[1])])
    };
    let spans: Option<Vec<Span>> = channels.iter().enumerate().map(span).collect();
    spans.filter(|spans| spans.len() == robot.coordinate_count())
}
