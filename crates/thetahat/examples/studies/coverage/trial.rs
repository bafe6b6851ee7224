//! One seed in one condition: estimates and their standard deviations by every method.

use std::{error::Error, sync::Arc};

use thetahat::{
    Matrix, Method,
    dynamics::Sign,
    identification::{Fit, Uncertainty, idim_iv, idim_ls, uncertainty},
    regression::Regression,
    statistics::Sandwich,
};
use thetahat_estimation::identification::{DesignMatrix, Divisor, RowMask};

use super::{noise::Noise, stage::Stage, twin::Twin};

/// Two-sided 95 % of the normal distribution, for the covariances without degrees of freedom of their own.
const NORMAL_95: f64 = 1.959_963_984_540_054;

/// The kinds of interval that are compared.
pub const KINDS: [&str; 6] = ["classical", "per joint", "HC3", "Newey-West", "stationary", "interval_95"];

/// What a method made of a seed.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Estimates less the true values.
    pub error: Vec<f64>,
    /// Half width of each parameter's interval, by kind.
    pub half_width: [Vec<f64>; 6],
}

/// A method with what stays the same from seed to seed: an exact design.
pub struct Exact<'a> {
    twin: &'a Twin,
    regression: Regression,
    influence: Matrix,
    /// Diagonal of `(X_w^T X_w)^-1`.
    inverse_gram: Vec<f64>,
}

impl<'a> Exact<'a> {
    /// Least squares on X of the true motion: IDIM-LS, and without weights DIDIM too.
    pub fn new(twin: &'a Twin, weights: Option<Vec<f64>>) -> Result<Self, Box<dyn Error>> {
        let regression = twin.regression(&twin.x_true, &twin.y_true).with_weights(weights);
        let influence = Method::IDIM_LS.influence(&regression, None)?;
        let weight = |k: usize| regression.weights().map_or(1.0, |w| w[k]);
        let norm = |i| influence.column(i).iter().enumerate().map(|(k, a)| (a / weight(k)).powi(2)).sum();
        let inverse_gram = (0..influence.columns()).map(norm).collect();
        Ok(Self { twin, regression, influence, inverse_gram })
    }

    /// The estimate for errors e of the rows: `A^T e` off.
    pub fn estimate(&self, e: &[f64]) -> Result<Estimate, Box<dyn Error>> {
        let error = self.influence.transposed_times(&Matrix::from_fn(e.len(), 1, |k, _| e[k])).column(0).to_vec();
        let fitted = self.twin.x_true.times(&error);
        let residual: Vec<f64> = e.iter().zip(fitted).map(|(e, f)| e - f).collect();
        let squares: f64 = self.regression.whiten(&residual).iter().map(|r| r.powi(2)).sum();
        let variance = squares / (e.len() - error.len()) as f64;
        let classical = self.inverse_gram.iter().map(|g| (variance * g).sqrt()).collect();
        let sandwich = self.sandwich(&residual);
        let interval = Uncertainty::new(&error, &sandwich.robust())?;
        Ok(Estimate { half_width: half_widths(classical, &sandwich, &interval), error })
    }

    fn sandwich<'s>(&'s self, residual: &'s [f64]) -> Sandwich<'s> {
        Sandwich { design: &self.twin.x_true, influence: &self.influence, residual, rows: &self.regression.layout }
    }
}

fn half_widths(classical: Vec<f64>, sandwich: &Sandwich<'_>, interval: &Uncertainty) -> [Vec<f64>; 6] {
    let of_variances = |v: Vec<f64>| -> Vec<f64> { v.into_iter().map(|v| NORMAL_95 * v.sqrt()).collect() };
    [
        classical.into_iter().map(|sd: f64| NORMAL_95 * sd).collect(),
        of_variances(sandwich.per_joint()),
        of_variances(sandwich.heteroscedastic()),
        of_variances(sandwich.newey_west()),
        sandwich.stationary().iter().map(|v| v.half_width_95().unwrap_or(f64::NAN)).collect(),
        interval.interval_95.iter().map(|[low, high]| 0.5 * (high - low)).collect(),
    ]
}

/// What a method of the program makes of measured rows.
pub fn as_the_program(
    twin: &Twin,
    method: Method,
    regression: &Regression,
    z: Option<&Matrix>,
    fit: &Fit,
) -> Result<Estimate, Box<dyn Error>> {
    let interval = uncertainty(method, regression, z, fit)?;
    let influence = method.influence(regression, z)?;
    let residual = regression.residual(&fit.prediction);
    let design = match method.design() {
        DesignMatrix::Measured => &regression.x,
        DesignMatrix::Simulated => z.ok_or("no instruments")?,
    };
    let sandwich = Sandwich { design, influence: &influence, residual: &residual, rows: &regression.layout };
    let error = fit.theta.iter().zip(&twin.theta).map(|(found, exact)| found - exact).collect();
    Ok(Estimate { error, half_width: half_widths(fit.standard_deviation.clone(), &sandwich, &interval) })
}

/// The methods where their assumptions hold, in the order of [`ASSUMED`].
pub const ASSUMED: [&str; 3] = ["IDIM-LS, exact X", "IDIM-IV, noise-free Z", "DIDIM, exact simulator"];
/// Methods through the chain: LS and IV at every stage, then DIDIM at the last.
pub const CHAIN: usize = 2 * Stage::ALL.len() + 1;
/// The place of DIDIM in the chain.
pub const DIDIM: usize = CHAIN - 1;

/// The place of LS or IV at a stage in the chain.
pub fn place(method: Method, stage: Stage) -> usize {
    stage as usize + if method == Method::IDIM_IV { Stage::ALL.len() } else { 0 }
}

/// What a seed gives: with the assumptions, and through the chain; `None` if it was not run.
#[derive(Debug, Default, PartialEq)]
pub struct Outcome {
    pub assumed: [Option<Estimate>; 3],
    pub chain: [Option<Estimate>; CHAIN],
}

/// What is run.
#[derive(Debug, Clone, Copy)]
pub struct Scope {
    /// IV with errors in X, and LS and IV through the chain, on one seed of so many.
    pub measured_every: u64,
    /// The stages of the chain.
    pub stages: &'static [Stage],
    /// DIDIM with simulations, after the last stage, on one seed of this many; `None` for never.
    pub simulated_every: Option<u64>,
}

/// All seeds of one twin in one condition.
pub struct Trials<'a> {
    twin: &'a Twin,
    noise: Noise,
    scope: Scope,
    unweighted: Exact<'a>,
    weighted: Exact<'a>,
    weights: Vec<f64>,
}

impl<'a> Trials<'a> {
    pub fn new(twin: &'a Twin, noise: Noise, scope: Scope) -> Result<Self, Box<dyn Error>> {
        let per_joint = twin.y_true.len() / twin.model.coordinate_count();
        let deviations = noise.torque_deviation(twin);
        let weights: Vec<f64> = deviations.iter().flat_map(|sd| vec![1.0 / sd; per_joint]).collect();
        Ok(Self {
            twin,
            noise,
            scope,
            unweighted: Exact::new(twin, None)?,
            weighted: Exact::new(twin, Some(weights.clone()))?,
            weights,
        })
    }

    /// The estimates of a seed: LS with equal weights, IV with equal weights, DIDIM weighted per joint.
    pub fn run(&self, seed: u64) -> Result<Outcome, Box<dyn Error>> {
        let twin = self.twin;
        let mut generator = self.noise.generator(seed);
        let noise = self.noise.torque(twin, &mut generator);
        let e = twin.decimate(&noise)?;
        let mut outcome = Outcome::default();
        outcome.assumed[0] = Some(self.unweighted.estimate(&e)?);
        outcome.assumed[2] = Some(self.weighted.estimate(&e)?);
        if !seed.is_multiple_of(self.scope.measured_every) {
            return Ok(outcome);
        }
        let positions = self.noise.positions(twin, &mut generator);
        let y: Vec<f64> = twin.y_true.iter().zip(&e).map(|(y, e)| y + e).collect();
        let with_errors = twin.regression(&twin.matrix_with_errors(&positions)?, &y);
        outcome.assumed[1] = Some(self.iv(&with_errors, &twin.x_true)?);
        let torque = twin.torque_with(&noise);
        for &stage in self.scope.stages {
            let measured = stage.measured(twin, &positions)?;
            let z = measured.instruments()?;
            let regression = measured.regression(measured.matrix(Sign::Exact)?, &torque)?;
            outcome.chain[place(Method::IDIM_LS, stage)] = Some(self.ls(&regression)?);
            outcome.chain[place(Method::IDIM_IV, stage)] = Some(self.iv(&regression, &z)?);
            let simulated = self.scope.simulated_every.is_some_and(|every| seed.is_multiple_of(every));
            if stage == Stage::Derivative && simulated {
                let weighted = regression.with_weights(Some(self.weights.clone()));
                outcome.chain[DIDIM] = self.didim(&weighted, measured.mask.as_ref())?;
            }
        }
        Ok(outcome)
    }

    fn ls(&self, regression: &Regression) -> Result<Estimate, Box<dyn Error>> {
        let fit = idim_ls(regression, Divisor::default())?;
        as_the_program(self.twin, Method::IDIM_LS, regression, None, &fit)
    }

    fn iv(&self, regression: &Regression, z: &Matrix) -> Result<Estimate, Box<dyn Error>> {
        let fit = idim_iv(regression, z, Divisor::default())?;
        as_the_program(self.twin, Method::IDIM_IV, regression, Some(z), &fit)
    }

    /// `None` if the iteration does not converge.
    fn didim(&self, regression: &Regression, mask: Option<&Arc<RowMask>>) -> Result<Option<Estimate>, Box<dyn Error>> {
        let outcome = self.twin.iterate_didim(regression, mask);
        let (Some(fit), Some(z)) = (outcome.fit, outcome.instruments) else { return Ok(None) };
        as_the_program(self.twin, Method::DIDIM, regression, Some(&z), &fit).map(Some)
    }

    /// What noise-free positions and torques give less the truth at each stage, with LS and with IV.
    pub fn noise_free(&self) -> Result<[[Vec<f64>; 2]; 4], Box<dyn Error>> {
        let twin = self.twin;
        let mut of_stages: [[Vec<f64>; 2]; 4] = Default::default();
        for stage in Stage::ALL {
            let measured = stage.measured(twin, &twin.motion.q)?;
            let regression = measured.regression(measured.matrix(Sign::Exact)?, &twin.motion.tau)?;
            let ls = idim_ls(&regression, Divisor::default())?;
            let iv = idim_iv(&regression, &measured.instruments()?, Divisor::default())?;
            let error = |fit: Fit| fit.theta.iter().zip(&twin.theta).map(|(found, exact)| found - exact).collect();
            of_stages[stage as usize] = [ls, iv].map(error);
        }
        Ok(of_stages)
    }

    /// The bound of Cramer and Rao for white noise of the torques: the deviations of weighted least squares on the true motion
    /// with all samples, whose number is that of the rows times the decimation.
    pub fn bound(&self) -> Vec<f64> {
        let decimation = self.twin.experiment.settings.signal.decimation as f64;
        self.weighted.inverse_gram.iter().map(|g| (g / decimation).sqrt()).collect()
    }
}
