//! From samples to steps: positions filtered, torques late by as much.

use std::{collections::VecDeque, f64::consts::TAU};

use super::{
    error::WatchError,
    samples::Sample,
    step::{Mean, NearRest, Row, Step},
    subject::{Scratch, WatchedRobot},
};
use thetahat_estimation::signal::CausalBandPass;
use thetahat_model::robot::JointKind;

/// Steps without a sample from which it is a gap.
const GAP: f64 = 1.5;
/// Part of a step that is no step.
const REPEATED: f64 = 0.1;
/// Part of a turn from which a step of an angle is a turn.
const TURN: f64 = 0.75;
/// From samples to steps.
#[derive(Debug)]
pub(super) struct Input {
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

/// What a sample gives.
pub(super) enum Taken {
    Nothing,
    Step(Step),
    Incomplete,
    AfterGap,
}

impl Input {
    /// For samples at a rate, so many of them in a step.
    pub(super) fn new(robot: &WatchedRobot, sample_rate_hz: f64, samples_per_step: usize) -> Result<Self, WatchError> {
        let (joints, layout) = (robot.joints(), robot.layout());
        let count = joints.len();
        let step_s = samples_per_step as f64 / sample_rate_hz;
        let neighbours = (1.0 / robot.cutoff_hz(sample_rate_hz) / step_s).ceil() as usize;
        Ok(Self {
            sample_s: 1.0 / sample_rate_hz,
            filter: robot.filter(sample_rate_hz)?,
            waiting: VecDeque::new(),
            last: None,
            first_s: None,
            turns: vec![0.0; count],
            is_angle: joints.iter().map(|joint| joint.kind == JointKind::Revolute).collect(),
            rest_velocity: robot.rest_velocity().to_vec(),
            scratch: robot.scratch(),
            rows: vec![Row::zeros(layout.of_joint()); count],
            motion: [vec![0.0; count], vec![0.0; count], vec![0.0; count]],
            mean: Mean::new(layout, samples_per_step),
            near: NearRest::new(count, neighbours),
        })
    }

    /// By how much steps are late, s.
    pub(super) fn delay_s(&self) -> f64 {
        let samples = self.filter.delay_samples() + (self.near.neighbours() + 1) * self.mean.length();
        samples as f64 * self.sample_s
    }

    /// Time of a sample, s.
    pub(super) fn sample_s(&self) -> f64 {
        self.sample_s
    }

    /// Time stamp of the first sample, s.
    pub(super) fn first_s(&self) -> f64 {
        self.first_s.unwrap_or(0.0)
    }

    /// The time since the first sample, s.
    pub(super) fn since_first_s(&mut self, sample: &Sample) -> Option<f64> {
        let time_s = Some(sample.time_s).filter(|time_s| time_s.is_finite())?;
        Some(time_s - *self.first_s.get_or_insert(time_s))
    }

    pub(super) fn take(&mut self, robot: &WatchedRobot, sample: &Sample) -> Taken {
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
        self.waiting.push_back((sample.time_s - self.first_s(), sample.torque.clone()));
        let [q, dq, ddq] = &mut self.motion;
        if !self.filter.push(&position, [q, dq, ddq]) {
            if self.waiting.len() > self.filter.delay_samples() {
                self.waiting.pop_front();
            }
            return if is_gap { Taken::AfterGap } else { Taken::Nothing };
        }
        let Some((time_s, torque)) = self.waiting.pop_front() else { return Taken::Nothing };
        let [q, dq, ddq] = &self.motion;
        robot.rows([q, dq, ddq], &torque, self.sample_s, &mut self.scratch, &mut self.rows);
        let limits = &self.rest_velocity;
        let step = self.mean.push(time_s, &self.rows, |j| dq[j].abs() < limits[j]);
        step.and_then(|step| self.near.push(step)).map_or(Taken::Nothing, Taken::Step)
    }

    fn restart(&mut self) {
        self.filter.restart();
        self.scratch.restart();
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
