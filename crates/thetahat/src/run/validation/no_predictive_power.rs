//! Joints whose torque an estimate predicts worse than zero does.

use thetahat_estimation::{
    checks::{Code, Finding, Severity},
    regression::Regression,
};
use thetahat_model::robot::Robot;

/// Relative error of a joint's torque, percent, above which no prediction is better.
const LIMIT_PERCENT: f64 = 100.0;

/// What the torques are that were predicted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::run) enum Data {
    /// Those of the estimate.
    Own,
    /// Of recordings that are held back.
    HeldBack,
}

/// The finding about the joints that are predicted worse than zero; none if all are predicted better.
pub(in crate::run) fn no_predictive_power(
    robot: &Robot,
    regression: &Regression,
    prediction: &[f64],
    data: Data,
) -> Option<Finding> {
    let errors = regression.joint_relative_errors_percent(prediction);
    let worse = |(j, error): (usize, Option<f64>)| Some((robot.joint_of(j) + 1, error.filter(|e| *e > LIMIT_PERCENT)?));
    let worse: Vec<(usize, f64)> = errors.into_iter().enumerate().filter_map(worse).collect();
    let largest = worse.iter().map(|w| w.1).fold(0.0, f64::max);
    let only = if let [(joint, _)] = worse[..] { Some(joint) } else { None };
    let listed: Vec<String> = worse.iter().map(|(joint, error)| format!("{joint} ({error:.0} %)")).collect();
    let joints = if worse.len() == 1 { "joint" } else { "joints" };
    let (severity, which, remedy) = match data {
        Data::Own => (
            Severity::Problem,
            "",
            "do not take their parameters; weighting = \"per-joint\" in [estimation] counts small torques as much as large \
             ones; else look at the findings of these joints",
        ),
        Data::HeldBack => (
            Severity::Warning,
            " of what is held back",
            "do not predict these joints with this estimate; compare speeds, payload and temperature of the recordings",
        ),
    };
    (!worse.is_empty()).then(|| Finding {
        code: Code::WorseThanMean,
        severity,
        joint: only,
        joint_name: only.and_then(|joint| robot.joints.get(joint - 1)).map(|joint| joint.name.clone()),
        value: largest,
        unit: "% of the torque".to_owned(),
        limit: Some(LIMIT_PERCENT),
        message: format!("the torques{which} of {joints} {} are predicted worse than by zero", listed.join(" ")),
        remedy: remedy.to_owned(),
        parameters: Vec::new(),
        step: None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use thetahat_estimation::regression::RowLayout;
    use thetahat_ground::linear_algebra::Matrix;

    #[test]
    fn joints_that_are_predicted_worse_than_zero_stand_in_one_line() {
        let text = "name = 'r'\n[[joint]]\nname = 'a'\nkind = 'revolute'\n[[joint]]\nname = 'b'\nkind = 'revolute'\n";
        let robot = Robot::parse(text, std::path::Path::new("r.toml")).unwrap();
        let y = vec![1.0, -1.0, 2.0, -2.0];
        let regression = Regression::new(Matrix::zeros(4, 1), y, RowLayout::new(2, &[2]));
        let finding = no_predictive_power(&robot, &regression, &[0.9, -0.9, -1.0, 1.0], Data::Own).unwrap();
        assert_eq!(finding.message, "the torques of joint 2 (150 %) are predicted worse than by zero");
        assert_eq!((finding.joint, finding.severity), (Some(2), Severity::Problem));
        let both = no_predictive_power(&robot, &regression, &[-0.9, 0.9, -1.0, 1.0], Data::HeldBack).unwrap();
        assert_eq!(
            both.message,
            "the torques of what is held back of joints 1 (190 %) 2 (150 %) are predicted worse than by zero"
        );
        assert!(no_predictive_power(&robot, &regression, &[0.0; 4], Data::Own).is_none());
    }
}
