//! Results of the diagnosis of a run.

use serde::{Deserialize, Serialize};

use thetahat_estimation::{
    identification::Method,
    simulation::BiasKind,
    statistics::{ChiSquaredTest, FTest},
};

/// Tests of the residual of one run.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct ResidualResult {
    /// Joint by joint.
    pub joints: Vec<JointResidual>,
    /// Levene's test of equal variances of the joints, on the residual as it was weighted.
    pub homoscedasticity: Option<FTest>,
}

/// The residual of one joint.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct JointResidual {
    /// The joint, from one.
    pub joint: usize,
    /// Root mean square, N m or N.
    pub rms: f64,
    /// Correlation of adjacent rows.
    pub autocorrelation: f64,
    /// The Ljung-Box test of white rows.
    pub whiteness: Option<ChiSquaredTest>,
    /// The Jarque-Bera test of normal rows.
    pub normality: Option<ChiSquaredTest>,
    /// Whether the model explains the torque better than a constant.
    #[serde(default)]
    pub explained: Option<Explained>,
}

/// F-test of the model of a joint against a constant torque.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Explained {
    /// The F-test, with the effective number of independent rows of the residual.
    #[serde(flatten)]
    pub test: FTest,
    /// If the F-test is not decisive: robust deviations by which the model explains the torque better than the same torque shifted
    /// in time against the motion.
    #[serde(default, alias = "stands_out")]
    pub deviations_above_shifted: Option<f64>,
}

impl Explained {
    /// Probability of the F-test above which the fit may be due to chance.
    pub const LIMIT: f64 = 1e-4;
    /// Deviations from the shifted torques below which the fit may be due to chance.
    pub const LIMIT_DEVIATIONS: f64 = 4.0;

    /// Whether the fit of the model may be due to chance.
    #[must_use]
    pub fn is_by_chance(&self) -> bool {
        self.test.p_value > Self::LIMIT && self.deviations_above_shifted.is_none_or(|z| z < Self::LIMIT_DEVIATIONS)
    }
}

/// The part of the recording whose removal changes the estimates most.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Influence {
    /// The move, part or recording.
    pub part: String,
    /// The parameter that changes most, in its standard deviations with correlated errors.
    pub parameter: String,
    /// Its change in standard deviations without the part.
    pub change: f64,
}

/// An error that hardly shows in the residual and that the intervals do not include.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum HiddenError {
    /// The torques of all joints are delayed; the size is the delay, s.
    LateTorque,
    /// Friction of a joint is larger near rest and falls to `1/e` of that at a tenth of the largest velocity; the size is the
    /// friction at rest minus the Coulomb friction, N m or N.
    FrictionNearRest,
}

/// The bias of a run by an error of the largest size that the recording allows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HiddenBias {
    /// The error.
    pub error: HiddenError,
    /// The coordinate of the error, counted from one; `null` for an error of all coordinates.
    pub joint: Option<usize>,
    /// 95 % interval of the error's size, which is estimated together with the parameters.
    pub size_interval_95: [f64; 2],
    /// The parameter with the largest shift in its standard deviations.
    pub parameter: String,
    /// Its shift in standard deviations with correlated errors, at the end of the interval with the larger shift.
    pub deviations: f64,
    /// The other parameters that shift by more than half of their 95 % interval at this end.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub others: Vec<MovedParameter>,
}

/// A parameter that an error shifts.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MovedParameter {
    /// Its name.
    pub parameter: String,
    /// Its shift in standard deviations with correlated errors.
    pub deviations: f64,
}

impl HiddenBias {
    /// The shift of a parameter in its standard deviations; none if it is less than half of the interval and another
    /// parameter shifts more.
    #[must_use]
    pub fn deviations_of(&self, parameter: &str) -> Option<f64> {
        if self.parameter == parameter {
            return Some(self.deviations);
        }
        self.others.iter().find(|moved| moved.parameter == parameter).map(|moved| moved.deviations)
    }

    /// Whether the residual shows the error: its interval excludes zero.
    #[must_use]
    pub fn is_seen(&self) -> bool {
        let [from, to] = self.size_interval_95;
        from > 0.0 || to < 0.0
    }
}

/// Tests that compare the methods of one case.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct CaseDiagnosis {
    /// The case.
    pub case: String,
    /// LS against IV.
    pub endogeneity: Option<EndogeneityResult>,
    /// The instruments of IV.
    pub instruments: Option<InstrumentResult>,
    /// DIDIM against IV.
    pub biased_simulator: Option<BiasedSimulatorResult>,
    /// DIDIM against CLIE.
    #[serde(default)]
    pub approximation: Option<ApproximationResult>,
}

/// DIDIM against CLIE: the error of approximating the sensitivities by phi, equations (16) and (17).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ApproximationResult {
    /// Whether an estimate differs by more than its standard deviation.
    pub matters: bool,
    /// Average difference of the estimates in standard deviations of CLIE, with correlated errors.
    pub average_difference: f64,
    /// Every parameter.
    pub parameters: Vec<ApproximatedParameter>,
}

/// A parameter of DIDIM compared with that of CLIE.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ApproximatedParameter {
    /// Its name.
    pub name: String,
    /// `100 |Z_i - J_i| / |J_i|`: the difference between the approximated sensitivity of DIDIM and the exact one of CLIE, each at its own
    /// estimate.
    pub column_percent: f64,
    /// DIDIM minus CLIE.
    pub difference: f64,
    /// The same in standard deviations of CLIE, with correlated errors.
    pub deviations: f64,
}

/// The Durbin-Wu-Hausman test of LS against IV.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct EndogeneityResult {
    /// The F-test of the augmented regression, for independent rows of equal variance.
    pub classical: FTest,
    /// The same test with the autocorrelation and the variance of each joint's residual.
    pub robust: ChiSquaredTest,
    /// Average difference of the estimates in standard deviations of IV.
    pub average_difference: f64,
    /// The parameters that differ most.
    pub parameters: Vec<ParameterDifference>,
    /// The conclusion.
    pub verdict: Comparison,
}

/// How strong the instruments are.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct InstrumentResult {
    /// The conditional first-stage F statistic of each parameter, in their order; empty if the rank is not full.
    pub f_statistics: Vec<f64>,
    /// The smallest of them.
    pub smallest_f: f64,
    /// The parameter with the smallest statistic.
    pub weakest: String,
    /// Rank of `Z^T X`.
    pub rank: usize,
    /// Condition number of `Q^T X` with `Z = Q R` and columns of X of length one.
    pub condition_number: f64,
}

/// The biased simulator test: DIDIM against IV with the same instruments and weights.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct BiasedSimulatorResult {
    /// The statistic.
    pub statistic: f64,
    /// Parameters.
    pub freedom: usize,
    /// The 95 % quantile of the statistic of an unbiased simulator, by parametric bootstrap.
    pub threshold: f64,
    /// Share of those statistics that are at least as large, including the measured one.
    pub p_value: f64,
    /// Draws of the bootstrap.
    pub draws: usize,
    /// Its seed.
    pub seed: u64,
    /// Average difference of the estimates in standard deviations of IV.
    pub average_difference: f64,
    /// DIDIM's residual over IV's: above one, the simulated motion explains the torques worse than the measured motion.
    pub residual_ratio: f64,
    /// The average difference below which a bias is negligible.
    pub harmless_below: f64,
    /// The conclusion.
    pub verdict: Comparison,
    /// The parameters that differ most, in standard deviations of IV.
    pub parameters: Vec<ParameterDifference>,
    /// The share of each joint in the squared torques that the difference of the estimates causes, percent.
    pub joint_percent: Vec<f64>,
    /// The errors of the simulator that would explain the difference, the best explanation first; only if the verdict is an alarm.
    pub explanations: Vec<BiasExplanation>,
}

/// The conclusion from a comparison of two estimates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Comparison {
    /// The difference is within noise.
    Agree,
    /// It is more than noise, but negligible compared with the standard deviations.
    SmallDifference,
    /// It is more than noise and not negligible.
    Alarm,
    /// It is more than noise and not negligible, but DIDIM explains the torques better than IV: the measured motion may be wrong as
    /// well as the simulated one.
    Undecided,
    /// It is not negligible but within noise, and the noise comes from the simulator: the simulated motion explains the
    /// torques worse than the measured one.
    Unclear,
}

impl Comparison {
    /// Whether the estimates that were compared with IV cannot be trusted.
    #[must_use]
    pub fn distrusts(self) -> bool {
        matches!(self, Self::Alarm | Self::Unclear)
    }
}

/// One parameter's difference between two estimates.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct ParameterDifference {
    /// The parameter.
    pub name: String,
    /// The difference, in its unit.
    pub difference: f64,
    /// The same in standard deviations of IV, with the autocorrelation of the residual.
    pub deviations: f64,
}

/// An error of the simulator that would explain a difference.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub struct BiasExplanation {
    /// The quantity in error.
    pub kind: BiasKind,
    /// The simulator's value over the true one, or minus the true one for a delay (s); `null` if the difference requires a
    /// factor that is not positive.
    pub simulator_to_true: Option<f64>,
    /// Its standard deviation.
    pub standard_deviation: Option<f64>,
    /// Share of the statistic that it explains, percent.
    pub explained_percent: f64,
}

/// Which method to use in a case.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Advice {
    /// The case.
    pub case: String,
    /// The recommended method; `null` if no method can be recommended.
    #[serde(alias = "take")]
    pub recommended: Option<Method>,
    /// Methods whose estimates cannot be trusted.
    pub distrust: Vec<Method>,
    /// Why, with the numbers.
    pub text: String,
}
