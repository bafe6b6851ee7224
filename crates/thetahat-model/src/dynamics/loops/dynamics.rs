//! Dynamics of the tree, projected on the robot's coordinates.

use std::ops::Range;

use crate::dynamics::{
    damping::DampingWorkspace,
    jacobian::Jacobian,
    model::{ClosedTree, DynamicsError, Model},
    parameters::DynamicParameters,
    sign::Sign,
    solve::{factorise, solve_factorised},
    state::State,
    workspace::LoopScratch,
};
use thetahat_ground::{series::Series, vector::Vec3};

/// Steps of central differences: of positions, rad or m; of velocities, rad/s or m/s, below a thousandth of usual transitions of Coulomb
/// friction; and of accelerations, in which torques are linear.
pub(crate) const DIFFERENCES: [f64; 3] = [1e-5, 1e-6, 1.0];
/// Most halves of the way to a position that is out of reach.
const MOST_HALVES: usize = 20;

impl ClosedTree {
    /// `G^T tau` of torques on the tree's coordinates.
    fn project(&self, scratch: &LoopScratch, torques: &[f64], tau: &mut [f64]) {
        for (i, tau) in tau.iter_mut().enumerate() {
            *tau = torques.iter().enumerate().map(|(tree, torque)| self.slope(scratch, tree, i) * torque).sum();
        }
    }

    /// The lower triangle of `G^T A G`, from a symmetric matrix of the tree's coordinates.
    fn project_matrix(&self, scratch: &LoopScratch, matrix: &[f64], projected: &mut [f64]) {
        let (n, own) = (self.tree.coordinate_count(), self.independent.len());
        for i in 0..own {
            for j in 0..=i {
                let row = |t: usize| (0..n).map(|u| matrix[t * n + u] * self.slope(scratch, u, j)).sum::<f64>();
                projected[i * own + j] = (0..n).map(|t| self.slope(scratch, t, i) * row(t)).sum();
            }
        }
    }

    /// The torques of a motion; not numbers where the loops cannot be closed.
    pub(crate) fn inverse_dynamics(
        &self,
        parameters: &DynamicParameters,
        motion: [&[f64]; 3],
        sign: Sign,
        scratch: &mut LoopScratch,
        tau: &mut [f64],
    ) {
        if self.move_all(motion, scratch).is_err() {
            return tau.fill(f64::NAN);
        }
        let LoopScratch { q, dq, ddq, tree, tau: all, .. } = scratch;
        self.tree.inverse_dynamics(parameters, State::new(q, dq), ddq, sign, tree, all);
        self.project(scratch, &scratch.tau, tau);
    }

    /// The mass matrix, lower triangle; not numbers where the loops cannot be closed.
    pub(crate) fn mass_matrix(
        &self,
        parameters: &DynamicParameters,
        q: &[f64],
        scratch: &mut LoopScratch,
        mass: &mut [f64],
    ) {
        if self.place(q, scratch).is_err() {
            return mass.fill(f64::NAN);
        }
        self.project_mass(parameters, scratch, mass);
    }

    fn project_mass(&self, parameters: &DynamicParameters, scratch: &mut LoopScratch, mass: &mut [f64]) {
        let LoopScratch { q, tree, mass: all, .. } = scratch;
        self.tree.mass_matrix(parameters, q, tree, all);
        self.project_matrix(scratch, &scratch.mass, mass);
    }

    /// The accelerations of torques; `mass` becomes the factors of the mass matrix.
    ///
    /// # Errors
    /// Where the loops cannot be closed, or the mass matrix is not positive definite.
    pub(crate) fn forward_dynamics(
        &self,
        parameters: &DynamicParameters,
        [q, dq, tau]: [&[f64]; 3],
        sign: Sign,
        (scratch, mass): (&mut LoopScratch, &mut [f64]),
        ddq: &mut [f64],
    ) -> Result<(), DynamicsError> {
        ddq.fill(0.0);
        let mut bias = std::mem::take(&mut scratch.bias);
        bias.resize(q.len(), 0.0);
        let moved = self.move_all([q, dq, ddq], scratch);
        if moved.is_ok() {
            let LoopScratch { q, dq, ddq, tree, tau: all, .. } = &mut *scratch;
            self.tree.inverse_dynamics(parameters, State::new(q, dq), ddq, sign, tree, all);
            self.project(scratch, &scratch.tau, &mut bias);
        }
        scratch.bias = bias;
        moved?;
        ddq.iter_mut().zip(tau.iter().zip(&scratch.bias)).for_each(|(a, (t, b))| *a = t - b);
        self.project_mass(parameters, scratch, mass);
        let pivot = |(c, pivot): (usize, f64)| DynamicsError::MassMatrixNotPositiveDefinite {
            joint: self.joint_number(self.independent[c]),
            pivot,
        };
        factorise(mass, q.len()).map_err(pivot)?;
        solve_factorised(mass, ddq);
        Ok(())
    }

    /// As [`Model::inverse_dynamics_jacobians`].
    pub(crate) fn jacobians(
        &self,
        parameters: &DynamicParameters,
        motion: [&Series; 3],
        samples: Range<usize>,
        sign: Sign,
        out: &mut [Jacobian],
    ) {
        let (n, mut scratch) = (self.independent.len(), LoopScratch::new(self));
        let mut torques = |state: &[Vec<f64>; 3]| {
            let mut tau = vec![0.0; n];
            self.inverse_dynamics(parameters, state.each_ref().map(Vec::as_slice), sign, &mut scratch, &mut tau);
            tau
        };
        for (k, out) in samples.clone().zip(&mut out[samples]) {
            let mut state = motion.map(|series| series.sample(k).to_vec());
            let Jacobian { by_position, by_velocity } = out;
            for (order, matrix) in [by_position, by_velocity].into_iter().enumerate() {
                for j in 0..n {
                    let (value, step) = (state[order][j], DIFFERENCES[order]);
                    let [above, below] = [value + step, value - step].map(|moved| {
                        state[order][j] = moved;
                        torques(&state)
                    });
                    state[order][j] = value;
                    (0..n).for_each(|i| matrix[i * n + j] = (above[i] - below[i]) / (2.0 * step));
                }
            }
        }
    }

    /// `D = d tau / d dq` of friction.
    pub(crate) fn damping(
        &self,
        parameters: &DynamicParameters,
        state: State<'_>,
        sign: Sign,
        (scratch, workspace): (&mut LoopScratch, &mut DampingWorkspace),
        d: &mut [f64],
    ) {
        if self.place(state.q, scratch).is_err() {
            return d.fill(f64::NAN);
        }
        self.rates(state.dq, scratch);
        let mut of_tree = std::mem::take(&mut scratch.mass);
        self.tree.damping_into(parameters, State::new(&scratch.q, &scratch.dq), sign, workspace, &mut of_tree);
        let own = self.independent.len();
        self.project_matrix(scratch, &of_tree, d);
        (0..own).for_each(|i| (0..i).for_each(|j| d[j * own + i] = d[i * own + j]));
        scratch.mass = of_tree;
    }
}

impl ClosedTree {
    /// The tree's coordinates at those of the robot; not numbers where the loops cannot be closed.
    pub(crate) fn positions(&self, q: &[f64]) -> Vec<f64> {
        let mut scratch = LoopScratch::new(self);
        match self.place(q, &mut scratch) {
            Ok(()) => scratch.q,
            Err(_) => vec![f64::NAN; scratch.q.len()],
        }
    }

    /// As [`Model::frame`].
    pub(crate) fn frame(&self, j: usize, q: &[f64]) -> (Vec3, Vec3) {
        self.tree.frame(j, &self.positions(q))
    }

    /// As [`Model::energy`]; not a number where the loops cannot be closed.
    pub(crate) fn energy(&self, parameters: &DynamicParameters, state: State<'_>) -> f64 {
        let mut scratch = LoopScratch::new(self);
        if self.place(state.q, &mut scratch).is_err() {
            return f64::NAN;
        }
        self.rates(state.dq, &mut scratch);
        let LoopScratch { q, dq, tree, .. } = &mut scratch;
        self.tree.energy(parameters, State::new(q, dq), tree)
    }
}

impl Model {
    /// Whether loops of links move some of the joints.
    #[must_use]
    #[doc(hidden)]
    pub fn has_loops(&self) -> bool {
        self.closed().is_some()
    }

    /// Refuses loops that cannot be closed where the description says.
    ///
    /// # Errors
    /// What is wrong with the loop.
    #[doc(hidden)]
    pub fn check_loops(&self) -> Result<(), DynamicsError> {
        self.closed().and_then(ClosedTree::problem).map_or(Ok(()), |problem| Err(problem.clone()))
    }

    /// The positions of all joints where the description closes the loops, rad or m; none of a tree.
    #[doc(hidden)]
    #[must_use]
    pub fn closed_positions(&self) -> Option<Vec<f64>> {
        let closed = self.closed()?;
        Some(closed.tree.joints.iter().map(|joint| joint.position(closed.reference())).collect())
    }

    /// The positions of all joints, rad or m, at those of the coordinates; not numbers where loops cannot be closed.
    #[doc(hidden)]
    #[must_use]
    pub fn joint_positions(&self, q: &[f64]) -> Vec<f64> {
        match self.closed() {
            None => self.joints.iter().map(|joint| joint.position(q)).collect(),
            Some(closed) => closed.tree.joint_positions(&closed.positions(q)),
        }
    }

    /// Moves positions towards those where the description closes the loops, until the loops can be closed.
    #[doc(hidden)]
    pub fn reach(&self, q: &mut [f64]) {
        let Some(closed) = self.closed() else { return };
        let mut scratch = LoopScratch::new(closed);
        for _ in 0..MOST_HALVES {
            if closed.place(q, &mut scratch).is_ok() {
                return;
            }
            q.iter_mut().enumerate().for_each(|(c, q)| *q = 0.5 * (*q + closed.reference_of(c)));
        }
    }

    /// Refuses positions at which loops cannot be closed.
    ///
    /// # Errors
    /// The first sample, from zero, and the joint.
    #[doc(hidden)]
    pub fn check_positions(&self, q: &Series) -> Result<(), (usize, DynamicsError)> {
        let Some(closed) = self.closed() else { return Ok(()) };
        let mut scratch = LoopScratch::new(closed);
        (0..q.len()).try_for_each(|k| closed.place(q.sample(k), &mut scratch).map_err(|error| (k, error)))
    }
}
