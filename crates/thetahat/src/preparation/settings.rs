use std::{collections::BTreeMap, fmt};

use serde::Deserialize;

use super::{
    estimated_size::EstimatedSize,
    loop_parameters::LoopParameter,
    payload::Payload,
    physical::{KnownQuantity, PriorOptions},
};
use thetahat_estimation::{
    control::ControllerDescription,
    identification::{Convergence, Divisor, EliminationRule, IterationOptions, Method, Weighting},
    signal::{Decimator, Derivative, SignalError},
    simulation::{NOMINAL, SimulatorBias, Solver},
};
use thetahat_model::robot::Friction;

/// How a robot is identified from its recordings. Its form as data is that of an experiment file's tables of these names.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// Filters, decimation and window.
    pub signal: SignalOptions,
    /// Which parameters are estimated and shown.
    #[serde(default)]
    pub parameters: ParameterSelection,
    /// Methods and their options.
    #[serde(default)]
    pub estimation: EstimationOptions,
    /// The simulated controller, for methods that simulate the closed loop.
    pub controller: Option<ControllerDescription>,
    /// The simulator's options.
    #[serde(default)]
    pub simulation: SimulationOptions,
    /// What the model does not have to find.
    #[serde(default)]
    pub model: ModelOptions,
    /// Cases in addition to the nominal one.
    #[serde(default, rename = "case")]
    pub cases: Vec<Case>,
    /// Payloads that recordings may carry.
    #[serde(default, rename = "payload")]
    pub payloads: Vec<Payload>,
}

impl Settings {
    /// Settings with a cut-off of the position filter in Hz and a decimation, for IDIM-LS and nothing else.
    #[must_use]
    pub fn new(cutoff_hz: f64, decimation: usize) -> Self {
        let signal = SignalOptions {
            position: PositionFilter::Butterworth,
            filter_order: default_filter_order(),
            cutoff_hz,
            decimation,
            window_start_s: None,
            window_end_s: None,
            derivative: Derivative::default(),
            mask: Mask::default(),
        };
        Self {
            signal,
            parameters: ParameterSelection::default(),
            estimation: EstimationOptions { methods: vec![Method::IDIM_LS], ..EstimationOptions::default() },
            controller: None,
            simulation: SimulationOptions::default(),
            model: ModelOptions::default(),
            cases: Vec::new(),
            payloads: Vec::new(),
        }
    }

    /// The same with payloads that recordings may carry.
    #[must_use]
    pub fn with_payloads(self, payloads: impl IntoIterator<Item = Payload>) -> Self {
        Self { payloads: payloads.into_iter().collect(), ..self }
    }

    /// The same with these methods, in the order of tables.
    #[must_use]
    pub fn with_methods(mut self, methods: impl IntoIterator<Item = Method>) -> Self {
        self.estimation.methods = methods.into_iter().collect();
        self
    }

    /// The same with a simulated controller.
    #[must_use]
    pub fn with_controller(self, controller: ControllerDescription) -> Self {
        Self { controller: Some(controller), ..self }
    }

    /// The nominal case and the others.
    #[must_use]
    pub fn all_cases(&self) -> Vec<Case> {
        std::iter::once(Case::nominal()).chain(self.cases.iter().cloned()).collect()
    }

    /// The methods of all cases.
    #[must_use]
    pub fn all_methods(&self) -> Vec<Method> {
        let of_cases = self.cases.iter().filter_map(|case| case.methods.as_ref());
        of_cases.chain([&self.estimation.methods]).flatten().copied().collect()
    }

    /// The weighting of a method: its own, or else the one that is asked for.
    #[must_use]
    pub fn weighting(&self, method: Method) -> Weighting {
        let asked = || self.estimation.weighting.get(&method).copied();
        method.weighting().or_else(asked).unwrap_or_default()
    }

    /// Whether the tables show a parameter.
    #[must_use]
    pub fn shows(&self, name: &str) -> bool {
        let show = &self.parameters.show;
        show.is_empty() || show.iter().any(|shown| shown == name)
    }
}

/// Filters, decimation and window.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SignalOptions {
    /// How positions are filtered.
    #[serde(default)]
    pub position: PositionFilter,
    /// Order of the Butterworth filter of the positions, which runs forward and backward, or of the smoother's random walk: 3, 4 or 5.
    #[serde(default = "default_filter_order")]
    pub filter_order: usize,
    /// Cut-off of the Butterworth filter, which needs one. The smoother finds its own for each joint.
    #[serde(default)]
    pub cutoff_hz: f64,
    /// Every how many samples one is kept, after the parallel filter.
    pub decimation: usize,
    /// Start of the window, s. Without start and end, the window is the moving part less the edges of the filter.
    pub window_start_s: Option<f64>,
    /// End of the window, s; with a start alone, the end of the recording. Where a recording starts or ends in motion, the edges
    /// of the filter are in no window.
    pub window_end_s: Option<f64>,
    /// How positions are differentiated.
    #[serde(default)]
    pub derivative: Derivative,
    /// Which samples make no rows because a joint is near rest.
    #[serde(default)]
    pub mask: Mask,
}

/// How positions are filtered.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PositionFilter {
    /// A Butterworth low-pass, forward and backward, then differences.
    #[default]
    Butterworth,
    /// A Kalman smoother of a random walk of `filter_order`, whose cut-off for each joint has the largest likelihood.
    Smoother,
}

/// Which samples of a joint make no rows: near rest, a wrong sign of the velocity makes a wrong sign of its friction. What makes
/// no rows is zero for the parallel filter; where there is a mask, so is what lies beyond the window.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(untagged, expecting = "expected \"near-rest\", \"none\" or { velocity, widened_s }")]
pub enum Mask {
    /// `"near-rest"`, whose limits follow from the recording and the simulator, or `"none"`.
    Named(NamedMask),
    /// The same limits for all joints.
    Stated(StatedMask),
}

impl Default for Mask {
    fn default() -> Self {
        Self::Named(NamedMask::NearRest)
    }
}

impl fmt::Display for Mask {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Named(NamedMask::NearRest) => f.write_str("near-rest"),
            Self::Named(NamedMask::None) => f.write_str("none"),
            Self::Stated(StatedMask { velocity, widened_s }) => {
                write!(f, "{{ velocity = {velocity}, widened_s = {widened_s} }}")
            }
        }
    }
}

/// A mask by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum NamedMask {
    /// Samples near rest are left out.
    NearRest,
    /// Every sample makes rows.
    None,
}

/// A mask with stated limits.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StatedMask {
    /// Velocity of a joint or coupled motor below which it is near rest, rad/s or m/s.
    pub velocity: f64,
    /// Time on either side that is left out as well, s.
    pub widened_s: f64,
}

fn default_filter_order() -> usize {
    4
}

impl SignalOptions {
    /// The same with the window of a recording, where that states one.
    #[must_use]
    pub fn in_window(self, [start_s, end_s]: [Option<f64>; 2]) -> Self {
        match (start_s, end_s) {
            (None, None) => self,
            (window_start_s, window_end_s) => Self { window_start_s, window_end_s, ..self },
        }
    }

    /// The decimation of a window of so many samples: of recordings that are zero beyond their ends, unless every sample makes rows.
    pub(crate) fn decimator(&self, samples: usize) -> Result<Decimator, SignalError> {
        let decimator = Decimator::new(self.decimation, samples)?;
        Ok(match self.mask {
            Mask::Named(NamedMask::None) => decimator,
            Mask::Named(NamedMask::NearRest) | Mask::Stated(_) => decimator.with_zero_padding(),
        })
    }

    /// The same for the model's rows: beyond its ends a recording is zero, so that no row has the noise of a single sample.
    pub(crate) fn model_decimator(&self, samples: usize) -> Result<Decimator, SignalError> {
        Ok(Decimator::new(self.decimation, samples)?.with_zero_padding())
    }
}

/// What the model does not have to find: a stated value is the only candidate.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ModelOptions {
    /// Weight of the belief in the a-priori robot, in long-run variances of the residual.
    pub belief_weight: Option<f64>,
    /// Velocity v of `tanh(dq / v)`, the sign of the Coulomb friction, rad/s or m/s.
    pub friction_transition: Option<f64>,
    /// The same of joints that slide, m/s, where others turn: with friction_transition, which without it is that of all joints.
    pub friction_transition_sliding: Option<f64>,
    /// Sizes in the description that were estimated from these recordings: their deviations count in the intervals. `"gravity-direction"`,
    /// `"torque-filter"`, `"lag"`, or of joint 2 `"gear-ratio-2"`, `"position-scale-2"`, `"drive-gain-2"`, `"lag-2"`.
    pub estimated: Vec<EstimatedSize>,
}

impl ModelOptions {
    /// Whether the law of the friction is stated: nothing challenges it.
    pub(crate) fn is_stated(&self) -> bool {
        self.friction_transition.is_some()
    }
}

/// Which parameters are estimated and shown.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ParameterSelection {
    /// `"base"`, `"essential"`, `"drives"`, or a list of base parameters.
    pub estimate: ParameterChoice,
    /// Standard parameters taken as zero.
    pub exclude: Vec<String>,
    /// Parameters that the tables show; none means all.
    pub show: Vec<String>,
    /// Whether every estimate gets a physically consistent one in addition.
    pub physical: bool,
    /// Standard parameters at a value, SI: their torques are taken off the recorded ones, and they are not estimated.
    pub fix: BTreeMap<String, f64>,
    /// What else is known of the robot and holds for the consistent estimates.
    pub known: Vec<KnownQuantity>,
    /// How consistent estimates are drawn to the a-priori parameters.
    pub prior: PriorOptions,
    /// The rule of the elimination, for `"essential"`.
    pub elimination: EliminationRule,
}

/// The parameters of a run.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(untagged, expecting = "expected \"base\", \"essential\", \"drives\" or a list of base parameters")]
pub enum ParameterChoice {
    /// All base parameters.
    #[default]
    #[serde(skip)]
    Base,
    /// `"base"`, `"essential"` or `"drives"`.
    Named(NamedChoice),
    /// Base parameters by name.
    List(Vec<String>),
}

impl ParameterChoice {
    /// Whether it is all base parameters.
    #[must_use]
    pub fn takes_all(&self) -> bool {
        match self {
            Self::Base | Self::Named(NamedChoice::Base | NamedChoice::Drives) => true,
            Self::Named(NamedChoice::Essential) | Self::List(_) => false,
        }
    }
}

/// A choice by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum NamedChoice {
    /// All base parameters.
    Base,
    /// Those that an elimination leaves.
    Essential,
    /// Motor inertia, friction and offset; the links are as the robot's description has them.
    Drives,
}

/// Methods and their options.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct EstimationOptions {
    /// The methods, in the order of the tables.
    pub methods: Vec<Method>,
    /// Weighting by method; none if a method is not listed.
    pub weighting: BTreeMap<Method, Weighting>,
    /// Start values of the iterations.
    pub start: Start,
    /// Gains of a controller that is given by its bandwidth.
    pub gains: Gains,
    /// What CLIE and CLOE estimate of the loop in addition to the parameters; gains stay those of the start values then. Where no torques are
    /// recorded and none is named, `delay` and `friction-transition` are estimated if they explain the positions.
    pub loop_parameters: Vec<LoopParameter>,
    /// Whether laws of torque terms are compared, for the user to accept.
    pub compare_terms: bool,
    /// When the iterations stop.
    pub convergence: Convergence,
    /// What the squared residual is divided by.
    pub variance: Divisor,
}

impl Default for EstimationOptions {
    fn default() -> Self {
        Self {
            methods: vec![Method::IDIM_LS, Method::IDIM_IV, Method::DIDIM],
            weighting: BTreeMap::new(),
            start: Start::default(),
            gains: Gains::default(),
            loop_parameters: Vec::new(),
            compare_terms: false,
            convergence: Convergence::default(),
            variance: Divisor::default(),
        }
    }
}

impl EstimationOptions {
    /// What an iteration needs of them.
    #[must_use]
    pub fn iteration(&self) -> IterationOptions {
        IterationOptions { divisor: self.variance, convergence: self.convergence }
    }
}

/// Start values of the iterations.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Start {
    /// The robot's a-priori parameters.
    #[default]
    Cad,
    /// The a-priori motor inertias and nothing else.
    MotorInertias,
}

/// Gains of a controller that is given by its bandwidth.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Gains {
    /// Follow the estimated inertia, so that the bandwidth stays.
    #[default]
    Updated,
    /// Stay those of the start values.
    Kept,
}

/// The simulator's options.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SimulationOptions {
    /// How to integrate.
    pub solver: Solver,
    /// Velocity scale of the regularised sign of Coulomb friction, rad/s or m/s.
    pub sign_velocity_scale: f64,
    /// Whether simulated positions are filtered and differentiated as the measured ones are.
    pub band_pass: bool,
}

impl Default for SimulationOptions {
    fn default() -> Self {
        Self { solver: Solver::default(), sign_velocity_scale: 0.01, band_pass: false }
    }
}

/// A case other than the nominal one.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Case {
    /// Its name, such as `gear_ratio_0.9`.
    pub name: String,
    /// How the simulator differs from the true loop.
    #[serde(default)]
    pub simulator: SimulatorBias,
    /// Another friction model than the robot's.
    pub friction: Option<Friction>,
    /// Another velocity scale of the simulator's regularised sign than the experiment's, rad/s or m/s.
    pub sign_velocity_scale: Option<f64>,
    /// Other methods than the experiment's.
    pub methods: Option<Vec<Method>>,
}

impl Case {
    /// The case without any difference.
    #[must_use]
    pub fn nominal() -> Self {
        Self {
            name: NOMINAL.to_owned(),
            simulator: SimulatorBias::NONE,
            friction: None,
            sign_velocity_scale: None,
            methods: None,
        }
    }

    /// The same with another bias of the simulator.
    #[must_use]
    pub fn with_simulator(self, simulator: SimulatorBias) -> Self {
        Self { simulator, ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_are_read_from_the_tables_of_an_experiment() {
        let text = "estimation.methods = ['idim-ls']\n[signal]\ncutoff_hz = 20\ndecimation = 10";
        assert_eq!(toml::from_str(text), Ok(Settings::new(20.0, 10)));
        let more: Settings = toml::from_str(&format!("{text}\n[[case]]\nname = 'a'")).unwrap();
        assert_eq!(more.cases, [Case { name: "a".to_owned(), ..Case::nominal() }]);
        let error = toml::from_str::<Settings>(&format!("{text}\n[twin]")).unwrap_err();
        assert!(error.message().starts_with("unknown field `twin`"), "{error}");
    }
}
