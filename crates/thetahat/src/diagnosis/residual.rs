use std::cell::LazyCell;

use super::explained::{absorbed, explained};
use thetahat_estimation::{
    regression::Regression,
    statistics::{autocorrelation, jarque_bera, levene, ljung_box, usual_lags},
};
use thetahat_ground::linear_algebra::norm;
use thetahat_report::results::{JointResidual, ResidualResult};

/// The tests of one run's residual.
pub(crate) fn residual(regression: &Regression, prediction: &[f64]) -> ResidualResult {
    let residual = regression.residual(prediction);
    let joints = regression.layout.runs(&residual);
    let shortest = regression.layout.blocks().iter().map(|b| b.rows.len()).min().unwrap_or(0);
    let absorbed = LazyCell::new(|| absorbed(regression));
    let joint = |(j, runs): (usize, &Vec<&[f64]>)| JointResidual {
        explained: explained(regression, j, runs, &|j| absorbed[j]),
        ..joint_residual(j + 1, runs, usual_lags(shortest))
    };
    // A joint that is fitted exactly, as one that is locked and without torque, or that has one row, has no residual to test.
    let is_left = |joint: &JointResidual| joint.rms > 0.0 && joint.autocorrelation.is_finite();
    let whitened = regression.whiten(&residual);
    let whitened: Vec<Vec<f64>> = regression.layout.runs(&whitened).iter().map(|runs| runs.concat()).collect();
    let groups: Vec<&[f64]> =
        whitened.iter().map(Vec::as_slice).filter(|joint| joint.iter().any(|r| *r != 0.0)).collect();
    ResidualResult {
        joints: joints.iter().enumerate().map(joint).filter(is_left).collect(),
        homoscedasticity: levene(&groups),
    }
}

fn joint_residual(joint: usize, runs: &[&[f64]], lags: usize) -> JointResidual {
    let all = runs.concat();
    JointResidual {
        joint,
        rms: norm(&all) / (all.len().max(1) as f64).sqrt(),
        autocorrelation: autocorrelation(runs, 1)[0],
        whiteness: ljung_box(runs, lags),
        normality: jarque_bera(&all),
        explained: None,
    }
}
