//! How the torques of a motion change with positions and velocities: exactly, from the kernel that gives them.

use pulp::{Simd, WithSimd};

use super::{model::Model, parameters::DynamicParameters, sign::Sign, state::State, workspace::Workspace};
use crate::real::Dual;

/// Directions of one pass of the kernel.
const DIRECTIONS: usize = 4;

type Number = Dual<DIRECTIONS>;

/// The derivatives of inverse dynamics, n by n each, row by row: torque by row, coordinate by column.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Jacobian {
    /// `d tau / d q`, N m/rad.
    pub(crate) by_position: Vec<f64>,
    /// `d tau / d dq`, N m s/rad.
    pub(crate) by_velocity: Vec<f64>,
}

impl Jacobian {
    /// Zeros for `n` coordinates.
    pub(crate) fn zeros(n: usize) -> Self {
        Self { by_position: vec![0.0; n * n], by_velocity: vec![0.0; n * n] }
    }
}

/// Scratch of [`Model::inverse_dynamics_jacobian`].
#[derive(Debug, Clone)]
pub(crate) struct JacobianWorkspace {
    kernel: Workspace<Number>,
    q: Vec<Number>,
    dq: Vec<Number>,
    ddq: Vec<Number>,
    tau: Vec<Number>,
}

impl JacobianWorkspace {
    /// Scratch for a model.
    pub(crate) fn new(model: &Model) -> Self {
        let zero = Number::constant(0.0);
        let [q, dq, ddq, tau] = [(); 4].map(|()| vec![zero; model.coordinate_count()]);
        Self { kernel: Workspace::like(model, zero), q, dq, ddq, tau }
    }
}

impl Model {
    /// `d ID / d q` and `d ID / d dq` of inverse dynamics `ID(q, dq, ddq)`, friction and coupled motors included, by dual
    /// numbers in four directions a pass. The derivative by the accelerations is the mass matrix.
    pub(crate) fn inverse_dynamics_jacobian(
        &self,
        parameters: &DynamicParameters,
        state: State<'_>,
        ddq: &[f64],
        sign: Sign,
        workspace: &mut JacobianWorkspace,
        out: &mut Jacobian,
    ) {
        pulp::Arch::new().dispatch(Kernel { model: self, parameters, state, ddq, sign, workspace, out });
    }
}

struct Kernel<'a> {
    model: &'a Model,
    parameters: &'a DynamicParameters,
    state: State<'a>,
    ddq: &'a [f64],
    sign: Sign,
    workspace: &'a mut JacobianWorkspace,
    out: &'a mut Jacobian,
}

impl WithSimd for Kernel<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { model, parameters, state, ddq, sign, workspace, out } = self;
        let n = state.q.len();
        let JacobianWorkspace { kernel, q, dq, ddq: acceleration, tau } = workspace;
        acceleration.iter_mut().zip(ddq).for_each(|(to, from)| *to = Number::constant(*from));
        for first in (0..2 * n).step_by(DIRECTIONS) {
            seed(q, state.q, 0, first);
            seed(dq, state.dq, n, first);
            model.inverse_dynamics_of(parameters, State { q, dq }, acceleration, sign, kernel, tau);
            for (lane, direction) in (first..2 * n).take(DIRECTIONS).enumerate() {
                let column = if direction < n {
                    &mut out.by_position[direction..]
                } else {
                    &mut out.by_velocity[direction - n..]
                };
                column.iter_mut().step_by(n).zip(&*tau).for_each(|(to, torque)| *to = torque.derivatives[lane]);
            }
        }
    }
}

/// Values of which the one at `place` varies in the direction `offset + place`, the first direction of the pass being `first`.
#[inline(always)]
fn seed(numbers: &mut [Number], values: &[f64], offset: usize, first: usize) {
    for (place, (number, &value)) in numbers.iter_mut().zip(values).enumerate() {
        let derivatives = std::array::from_fn(|lane| f64::from(u8::from(first + lane == offset + place)));
        *number = Number { value, derivatives };
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::robot::Robot;

    const SIGN: Sign = Sign::Smooth { scale: 0.1 };
    const MIXED: &str = "name = \"mixed\"\n[[joint]]\nname = \"a\"\nkind = \"revolute\"\n\
        [[joint]]\nname = \"b\"\nkind = \"prismatic\"\nalpha_deg = 90\na_m = 0.2\n\
        [[joint]]\nname = \"c\"\nkind = \"revolute\"\nalpha_deg = -40\nd_m = 0.3\n\
        [[joint]]\nname = \"d\"\nkind = \"revolute\"\nparent = \"b\"\na_m = 0.4\n\
        mimic = { joint = \"a\", ratio = -1.5 }\n[transmission]\nmatrix = [[45, 0, 0], [0, 20, 0], [3, 0, 32]]\n";

    /// Against central differences of inverse dynamics: a tree with a prismatic joint, a follower and a coupled motor.
    #[test]
    fn it_is_the_derivative_of_inverse_dynamics() {
        let robot = Robot::parse(MIXED, Path::new("robot.toml")).unwrap();
        let model = Model::new(&robot);
        let theta: Vec<f64> = (0..model.parameter_table().len()).map(|i| (1.7 * i as f64).sin()).collect();
        let parameters = DynamicParameters::new(&model, &theta);
        let (state, ddq) = ([0.3, -0.2, 1.1, 0.07, -0.6, 0.9], [2.0, -1.0, 3.0]);
        let mut torques = |state: &[f64]| {
            let (mut tau, mut workspace) = ([0.0; 3], Workspace::new(&model));
            let (q, dq) = state.split_at(3);
            model.inverse_dynamics(&parameters, State { q, dq }, &ddq, SIGN, &mut workspace, &mut tau);
            tau
        };
        let (mut found, (q, dq)) = (Jacobian::zeros(3), state.split_at(3));
        let mut workspace = JacobianWorkspace::new(&model);
        model.inverse_dynamics_jacobian(&parameters, State { q, dq }, &ddq, SIGN, &mut workspace, &mut found);
        for direction in 0..6 {
            let mut moved = |by: f64| {
                let mut state = state;
                state[direction] += by;
                torques(&state)
            };
            let (above, below) = (moved(1e-6), moved(-1e-6));
            for i in 0..3 {
                let expected = (above[i] - below[i]) / 2e-6;
                let columns = if direction < 3 { &found.by_position } else { &found.by_velocity };
                let value = columns[i * 3 + direction % 3];
                assert!(
                    (value - expected).abs() < 1e-7 * (1.0 + expected.abs()),
                    "{i} {direction}: {value} {expected}"
                );
            }
        }
    }
}
