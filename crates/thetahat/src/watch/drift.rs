//! Lasting changes: of a joint's friction or offset, or of a payload at the last link.

use std::collections::VecDeque;

use super::{
    likelihood::{Ratio, Sums, Unexplained, of_joint, place, posterior},
    settling::{BlockNoise, Settled, Whitening},
    step::Step,
    subject::{CHANGES, PAYLOAD},
};
use thetahat_ground::linear_algebra::Matrix;

/// Seconds that a ratio looks back: one alone may hold the instant of the change.
const LENGTHS: [usize; 15] = [2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 192, 256];
/// The ratio over others by which a cause explains better: twenty to one.
const BETTER: f64 = 3.0;
/// Part of the prior deviation that a payload's mass keeps where the motion does not show it.
const UNKNOWN: f64 = 0.5;
/// What earlier seconds count for in the baseline, each time that as many as a ratio looks back have passed.
const FORGOTTEN: f64 = 0.5;

/// What can change.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Cause {
    /// Friction of a joint, from zero.
    Friction(usize),
    /// Offset of a joint's torque.
    Offset(usize),
    /// A payload at the last link.
    Payload,
}

impl Cause {
    /// All causes of a robot.
    pub(super) fn all(joints: usize) -> Vec<Self> {
        let of_joints = (0..joints).flat_map(|j| [Self::Friction(j), Self::Offset(j)]);
        of_joints.chain([Self::Payload]).collect()
    }

    /// Its parameters among the changes of a robot.
    pub(super) fn parameters(self, joints: usize) -> Vec<usize> {
        match self {
            Self::Friction(j) => vec![place(joints, j, 0), place(joints, j, 1)],
            Self::Offset(j) => vec![place(joints, j, 2)],
            Self::Payload => (3..CHANGES).map(|change| place(joints, 0, change)).collect(),
        }
    }
}

impl Cause {
    /// Whether the changes can be of the cause: a payload whose mass is known has one, by two deviations.
    fn is_possible(self, ratio: &Ratio, prior: &[f64]) -> bool {
        match self {
            Self::Friction(_) | Self::Offset(_) => true,
            Self::Payload => {
                let (mass, deviation) = (ratio.changes[0], ratio.deviations[0]);
                let prior = prior[prior.len() - PAYLOAD.len()];
                mass.abs() > 2.0 * deviation || deviation > UNKNOWN * prior
            }
        }
    }
}

/// The test of all causes.
#[derive(Debug, Clone)]
pub(super) struct Drift {
    /// The changes from the identified model that are taken for no news, and their precision.
    baseline: Vec<f64>,
    precision: Matrix,
    /// The changes by the baseline and the seconds since.
    running: Vec<f64>,
    /// The baseline when watching began, and its covariance.
    first: (Vec<f64>, Matrix),
    noise: Vec<Option<BlockNoise>>,
    whitening: Whitening,
    causes: Vec<Cause>,
    /// Prior deviations of changes.
    prior: Vec<f64>,
    /// Logarithm of the ratio from which a change is said.
    threshold: f64,
    blocks_per_tick: usize,
    /// The second that goes on, with its blocks and its beginning.
    current: Tick,
    blocks: usize,
    /// The last second, which counts when no event began in it.
    last: Option<Tick>,
    ticks: VecDeque<Tick>,
    /// Whether the threshold was passed a second ago.
    waits: bool,
}

#[derive(Debug, Clone)]
struct Tick {
    sums: Sums,
    began_s: f64,
}

/// A change that is said.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct FoundChange {
    pub(super) began_s: f64,
    pub(super) cause: Cause,
    pub(super) rivals: Vec<Cause>,
    pub(super) ratio: Ratio,
}

impl Drift {
    pub(super) fn new(settled: Settled, prior: Vec<f64>, blocks_per_tick: usize, threshold: f64) -> Self {
        let Settled { baseline, precision, noise } = settled;
        let joints = noise.len();
        Self {
            first: (baseline.clone(), inverse(&precision)),
            running: baseline.clone(),
            baseline,
            precision,
            whitening: Whitening::new(joints),
            causes: Cause::all(joints),
            noise,
            prior,
            threshold,
            blocks_per_tick,
            current: Tick { sums: Sums::zeros(joints), began_s: 0.0 },
            blocks: 0,
            last: None,
            ticks: VecDeque::new(),
            waits: false,
        }
    }

    /// The changes from the identified model by all seconds until now.
    pub(super) fn running(&self) -> &[f64] {
        &self.running
    }

    /// The changes from the identified model when watching began, with their covariance.
    pub(super) fn first(&self) -> (&[f64], &Matrix) {
        (&self.first.0, &self.first.1)
    }

    pub(super) fn noise(&self) -> &[Option<BlockNoise>] {
        &self.noise
    }

    /// The changes since watching began, and their deviations.
    pub(super) fn changes(&self) -> (Vec<f64>, Vec<f64>) {
        let (since, precision) = posterior(&self.precision, &self.sums_of(self.ticks.len()))
            .unwrap_or_else(|| (vec![0.0; self.baseline.len()], self.precision.clone()));
        let (first, of_first) = &self.first;
        let all = self.baseline.iter().zip(&since).zip(first).map(|((a, b), c)| a + b - c).collect();
        let covariance = inverse(&precision).plus(of_first, 1.0);
        (all, (0..covariance.columns()).map(|i| covariance.at(i, i).max(0.0).sqrt()).collect())
    }

    /// Leaves the last seconds out, as after a gap or while an event disturbs.
    pub(super) fn leave_out(&mut self) {
        self.last = None;
        self.start_tick();
        self.whitening = Whitening::new(self.noise.len());
    }

    fn start_tick(&mut self) {
        self.current = Tick { sums: Sums::zeros(self.noise.len()), began_s: 0.0 };
        self.blocks = 0;
    }

    /// Takes a block; a change that it shows.
    pub(super) fn push(&mut self, block: &Step) -> Option<FoundChange> {
        for (j, noise) in self.noise.iter().enumerate() {
            let Some(noise) = noise else { continue };
            let Some(mut row) = self.whitening.push(j, block, noise.correlation) else { continue };
            row.y -= row.torque(&of_joint(&self.baseline, j));
            self.current.sums.add_row(j, &row, noise.deviation.powi(-2));
        }
        if self.blocks == 0 {
            self.current.began_s = block.time_s;
        }
        self.blocks += 1;
        if self.blocks < self.blocks_per_tick {
            return None;
        }
        let last = self.last.replace(self.current.clone());
        self.start_tick();
        self.ticks.extend(last);
        let found = self.test();
        match &found {
            Some(found) => self.take(found),
            None => self.forget(),
        }
        self.running.clone_from(&self.baseline);
        if let Some((since, _)) = posterior(&self.precision, &self.sums_of(self.ticks.len())) {
            self.running.iter_mut().zip(&since).for_each(|(all, change)| *all += change);
        }
        found
    }

    /// The sums of the last seconds.
    fn sums_of(&self, length: usize) -> Sums {
        let mut sums = Sums::zeros(self.noise.len());
        self.ticks.iter().rev().take(length).for_each(|tick| sums.add(&tick.sums));
        sums
    }

    /// A change, one second after its ratio passed the threshold: from the seconds after the one that holds its instant.
    fn test(&mut self) -> Option<FoundChange> {
        let largest = self.largest_ratios();
        let (_, ratio, count) = largest.first()?;
        let is_large = ratio.log > self.threshold;
        let was_large = self.waits;
        self.waits = is_large && !was_large;
        if !(is_large && was_large) {
            return None;
        }
        let after = count - 1;
        let unexplained = Unexplained::of(&self.precision, &self.sums_of(after))?;
        let mut found: Vec<(Cause, Ratio)> = Vec::new();
        for cause in &self.causes {
            found.extend(self.ratio(&unexplained, *cause).map(|ratio| (*cause, ratio)));
        }
        found.sort_by(|a, b| b.1.log.total_cmp(&a.1.log));
        let (cause, ratio) = found.first()?.clone();
        let rivals = found[1..].iter().filter(|other| other.1.log > ratio.log - BETTER).map(|other| other.0);
        let began_s = self.ticks.get(self.ticks.len() - after).map_or(0.0, |tick| tick.began_s);
        Some(FoundChange { began_s, cause, rivals: rivals.collect(), ratio })
    }

    /// The ratio of a cause, if the changes can be of it.
    fn ratio(&self, unexplained: &Unexplained, cause: Cause) -> Option<Ratio> {
        let ratio = unexplained.ratio(&cause.parameters(self.noise.len()), &self.prior);
        ratio.filter(|ratio| cause.is_possible(ratio, &self.prior))
    }

    /// The largest ratio of each cause over all beginnings, with its seconds; the largest first.
    fn largest_ratios(&self) -> Vec<(Cause, Ratio, usize)> {
        let mut largest: Vec<Option<(Cause, Ratio, usize)>> = vec![None; self.causes.len()];
        let mut sums = Sums::zeros(self.noise.len());
        for (count, tick) in (1..).zip(self.ticks.iter().rev()) {
            sums.add(&tick.sums);
            if !LENGTHS.contains(&count) {
                continue;
            }
            let Some(unexplained) = Unexplained::of(&self.precision, &sums) else { continue };
            for (cause, largest) in self.causes.iter().zip(&mut largest) {
                let ratio = self.ratio(&unexplained, *cause);
                let ratio = ratio.filter(|ratio| largest.as_ref().is_none_or(|(_, other, _)| other.log < ratio.log));
                *largest = ratio.map(|ratio| (*cause, ratio, count)).or(largest.take());
            }
        }
        let mut largest: Vec<_> = largest.into_iter().flatten().collect();
        largest.sort_by(|a, b| b.1.log.total_cmp(&a.1.log));
        largest
    }

    /// Takes a change into the baseline, by the seconds since it began.
    fn take(&mut self, found: &FoundChange) {
        let joints = self.noise.len();
        let count = self.ticks.iter().filter(|tick| tick.began_s >= found.began_s).count();
        let mut covariance = self.precision.inverse();
        for cause in [found.cause].iter().chain(&found.rivals) {
            for p in cause.parameters(joints) {
                if let Some(covariance) = &mut covariance {
                    *covariance.at_mut(p, p) += self.prior[p].powi(2);
                }
            }
        }
        let before = covariance.and_then(|covariance| covariance.inverse());
        let Some((changes, precision)) = before.and_then(|before| posterior(&before, &self.sums_of(count))) else {
            return;
        };
        self.baseline.iter_mut().zip(&changes).for_each(|(all, change)| *all += change);
        self.precision = precision;
        self.ticks.clear();
        self.last = None;
    }

    /// Takes the older half of the seconds into the baseline when no ratio looks back to them.
    fn forget(&mut self) {
        let longest = LENGTHS[LENGTHS.len() - 1];
        if self.ticks.len() < longest + longest / 2 {
            return;
        }
        let mut old = Sums::zeros(self.noise.len());
        self.ticks.drain(..longest / 2).for_each(|tick| old.add(&tick.sums));
        let Some((changes, _)) = posterior(&self.precision, &old) else { return };
        let (information, _) = old.all();
        self.precision = information.plus(&self.precision, FORGOTTEN);
        self.baseline.iter_mut().zip(&changes).for_each(|(all, change)| *all += change);
        let waiting = self.ticks.iter_mut().chain(&mut self.last);
        waiting.for_each(|tick| tick.sums.less(&changes));
        self.current.sums.less(&changes);
    }
}

fn inverse(precision: &Matrix) -> Matrix {
    let size = precision.columns();
    precision.inverse().unwrap_or_else(|| Matrix::zeros(size, size))
}
