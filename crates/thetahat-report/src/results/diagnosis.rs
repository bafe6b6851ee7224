//! What the diagnosis of a run gives.

use serde::{Deserialize, Serialize};

use thetahat_estimation::{
    identification::Method,
    simulation::BiasKind,
    statistics::{ChiSquaredTest, FTest},
};

/// What the residual of one run says.
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
    /// Correlation of neighbouring rows.
    pub autocorrelation: f64,
    /// The Ljung-Box test of white rows.
    pub whiteness: Option<ChiSquaredTest>,
    /// The Jarque-Bera test of normal rows.
    pub normality: Option<ChiSquaredTest>,
    /// Whether the model explains the torque better than a constant.
    #[serde(default)]
    pub explained: Option<Explained>,
}

/// The model of a joint against one constant.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Explained {
    /// The F-test, with as many rows as independent ones of the residual are worth.
    #[serde(flatten)]
    pub test: FTest,
    /// Where the F-test is not certain: robust deviations by which the torque is explained better than the same torque shifted
    /// against the motion.
    #[serde(default)]
    pub stands_out: Option<f64>,
}

impl Explained {
    /// Probability of the F-test from which chance is not excluded.
    pub const LIMIT: f64 = 1e-4;
    /// Deviations from the shifted torques up to which it is not either.
    pub const LIMIT_DEVIATIONS: f64 = 4.0;

    /// Whether chance is enough to explain what the model explains.
    #[must_use]
    pub fn is_by_chance(&self) -> bool {
        self.test.p_value > Self::LIMIT && self.stands_out.is_none_or(|z| z < Self::LIMIT_DEVIATIONS)
    }
}

/// The part of the record without which the estimates change most.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Influence {
    /// The move, part or recording.
    pub part: String,
    /// The parameter that changes most in its standard deviations with correlated errors.
    pub parameter: String,
    /// Its change in standard deviations when the part is left out.
    pub change: f64,
}

/// An error that an estimate's residual hardly shows, and no interval holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum HiddenError {
    /// The torques of all joints are late; its size is the delay, s.
    LateTorque,
    /// Friction of a joint is larger near rest and falls to `1/e` of that at a tenth of the largest velocity; its size is the
    /// friction at rest less the Coulomb friction, N m or N.
    FrictionNearRest,
}

/// The bias of a run by an error of the largest size that the record leaves possible.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HiddenBias {
    /// The error.
    pub error: HiddenError,
    /// The coordinate that it belongs to, counted from one; none where it belongs to all.
    pub joint: Option<usize>,
    /// 95 % interval of the error's size, which is estimated beside the parameters.
    pub size_interval_95: [f64; 2],
    /// The parameter that it moves by most of its standard deviations.
    pub parameter: String,
    /// By how many standard deviations with correlated errors, at the end of the interval that moves it further.
    pub deviations: f64,
    /// The other parameters that this end moves by more than half of their 95 % interval.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub others: Vec<MovedParameter>,
}

/// A parameter that an error moves.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MovedParameter {
    /// Its name.
    pub parameter: String,
    /// By how many of its standard deviations with correlated errors.
    pub deviations: f64,
}

impl HiddenBias {
    /// By how many of its standard deviations it moves a parameter; none where that is less than half of the interval and another
    /// moves further.
    #[must_use]
    pub fn deviations_of(&self, parameter: &str) -> Option<f64> {
        if self.parameter == parameter {
            return Some(self.deviations);
        }
        self.others.iter().find(|moved| moved.parameter == parameter).map(|moved| moved.deviations)
    }

    /// Whether the residual shows the error: its interval has no zero.
    #[must_use]
    pub fn is_seen(&self) -> bool {
        let [from, to] = self.size_interval_95;
        from > 0.0 || to < 0.0
    }
}

/// What one case says of its methods.
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

/// DIDIM against CLIE: what the approximation of the sensitivities by phi, equations (16) and (17), leaves out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ApproximationResult {
    /// Whether an estimate differs by more than its deviation.
    pub matters: bool,
    /// Average difference of the estimates in standard deviations of CLIE, with correlated errors.
    pub average_difference: f64,
    /// Every parameter.
    pub parameters: Vec<ApproximatedParameter>,
}

/// A parameter of DIDIM beside that of CLIE.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ApproximatedParameter {
    /// Its name.
    pub name: String,
    /// `100 |Z_i - J_i| / |J_i|`: how far the approximated sensitivity of DIDIM is from the exact one of CLIE, each at its own
    /// estimate.
    pub column_percent: f64,
    /// DIDIM less CLIE.
    pub difference: f64,
    /// The same in standard deviations of CLIE, with correlated errors.
    pub deviations: f64,
}

/// The Durbin-Wu-Hausman test of LS against IV.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct EndogeneityResult {
    /// The F-test of the augmented regression, for independent rows of equal variance.
    pub classical: FTest,
    /// The same with the autocorrelation and the variance of each joint's residual.
    pub robust: ChiSquaredTest,
    /// Average difference of the estimates in standard deviations of IV.
    pub average_difference: f64,
    /// The parameters that differ most.
    pub parameters: Vec<ParameterDifference>,
    /// What follows.
    pub verdict: Comparison,
}

/// How strong the instruments are.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct InstrumentResult {
    /// The conditional first-stage F statistic of each parameter, in their order; empty where the rank is not full.
    pub f_statistics: Vec<f64>,
    /// The smallest of them.
    pub smallest_f: f64,
    /// The parameter that has it.
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
    /// What 5 % of the statistics of an unbiased simulator exceed, by parametric bootstrap.
    pub threshold: f64,
    /// Part of those statistics that are at least as large, the record's own counted.
    pub p_value: f64,
    /// Draws of the bootstrap.
    pub draws: usize,
    /// Its seed.
    pub seed: u64,
    /// Average difference of the estimates in standard deviations of IV.
    pub average_difference: f64,
    /// DIDIM's residual over IV's: above one, the simulated motion explains the torques worse than the measured one.
    pub residual_ratio: f64,
    /// The average difference below which a bias does little.
    pub harmless_below: f64,
    /// What follows.
    pub verdict: Comparison,
    /// The parameters that differ most, in standard deviations of IV.
    pub parameters: Vec<ParameterDifference>,
    /// The part of each joint in the squared torques that the difference stands for, percent.
    pub joint_percent: Vec<f64>,
    /// How large an error of the simulator would explain the difference, the best first; only where the verdict is an alarm.
    pub explanations: Vec<BiasExplanation>,
}

/// What a comparison of two estimates says.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Comparison {
    /// The difference is no more than noise.
    Agree,
    /// It is more than noise, but too small to matter beside the standard deviations.
    SmallDifference,
    /// It is more than noise, and matters.
    Alarm,
    /// It is more than noise, and matters, but DIDIM explains the torques better than IV: the measured motion may be wrong as
    /// well as the simulated one.
    Undecided,
    /// It matters and is no more than noise, but the noise comes from the simulator: the simulated motion explains the
    /// torques worse than the measured one.
    Unclear,
}

impl Comparison {
    /// Whether the estimates that were compared with IV are not to be trusted.
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

/// The error of the simulator that would explain a difference best.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub struct BiasExplanation {
    /// What would be wrong.
    pub kind: BiasKind,
    /// The simulator's value over the true one, or less the true one for a delay (s); none where the difference asks for a
    /// factor that is not positive.
    pub simulator_to_true: Option<f64>,
    /// Its standard deviation.
    pub standard_deviation: Option<f64>,
    /// Part of the statistic that it explains, percent.
    pub explained_percent: f64,
}

/// Which numbers of a case to take.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Advice {
    /// The case.
    pub case: String,
    /// The method to take; none where no method has an estimate.
    pub take: Option<Method>,
    /// Methods whose estimates are not to be trusted.
    pub distrust: Vec<Method>,
    /// Why, with the numbers.
    pub text: String,
}
