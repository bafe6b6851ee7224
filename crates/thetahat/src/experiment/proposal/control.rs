//! The controller of a log without torques: CLOE fits the positions that it gives.

use super::{request::ProposalRequest, source::Source, stated::controller};
use crate::{
    experiment::{column_names, driver::DriverController},
    preparation::describes_links,
};
use thetahat_model::robot::Robot;

/// Names of columns that hold the gains of a controller.
const POSITION_GAINS: [&str; 4] = ["kp", "p_gain", "pgain", "stiffness"];
const VELOCITY_GAINS: [&str; 4] = ["kd", "kv", "d_gain", "dgain"];

/// A PD law that acts on positions and velocities.
#[derive(Debug, Clone, PartialEq)]
pub struct ProposedControl {
    /// One for all motors or one for each, N m/rad; empty where they are to be filled in.
    pub position_gain: Vec<f64>,
    /// Likewise, N m s/rad.
    pub velocity_gain: Vec<f64>,
    /// Columns of desired torques, which the controller computed: they are no measurement.
    pub desired_torques: Vec<String>,
    /// Whether the links are taken as the description has them, where they are physical: positions alone show little of them.
    pub trusts_links: bool,
}

/// The gains that were stated, or else those of columns that hold one value, or else the driver's.
pub(super) fn control(request: &ProposalRequest, sources: &[Source<'_>], robot: &Robot) -> ProposedControl {
    let joints = robot.coordinate_count();
    let stated_or = |stated: &[f64], names: &[&str], of_driver: fn(&DriverController) -> &Vec<f64>| match stated {
        [] => {
            let recorded = sources.iter().find_map(|source| constant(source, names, joints));
            let controller = || request.driver.as_ref()?.controller.as_ref().map(|c| of_driver(c).clone());
            recorded.or_else(controller).unwrap_or_default()
        }
        stated => stated.to_vec(),
    };
    ProposedControl {
        position_gain: stated_or(&request.position_gain, &POSITION_GAINS, |c| &c.position_gain),
        velocity_gain: stated_or(&request.velocity_gain, &VELOCITY_GAINS, |c| &c.velocity_gain),
        desired_torques: sources
            .iter()
            .flat_map(Source::names)
            .filter(|name| column_names::says_desired_torque(name))
            .collect(),
        trusts_links: describes_links(robot),
    }
}

/// The value of a column of one of these names that is one number, or one for each joint.
fn constant(source: &Source<'_>, names: &[&str], joints: usize) -> Option<Vec<f64>> {
    let tables = source.contents.tables.iter().flat_map(|table| &table.columns);
    let mut named = tables.filter(|c| names.contains(&c.name.to_ascii_lowercase().as_str()));
    let column = named.find(|c| c.statistics.iter().all(|s| s.constant))?;
    let values: Option<Vec<f64>> = column.statistics.iter().map(|s| s.min).collect();
    values.filter(|values| values.len() == 1 || values.len() == joints)
}

impl ProposedControl {
    /// The tables `[estimation]` and `[controller]` of the experiment file.
    pub(super) fn text(&self) -> String {
        let desired = match &self.desired_torques[..] {
            [] => String::new(),
            names => format!(
                "\n# {}: desired torques, which the controller computed. They are no measurement, and are not used.\n",
                names.join(" ")
            ),
        };
        format!(
            "{desired}{}[estimation]\nmethods = [\"cloe\"]\n\n{}",
            self.what_is_estimated(),
            controller(&self.position_gain, &self.velocity_gain),
        )
    }

    fn what_is_estimated(&self) -> &'static str {
        if self.trusts_links {
            "\n# The log has no measured torque: CLOE fits the positions of the closed loop. It estimates motor inertia, friction and \
             offset of each\n# joint, in the unit of the gains; masses, centres and inertias of the links are those of the description,\n# and intervals allow for a tenth of them. To \
             estimate what the\n# motion shows of the links, too, take this table out.\n[parameters]\nestimate = \"drives\"\n\n"
        } else {
            "\n# The log has no measured torque: CLOE fits the positions of the closed loop. It estimates motor inertia, friction, \
             offsets and\n# what the motion shows of the links, all in the unit of the gains.\n"
        }
    }

    /// What is to be filled in.
    pub(super) fn to_fill_in(&self) -> Option<String> {
        let missing = self.position_gain.is_empty() || self.velocity_gain.is_empty();
        missing.then(|| {
            "The log has no torque: the gains of the controller are needed. Fill in position_gain (N m/rad) and velocity_gain \
             (N m s/rad) of [controller]."
                .to_owned()
        })
    }
}
