//! The model: one robot with parameters, which predictions and exports use.

use serde::{Deserialize, Serialize};

use super::{
    cause::{ModelCause, SmallestShown},
    parameters::ParameterResult,
    physical::PhysicalResult,
    run::RunResult,
    verdict::Verdict,
};
use thetahat_estimation::identification::{Method, Status};
use thetahat_ground::linear_algebra::Matrix;
use thetahat_model::{dynamics::FrictionTransition, robot::TermDescription};

/// Percent of a base parameter that the recordings must have decided for it to be quoted by itself.
const QUOTED: f64 = 90.0;

/// Half of a 95 % interval in deviations.
const NORMAL_QUANTILE: f64 = 1.96;

/// The physically consistent robot that predicts unseen motion best.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ModelResult {
    /// The method whose rows it is fitted to.
    pub method: Method,
    /// Weight of the belief in the a-priori robot, in long-run variances of the residual.
    pub belief_weight: f64,
    /// The same as a deviation: by how many percent an a-priori body is believed to be off.
    pub belief_percent: f64,
    /// Links whose a-priori bodies were guessed from the geometry, from one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub guessed_links: Vec<usize>,
    /// Sizes in the description that are estimated from the recordings, with their deviations in the intervals: `[model] estimated`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub estimated_sizes: Vec<String>,
    /// Velocity v of `tanh(dq / v)`, the sign of the Coulomb friction, rad/s (m/s where all joints slide).
    pub friction_transition: f64,
    /// The same of joints that slide, m/s, where others turn.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction_transition_sliding: Option<f64>,
    /// Torque terms that it has in addition to the robot's, as a `[[term]]` states them: those that predict unseen motion better.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub terms: Vec<TermDescription>,
    /// What was tried, the default first.
    pub candidates: Vec<ModelCandidate>,
    /// Error on the rows that it is fitted to.
    pub fit: ModelError,
    /// Error on the recordings that were held back; `null` without any.
    #[serde(default)]
    pub held_back: Option<ModelError>,
    /// Error on parts of the recordings that neither fit nor choice has seen; `null` where none can be left out.
    pub unseen: Option<ModelError>,
    /// Root mean square of the errors of its torques that last for a quarter of a period of the position filter's cut-off, while a joint moves,
    /// percent of all torques: no noise. `null` where only factors of the rows are known.
    #[serde(default)]
    pub lasting_percent: Option<f64>,
    /// What the residual shows that the model or the recordings are wrong in, the strongest first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub causes: Vec<ModelCause>,
    /// Errors of the description that these recordings do not show unless they are larger.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub smallest_shown: Vec<SmallestShown>,
    /// What the recordings cover and determine of each joint.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub joints: Vec<ModelJoint>,
    /// What it may be used for.
    #[serde(default)]
    pub uses: Vec<ModelUse>,
    /// All base parameters.
    pub parameters: Vec<ModelParameter>,
    /// Covariance of the base parameters, by recordings and belief: the lower triangle row by row, SI.
    pub covariance: Vec<f64>,
    /// All standard parameters.
    pub standard: Vec<ModelStandardParameter>,
    /// Time of fit and choice, s.
    pub seconds: f64,
}

/// A candidate for the model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ModelCandidate {
    /// Weight of the belief.
    pub belief_weight: f64,
    /// Velocity of the friction's transition.
    pub friction_transition: f64,
    /// The same of joints that slide, m/s, where others turn.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction_transition_sliding: Option<f64>,
    /// Kinds of the torque terms that it has in addition to the robot's.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub terms: Vec<String>,
    /// Mean square of its errors on what is left out, in long-run variances of the residual.
    pub unseen_square: f64,
    /// Difference of that square from the one of the candidate that it challenged, and its standard error between the parts.
    pub difference: Option<[f64; 2]>,
    /// Whether it was taken over that candidate.
    pub taken: bool,
}

/// The error of predicted torques, percent: `100 |tau - tau_hat| / |tau|` over the samples that are named.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ModelError {
    /// All joints and samples.
    pub percent: f64,
    /// Each joint.
    pub joints: Vec<ModelJointError>,
}

/// The error of one joint's torque.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ModelJointError {
    /// All samples; `null` where the torque is zero.
    pub percent: Option<f64>,
    /// While the joint moves.
    pub moving_percent: Option<f64>,
    /// While it is near rest.
    pub near_rest_percent: Option<f64>,
    /// Percent of the samples near rest.
    pub near_rest_share_percent: f64,
    /// Root mean square of the error, N m or N.
    pub rms: f64,
}

/// What the recordings cover and determine of a joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ModelJoint {
    /// Its inertia at the recorded positions, root mean square: the diagonal of the mass matrix, kg m^2 or kg.
    pub inertia: f64,
    /// Deviation of the inertia by recordings and belief, percent of it.
    pub inertia_deviation_percent: f64,
    /// Largest speed in the windows, rad/s or m/s; `null` where only factors of the rows are known.
    pub speed: Option<f64>,
    /// The same of the acceleration, rad/s^2 or m/s^2.
    pub acceleration: Option<f64>,
}

/// A base parameter of the model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ModelParameter {
    /// Name.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// Regrouping formula.
    pub expression: String,
    /// Value.
    pub value: f64,
    /// Value of the a-priori robot.
    pub a_priori: f64,
    /// Percent of it that the recordings decided: `100 (1 - variance / variance by the belief alone)`.
    pub decided_percent: f64,
    /// Interval of the recordings alone, inside what a robot can have, widened by what the causes that were named may have moved;
    /// `null` where the recordings do not determine it.
    pub interval_95: Option<[f64; 2]>,
    /// True value, for a simulated robot.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub true_value: Option<f64>,
}

/// A standard parameter of the model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ModelStandardParameter {
    /// Name.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// Value.
    pub value: f64,
    /// Value believed before the recordings.
    pub a_priori: f64,
}

impl ModelParameter {
    /// Whether the recordings decided it, so that it can be quoted by itself.
    #[must_use]
    pub fn is_decided(&self) -> bool {
        self.decided_percent >= QUOTED
    }

    /// The factor of a deviation by recordings and belief that makes it the interval's, at most that of the belief.
    fn widening(&self, deviation: f64) -> f64 {
        let most = (1.0 - 0.01 * self.decided_percent).max(f64::MIN_POSITIVE).powf(-0.5);
        let of_interval = self.interval_95.map_or(1.0, |[low, high]| 0.5 * (high - low) / NORMAL_QUANTILE / deviation);
        if of_interval.is_finite() { of_interval.min(most).max(1.0) } else { 1.0 }
    }
}

/// The kinds of torque terms, each once.
#[doc(hidden)]
#[must_use]
pub fn kinds_of(terms: &[TermDescription]) -> Vec<&'static str> {
    let mut kinds: Vec<&'static str> = terms.iter().map(TermDescription::kind).collect();
    kinds.dedup();
    kinds
}

impl ModelResult {
    /// The kinds of the torque terms that it has in addition to the robot's.
    #[must_use]
    pub fn kinds_of_terms(&self) -> Vec<&'static str> {
        kinds_of(&self.terms)
    }

    /// The velocities at which its friction changes its sign.
    #[doc(hidden)]
    #[must_use]
    pub fn transition(&self) -> FrictionTransition {
        let turning = self.friction_transition;
        FrictionTransition { turning, sliding: self.friction_transition_sliding.unwrap_or(turning) }
    }

    /// The error that it is judged by: on recordings that were held back, else on parts that were left out, else of the fit.
    #[must_use]
    pub fn judged_error(&self) -> &ModelError {
        self.held_back.as_ref().or(self.unseen.as_ref()).unwrap_or(&self.fit)
    }

    /// The covariance for another motion: a deviation is no less than that of the interval, which rests on the errors of the rows as they
    /// are, and no more than that of the belief. Correlations stay.
    #[doc(hidden)]
    #[must_use]
    pub fn open_covariance(&self) -> Matrix {
        let count = self.parameters.len();
        let covariance =
            Matrix::from_lower_half(count, &self.covariance).unwrap_or_else(|| Matrix::zeros(count, count));
        let deviation = |i: usize| covariance.at(i, i).max(0.0).sqrt();
        let factors: Vec<f64> = (0..count).map(|i| self.parameters[i].widening(deviation(i))).collect();
        covariance.scale_rows(&factors).scale_columns(&factors)
    }

    /// The model as a run of the nominal case, for what takes estimates of a run: its base parameters with the deviations
    /// of its covariance, and its standard parameters as the consistent estimate.
    #[must_use]
    pub fn as_run(&self, case: &str) -> RunResult {
        let deviation =
            |i: usize| self.covariance.get((i + 1) * (i + 2) / 2 - 1).copied().unwrap_or(0.0).max(0.0).sqrt();
        let parameter = |(i, p): (usize, &ModelParameter)| ParameterResult {
            name: p.name.clone(),
            estimate: p.value,
            standard_deviation: Some(deviation(i)),
            relative_standard_deviation_percent: None,
            true_value: p.true_value,
            unit: p.unit.clone(),
            expression: p.expression.clone(),
            shown: true,
            standard_deviation_robust: Some(deviation(i)),
            interval_95: p.interval_95,
        };
        RunResult {
            relative_error_percent: Some(self.fit.percent),
            joint_relative_error_percent: self.fit.joints.iter().map(|j| j.percent).collect(),
            cross_validation_relative_error_percent: self
                .held_back
                .as_ref()
                .or(self.unseen.as_ref())
                .map(|e| e.percent),
            parameters: self.parameters.iter().enumerate().map(parameter).collect(),
            covariance: self.covariance.clone(),
            physical: Some(self.physical()),
            ..RunResult::new(case, self.method, Status::Converged)
        }
    }

    /// [`ModelResult::as_run`] in which parameters that the recordings did not decide have no deviation and no interval: what is
    /// quoted by itself.
    #[must_use]
    pub fn quoted(&self, case: &str) -> RunResult {
        let mut run = self.as_run(case);
        for (parameter, own) in run.parameters.iter_mut().zip(&self.parameters) {
            let interval = own.interval_95.filter(|_| own.is_decided());
            parameter.interval_95 = interval;
            let half = interval.map(|[low, high]| 0.5 * (high - low) / NORMAL_QUANTILE);
            (parameter.standard_deviation, parameter.standard_deviation_robust) = (half, half);
        }
        run
    }

    fn physical(&self) -> PhysicalResult {
        PhysicalResult {
            consistent: true,
            inconsistent: Vec::new(),
            violations: Vec::new(),
            deviations: None,
            smallest_eigenvalue: 0.0,
            findings: Vec::new(),
            estimate: None,
            reason: None,
        }
    }

    /// The value of a standard parameter.
    #[must_use]
    pub fn standard_value(&self, name: &str) -> Option<f64> {
        self.standard.iter().find(|p| p.name == name).map(|p| p.value)
    }
}

/// What a model can be used for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum UseGrade {
    /// Predict the torques of a motion.
    PredictTorques,
    /// Simulate the robot.
    Simulate,
    /// Quote the value of a single parameter.
    QuoteSingleValues,
}

impl UseGrade {
    /// In words.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::PredictTorques => "predict torques",
            Self::Simulate => "simulate",
            Self::QuoteSingleValues => "quote single values",
        }
    }
}

/// The verdict on one use of the model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ModelUse {
    /// The use.
    pub for_what: UseGrade,
    /// The verdict.
    pub verdict: Verdict,
    /// Why it is not good, or on what motion alone it is; empty if it is good without a condition.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub why: String,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parameter(interval_95: Option<[f64; 2]>, decided_percent: f64) -> ModelParameter {
        ModelParameter {
            name: "fv1".to_owned(),
            unit: "N m s/rad".to_owned(),
            expression: "fv1".to_owned(),
            value: 1.0,
            a_priori: 1.0,
            decided_percent,
            interval_95,
            true_value: None,
        }
    }

    #[test]
    fn a_deviation_is_the_intervals_and_at_most_the_beliefs() {
        let half = 5.0 * NORMAL_QUANTILE;
        let wide = Some([1.0 - half, 1.0 + half]);
        assert!((parameter(wide, 99.99).widening(1.0) - 5.0).abs() < 1e-12);
        assert!((parameter(wide, 75.0).widening(1.0) - 2.0).abs() < 1e-12);
        assert_eq!(parameter(wide, 99.99).widening(10.0), 1.0);
        assert_eq!(parameter(None, 99.99).widening(1.0), 1.0);
        assert_eq!(parameter(wide, 99.99).widening(0.0), 1.0);
    }
}
