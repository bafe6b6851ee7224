//! Derivatives of weighted sums of the entries of `phi` with respect to the motion: exact, by reverse mode from the links to
//! the coordinates, one sample in each lane. Entries of drives, which depend on few variables, are differentiated by dual
//! numbers.

use pulp::{Simd, WithSimd};

use super::observation::Regressor;
use crate::dynamics::{Adjoint, Model, Sign, State, Workspace};
use thetahat_ground::{
    real::{Dual, Lanes, Real},
    series::Series,
};

impl Regressor {
    /// The derivatives of `sum_jc w_kjc phi_jc(q_k, dq_k, ddq_k)` with respect to `q_k`, `dq_k` and `ddq_k`, sample by sample.
    ///
    /// `weights` have the layout of the rows of [`Regressor::evaluate_rows`]: sample by sample, coordinate by coordinate,
    /// column by column. Recorded channels are not supported: torque terms that need one have no slopes here. Of loops they are central
    /// differences.
    #[doc(hidden)]
    pub fn weighted_slopes(&self, model: &Model, motion: [&Series; 3], weights: &[f64], sign: Sign) -> [Series; 3] {
        if model.has_loops() {
            return self.slopes_by_differences(model, motion, weights, sign);
        }
        let [samples, joints] = [motion[0].len(), model.coordinate_count()];
        let mut slopes = [(); 3].map(|()| Series::zeros(samples, joints));
        let places: Vec<usize> = self.entries().iter().map(|e| e.joint * self.columns() + e.column).collect();
        let depends_on: Vec<_> = self.drives().iter().map(|drive| drive.depends_on(model)).collect();
        let problem =
            Problem { regressor: self, model, motion, weights, sign, places: &places, depends_on: &depends_on };
        let done = pulp::Arch::new().dispatch(Batches { problem, slopes: &mut slopes });
        let mut scratch = Scratch::new(&problem, 0.0);
        for k in done..samples {
            problem.gather(k, &mut scratch, |value| value(0));
            problem.slopes_of(&mut scratch);
            slopes
                .iter_mut()
                .zip(&scratch.slopes)
                .for_each(|(series, slopes)| series.sample_mut(k).copy_from_slice(slopes));
        }
        slopes
    }
}

#[derive(Clone, Copy)]
struct Problem<'a> {
    regressor: &'a Regressor,
    model: &'a Model,
    motion: [&'a Series; 3],
    weights: &'a [f64],
    sign: Sign,
    /// Index of each entry in the row of a sample.
    places: &'a [usize],
    /// The variables on which each entry of a drive depends: order and coordinate.
    depends_on: &'a [Vec<(usize, usize)>],
}

struct Scratch<T> {
    motion: [Vec<T>; 3],
    weights: Vec<T>,
    slopes: [Vec<T>; 3],
    workspace: Workspace<T>,
    adjoint: Adjoint<T>,
    /// The motion as dual numbers, for the entries of drives.
    dual: [Vec<Dual<T>>; 3],
}

impl<T: Real> Scratch<T> {
    #[inline(always)]
    fn new(problem: &Problem<'_>, kind: T) -> Self {
        let (zero, n) = (kind.like(0.0), problem.model.coordinate_count());
        Self {
            motion: [(); 3].map(|()| vec![zero; n]),
            weights: vec![zero; problem.places.len()],
            slopes: [(); 3].map(|()| vec![zero; n]),
            workspace: Workspace::like(problem.model, zero),
            adjoint: Adjoint::like(problem.model, zero),
            dual: [(); 3].map(|()| vec![Dual::constant(zero); n]),
        }
    }
}

impl Problem<'_> {
    /// Loads the motion and the weights of the samples from `start`; `lanes` makes a number from a function of the lane.
    #[inline(always)]
    fn gather<T: Real>(&self, start: usize, scratch: &mut Scratch<T>, lanes: impl Fn(&dyn Fn(usize) -> f64) -> T) {
        for (series, values) in self.motion.iter().zip(&mut scratch.motion) {
            for (c, value) in values.iter_mut().enumerate() {
                *value = lanes(&|lane| series.sample(start + lane)[c]);
            }
        }
        let size = self.model.coordinate_count() * self.regressor.columns();
        for (weight, place) in scratch.weights.iter_mut().zip(self.places) {
            *weight = lanes(&|lane| self.weights[(start + lane) * size + place]);
        }
    }

    /// Computes the derivatives with respect to q, dq and ddq in the scratch.
    #[inline(always)]
    fn slopes_of<T: Real>(&self, scratch: &mut Scratch<T>) {
        let Scratch { motion, weights, slopes, workspace, adjoint, dual } = scratch;
        let Some(&kind) = motion[0].first() else { return };
        slopes.iter_mut().flatten().for_each(|slope| *slope = kind.like(0.0));
        adjoint.clear(kind);
        let (inertial, drives) = weights.split_at(self.regressor.inertial().len());
        let [q, dq, ddq] = &*motion;
        let state = State::new(q, dq);
        self.model.propagate_motion(state, ddq, &mut workspace.links);
        self.regressor.inertial().add_slopes(self.model, workspace, inertial, adjoint);
        let [of_q, of_dq, of_ddq] = &mut *slopes;
        self.model.pull_back(state, workspace, adjoint, [of_q, of_dq, of_ddq]);
        for (values, numbers) in motion.iter().zip(dual.iter_mut()) {
            numbers.iter_mut().zip(values).for_each(|(number, value)| *number = Dual::constant(*value));
        }
        for (weight, (drive, depends_on)) in drives.iter().zip(self.regressor.drives().iter().zip(self.depends_on)) {
            for &(order, coordinate) in depends_on {
                dual[order][coordinate].derivative = kind.like(1.0);
                let [q, dq, ddq] = &*dual;
                let entry = drive.evaluate(self.model, State::new(q, dq), ddq, self.sign);
                dual[order][coordinate].derivative = kind.like(0.0);
                slopes[order][coordinate] += *weight * entry.derivative;
            }
        }
    }
}

struct Batches<'a, 'b> {
    problem: Problem<'a>,
    slopes: &'b mut [Series; 3],
}

impl WithSimd for Batches<'_, '_> {
    /// Number of finished samples: whole batches only.
    type Output = usize;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> usize {
        let lanes = Lanes::<S>::COUNT;
        if lanes == 1 {
            return 0;
        }
        let Self { problem, slopes } = self;
        let mut scratch = Scratch::new(&problem, Lanes::splat(simd, 0.0));
        let batches = problem.motion[0].len() / lanes;
        for start in (0..batches).map(|batch| batch * lanes) {
            problem.gather(start, &mut scratch, |value| Lanes::from_fn(simd, value));
            problem.slopes_of(&mut scratch);
            for (series, of_joints) in slopes.iter_mut().zip(&scratch.slopes) {
                for (joint, slope) in of_joints.iter().enumerate() {
                    let of_lanes = slope.to_array();
                    (0..lanes).for_each(|lane| series.sample_mut(start + lane)[joint] = of_lanes[lane]);
                }
            }
        }
        batches * lanes
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::robot::{Robot, RobotSource};

    fn robots() -> Vec<Robot> {
        let text = "name = 'r'\n[[joint]]\nname = 'a'\nkind = 'revolute'\n[[joint]]\nname = 'b'\nkind = 'prismatic'\n\
                    alpha_deg = 90\na_m = 0.3\n[[joint]]\nname = 'c'\nkind = 'revolute'\nalpha_deg = 40\ngamma_deg = 25\n\
                    [transmission]\nmatrix = [[1, 0, 0], [0, 1, 0], [0, 1, 1]]";
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../robots");
        let files = ["tx40.toml", "branching.urdf", "mobile_manipulator.urdf", "scara.toml"];
        let read = |name: &str| RobotSource::read(&folder.join(name)).unwrap().robot_without_transmission().unwrap();
        [Robot::parse(text, Path::new("r.toml")).unwrap()].into_iter().chain(files.map(read)).collect()
    }

    /// Every kind of term without a recorded channel. A Stribeck exponent of one has a kink at rest, which differences do not
    /// see.
    const TERMS: &str = "
[[term]]
kind = 'joint-spring'
joints = ['elbow']
rest_deg = 30
[[term]]
kind = 'exponential-stribeck'
velocity = 0.2
exponent = 2
[[term]]
kind = 'spring'
name = 'balancer'
from = { point_m = [-0.2, 0.5, 0.0] }
to = { link_of = 'shoulder', point_m = [0.3, 0.1, 0.0] }
free_length_m = 0.4
[[term]]
kind = 'hydraulic'
name = 'cylinder'
from = { link_of = 'shoulder', point_m = [0.1, 0.2, 0.0] }
to = { link_of = 'elbow', point_m = [0.25, 0.1, 0.0] }
direction = 'push'
length_m = 0.7
gas_length_m = 0.5
exponent = 1.2
[[term]]
kind = 'motor-harmonics'
joints = ['elbow']
harmonics = [1]
[[term]]
kind = 'polynomial-viscous'
joints = ['shoulder']
[[term]]
kind = 'load-friction'
[[term]]
kind = 'expression'
name = 'coupled'
joint = 'elbow'
expression = 'sin(3*q1) * cos(q)'
unit = 'N m'
";

    /// A planar arm with terms, and an arm whose last joint follows the first, which carries it.
    fn more_robots() -> [Robot; 2] {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../robots/two_joint.toml");
        let arm = std::fs::read_to_string(file).unwrap();
        let follower = "name = 'f'\n[[joint]]\nname = 'a'\nkind = 'revolute'\nalpha_deg = 90\n[[joint]]\nname = 'b'\n\
                        parent = 'a'\nkind = 'prismatic'\na_m = 0.3\nalpha_deg = 30\n[[joint]]\nname = 'c'\nparent = 'b'\n\
                        kind = 'revolute'\na_m = 0.2\nmimic = { joint = 'a', ratio = -0.7 }\n";
        [arm + TERMS, follower.to_owned()].map(|text| Robot::parse(&text, Path::new("r.toml")).unwrap())
    }

    /// Central differences over h are right to h^2 and to the rounding of the sum.
    #[test]
    fn slopes_are_those_of_finite_differences() {
        robots().iter().chain(&more_robots()).for_each(compare);
    }

    fn compare(robot: &Robot) {
        let model = Model::new(robot);
        let (n, all) = (model.coordinate_count(), (0..model.parameter_table().len()).collect::<Vec<_>>());
        let regressor = Regressor::new(&model, &all);
        let sign = Sign::smooth(0.4);
        let (samples, h, size) = (11, 1e-6, n * all.len());
        let wave = |w: f64| Series::shaped(n, (0..n * samples).map(|k| (w * k as f64).sin()).collect());
        let motion = [0.13, 0.7, 1.3].map(wave);
        let weights: Vec<f64> = (0..samples * size).map(|i| (0.37 * i as f64).cos()).collect();
        let sums = |motion: &[Series; 3]| -> Vec<f64> {
            let mut rows = vec![0.0; weights.len()];
            regressor.evaluate_rows(&model, motion.each_ref(), 0..samples, sign, &mut rows);
            rows.chunks(size)
                .zip(weights.chunks(size))
                .map(|(r, w)| thetahat_ground::linear_algebra::dot(r, w))
                .collect()
        };
        let slopes = regressor.weighted_slopes(&model, motion.each_ref(), &weights, sign);
        for (order, slopes) in slopes.iter().enumerate() {
            for joint in 0..n {
                let moved = |by: f64| {
                    let mut motion = motion.clone();
                    (0..samples).for_each(|k| motion[order].sample_mut(k)[joint] += by);
                    sums(&motion)
                };
                let (after, before) = (moved(h), moved(-h));
                for k in 0..samples {
                    let (found, central) = (slopes.sample(k)[joint], (after[k] - before[k]) / (2.0 * h));
                    let name = &robot.name;
                    assert!(
                        (found - central).abs() < 1e-7 * central.abs().max(10.0),
                        "{name} {order} {joint} {k}: {found} {central}"
                    );
                }
            }
        }
    }
}
