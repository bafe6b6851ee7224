use super::{
    moves::{MoveFamily, Point},
    quadratic::Row,
    sums::{Derivatives, Sampled, Slopes, Sums},
};
use thetahat_estimation::trajectory::Moves;
use thetahat_ground::series::Series;

/// The motions among which one is chosen, as functions of unknowns, at the instants where they are looked at.
#[derive(Debug, Clone)]
pub(super) enum Motions {
    /// Sums of functions of time, at fixed instants: linear in the unknowns.
    Sums { family: Sums, sampled: Sampled },
    /// Point-to-point moves, at points that move with their phases.
    Moves { family: MoveFamily, points: Vec<Point> },
}

impl Motions {
    /// Whether motions are linear in the unknowns.
    pub(super) fn is_linear(&self) -> bool {
        match self {
            Self::Sums { .. } => true,
            Self::Moves { .. } => false,
        }
    }

    /// The motion where it is looked at.
    pub(super) fn at(&self, x: &[f64]) -> Derivatives {
        match self {
            Self::Sums { family, sampled } => family.motion(sampled, x),
            Self::Moves { family, points } => family.motion(points, x),
        }
    }

    /// The motion at times in s.
    pub(super) fn on(&self, x: &[f64], time_s: &[f64]) -> Derivatives {
        match self {
            Self::Sums { family, .. } => family.motion(&family.sampled(time_s), x),
            Self::Moves { family, .. } => on(family.moves(x).as_ref(), family.joints(), time_s),
        }
    }

    /// The moves, where it is a motion of such.
    pub(super) fn moves(&self, x: &[f64]) -> Option<Moves> {
        match self {
            Self::Sums { .. } => None,
            Self::Moves { family, .. } => family.moves(x),
        }
    }

    /// The family of moves, where it is such.
    pub(super) fn move_family(&self) -> Option<&MoveFamily> {
        match self {
            Self::Sums { .. } => None,
            Self::Moves { family, .. } => Some(family),
        }
    }

    /// The time that each instant stands for, s.
    pub(super) fn seconds(&self, x: &[f64]) -> Vec<f64> {
        match self {
            Self::Sums { family, sampled } => {
                let count = sampled.orders[0].rows();
                vec![family.duration_s() / count as f64; count]
            }
            Self::Moves { family, points } => family.seconds(points, x),
        }
    }

    /// The derivative by the unknowns of a function with these derivatives.
    pub(super) fn chain(&self, x: &[f64], slopes: &Slopes) -> Vec<f64> {
        match self {
            Self::Sums { family, sampled } => family.chain(sampled, 0, &slopes.by_motion),
            Self::Moves { family, points } => family.chain(points, x, slopes),
        }
    }

    /// The same of a function of one instant.
    pub(super) fn chain_at(&self, x: &[f64], instant: usize, by_motion: [Series; 3]) -> Vec<f64> {
        match self {
            Self::Sums { family, sampled } => family.chain(sampled, instant, &by_motion),
            Self::Moves { family, points } => {
                family.chain(&points[instant..=instant], x, &Slopes { by_motion, by_seconds: Vec::new() })
            }
        }
    }

    /// First unknown and derivatives, by it and those behind it, of one derivative of one joint's position at one instant.
    pub(super) fn signal(&self, x: &[f64], instant: usize, joint: usize, order: usize) -> (usize, Vec<f64>) {
        match self {
            Self::Sums { family, sampled } => {
                let size = family.unknowns_of_joint();
                let value = |m| sampled.orders[order].at(instant, m) * family.unit(joint, m);
                (joint * size, (0..size).map(value).collect())
            }
            Self::Moves { family, points } => (0, family.signal(&points[instant], x, joint, order)),
        }
    }

    /// What holds of the unknowns alone, as rows of a step.
    pub(super) fn rows(&self, x: &[f64]) -> Vec<Row> {
        match self {
            Self::Sums { .. } => Vec::new(),
            Self::Moves { family, .. } => family.rows(x),
        }
    }
}

/// Moves at times in s, at rest where there are none.
fn on(moves: Option<&Moves>, joints: usize, time_s: &[f64]) -> Derivatives {
    let mut motion = [(); 4].map(|()| Series::zeros(time_s.len(), joints));
    let [q, dq, ddq, dddq] = &mut motion;
    for (k, &t) in time_s.iter().enumerate() {
        if let Some(moves) = moves {
            moves.evaluate(t, q.sample_mut(k), dq.sample_mut(k), ddq.sample_mut(k));
            moves.jerk(t, dddq.sample_mut(k));
        }
    }
    motion
}
