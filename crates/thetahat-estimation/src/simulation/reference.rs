use std::sync::Arc;

use crate::trajectory::{FourierSeries, Moves};
use thetahat_ground::series::Series;

/// The joint motion that the controller is asked to follow.
#[derive(Debug, Clone, PartialEq)]
pub enum Reference {
    /// A recorded reference, known at its samples.
    Sampled(SampledReference),
    /// Synchronised moves, known at any time.
    Moves(Moves),
    /// A periodic motion, known at any time.
    Periodic(PeriodicReference),
}

/// A periodic motion, and the transients before and after it.
#[derive(Debug, Clone, PartialEq)]
pub struct PeriodicReference {
    series: FourierSeries,
    /// Added to the series: zero where the motion repeats.
    transient: SampledReference,
}

impl PeriodicReference {
    /// A reference that is a series plus transients; both begin at time zero.
    #[must_use]
    pub fn new(series: FourierSeries, transient: SampledReference) -> Self {
        Self { series, transient }
    }

    /// The series alone.
    #[must_use]
    pub fn series(&self) -> &FourierSeries {
        &self.series
    }

    fn evaluate(&self, t: f64, q: &mut [f64], dq: &mut [f64], ddq: &mut [f64]) {
        self.transient.evaluate(t, q, dq, ddq);
        self.series.add_derivatives(self.transient.within(t), [0, 1, 2], [q, dq, ddq]);
    }

    fn rates(&self, t: f64, dq: &mut [f64], ddq: &mut [f64], dddq: &mut [f64]) {
        self.transient.rates(t, dq, ddq, dddq);
        if self.transient.within(t) == t {
            self.series.add_derivatives(t, [1, 2, 3], [dq, ddq, dddq]);
        }
    }
}

/// A recorded reference with its derivatives by central differences. Between its samples positions and velocities are cubic
/// Hermite polynomials of their values and rates, accelerations are linear: a chord of the positions would differ from the
/// curve by `T^2 ddq / 8`, which torques at the samples lack.
#[derive(Debug, Clone, PartialEq)]
pub struct SampledReference {
    sample_rate_hz: f64,
    q: Arc<Series>,
    dq: Arc<Series>,
    ddq: Arc<Series>,
}

impl SampledReference {
    /// A reference from its samples, the first at time zero.
    #[must_use]
    pub fn new(q: Series, sample_rate_hz: f64) -> Self {
        let dq = crate::signal::central_difference(&q, sample_rate_hz);
        let ddq = crate::signal::central_difference(&dq, sample_rate_hz);
        Self { sample_rate_hz, q: Arc::new(q), dq: Arc::new(dq), ddq: Arc::new(ddq) }
    }

    fn evaluate(&self, t: f64, q: &mut [f64], dq: &mut [f64], ddq: &mut [f64]) {
        let place = (t * self.sample_rate_hz).clamp(0.0, (self.q.len() - 1) as f64);
        let k = (place + SAME_SAMPLE) as usize;
        let interval = self.interval(k, (place - k as f64).max(0.0));
        interval.cubic(q, &self.q, &self.dq);
        interval.cubic(dq, &self.dq, &self.ddq);
        for (j, out) in ddq.iter_mut().enumerate() {
            let [a, b] = interval.ends(&self.ddq, j);
            *out = a + interval.part * (b - a);
        }
    }

    fn interval(&self, k: usize, part: f64) -> Interval {
        Interval { k, next: (k + 1).min(self.q.len() - 1), part, step_s: 1.0 / self.sample_rate_hz }
    }
}

/// A place between two samples.
struct Interval {
    k: usize,
    next: usize,
    /// From 0 at the first to 1 at the next.
    part: f64,
    step_s: f64,
}

impl Interval {
    fn ends(&self, series: &Series, joint: usize) -> [f64; 2] {
        [series.sample(self.k)[joint], series.sample(self.next)[joint]]
    }

    /// The cubic with the values and the rates at both ends.
    fn cubic(&self, out: &mut [f64], values: &Series, rates: &Series) {
        let (s, r) = (self.part, 1.0 - self.part);
        for (j, out) in out.iter_mut().enumerate() {
            let ([a, b], [da, db]) = (self.ends(values, j), self.ends(rates, j));
            *out = a + s * s * (3.0 - 2.0 * s) * (b - a) + self.step_s * s * r * (r * da - s * db);
        }
    }

    /// Its slope.
    fn slope(&self, out: &mut [f64], values: &Series, rates: &Series) {
        let (s, r) = (self.part, 1.0 - self.part);
        for (j, out) in out.iter_mut().enumerate() {
            let ([a, b], [da, db]) = (self.ends(values, j), self.ends(rates, j));
            *out = 6.0 * s * r * (b - a) / self.step_s + r * (r - 2.0 * s) * da + s * (s - 2.0 * r) * db;
        }
    }
}

impl SampledReference {
    /// The time, held at the first and last sample.
    fn within(&self, t: f64) -> f64 {
        t.clamp(0.0, (self.q.len() - 1) as f64 / self.sample_rate_hz)
    }

    fn mapped(&self, position: &dyn Fn(&[f64]) -> Vec<f64>, rate: &dyn Fn(&[f64]) -> Vec<f64>) -> Self {
        Self {
            sample_rate_hz: self.sample_rate_hz,
            q: mapped(&self.q, position),
            dq: mapped(&self.dq, rate),
            ddq: mapped(&self.ddq, rate),
        }
    }

    /// The derivatives in time of what [`Self::evaluate`] gives; zero before the first sample and after the last.
    fn rates(&self, t: f64, dq: &mut [f64], ddq: &mut [f64], dddq: &mut [f64]) {
        let place = t * self.sample_rate_hz;
        if place < 0.0 || place >= (self.q.len() - 1) as f64 {
            [dq, ddq, dddq].into_iter().for_each(|out| out.fill(0.0));
            return;
        }
        let k = (place + SAME_SAMPLE) as usize;
        let interval = self.interval(k, (place - k as f64).max(0.0));
        interval.slope(dq, &self.q, &self.dq);
        interval.slope(ddq, &self.dq, &self.ddq);
        for (j, out) in dddq.iter_mut().enumerate() {
            let [a, b] = interval.ends(&self.ddq, j);
            *out = (b - a) * self.sample_rate_hz;
        }
    }
}

/// Fractional sample indices this close to a sample count as that sample: k * T is not exact.
const SAME_SAMPLE: f64 = 1e-6;

impl Reference {
    /// Position, velocity and acceleration at time `t` in s.
    pub fn evaluate(&self, t: f64, q: &mut [f64], dq: &mut [f64], ddq: &mut [f64]) {
        match self {
            Self::Sampled(sampled) => sampled.evaluate(t, q, dq, ddq),
            Self::Moves(moves) => moves.evaluate(t, q, dq, ddq),
            Self::Periodic(periodic) => periodic.evaluate(t, q, dq, ddq),
        }
    }

    /// The derivatives in time of what [`Self::evaluate`] gives.
    pub(super) fn rates(&self, t: f64, dq: &mut [f64], ddq: &mut [f64], dddq: &mut [f64]) {
        match self {
            Self::Sampled(sampled) => sampled.rates(t, dq, ddq, dddq),
            Self::Moves(moves) => {
                moves.evaluate(t, dddq, dq, ddq);
                moves.jerk(t, dddq);
            }
            Self::Periodic(periodic) => periodic.rates(t, dq, ddq, dddq),
        }
    }

    /// The reference in other coordinates: `position` maps points, and its linear part `rate` the derivatives.
    pub(super) fn mapped(&self, position: &dyn Fn(&[f64]) -> Vec<f64>, rate: &dyn Fn(&[f64]) -> Vec<f64>) -> Self {
        match self {
            Self::Moves(moves) => Self::Moves(moves.mapped(position)),
            Self::Sampled(sampled) => Self::Sampled(sampled.mapped(position, rate)),
            Self::Periodic(PeriodicReference { series, transient }) => Self::Periodic(PeriodicReference {
                series: series.mapped(position, rate),
                transient: transient.mapped(rate, rate),
            }),
        }
    }

    /// The reference of some of the joints.
    #[doc(hidden)]
    #[must_use]
    pub fn of_joints(&self, joints: &[usize]) -> Self {
        let part = |all: &[f64]| joints.iter().map(|&j| all[j]).collect();
        self.mapped(&part, &part)
    }

    /// Number of joints.
    #[must_use]
    pub fn joints(&self) -> usize {
        match self {
            Self::Sampled(sampled) => sampled.q.channels(),
            Self::Moves(moves) => moves.joints(),
            Self::Periodic(periodic) => periodic.series.joints(),
        }
    }
}

/// The series of what each sample becomes; the same one where no sample changes.
fn mapped(series: &Arc<Series>, map: &dyn Fn(&[f64]) -> Vec<f64>) -> Arc<Series> {
    if (0..series.len()).all(|k| map(series.sample(k)) == series.sample(k)) {
        return series.clone();
    }
    let values: Vec<f64> = (0..series.len()).flat_map(|k| map(series.sample(k))).collect();
    Arc::new(Series::shaped((values.len() / series.len().max(1)).max(1), values))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trajectory::{LowPass, find_periodic};

    /// A long reference takes the memory of one, where motors are joints.
    #[test]
    fn a_reference_that_does_not_change_is_not_copied() {
        let series = Arc::new(Series::shaped(2, (0..20).map(f64::from).collect()));
        assert!(Arc::ptr_eq(&mapped(&series, &|q| q.to_vec()), &series));
        let doubled = mapped(&series, &|q| q.iter().map(|v| 2.0 * v).collect());
        assert_eq!((doubled.channels(), doubled.sample(9)), (2, &[36.0, 38.0][..]));
    }

    /// Between the samples of a sine: errors of the position fall with the fourth power of the step, its rates are slopes.
    #[test]
    fn a_sampled_reference_follows_the_curve_between_its_samples() {
        let error = |rate: f64| {
            let wave = |t: f64| (6.0 * t).sin();
            let samples = (2.0 * rate) as usize;
            let position = Series::shaped(1, (0..samples).map(|k| wave(k as f64 / rate)).collect());
            let reference = SampledReference::new(position, rate);
            let at = |t: f64| {
                let [mut q, mut dq, mut ddq] = [[0.0]; 3];
                reference.evaluate(t, &mut q, &mut dq, &mut ddq);
                [q[0], dq[0], ddq[0]]
            };
            let t = 100.37 / rate;
            let [mut dq, mut ddq, mut dddq] = [[0.0]; 3];
            reference.rates(t, &mut dq, &mut ddq, &mut dddq);
            let step = 1e-3 / rate;
            for ((before, after), slope) in at(t - step).iter().zip(at(t + step)).zip([dq[0], ddq[0], dddq[0]]) {
                let difference = (after - before) / (2.0 * step);
                assert!((difference - slope).abs() < 1e-5 * slope.abs(), "{difference} {slope}");
            }
            (at(t)[0] - wave(t)).abs()
        };
        let [coarse, fine] = [100.0, 200.0].map(error);
        println!("{coarse:.1e} at 100 Hz, {fine:.1e} at 200 Hz; the chord: {:.1e}", 36.0 / (8.0 * 1e4));
        assert!(coarse < 36.0 / (8.0 * 1e4) / 50.0 && fine < coarse / 4.0);
    }

    #[test]
    fn a_periodic_reference_holds_where_its_recording_ends() {
        let (rate, samples) = (100.0, 1030);
        let wave = |k: usize| (std::f64::consts::TAU * k as f64 / 130.0).sin();
        let position = Series::shaped(1, (0..samples).map(wave).collect());
        let low_pass = LowPass { sample_rate_hz: rate, order: 4, cutoff_hz: 20.0 };
        let periodic = find_periodic(&position, &(0..samples), low_pass).unwrap();
        let rest = SampledReference::new(Series::shaped(1, vec![0.0; samples]), rate);
        let reference = Reference::Periodic(PeriodicReference::new(periodic.series, rest));
        let at = |t: f64| {
            let [mut q, mut dq, mut ddq] = [[0.0]; 3];
            reference.evaluate(t, &mut q, &mut dq, &mut ddq);
            q[0]
        };
        let end = samples - 1;
        for k in [130, 333, end] {
            assert!(
                (at(k as f64 / rate) - wave(k)).abs() < 1e-6,
                "sample {k}: {} against {}",
                at(k as f64 / rate),
                wave(k)
            );
        }
        assert_eq!(at(end as f64 / rate + 0.4), at(end as f64 / rate));
    }
}
