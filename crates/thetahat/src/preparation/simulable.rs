//! What an elimination must leave, so that the rest can be simulated.

use std::f64::consts::PI;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use thetahat_estimation::{identification::idim_ls, regression::Regression};
use thetahat_model::{
    base_parameters::BaseParameters,
    dynamics::{DynamicParameters, Model, Workspace, factorise},
    robot::{Joint, JointKind, Robot},
};

/// Configurations at which the mass matrix is looked at, and the seed from which they are drawn.
const CONFIGURATIONS: usize = 25;
const SEED: u64 = 1;
/// Reach of a prismatic joint to both sides, m.
const REACH_M: f64 = 0.5;

/// A robot whose motors have inertia, and whose mass matrix is positive definite where that of all base parameters is.
pub(crate) struct Simulable<'a> {
    model: &'a Model,
    base: &'a BaseParameters,
    /// The columns of the base that the motion separates.
    separated: &'a [usize],
    configurations: Vec<Vec<f64>>,
    /// Whether the estimate of all of them has a positive definite mass matrix.
    whole_is_definite: bool,
}

impl<'a> Simulable<'a> {
    /// What the rows of the base parameters that the motion separates say.
    pub(crate) fn new(
        robot: &Robot,
        (model, base): (&'a Model, &'a BaseParameters),
        all: &Regression,
        separated: &'a [usize],
    ) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(SEED);
        let reach = |j: &Joint| match j.kind {
            JointKind::Revolute => PI,
            JointKind::Prismatic => REACH_M,
        };
        let mut draw = || robot.coordinates().map(|j| rng.random_range(-1.0..1.0) * reach(j)).collect();
        let configurations = (0..CONFIGURATIONS).map(|_| draw()).collect();
        let mut simulable = Self { model, base, separated, configurations, whole_is_definite: false };
        let estimate = idim_ls(&all.with_columns(separated), Default::default()).ok();
        simulable.whole_is_definite = estimate.is_some_and(|fit| simulable.is_definite(separated, &fit.theta));
        simulable
    }

    /// Whether some of the columns, with their estimates, are enough.
    pub(crate) fn is_possible(&self, kept: &[usize], theta: &[f64]) -> bool {
        self.has_motor_inertias(kept) && (!self.whole_is_definite || self.is_definite(kept, theta))
    }

    fn has_motor_inertias(&self, kept: &[usize]) -> bool {
        let table = self.model.parameter_table();
        let is_inertia = |c: &usize| table.get(self.base.parameters()[*c].kept).quantity.is_motor_inertia();
        self.separated.iter().filter(|c| is_inertia(c)).all(|c| kept.contains(c))
    }

    fn is_definite(&self, kept: &[usize], theta: &[f64]) -> bool {
        let mut of_base = vec![0.0; self.base.len()];
        kept.iter().zip(theta).for_each(|(&c, t)| of_base[c] = *t);
        let parameters = DynamicParameters::sorted(self.model, &self.base.to_standard(&of_base));
        let mut workspace = Workspace::new(self.model);
        let n = self.model.coordinate_count();
        let mut mass = vec![0.0; n * n];
        self.configurations.iter().all(|q| {
            self.model.mass_matrix(&parameters, q, &mut workspace, &mut mass);
            factorise(&mut mass, n).is_ok()
        })
    }
}
