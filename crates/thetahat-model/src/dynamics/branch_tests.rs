//! The dynamics of parts that move independently are those of the whole robot.

use std::path::Path;

use super::{DynamicParameters, Model, Sign};
use crate::robot::{Parameter, Robot};
use thetahat_ground::series::Series;
use thetahat_testing::TWO_LEGS;

#[test]
fn the_accelerations_of_branches_are_those_of_the_whole() {
    let robot = Robot::parse(TWO_LEGS, Path::new("legs.toml")).unwrap();
    let whole = Model::new(&robot);
    let theta: Vec<f64> = whole.parameter_table().iter().enumerate().map(|(i, p)| value(i, p)).collect();
    let series = |part: &[usize], w: f64| {
        Series::shaped(
            part.len(),
            (0..5 * 4).filter(|i| part.contains(&(i % 4))).map(|i| (w * i as f64).sin()).collect(),
        )
    };
    let accelerations = |model: &Model, theta: &[f64], part: &[usize]| {
        let motion = [0.7, 1.3, 2.1].map(|w| series(part, w));
        let parameters = DynamicParameters::sorted(model, theta);
        let sign = Sign::smooth(0.1);
        model.forward_dynamics_with_channels(&parameters, motion.each_ref(), None, sign).unwrap()
    };
    let all = accelerations(&whole, &theta, &[0, 1, 2, 3]);
    for branch in robot.branches() {
        let own: Vec<f64> = branch.parameters.iter().map(|&i| theta[i]).collect();
        let of_branch = accelerations(&Model::new(&branch.robot), &own, &branch.coordinates);
        for (c, &coordinate) in branch.coordinates.iter().enumerate() {
            for k in 0..all.len() {
                let (a, b) = (of_branch.sample(k)[c], all.sample(k)[coordinate]);
                assert!((a - b).abs() < 1e-12 * b.abs().max(1.0), "{coordinate} {k}: {a} {b}");
            }
        }
    }
}

/// A heavy body for each link, friction and offsets.
fn value(i: usize, parameter: &Parameter) -> f64 {
    match parameter.quantity.name() {
        "xx" | "yy" | "zz" | "ia" => 0.5 + 0.01 * i as f64,
        "m" => 3.0,
        "iam" => 0.02,
        _ => 0.03 * (1.7 * i as f64).sin(),
    }
}
