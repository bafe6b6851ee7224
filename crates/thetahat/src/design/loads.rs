use super::{
    limits::{JointLimits, Limited},
    motions::Motions,
    quadratic::Row,
    sums::Derivatives,
};
use crate::{
    dynamics::{DynamicParameters, Model, Sign, State, Workspace},
    regressor::Regressor,
    series::Series,
};

/// The limits of torque and power along a motion, with the robot's a-priori parameters.
#[derive(Debug, Clone)]
pub(super) struct Loads {
    model: Model,
    parameters: DynamicParameters,
    /// Of the parameters that are not zero.
    regressor: Regressor,
    theta: Vec<f64>,
    limits: Vec<JointLimits>,
}

/// A torque or power is watched where it comes nearer to its limit than this part of it.
const NEAR: f64 = 0.3;

impl Loads {
    pub(super) fn new(model: &Model, theta: &[f64], limits: Vec<JointLimits>) -> Self {
        let columns: Vec<usize> = (0..theta.len()).filter(|&i| theta[i] != 0.0).collect();
        Self {
            parameters: DynamicParameters::new(model, theta),
            regressor: Regressor::new(model, &columns),
            theta: columns.iter().map(|&c| theta[c]).collect(),
            model: model.clone(),
            limits,
        }
    }

    /// Makes every limit smaller by a part.
    pub(super) fn tighten(&mut self, part: f64) {
        self.limits = self.limits.iter().map(|limits| limits.less(part)).collect();
    }

    /// The torques of a motion.
    pub(super) fn torques(&self, [q, dq, ddq]: [&Series; 3], sign: Sign) -> Series {
        let mut tau = Series::zeros(q.len(), q.channels());
        let mut workspace = Workspace::new(&self.model);
        for k in 0..q.len() {
            let state = State::new(q.sample(k), dq.sample(k));
            let torque = tau.sample_mut(k);
            self.model.inverse_dynamics(&self.parameters, state, ddq.sample(k), sign, &mut workspace, torque);
        }
        tau
    }

    /// Whether a joint has such a limit.
    pub(super) fn is_limited(&self) -> bool {
        self.limits.iter().any(JointLimits::has_dynamic)
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

    /// The largest use of a limit: above one it is violated.
    pub(super) fn use_of(&self, motion: &Derivatives, sign: Sign) -> f64 {
        if !self.is_limited() {
            return 0.0;
        }
        let tau = self.torques([&motion[0], &motion[1], &motion[2]], sign);
        self.uses(motion, &tau).map(|u| u.part.abs()).fold(0.0, f64::max)
    }

    /// The rows of a step from a motion, linearised at the extremes that are near a limit.
    pub(super) fn rows(&self, motions: &Motions, x: &[f64], motion: &Derivatives, sign: Sign) -> Vec<Row> {
        if !self.is_limited() {
            return Vec::new();
        }
        let tau = self.torques([&motion[0], &motion[1], &motion[2]], sign);
        let uses: Vec<Use> = self.uses(motion, &tau).collect();
        let is_extreme = |i: usize| {
            let same = |j: usize| uses[j].joint == uses[i].joint && uses[j].limited == uses[i].limited;
            let below = |j: usize| !same(j) || uses[j].part * uses[i].part.signum() <= uses[i].part.abs();
            below(i.saturating_sub(1)) && below((i + 1).min(uses.len() - 1))
        };
        let near = (0..uses.len()).filter(|&i| uses[i].part.abs() > 1.0 - NEAR && is_extreme(i));
        let at = At { motions, x, motion };
        near.map(|i| self.row(&at, &tau, &uses[i], sign)).collect()
    }

    fn row(&self, at: &At, tau: &Series, of: &Use, sign: Sign) -> Row {
        let Use { limited, joint, instant, limit, part } = *of;
        let mut slopes = self.torque_slopes(at.motion, joint, instant, sign);
        if limited == Limited::Power {
            let (torque, velocity) = (tau.sample(instant)[joint], at.motion[1].sample(instant)[joint]);
            slopes.iter_mut().for_each(|s| s.values_mut().iter_mut().for_each(|v| *v *= velocity));
            slopes[1].values_mut()[joint] += torque;
        }
        let per = part.signum() / limit;
        let entries = at.motions.chain_at(at.x, instant, slopes).into_iter().map(|v| per * v).collect();
        Row { start: 0, entries, bound: 1.0 - part.abs(), soft: true }
    }

    /// The derivatives of one joint's torque at one instant by q, dq and ddq.
    fn torque_slopes(&self, motion: &Derivatives, joint: usize, instant: usize, sign: Sign) -> [Series; 3] {
        let here = [0, 1, 2].map(|order: usize| motion[order].window(instant..instant + 1));
        let size = self.theta.len();
        let mut weights = vec![0.0; size * self.model.coordinate_count()];
        weights[joint * size..(joint + 1) * size].copy_from_slice(&self.theta);
        self.regressor.weighted_slopes(&self.model, here.each_ref(), &weights, sign)
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

/// A motion where it is looked at.
struct At<'a> {
    motions: &'a Motions,
    x: &'a [f64],
    motion: &'a Derivatives,
}
