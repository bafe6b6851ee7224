//! What must agree between reductions that are solved together.

use serde::{Deserialize, Serialize};

use super::ReductionError;
use crate::{
    experiment::Experiment,
    preparation::{Mask, NamedMask, Settings},
    run::{ModelColumns, changing, transitions},
};
use thetahat_model::{
    base_parameters::BaseParameters,
    dynamics::{FrictionTransition, Model},
    regressor::Regressor,
    robot::Robot,
};

/// What must agree before reductions can be solved together.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Identity {
    /// Name of the robot.
    pub robot: String,
    /// Names of the joints, in the order of the factors.
    pub joints: Vec<String>,
    /// Names of all base parameters, in the order of the columns.
    pub parameters: Vec<String>,
    /// Their regrouping formulas, which hold the geometry.
    pub expressions: Vec<String>,
    /// The joints that are locked, with their values.
    pub locked: Vec<String>,
    /// The standard parameters at a given value.
    pub fixed: Vec<String>,
    /// For each joint the base parameters, from zero, that act on it.
    pub acting: Vec<Vec<usize>>,
    /// Order of the position filter.
    pub filter_order: usize,
    /// Its cut-off, Hz.
    pub cutoff_hz: f64,
    /// Every how many samples a row was kept.
    pub decimation: usize,
    /// How positions were differentiated.
    pub derivative: String,
    /// Which samples near rest make no rows.
    pub mask: String,
    /// Velocities at which friction changes its sign, from which the model's is chosen, rad/s or m/s.
    pub transitions: Vec<f64>,
    /// The same of joints that slide, m/s, where others turn.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sliding_transitions: Vec<f64>,
    /// The base parameters, from zero, whose columns depend on it.
    pub changing: Vec<usize>,
}

impl Identity {
    /// That of an experiment's reductions. Without jumps of its torques at changes of velocity, a robot has no mask.
    pub(super) fn of(
        experiment: &Experiment,
        (model, base): (&Model, &BaseParameters),
        regressor: &Regressor,
        has_jumps: bool,
    ) -> Self {
        let signal = experiment.settings.signal;
        let transitions = transitions(experiment.setup());
        let joints: Vec<String> = experiment.robot.coordinates().map(|j| j.name.clone()).collect();
        Self {
            robot: experiment.robot.name.clone(),
            fixed: fixed_in_words(&experiment.settings),
            acting: acting(joints.len(), regressor),
            joints,
            locked: locked_in_words(&experiment.robot),
            parameters: base.parameters().iter().map(|p| p.name.clone()).collect(),
            expressions: base.parameters().iter().map(|p| p.expression.clone()).collect(),
            filter_order: signal.filter_order,
            cutoff_hz: signal.cutoff_hz,
            decimation: signal.decimation,
            derivative: signal.derivative.to_string(),
            mask: mask_in_words(&experiment.settings, has_jumps),
            transitions: transitions.iter().map(|t| t.turning).collect(),
            sliding_transitions: transitions.iter().filter_map(|t| t.sliding_apart()).collect(),
            changing: changing(model, base),
        }
    }

    /// The columns of the rows from which the model is chosen.
    pub(super) fn model_columns(&self) -> ModelColumns {
        let sizes = [self.transitions.len(), self.parameters.len()];
        ModelColumns::new(self.acting.clone(), self.changing.clone(), sizes)
    }

    /// The velocities at which friction changes its sign, of joints that turn and slide.
    pub(super) fn friction_transitions(&self) -> Vec<FrictionTransition> {
        let of_place = |(k, turning): (usize, &f64)| {
            let sliding = self.sliding_transitions.get(k).copied().unwrap_or(*turning);
            FrictionTransition { turning: *turning, sliding }
        };
        self.transitions.iter().enumerate().map(of_place).collect()
    }

    /// Whether it is of a robot with these base parameters: the same joints, locks and geometry.
    pub(crate) fn is_of(&self, robot: &Robot, base: &BaseParameters) -> bool {
        let parameters = base.parameters().iter();
        robot.coordinates().map(|joint| &joint.name).eq(&self.joints)
            && locked_in_words(robot) == self.locked
            && parameters.clone().map(|p| &p.name).eq(&self.parameters)
            && parameters.map(|p| &p.expression).eq(&self.expressions)
    }

    /// Refuses another with which it cannot be merged, and says what differs.
    pub(super) fn require_like(&self, other: &Self) -> Result<(), ReductionError> {
        let list = |list: &[String]| list.join(" ");
        let numbers = |numbers: &[f64]| numbers.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ");
        let texts = [
            ("the list of joints", list(&self.joints), list(&other.joints)),
            ("the locked joints", list(&self.locked), list(&other.locked)),
            ("the list of base parameters", list(&self.parameters), list(&other.parameters)),
            ("the parameters at a given value ([parameters] fix)", list(&self.fixed), list(&other.fixed)),
            ("the position filter's order", self.filter_order.to_string(), other.filter_order.to_string()),
            ("the position filter's cut-off in Hz", self.cutoff_hz.to_string(), other.cutoff_hz.to_string()),
            ("the decimation", self.decimation.to_string(), other.decimation.to_string()),
            ("the derivative", self.derivative.clone(), other.derivative.clone()),
            ("the mask near rest", self.mask.clone(), other.mask.clone()),
            ("the model's friction_transition", numbers(&self.transitions), numbers(&other.transitions)),
            (
                "the model's friction_transition_sliding",
                numbers(&self.sliding_transitions),
                numbers(&other.sliding_transitions),
            ),
        ];
        if let Some((what, first, other)) = texts.into_iter().find(|(_, first, other)| first != other) {
            return Err(ReductionError::Unlike { what, first, other });
        }
        match self.expressions.iter().zip(&other.expressions).find(|(a, b)| a != b) {
            Some((first, other)) => Err(unlike("a base parameter's formula (the robot's geometry)", first, other)),
            None if self.acting != other.acting => {
                Err(unlike("which parameters act on which joint", &"one", &"another"))
            }
            None => Ok(()),
        }
    }
}

/// What decides which samples make no rows, but for the noise of each recording.
fn mask_in_words(settings: &Settings, has_jumps: bool) -> String {
    let (mask, scale) = (settings.signal.mask, settings.simulation.sign_velocity_scale);
    let near_rest = match mask {
        Mask::Named(NamedMask::None) => return every_sample(),
        Mask::Stated(_) | Mask::Named(NamedMask::NearRest) if !has_jumps => every_sample(),
        Mask::Stated(_) => mask.to_string(),
        Mask::Named(NamedMask::NearRest) => format!("{mask}, sign_velocity_scale {scale}"),
    };
    format!("{near_rest}, zero beyond the window")
}

/// The columns that act on each joint, in order.
fn acting(joints: usize, regressor: &Regressor) -> Vec<Vec<usize>> {
    let of_joint = |joint: usize| {
        let mut own: Vec<usize> = regressor.entries().iter().filter(|e| e.joint == joint).map(|e| e.column).collect();
        own.sort_unstable();
        own
    };
    (0..joints).map(of_joint).collect()
}

fn every_sample() -> String {
    Mask::Named(NamedMask::None).to_string()
}

pub(super) fn unlike(what: &'static str, first: &dyn ToString, other: &dyn ToString) -> ReductionError {
    ReductionError::Unlike { what, first: first.to_string(), other: other.to_string() }
}

fn fixed_in_words(settings: &Settings) -> Vec<String> {
    settings.parameters.fix.iter().map(|(name, value)| format!("{name} {value}")).collect()
}

fn locked_in_words(robot: &Robot) -> Vec<String> {
    robot.locked.iter().map(|joint| format!("{} {}", joint.name, joint.value)).collect()
}
