use crate::design::{
    limits::joint_limits::JointLimits,
    motions::{family::MotionPoint, sums::Derivatives},
};
use thetahat_ground::{quadratic_program::Row, series::Series};
use thetahat_model::{
    dynamics::{DynamicParameters, Model, Sign, State, Workspace},
    regressor::Regressor,
};
use thetahat_report::results::Limited;

/// The limits of torque and power along a motion: they hold for every possible robot.
#[derive(Debug, Clone)]
pub(in crate::design) struct Loads {
    model: Model,
    /// The first is the expected robot.
    robots: Vec<LoadedRobot>,
    limits: Vec<JointLimits>,
}

/// A robot by its standard parameters.
#[derive(Debug, Clone)]
struct LoadedRobot {
    parameters: DynamicParameters,
    /// The regressor of the parameters that are not zero.
    regressor: Regressor,
    theta: Vec<f64>,
}

impl LoadedRobot {
    fn new(model: &Model, theta: &[f64]) -> Self {
        let columns: Vec<usize> = (0..theta.len()).filter(|&i| theta[i] != 0.0).collect();
        Self {
            parameters: DynamicParameters::sorted(model, theta),
            regressor: Regressor::new(model, &columns),
            theta: columns.iter().map(|&c| theta[c]).collect(),
        }
    }
}

/// A torque or power within this part of its limit is constrained.
const NEAR: f64 = 0.3;

impl Loads {
    /// The loads of robots, given by their standard parameters, the expected one first.
    pub(in crate::design) fn new(model: &Model, robots: &[Vec<f64>], limits: Vec<JointLimits>) -> Self {
        let robots = robots.iter().map(|theta| LoadedRobot::new(model, theta)).collect();
        Self { model: model.clone(), robots, limits }
    }

    /// Makes every limit smaller by a part.
    pub(in crate::design) fn tighten(&mut self, part: f64) {
        self.limits = self.limits.iter().map(|limits| limits.less(part)).collect();
    }

    /// The torques of a motion by each robot, the expected one first.
    pub(in crate::design) fn torques(&self, motion: &Derivatives, sign: Sign) -> Vec<Series> {
        self.robots.iter().map(|robot| self.torques_of(robot, motion, sign)).collect()
    }

    fn torques_of(&self, robot: &LoadedRobot, [q, dq, ddq, _]: &Derivatives, sign: Sign) -> Series {
        let mut tau = Series::zeros(q.len(), q.channels());
        let mut workspace = Workspace::new(&self.model);
        for k in 0..q.len() {
            let state = State::new(q.sample(k), dq.sample(k));
            let torque = tau.sample_mut(k);
            self.model.inverse_dynamics(&robot.parameters, state, ddq.sample(k), sign, &mut workspace, torque);
        }
        tau
    }

    /// Use of the limits by every joint at every instant: load over limit, with its sign.
    fn uses<'a>(&'a self, motion: &'a Derivatives, tau: &'a Series) -> impl Iterator<Item = Use> + 'a {
        let of = move |limited: Limited, joint: usize, limit: f64| {
            (0..tau.len()).map(move |instant| {
                let torque = tau.sample(instant)[joint];
                let load = match limited {
                    Limited::Power => torque * motion[1].sample(instant)[joint],
                    Limited::Position | Limited::Velocity | Limited::Acceleration | Limited::Jerk | Limited::Torque => {
                        torque
                    }
                };
                Use { limited, joint, instant, limit, part: load / limit }
            })
        };
        self.limits.iter().enumerate().flat_map(move |(joint, limits)| {
            let torque = limits.torque.into_iter().flat_map(move |limit| of(Limited::Torque, joint, limit));
            torque.chain(limits.power.into_iter().flat_map(move |limit| of(Limited::Power, joint, limit)))
        })
    }

    /// The torques of a motion, robot by robot; empty if no load is limited.
    pub(in crate::design) fn limited_torques(&self, motion: &Derivatives, sign: Sign) -> Vec<Series> {
        let is_limited = self.limits.iter().any(JointLimits::has_dynamic);
        if is_limited { self.torques(motion, sign) } else { Vec::new() }
    }

    /// The largest use of a limit by a motion with its torques: above one it is violated.
    pub(in crate::design) fn use_of(&self, motion: &Derivatives, torques: &[Series]) -> f64 {
        torques.iter().flat_map(|tau| self.uses(motion, tau)).map(|u| u.part.abs()).fold(0.0, f64::max)
    }

    /// The rows of a step from a motion with its torques, linearised at the extremes that are near a limit.
    pub(in crate::design) fn rows(&self, at: MotionPoint<'_>, torques: &[Series], sign: Sign) -> Vec<Row> {
        let of_robots = self.robots.iter().zip(torques);
        of_robots.flat_map(|(robot, tau)| self.rows_of(robot, at, tau, sign)).collect()
    }

    fn rows_of(&self, robot: &LoadedRobot, at: MotionPoint<'_>, tau: &Series, sign: Sign) -> Vec<Row> {
        let MotionPoint { motions, x, motion } = at;
        let near = self.near(motion, tau);
        let [by_q, by_dq, by_ddq] = self.torque_slopes(robot, motion, &near, sign);
        let row = |(k, of): (usize, &Use)| {
            let mut slopes = [&by_q, &by_dq, &by_ddq].map(|series| series.window(k..k + 1));
            if of.limited == Limited::Power {
                let (torque, velocity) = (tau.sample(of.instant)[of.joint], motion[1].sample(of.instant)[of.joint]);
                slopes.iter_mut().for_each(|s| s.values_mut().iter_mut().for_each(|v| *v *= velocity));
                slopes[1].values_mut()[of.joint] += torque;
            }
            let per = of.part.signum() / of.limit;
            let entries = motions.chain_at(x, of.instant, slopes).into_iter().map(|v| per * v).collect();
            Row { start: 0, entries, bound: 1.0 - of.part.abs(), soft: true }
        };
        near.iter().enumerate().map(row).collect()
    }

    /// The extremes of each load that are near its limit.
    fn near(&self, motion: &Derivatives, tau: &Series) -> Vec<Use> {
        let uses: Vec<Use> = self.uses(motion, tau).collect();
        let is_extreme = |i: usize| {
            let same = |j: usize| uses[j].joint == uses[i].joint && uses[j].limited == uses[i].limited;
            let below = |j: usize| !same(j) || uses[j].part * uses[i].part.signum() <= uses[i].part.abs();
            below(i.saturating_sub(1)) && below((i + 1).min(uses.len() - 1))
        };
        (0..uses.len()).filter(|&i| uses[i].part.abs() > 1.0 - NEAR && is_extreme(i)).map(|i| uses[i]).collect()
    }

    /// The derivatives, by q, dq and ddq, of the torque of each use's joint at its instant: one sample for each use.
    fn torque_slopes(&self, robot: &LoadedRobot, motion: &Derivatives, uses: &[Use], sign: Sign) -> [Series; 3] {
        let joints = self.model.coordinate_count();
        let there = [0, 1, 2].map(|order: usize| {
            let values = uses.iter().flat_map(|of| motion[order].sample(of.instant)).copied().collect();
            Series::shaped(joints, values)
        });
        let size = robot.theta.len();
        let mut weights = vec![0.0; uses.len() * joints * size];
        for (of, weights) in uses.iter().zip(weights.chunks_exact_mut((joints * size).max(1))) {
            weights[of.joint * size..(of.joint + 1) * size].copy_from_slice(&robot.theta);
        }
        robot.regressor.weighted_slopes(&self.model, there.each_ref(), &weights, sign)
    }
}

/// Use of a limit at one instant.
#[derive(Debug, Clone, Copy)]
struct Use {
    limited: Limited,
    joint: usize,
    instant: usize,
    limit: f64,
    part: f64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::motions::{basis::Basis, family::Motions, sums::Sums};
    use thetahat_model::robot::{JointKind, Robot};

    fn robot() -> Robot {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../robots/two_joint.toml");
        Robot::read(&path).unwrap()
    }

    fn limits(joint: &str) -> JointLimits {
        JointLimits {
            joint: joint.to_owned(),
            kind: JointKind::Revolute,
            start: None,
            lower: -1.5,
            upper: 1.5,
            velocity: 4.0,
            acceleration: 25.0,
            jerk: None,
            torque: Some(25.0),
            power: Some(60.0),
        }
    }

    /// The rows of torque and power against what a step changes of the uses.
    #[test]
    fn rows_are_those_of_finite_differences() {
        let robot = robot();
        let model = Model::new(&robot);
        let expected = robot.a_priori_parameters();
        let heavy: Vec<f64> = expected.iter().map(|v| 1.2 * v).collect();
        let loads = Loads::new(&model, &[expected, heavy], vec![limits("shoulder"), limits("elbow")]);
        let family = Sums::new(Basis::fourier(4.0, 3), vec![0.2, -0.1], true, &[[1.5, 4.0, 25.0]; 2]);
        let time: Vec<f64> = (0..90).map(|k| 4.0 * (f64::from(k) + 0.5) / 90.0).collect();
        let motions = Motions::Sums { sampled: family.sampled(&time), family };
        let (sign, h) = (Sign::smooth(0.3), 1e-6);
        let x: Vec<f64> = (0..14).map(|i| 0.6 * (1.9 * f64::from(i)).sin()).collect();
        let motion = motions.at(&x);
        let torques = loads.limited_torques(&motion, sign);
        let near: Vec<Vec<Use>> = torques.iter().map(|tau| loads.near(&motion, tau)).collect();
        let rows = loads.rows(MotionPoint { motions: &motions, x: &x, motion: &motion }, &torques, sign);
        assert!(
            [Limited::Torque, Limited::Power].iter().all(|limited| near[0].iter().any(|of| of.limited == *limited))
        );
        assert!(torques.len() == 2 && near[1].len() > 2 && rows.len() == near[0].len() + near[1].len());
        let parts = |x: &[f64]| -> Vec<f64> {
            let motion = motions.at(x);
            let torques = loads.limited_torques(&motion, sign);
            let is_same = |u: &&Use, of: &Use| (u.limited, u.joint, u.instant) == (of.limited, of.joint, of.instant);
            let of_robot = |(tau, near): (&Series, &Vec<Use>)| -> Vec<f64> {
                let uses: Vec<Use> = loads.uses(&motion, tau).collect();
                near.iter().map(|of| uses.iter().find(|u| is_same(u, of)).unwrap().part.abs()).collect()
            };
            torques.iter().zip(&near).flat_map(of_robot).collect()
        };
        for i in 0..x.len() {
            let moved = |by: f64| {
                let mut x = x.clone();
                x[i] += by;
                parts(&x)
            };
            let (after, before) = (moved(h), moved(-h));
            for (k, row) in rows.iter().enumerate() {
                let (found, central) = (row.entries[i], (after[k] - before[k]) / (2.0 * h));
                assert!(
                    (found - central).abs() < 1e-7 * central.abs().max(1.0),
                    "row {k}, unknown {i}: {found} {central}"
                );
            }
        }
    }
}
