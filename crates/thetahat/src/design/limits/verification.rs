//! The limits along a motion at 1 kHz.

use crate::design::{limits::joint_limits::JointLimits, motions::sums::Derivatives};
use thetahat_ground::series::Series;
use thetahat_report::results::{LimitUse, Limited};

/// Samples per second at which limits are verified.
pub(in crate::design) const RATE_HZ: f64 = 1000.0;

/// The largest use of every limit of every joint, by a motion at [`RATE_HZ`] and the torques of every possible robot.
pub(in crate::design) fn uses(limits: &[JointLimits], motion: &Derivatives, torques: &[Series]) -> Vec<LimitUse> {
    let of = |coordinate: usize, limits: &JointLimits| {
        let one = |limited: Limited| {
            let range = limits.range(limited)?;
            let values = |tau: &Series| values(motion, tau, coordinate, limited);
            let uses = torques.iter().map(|tau| use_of(coordinate, limits, limited, range, &values(tau)));
            uses.max_by(|a, b| a.part.total_cmp(&b.part))
        };
        Limited::ALL.into_iter().filter_map(one).collect::<Vec<_>>()
    };
    limits.iter().enumerate().flat_map(|(coordinate, limits)| of(coordinate, limits)).collect()
}

fn values(motion: &Derivatives, tau: &Series, coordinate: usize, limited: Limited) -> Vec<f64> {
    match limited {
        Limited::Position => motion[0].channel(coordinate),
        Limited::Velocity => motion[1].channel(coordinate),
        Limited::Acceleration => motion[2].channel(coordinate),
        Limited::Jerk => motion[3].channel(coordinate),
        Limited::Torque => tau.channel(coordinate),
        Limited::Power => {
            tau.channel(coordinate).into_iter().zip(motion[1].channel(coordinate)).map(|(tau, v)| tau * v).collect()
        }
    }
}

fn use_of(coordinate: usize, limits: &JointLimits, limited: Limited, limit: [f64; 2], values: &[f64]) -> LimitUse {
    let [lower, upper] = limit;
    let part = |value: f64| (value - 0.5 * (lower + upper)).abs() / (0.5 * (upper - lower));
    let largest = (0..values.len()).max_by(|&a, &b| part(values[a]).total_cmp(&part(values[b]))).unwrap_or(0);
    let reached = [f64::min, f64::max].map(|better| values.iter().copied().fold(values[largest], better));
    LimitUse {
        joint: limits.joint.clone(),
        coordinate,
        quantity: limited,
        limit,
        reached,
        at_s: largest as f64 / RATE_HZ,
        part: part(values[largest]),
    }
}
