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

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::super::{ProposalRequest, propose, propose_for_motion};
    use thetahat_data::recording::inspect;
    use thetahat_model::robot::RobotSource;

    const ARM: &str = "name = 'arm'\n[[joint]]\nname = 'a'\nkind = 'revolute'\n[[joint]]\nname = 'b'\nkind = 'revolute'\n\
                       [[joint]]\nname = 'c'\nkind = 'revolute'\n";

    /// The locks of a log whose joints travel so far around 0.3 rad, as they are proposed, and without those that stand.
    fn locks(travel: [f64; 3]) -> [Vec<(String, f64)>; 2] {
        let row = |k: usize| {
            let q = travel.map(|travel| 0.3 + 0.5 * travel * (0.1 * k as f64).sin());
            let tau = travel.map(|travel| 1.0 + 5.0 * travel * (0.1 * k as f64).cos());
            let values = [k as f64 * 1e-3].into_iter().chain(q).chain(tau).map(|v| v.to_string());
            values.collect::<Vec<_>>().join(",") + "\n"
        };
        let folder = thetahat_testing::Folder::new();
        let rows: String = (0..300).map(row).collect();
        folder.write("log.csv", format!("t,q1,q2,q3,tau1,tau2,tau3\n{rows}"));
        let contents = [inspect(&folder.at("log.csv")).unwrap()];
        let robot = RobotSource::from_text(ARM.to_owned(), Path::new("arm.toml")).unwrap();
        let request = ProposalRequest {
            robot_file: "arm.toml".into(),
            recording_files: vec!["log.csv".into()],
            ..ProposalRequest::default()
        };
        [propose_for_motion, propose].map(|of| {
            let proposal = of(&request, &robot, &contents).unwrap();
            proposal.locks.into_iter().map(|lock| (lock.joint, lock.value)).collect()
        })
    }

    #[test]
    fn joints_that_stand_are_locked_where_they_stand() {
        assert_eq!(locks([1.0, 0.001, 0.8]), [vec![("b".to_owned(), 0.3)], Vec::new()]);
    }

    #[test]
    fn joints_that_move_are_not() {
        assert_eq!(locks([1.0, 0.01, 0.8]), [Vec::new(), Vec::new()]);
    }

    #[test]
    fn a_robot_that_stands_has_no_motion_to_propose_for() {
        assert_eq!(locks([0.0, 0.0, 0.0]), [Vec::new(), Vec::new()]);
    }
}
