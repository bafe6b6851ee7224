use crate::design::{
    limits::joint_limits::JointLimits,
    motions::{family::MotionPoint, sums::Derivatives},
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use thetahat_ground::{quadratic_program::Row, series::Series};
use thetahat_model::collision::Scene;
use thetahat_report::results::{CollisionResults, PairDistance};

/// The least distances of shapes along a motion.
#[derive(Debug, Clone)]
pub(in crate::design) struct Clearances {
    pub(in crate::design) scene: Scene,
    /// Least distance, m.
    pub(in crate::design) margin: f64,
}

/// A distance this far below the margin, m, counts as much as a limit exceeded by 100 %.
const UNIT: f64 = 0.1;
/// Distances within this of the margin, m, are constrained.
const NEAR: f64 = 0.15;
/// Random postures at which pairs are measured before the search.
const POSTURES: usize = 2000;
/// Instants on the path from home.
const PATH_INSTANTS: usize = 500;

impl Clearances {
    /// Distances at every instant, pair by pair.
    fn distances(&self, q: &Series) -> Vec<Vec<f64>> {
        (0..q.len()).map(|k| self.scene.distances(q.sample(k))).collect()
    }

    /// The first posture at which shapes are closer than the margin, and their pair.
    pub(in crate::design) fn first_too_near(&self, q: &Series) -> Option<(usize, usize)> {
        (0..q.len()).find_map(|k| {
            let distances = self.scene.distances(q.sample(k));
            distances.iter().position(|distance| *distance < self.margin).map(|pair| (k, pair))
        })
    }

    /// A pair that is nearer than the margin at each of many postures within the limits, and its largest distance there.
    pub(in crate::design) fn never_apart(&self, limits: &[JointLimits]) -> Option<(usize, f64)> {
        let mut rng = ChaCha8Rng::seed_from_u64(0);
        let mut furthest = vec![f64::NEG_INFINITY; self.scene.pairs()];
        for _ in 0..POSTURES {
            let q: Vec<f64> = limits.iter().map(|l| l.lower + (l.upper - l.lower) * rng.random::<f64>()).collect();
            let distances = self.scene.distances(&q);
            furthest.iter_mut().zip(distances).for_each(|(most, distance)| *most = most.max(distance));
        }
        let nearest = furthest.into_iter().enumerate().min_by(|a, b| a.1.total_cmp(&b.1))?;
        (nearest.1 < self.margin).then_some(nearest)
    }

    /// The distances as the use of a limit: one when the least distance is the margin.
    pub(in crate::design) fn use_of(&self, motion: &Derivatives) -> f64 {
        let least = self.distances(&motion[0]).into_iter().flatten().fold(f64::INFINITY, f64::min);
        1.0 + (self.margin - least) / UNIT
    }

    /// The rows of a step from a motion, linearised at the local minima of each distance.
    pub(in crate::design) fn rows(&self, at: MotionPoint<'_>) -> Vec<Row> {
        let distances = self.distances(&at.motion[0]);
        let mut rows = Vec::new();
        for pair in 0..self.scene.pairs() {
            for k in 0..distances.len() {
                let here = distances[k][pair];
                let is_least = |other: usize| distances[other][pair] >= here;
                let last = distances.len() - 1;
                if here < self.margin + NEAR && is_least(k.saturating_sub(1)) && is_least((k + 1).min(last)) {
                    rows.push(self.row(at, pair, k));
                }
            }
        }
        rows
    }

    fn row(&self, at: MotionPoint<'_>, pair: usize, instant: usize) -> Row {
        let MotionPoint { motions, x, motion } = at;
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

    /// The least distance of every pair along a motion at a rate and on the straight path from home.
    pub(in crate::design) fn results(
        &self,
        q: &Series,
        rate_hz: f64,
        home: Option<&[f64]>,
        uncovered: &[String],
    ) -> CollisionResults {
        let motion = self.distances(q);
        let path = home.map(|home| self.distances(&path_from(home, q.sample(0)))).unwrap_or_default();
        let of = |pair: usize| {
            let least = |all: &[Vec<f64>]| (0..all.len()).map(|k| (all[k][pair], k)).min_by(|a, b| a.0.total_cmp(&b.0));
            let (distance, k) = least(&motion).unwrap_or((f64::INFINITY, 0));
            let on_path = least(&path).map(|(distance, _)| distance).filter(|on_path| *on_path < distance);
            let [first, second] = self.scene.names(pair).map(str::to_owned);
            PairDistance {
                first,
                second,
                distance: on_path.unwrap_or(distance),
                at_s: on_path.is_none().then_some(k as f64 / rate_hz),
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

fn path_from(home: &[f64], start: &[f64]) -> Series {
    let mut path = Series::zeros(PATH_INSTANTS + 1, home.len());
    for k in 0..=PATH_INSTANTS {
        let part = k as f64 / PATH_INSTANTS as f64;
        let ends = home.iter().zip(start);
        path.sample_mut(k).iter_mut().zip(ends).for_each(|(q, (home, start))| *q = home + part * (start - home));
    }
    path
}
