//! Derivatives of a motion's torques with respect to positions and velocities: exact, from the torque kernel.

use std::ops::Range;

use pulp::{Simd, WithSimd};

use super::{model::Model, parameters::DynamicParameters, sign::Sign, state::State, workspace::Workspace};
use thetahat_ground::{
    real::{Dual, Lanes, Real},
    series::Series,
};

/// The derivatives of inverse dynamics, n by n each, row by row: torque by row, coordinate by column.
#[derive(Debug, Clone, PartialEq)]
#[doc(hidden)]
pub struct Jacobian {
    /// `d tau / d q`, N m/rad.
    #[doc(hidden)]
    pub by_position: Vec<f64>,
    /// `d tau / d dq`, N m s/rad.
    #[doc(hidden)]
    pub by_velocity: Vec<f64>,
}

impl Jacobian {
    /// Zeros for `n` coordinates.
    #[doc(hidden)]
    pub fn zeros(n: usize) -> Self {
        Self { by_position: vec![0.0; n * n], by_velocity: vec![0.0; n * n] }
    }
}

impl Model {
    /// `d ID / d q` and `d ID / d dq` of inverse dynamics `ID(q, dq, ddq)`, friction and coupled motors included, at each of
    /// the `samples` of a motion, at the same indices of `out`: by dual numbers, with one direction in each lane of a vector; of loops by
    /// central differences.
    /// The derivative with respect to the accelerations is the mass matrix.
    #[doc(hidden)]
    pub fn inverse_dynamics_jacobians(
        &self,
        parameters: &DynamicParameters,
        motion: [&Series; 3],
        channels: Option<&Series>,
        samples: Range<usize>,
        sign: Sign,
        out: &mut [Jacobian],
    ) {
        if let Some(closed) = self.closed() {
            return closed.jacobians(parameters, motion, samples, sign, out);
        }
        pulp::Arch::new().dispatch(Kernel { model: self, parameters, motion, channels, samples, sign, out });
    }
}

struct Kernel<'a> {
    model: &'a Model,
    parameters: &'a DynamicParameters,
    motion: [&'a Series; 3],
    channels: Option<&'a Series>,
    samples: Range<usize>,
    sign: Sign,
    out: &'a mut [Jacobian],
}

impl WithSimd for Kernel<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let n = self.model.coordinate_count();
        let zero = Dual::constant(Lanes::splat(simd, 0.0));
        let mut workspace = Workspace::like(self.model, zero);
        let [mut q, mut dq, mut ddq, mut tau] = [(); 4].map(|()| vec![zero; n]);
        let mut recorded = vec![zero; self.channels.map_or(0, Series::channels)];
        for (k, out) in self.samples.clone().zip(&mut self.out[self.samples]) {
            let [q_k, dq_k, ddq_k] = self.motion.map(|series| series.sample(k));
            recorded
                .iter_mut()
                .zip(self.channels.map_or(&[][..], |channels| channels.sample(k)))
                .for_each(|(to, value): (&mut Dual<Lanes<S>>, _)| *to = zero.like(*value));
            ddq.iter_mut().zip(ddq_k).for_each(|(to, value)| *to = zero.like(*value));
            for first in (0..2 * n).step_by(Lanes::<S>::COUNT) {
                seed(simd, &mut q, q_k, first, 0);
                seed(simd, &mut dq, dq_k, first, n);
                let state = State::new(&q, &dq).with_channels(&recorded);
                self.model.inverse_dynamics_of(self.parameters, state, &ddq, self.sign, &mut workspace, &mut tau);
                for (i, torque) in tau.iter().enumerate() {
                    let derivatives = torque.derivative.to_array();
                    for (direction, derivative) in (first..2 * n).zip(derivatives).take(Lanes::<S>::COUNT) {
                        let matrix = if direction < n { &mut out.by_position } else { &mut out.by_velocity };
                        matrix[i * n + direction % n] = derivative;
                    }
                }
            }
        }
    }
}

/// Seeds the dual numbers: the value at `place` varies in the direction `offset + place`. Lane `l` holds the direction `first +
/// l`.
#[inline(always)]
fn seed<S: Simd>(simd: S, numbers: &mut [Dual<Lanes<S>>], values: &[f64], first: usize, offset: usize) {
    for (place, (number, &value)) in numbers.iter_mut().zip(values).enumerate() {
        let derivative = Lanes::from_fn(simd, |lane| if first + lane == offset + place { 1.0 } else { 0.0 });
        *number = Dual { value: Lanes::splat(simd, value), derivative };
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::robot::Robot;

    const SIGN: Sign = Sign::smooth(0.1);
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
        let parameters = DynamicParameters::sorted(&model, &theta);
        let (state, ddq) = ([0.3, -0.2, 1.1, 0.07, -0.6, 0.9], [2.0, -1.0, 3.0]);
        let torques = |state: &[f64]| {
            let (mut tau, mut workspace) = ([0.0; 3], Workspace::new(&model));
            let (q, dq) = state.split_at(3);
            model.inverse_dynamics(&parameters, State::new(q, dq), &ddq, SIGN, &mut workspace, &mut tau);
            tau
        };
        let (q, dq) = state.split_at(3);
        let motion = [&[q, q].concat(), &[dq, dq].concat(), &[ddq, ddq].concat()];
        let [q, dq, ddq] = motion.map(|values| Series::shaped(3, values.clone()));
        let mut found = [Jacobian::zeros(3), Jacobian::zeros(3)];
        model.inverse_dynamics_jacobians(&parameters, [&q, &dq, &ddq], None, 0..2, SIGN, &mut found);
        assert_eq!(found[0], found[1]);
        for direction in 0..6 {
            let moved = |by: f64| {
                let mut state = state;
                state[direction] += by;
                torques(&state)
            };
            let (above, below) = (moved(1e-6), moved(-1e-6));
            for i in 0..3 {
                let expected = (above[i] - below[i]) / 2e-6;
                let columns = if direction < 3 { &found[1].by_position } else { &found[1].by_velocity };
                let value = columns[i * 3 + direction % 3];
                assert!(
                    (value - expected).abs() < 1e-7 * (1.0 + expected.abs()),
                    "{i} {direction}: {value} {expected}"
                );
            }
        }
    }
}
