use std::ops::Range;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::combination::Combination;
use crate::{
    dynamics::{Model, Sign},
    regressor::Regressor,
};
use thetahat_ground::series::Series;

/// Seed of the random states.
const SEED: u64 = 20_170_703;
/// Additional states for checking.
const CHECKS: usize = 8;
/// Columns smaller than this, relative to the largest, have no effect: they are rounding.
const NO_EFFECT: f64 = 1e-12;
/// Columns larger than this have an effect.
const EFFECT: f64 = 1e-8;

/// Positions, velocities and accelerations, the same at each call. Torque terms may act only at small velocities: for a robot
/// with terms, every second velocity is smaller, by up to four orders of magnitude.
pub(super) fn random_states(model: &Model, count: usize) -> [Series; 3] {
    let coordinates = model.coordinate_count();
    let mut rng = ChaCha8Rng::seed_from_u64(SEED);
    let mut states = [(); 3].map(|()| Series::zeros(count, coordinates));
    for k in 0..count {
        for (series, range) in states.iter_mut().zip([3.0, 2.0, 5.0]) {
            series.sample_mut(k).fill_with(|| rng.random_range(-range..range));
        }
        model.reach(states[0].sample_mut(k));
    }
    if !model.terms().is_empty() {
        for velocity in states[1].values_mut() {
            if rng.random_bool(0.5) {
                *velocity *= 10.0_f64.powf(-rng.random_range(0.0..4.0));
            }
        }
    }
    states
}

/// Values of the recorded channels that torque terms use, the same at each call; none if no term uses one.
pub(super) fn random_channels(model: &Model, count: usize) -> Option<Series> {
    let width = model.channels().len() * model.coordinate_count();
    let mut rng = ChaCha8Rng::seed_from_u64(SEED + 2);
    let values = (0..count * width).map(|_| rng.random_range(-50.0..50.0)).collect();
    (width > 0).then(|| Series::shaped(width, values))
}

/// The entries of `phi` in random states, each column divided by its norm over all of them.
pub(super) struct Observations {
    /// Number of states, without the check states, which follow.
    states: usize,
    entries: usize,
    /// State by state, as the regressor wrote them.
    phi: Vec<f64>,
    columns: Vec<Observed>,
}

struct Observed {
    /// The coordinates on which the column acts, rising, with the indices of the entries.
    places: Vec<(usize, usize)>,
    /// One by its norm; zero where it has no effect.
    scale: f64,
    /// In each state, the sum over the coordinates with random weights, scaled.
    combined: Vec<f64>,
}

impl Observations {
    /// The observations of the standard parameters at `indices`, in `states` states; `None` if it is not clear which have an
    /// effect.
    pub(super) fn new(model: &Model, indices: &[usize], states: usize) -> Option<Self> {
        let regressor = Regressor::new(model, indices).with_channels(random_channels(model, states + CHECKS));
        let (entries, all) = (regressor.entries().len(), states + CHECKS);
        let [q, dq, ddq] = random_states(model, all);
        let mut phi = vec![0.0; entries * all];
        regressor.evaluate_samples(model, [&q, &dq, &ddq], 0..all, Sign::Exact, &mut phi);
        let mut observations = Self { states, entries, phi, columns: Observed::of(&regressor, all) };
        observations.combine(&regressor, &random_weights(model.coordinate_count(), all))?;
        Some(observations)
    }

    /// Norms, and sums over the coordinates.
    fn combine(&mut self, regressor: &Regressor, weights: &Series) -> Option<()> {
        let mut squares = vec![0.0; self.columns.len()];
        for (k, phi) in self.phi.chunks_exact(self.entries.max(1)).enumerate() {
            let weights = weights.sample(k);
            for (entry, value) in regressor.entries().iter().zip(phi) {
                squares[entry.column] += value * value;
                self.columns[entry.column].combined[k] += weights[entry.joint] * value;
            }
        }
        let largest = squares.iter().copied().fold(0.0, f64::max).sqrt();
        self.columns.iter_mut().zip(squares).try_for_each(|(column, square)| column.set_scale(square.sqrt(), largest))
    }

    /// Number of columns.
    pub(super) fn columns(&self) -> usize {
        self.columns.len()
    }

    /// The factor by which a column was multiplied; zero for a column without effect.
    pub(super) fn scale(&self, column: usize) -> f64 {
        self.columns[column].scale
    }

    /// The coordinates on which a column acts, from the last to the first; none if it has no effect.
    pub(super) fn coordinates(&self, column: usize) -> impl Iterator<Item = usize> {
        let Observed { places, scale, .. } = &self.columns[column];
        places.iter().rev().map(|(coordinate, _)| *coordinate).filter(move |_| *scale > 0.0)
    }

    /// The torques of a coordinate.
    pub(super) fn torques(&self, coordinate: usize, combination: &Combination) -> Vec<f64> {
        let mut torques = vec![0.0; self.states];
        for (&column, factor) in combination {
            let Observed { places, scale, .. } = &self.columns[column];
            if let Some((_, entry)) = places.iter().rev().find(|(c, _)| *c == coordinate) {
                let values = self.phi[*entry..].iter().step_by(self.entries);
                torques.iter_mut().zip(values).for_each(|(t, v)| *t += factor * scale * v);
            }
        }
        torques
    }

    /// The sums of the torques of all coordinates with random weights.
    pub(super) fn combined(&self, combination: &Combination) -> Vec<f64> {
        self.sums(0..self.states, combination)
    }

    /// The sums in the check states.
    pub(super) fn check(&self, combination: &Combination) -> Vec<f64> {
        self.sums(self.states..self.states + CHECKS, combination)
    }

    fn sums(&self, states: Range<usize>, combination: &Combination) -> Vec<f64> {
        let mut sums = vec![0.0; states.len()];
        for (&column, factor) in combination {
            let of_column = &self.columns[column].combined[states.clone()];
            sums.iter_mut().zip(of_column).for_each(|(s, v)| *s += factor * v);
        }
        sums
    }
}

fn random_weights(coordinates: usize, states: usize) -> Series {
    let mut rng = ChaCha8Rng::seed_from_u64(SEED + 1);
    let mut weights = Series::zeros(states, coordinates);
    weights.values_mut().fill_with(|| rng.random_range(-1.0..1.0));
    weights
}

impl Observed {
    fn of(regressor: &Regressor, states: usize) -> Vec<Self> {
        let empty = || Self { places: Vec::new(), scale: 0.0, combined: vec![0.0; states] };
        let mut columns: Vec<Self> = (0..regressor.columns()).map(|_| empty()).collect();
        for (place, entry) in regressor.entries().iter().enumerate() {
            columns[entry.column].places.push((entry.joint, place));
        }
        columns.iter_mut().for_each(|column| column.places.sort_unstable());
        columns
    }

    fn set_scale(&mut self, norm: f64, largest: f64) -> Option<()> {
        if norm > NO_EFFECT * largest {
            self.scale = 1.0 / norm;
            self.combined.iter_mut().for_each(|v| *v *= self.scale);
        }
        (self.scale == 0.0 || norm > EFFECT * largest).then_some(())
    }
}
