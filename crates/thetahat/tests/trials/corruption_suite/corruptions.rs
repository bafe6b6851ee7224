//! Corruptions of a record, one by one, with the finding that each must raise.

use std::path::Path;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use thetahat::{ControllerDescription, Series, checks::Code, robot::Transmission};
use thetahat_data::recording::Clock;

use super::record::Record;

/// What is recorded beside positions and torques.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub enum Beside {
    Nothing,
    Velocities,
    TimeStamps,
    Reference,
}

/// A corruption with the finding that it must raise.
#[derive(Clone)]
pub struct Corruption {
    pub name: &'static str,
    pub code: Code,
    /// From one; none where any joint or no joint will do.
    pub joint: Option<usize>,
    pub beside: Beside,
    pub apply: fn(&mut Record),
}

fn with(name: &'static str, code: Code, joint: impl Into<Option<usize>>, apply: fn(&mut Record)) -> Corruption {
    Corruption { name, code, joint: joint.into(), beside: Beside::Nothing, apply }
}

impl Corruption {
    fn given(self, beside: Beside) -> Self {
        Self { beside, ..self }
    }
}

/// All corruptions of the two TX40 records.
pub fn all() -> Vec<Corruption> {
    let mut all = scales();
    all.extend(signs_and_order());
    all.extend(ratios_and_lags());
    all.extend(samples());
    all.extend(values());
    all.extend(motion_and_filter());
    all.extend(beside());
    all
}

fn scales() -> Vec<Corruption> {
    use Code::{PositionScale, PositionZero, TorqueScale};
    vec![
        with("all positions in degrees, read as rad", PositionScale, None, |r| {
            r.position.values_mut().iter_mut().for_each(|q| *q = q.to_degrees());
        }),
        with("position 3 in degrees, read as rad", PositionScale, 3, |r| {
            scale(&mut r.position, 3, 1.0_f64.to_degrees())
        }),
        with("all positions in rad, read as degrees", PositionScale, None, |r| {
            r.position.values_mut().iter_mut().for_each(|q| *q = q.to_radians());
        }),
        with("positions 2 and 3 in degrees, read as rad", PositionScale, 2, |r| {
            (2..=3).for_each(|j| scale(&mut r.position, j, 1.0_f64.to_degrees()));
        }),
        with("positions 1 to 3 in rad, read as degrees", PositionScale, 1, |r| {
            (1..=3).for_each(|j| scale(&mut r.position, j, 1.0_f64.to_radians()));
        }),
        with("all positions of the motor side, read as of the joints", PositionScale, None, |r| {
            r.position = r.robot.transmission.motor_positions(&r.position);
        }),
        with("position 2 of the motor side, read as of the joint", PositionScale, 2, |r| {
            let motor = r.robot.transmission.motor_positions(&r.position).channel(1);
            set(&mut r.position, 2, |k, _| motor[k]);
        }),
        with("all positions of the joints, read as of the motor side", PositionScale, None, |r| {
            r.position = r.robot.transmission.joint_positions(&r.position);
        }),
        with("torque 3 of the motor side, read as of the joint", TorqueScale, 3, |r| {
            scale(&mut r.torque, 3, 1.0 / 45.0)
        }),
        with("offsets of positions 2 and 3 left out", PositionZero, None, |r| {
            let offset = r.robot.transmission.offset().to_vec();
            (1..=6).for_each(|j| set(&mut r.position, j, |_, q| q - offset[j - 1]));
        }),
    ]
}

fn signs_and_order() -> Vec<Corruption> {
    use Code::{JointsSwapped, PositionSign, TorqueSign};
    vec![
        with("torque 1 with the other sign", TorqueSign, 1, |r| scale(&mut r.torque, 1, -1.0)),
        with("torque 2 with the other sign", TorqueSign, 2, |r| scale(&mut r.torque, 2, -1.0)),
        with("torque 4 with the other sign", TorqueSign, 4, |r| scale(&mut r.torque, 4, -1.0)),
        with("torque 6 with the other sign", TorqueSign, 6, |r| scale(&mut r.torque, 6, -1.0)),
        with("all torques with the other sign", TorqueSign, None, |r| {
            r.torque.values_mut().iter_mut().for_each(|t| *t = -*t);
        }),
        with("position 3 with the other sign", PositionSign, 3, |r| scale(&mut r.position, 3, -1.0)),
        with("position 5 with the other sign", PositionSign, 5, |r| scale(&mut r.position, 5, -1.0)),
        with("torques 2 and 3 exchanged", JointsSwapped, None, |r| exchange(&mut r.torque, 2, 3)),
        with("torques 5 and 6 exchanged", JointsSwapped, None, |r| exchange(&mut r.torque, 5, 6)),
        with("positions 4 and 5 exchanged", JointsSwapped, None, |r| exchange(&mut r.position, 4, 5)),
        with("positions and torques 1 and 2 exchanged", JointsSwapped, None, |r| {
            exchange(&mut r.position, 1, 2);
            exchange(&mut r.torque, 1, 2);
        }),
        with("positions and torques 3 and 5 exchanged", JointsSwapped, None, |r| {
            exchange(&mut r.position, 3, 5);
            exchange(&mut r.torque, 3, 5);
        }),
        with("positions and torques 4 and 6 exchanged", JointsSwapped, None, |r| {
            exchange(&mut r.position, 4, 6);
            exchange(&mut r.torque, 4, 6);
        }),
    ]
}

/// The late shift of the suite's lags, samples.
pub const LATE: f64 = 60.3;

fn ratios_and_lags() -> Vec<Corruption> {
    use Code::{GearRatio, Lag};
    vec![
        with("gear ratio of motor 2 taken 25 % too large", GearRatio, 2, |r| wrong_ratio(r, 2, 1.25)),
        with("gear ratio of motor 3 taken 20 % too small", GearRatio, 3, |r| wrong_ratio(r, 3, 0.8)),
        with("position 3 taken 25 % too large", GearRatio, 3, |r| scale(&mut r.position, 3, 1.25)),
        with("drive gain of motor 2 taken 40 % too large", GearRatio, 2, |r| scale(&mut r.torque, 2, 1.4)),
        with("all torques 60.3 samples late", Lag, None, |r| (1..=6).for_each(|j| late(&mut r.torque, j, LATE))),
        with("all torques 60.3 samples early", Lag, None, |r| (1..=6).for_each(|j| late(&mut r.torque, j, -LATE))),
        with("torque 2 60.3 samples late", Lag, 2, |r| late(&mut r.torque, 2, LATE)),
    ]
}

fn samples() -> Vec<Corruption> {
    use Code::{ClockJitter, DroppedSamples, RepeatedSamples};
    vec![
        with("five samples missing, no time stamps", DroppedSamples, None, |r| {
            remove(r, &[6000, 12_100, 12_101, 20_000, 31_000]);
        }),
        with("three samples missing, seen in the time stamps", DroppedSamples, None, |r| {
            remove(r, &[5000, 14_000, 25_000]);
        })
        .given(Beside::TimeStamps),
        with("20 stretches of 5 samples that repeat the one before", RepeatedSamples, None, |r| {
            for start in (5000..33_000).step_by(1400) {
                (start..start + 5).for_each(|k| repeat(r, k));
            }
        }),
        with("torques recorded at a tenth of the rate and held", RepeatedSamples, None, |r| {
            (0..r.torque.len()).for_each(|k| {
                let held = r.torque.sample(k - k % 10).to_vec();
                r.torque.sample_mut(k).copy_from_slice(&held);
            });
        }),
        with("time stamps that vary by 15 % of a step", ClockJitter, None, |r| {
            let mut rng = ChaCha8Rng::seed_from_u64(3);
            let step = 1.0 / r.rate_hz;
            r.time_s.iter_mut().flatten().for_each(|t| *t += step * 0.2 * rng.random_range(-1.0..1.0));
            // The samples were taken at equal steps, and are brought to those that the stamps say.
            let stamps = r.time_s.clone().expect("the record has time stamps");
            let clock = Clock::from_stamps(stamps, 0.5, Path::new("record.csv"), "t").expect("the stamps are a clock");
            for series in [&mut r.position, &mut r.torque] {
                *series = clock.to_equal_steps(series.clone());
            }
        })
        .given(Beside::TimeStamps),
    ]
}

fn values() -> Vec<Corruption> {
    use Code::{
        PositionJump, PositionQuantised, PositionSpikes, TorqueConstant, TorqueIdle, TorqueQuantised, TorqueSaturated,
        TorqueSpikes,
    };
    vec![
        with("torque 2 limited to 60 % of its peak", TorqueSaturated, 2, |r| limit(&mut r.torque, 2, 0.6)),
        with("torque 4 limited to 80 % of its peak", TorqueSaturated, 4, |r| limit(&mut r.torque, 4, 0.8)),
        with("position 3 in steps of 1 degree", PositionQuantised, 3, |r| {
            quantise(&mut r.position, 3, 1_f64.to_radians())
        }),
        with("torque 1 in 12 steps of its range", TorqueQuantised, 1, |r| {
            let range = peak(&r.torque, 1) / 6.0;
            quantise(&mut r.torque, 1, range);
        }),
        with("torque 5 zero throughout", TorqueConstant, 5, |r| set(&mut r.torque, 5, |_, _| 0.0)),
        with("six outliers in position 2", PositionSpikes, 2, |r| {
            (0..6).for_each(|i| r.position.sample_mut(4000 + 5000 * i)[1] += 0.3);
        }),
        with("an encoder of joint 3 that slips by 0.1 rad", PositionJump, 3, |r| {
            set(&mut r.position, 3, |k, q| if k < 20_000 { q } else { q - 0.1 });
        }),
        with("torque 2 not recorded for 1.2 s", TorqueIdle, 2, |r| {
            let held = r.torque.sample(15_000)[1];
            set(&mut r.torque, 2, |k, tau| if (15_000..21_000).contains(&k) { held } else { tau });
        }),
        with("six outliers in torque 3", TorqueSpikes, 3, |r| {
            let size = 3.0 * peak(&r.torque, 3);
            (0..6).for_each(|i| r.torque.sample_mut(4000 + 5000 * i)[2] += size);
        }),
    ]
}

fn motion_and_filter() -> Vec<Corruption> {
    use Code::{CutoffHigh, CutoffLow, JointStill, NotExcited, PoorFit, StillPeriod};
    vec![
        with("position 6 stays at its first value", JointStill, 6, |r| {
            let first = r.position.sample(0)[5];
            set(&mut r.position, 6, |_, _| first);
        }),
        with("a rest of 1.5 s in the window", StillPeriod, None, |r| {
            let rest = r.signal.window.start + 20_000;
            insert_rest(r, rest, 7500);
        }),
        with("position filter at 4 Hz", CutoffLow, None, |r| r.signal.cutoff_hz = 4.0),
        with("position filter at 2000 Hz, every sample a row", CutoffHigh, None, |r| {
            (r.signal.cutoff_hz, r.signal.decimation) = (2000.0, 1);
        }),
        with("a window of one move", NotExcited, None, |r| r.signal.window = 1500..4200),
        with("joint 6 without motion, its parameters estimated", NotExcited, None, |r| {
            let first = r.position.sample(0)[5];
            set(&mut r.position, 6, |_, _| first);
        }),
        with("torques of another motion", PoorFit, None, |r| {
            let values: Vec<f64> = (0..r.torque.len()).rev().flat_map(|k| r.torque.sample(k).to_vec()).collect();
            r.torque = Series::shaped(6, values);
        }),
    ]
}

fn beside() -> Vec<Corruption> {
    use Code::{ReferenceMismatch, VelocityMismatch};
    vec![
        with("velocity 2 in degrees/s, read as rad/s", VelocityMismatch, 2, |r| {
            r.velocity.iter_mut().for_each(|v| scale(v, 2, 1.0_f64.to_degrees()));
        })
        .given(Beside::Velocities),
        with("velocities 1 and 4 exchanged", VelocityMismatch, 4, |r| {
            r.velocity.iter_mut().for_each(|v| exchange(v, 1, 4));
        })
        .given(Beside::Velocities),
        with("velocity 5 with the other sign", VelocityMismatch, 5, |r| {
            r.velocity.iter_mut().for_each(|v| scale(v, 5, -1.0));
        })
        .given(Beside::Velocities),
        with("velocity 3 60 samples late", VelocityMismatch, 3, |r| {
            r.velocity.iter_mut().for_each(|v| late(v, 3, 60.0));
        })
        .given(Beside::Velocities),
        with("references 2 and 3 exchanged", ReferenceMismatch, 2, |r| {
            r.reference.iter_mut().for_each(|v| exchange(v, 2, 3));
        })
        .given(Beside::Reference),
        with("references 30 ms early", ReferenceMismatch, 1, |r| {
            let samples = -0.03 * r.rate_hz;
            r.reference.iter_mut().for_each(|v| (1..=6).for_each(|j| late(v, j, samples)));
        })
        .given(Beside::Reference),
        with("moves reconstructed 0.1 rad off the motion", ReferenceMismatch, 1, |r| {
            r.reconstructed_deviation = Some(vec![0.1; 6]);
        }),
    ]
}

/// Corruptions that are not found, by name, and why.
pub struct Unseen {
    pub name: &'static str,
    pub why: &'static str,
    pub apply: fn(&mut Record),
}

/// What the checks do not see in the two TX40 records.
pub fn unseen() -> Vec<Unseen> {
    let by = |name, why, apply| Unseen { name, why, apply };
    vec![
        by(
            "torque 3 60.3 samples (12 ms) late",
            "the friction of joint 3 is twice the rest of its torque, and friction that follows no simple law looks like a lag",
            |r| late(&mut r.torque, 3, LATE),
        ),
        by(
            "all torques 30 % too large",
            "every parameter is 30 % larger and nothing contradicts it; compare the masses with a scale or with CAD",
            |r| (1..=6).for_each(|j| scale(&mut r.torque, j, 1.3)),
        ),
        by(
            "sample rate stated 20 % too low",
            "time is in inertia and friction alone, which take it up; gravity has none",
            |r| r.rate_hz *= 0.8,
        ),
        by(
            "zero of position 1 off by 30 degrees",
            "a vertical first axis has no zero: nothing depends on its position",
            |r| set(&mut r.position, 1, |_, q| q + 30.0_f64.to_radians()),
        ),
        by(
            "zero of position 3 off by 90 degrees",
            "the link's parameters in the turned frame explain nearly the same; it matters for their values alone",
            |r| set(&mut r.position, 3, |_, q| q - 90.0_f64.to_radians()),
        ),
        by(
            "zero of position 6 off by 40 degrees",
            "the last link's parameters in the turned frame are as good as the others",
            |r| set(&mut r.position, 6, |_, q| q + 40.0_f64.to_radians()),
        ),
        by(
            "position and torque 1 with the other sign",
            "the mirrored motion of a vertical axis fits the model nearly as well",
            |r| {
                scale(&mut r.position, 1, -1.0);
                scale(&mut r.torque, 1, -1.0);
            },
        ),
        by(
            "gear ratio of motor 4 taken 25 % too large",
            "the joint's torque is its own friction, which takes the ratio up; the coupling is below the noise",
            |r| wrong_ratio(r, 4, 1.25),
        ),
        by("all torques 15 samples (3 ms) late", "below what friction that is not quite a sign looks like", |r| {
            (1..=6).for_each(|j| late(&mut r.torque, j, 15.0))
        }),
        by(
            "torque 2 limited to 90 % of its peak, with noise of 0.1 N m on top",
            "a limit is recognised by samples at exactly one value",
            |r| {
                limit(&mut r.torque, 2, 0.9);
                let mut rng = ChaCha8Rng::seed_from_u64(5);
                let noise: Vec<f64> = (0..r.torque.len()).map(|_| 0.1 * rng.random_range(-1.0..1.0)).collect();
                set(&mut r.torque, 2, |k, t| t + noise[k]);
            },
        ),
        by(
            "one sample missing at slow motion",
            "the jump is below the noise and the steps of the positions; with time stamps it is found",
            |r| {
                let slow = slowest(r);
                remove(r, &[slow]);
            },
        ),
    ]
}

/// The sample of the window at which the joints are slowest.
fn slowest(record: &Record) -> usize {
    let velocity = record.own_velocity();
    let speed = |k: &usize| velocity.sample(*k).iter().map(|v| v.abs()).sum::<f64>();
    record.signal.window.clone().min_by(|a, b| speed(a).total_cmp(&speed(b))).unwrap()
}

/// Corruptions of a controller and of the drive signals that it gives.
pub fn of_controllers() -> Vec<Corruption> {
    use Code::ControllerMismatch;
    vec![
        with("a controller that acts 30 ms late", ControllerMismatch, 1, |r| {
            let sample_time_s = 1.0 / r.rate_hz;
            if let Some(c) = &mut r.controller {
                (c.delay_s, c.sample_time_s) = (0.03, sample_time_s);
            }
        }),
        with("a controller with a quarter of the position gain", ControllerMismatch, 1, |r| {
            controller(r, |c| {
                c.position_gain.iter_mut().for_each(|g| *g *= 0.25);
                c.bandwidth_hz.iter_mut().for_each(|b| *b *= 0.5);
            });
        }),
        with("drive signals with the other sign", ControllerMismatch, 1, |r| {
            r.torque.values_mut().iter_mut().for_each(|t| *t = -*t);
        }),
    ]
    .into_iter()
    .map(|c| c.given(Beside::Reference))
    .collect()
}

fn controller(record: &mut Record, change: fn(&mut ControllerDescription)) {
    record.controller.iter_mut().for_each(change);
}

impl Record {
    /// The record with what is recorded beside it.
    pub fn with(&self, beside: Beside) -> Self {
        let mut record = self.clone();
        match beside {
            Beside::Nothing => {}
            Beside::Velocities => record.velocity = Some(self.own_velocity()),
            Beside::TimeStamps => {
                record.time_s = Some((0..self.position.len()).map(|k| k as f64 / self.rate_hz).collect())
            }
            Beside::Reference => {
                let moves = self.moves.as_ref().map(|m| m.sample(self.rate_hz, self.position.len()).q);
                record.reference = record.reference.or(moves);
            }
        }
        record
    }
}

pub fn set(series: &mut Series, joint: usize, value: impl Fn(usize, f64) -> f64) {
    for k in 0..series.len() {
        let old = series.sample(k)[joint - 1];
        series.sample_mut(k)[joint - 1] = value(k, old);
    }
}

pub fn scale(series: &mut Series, joint: usize, factor: f64) {
    set(series, joint, |_, v| factor * v);
}

fn exchange(series: &mut Series, a: usize, b: usize) {
    (0..series.len()).for_each(|k| series.sample_mut(k).swap(a - 1, b - 1));
}

pub fn quantise(series: &mut Series, joint: usize, step: f64) {
    set(series, joint, |_, v| step * (v / step).round());
}

pub fn peak(series: &Series, joint: usize) -> f64 {
    series.channel(joint - 1).iter().fold(0.0, |m, v| v.abs().max(m))
}

pub fn limit(series: &mut Series, joint: usize, part: f64) {
    // Of a low percentile of the peak, so that the noise of single samples does not set it.
    let mut sizes: Vec<f64> = series.channel(joint - 1).iter().map(|v| v.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let most = part * sizes[sizes.len() * 995 / 1000];
    set(series, joint, |_, v| v.clamp(-most, most));
}

/// The channel later by so many samples, linear between samples, the ends held.
pub fn late(series: &mut Series, joint: usize, samples: f64) {
    let channel = series.channel(joint - 1);
    let last = channel.len() - 1;
    set(series, joint, |k, _| {
        let place = (k as f64 - samples).clamp(0.0, last as f64);
        let (before, part) = (place.floor() as usize, place - place.floor());
        channel[before] + part * (channel[(before + 1).min(last)] - channel[before])
    });
}

/// The record as read with another ratio of one motor.
pub fn wrong_ratio(record: &mut Record, motor: usize, factor: f64) {
    let right = &record.robot.transmission;
    let n = right.joints();
    let of = |i: usize| if i == motor - 1 { factor } else { 1.0 };
    let matrix = thetahat::Matrix::from_fn(n, n, |i, j| of(i) * right.matrix().at(i, j));
    let wrong = Transmission::new(matrix, right.offset().to_vec(), vec![1.0; n]).unwrap();
    record.position = wrong.joint_positions(&right.motor_positions(&record.position));
    record.torque = wrong.joint_torques(&right.drive_signals(&record.torque));
    record.robot.transmission = wrong;
}

pub fn remove(record: &mut Record, samples: &[usize]) {
    let keep: Vec<usize> = (0..record.position.len()).filter(|k| !samples.contains(k)).collect();
    let of = |series: &Series| {
        let values = keep.iter().flat_map(|&k| series.sample(k).to_vec()).collect();
        Series::shaped(series.channels(), values)
    };
    (record.position, record.torque) = (of(&record.position), of(&record.torque));
    record.time_s = record.time_s.take().map(|t| keep.iter().map(|&k| t[k]).collect());
    record.signal.window.end -= samples.len();
}

pub fn repeat(record: &mut Record, k: usize) {
    for series in [&mut record.position, &mut record.torque] {
        let before = series.sample(k - 1).to_vec();
        series.sample_mut(k).copy_from_slice(&before);
    }
}

/// The robot stops for a while where its joints come closest to rest, with the noise of a record.
pub fn insert_rest(record: &mut Record, after: usize, samples: usize) {
    let velocity = record.own_velocity();
    let speed = |k: usize| velocity.sample(k).iter().map(|v| v.abs()).sum::<f64>();
    let rest = (after..after + 4000).min_by(|a, b| speed(*a).total_cmp(&speed(*b))).unwrap();
    let insert = |series: &Series, noise: f64| {
        let mut rng = ChaCha8Rng::seed_from_u64(4);
        let mut values = series.values()[..rest * series.channels()].to_vec();
        for _ in 0..samples {
            values.extend(series.sample(rest).iter().map(|v| v + noise * rng.random_range(-1.0..1.0)));
        }
        values.extend_from_slice(&series.values()[rest * series.channels()..]);
        Series::shaped(series.channels(), values)
    };
    record.position = insert(&record.position, 1e-6);
    record.torque = insert(&record.torque, 0.01);
    record.signal.window.end += samples;
}
