use crate::{series::Series, trajectory::Moves};

/// The joint motion that the controller is asked to follow.
#[derive(Debug, Clone, PartialEq)]
pub enum Reference {
    /// A recorded reference, known at its samples.
    Sampled(SampledReference),
    /// Synchronised moves, known at any time.
    Moves(Moves),
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
    /// The slopes between the samples; zero before the first and behind the last.
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

/// Times this close to a sample, in samples, are that sample: k * T is not exact.
const SAME_SAMPLE: f64 = 1e-6;

impl Reference {
    /// Position, velocity and acceleration at time `t` in s.
    pub fn evaluate(&self, t: f64, q: &mut [f64], dq: &mut [f64], ddq: &mut [f64]) {
        match self {
            Self::Sampled(sampled) => sampled.evaluate(t, q, dq, ddq),
            Self::Moves(moves) => moves.evaluate(t, q, dq, ddq),
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
        }
    }

    /// The reference in other coordinates: `position` maps points, and its linear part `rate` the derivatives.
    pub(super) fn mapped(&self, position: &dyn Fn(&[f64]) -> Vec<f64>, rate: &dyn Fn(&[f64]) -> Vec<f64>) -> Self {
        match self {
            Self::Moves(moves) => Self::Moves(moves.mapped(position)),
            Self::Sampled(SampledReference { sample_rate_hz, q, dq, ddq }) => Self::Sampled(SampledReference {
                sample_rate_hz: *sample_rate_hz,
                q: mapped(q, position),
                dq: mapped(dq, rate),
                ddq: mapped(ddq, rate),
            }),
        }
    }

    /// Number of joints.
    #[must_use]
    pub fn joints(&self) -> usize {
        match self {
            Self::Sampled(sampled) => sampled.q.channels(),
            Self::Moves(moves) => moves.joints(),
        }
    }
}

fn mapped(series: &Series, map: &dyn Fn(&[f64]) -> Vec<f64>) -> Series {
    Series::from_values(series.channels(), (0..series.len()).flat_map(|k| map(series.sample(k))).collect())
}
