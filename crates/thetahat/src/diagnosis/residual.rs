use super::explained::explained;
use crate::{
    linear_algebra::norm,
    regression::Regression,
    results::{JointResidual, ResidualResult},
    statistics::{autocorrelation, jarque_bera, levene, ljung_box, usual_lags},
};

/// The tests of one run's residual.
pub(crate) fn residual(regression: &Regression, prediction: &[f64]) -> ResidualResult {
    let residual = regression.residual(prediction);
    let joints = regression.layout.split(&residual);
    let joint = |(j, blocks): (usize, &Vec<&[f64]>)| JointResidual {
        explained: explained(regression, j, blocks),
        ..joint_residual(j + 1, blocks)
    };
    // A joint that is fitted exactly, as one that is locked and without torque, has no residual to test.
    let is_left = |joint: &JointResidual| joint.rms > 0.0;
    let whitened = regression.layout.by_joint(&regression.whiten(&residual));
    let groups: Vec<&[f64]> =
        whitened.iter().map(Vec::as_slice).filter(|joint| joint.iter().any(|r| *r != 0.0)).collect();
    ResidualResult {
        joints: joints.iter().enumerate().map(joint).filter(is_left).collect(),
        homoscedasticity: levene(&groups),
    }
}

fn joint_residual(joint: usize, blocks: &[&[f64]]) -> JointResidual {
    let all = blocks.concat();
    let shortest = blocks.iter().map(|s| s.len()).min().unwrap_or(0);
    JointResidual {
        joint,
        rms: norm(&all) / (all.len().max(1) as f64).sqrt(),
        autocorrelation: autocorrelation(blocks, 1)[0],
        whiteness: ljung_box(blocks, usual_lags(shortest)),
        normality: jarque_bera(&all),
        explained: None,
    }
}
