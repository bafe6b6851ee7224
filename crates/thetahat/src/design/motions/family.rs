use crate::design::motions::{
    moves::{MoveFamily, Point},
    sums::{Derivatives, Sampled, Slopes, Sums},
};
use thetahat_estimation::trajectory::Moves;
use thetahat_ground::{quadratic_program::Row, series::Series};

/// The motions to choose from, as functions of unknowns, at the instants where they are evaluated.
#[derive(Debug, Clone)]
pub(in crate::design) enum Motions {
    /// Sums of functions of time, at fixed instants: linear in the unknowns.
    Sums { family: Sums, sampled: Sampled },
    /// Point-to-point moves, at points that move with their phases.
    Moves { family: MoveFamily, points: Vec<Point> },
}

/// A motion of a family, by its unknowns.
#[derive(Clone, Copy)]
pub(in crate::design) struct MotionPoint<'a> {
    pub(in crate::design) motions: &'a Motions,
    pub(in crate::design) x: &'a [f64],
    /// The motion at the instants of the family.
    pub(in crate::design) motion: &'a Derivatives,
}

impl Motions {
    /// Whether motions are linear in the unknowns.
    pub(in crate::design) fn is_linear(&self) -> bool {
        match self {
            Self::Sums { .. } => true,
            Self::Moves { .. } => false,
        }
    }

    /// The motion at these instants.
    pub(in crate::design) fn at(&self, x: &[f64]) -> Derivatives {
        match self {
            Self::Sums { family, sampled } => family.motion(sampled, x),
            Self::Moves { family, points } => family.motion(points, x),
        }
    }

    /// The motion at times in s.
    pub(in crate::design) fn on(&self, x: &[f64], time_s: &[f64]) -> Derivatives {
        match self {
            Self::Sums { family, .. } => family.motion(&family.sampled(time_s), x),
            Self::Moves { family, .. } => on(family.moves(x).as_ref(), family.joints(), time_s),
        }
    }

    /// The moves, if the motion consists of moves.
    pub(in crate::design) fn moves(&self, x: &[f64]) -> Option<Moves> {
        match self {
            Self::Sums { .. } => None,
            Self::Moves { family, .. } => family.moves(x),
        }
    }

    /// The family of moves, if the motion consists of moves.
    pub(in crate::design) fn move_family(&self) -> Option<&MoveFamily> {
        match self {
            Self::Sums { .. } => None,
            Self::Moves { family, .. } => Some(family),
        }
    }

    /// The time that each instant stands for, s.
    pub(in crate::design) fn seconds(&self, x: &[f64]) -> Vec<f64> {
        match self {
            Self::Sums { family, sampled } => {
                let count = sampled.orders[0].rows();
                vec![family.duration_s() / count as f64; count]
            }
            Self::Moves { family, points } => family.seconds(points, x),
        }
    }

    /// The derivative by the unknowns of a function with these derivatives.
    pub(in crate::design) fn chain(&self, x: &[f64], slopes: &Slopes) -> Vec<f64> {
        match self {
            Self::Sums { family, sampled } => family.chain(sampled, 0, &slopes.by_motion),
            Self::Moves { family, points } => family.chain(points, x, slopes),
        }
    }

    /// The same of a function of one instant.
    pub(in crate::design) fn chain_at(&self, x: &[f64], instant: usize, by_motion: [Series; 3]) -> Vec<f64> {
        match self {
            Self::Sums { family, sampled } => family.chain(sampled, instant, &by_motion),
            Self::Moves { family, points } => {
                family.chain(&points[instant..=instant], x, &Slopes { by_motion, by_seconds: Vec::new() })
            }
        }
    }

    /// One derivative of one joint's position at one instant, derived by the unknowns: the first unknown that it depends on, and the
    /// derivatives by that and the following ones.
    pub(in crate::design) fn signal(&self, x: &[f64], instant: usize, joint: usize, order: usize) -> (usize, Vec<f64>) {
        match self {
            Self::Sums { family, sampled } => {
                let size = family.unknowns_of_joint();
                let value = |m| sampled.orders[order].at(instant, m) * family.unit(joint, m);
                (joint * size, (0..size).map(value).collect())
            }
            Self::Moves { family, points } => (0, family.signal(&points[instant], x, joint, order)),
        }
    }

    /// Constraints on the unknowns themselves, as rows of a step.
    pub(in crate::design) fn rows(&self, x: &[f64]) -> Vec<Row> {
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
