//! What is wrong in the links of a description goes into the drives that are estimated with them: their intervals allow for it.

use super::identification::Identification;
use crate::preparation::{NamedChoice, ParameterChoice};
use thetahat_model::{
    dynamics::{DynamicParameters, Model, Sign, State, Workspace},
    robot::{JointQuantity, Quantity},
};
use thetahat_report::results::RunResult;

/// How well a description gives the inertia and the weight at a joint: half of a 95 % interval, as a part of them. A choice, which the
/// run's notes state: no data of the run says it.
const KNOWN_TO: f64 = 0.1;

/// Widens the intervals of motor inertias and offsets by what links that are a tenth off would add to them, and says so.
pub(super) fn allow_for_links(identification: &Identification, run: &mut RunResult) {
    let setup = identification.setup();
    if setup.settings.parameters.estimate != ParameterChoice::Named(NamedChoice::Drives) {
        return;
    }
    run.notes.push(
        "the links are as the robot's description has them; motor inertia, friction and offset are estimated. The intervals of motor \
         inertias and offsets allow for links whose inertia and weight at a joint are off by a tenth"
            .to_owned(),
    );
    let Some(posture) = identification.main.first().map(|p| p.filtered.motion.q.means()) else { return };
    let model = Model::new(setup.robot);
    let Some(links) = Links::of(&model, &setup.robot.a_priori_parameters(), &posture) else { return };
    let coordinates = setup.robot.coordinate_joints();
    for p in model.parameter_table().iter() {
        let Some(c) = coordinates.iter().position(|joint| joint + 1 == p.number) else { continue };
        let is_offset = p.quantity == Quantity::Joint(JointQuantity::Off);
        let size = match (p.quantity.is_motor_inertia(), is_offset) {
            (true, _) => links.inertia[c],
            (false, true) => links.weight[c],
            (false, false) => continue,
        };
        let name = p.name();
        for found in run.parameters.iter_mut().filter(|found| found.name == name) {
            found.widen_interval(KNOWN_TO * size.abs());
        }
    }
}

/// The inertia and the weight of the links at each coordinate.
struct Links {
    inertia: Vec<f64>,
    weight: Vec<f64>,
}

impl Links {
    fn of(model: &Model, a_priori: &[f64], posture: &[f64]) -> Option<Self> {
        let table = model.parameter_table();
        let of_links = |(i, value): (usize, &f64)| if table.get(i).quantity.is_inertial() { *value } else { 0.0 };
        let links: Vec<f64> = a_priori.iter().enumerate().map(of_links).collect();
        let rest = vec![0.0; posture.len()];
        let mut weight = rest.clone();
        let parameters = DynamicParameters::new(model, &links).ok()?;
        let state = State::new(posture, &rest);
        model.inverse_dynamics(&parameters, state, &rest, Sign::Exact, &mut Workspace::new(model), &mut weight);
        Some(Self { inertia: model.joint_inertias(&links, posture).ok()?, weight })
    }
}
