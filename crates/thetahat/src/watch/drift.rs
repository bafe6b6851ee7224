//! Lasting changes: of a joint's friction or offset, or of a payload at the last link.

use super::{
    belief::Belief,
    history::{History, Stretch},
    layout::{Layout, OWN, PAYLOAD},
    likelihood::{Ratio, Sums, Unexplained, posterior},
    scale::Scales,
    second::Second,
    settling::Settled,
    step::Step,
    whitening::{BlockNoise, Whitening},
};
use thetahat_ground::linear_algebra::Matrix;

/// Seconds that a ratio looks back at least: one alone may hold the instant of the change.
const FEWEST: usize = 2;
/// Seconds that it looks back at most, but for those of one stretch.
const LONGEST: usize = 256;
/// Part of the friction that a change exceeds: less is an error of the model, which is another in other motion.
const SMALLEST: f64 = 0.03;
/// Part of the friction up to which a change is believed to be of friction where an offset explains as well.
const LARGEST: f64 = 0.5;
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
            Self::Friction(j) => vec![OWN * j, OWN * j + 1],
            Self::Offset(j) => vec![OWN * j + 2],
            Self::Payload => (OWN * joints..OWN * joints + PAYLOAD.len()).collect(),
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
    layout: Layout,
    /// The changes from the identified model that are taken for no news, and their precision.
    baseline: Vec<f64>,
    precision: Matrix,
    /// What is believed of it without data.
    believed: Matrix,
    /// The changes by the baseline and the seconds since.
    running: Vec<f64>,
    /// The baseline when watching began, and its covariance.
    first: (Vec<f64>, Matrix),
    noise: Vec<Option<BlockNoise>>,
    whitening: Whitening,
    causes: Vec<Cause>,
    /// Prior deviations of the changes that are said.
    prior: Vec<f64>,
    /// Identified viscous and Coulomb friction of each joint.
    friction: Vec<[f64; 2]>,
    /// Logarithm of the ratio from which a change is said.
    threshold: f64,
    blocks_per_tick: usize,
    scales: Scales,
    current: Second,
    /// The last second, which counts when no event began in it, and the speeds in it.
    last: Option<(Stretch, Vec<Option<f64>>)>,
    history: History,
    /// Whether the threshold was passed a second ago.
    waits: bool,
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
    pub(super) fn new(
        layout: Layout,
        settled: Settled,
        belief: Belief,
        blocks_per_tick: usize,
        threshold: f64,
    ) -> Self {
        let Settled { baseline, precision, noise, scales } = settled;
        Self {
            layout,
            first: (baseline.clone(), inverse(&precision)),
            running: baseline.clone(),
            baseline,
            precision,
            whitening: Whitening::new(layout.joints),
            causes: Cause::all(layout.joints),
            noise,
            prior: belief.changes,
            believed: belief.baseline,
            friction: belief.friction,
            threshold,
            blocks_per_tick,
            scales,
            current: Second::new(layout.joints),
            last: None,
            history: History::default(),
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
        let (since, precision) = posterior(&self.precision, &self.sums_since(0.0))
            .unwrap_or_else(|| (vec![0.0; self.baseline.len()], self.precision.clone()));
        let (first, of_first) = &self.first;
        let all = self.baseline.iter().zip(&since).zip(first).map(|((a, b), c)| a + b - c).collect();
        let covariance = inverse(&precision).plus(of_first, 1.0);
        (all, (0..covariance.columns()).map(|i| covariance.at(i, i).max(0.0).sqrt()).collect())
    }

    /// Leaves the last seconds out, as after a gap or while an event disturbs.
    pub(super) fn leave_out(&mut self) {
        self.last = None;
        self.current = Second::new(self.layout.joints);
        self.whitening = Whitening::new(self.noise.len());
    }

    /// Takes a block; a change that it shows.
    pub(super) fn push(&mut self, block: &Step) -> Option<FoundChange> {
        self.current.push(&mut self.whitening, &self.noise, block);
        if self.current.blocks < self.blocks_per_tick {
            return None;
        }
        let second = std::mem::replace(&mut self.current, Second::new(self.layout.joints));
        let sums = second.sums(self.layout, &self.noise, &self.scales, &self.baseline);
        let stretch = Stretch { sums, began_s: second.began_s, ticks: 1 };
        if let Some((last, speeds)) = self.last.replace((stretch, second.speeds())) {
            self.learn(&last, &speeds);
            self.history.push(last);
        }
        let found = self.test();
        match &found {
            Some(found) => self.take(found),
            None => self.forget(),
        }
        self.running.clone_from(&self.baseline);
        if let Some((since, _)) = posterior(&self.precision, &self.sums_since(0.0)) {
            self.running.iter_mut().zip(&since).for_each(|(all, change)| *all += change);
        }
        found
    }

    /// Learns the noise of a second at its speeds.
    fn learn(&mut self, second: &Stretch, speeds: &[Option<f64>]) {
        let since: Vec<f64> = self.running.iter().zip(&self.baseline).map(|(all, before)| all - before).collect();
        let mut sums = second.sums.clone();
        sums.less(&since);
        self.scales.push(&sums, speeds);
    }

    /// The sums of the stretches that began at a time or later.
    fn sums_since(&self, began_s: f64) -> Sums {
        let mut sums = Sums::zeros(self.layout);
        let later = self.history.newest_first().take_while(|stretch| stretch.began_s >= began_s);
        later.for_each(|stretch| sums.add(&stretch.sums));
        sums
    }

    /// A change, one second after its ratio passed the threshold: from the seconds after the one that holds its instant, which show it as well.
    fn test(&mut self) -> Option<FoundChange> {
        let largest = self.largest_ratios();
        let (_, ratio, began_s) = largest.first()?;
        let is_large = ratio.log > self.threshold;
        let was_large = std::mem::replace(&mut self.waits, is_large);
        if !(is_large && was_large) {
            return None;
        }
        let after = self.history.newest_first().map(|stretch| stretch.began_s).take_while(|time_s| time_s > began_s);
        let began_s = after.last()?;
        let sums = self.sums_since(began_s);
        let unexplained = Unexplained::of(&self.precision, &sums)?;
        let mut found: Vec<(Cause, Ratio)> = Vec::new();
        for cause in &self.causes {
            found.extend(self.ratio(&unexplained, *cause).map(|ratio| (*cause, ratio)));
        }
        found.sort_by(|a, b| b.1.log.total_cmp(&a.1.log));
        let best = found.first()?.1.log;
        self.prefer_friction(&mut found, &sums);
        let (cause, ratio) = found.first()?.clone();
        if ratio.log < self.threshold || self.over_friction(cause, &ratio, &sums) < SMALLEST {
            return None;
        }
        self.waits = false;
        let rivals = found[1..].iter().filter(|other| other.1.log > best - BETTER).map(|other| other.0);
        Some(FoundChange { began_s, cause, rivals: rivals.collect(), ratio })
    }

    /// The rms torque of a change in some seconds over that of friction: the joint's own, or of a payload that of all joints.
    fn over_friction(&self, cause: Cause, ratio: &Ratio, sums: &Sums) -> f64 {
        let joints: Vec<usize> = match cause {
            Cause::Friction(joint) | Cause::Offset(joint) => vec![joint],
            Cause::Payload => (0..self.layout.joints).collect(),
        };
        let of_friction = |joint: usize| {
            let [viscous, coulomb] = self.friction[joint];
            sums.square(&[(OWN * joint, viscous), (OWN * joint + 1, coulomb)])
        };
        let friction: f64 = joints.into_iter().map(of_friction).sum();
        let places = cause.parameters(self.layout.joints);
        let changes: Vec<(usize, f64)> = places.into_iter().zip(ratio.changes.iter().copied()).collect();
        (sums.square(&changes) / friction.max(f64::MIN_POSITIVE)).sqrt()
    }

    /// Puts friction before the offset of its joint where it explains as well and changes by less than half: a joint that moves in one
    /// direction shows their sum.
    fn prefer_friction(&self, found: &mut [(Cause, Ratio)], sums: &Sums) {
        let Some((Cause::Offset(joint), offset)) = found.first() else { return };
        let (cause, least) = (Cause::Friction(*joint), offset.log - BETTER);
        let is_as_good = |(other, ratio): &(Cause, Ratio)| {
            *other == cause && ratio.log > least && self.over_friction(cause, ratio, sums) < LARGEST
        };
        if let Some(place) = found.iter().position(is_as_good) {
            found[..=place].rotate_right(1);
        }
    }

    /// The ratio of a cause, if the changes can be of it.
    fn ratio(&self, unexplained: &Unexplained, cause: Cause) -> Option<Ratio> {
        let ratio = unexplained.ratio(&cause.parameters(self.noise.len()), &self.prior);
        ratio.filter(|ratio| cause.is_possible(ratio, &self.prior))
    }

    /// The largest ratio of each cause over all beginnings, with its beginning; the largest first.
    fn largest_ratios(&self) -> Vec<(Cause, Ratio, f64)> {
        let mut largest: Vec<Option<(Cause, Ratio, f64)>> = vec![None; self.causes.len()];
        let (mut sums, mut count) = (Sums::zeros(self.layout), 0);
        for stretch in self.history.newest_first() {
            sums.add(&stretch.sums);
            count += stretch.ticks;
            if count < FEWEST {
                continue;
            }
            let Some(unexplained) = Unexplained::of(&self.precision, &sums) else { continue };
            for (cause, largest) in self.causes.iter().zip(&mut largest) {
                let ratio = self.ratio(&unexplained, *cause);
                let ratio = ratio.filter(|ratio| largest.as_ref().is_none_or(|(_, other, _)| other.log < ratio.log));
                *largest = ratio.map(|ratio| (*cause, ratio, stretch.began_s)).or(largest.take());
            }
        }
        let mut largest: Vec<_> = largest.into_iter().flatten().collect();
        largest.sort_by(|a, b| b.1.log.total_cmp(&a.1.log));
        largest
    }

    /// Takes a change into the baseline, by the seconds since it began.
    fn take(&mut self, found: &FoundChange) {
        let mut covariance = self.precision.inverse();
        for cause in [found.cause].iter().chain(&found.rivals) {
            for p in cause.parameters(self.layout.joints) {
                if let Some(covariance) = &mut covariance {
                    *covariance.at_mut(p, p) += self.prior[p].powi(2);
                }
            }
        }
        let before = covariance.and_then(|covariance| covariance.inverse());
        let Some((changes, precision)) = before.and_then(|before| posterior(&before, &self.sums_since(found.began_s)))
        else {
            return;
        };
        self.baseline.iter_mut().zip(&changes).for_each(|(all, change)| *all += change);
        self.precision = precision;
        self.history.clear();
        self.scales.forget_waiting();
        self.last = None;
    }

    /// Takes the oldest seconds into the baseline when no ratio looks back to them.
    fn forget(&mut self) {
        let Some(old) = self.history.take_older_than(LONGEST) else { return };
        let Some((changes, _)) = posterior(&self.precision, &old.sums) else { return };
        let (information, _) = old.sums.all();
        let kept = FORGOTTEN.powf(old.ticks as f64 / LONGEST as f64);
        self.precision = information.plus(&self.precision, kept).plus(&self.believed, 1.0 - kept);
        self.baseline.iter_mut().zip(&changes).for_each(|(all, change)| *all += change);
        let waiting = self.history.iter_mut().chain(self.last.iter_mut().map(|(last, _)| last));
        waiting.for_each(|stretch| stretch.sums.less(&changes));
    }
}

fn inverse(precision: &Matrix) -> Matrix {
    let size = precision.columns();
    precision.inverse().unwrap_or_else(|| Matrix::zeros(size, size))
}
