//! Which joints of the robot a log has; the others are proposed to be locked.

use super::{
    super::column_names::Signal,
    columns,
    error::ProposalError,
    request::{ProposalRequest, is_named},
    set_aside::parted,
    source::{SelectedColumn, Source, channels},
    units::Units,
};
use thetahat_data::recording::{ChannelSummary, ColumnSummary, Side};
use thetahat_model::robot::{Joint, JointKind, Locks, Robot, RobotSource};

/// Travel above which a joint without torques does not count as at rest, rad and m.
const MOVES: [f64; 2] = [0.1, 0.02];

/// A joint that is proposed to be locked.
#[derive(Debug, Clone, PartialEq)]
pub struct ProposedLock {
    /// Its name.
    pub joint: String,
    /// Its coordinate, rad or m.
    pub value: f64,
    /// Where the value is from.
    pub why: String,
}

/// The robot whose joints are those of the log, and the joints that are locked for that.
pub(super) struct JointsOfLog {
    pub(super) robot: Robot,
    pub(super) locks: Vec<ProposedLock>,
    /// Whether each coordinate of the description is left, where the user locked some: the log may have columns of all.
    pub(super) free: Option<Vec<bool>>,
    /// The robot of the description.
    pub(super) whole: Robot,
}

impl JointsOfLog {
    pub(super) fn find(
        request: &ProposalRequest,
        description: &RobotSource,
        sources: &[Source<'_>],
    ) -> Result<Self, ProposalError> {
        let refuse = |e: thetahat_model::robot::RobotError| ProposalError::Robot { problem: e.to_string() };
        let whole = description.robot_without_transmission().map_err(refuse)?;
        if whole.base_coordinates() > 0 {
            return Err(ProposalError::FloatingBase { robot: whole.name });
        }
        let search = Search { request, robot: &whole, sources };
        let moving = search.unlocked()?;
        let locks = moving.as_ref().map_or(Ok(Vec::new()), |moving| search.locks(moving))?;
        let free = moving.filter(|_| !request.locked.is_empty());
        let locked = locks.iter().map(|lock| (lock.joint.clone(), lock.value)).collect();
        let locked = Locks { locked, until: Vec::new() };
        let robot = match description.robot_with_locks(&locked, &request.robot_file) {
            Ok(robot) => robot,
            // Transmissions that cannot be read do not matter to a proposal; the experiment refuses them.
            Err(_) if locks.is_empty() => whole.clone(),
            Err(error) => return Err(refuse(error)),
        };
        Ok(Self { robot, locks, free, whole })
    }

    /// The columns of the joints that are left, where columns of all joints stand in their order and the user locked some;
    /// other columns as they are.
    pub(super) fn left<'a>(&self, columns: Vec<SelectedColumn<'a>>) -> Vec<SelectedColumn<'a>> {
        match &self.free {
            Some(free) if channels(&columns) == free.len() && !columns.iter().any(|c| c.in_rows) => {
                let each = columns.iter().flat_map(SelectedColumn::each);
                each.zip(free).filter(|(_, free)| **free).map(|(column, _)| column).collect()
            }
            Some(_) | None => columns,
        }
    }
}

#[derive(Clone, Copy)]
struct Search<'s, 'a> {
    request: &'s ProposalRequest,
    robot: &'s Robot,
    sources: &'s [Source<'a>],
}

/// The column of each joint in a file.
type OfJoint<'a> = Vec<Option<&'a ColumnSummary>>;

impl<'a> Search<'_, 'a> {
    /// The coordinates that move and that the user did not lock; `None` if all move.
    fn unlocked(&self) -> Result<Option<Vec<bool>>, ProposalError> {
        let moving = self.moving()?;
        if self.request.locked.is_empty() {
            return Ok(moving);
        }
        let mut moving = moving.unwrap_or_else(|| vec![true; self.robot.coordinate_count()]);
        for joint in self.request.locked.keys() {
            let place = self.joints().position(|known| known.name == *joint);
            let place = place.ok_or_else(|| ProposalError::NoSuchJoint {
                joint: joint.clone(),
                known: self.joints().map(|joint| joint.name.clone()).collect(),
            })?;
            if self.request.joints.contains(joint) {
                return Err(ProposalError::LockedAndNamed { joint: joint.clone() });
            }
            moving[place] = false;
        }
        Ok(Some(moving))
    }

    /// Whether each coordinate moves and has its torque in the log; `None` if the log has all, or the names do not show it.
    fn moving(&self) -> Result<Option<Vec<bool>>, ProposalError> {
        if !self.request.joints.is_empty() {
            return self.stated().map(Some);
        }
        let [position, torque] = [Signal::Position, Signal::Torque].map(|signal| self.by_name(signal));
        let has = |found: &[OfJoint<'a>], j: usize| !found.is_empty() && found.iter().all(|of| of[j].is_some());
        let named: Vec<bool> =
            (0..self.robot.coordinate_count()).map(|j| has(&position, j) && has(&torque, j)).collect();
        let by_number = |signal| self.sources.iter().any(|s| columns::by_name(s, self.robot, signal).is_ok());
        let all_named = named.iter().all(|named| *named);
        let all_numbered = by_number(Signal::Position) && by_number(Signal::Torque);
        if !named.contains(&true) || (!all_named && all_numbered) {
            return Ok(None);
        }
        let idle = |j: usize| {
            let constant = torque.iter().flat_map(|of| of[j]).all(|c| c.statistics.iter().all(|s| s.constant));
            constant && self.travel(j).is_some_and(|(least, most)| !self.moves(j, most - least))
        };
        let moving: Vec<bool> = named.iter().enumerate().map(|(j, named)| *named && !idle(j)).collect();
        Ok((moving.contains(&true) && moving.contains(&false)).then_some(moving))
    }

    /// The joints that the user named as those of the columns.
    fn stated(&self) -> Result<Vec<bool>, ProposalError> {
        let names: Vec<&str> = self.joints().map(|joint| joint.name.as_str()).collect();
        let place = |name: &String| names.iter().position(|known| known == name);
        let places: Option<Vec<usize>> = self.request.joints.iter().map(place).collect();
        let places = places.filter(|places| places.windows(2).all(|pair| pair[0] < pair[1]));
        let places = places.ok_or_else(|| ProposalError::Joints {
            found: self.request.joints.clone(),
            known: names.iter().map(|name| (*name).to_owned()).collect(),
        })?;
        Ok((0..names.len()).map(|j| places.contains(&j)).collect())
    }

    fn joints(&self) -> impl Iterator<Item = &Joint> {
        self.robot.coordinates()
    }

    /// The columns of a signal, joint by joint, in each file that has any with a joint's name.
    fn by_name(&self, signal: Signal) -> Vec<OfJoint<'a>> {
        let names: Vec<&str> = self.joints().map(|joint| joint.name.as_str()).collect();
        let asked = match signal {
            Signal::Position => &self.request.position,
            Signal::Torque => &self.request.torque,
            Signal::Time | Signal::Velocity | Signal::Reference => return Vec::new(),
        };
        let is_of = |source: &Source<'a>, column: &ColumnSummary| match asked.is_empty() {
            true => columns::says(source, &column.name, signal),
            false => asked.iter().any(|argument| is_named(argument, &column.name)),
        };
        let of_file = |source: &Source<'a>| {
            let columns: Vec<&ColumnSummary> = source.columns().filter(|column| is_of(source, column)).collect();
            let columns = if asked.is_empty() { parted(source, self.robot, signal, columns).0 } else { columns };
            source.columns_of(&names, &columns)
        };
        self.sources.iter().map(of_file).filter(|of| of.iter().any(Option::is_some)).collect()
    }

    /// The least and the largest recorded position of a coordinate, rad or m; `None` if it was not recorded on the joint side
    /// of the gears.
    fn travel(&self, coordinate: usize) -> Option<(f64, f64)> {
        let ends = |summary: fn(&ChannelSummary) -> Option<f64>, pick: fn(f64, f64) -> f64| {
            let of_files = self.by_name(Signal::Position);
            let values = of_files.iter().filter_map(|of| of[coordinate]).flat_map(|c| &c.statistics);
            values.filter_map(summary).reduce(pick)
        };
        let factor = self.factor(coordinate)?;
        Some((factor * ends(|s| s.min, f64::min)?, factor * ends(|s| s.max, f64::max)?))
    }

    /// Factor from the file's unit to rad or m; `None` for positions of motors.
    fn factor(&self, coordinate: usize) -> Option<f64> {
        let kind = self.joints().nth(coordinate)?.kind;
        let of_kind: Vec<usize> =
            self.joints().enumerate().filter(|(_, joint)| joint.kind == kind).map(|(j, _)| j).collect();
        let (source, columns): (Source<'a>, Vec<(usize, SelectedColumn<'a>)>) =
            self.sources.iter().find_map(|source| {
                let one = Search { sources: std::slice::from_ref(source), ..*self }.by_name(Signal::Position);
                let of_file = one.into_iter().next()?;
                of_file[coordinate]?;
                let column = |&j: &usize| Some((j, SelectedColumn::of(of_file[j]?)));
                Some((*source, of_kind.iter().filter_map(column).collect()))
            })?;
        let (places, columns): (Vec<usize>, Vec<SelectedColumn<'a>>) = columns.into_iter().unzip();
        let joints = places.iter().filter_map(|&j| self.joints().nth(j)).collect();
        let measured = Units { request: self.request, robot: self.robot, source, joints }.of_position(&columns).ok()?;
        let channel = places.iter().position(|place| *place == coordinate)?;
        match (measured.side, &measured.gain) {
            (Side::Joint, None) => Some(measured.to_si(channel)),
            (Side::Motor, _) | (Side::Joint, Some(_)) => None,
        }
    }

    fn moves(&self, coordinate: usize, travel: f64) -> bool {
        let [angle, length] = MOVES;
        self.joints().nth(coordinate).is_some_and(|joint| match joint.kind {
            JointKind::Revolute => travel > angle,
            JointKind::Prismatic => travel > length,
        })
    }

    /// The locks of the coordinates that do not move.
    fn locks(&self, moving: &[bool]) -> Result<Vec<ProposedLock>, ProposalError> {
        let still = self.joints().enumerate().filter(|(j, _)| !moving[*j]);
        still.map(|(j, joint)| self.lock(j, joint)).collect()
    }

    fn lock(&self, coordinate: usize, joint: &Joint) -> Result<ProposedLock, ProposalError> {
        let name = joint.name.clone();
        if let Some(&value) = self.request.locked.get(&name) {
            return Ok(ProposedLock { joint: name, value, why: "as stated".to_owned() });
        }
        let Some((least, most)) = self.travel(coordinate) else {
            let value = joint.limits.neutral();
            let from = if value == 0.0 { "0" } else { "the middle of its limits, as 0 is outside of them" };
            let is_recorded = self.by_name(Signal::Position).iter().any(|of| of[coordinate].is_some());
            let place =
                if is_recorded { "in the log, but not as the joint's angle or length" } else { "not in the log" };
            let why = format!("{place}, so a guess: {from}");
            return Ok(ProposedLock { joint: name, value, why });
        };
        if self.moves(coordinate, most - least) {
            let unit = match joint.kind {
                JointKind::Revolute => "rad",
                JointKind::Prismatic => "m",
            };
            return Err(ProposalError::MovesWithoutTorque { joint: name, least, most, unit });
        }
        let mean = rounded(0.5 * (least + most));
        let why = format!("in the log from {least:.4} to {most:.4}, without a torque that changes");
        Ok(ProposedLock { joint: name, value: mean, why })
    }
}

/// With six decimals: a micrometre, or a microradian.
pub(super) fn rounded(value: f64) -> f64 {
    (1e6 * value).round() / 1e6
}
