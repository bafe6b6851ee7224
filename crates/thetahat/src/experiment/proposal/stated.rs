//! What the user states of the estimation of a log with torques: methods, and the gains of the controller.

use std::fmt::Write as _;

use super::request::ProposalRequest;
use thetahat_estimation::identification::Method;

/// The tables `[estimation]` and `[controller]`: the usual methods without a controller where nothing is stated.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Stated {
    methods: Vec<Method>,
    position_gain: Vec<f64>,
    velocity_gain: Vec<f64>,
}

impl Stated {
    pub(super) fn of(request: &ProposalRequest) -> Self {
        Self {
            methods: request.methods.clone(),
            position_gain: request.position_gain.clone(),
            velocity_gain: request.velocity_gain.clone(),
        }
    }

    /// The tables where torques are recorded.
    pub(super) fn text(&self) -> String {
        let mut text = String::from("\n# Rows are weighted by joint. IDIM-IV tests IDIM-WLS; ");
        if self.has_gains() {
            text += "it simulates the loop of [controller].\n";
        } else {
            text += "without [controller] it simulates a guess of the closed loop, which is enough for it. With\n# the controller's law in \
                     [controller] (docs/reference/experiments.md) \"didim\" can be added.\n";
        }
        let _ = write!(text, "[estimation]\nmethods = [{}]\n", self.methods());
        text += "weighting = { idim-iv = \"per-joint\" }\n";
        if self.has_gains() {
            text += &format!("\n{}", controller(&self.position_gain, &self.velocity_gain));
        }
        text
    }

    fn has_gains(&self) -> bool {
        !(self.position_gain.is_empty() && self.velocity_gain.is_empty())
    }

    fn methods(&self) -> String {
        if self.methods.is_empty() {
            return "\"idim-wls\", \"idim-iv\"".to_owned();
        }
        self.methods.iter().map(|method| format!("\"{method}\"")).collect::<Vec<_>>().join(", ")
    }

    /// What is to be filled in: one of the two gains without the other.
    pub(super) fn to_fill_in(&self) -> Option<String> {
        let is_half = self.position_gain.is_empty() != self.velocity_gain.is_empty();
        is_half.then(|| {
            "A controller needs both gains: fill in position_gain (N m/rad) and velocity_gain (N m s/rad) of [controller]."
                .to_owned()
        })
    }
}

/// The table of a PD controller.
pub(super) fn controller(position_gain: &[f64], velocity_gain: &[f64]) -> String {
    format!(
        "# u = position_gain (reference - position) - velocity_gain velocity, in N m at the joint.\n[controller]\nlaw = \"pd\"\n\
         position_gain = {}\nvelocity_gain = {}\n",
        gains(position_gain),
        gains(velocity_gain),
    )
}

fn gains(gains: &[f64]) -> String {
    match gains {
        [] => "[]".to_owned(),
        [one] => one.to_string(),
        several => format!("[{}]", several.iter().map(f64::to_string).collect::<Vec<_>>().join(", ")),
    }
}
