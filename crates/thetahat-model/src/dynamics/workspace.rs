use super::{
    frames::JointFrame,
    inertial::{Inertial, Wrench},
    loops::Spin,
    model::{ClosedTree, Model},
    motion::LinkMotion,
    twist::Twist,
};
use thetahat_ground::real::Real;

/// Scratch of the algorithms: one for each thread.
#[derive(Debug, Clone)]
pub struct Workspace<T = f64> {
    pub(crate) links: Vec<LinkMotion<T>>,
    pub(crate) twists: Vec<Twist<T>>,
    pub(super) wrenches: Vec<Wrench<T>>,
    pub(super) composite: Vec<Inertial<T>>,
    /// Lower triangle of the mass matrix of the joints as if none followed another; used if one does.
    pub(super) link_masses: Vec<T>,
    /// Lower triangle of the mass matrix of the coordinates.
    pub(super) mass_matrix: Vec<T>,
    pub(super) rhs: Vec<T>,
    pub(super) zeros: Vec<T>,
    /// Scratch of loops; none of a tree.
    pub(crate) loops: Option<Box<LoopScratch>>,
}

impl Workspace {
    /// Scratch for a model.
    #[must_use]
    pub fn new(model: &Model) -> Self {
        Self::like(model, 0.0)
    }
}

impl<T: Copy> Workspace<T> {
    /// Scratch for numbers of the type of `kind`.
    #[inline(always)]
    #[doc(hidden)]
    pub fn like(model: &Model, kind: T) -> Self
    where
        T: Real,
    {
        let (n, links, zero) = (model.coordinate_count(), model.link_count(), kind.like(0.0));
        let none = [zero; 3];
        Self {
            links: vec![LinkMotion::at_rest(kind, [0.0; 3]); links],
            twists: vec![Twist { angular: none, linear: none }; model.twist_count()],
            wrenches: vec![Wrench { force: none, moment: none }; links],
            composite: vec![Inertial::<f64>::default().in_lanes(kind); links],
            link_masses: vec![zero; links * links],
            mass_matrix: vec![zero; n * n],
            rhs: vec![zero; n],
            zeros: vec![zero; n],
            loops: model.closed().map(|closed| Box::new(LoopScratch::new(closed))),
        }
    }
}

impl<T> Workspace<T> {
    /// The mass matrix of the last forward dynamics, as `L` with `1/D` on its diagonal.
    #[doc(hidden)]
    pub fn factored_mass_matrix(&self) -> &[T] {
        &self.mass_matrix
    }
}

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
