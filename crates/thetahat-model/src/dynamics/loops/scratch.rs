use super::{closed_tree::ClosedTree, conditions::Spin};
use crate::dynamics::{frames::JointFrame, workspace::Workspace};

/// Scratch of a closed tree: the state of all joints, and how the robot's coordinates move them.
#[derive(Debug, Clone)]
pub(crate) struct LoopScratch {
    /// Positions, velocities and accelerations of the tree's coordinates.
    pub(crate) q: Vec<f64>,
    pub(crate) dq: Vec<f64>,
    pub(crate) ddq: Vec<f64>,
    /// `G`: the tree's coordinates per coordinate of the robot, row by row.
    pub(crate) slopes: Vec<f64>,
    pub(super) before: Vec<f64>,
    pub(super) frames: Vec<JointFrame>,
    pub(super) spins: Vec<Spin>,
    pub(super) gaps: Vec<f64>,
    pub(super) drift: Vec<f64>,
    pub(super) jacobian: Vec<f64>,
    /// An orthonormal basis of the columns of `J_p`, column by column, and its triangular factor, row by row.
    pub(super) basis: Vec<f64>,
    pub(super) triangle: Vec<f64>,
    pub(super) rest: Vec<f64>,
    pub(super) solved: Vec<f64>,
    pub(crate) tree: Box<Workspace>,
    pub(super) tau: Vec<f64>,
    pub(super) bias: Vec<f64>,
    pub(super) mass: Vec<f64>,
}

impl LoopScratch {
    pub(crate) fn new(closed: &ClosedTree) -> Self {
        let (n, own) = (closed.tree.coordinate_count(), closed.independent.len());
        let (passive, equations) = (closed.passive.len(), closed.equations);
        let [q, dq, ddq, before, tau, bias] = [(); 6].map(|()| vec![0.0; n]);
        Self {
            q,
            dq,
            ddq,
            slopes: vec![0.0; n * own],
            before,
            frames: Vec::with_capacity(closed.tree.link_count()),
            spins: Vec::with_capacity(closed.tree.link_count()),
            gaps: vec![0.0; equations],
            drift: vec![0.0; equations],
            jacobian: vec![0.0; equations * n],
            basis: vec![0.0; passive * equations],
            triangle: vec![0.0; passive * passive],
            rest: vec![0.0; equations],
            solved: vec![0.0; passive],
            tree: Box::new(Workspace::new(&closed.tree)),
            tau,
            bias,
            mass: vec![0.0; n * n],
        }
    }
}
