//! The observation matrix of many samples, one sample in each lane of a vector of this machine.

use std::ops::Range;

use pulp::{Simd, WithSimd};

use super::observation::Regressor;
use crate::dynamics::{Model, Sign, State, Workspace, gather};
use thetahat_ground::{real::Lanes, series::Series};

impl Regressor {
    /// The entries of `phi` over a motion: one channel for each entry.
    ///
    /// # Panics
    /// If the series differ in length, or have not one channel for each coordinate of the model.
    #[must_use]
    pub fn evaluate_series(&self, model: &Model, q: &Series, dq: &Series, ddq: &Series, sign: Sign) -> Series {
        let mut phi = Series::zeros(q.len(), self.entries().len());
        self.evaluate_samples(model, [q, dq, ddq], 0..q.len(), sign, phi.values_mut());
        phi
    }

    /// `phi(q, dq, ddq) theta` in every sample, one value of `theta` for each column: N m or N, one channel for each coordinate.
    #[doc(hidden)]
    pub fn torques(&self, model: &Model, [q, dq, ddq]: [&Series; 3], sign: Sign, theta: &[f64]) -> Series {
        let mut torque = Series::zeros(q.len(), q.channels());
        if self.entries().is_empty() {
            return torque;
        }
        let mut phi = vec![0.0; self.entries().len()];
        let mut samples = BufferedRegressor::new(self, model, [q, dq, ddq], sign);
        for k in 0..q.len() {
            samples.write(k, &mut phi);
            let tau = torque.sample_mut(k);
            for (entry, value) in self.entries().iter().zip(&phi) {
                tau[entry.joint] += value * theta[entry.column];
            }
        }
        torque
    }

    /// The entries of the samples in `range`, sample by sample.
    pub fn evaluate_samples(
        &self,
        model: &Model,
        [q, dq, ddq]: [&Series; 3],
        range: Range<usize>,
        sign: Sign,
        phi: &mut [f64],
    ) {
        let motion = [q, dq, ddq];
        let done =
            pulp::Arch::new().dispatch(Batches { regressor: self, model, motion, range: range.clone(), sign, phi });
        let mut workspace = Workspace::new(model);
        let rest = phi.chunks_exact_mut(self.entries().len().max(1)).skip(done);
        for (k, phi) in (range.start + done..range.end).zip(rest) {
            let recorded = self.channels().map_or(&[][..], |channels| channels.sample(k));
            let state = State::new(q.sample(k), dq.sample(k)).with_channels(recorded);
            self.evaluate(model, state, ddq.sample(k), sign, &mut workspace, phi);
        }
    }
}

impl Regressor {
    /// All of `phi` for the samples in `range`, zeros included: sample by sample, coordinate by coordinate, column by column.
    pub fn evaluate_rows(
        &self,
        model: &Model,
        motion: [&Series; 3],
        range: Range<usize>,
        sign: Sign,
        rows: &mut [f64],
    ) {
        let (entries, size) = (self.entries().len(), model.coordinate_count() * self.columns());
        let mut phi = vec![0.0; AHEAD.min(range.len()) * entries];
        let starts = range.clone().step_by(AHEAD);
        for (start, rows) in starts.zip(rows.chunks_mut((AHEAD * size).max(1))) {
            let samples = start..range.end.min(start + AHEAD);
            let phi = &mut phi[..samples.len() * entries];
            self.evaluate_samples(model, motion, samples, sign, phi);
            rows.fill(0.0);
            for (row, values) in rows.chunks_exact_mut(size.max(1)).zip(phi.chunks_exact(entries.max(1))) {
                for (entry, value) in self.entries().iter().zip(values) {
                    row[entry.joint * self.columns() + entry.column] = *value;
                }
            }
        }
    }
}

struct Batches<'a> {
    regressor: &'a Regressor,
    model: &'a Model,
    motion: [&'a Series; 3],
    range: Range<usize>,
    sign: Sign,
    phi: &'a mut [f64],
}

impl WithSimd for Batches<'_> {
    /// Number of finished samples: whole batches only.
    type Output = usize;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> usize {
        if Lanes::<S>::COUNT == 1 || self.model.has_loops() {
            // With one lane, and of loops, the kernel for one sample does all the work.
            return 0;
        }
        let (zero, entries) = (Lanes::splat(simd, 0.0), self.regressor.entries().len());
        let mut workspace = Workspace::like(self.model, zero);
        let n = self.model.coordinate_count();
        let [mut q, mut dq, mut ddq] = [(); 3].map(|()| vec![zero; n]);
        let mut recorded = vec![zero; self.regressor.channels().map_or(0, Series::channels)];
        let mut values = vec![zero; entries];
        let mut scratch = vec![0.0; entries * Lanes::<S>::COUNT];
        let batches = self.phi.chunks_exact_mut(entries.max(1) * Lanes::<S>::COUNT);
        let count = batches.len();
        for (batch, phi) in batches.enumerate() {
            let start = self.range.start + batch * Lanes::<S>::COUNT;
            for (series, channels) in self.motion.into_iter().zip([&mut q, &mut dq, &mut ddq]) {
                gather(simd, series, start..start + Lanes::<S>::COUNT, channels);
            }
            if let Some(channels) = self.regressor.channels() {
                gather(simd, channels, start..start + Lanes::<S>::COUNT, &mut recorded);
            }
            let state = State::new(&q, &dq).with_channels(&recorded);
            self.regressor.evaluate_of(self.model, state, &ddq, self.sign, &mut workspace, &mut values);
            scatter(&values, &mut scratch, phi);
        }
        count * Lanes::<S>::COUNT
    }
}

/// Transposes from one sample in each lane to entries sample by sample. `scratch` has the length of `phi`.
#[inline(always)]
fn scatter<S: Simd>(values: &[Lanes<S>], scratch: &mut [f64], phi: &mut [f64]) {
    let lanes = Lanes::<S>::COUNT;
    for (of_samples, value) in scratch.chunks_exact_mut(lanes).zip(values) {
        value.store(of_samples);
    }
    for (lane, phi) in phi.chunks_exact_mut(values.len().max(1)).enumerate() {
        for (entry, of_samples) in phi.iter_mut().zip(scratch.chunks_exact(lanes)) {
            *entry = of_samples[lane];
        }
    }
}

/// Number of samples computed ahead.
const AHEAD: usize = 64;

/// The entries of `phi`, requested sample by sample and computed in batches.
#[derive(Debug)]
pub struct BufferedRegressor<'a> {
    regressor: &'a Regressor,
    model: &'a Model,
    motion: [&'a Series; 3],
    sign: Sign,
    start: usize,
    phi: Vec<f64>,
}

impl<'a> BufferedRegressor<'a> {
    /// The entries over a motion `q, dq, ddq`.
    #[must_use]
    pub fn new(regressor: &'a Regressor, model: &'a Model, motion: [&'a Series; 3], sign: Sign) -> Self {
        Self { regressor, model, motion, sign, start: 0, phi: Vec::new() }
    }

    /// Number of entries of a sample.
    #[doc(hidden)]
    #[must_use]
    pub fn count(&self) -> usize {
        self.regressor.entries().len()
    }

    /// Writes the entries at sample `k`.
    pub fn write(&mut self, k: usize, entries: &mut [f64]) {
        let length = entries.len();
        let place = |start: usize| k.checked_sub(start).map(|ahead| ahead * length);
        let known = place(self.start).filter(|place| *place < self.phi.len());
        let place = known.unwrap_or_else(|| {
            self.compute(k, length);
            0
        });
        entries.copy_from_slice(&self.phi[place..place + length]);
    }

    fn compute(&mut self, start: usize, entries: usize) {
        let end = self.motion[0].len().min(start + AHEAD);
        self.start = start;
        self.phi.resize((end - start) * entries, 0.0);
        self.regressor.evaluate_samples(self.model, self.motion, start..end, self.sign, &mut self.phi);
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::robot::Robot;

    #[test]
    fn rows_hold_the_entries_in_their_places_and_zeros() {
        let text = "name = 'r'\n[[joint]]\nname = 'a'\nkind = 'revolute'\n[[joint]]\nname = 'b'\nkind = 'prismatic'\nalpha_deg = 90";
        let model = Model::new(&Robot::parse(text, Path::new("r.toml")).unwrap());
        let regressor = Regressor::new(&model, &[5, 11, 19, 25]);
        // More than two batches, and a remainder.
        let (samples, range) = (2 * AHEAD + 7, 3..2 * AHEAD + 7);
        let motion =
            [0.1, 0.7, 1.3].map(|w| Series::shaped(2, (0..2 * samples).map(|k| (w * k as f64).sin()).collect()));
        let [q, dq, ddq] = [0, 1, 2].map(|i: usize| &motion[i]);
        let entries = regressor.evaluate_series(&model, q, dq, ddq, Sign::Exact);
        let mut rows = vec![f64::NAN; range.len() * 2 * 4];
        regressor.evaluate_rows(&model, [q, dq, ddq], range.clone(), Sign::Exact, &mut rows);
        let mut expected = vec![0.0; rows.len()];
        for (row, k) in expected.chunks_exact_mut(8).zip(range) {
            for (entry, value) in regressor.entries().iter().zip(entries.sample(k)) {
                row[4 * entry.joint + entry.column] = *value;
            }
        }
        assert_eq!(rows, expected);
    }
}
