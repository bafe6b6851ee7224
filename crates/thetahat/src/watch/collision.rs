//! Fast residuals: a torque that the model and its usual errors do not explain, within a third of a second.

use std::collections::VecDeque;

use super::{
    layout::{CURVE, Layout, OWN, PAYLOAD},
    step::{Row, Step},
    whitening::neighbours,
};

/// Longest time that a ratio looks back, s.
const REACH_S: f64 = 0.3;
/// Time constant of the residual's mean, which is no event, s.
const MEAN_S: f64 = 2.0;
/// After this time an event lasts: what remains is for changes to explain, s.
const LASTS_S: f64 = 1.0;
/// An event ends after [`REACH_S`] in which no residual exceeds so many of its deviations.
const QUIET: f64 = 4.0;
/// Prior deviation of an event's torque, in deviations of the residual.
const PRIOR: f64 = 10.0;
/// Torque within which friction near rest is not known, over Coulomb friction.
const LEEWAY: f64 = 1.5;
/// The largest ratio of settling may be that of so many times its steps.
const MARGIN: f64 = 20.0;
/// Part of Coulomb friction that an event exceeds: less is a change of friction, whose sign turns with the motion, or friction near rest.
const FLOOR: f64 = 0.65;
/// Deviations of the torque's delay whose error an event exceeds.
const DELAYS: f64 = 3.0;
/// Part of the torque's rms that an event exceeds: less is an error of the model.
const OF_TORQUE: f64 = 0.1;
/// Deviations of the residual that an event exceeds: less that lasts is a change.
const LEAST: f64 = 4.0;
/// An event that begins so soon after the last one is a part of it, s.
const REPEATS_S: f64 = 5.0;
/// Step by which deviations are raised until it is.
const RAISE: f64 = 1.05;
/// Largest correlation of neighbours.
const LARGEST: f64 = 0.98;

/// Octaves of the torque's rate of change above its rms while settling, each with a noise of its own; the first holds what is slower.
const OCTAVES: usize = 5;
/// The factor on the variance that is believed of an octave before it was seen, and the steps that this counts for.
const UNSEEN: [f64; 2] = [4.0, 50.0];
/// Steps of an octave by which its noise is known: later ones take the place of earlier ones.
const MEMORY: f64 = 6000.0;
/// Deviations by which a step counts at most.
const LARGEST_STEP: f64 = 4.0;

/// What is known of a robot without its steps.
#[derive(Clone, Copy)]
pub(super) struct Known<'a> {
    /// Identified Coulomb friction of each joint.
    pub(super) coulomb: &'a [f64],
    /// Deviation of the torque's delay, s.
    pub(super) delay_s: f64,
    /// Time of a step, s.
    pub(super) step_s: f64,
}

/// The test of all joints.
#[derive(Debug, Clone)]
pub(super) struct Collisions {
    layout: Layout,
    joints: Vec<Option<Joint>>,
    step_s: f64,
    /// Logarithm of the ratio from which it is an event.
    threshold: f64,
    event: Option<Event>,
    /// End of the last event, s.
    last_s: f64,
}

#[derive(Debug, Clone)]
struct Joint {
    coulomb: f64,
    delay_s: f64,
    /// Rms of the torque while settling.
    torque: f64,
    correlation: f64,
    /// Deviation of what a step adds to the correlated part, N m or N.
    deviation: f64,
    mean: f64,
    before: f64,
    /// Rms of the torque's rate of change while settling.
    rate: f64,
    /// The noise of each octave of that rate: the mean of squares over the variance, and the steps that it is from.
    octaves: [[f64; 2]; OCTAVES],
    /// Factor on the deviation in the present step.
    factor: f64,
    /// What the last steps added, in deviations, and the torque's rate of change in them, the newest last.
    added: VecDeque<[f64; 2]>,
}

#[derive(Debug, Clone, Copy)]
struct Event {
    began_s: f64,
    quiet: usize,
    lasts: bool,
}

/// An event that begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bump {
    pub(super) began_s: f64,
    /// From zero.
    pub(super) joint: usize,
    pub(super) torque: f64,
    log: f64,
}

impl Collisions {
    /// The test with the noise of settled steps; `coulomb` is the identified friction.
    pub(super) fn of(layout: Layout, steps: &[Step], baseline: &[f64], known: Known<'_>, threshold: f64) -> Self {
        let joints = (0..layout.joints).map(|j| Joint::of(steps, j, &layout.pick(baseline, j), known));
        let (joints, step_s) = (joints.collect(), known.step_s);
        Self { layout, joints, step_s, threshold, event: None, last_s: f64::NEG_INFINITY }
    }

    /// Deviation of each joint's residual; `None` of joints that did not move.
    pub(super) fn deviations(&self) -> Vec<Option<f64>> {
        self.joints.iter().map(|joint| joint.as_ref().map(Joint::spread)).collect()
    }

    /// Forgets the last steps, as after a gap.
    pub(super) fn restart(&mut self) {
        self.event = None;
        for joint in self.joints.iter_mut().flatten() {
            joint.added.clear();
            joint.before = 0.0;
        }
    }

    /// Whether an event disturbs what lasts.
    pub(super) fn disturbs(&self) -> bool {
        self.event.is_some_and(|event| !event.lasts)
    }

    /// Takes a step; an event that begins.
    pub(super) fn push(&mut self, step: &Step, baseline: &[f64]) -> Option<Bump> {
        let is_frozen = self.disturbs();
        let (mut is_quiet, mut largest) = (true, None::<Bump>);
        for (j, joint) in self.joints.iter_mut().enumerate() {
            let Some(joint) = joint else { continue };
            let error = joint.take(&step.rows[j], step.rest[j], &self.layout.pick(baseline, j), is_frozen, self.step_s);
            is_quiet &= error.abs() < QUIET * joint.factor * joint.spread();
            let (log, torque, steps) = joint.largest_ratio();
            if torque.abs() > joint.least() && largest.is_none_or(|other| other.log < log) {
                let began_s = step.time_s - steps as f64 * self.step_s;
                largest = Some(Bump { began_s, joint: j, torque, log });
            }
        }
        match &mut self.event {
            Some(event) => {
                event.quiet = if is_quiet { event.quiet + 1 } else { 0 };
                event.lasts |= step.time_s - event.began_s > LASTS_S;
                if event.quiet as f64 * self.step_s > REACH_S {
                    self.last_s = step.time_s;
                    self.restart();
                }
                None
            }
            None => {
                let bump = largest.filter(|bump| bump.log > self.threshold)?;
                let repeats = step.time_s - self.last_s < REPEATS_S;
                self.event = Some(Event { began_s: bump.began_s, quiet: 0, lasts: repeats });
                Some(bump).filter(|_| !repeats)
            }
        }
    }
}

impl Joint {
    /// The noise of a joint's steps, raised until their largest ratio is usual; `None` if it does not move.
    fn of(steps: &[Step], joint: usize, changes: &[f64], known: Known<'_>) -> Option<Self> {
        let (coulomb, step_s) = (known.coulomb[joint], known.step_s);
        let squares: f64 = steps.iter().map(|step| step.rows[joint].square).sum();
        let torque = (squares / steps.len() as f64).sqrt();
        let rates: f64 = steps.iter().map(|step| rate(&step.rows[joint]).powi(2)).sum();
        let white = Self {
            coulomb,
            delay_s: known.delay_s,
            torque,
            correlation: 0.0,
            deviation: 1.0,
            mean: 0.0,
            before: 0.0,
            rate: (rates / steps.len() as f64).sqrt().max(f64::MIN_POSITIVE),
            octaves: [UNSEEN; OCTAVES],
            factor: 1.0,
            added: VecDeque::new(),
        };
        let mut trial = white.clone();
        let errors: Vec<Option<f64>> = steps
            .iter()
            .map(|step| {
                let error = trial.take(&step.rows[joint], step.rest[joint], changes, false, step_s);
                (!step.rest[joint]).then_some(error)
            })
            .collect();
        let [product, square, count] = neighbours(&errors);
        if count < REACH_S / step_s || square <= 0.0 {
            return None;
        }
        let correlation = (product / square).clamp(0.0, LARGEST);
        let deviation = (square / count * (1.0 - correlation * correlation)).sqrt();
        let mut noise = Self { correlation, deviation, ..white };
        for (step, error) in steps.iter().zip(&errors) {
            error.iter().for_each(|error| noise.learn(&step.rows[joint], *error));
        }
        let usual = (MARGIN * steps.len() as f64).ln();
        while noise.clone().largest_of(steps, joint, changes, step_s) > usual {
            noise.deviation *= RAISE;
        }
        Some(noise)
    }

    /// The largest ratio of some steps.
    fn largest_of(mut self, steps: &[Step], joint: usize, changes: &[f64], step_s: f64) -> f64 {
        let ratios = steps.iter().map(|step| {
            self.take(&step.rows[joint], step.rest[joint], changes, false, step_s);
            self.largest_ratio().0
        });
        ratios.fold(0.0, f64::max)
    }

    /// The least torque of an event.
    fn least(&self) -> f64 {
        let rate = self.added.iter().fold(0.0, |largest: f64, [_, rate]| largest.max(rate.abs()));
        let least = (FLOOR * self.coulomb).max(OF_TORQUE * self.torque).max(LEAST * self.factor * self.spread());
        least + DELAYS * self.delay_s * rate
    }

    fn octave(&self, row: &Row) -> usize {
        let over = (rate(row).abs() / self.rate).max(1.0).log2();
        (if over > 0.0 { 1 + over as usize } else { 0 }).min(OCTAVES - 1)
    }

    /// Learns the noise of a step's octave.
    fn learn(&mut self, row: &Row, error: f64) {
        let (octave, spread) = (self.octave(row), self.spread());
        let [mean, count] = &mut self.octaves[octave];
        let square = (error / spread).powi(2).min(LARGEST_STEP.powi(2) * mean.max(1.0));
        *count = (*count + 1.0).min(MEMORY);
        *mean += (square - *mean) / *count;
    }

    /// Deviation of the residual itself.
    fn spread(&self) -> f64 {
        self.deviation / (1.0 - self.correlation * self.correlation).sqrt()
    }

    /// Takes a step and gives its residual less the mean. Near rest only what exceeds friction counts.
    fn take(&mut self, row: &Row, is_at_rest: bool, changes: &[f64], is_frozen: bool, step_s: f64) -> f64 {
        let residual = row.y - row.torque(changes);
        let error = if is_at_rest {
            let friction = self.coulomb + changes[1];
            let without = residual + friction * row.friction;
            (without.abs() - LEEWAY * friction.abs()).max(0.0) * without.signum()
        } else {
            let error = residual - self.mean;
            if !is_frozen {
                self.mean += step_s / MEAN_S * error;
            }
            error
        };
        let [mean, _] = self.octaves[self.octave(row)];
        self.factor = mean.sqrt().max(1.0);
        let added = (error - self.correlation * self.before) / (self.deviation * self.factor);
        if !(is_at_rest || is_frozen) {
            self.learn(row, error);
        }
        self.before = error;
        self.added.push_back([added, rate(row)]);
        if self.added.len() as f64 * step_s > REACH_S {
            self.added.pop_front();
        }
        error
    }

    /// The logarithm of the largest ratio over the beginnings of an event, its torque, and its steps.
    fn largest_ratio(&self) -> (f64, f64, usize) {
        let kept = 1.0 - self.correlation;
        let prior = PRIOR * PRIOR / (1.0 - self.correlation * self.correlation);
        let (mut later, mut best) = (0.0, (f64::NEG_INFINITY, 0.0, 0));
        for (steps, [added, _]) in self.added.iter().rev().enumerate() {
            let score = kept * later + added;
            let information = kept * kept * steps as f64 + 1.0;
            let size = score / (information + 1.0 / prior);
            let log = 0.5 * score * size - 0.5 * (1.0 + prior * information).ln();
            if log > best.0 {
                best = (log, size * self.deviation * self.factor, steps + 1);
            }
            later += added;
        }
        best
    }
}

/// The rate of change of the model's torque.
fn rate(row: &Row) -> f64 {
    row.x[OWN + PAYLOAD.len() + CURVE - 1]
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    const STEP_S: f64 = 0.01;
    const LAYOUT: Layout = Layout { joints: 1, model: 0 };

    fn test_of(steps: &[Step], coulomb: f64) -> Collisions {
        let known = Known { coulomb: &[coulomb], delay_s: 1e-3, step_s: STEP_S };
        Collisions::of(LAYOUT, steps, &vec![0.0; LAYOUT.all()], known, 20.0)
    }

    /// Steps of one joint: noise of deviation 0.5, and a torque in some of them.
    fn steps(count: usize, torque: impl Fn(usize) -> f64) -> Vec<Step> {
        let mut generator = ChaCha8Rng::seed_from_u64(8);
        let step = |k: usize| {
            let noise: f64 = StandardNormal.sample(&mut generator);
            let row = Row { y: 0.5 * noise + torque(k), ..Row::zeros(LAYOUT.of_joint()) };
            Step { time_s: STEP_S * k as f64, rows: vec![row], rest: vec![false] }
        };
        (0..count).map(step).collect()
    }

    fn bumps(test: &mut Collisions, steps: &[Step]) -> Vec<Bump> {
        steps.iter().filter_map(|step| test.push(step, &vec![0.0; LAYOUT.all()])).collect()
    }

    #[test]
    fn a_push_is_one_event_with_its_torque_and_time() {
        let quiet = steps(3000, |_| 0.0);
        let mut test = test_of(&quiet, 0.0);
        let pushed = steps(3000, |k| if (1000..1020).contains(&k) { 3.0 } else { 0.0 });
        let found = bumps(&mut test, &pushed);
        assert_eq!(found.len(), 1, "{found:?}");
        assert!((found[0].began_s - 9.99).abs() < 0.03, "{found:?}");
        assert!((found[0].torque - 3.0).abs() < 0.6, "{found:?}");
        assert!(!test.disturbs());
    }

    /// With a threshold of 20 an event is expected in `e^20` steps.
    #[test]
    fn noise_is_no_event() {
        let quiet = steps(100_000, |_| 0.0);
        let mut test = test_of(&quiet[..3000], 0.0);
        assert_eq!(bumps(&mut test, &quiet), []);
    }

    #[test]
    fn near_rest_friction_is_no_event() {
        let mut test = test_of(&steps(3000, |_| 0.0), 4.0);
        let mut resting = steps(200, |k| if k < 100 { 4.5 } else { 12.0 });
        resting.iter_mut().for_each(|step| step.rest[0] = true);
        let found = bumps(&mut test, &resting);
        assert_eq!(found.len(), 1, "{found:?}");
        assert!(found[0].began_s > 0.97, "{found:?}");
    }
}
