use super::{
    inertial::{Inertial, Wrench},
    loops::LoopScratch,
    model::Model,
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
