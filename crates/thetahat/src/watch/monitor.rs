//! A robot watched sample by sample.

use std::path::{Path, PathBuf};

use super::{
    belief::Belief,
    collision::{Collisions, Known},
    drift::{Cause, Drift},
    error::WatchError,
    input::{Input, Taken},
    layout::OWN,
    options::WatchOptions,
    residual::ResidualSums,
    samples::Sample,
    settling::Settled,
    start::starts,
    step::{Mean, Step},
    subject::WatchedRobot,
    words::Words,
};
use thetahat_report::results::{JointResult, WatchEvent, WatchSettled, WatchSummary};

/// Time of a step of the collision test, s.
const STEP_S: f64 = 0.01;
/// Shortest time of a block of the test for changes, s.
const BLOCK_S: f64 = 0.05;
/// Time between two tests for changes, s.
const TICK_S: f64 = 1.0;

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
        let samples_per_step = (STEP_S * sample_rate_hz).round().max(1.0);
        let step_s = samples_per_step / sample_rate_hz;
        let steps_per_block = (BLOCK_S.max(1.0 / robot.cutoff_hz(sample_rate_hz)) / step_s).ceil().max(1.0);
        Ok(Self {
            blocks_per_tick: (TICK_S / (steps_per_block * step_s)).round().max(1.0) as usize,
            block: Mean::new(robot.layout(), steps_per_block as usize),
            input: Input::new(&robot, sample_rate_hz, samples_per_step as usize)?,
            joints: robot.joints(),
            sums: ResidualSums::new(robot.joint_count()),
            robot,
            options,
            recording: recording.to_owned(),
            stage: Stage::Settling(Vec::new()),
            step_s,
            counts: Counts::default(),
        })
    }

    /// By how much events are late at least, s.
    #[must_use]
    pub fn delay_s(&self) -> f64 {
        self.input.delay_s()
    }

    /// Takes a sample; the events that it shows.
    ///
    /// # Errors
    /// [`WatchError::NoMotion`] at the end of settling.
    pub fn push(&mut self, sample: &Sample) -> Result<Vec<WatchEvent>, WatchError> {
        self.counts.time_s = self.input.since_first_s(sample).unwrap_or(self.counts.time_s);
        match self.input.take(&self.robot, sample) {
            Taken::Step(step) => self.step(step),
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

    fn step(&mut self, step: Step) -> Result<Vec<WatchEvent>, WatchError> {
        match &mut self.stage {
            Stage::Settling(steps) => {
                steps.push(step);
                // Rounded, as a rate from stamps is not exact.
                if (steps.len() as f64) < (self.options.settle_s / self.step_s).round() {
                    return Ok(Vec::new());
                }
                let steps = std::mem::take(steps);
                self.settle(&steps)
            }
            Stage::Watching(_) => Ok(self.watch(&step)),
        }
    }

    fn words(&self) -> Words<'_> {
        Words { robot: &self.robot, joints: &self.joints, time_s: self.counts.time_s }
    }

    /// The events of a step after settling.
    fn watch(&mut self, step: &Step) -> Vec<WatchEvent> {
        let Stage::Watching(tests) = &mut self.stage else { return Vec::new() };
        let Tests { collisions, drift } = tests.as_mut();
        let (mut events, mut found) = (Vec::new(), None);
        self.counts.watched_s += self.step_s;
        self.sums.add(step);
        let bump = collisions.push(step, drift.running());
        if collisions.disturbs() {
            drift.leave_out();
            self.block.restart();
        } else if let Some(block) = self.block.push(step.time_s, &step.rows, |j| step.rest[j]) {
            found = drift.push(&block);
        }
        self.counts.drifts += usize::from(found.is_some());
        self.counts.collisions += usize::from(bump.is_some());
        events.extend(found.map(|found| WatchEvent::Drift(self.words().drift(&found))));
        events.extend(bump.map(|bump| WatchEvent::Collision(self.words().bump(&bump))));
        let due = self.options.every_s.and_then(|every_s| self.sums.due(self.counts.time_s, every_s));
        events.extend(due.map(WatchEvent::Residual));
        events
    }

    /// Learns baseline and noise, and begins to watch.
    fn settle(&mut self, steps: &[Step]) -> Result<Vec<WatchEvent>, WatchError> {
        let blocks: Vec<Step> =
            steps.iter().filter_map(|step| self.block.push(step.time_s, &step.rows, |j| step.rest[j])).collect();
        self.block.restart();
        let (layout, belief) = (self.robot.layout(), Belief::of(&self.robot, self.input.sample_s(), &blocks));
        let no_motion = || WatchError::NoMotion { path: self.recording.clone(), settle_s: self.options.settle_s };
        let settled = Settled::of(layout, &blocks, self.blocks_per_tick, self.robot.rest_velocity(), &belief.baseline);
        let settled = settled.ok_or_else(no_motion)?;
        if settled.noise.iter().all(Option::is_none) {
            return Err(no_motion());
        }
        let per_alarm = 2.0 * 3600.0 / self.options.alarms_per_hour;
        let tests = per_alarm * layout.joints as f64 / self.step_s;
        let coulomb = |j| self.robot.friction(j).coulomb.map_or(0.0, |[value, _]| value);
        let coulomb: Vec<f64> = (0..layout.joints).map(coulomb).collect();
        let known = Known { coulomb: &coulomb, delay_s: belief.delay_s, step_s: self.step_s };
        let collisions = Collisions::of(layout, steps, &settled.baseline, known, tests.ln());
        let tests = per_alarm * Cause::all(layout.joints).len() as f64 / TICK_S;
        let drift = Drift::new(layout, settled, belief, self.blocks_per_tick, tests.ln());
        let mut events = vec![WatchEvent::Settled(WatchSettled {
            first_s: self.input.first_s(),
            time_s: self.counts.time_s,
            delay_s: self.delay_s(),
            deviation: collisions.deviations(),
            inflation: drift.noise().iter().map(|noise| noise.map(|noise| noise.inflation)).collect(),
            alarms_per_hour: self.options.alarms_per_hour,
        })];
        events.extend(starts(&self.words(), &drift, &blocks).into_iter().map(WatchEvent::Start));
        self.counts.drifts += events.len() - 1;
        self.stage = Stage::Watching(Box::new(Tests { collisions, drift }));
        Ok(events)
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
            tests.drift.noise().get(place / OWN).is_none_or(Option::is_some)
                && (place / OWN < self.joints.len() || changes[*place] != 0.0)
        };
        let places: Vec<usize> = (0..self.robot.layout().said()).filter(is_known).collect();
        let one =
            |place: &usize| self.words().changes(&[*place], &[changes[*place]], &[deviations[*place]], places.len());
        let changes = places.iter().flat_map(one).collect();
        let residual = self.sums.whole(time_s);
        let joints = self.joints;
        Ok(WatchSummary { time_s, watched_s, gaps, incomplete, collisions, drifts, residual, changes, joints })
    }
}
