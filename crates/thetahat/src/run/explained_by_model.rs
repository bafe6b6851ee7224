//! What the model says of findings, and findings of the model.

use thetahat_estimation::checks::{Code, Finding, Severity};
use thetahat_report::results::{CauseKind, ModelCause, ModelResult, RecordingFindings};

/// The model's error over the torque that a wider filter would explain, below which nothing of it is missing. With a filter that
/// does remove motion, at 0.6 Hz instead of 15, it is 0.33; where joints move one after the other and their friction is fitted
/// badly by the check, 0.10.
const NOTHING_MISSING: f64 = 0.15;
/// Largest noise of the accelerations that is judged by what it does to estimates, percent: at more, predictions have it too.
const MOST_NOISE_PERCENT: f64 = 10.0;
/// Part of the model's error that another load explains where it is the reason of it: 0.56 to 0.9 where a payload was picked up.
const MOST_OF_ERROR: f64 = 0.5;
/// Error on unseen motion, percent, up to which the model's residual would show friction that drifts.
const SHOWS_DRIFTS_PERCENT: f64 = 10.0;
/// Part of half an interval by which noise of the accelerations may move an estimate.
const MOVED: f64 = 0.1;

/// The findings as they are with a model: motion that the filter removes is in the model's error, and a part r of noise in the
/// accelerations takes the part r^2 off the estimates.
pub(super) fn with_model_explained(findings: &mut [RecordingFindings], model: &ModelResult) {
    let estimates = model.parameters.iter().filter_map(|p| Some((p.value, p.interval_95?)));
    let estimates: Vec<Estimate> = estimates.collect();
    let of_recordings = findings.iter_mut().filter(|f| !f.held_back);
    let unseen = model.unseen.as_ref().map_or(f64::INFINITY, |error| error.percent);
    of_recordings.flat_map(|of| &mut of.findings).for_each(|f| explain(f, unseen, &estimates));
}

/// Makes notes of drifts of friction that are none: the check compares blocks of time of one joint, near rest too, and in short or slow
/// recordings three of thirty clean ones have one; the causes of the model, which were tested, are what its whitened residual shows.
pub(super) fn without_drifts_that_do_not_show(findings: &mut [RecordingFindings], model: &ModelResult) {
    let drifts = |c: &ModelCause| matches!(c.kind, CauseKind::FrictionDrift | CauseKind::GainDrift);
    let unseen = model.unseen.as_ref().map_or(f64::INFINITY, |error| error.percent);
    if unseen > SHOWS_DRIFTS_PERCENT || model.causes.iter().any(drifts) {
        return;
    }
    let found = findings.iter_mut().filter(|of| !of.held_back).flat_map(|of| &mut of.findings);
    let warnings = found.filter(|f| f.code == Code::FrictionDrift && f.severity == Severity::Warning);
    warnings.for_each(|finding| make_note(finding, "the residual of the model shows no drift"));
}

/// Leaves out the causes where the checks found that the signals are not those of the robot alone, as they are said to be: errors of a model
/// that was fitted to them have none. But another load from some instant on is the reason why nothing fits, where it explains most of it.
pub(super) fn keep_causes_of_these_data(model: &mut ModelResult, findings: &[RecordingFindings]) {
    let all = || findings.iter().filter(|of| !of.held_back).flat_map(|of| &of.findings);
    let least = MOST_OF_ERROR * model.fit.percent;
    if all().any(is_of_other_signals) {
        model.causes.clear();
    } else if all().any(|finding| finding.code == Code::WrongRobot && finding.severity == Severity::Problem) {
        model.causes.retain(|cause| cause.kind == CauseKind::Payload && cause.error_percent > least);
    }
}

fn is_of_other_signals(finding: &Finding) -> bool {
    let is_of_signals = matches!(
        finding.code,
        Code::PositionScale
            | Code::PositionSign
            | Code::PositionZero
            | Code::TorqueScale
            | Code::TorqueSign
            | Code::JointsSwapped
            | Code::Lag
            | Code::GravityDirection
            | Code::TimeScale
            | Code::ExternalForce
    );
    let is_limited = finding.code == Code::TorqueSaturated && finding.severity < Severity::Note;
    is_limited || (is_of_signals && finding.severity == Severity::Problem)
}

/// A value with its interval.
type Estimate = (f64, [f64; 2]);

fn explain(finding: &mut Finding, error_percent: f64, estimates: &[Estimate]) {
    let is_noise = matches!(finding.code, Code::PositionQuantised | Code::CutoffHigh);
    let why = if finding.code == Code::CutoffLow && error_percent < NOTHING_MISSING * finding.value {
        format!("the model's error on data not used is {error_percent:.2} %: no motion is missing in it")
    } else if is_noise && finding.value < MOST_NOISE_PERCENT && moves_nothing(finding.value / 100.0, estimates) {
        "no estimate is moved by a tenth of its interval".to_owned()
    } else {
        return;
    };
    make_note(finding, &why);
}

fn make_note(finding: &mut Finding, why: &str) {
    finding.severity = Severity::Note;
    finding.message += &format!("; {why}");
    finding.remedy = "nothing to do".to_owned();
    finding.step = None;
}

/// Whether the intervals are wide against what noise takes off the estimates.
fn moves_nothing(noise: f64, estimates: &[Estimate]) -> bool {
    let is_small = |(value, [low, high]): &Estimate| noise.powi(2) * value.abs() < MOVED * (high - low) / 2.0;
    !estimates.is_empty() && estimates.iter().all(is_small)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The severity of a finding after it was explained by a model with an error of 0.8 % and one estimate of 1 +- 0.01.
    fn explained(code: Code, value: f64) -> Severity {
        let mut finding = finding(code, value);
        explain(&mut finding, 0.8, &[(1.0, [0.99, 1.01])]);
        assert_eq!(finding.message.contains(';'), finding.severity == Severity::Note);
        finding.severity
    }

    fn finding(code: Code, value: f64) -> Finding {
        Finding {
            code,
            severity: Severity::Warning,
            joint: None,
            joint_name: None,
            value,
            unit: "%".to_owned(),
            limit: Some(2.0),
            message: "found".to_owned(),
            remedy: "do".to_owned(),
            parameters: Vec::new(),
            step: None,
        }
    }

    /// 8 % of the torques cannot be missing where 0.8 % are, 5 % can; 2.3 % of noise take 0.05 % off an estimate, a twentieth of
    /// its interval, 4 % take 0.16 % off.
    #[test]
    fn a_finding_stays_where_the_model_does_not_answer_it() {
        assert_eq!(explained(Code::CutoffLow, 8.0), Severity::Note);
        assert_eq!(explained(Code::CutoffLow, 5.0), Severity::Warning);
        assert_eq!(explained(Code::PositionQuantised, 2.3), Severity::Note);
        assert_eq!(explained(Code::CutoffHigh, 4.0), Severity::Warning);
        assert_eq!(explained(Code::Lag, 8.0), Severity::Warning);
    }

    /// A model with an error of this size on unseen motion, and one cause.
    fn severity_of_drift(unseen: f64, cause: &str) -> Severity {
        let joint = r#"{"percent": 1.0, "moving_percent": 1.0, "near_rest_percent": 1.0, "near_rest_share_percent": 0.0, "rms": 0.1}"#;
        let model = format!(
            r#"{{"method": "idim-wls", "belief_weight": 1.0, "belief_percent": 141.0, "friction_transition": 0.03, "candidates": [],
                "fit": {{"percent": 1.0, "joints": [{joint}]}}, "unseen": {{"percent": {unseen}, "joints": [{joint}]}}, "joints": [],
                "covariance": [], "standard": [], "seconds": 0.0, "parameters": [], "causes": [{{"kind": "{cause}", "subject": "",
                "log10_probability": -9.0, "size": null, "standard_deviation": null, "unit": "", "error_percent": 1.0, "moved": []}}]}}"#
        );
        let mut findings = vec![RecordingFindings {
            recording: "a".to_owned(),
            held_back: false,
            findings: vec![finding(Code::FrictionDrift, 15.0)],
        }];
        without_drifts_that_do_not_show(&mut findings, &serde_json::from_str(&model).unwrap());
        findings[0].findings[0].severity
    }

    #[test]
    fn a_drift_of_friction_stays_where_the_model_shows_one_or_nothing() {
        assert_eq!(severity_of_drift(1.0, "length"), Severity::Note);
        assert_eq!(severity_of_drift(1.0, "gain-drift"), Severity::Warning);
        assert_eq!(severity_of_drift(12.0, "length"), Severity::Warning);
    }

    #[test]
    fn noise_is_not_judged_without_intervals_or_where_it_is_large() {
        assert!(!moves_nothing(0.01, &[]));
        assert_eq!(explained(Code::PositionQuantised, 20.0), Severity::Warning);
    }
}
