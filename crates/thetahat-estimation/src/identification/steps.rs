//! Step control of a fixed-point iteration: which parameters are simulated after an estimate.
//!
//! While the changes shrink, the estimate itself is simulated. If they do not shrink, they are the simulation's errors, or the
//! map from simulated to estimated parameters is no contraction: simulations get finer tolerances, and steps are mixed by
//! Anderson's method, in the metric of the regression (D. G. Anderson, "Iterative procedures for nonlinear integral equations",
//! Journal of the ACM 12(4), 1965; H. F. Walker, P. Ni, SIAM J. Numer. Anal. 49(4), 2011, algorithm AA).

use thetahat_ground::linear_algebra::{Matrix, PivotedQr, dot, norm};

/// Ratio to the smallest change so far below which a change is progress.
const PROGRESS: f64 = 0.8;
/// Iterations in a row without progress after which the next measure is taken.
const WITHOUT_PROGRESS: usize = 2;
/// Factor of the simulations' tolerances at each refinement.
const FINER: f64 = 0.01;
/// Number of steps that are mixed.
const DEPTH: usize = 5;
/// Diagonal entry of R, relative to the largest, below which an older step adds no information.
const DEPENDENT: f64 = 1e-4;
/// Smallest fraction of an estimate's change that is made.
const LEAST_PART: f64 = 1.0 / 16.0;

/// Most refinements.
const REFINEMENTS: usize = 2;
/// Change in standard deviations below which a change that does not shrink is more likely the simulation's error: simulations are refined
/// once more before steps are mixed.
const CLOSE: f64 = 1.0;

/// The measure against changes that do not shrink.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Measure {
    /// Simulations get finer tolerances.
    Refine,
    /// Steps are mixed, and half of each change is made.
    Mix,
}

/// A simulated vector of parameters and the resulting change.
#[derive(Debug, Clone)]
struct Step {
    point: Vec<f64>,
    change: Vec<f64>,
    /// The change in the metric of the regression.
    image: Vec<f64>,
}

/// The step control of one iteration.
#[derive(Debug, Clone)]
pub(super) struct Steps {
    taken: Vec<Step>,
    refinements: usize,
    is_mixed: bool,
    part: f64,
    smallest: f64,
    without_progress: usize,
    /// Factor of the simulations' tolerances.
    pub(super) tolerance: f64,
}

impl Steps {
    pub(super) fn new() -> Self {
        Self {
            taken: Vec::new(),
            refinements: 0,
            is_mixed: false,
            part: 1.0,
            smallest: f64::INFINITY,
            without_progress: 0,
            tolerance: 1.0,
        }
    }

    /// The parameters to simulate next, after those at `point` gave `estimate`. `design` is the matrix whose product with a change is its
    /// effect, and `largest` the largest change in standard deviations, if the point was an estimate.
    pub(super) fn next(&mut self, point: &[f64], estimate: &[f64], design: &Matrix, largest: Option<f64>) -> Vec<f64> {
        let change: Vec<f64> = estimate.iter().zip(point).map(|(e, p)| e - p).collect();
        let image = design.times(&change);
        if self.has_overshot(&image) {
            self.taken.clear();
            self.shorten();
        }
        self.taken.push(Step { point: point.to_vec(), change, image });
        if self.taken.len() > DEPTH {
            self.taken.remove(0);
        }
        if let Some(largest) = largest {
            self.watch(largest);
        }
        if self.is_mixed { self.mixed() } else { estimate.to_vec() }
    }

    /// Forgets the steps so far, which were made with other simulations.
    pub(super) fn restart(&mut self) {
        self.taken.clear();
    }

    /// Whether a mixed step increased the change a lot.
    fn has_overshot(&self, image: &[f64]) -> bool {
        let least = self.taken.iter().map(|s| norm(&s.image)).fold(f64::INFINITY, f64::min);
        self.is_mixed && norm(image) > 2.0 * least
    }

    fn watch(&mut self, largest: f64) {
        self.without_progress = if largest < PROGRESS * self.smallest { 0 } else { self.without_progress + 1 };
        self.smallest = self.smallest.min(largest);
        if self.without_progress < WITHOUT_PROGRESS {
            return;
        }
        if self.refinements == 0 && self.tolerance <= FINER {
            self.refinements = 1;
        }
        match self.measure(largest) {
            Some(Measure::Refine) => {
                self.refinements += 1;
                self.tolerance *= FINER;
                let last = self.taken.len().saturating_sub(1);
                self.taken.drain(..last);
            }
            Some(Measure::Mix) => {
                self.is_mixed = true;
                self.shorten();
            }
            None => return,
        }
        (self.smallest, self.without_progress) = (largest, 0);
    }

    /// The next measure against changes as large as `largest`, in standard deviations. Refinement comes first, unless simulations are fine
    /// already.
    fn measure(&self, largest: f64) -> Option<Measure> {
        let wants_to_refine = self.refinements == 0 || largest < CLOSE || self.is_mixed;
        if self.refinements < REFINEMENTS && wants_to_refine {
            return Some(Measure::Refine);
        }
        (!self.is_mixed).then_some(Measure::Mix)
    }

    fn shorten(&mut self) {
        self.part = (0.5 * self.part).max(LEAST_PART);
    }

    /// The combination of the steps that would minimise the change if the map were affine.
    fn mixed(&self) -> Vec<f64> {
        let Some((last, _)) = self.taken.split_last() else { return Vec::new() };
        let mut next: Vec<f64> = last.point.iter().zip(&last.change).map(|(p, c)| p + self.part * c).collect();
        let pairs = independent_pairs(&self.taken);
        let differences: Vec<Vec<f64>> = pairs.iter().map(|[a, b]| difference(&b.image, &a.image)).collect();
        if differences.is_empty() {
            return next;
        }
        let matrix = Matrix::from_fn(last.image.len(), differences.len(), |i, j| differences[j][i]);
        let weights = PivotedQr::with_equal_columns(&matrix).solve(&last.image);
        for ([a, b], weight) in pairs.iter().zip(weights) {
            let (points, changes) = (difference(&b.point, &a.point), difference(&b.change, &a.change));
            let back = points.iter().zip(changes).map(|(p, c)| weight * (p + self.part * c));
            next.iter_mut().zip(back).for_each(|(n, b)| *n -= b);
        }
        next
    }
}

/// The newest pairs of neighbouring steps whose differences are independent.
fn independent_pairs(taken: &[Step]) -> Vec<[&Step; 2]> {
    let mut pairs: Vec<[&Step; 2]> = Vec::new();
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for pair in taken.windows(2).rev() {
        let [a, b] = pair else { continue };
        let whole = difference(&b.image, &a.image);
        let mut rest = whole.clone();
        for axis in basis.iter().chain(&basis) {
            let along = dot(axis, &rest);
            rest.iter_mut().zip(axis).for_each(|(r, a)| *r -= along * a);
        }
        let size = norm(&rest);
        if size > DEPENDENT * norm(&whole) && size.is_normal() {
            basis.push(rest.iter().map(|r| r / size).collect());
            pairs.push([a, b]);
        }
    }
    pairs
}

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Largest change after several steps of an affine map whose slopes are far from a contraction.
    fn iterate(steps: usize) -> f64 {
        let (slopes, fixed) = ([-3.0, 0.5, 1.8], [1.0, -2.0, 0.5]);
        let design = Matrix::identity(3);
        let mut control = Steps::new();
        let mut point = vec![1.1, -2.2, 0.6];
        let mut largest = f64::INFINITY;
        for _ in 0..steps {
            let estimate: Vec<f64> = (0..3).map(|i| fixed[i] + slopes[i] * (point[i] - fixed[i])).collect();
            largest = estimate.iter().zip(&point).map(|(e, p)| (e - p).abs()).fold(0.0, f64::max);
            point = control.next(&point, &estimate, &design, Some(largest));
        }
        largest
    }

    #[test]
    fn an_affine_map_that_is_no_contraction_is_solved() {
        assert!(iterate(3) > 0.1);
        assert!(iterate(14) < 1e-9, "{}", iterate(14));
    }

    /// The control after several changes of one size that alternate in sign.
    fn after_noise(size: f64, steps: usize) -> Steps {
        let mut control = Steps::new();
        for k in 0..steps {
            let change = if k % 2 == 0 { size } else { -size };
            control.next(&[0.0], &[change], &Matrix::identity(1), Some(size));
        }
        control
    }

    #[test]
    fn changes_that_do_not_shrink_refine_the_simulations_first() {
        for size in [0.1, 10.0] {
            let control = after_noise(size, 4);
            assert_eq!((control.tolerance, control.is_mixed), (FINER, false));
        }
        let [small, large] = [0.1, 10.0].map(|size| after_noise(size, 6));
        assert_eq!((small.tolerance, small.is_mixed), (FINER * FINER, false));
        assert_eq!((large.tolerance, large.is_mixed), (FINER, true));
    }
}
