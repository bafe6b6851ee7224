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

/// A recorded reference with its derivatives by central differences, linear between its samples.
#[derive(Debug, Clone, PartialEq)]
pub struct SampledReference {
    sample_rate_hz: f64,
    q: Series,
    dq: Series,
    ddq: Series,
}

impl SampledReference {
    /// A reference from its samples, the first at time zero.
    #[must_use]
    pub fn new(q: Series, sample_rate_hz: f64) -> Self {
        let dq = crate::signal::central_difference(&q, sample_rate_hz);
        let ddq = crate::signal::central_difference(&dq, sample_rate_hz);
        Self { sample_rate_hz, q, dq, ddq }
    }

    fn evaluate(&self, t: f64, q: &mut [f64], dq: &mut [f64], ddq: &mut [f64]) {
        let place = (t * self.sample_rate_hz).clamp(0.0, (self.q.len() - 1) as f64);
        let k = (place + SAME_SAMPLE) as usize;
        let part = (place - k as f64).max(0.0);
        let next = (k + 1).min(self.q.len() - 1);
        for (out, series) in [(q, &self.q), (dq, &self.dq), (ddq, &self.ddq)] {
            let (from, to) = (series.sample(k), series.sample(next));
            for (o, (a, b)) in out.iter_mut().zip(from.iter().zip(to)) {
                *o = a + part * (b - a);
            }
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

    /// The slopes between the samples; zero before the first and after the last.
    fn rates(&self, t: f64, dq: &mut [f64], ddq: &mut [f64], dddq: &mut [f64]) {
        let place = t * self.sample_rate_hz;
        let within = place >= 0.0 && place < (self.q.len() - 1) as f64;
        let k = if within { (place + SAME_SAMPLE) as usize } else { 0 };
        let next = if within { (k + 1).min(self.q.len() - 1) } else { 0 };
        for (out, series) in [(dq, &self.q), (ddq, &self.dq), (dddq, &self.ddq)] {
            for (o, (a, b)) in out.iter_mut().zip(series.sample(k).iter().zip(series.sample(next))) {
                *o = (b - a) * self.sample_rate_hz;
            }
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

    /// The derivatives in time of what [`Self::evaluate`] gives; of a sampled reference the slopes between its samples.
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

fn mapped(series: &Series, map: &dyn Fn(&[f64]) -> Vec<f64>) -> Series {
    let values: Vec<f64> = (0..series.len()).flat_map(|k| map(series.sample(k))).collect();
    Series::shaped((values.len() / series.len().max(1)).max(1), values)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trajectory::{LowPass, find_periodic};

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
