//! How well a parameter is known.

use serde::{Deserialize, Serialize};

use super::{parameters::ParameterResult, run::RunResult};
use thetahat_estimation::checks::{Code, Finding, Severity};

/// Largest half width of the 95 % interval of a precise parameter, relative to the estimate.
const PRECISE: f64 = 0.2;

/// Standard deviations in half of a 95 % interval of normal errors.
const HALF_WIDTH: f64 = 1.96;

/// How well a parameter is known, by its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Grade {
    /// The half width of its interval is at most 20 % of the estimate, and no error that the residual shows shifts it by more.
    Precise,
    /// Its interval is wider, or such an error may shift it by more; its interval excludes zero.
    Rough,
    /// Its interval contains zero, or would contain zero after such a shift, or it has no interval.
    NotIdentified,
    /// A motor inertia or a friction coefficient whose interval lies below zero: physically impossible.
    Impossible,
}

impl Grade {
    /// All grades, the best first.
    pub const ALL: [Self; 4] = [Self::Precise, Self::Rough, Self::NotIdentified, Self::Impossible];

    /// Its name in words.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Precise => "precise",
            Self::Rough => "rough",
            Self::NotIdentified => "not identified",
            Self::Impossible => "impossible",
        }
    }
}

impl ParameterResult {
    /// The standard deviation with correlated errors, or the classical one if there is none.
    #[must_use]
    pub fn deviation(&self) -> Option<f64> {
        self.standard_deviation_robust.or(self.standard_deviation)
    }

    /// Adds to the interval another half width that is independent of its own.
    pub fn widen_interval(&mut self, half_width: f64) {
        self.interval_95 = self.interval_95.map(|[low, high]| {
            let (middle, half) = (0.5 * (low + high), (0.5 * (high - low)).hypot(half_width));
            [middle - half, middle + half]
        });
    }

    /// Distance from the estimate to the farther end of `interval_95`, or 1.96 classical deviations where there is no interval. That of free
    /// estimates is half of it; a physically consistent value can be near an end.
    #[must_use]
    pub fn farther_end(&self) -> Option<f64> {
        let of_deviation = || self.standard_deviation.map(|sd| HALF_WIDTH * sd);
        self.interval_95.map(|[low, high]| (high - self.estimate).max(self.estimate - low)).or_else(of_deviation)
    }

    /// `interval_95`, or the estimate with 1.96 classical deviations on either side where there is no interval.
    #[must_use]
    pub fn interval(&self) -> Option<[f64; 2]> {
        let about = |half: f64| [self.estimate - half, self.estimate + half];
        self.interval_95.or_else(|| self.farther_end().map(about))
    }

    /// Its grade by its interval alone.
    pub(super) fn grade_of_interval(&self) -> Grade {
        let has_sign = |[low, high]: [f64; 2]| (low * self.estimate).min(high * self.estimate) > 0.0;
        match self.farther_end().zip(self.interval()) {
            Some((half, _)) if half <= PRECISE * self.estimate.abs() => Grade::Precise,
            Some((_, interval)) if has_sign(interval) => Grade::Rough,
            Some(_) | None => Grade::NotIdentified,
        }
    }
}

impl RunResult {
    /// How well one of the parameters is known.
    #[must_use]
    pub fn grade(&self, parameter: &ParameterResult) -> Grade {
        if self.impossible().any(|name| *name == parameter.name) {
            return Grade::Impossible;
        }
        let grade = parameter.grade_of_interval();
        let Some((shift, half)) = self.may_be_moved(parameter).zip(parameter.farther_end()) else { return grade };
        if shift + half >= parameter.estimate.abs() { Grade::NotIdentified } else { grade.max(Grade::Rough) }
    }

    /// Possible shift of a parameter by an error that the residual shows, if that exceeds its interval and the uncertainty of a
    /// precise parameter.
    pub(crate) fn may_be_moved(&self, parameter: &ParameterResult) -> Option<f64> {
        let seen = self.hidden_bias.iter().filter(|b| b.is_seen());
        let shifts = seen.filter_map(|b| Some((b.deviations_of(&parameter.name)? * parameter.deviation()?).abs()));
        let least = (PRECISE * parameter.estimate.abs()).max(parameter.farther_end()?);
        shifts.max_by(f64::total_cmp).filter(|shift| *shift > least)
    }

    /// The parameters of this run with a grade.
    pub fn graded(&self, grade: Grade) -> impl Iterator<Item = &ParameterResult> {
        self.parameters.iter().filter(move |p| self.grade(p) == grade)
    }

    /// The names of the parameters with physically impossible intervals: findings about one joint are those of a
    /// parameter that is negative.
    fn impossible(&self) -> impl Iterator<Item = &String> {
        let findings = self.physical.iter().flat_map(|p| &p.findings);
        let is_negative =
            |f: &&Finding| f.code == Code::NotPhysical && f.severity != Severity::Note && f.joint.is_some();
        findings.filter(is_negative).flat_map(|f| &f.parameters)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::{HiddenBias, HiddenError, MovedParameter};
    use thetahat_estimation::identification::{Method, Status};

    fn parameter(estimate: f64, interval_95: Option<[f64; 2]>, standard_deviation: Option<f64>) -> ParameterResult {
        ParameterResult {
            name: "zz1r".to_owned(),
            estimate,
            standard_deviation,
            relative_standard_deviation_percent: None,
            true_value: None,
            unit: "kg m^2".to_owned(),
            expression: "zz1".to_owned(),
            shown: true,
            standard_deviation_robust: None,
            interval_95,
        }
    }

    fn graded(estimate: f64, interval_95: Option<[f64; 2]>, standard_deviation: Option<f64>) -> Grade {
        parameter(estimate, interval_95, standard_deviation).grade_of_interval()
    }

    #[test]
    fn the_interval_decides_and_the_deviation_where_there_is_none() {
        assert_eq!(graded(-2.0, Some([-2.4, -1.6]), None), Grade::Precise);
        assert_eq!(graded(2.0, Some([1.5, 2.5]), Some(1e-9)), Grade::Rough);
        assert_eq!(graded(2.0, Some([-0.1, 4.1]), Some(1e-9)), Grade::NotIdentified);
        assert_eq!(graded(2.0, None, Some(0.2)), Grade::Precise);
        assert_eq!(graded(2.0, None, Some(1.0)), Grade::Rough);
        assert_eq!(graded(2.0, None, None), Grade::NotIdentified);
        assert_eq!(graded(f64::NAN, Some([0.0, 1.0]), None), Grade::NotIdentified);
        assert_eq!(graded(0.8, None, Some(0.0)), Grade::Precise);
    }

    #[test]
    fn half_widths_add_as_independent_errors_do() {
        let mut wide = parameter(4.0, Some([1.0, 7.0]), None);
        wide.widen_interval(4.0);
        assert_eq!(wide.interval_95, Some([-1.0, 9.0]));
        wide.widen_interval(0.0);
        assert_eq!(wide.interval_95, Some([-1.0, 9.0]));
    }

    #[test]
    fn an_error_that_the_residual_shows_makes_a_precise_parameter_rough() {
        let fc2 = ParameterResult { name: "fc2".to_owned(), ..parameter(8.0, Some([7.5, 8.5]), Some(0.27)) };
        let bias = |size_interval_95, deviations| HiddenBias {
            error: HiddenError::FrictionNearRest,
            joint: Some(2),
            size_interval_95,
            parameter: "fc2".to_owned(),
            deviations,
            others: Vec::new(),
        };
        let grade = |hidden_bias| {
            let run = RunResult::new("nominal", Method::IDIM_IV, Status::Converged);
            RunResult { hidden_bias: vec![hidden_bias], ..run }.grade(&fc2)
        };
        assert_eq!(grade(bias([4.2, 5.5], -9.2)), Grade::Rough, "2.5 of 8.0");
        assert_eq!(grade(bias([4.2, 5.5], -3.0)), Grade::Precise, "0.8 of 8.0");
        assert_eq!(grade(bias([4.2, 5.5], 28.0)), Grade::NotIdentified, "7.6 of 8.0, with an interval of 0.5");
        assert_eq!(grade(bias([-1.0, 5.5], -9.2)), Grade::Precise, "the residual does not show it");
        let others = vec![MovedParameter { parameter: "fc2".to_owned(), deviations: 9.2 }];
        let of_another = HiddenBias { parameter: "fv2".to_owned(), others, ..bias([4.2, 5.5], 12.0) };
        assert_eq!(grade(of_another), Grade::Rough, "another moves further");
        let wide = ParameterResult { interval_95: Some([2.0, 14.0]), standard_deviation: Some(3.0), ..fc2.clone() };
        let run = RunResult::new("nominal", Method::IDIM_IV, Status::Converged);
        let run = RunResult { hidden_bias: vec![bias([4.2, 5.5], 1.5)], ..run };
        assert_eq!(run.grade(&wide), Grade::Rough, "4.5 of 8.0 is within its interval");
    }
}
