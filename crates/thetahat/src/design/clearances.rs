use super::{motions::Motions, quadratic::Row, sums::Derivatives};
use thetahat_ground::series::Series;
use thetahat_model::collision::Scene;
use thetahat_report::results::{CollisionResults, PairDistance};

/// The least distances of shapes along a motion.
#[derive(Debug, Clone)]
pub(super) struct Clearances {
    pub(super) scene: Scene,
    /// Least distance, m.
    pub(super) margin: f64,
}

/// A distance that is missing by so much, m, counts as much as a limit that is exceeded by all of it.
const UNIT: f64 = 0.1;
/// A distance is watched where it is larger than the margin by less than this, m.
const NEAR: f64 = 0.15;
/// Instants of the way from home.
const WAY: usize = 500;

impl Clearances {
    /// Distances at every instant, pair by pair.
    fn distances(&self, q: &Series) -> Vec<Vec<f64>> {
        (0..q.len()).map(|k| self.scene.distances(q.sample(k))).collect()
    }

    /// The first posture at which shapes are too near to one another, and their pair.
    pub(super) fn first_too_near(&self, q: &Series) -> Option<(usize, usize)> {
        (0..q.len()).find_map(|k| {
            let distances = self.scene.distances(q.sample(k));
            distances.iter().position(|distance| *distance < self.margin).map(|pair| (k, pair))
        })
    }

    /// As the use of a limit: one where the least distance is the margin.
    pub(super) fn use_of(&self, motion: &Derivatives) -> f64 {
        let least = self.distances(&motion[0]).into_iter().flatten().fold(f64::INFINITY, f64::min);
        1.0 + (self.margin - least) / UNIT
    }

    /// The rows of a step from a motion, linearised where shapes are nearest to one another.
    pub(super) fn rows(&self, motions: &Motions, x: &[f64], motion: &Derivatives) -> Vec<Row> {
        let distances = self.distances(&motion[0]);
        let mut rows = Vec::new();
        for pair in 0..self.scene.pairs() {
            for k in 0..distances.len() {
                let here = distances[k][pair];
                let is_least = |other: usize| distances[other][pair] >= here;
                let last = distances.len() - 1;
                if here < self.margin + NEAR && is_least(k.saturating_sub(1)) && is_least((k + 1).min(last)) {
                    rows.push(self.row(motions, x, motion, pair, k));
                }
            }
        }
        rows
    }

    fn row(&self, motions: &Motions, x: &[f64], motion: &Derivatives, pair: usize, instant: usize) -> Row {
        let clearance = self.scene.clearance(pair, motion[0].sample(instant));
        let zeros = || Series::zeros(1, clearance.slopes.len());
        let by_motion = [Series::shaped(clearance.slopes.len(), clearance.slopes.clone()), zeros(), zeros()];
        let slopes = motions.chain_at(x, instant, by_motion);
        Row {
            start: 0,
            entries: slopes.into_iter().map(|slope| -slope / UNIT).collect(),
            bound: (clearance.distance - self.margin) / UNIT,
            soft: true,
        }
    }

    /// The least distance of every pair along a motion at a rate and on the straight way from home.
    pub(super) fn results(
        &self,
        q: &Series,
        rate_hz: f64,
        home: Option<&[f64]>,
        uncovered: &[String],
    ) -> CollisionResults {
        let motion = self.distances(q);
        let way = home.map(|home| self.distances(&way(home, q.sample(0)))).unwrap_or_default();
        let of = |pair: usize| {
            let least = |all: &[Vec<f64>]| (0..all.len()).map(|k| (all[k][pair], k)).min_by(|a, b| a.0.total_cmp(&b.0));
            let (distance, k) = least(&motion).unwrap_or((f64::INFINITY, 0));
            let on_way = least(&way).map(|(distance, _)| distance).filter(|on_way| *on_way < distance);
            let [first, second] = self.scene.names(pair).map(str::to_owned);
            PairDistance {
                first,
                second,
                distance: on_way.unwrap_or(distance),
                at_s: on_way.is_none().then_some(k as f64 / rate_hz),
            }
        };
        let mut pairs: Vec<PairDistance> = (0..self.scene.pairs()).map(of).collect();
        pairs.sort_by(|a, b| a.distance.total_cmp(&b.distance));
        let least_of = |(k, distances): (usize, &Vec<f64>)| {
            [k as f64 / rate_hz, distances.iter().copied().fold(f64::INFINITY, f64::min)]
        };
        let least = motion.iter().enumerate().map(least_of).collect();
        CollisionResults { margin: self.margin, least, pairs, uncovered: uncovered.to_vec(), has_way: home.is_some() }
    }
}

fn way(home: &[f64], start: &[f64]) -> Series {
    let mut way = Series::zeros(WAY + 1, home.len());
    for k in 0..=WAY {
        let part = k as f64 / WAY as f64;
        let ends = home.iter().zip(start);
        way.sample_mut(k).iter_mut().zip(ends).for_each(|(q, (home, start))| *q = home + part * (start - home));
    }
    way
}
