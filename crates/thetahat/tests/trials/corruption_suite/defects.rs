//! Kinds of defects that are applied to every robot, whatever its joints and rate.

use std::f64::consts::{FRAC_PI_2, TAU};

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use thetahat::{
    Matrix, Robot, Series,
    checks::{Code, Finding, Severity},
};
use thetahat_ground::linear_algebra::PivotedQr;

use super::{
    corruptions::{limit, peak, quantise, scale, set},
    record::Record,
    robots::Specimen,
};

/// A defect of one record.
pub struct Defect {
    pub name: &'static str,
    /// The finding that it must raise.
    pub codes: &'static [Code],
    /// Robots in which it is not found, with the reason.
    pub unseen: &'static [(Specimen, &'static str)],
    pub apply: fn(&mut Record),
}

/// What becomes of a defect.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Outcome {
    /// A problem: exit code 1, and nothing or not this joint is to be taken.
    Refused(Code),
    /// A warning.
    Named(Code),
    NotSeen,
}

impl Outcome {
    /// The gravest of the expected findings.
    pub fn of(findings: &[Finding], codes: &[Code]) -> Self {
        match findings.iter().filter(|f| codes.contains(&f.code)).min_by_key(|f| f.severity) {
            Some(f) if f.severity == Severity::Problem => Self::Refused(f.code),
            Some(f) if f.severity == Severity::Warning => Self::Named(f.code),
            Some(_) | None => Self::NotSeen,
        }
    }

    pub fn cell(&self) -> String {
        match self {
            Self::Refused(code) => format!("refused, `{code}`"),
            Self::Named(code) => format!("named, `{code}`"),
            Self::NotSeen => "not seen".to_owned(),
        }
    }
}

const NO_MASSES: (Specimen, &str) = (Specimen::Ur10, "its description has no masses");

const BELOW_NOISE: &str = "a drift of 10 % is less than five of its deviations";

/// All of them.
pub fn defects() -> Vec<Defect> {
    let mut all = of_sides();
    all.extend(of_torques());
    all.extend(of_motions());
    all.extend(of_time());
    all
}

fn of_sides() -> Vec<Defect> {
    use Code::{
        APrioriScale, JointsSwapped, NegativeFriction, PoorFit, PositionScale, TorqueScale, TorqueSign, WrongRobot,
    };
    vec![
        Defect {
            name: "torques of the motors of gears that are not stated (1:100)",
            codes: &[APrioriScale],
            unseen: &[NO_MASSES],
            apply: |r| r.torque.values_mut().iter_mut().for_each(|t| *t /= 100.0),
        },
        Defect {
            name: "torques in N mm, read as N m",
            codes: &[APrioriScale],
            unseen: &[NO_MASSES],
            apply: |r| r.torque.values_mut().iter_mut().for_each(|t| *t *= 1000.0),
        },
        Defect {
            name: "positions of the motors of gears that are not stated (1:100)",
            codes: &[PositionScale, WrongRobot],
            unseen: &[],
            apply: |r| r.position.values_mut().iter_mut().for_each(|q| *q *= 100.0),
        },
        Defect {
            name: "positions in degrees, read as rad",
            codes: &[PositionScale],
            unseen: &[],
            apply: |r| r.position.values_mut().iter_mut().for_each(|q| *q = q.to_degrees()),
        },
        Defect {
            name: "torque 2 with the other sign",
            codes: &[TorqueSign, NegativeFriction, WrongRobot, PoorFit],
            unseen: &[],
            apply: |r| scale(&mut r.torque, 2, -1.0),
        },
        Defect {
            name: "torques 2 and 3 exchanged",
            codes: &[JointsSwapped, TorqueSign, WrongRobot],
            unseen: &[],
            apply: |r| (0..r.torque.len()).for_each(|k| r.torque.sample_mut(k).swap(1, 2)),
        },
        Defect {
            name: "torques of all joints 40 times too large, one gear's ratio",
            codes: &[APrioriScale, TorqueScale],
            unseen: &[NO_MASSES],
            apply: |r| r.torque.values_mut().iter_mut().for_each(|t| *t *= 40.0),
        },
    ]
}

fn of_torques() -> Vec<Defect> {
    use Code::{
        Lag, PoorFit, TorqueIdle, TorqueNoise, TorqueQuantised, TorqueSaturated, TorqueSpikes, WorseThanMean,
        WrongRobot,
    };
    vec![
        Defect {
            name: "torque 2 in 40 values",
            codes: &[TorqueQuantised],
            unseen: &[],
            apply: |r| {
                let step = peak(&r.torque, 2) / 20.0;
                quantise(&mut r.torque, 2, step);
            },
        },
        Defect {
            name: "torque 2 zero for 90 % of the time",
            codes: &[TorqueIdle],
            unseen: &[],
            apply: |r| set(&mut r.torque, 2, |k, t| if k % 10 == 0 { t } else { 0.0 }),
        },
        Defect { name: "torque 2 is noise", codes: &[TorqueNoise], unseen: &[], apply: |r| noise(r, 2) },
        Defect {
            name: "all torques are noise",
            codes: &[TorqueNoise],
            unseen: &[],
            apply: |r| (1..=r.robot.coordinate_count()).for_each(|j| noise(r, j)),
        },
        Defect {
            name: "torque 2 is that of another motion",
            codes: &[WorseThanMean, PoorFit, WrongRobot],
            unseen: &[],
            apply: |r| {
                let (torque, shift) = (r.torque.channel(1), r.signal.window.len() * 37 / 100);
                set(&mut r.torque, 2, |k, _| torque[(k + shift) % torque.len()]);
            },
        },
        Defect {
            name: "all torques are those of another motion",
            // Of a motion that nearly repeats, they are those of the same motion at another time.
            codes: &[WorseThanMean, PoorFit, WrongRobot, Lag],
            unseen: &[],
            apply: |r| {
                let (torque, shift) = (r.torque.clone(), r.signal.window.len() * 37 / 100);
                for k in 0..torque.len() {
                    r.torque.sample_mut(k).copy_from_slice(torque.sample((k + shift) % torque.len()));
                }
            },
        },
        Defect {
            name: "torque 2 limited to 60 % of its peak",
            codes: &[TorqueSaturated],
            unseen: &[],
            apply: |r| limit(&mut r.torque, 2, 0.6),
        },
        Defect {
            name: "six outliers in torque 2",
            codes: &[TorqueSpikes],
            unseen: &[],
            apply: |r| {
                let (size, window) = (3.0 * peak(&r.torque, 2), r.signal.window.clone());
                (1..=6).for_each(|i| r.torque.sample_mut(window.start + i * window.len() / 8)[1] += size);
            },
        },
    ]
}

fn of_motions() -> Vec<Defect> {
    use Code::{GravityDirection, JointDither, JointStill, PoorFit, PositionZero, WorseThanMean, WrongRobot};
    vec![
        Defect {
            name: "the last joint is held",
            codes: &[JointStill],
            unseen: &[],
            apply: |r| {
                let (n, first) = (r.robot.coordinate_count(), r.position.sample(0).to_vec());
                set(&mut r.position, n, |_, _| first[n - 1]);
            },
        },
        Defect {
            name: "the last joint is held and trembles",
            codes: &[JointDither],
            unseen: &[],
            apply: |r| {
                let (n, first, rate) = (r.robot.coordinate_count(), r.position.sample(0).to_vec(), r.rate_hz);
                set(&mut r.position, n, |k, _| first[n - 1] + 5e-4 * (TAU * 3.0 * k as f64 / rate).sin());
            },
        },
        Defect {
            name: "the description of another robot",
            // With the places of seven axes reversed, gravity comes from another side of the base.
            codes: &[WrongRobot, GravityDirection, PositionZero, PoorFit, WorseThanMean],
            unseen: &[],
            apply: other_robot,
        },
    ]
}

fn of_time() -> Vec<Defect> {
    use Code::{FrictionDrift, GainDrift, RepeatedSamples};
    vec![
        Defect {
            name: "torque 2 drifts by 20 %",
            codes: &[GainDrift],
            unseen: &[],
            apply: |r| {
                let ramp = ramp(r);
                set(&mut r.torque, 2, |k, t| t * (1.0 + 0.2 * ramp(k)));
            },
        },
        Defect {
            name: "torque 2 drifts by 10 %",
            codes: &[GainDrift],
            unseen: &[(Specimen::Ur10, BELOW_NOISE), (Specimen::Twin, BELOW_NOISE)],
            apply: |r| {
                let ramp = ramp(r);
                set(&mut r.torque, 2, |k, t| t * (1.0 + 0.1 * ramp(k)));
            },
        },
        Defect {
            name: "friction of joint 1 falls by 30 %",
            codes: &[FrictionDrift],
            unseen: &[],
            apply: |r| {
                let (ramp, friction) = (ramp(r), friction(r, 1));
                set(&mut r.torque, 1, |k, t| t - 0.3 * ramp(k) * friction[k]);
            },
        },
        Defect {
            name: "every second sample repeats the one before",
            codes: &[RepeatedSamples],
            unseen: &[],
            apply: |r| {
                for k in (1..r.position.len()).step_by(2) {
                    for series in [&mut r.position, &mut r.torque] {
                        let before = series.sample(k - 1).to_vec();
                        series.sample_mut(k).copy_from_slice(&before);
                    }
                }
            },
        },
    ]
}

/// White noise of the torque's deviation about its mean.
fn noise(record: &mut Record, joint: usize) {
    let mut rng = ChaCha8Rng::seed_from_u64(11 + joint as u64);
    let torque = record.torque.channel(joint - 1);
    let mean = torque.iter().sum::<f64>() / torque.len() as f64;
    let size = (torque.iter().map(|t| (t - mean).powi(2)).sum::<f64>() / torque.len() as f64).sqrt();
    let values: Vec<f64> = torque.iter().map(|_| mean + size * 3.0_f64.sqrt() * rng.random_range(-1.0..1.0)).collect();
    set(&mut record.torque, joint, |k, _| values[k]);
}

/// From -1/2 to 1/2 over the window.
fn ramp(record: &Record) -> impl Fn(usize) -> f64 + use<> {
    let window = record.signal.window.clone();
    move |k| ((k as f64 - window.start as f64) / window.len() as f64).clamp(0.0, 1.0) - 0.5
}

/// The friction of a joint by a fit of its own inertia, friction, offset and pendulum.
fn friction(record: &Record, joint: usize) -> Vec<f64> {
    let j = joint - 1;
    let velocity = record.own_velocity().channel(j);
    let (q, tau, rate) = (record.position.channel(j), record.torque.channel(j), record.rate_hz);
    let acceleration = |k: usize| 0.5 * rate * (velocity[(k + 1).min(velocity.len() - 1)] - velocity[k.max(1) - 1]);
    let row = |k: usize| [velocity[k], velocity[k].signum(), acceleration(k), 1.0, q[k].sin(), q[k].cos()];
    let step = (q.len() / 3000).max(1);
    let places: Vec<usize> = (0..q.len()).step_by(step).collect();
    let x = Matrix::from_fn(places.len(), 6, |i, c| row(places[i])[c]);
    let theta = PivotedQr::new(&x).solve(&places.iter().map(|&k| tau[k]).collect::<Vec<_>>());
    velocity.iter().map(|v| theta[0] * v + theta[1] * v.signum()).collect()
}

/// The TX40 for a UR10 and the reverse; of seven axes the joints in the reverse order, of others every axis turned by a right
/// angle.
fn other_robot(record: &mut Record) {
    let read = |file: &str| Robot::read(&thetahat_testing::root().join("robots").join(file)).unwrap();
    record.excluded.clear();
    if record.robot.coordinate_count() == 6 {
        let is_tx40 = record.robot.name.contains("TX40");
        record.robot = read(if is_tx40 { "ur10.toml" } else { "tx40.toml" });
        return;
    }
    let joints = &mut record.robot.joints;
    if joints.len() == 7 {
        let placements: Vec<_> = joints.iter().rev().map(|joint| joint.placement).collect();
        joints.iter_mut().zip(placements).for_each(|(joint, placement)| joint.placement = placement);
        return;
    }
    joints.iter_mut().for_each(|joint| joint.placement.alpha += FRAC_PI_2);
}

/// A part of a record.
pub fn part(record: &Record, window: std::ops::Range<usize>) -> Record {
    let of = |series: &Series| series.window(window.clone());
    let mut part = record.clone();
    (part.position, part.torque) = (of(&record.position), of(&record.torque));
    let edge = (part.rate_hz * 0.3).ceil() as usize;
    part.signal.window = edge..window.len() - edge;
    part
}
