//! The design that tests vary, and what they ask of results.

use std::path::Path;

use thetahat::{
    Experiment, Robot, Series,
    design::{Design, DesignError},
    dynamics::{DynamicParameters, Model, Sign, State, Workspace},
    preparation::PreparationError,
    results::DesignResults,
};
use thetahat_report::results::Limited;
use thetahat_testing::{Folder, project};

/// A planar arm of two joints.
pub const DESIGN: &str = "title = 'two joints'\nrobot = 'two_joint.toml'\nduration_s = 4\nsample_rate_hz = 500\n\
    [motion]\nharmonics = 3\nstarts = 2\n\
    [limits]\nposition = [[-90, 90], [-120, 120]]\nvelocity = [250, 350]\nacceleration = [1500, 2000]\ntorque = [60, 25]\n\
    [noise]\ntorque = 0.1\n[signal]\ncutoff_hz = 40\ndecimation = 10\n";

pub fn parse(text: &str) -> Result<Design, Box<DesignError>> {
    Design::parse(text, &project("robots/design.toml")).map_err(Box::new)
}

pub fn refused(from: &str, to: &str) -> Box<DesignError> {
    assert!(DESIGN.contains(from), "{from}");
    match parse(&DESIGN.replace(from, to)) {
        Err(error) => error,
        Ok(_) => panic!("{to} is taken"),
    }
}

/// The key of a value that is refused.
pub fn key(from: &str, to: &str) -> String {
    let error = refused(from, to);
    key_of(*error)
}

pub fn key_of(error: DesignError) -> String {
    let text = error.to_string();
    let DesignError::Preparation { source, .. } = error else { panic!("{text}") };
    let (PreparationError::Value { key, .. } | PreparationError::NotPositive { key, .. }) = source else {
        panic!("{text}")
    };
    key
}

/// The samples of a design are within the limits that it names, and as large as it says.
pub fn assert_within_limits(results: &DesignResults) {
    for limit in &results.limits {
        let channel = |series: &Series| series.channel(limit.coordinate);
        let values = match limit.quantity {
            Limited::Position => channel(&results.q),
            Limited::Velocity => channel(&results.dq),
            Limited::Acceleration => channel(&results.ddq),
            Limited::Jerk => differences(&channel(&results.ddq), results.sample_rate_hz),
            Limited::Torque => channel(&results.torque),
            Limited::Power => {
                channel(&results.torque).iter().zip(channel(&results.dq)).map(|(tau, v)| tau * v).collect()
            }
        };
        let [least, most] = [f64::min, f64::max].map(|better| values.iter().copied().reduce(better).unwrap());
        let [lower, upper] = limit.limit;
        assert!(least >= lower && most <= upper, "{limit:?}: from {least} to {most}");
        let slack = 0.02 * (upper - lower);
        assert!(least >= limit.reached[0] - slack && most <= limit.reached[1] + slack, "{limit:?}: {least} {most}");
        assert!(least <= limit.reached[0] + slack && most >= limit.reached[1] - slack, "{limit:?}: {least} {most}");
    }
}

/// Mean slopes between samples.
pub fn differences(values: &[f64], rate_hz: f64) -> Vec<f64> {
    values.windows(2).map(|pair| (pair[1] - pair[0]) * rate_hz).collect()
}

/// The design with its controller, whose loop is simulated.
pub fn with_controller() -> String {
    format!(
        "{DESIGN}[controller]\nlaw = 'pd'\nbandwidth_hz = [10]\ndamping = 1.0\nvelocity_feed_forward = 1.0\n\
         acceleration_feed_forward = 1.0\n"
    )
}

/// The twin of a design's rehearsal, in a folder beside the robot.
pub fn rehearsal(folder: &Folder, text: &str) -> (Design, thetahat::results::DesignResults, Experiment) {
    folder.write("two_joint.toml", std::fs::read(project("robots/two_joint.toml")).unwrap());
    let design = Design::parse(text, &folder.path().join("design.toml")).unwrap();
    let results = design.run(2).unwrap();
    let out = folder.path().join("out");
    thetahat_report::report::write_design(&results, &out).unwrap();
    let experiment = Experiment::read(&out.join("rehearsal.toml"), Path::new("")).unwrap();
    (design, results, experiment)
}

/// A planar arm that moves from posture to posture.
pub fn moves(jerk: &str) -> String {
    DESIGN.replace("harmonics = 3", "kind = 'moves'\nmoves = 6").replace("[noise]", &format!("{jerk}\n[noise]"))
}

/// The torques of a motion by a robot.
pub fn torques(robot: &Robot, results: &DesignResults) -> Series {
    let model = Model::new(robot);
    let parameters = DynamicParameters::sorted(&model, &robot.a_priori_parameters());
    let (mut tau, mut workspace) = (Series::zeros(results.q.len(), 2), Workspace::new(&model));
    for k in 0..results.q.len() {
        let state = State::new(results.q.sample(k), results.dq.sample(k));
        let ddq = results.ddq.sample(k);
        model.inverse_dynamics(&parameters, state, ddq, Sign::Exact, &mut workspace, tau.sample_mut(k));
    }
    tau
}
