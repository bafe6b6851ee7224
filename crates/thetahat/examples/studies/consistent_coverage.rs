//! How often intervals of consistent estimates hold the true value, how much nearer to it the estimates are, and how often
//! the test rejects a robot that is consistent: the table of `docs/theory/physical_consistency.md`.
//!
//! `cargo run --release -p thetahat --example studies -- consistent_coverage [seeds] [draws of the bootstrap]`
//!
//! Regressions `z = R theta + s n` with white noise n, R the triangular factor of 400 random states. The truth lies inside
//! the consistent set (the a-priori parameters) or on its boundary (the consistent parameters nearest to a noisy estimate).

use std::{error::Error, path::Path};

use rand::{Rng, RngExt as _, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{ChiSquared, Distribution, StandardNormal};
use thetahat::{
    Matrix, Robot,
    base_parameters::BaseParameters,
    consistency::{ConsistencyError, ConsistentFit, ConsistentSet, LeastSquares, Prior, completed_a_priori, fit},
    dynamics::{Model, Sign, State, Workspace},
    regressor::Regressor,
    statistics::{f_probability, t_quantile},
};
use thetahat_ground::linear_algebra::{PivotedQr, norm};
use thetahat_model::consistency::{bounds_of, interval_in};

const STATES: usize = 400;
/// Standard deviation of the noise, relative to the root mean square of the torques.
const NOISE: f64 = 0.3;
const PRIOR_WEIGHT: f64 = 1e-3;

struct Twin {
    set: ConsistentSet,
    base: BaseParameters,
    r: Matrix,
    /// Of `R^-1 R^-T`.
    unit_deviations: Vec<f64>,
    factor: PivotedQr,
    rows: usize,
}

/// A draw: the free estimate, the variance of its errors, and the consistent estimate.
struct Draw {
    free: Vec<f64>,
    variance: f64,
    found: ConsistentFit,
}

#[derive(Default)]
struct Tally {
    intervals: f64,
    free: f64,
    consistent: f64,
    bootstrap: [f64; 2],
    squares: [f64; 2],
    widths: [f64; 2],
    outside: f64,
    rejected: f64,
    draws: f64,
}

/// Runs the study.
pub fn main() -> Result<(), Box<dyn Error>> {
    let argument = |k: usize| super::arguments().nth(k - 1).map(|a| a.parse::<usize>()).transpose();
    let (seeds, draws) = (argument(1)?.unwrap_or(500), argument(2)?.unwrap_or(0));
    println!(
        "| robot | truth | free intervals, % | consistent, % | width | bootstrap, % | error | not consistent, % | rejected, % |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    for (name, path) in
        [("two_joint", "robots/two_joint.toml"), ("TX40", "robots/tx40.toml"), ("UR10", "robots/ur10.toml")]
    {
        let twin = Twin::new(&Robot::read(Path::new(path))?)?;
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let inside =
            twin.set.a_priori().iter().map(|v| v.max(0.05 * f64::from(u8::from(*v == 0.0)))).collect::<Vec<_>>();
        let inside = twin.base.from_standard(if twin.is_usual(&inside) { &inside } else { twin.set.a_priori() });
        let scale = NOISE * norm(&twin.r.times(&inside)) / (twin.rows as f64).sqrt();
        let boundary = twin.draw(&inside, 3.0 * scale, &mut rng)?.found.standard;
        let boundary = twin.base.from_standard(&boundary);
        for (place, truth) in [("inside", &inside), ("boundary", &boundary)] {
            // The refits of the larger robots take some ten times longer: one seed in ten has them.
            let every = if name == "two_joint" { 1 } else { 10 };
            let tally = twin.tally(truth, scale, Draws { seeds, draws, every }, &mut rng)?;
            tally.print(name, place);
        }
    }
    Ok(())
}

/// How many data sets are drawn, and how many refits for every how many-th of them.
#[derive(Clone, Copy)]
struct Draws {
    seeds: usize,
    draws: usize,
    every: usize,
}

impl Twin {
    fn new(robot: &Robot) -> Result<Self, Box<dyn Error>> {
        let set = ConsistentSet::new(robot, &completed_a_priori(robot, None))?;
        let model = Model::new(robot);
        let base = BaseParameters::of(&model, &[])?;
        let x = observations(&model, &base);
        let (rows, r) = (x.rows(), x.triangular_factor());
        let factor = PivotedQr::with_equal_columns(&r);
        let covariance = factor.inverse_gram();
        let unit_deviations = (0..base.len()).map(|i| covariance.at(i, i).sqrt()).collect();
        Ok(Self { set, base, r, unit_deviations, factor, rows })
    }

    /// Whether standard parameters are in the set, but for equalities.
    fn is_usual(&self, standard: &[f64]) -> bool {
        self.set.margins(standard).iter().all(|(_, margin)| *margin >= 0.0)
    }

    fn freedom(&self) -> f64 {
        (self.rows - self.base.len()) as f64
    }

    fn draw(&self, truth: &[f64], scale: f64, rng: &mut impl Rng) -> Result<Draw, Box<dyn Error>> {
        let noise = |rng: &mut dyn FnMut() -> f64| scale * rng();
        let mut normal = || -> f64 { StandardNormal.sample(rng) };
        let z: Vec<f64> = self.r.times(truth).into_iter().map(|v| v + noise(&mut normal)).collect();
        let chi: f64 = ChiSquared::new(self.freedom())?.sample(rng);
        let (free, variance) = (self.factor.solve(&z), scale * scale * chi / self.freedom());
        let found = self.consistent(z, variance)?;
        Ok(Draw { free, variance, found })
    }

    fn consistent(&self, z: Vec<f64>, variance: f64) -> Result<ConsistentFit, ConsistencyError> {
        let data = LeastSquares::in_base(&self.r, z, &self.base, self.set.parameter_table().len())?;
        fit(&self.set, &data, Prior::LogDet { weight: PRIOR_WEIGHT * variance }, None)
    }

    fn tally(
        &self,
        truth: &[f64],
        scale: f64,
        Draws { seeds, draws, every }: Draws,
        rng: &mut ChaCha8Rng,
    ) -> Result<Tally, Box<dyn Error>> {
        let mut tally = Tally::default();
        let quantile = t_quantile(0.975, self.freedom()).ok_or("no quantile")?;
        for seed in 0..seeds {
            let draw = self.draw(truth, scale, rng)?;
            let theta = self.base.from_standard(&draw.found.standard);
            let refits = self.refits(&theta, &draw, if seed % every == 0 { draws } else { 0 }, rng)?;
            for (i, parameter) in self.base.parameters().iter().enumerate() {
                let deviation = draw.variance.sqrt() * self.unit_deviations[i];
                let half = quantile * deviation;
                let free = [draw.free[i] - half, draw.free[i] + half];
                let consistent = interval_in(bounds_of(&self.set, parameter), free, theta[i]);
                tally.add(truth[i], free, consistent, [draw.free[i], theta[i]].map(|v| (v - truth[i]) / deviation));
                tally.add_bootstrap(truth[i], refits.iter().map(|r| r[i]).collect());
            }
            tally.draws += 1.0;
            tally.outside += f64::from(u8::from(draw.found.squared_residual > 1e-2 * draw.variance));
            tally.rejected += f64::from(u8::from(self.p_value(&draw).is_some_and(|p| p < 0.05)));
        }
        Ok(tally)
    }

    fn p_value(&self, draw: &Draw) -> Option<f64> {
        let taken = (self.base.len() as f64 - draw.found.effective_parameters).max(1.0);
        f_probability(draw.found.squared_residual / (taken * draw.variance), taken, self.freedom())
    }

    /// Consistent estimates of data drawn from one.
    fn refits(
        &self,
        theta: &[f64],
        draw: &Draw,
        draws: usize,
        rng: &mut ChaCha8Rng,
    ) -> Result<Vec<Vec<f64>>, Box<dyn Error>> {
        let one = |_| -> Result<Vec<f64>, Box<dyn Error>> {
            Ok(self.base.from_standard(&self.draw(theta, draw.variance.sqrt(), rng)?.found.standard))
        };
        (0..draws).map(one).collect()
    }
}

impl Tally {
    fn add(&mut self, truth: f64, free: [f64; 2], consistent: [f64; 2], errors: [f64; 2]) {
        let holds = |[low, high]: [f64; 2]| f64::from(u8::from((low..=high).contains(&truth)));
        self.intervals += 1.0;
        self.free += holds(free);
        // Rounding of a truth at its bound.
        self.consistent +=
            holds([consistent[0] - 1e-9 * truth.abs() - 1e-9, consistent[1] + 1e-9 * truth.abs() + 1e-9]);
        (0..2).for_each(|k| self.squares[k] += errors[k] * errors[k]);
        self.widths[0] += 1.0;
        self.widths[1] += (consistent[1] - consistent[0]) / (free[1] - free[0]);
    }

    fn add_bootstrap(&mut self, truth: f64, mut refits: Vec<f64>) {
        refits.sort_by(f64::total_cmp);
        let at = |part: f64| refits.get(((refits.len() as f64 + 1.0) * part) as usize).copied();
        if let (Some(low), Some(high)) = (at(0.025), at(0.975)) {
            self.bootstrap[0] += f64::from(u8::from((low..=high).contains(&truth)));
            self.bootstrap[1] += 1.0;
        }
    }

    fn print(&self, robot: &str, truth: &str) {
        let percent = |part: f64, of: f64| if of > 0.0 { format!("{:.1}", 100.0 * part / of) } else { "-".to_owned() };
        println!(
            "| {robot} | {truth} | {} | {} | {:.2} | {} | {:.2} | {} | {} |",
            percent(self.free, self.intervals),
            percent(self.consistent, self.intervals),
            self.widths[1] / self.widths[0],
            percent(self.bootstrap[0], self.bootstrap[1]),
            (self.squares[1] / self.squares[0]).sqrt(),
            percent(self.outside, self.draws),
            percent(self.rejected, self.draws),
        );
    }
}

fn observations(model: &Model, base: &BaseParameters) -> Matrix {
    let (columns, n) = (base.columns(), model.coordinate_count());
    let regressor = Regressor::new(model, &columns);
    let (mut workspace, mut phi) = (Workspace::new(model), vec![0.0; regressor.entries().len()]);
    let mut rng = ChaCha8Rng::seed_from_u64(0);
    let mut x = Matrix::zeros(STATES * n, columns.len());
    for k in 0..STATES {
        let [q, dq, ddq] =
            [3.0, 2.0, 10.0].map(|most: f64| (0..n).map(|_| rng.random_range(-most..most)).collect::<Vec<_>>());
        regressor.evaluate(model, State::new(&q, &dq), &ddq, Sign::Exact, &mut workspace, &mut phi);
        for (entry, value) in regressor.entries().iter().zip(&phi) {
            *x.at_mut(k * n + entry.joint, entry.column) = *value;
        }
    }
    x
}
