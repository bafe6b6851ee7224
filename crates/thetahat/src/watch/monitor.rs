//! A robot watched sample by sample.

use std::{
    collections::VecDeque,
    f64::consts::TAU,
    path::{Path, PathBuf},
};

use super::{
    collision::{Bump, Collisions},
    drift::{Cause, Drift, FoundChange},
    error::WatchError,
    samples::Sample,
    settling::Settled,
    step::{Mean, NearRest, Step},
    subject::{Friction, PAYLOAD, Row, Scratch, WatchedRobot},
};
use thetahat_estimation::{signal::CausalBandPass, statistics::t_quantile};
use thetahat_model::robot::JointKind;
use thetahat_report::results::{
    JointResult, WatchChange, WatchCollision, WatchDrift, WatchEvent, WatchResidual, WatchSettled, WatchSummary,
};

/// Time of a step of the collision test, s.
const STEP_S: f64 = 0.01;
/// Shortest time of a block of the test for changes, s.
const BLOCK_S: f64 = 0.05;
/// Time between two tests for changes, s.
const TICK_S: f64 = 1.0;
/// Steps without a sample from which it is a gap.
const GAP: f64 = 1.5;
/// Part of a step that is no step.
const REPEATED: f64 = 0.1;
/// Part of a turn from which a step of an angle is a turn.
const TURN: f64 = 0.75;
/// Prior deviation of a change of friction, over friction.
const FRICTION: f64 = 0.3;
/// The least of it, over the deviation of a block's residual.
const LEAST: f64 = 2.0;
/// Prior deviation of a payload, kg, and of its distance, m.
const PAYLOAD_PRIOR: [f64; 2] = [1.0, 0.15];
/// Prior deviations of the baseline, over those of a change.
const BASELINE: f64 = 1.0;
/// Probability that an interval of several misses its value.
const MISSED: f64 = 0.05;
/// Degrees of freedom of a normal distribution.
const NORMAL: f64 = 1e6;
/// Deviations by which a joint's friction at its rms speed is another at the start.
const START_DEVIATIONS: f64 = 4.5;
/// Part of the friction by which it is another: less is the model's error.
const START_PART: f64 = 0.1;

/// How a robot is watched.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WatchOptions {
    /// Time in which baseline and noise are learned, s.
    pub settle_s: f64,
    /// False alarms per hour: half for collisions, half for changes.
    pub alarms_per_hour: f64,
    /// Time between two residuals, s; `None` for the summary's alone.
    pub every_s: Option<f64>,
}

impl Default for WatchOptions {
    fn default() -> Self {
        Self { settle_s: 30.0, alarms_per_hour: 0.01, every_s: None }
    }
}

impl WatchOptions {
    fn check(&self) -> Result<(), WatchError> {
        let refuse = |option, expected, found| Err(WatchError::Option { option, expected, found });
        if !(self.settle_s >= 5.0 && self.settle_s.is_finite()) {
            return refuse("--settle", "5 s or more", self.settle_s);
        }
        if !(self.alarms_per_hour > 0.0 && self.alarms_per_hour <= 60.0) {
            return refuse("--alarms-per-hour", "above 0 and at most 60", self.alarms_per_hour);
        }
        match self.every_s.filter(|every| !(*every >= 0.1 && every.is_finite())) {
            Some(every) => refuse("--every", "0.1 s or more", every),
            None => Ok(()),
        }
    }
}

/// A robot that is watched.
#[derive(Debug)]
pub struct Watch {
    robot: WatchedRobot,
    joints: Vec<JointResult>,
    options: WatchOptions,
    recording: PathBuf,
    input: Input,
    stage: Stage,
    step_s: f64,
    blocks_per_tick: usize,
    block: Mean,
    sums: ResidualSums,
    counts: Counts,
}

/// From samples to steps.
#[derive(Debug)]
struct Input {
    sample_s: f64,
    filter: CausalBandPass,
    /// Times and torques of the samples that the filter is late by.
    waiting: VecDeque<(f64, Vec<f64>)>,
    last: Option<(f64, Vec<f64>)>,
    /// Time stamp of the first sample, s.
    first_s: Option<f64>,
    /// Turns added to each angle.
    turns: Vec<f64>,
    is_angle: Vec<bool>,
    rest_velocity: Vec<f64>,
    scratch: Scratch,
    rows: Vec<Row>,
    motion: [Vec<f64>; 3],
    mean: Mean,
    near: NearRest,
}

#[derive(Debug)]
enum Stage {
    Settling(Vec<Step>),
    Watching(Box<Tests>),
}

#[derive(Debug)]
struct Tests {
    collisions: Collisions,
    drift: Drift,
}

#[derive(Debug, Clone, Copy, Default)]
struct Counts {
    time_s: f64,
    watched_s: f64,
    gaps: usize,
    incomplete: usize,
    collisions: usize,
    drifts: usize,
}

/// Sums of squares of each joint while it moves: residual, torque, count; of the whole time and since the last line.
#[derive(Debug, Clone)]
struct ResidualSums {
    whole: Vec<[f64; 3]>,
    since: Vec<[f64; 3]>,
    said_s: Option<f64>,
}

impl Watch {
    /// Watches a robot whose samples come at this rate; `recording` names them in messages.
    ///
    /// # Errors
    /// [`WatchError`] for options without sense, and for a filter that does not fit the rate.
    pub fn new(
        robot: WatchedRobot,
        sample_rate_hz: f64,
        options: WatchOptions,
        recording: &Path,
    ) -> Result<Self, WatchError> {
        options.check()?;
        let joints = robot.joints();
        let count = joints.len();
        let samples_per_step = (STEP_S * sample_rate_hz).round().max(1.0);
        let step_s = samples_per_step / sample_rate_hz;
        let period_s = 1.0 / robot.cutoff_hz(sample_rate_hz);
        let steps_per_block = (BLOCK_S.max(period_s) / step_s).ceil().max(1.0);
        let neighbours = (period_s / step_s).ceil() as usize;
        let input = Input {
            sample_s: 1.0 / sample_rate_hz,
            filter: robot.filter(sample_rate_hz)?,
            waiting: VecDeque::new(),
            last: None,
            first_s: None,
            turns: vec![0.0; count],
            is_angle: joints.iter().map(|joint| joint.kind == JointKind::Revolute).collect(),
            rest_velocity: robot.rest_velocity().to_vec(),
            scratch: robot.scratch(),
            rows: vec![Row::default(); count],
            motion: [vec![0.0; count], vec![0.0; count], vec![0.0; count]],
            mean: Mean::new(count, samples_per_step as usize),
            near: NearRest::new(count, neighbours),
        };
        Ok(Self {
            blocks_per_tick: (TICK_S / (steps_per_block * step_s)).round().max(1.0) as usize,
            block: Mean::new(count, steps_per_block as usize),
            robot,
            joints,
            options,
            recording: recording.to_owned(),
            input,
            stage: Stage::Settling(Vec::new()),
            step_s,
            sums: ResidualSums { whole: vec![[0.0; 3]; count], since: vec![[0.0; 3]; count], said_s: None },
            counts: Counts::default(),
        })
    }

    /// By how much events are late at least, s.
    #[must_use]
    pub fn delay_s(&self) -> f64 {
        self.input.filter.delay_samples() as f64 * self.input.sample_s
            + (self.input.near.neighbours() + 1) as f64 * self.step_s
    }

    /// Takes a sample; the events that it shows.
    ///
    /// # Errors
    /// [`WatchError::NoMotion`] at the end of settling.
    pub fn push(&mut self, sample: &Sample) -> Result<Vec<WatchEvent>, WatchError> {
        if sample.time_s.is_finite() {
            self.counts.time_s = sample.time_s - *self.input.first_s.get_or_insert(sample.time_s);
        }
        match self.input.take(&self.robot, sample) {
            Taken::Step(step) => self.step(&step),
            Taken::Nothing => Ok(Vec::new()),
            Taken::Incomplete => {
                self.counts.incomplete += 1;
                Ok(Vec::new())
            }
            Taken::AfterGap => {
                self.counts.gaps += 1;
                self.restart();
                Ok(Vec::new())
            }
        }
    }

    fn restart(&mut self) {
        self.block.restart();
        match &mut self.stage {
            Stage::Settling(steps) => steps.clear(),
            Stage::Watching(tests) => {
                tests.collisions.restart();
                tests.drift.leave_out();
            }
        }
    }

    fn step(&mut self, step: &Step) -> Result<Vec<WatchEvent>, WatchError> {
        let mut events = Vec::new();
        match &mut self.stage {
            Stage::Settling(steps) => {
                steps.push(step.clone());
                if steps.len() as f64 * self.step_s >= self.options.settle_s {
                    let steps = std::mem::take(steps);
                    events = self.settle(&steps)?;
                }
                return Ok(events);
            }
            Stage::Watching(tests) => {
                let Tests { collisions, drift } = tests.as_mut();
                self.counts.watched_s += self.step_s;
                self.sums.add(step);
                let bump = collisions.push(step, drift.running());
                if collisions.disturbs() {
                    drift.leave_out();
                    self.block.restart();
                } else if let Some(block) = self.block.push(step.time_s, &step.rows, |j| step.rest[j]) {
                    let found = drift.push(&block);
                    self.counts.drifts += usize::from(found.is_some());
                    events.extend(found.map(|found| WatchEvent::Drift(self.of_drift(&found))));
                }
                self.counts.collisions += usize::from(bump.is_some());
                events.extend(bump.map(|bump| WatchEvent::Collision(self.of_bump(&bump))));
            }
        }
        if let Some(every_s) = self.options.every_s {
            let time_s = self.counts.time_s;
            if self.sums.said_s.is_none_or(|said| time_s - said >= every_s) {
                let said = self.sums.said_s.replace(time_s);
                let residual = self.sums.residual_since(time_s);
                events.extend(said.map(|_| WatchEvent::Residual(residual)));
            }
        }
        Ok(events)
    }

    /// Learns baseline and noise, and begins to watch.
    fn settle(&mut self, steps: &[Step]) -> Result<Vec<WatchEvent>, WatchError> {
        let mut blocks = Vec::new();
        for step in steps {
            blocks.extend(self.block.push(step.time_s, &step.rows, |j| step.rest[j]));
        }
        self.block.restart();
        let prior = self.prior(&blocks);
        let before: Vec<f64> = prior.iter().map(|deviation| BASELINE * deviation).collect();
        let no_motion = || WatchError::NoMotion { path: self.recording.clone(), settle_s: self.options.settle_s };
        let settled = Settled::of(&blocks, self.blocks_per_tick, &before).ok_or_else(no_motion)?;
        if settled.noise.iter().all(Option::is_none) {
            return Err(no_motion());
        }
        let per_alarm = 2.0 * 3600.0 / self.options.alarms_per_hour;
        let tests = per_alarm * self.joints.len() as f64 / self.step_s;
        let coulomb: Vec<f64> =
            (0..self.joints.len()).map(|j| self.robot.friction(j).coulomb.map_or(0.0, |[value, _]| value)).collect();
        let collisions = Collisions::of(steps, &settled.baseline, &coulomb, self.step_s, tests.ln());
        let tests = per_alarm * Cause::all(self.joints.len()).len() as f64 / TICK_S;
        let drift = Drift::new(settled, prior, self.blocks_per_tick, tests.ln());
        let mut events = vec![WatchEvent::Settled(WatchSettled {
            first_s: self.input.first_s.unwrap_or(0.0),
            time_s: self.counts.time_s,
            delay_s: self.delay_s(),
            deviation: collisions.deviations(),
            inflation: drift.noise().iter().map(|noise| noise.map(|noise| noise.inflation)).collect(),
            alarms_per_hour: self.options.alarms_per_hour,
        })];
        events.extend(self.starts(&drift, &blocks).into_iter().map(WatchEvent::Start));
        self.counts.drifts += events.len() - 1;
        self.stage = Stage::Watching(Box::new(Tests { collisions, drift }));
        Ok(events)
    }

    /// Prior deviations of all changes.
    fn prior(&self, blocks: &[Step]) -> Vec<f64> {
        let mut prior = Vec::new();
        for j in 0..self.joints.len() {
            let moving = blocks.iter().filter(|block| !block.rest[j]).map(|block| &block.rows[j]);
            let [squares, speeds, count] =
                moving.fold([0.0, 0.0, 1e-9], |[y, v, n], row| [y + row.y.powi(2), v + row.x[0].powi(2), n + 1.0]);
            let least = LEAST * (squares / count).sqrt() + f64::MIN_POSITIVE;
            let speed = (speeds / count).sqrt().max(1e-6);
            let friction = self.robot.friction(j);
            let part = |of: Option<[f64; 2]>| FRICTION * of.map_or(0.0, |[value, _]| value.abs());
            let coulomb = part(friction.coulomb).max(least);
            prior.extend([part(friction.viscous).max(least / speed), coulomb, coulomb]);
        }
        let [mass, centre] = PAYLOAD_PRIOR;
        prior.extend([mass, mass * centre, mass * centre, mass * centre]);
        prior.extend([mass * centre * centre; PAYLOAD.len() - 4]);
        prior
    }

    /// Friction that is another at the start than the identified one, at the rms of each joint's speed.
    fn starts(&self, drift: &Drift, blocks: &[Step]) -> Vec<WatchDrift> {
        let (baseline, covariance) = drift.first();
        let mut starts = Vec::new();
        for j in (0..self.joints.len()).filter(|&j| drift.noise()[j].is_some()) {
            let Friction { viscous: Some([fv, of_fv]), coulomb: Some([fc, of_fc]) } = self.robot.friction(j) else {
                continue;
            };
            let moving = blocks.iter().filter(|block| !block.rest[j]).map(|block| block.rows[j].x[0].powi(2));
            let [squares, count] = moving.fold([0.0, 1e-9], |[sum, n], square| [sum + square, n + 1.0]);
            let speed = (squares / count).sqrt();
            let places = Cause::Friction(j).parameters(self.joints.len());
            let [v, c] = [places[0], places[1]];
            let variance = speed * speed * (covariance.at(v, v) + of_fv * of_fv) + covariance.at(c, c) + of_fc * of_fc;
            let deviation = (variance + 2.0 * speed * covariance.at(v, c)).max(0.0).sqrt();
            let torque = (speed * baseline[v] + baseline[c]).abs();
            if torque > START_DEVIATIONS * deviation && torque > START_PART * (speed * fv + fc).abs() {
                let deviations = [covariance.at(v, v), covariance.at(c, c)].map(f64::sqrt);
                let deviations = [deviations[0].hypot(of_fv), deviations[1].hypot(of_fc)];
                starts.push(WatchDrift {
                    time_s: self.counts.time_s,
                    began_s: 0.0,
                    cause: self.words(Cause::Friction(j)),
                    rivals: Vec::new(),
                    changes: self.changes(&places, &[baseline[v], baseline[c]], &deviations, places.len()),
                    evidence: 0.5 * (torque / deviation).powi(2),
                });
            }
        }
        starts
    }

    fn of_bump(&self, bump: &Bump) -> WatchCollision {
        let joint = &self.joints[bump.joint];
        WatchCollision {
            time_s: self.counts.time_s,
            began_s: bump.began_s,
            joint: bump.joint + 1,
            torque: bump.torque,
            unit: joint.torque_unit.clone(),
            label: joint.label(bump.joint + 1),
        }
    }

    fn of_drift(&self, found: &FoundChange) -> WatchDrift {
        let places = found.cause.parameters(self.joints.len());
        WatchDrift {
            time_s: self.counts.time_s,
            began_s: found.began_s,
            cause: self.words(found.cause),
            rivals: found.rivals.iter().map(|cause| self.words(*cause)).collect(),
            changes: self.changes(&places, &found.ratio.changes, &found.ratio.deviations, places.len()),
            evidence: found.ratio.log,
        }
    }

    fn words(&self, cause: Cause) -> String {
        match cause {
            Cause::Friction(j) => format!("friction of {}", self.joints[j].label(j + 1)),
            Cause::Offset(j) => format!("offset of {}", self.joints[j].label(j + 1)),
            Cause::Payload => "payload".to_owned(),
        }
    }

    /// Changes at some places with intervals that hold all of so many.
    fn changes(&self, places: &[usize], changes: &[f64], deviations: &[f64], together: usize) -> Vec<WatchChange> {
        let half = t_quantile(1.0 - 0.5 * MISSED / together as f64, NORMAL).unwrap_or(f64::INFINITY);
        let of = |((place, change), deviation): ((&usize, &f64), &f64)| {
            let (parameter, unit, identified) = self.named(*place);
            WatchChange {
                parameter,
                unit,
                change: *change,
                interval_95: [change - half * deviation, change + half * deviation],
                percent: identified.filter(|value| *value != 0.0).map(|value| 100.0 * change / value),
            }
        };
        places.iter().zip(changes).zip(deviations).map(of).collect()
    }

    /// Name, unit and identified value of a change.
    fn named(&self, place: usize) -> (String, String, Option<f64>) {
        let (joint, change) = (place / 3, place % 3);
        let Some(of_joint) = self.joints.get(joint) else {
            let payload = place - 3 * self.joints.len();
            let unit = ["kg", "kg m", "kg m^2"][payload.div_ceil(3).min(2)];
            return (PAYLOAD[payload].to_owned(), unit.to_owned(), None);
        };
        let friction = self.robot.friction(joint);
        let value = |of: Option<[f64; 2]>| of.map(|[value, _]| value);
        let (torque, number) = (&of_joint.torque_unit, joint + 1);
        match change {
            0 => {
                let per_speed = if of_joint.kind == JointKind::Revolute { "N m s/rad" } else { "N s/m" };
                (format!("fv{number}"), per_speed.to_owned(), value(friction.viscous))
            }
            1 => (format!("fc{number}"), torque.clone(), value(friction.coulomb)),
            _ => (format!("off{number}"), torque.clone(), None),
        }
    }

    /// The end of the recording.
    ///
    /// # Errors
    /// [`WatchError::TooShort`] if watching has not begun.
    pub fn finish(mut self) -> Result<WatchSummary, WatchError> {
        let Counts { time_s, watched_s, gaps, incomplete, collisions, drifts } = self.counts;
        let Stage::Watching(tests) = &self.stage else {
            let needed_s = self.options.settle_s + self.delay_s();
            return Err(WatchError::TooShort { path: self.recording, found_s: time_s, needed_s });
        };
        let (changes, deviations) = tests.drift.changes();
        let is_known = |place: &usize| {
            tests.drift.noise().get(place / 3).is_none_or(Option::is_some)
                && (place / 3 < self.joints.len() || changes[*place] != 0.0)
        };
        let places: Vec<usize> = (0..changes.len()).filter(is_known).collect();
        let one = |place: &usize| self.changes(&[*place], &[changes[*place]], &[deviations[*place]], places.len());
        let changes = places.iter().flat_map(one).collect();
        self.sums.since = self.sums.whole.clone();
        let residual = self.sums.residual_since(time_s);
        let joints = self.joints;
        Ok(WatchSummary { time_s, watched_s, gaps, incomplete, collisions, drifts, residual, changes, joints })
    }
}

impl ResidualSums {
    fn add(&mut self, step: &Step) {
        for (j, row) in step.rows.iter().enumerate().filter(|(j, _)| !step.rest[*j]) {
            for sums in [&mut self.whole[j], &mut self.since[j]] {
                sums.iter_mut().zip([row.y * row.y, row.square, 1.0]).for_each(|(sum, value)| *sum += value);
            }
        }
    }

    fn residual_since(&mut self, time_s: f64) -> WatchResidual {
        let since = std::mem::replace(&mut self.since, vec![[0.0; 3]; self.whole.len()]);
        let rms = |[square, _, count]: &[f64; 3]| (*count > 0.0).then(|| (square / count).sqrt());
        let percent = |[square, torque, _]: &[f64; 3]| (*torque > 0.0).then(|| 100.0 * (square / torque).sqrt());
        WatchResidual { time_s, rms: since.iter().map(rms).collect(), percent: since.iter().map(percent).collect() }
    }
}

enum Taken {
    Nothing,
    Step(Step),
    Incomplete,
    AfterGap,
}

impl Input {
    fn take(&mut self, robot: &WatchedRobot, sample: &Sample) -> Taken {
        let is_complete = sample.position.iter().chain(&sample.torque).all(|value| value.is_finite());
        if !is_complete || !sample.time_s.is_finite() {
            return Taken::Incomplete;
        }
        let step_s = self.last.as_ref().map_or(self.sample_s, |(time_s, _)| sample.time_s - time_s);
        if step_s.abs() < REPEATED * self.sample_s {
            return Taken::Incomplete;
        }
        let is_gap = !(0.0..GAP * self.sample_s).contains(&step_s);
        if is_gap {
            self.restart();
        }
        let position = self.unwrapped(&sample.position);
        self.last = Some((sample.time_s, sample.position.clone()));
        self.waiting.push_back((sample.time_s - self.first_s.unwrap_or(0.0), sample.torque.clone()));
        let [q, dq, ddq] = &mut self.motion;
        if !self.filter.push(&position, [q, dq, ddq]) {
            if self.waiting.len() > self.filter.delay_samples() {
                self.waiting.pop_front();
            }
            return if is_gap { Taken::AfterGap } else { Taken::Nothing };
        }
        let Some((time_s, torque)) = self.waiting.pop_front() else { return Taken::Nothing };
        robot.rows([&self.motion[0], &self.motion[1], &self.motion[2]], &torque, &mut self.scratch, &mut self.rows);
        let (dq, limits) = (&self.motion[1], &self.rest_velocity);
        let step = self.mean.push(time_s, &self.rows, |j| dq[j].abs() < limits[j]);
        step.and_then(|step| self.near.push(step)).map_or(Taken::Nothing, Taken::Step)
    }

    fn restart(&mut self) {
        self.filter.restart();
        self.waiting.clear();
        self.mean.restart();
        self.near.restart();
    }

    /// The positions with the turns that angles lost.
    fn unwrapped(&mut self, position: &[f64]) -> Vec<f64> {
        if let Some((_, last)) = &self.last {
            let angles = self.turns.iter_mut().zip(&self.is_angle).zip(position.iter().zip(last));
            for ((turns, _), (now, before)) in angles.filter(|((_, is_angle), _)| **is_angle) {
                if (now - before).abs() > TURN * TAU {
                    *turns -= TAU * (now - before).signum();
                }
            }
        }
        position.iter().zip(&self.turns).map(|(value, turns)| value + turns).collect()
    }
}
