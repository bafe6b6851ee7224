//! Every rule by hand-made results.

use std::path::Path;

use super::judge;
use crate::diagnosis::advice::tests::simulator;
use thetahat_estimation::{
    checks::{Code, Finding, Severity},
    identification::{Method, Status},
    statistics::FTest,
};
use thetahat_report::results::{
    Advice, CaseDiagnosis, Comparison, DriveGainResult, Explained, Influence, JointResidual, NOMINAL, ParameterResult,
    PhysicalResult, ReasonCode, RecordingFindings, ResidualResult, Results, RunResult, Verdict,
};

const ROBOT: &str = r#"{
    "schema": 1, "thetahat": "0.1.0", "robot": "r", "title": "t", "samples_used": 1000, "decimated_rows": 100,
    "robot_joints": [{ "name": "a", "kind": "revolute", "position_unit": "rad", "torque_unit": "N m" },
                     { "name": "b", "kind": "revolute", "position_unit": "rad", "torque_unit": "N m" }],
    "recordings": [], "validation_recordings": [], "seed": null, "elimination": null,
    "bandwidth": { "position_cutoff_hz": 50.0, "decimation_cutoff_hz": 20.0 },
    "experiment_description": "", "robot_description": "", "runs": []
}"#;

fn parameter() -> ParameterResult {
    ParameterResult {
        name: "fv1".to_owned(),
        estimate: 1.0,
        standard_deviation: Some(0.1),
        relative_standard_deviation_percent: Some(10.0),
        true_value: None,
        unit: "N m s/rad".to_owned(),
        expression: "fv1".to_owned(),
        shown: true,
        standard_deviation_robust: Some(0.1),
        interval_95: Some([0.8, 1.2]),
    }
}

fn joint(joint: usize, p_value: f64, deviations_above_shifted: Option<f64>) -> JointResidual {
    let test = FTest { statistic: 1.0, numerator_freedom: 3, denominator_freedom: 30, p_value };
    JointResidual {
        joint,
        rms: 1.0,
        autocorrelation: 0.2,
        whiteness: None,
        normality: None,
        explained: Some(Explained { test, deviations_above_shifted }),
    }
}

fn run(method: Method) -> RunResult {
    RunResult {
        relative_error_percent: Some(5.0),
        joint_relative_error_percent: vec![Some(5.0), Some(6.0)],
        cross_validation_relative_error_percent: Some(7.5),
        residual: Some(ResidualResult {
            joints: vec![joint(1, 1e-30, None), joint(2, 1e-30, None)],
            homoscedasticity: None,
        }),
        parameters: vec![parameter(); 10],
        ..RunResult::new(NOMINAL, method, Status::Converged)
    }
}

fn advice(take: Option<Method>) -> Advice {
    Advice { case: NOMINAL.to_owned(), recommended: take, distrust: Vec::new(), text: "Because.".to_owned() }
}

fn good() -> Results {
    let mut results = Results::from_json(Path::new("results.json"), ROBOT).unwrap();
    results.runs = vec![run(Method::IDIM_LS), run(Method::IDIM_IV)];
    results.advice = vec![advice(Some(Method::IDIM_IV))];
    results
}

fn finding(code: Code, severity: Severity) -> Finding {
    Finding {
        code,
        severity,
        joint: Some(2),
        joint_name: Some("b".to_owned()),
        value: 3.0,
        unit: "samples".to_owned(),
        limit: Some(1.0),
        message: "it is late".to_owned(),
        remedy: "shift it".to_owned(),
        parameters: Vec::new(),
        step: None,
    }
}

fn in_recording(finding: Finding, held_back: bool) -> Vec<RecordingFindings> {
    vec![RecordingFindings { recording: "1".to_owned(), held_back, findings: vec![finding] }]
}

/// The verdict of results that `change` spoils, and the codes of its reasons.
fn judged(change: impl FnOnce(&mut Results)) -> (Verdict, Vec<ReasonCode>) {
    let mut results = good();
    change(&mut results);
    let verdict = judge(&mut results);
    assert!(results.verdict_reasons.iter().all(|r| r.text.ends_with('.') && !r.text.contains("  ")), "{results:?}");
    let text = results.to_json().unwrap();
    let read = Results::from_json(Path::new("results.json"), &text).unwrap();
    assert_eq!((read.verdict, &read.verdict_reasons), (Some(verdict), &results.verdict_reasons));
    (verdict, results.verdict_reasons.iter().map(|r| r.code).collect())
}

/// The run whose numbers are taken.
fn judged_with(change: impl FnOnce(&mut RunResult)) -> (Verdict, Vec<ReasonCode>) {
    judged(|results| change(&mut results.runs[1]))
}

fn care(code: ReasonCode) -> (Verdict, Vec<ReasonCode>) {
    (Verdict::Care, vec![code])
}

fn do_not_use(code: ReasonCode) -> (Verdict, Vec<ReasonCode>) {
    (Verdict::DoNotUse, vec![code])
}

#[test]
fn results_without_a_reason_are_good() {
    assert_eq!(judged(|_| {}), (Verdict::Good, Vec::new()));
}

#[test]
fn a_problem_of_the_checks_comes_first() {
    let found = judged(|r| {
        r.runs[0].status = Status::Diverged;
        r.findings = in_recording(finding(Code::TorqueSign, Severity::Problem), false);
    });
    assert_eq!(found, (Verdict::DoNotUse, vec![ReasonCode::CheckProblem, ReasonCode::NotConverged]));
    let held_back = judged(|r| r.findings = in_recording(finding(Code::TorqueSign, Severity::Problem), true));
    assert_eq!(held_back.0, Verdict::Good);
}

#[test]
fn warnings_and_a_lag_of_a_sample_ask_for_care_and_other_notes_for_nothing() {
    let with = |code, severity| judged(|r| r.findings = in_recording(finding(code, severity), false));
    assert_eq!(with(Code::Lag, Severity::Warning), care(ReasonCode::Lag));
    assert_eq!(with(Code::GainDrift, Severity::Warning), care(ReasonCode::CheckWarning));
    assert_eq!(with(Code::Lag, Severity::Note), care(ReasonCode::Lag));
    assert_eq!(with(Code::GainDrift, Severity::Note).0, Verdict::Good);
    let half = Finding { value: 0.7, ..finding(Code::Lag, Severity::Note) };
    assert_eq!(judged(|r| r.findings = in_recording(half, false)).0, Verdict::Good);
}

#[test]
fn recordings_that_disagree_are_not_used() {
    let with = |severity, held_back| {
        judged(|r| r.findings = in_recording(finding(Code::RecordingsContradict, severity), held_back))
    };
    assert_eq!(with(Severity::Problem, false), do_not_use(ReasonCode::RecordingsDisagree));
    assert_eq!(with(Severity::Warning, true), care(ReasonCode::RecordingsDisagree));
}

#[test]
fn a_payload_that_contradicts_the_torques_is_believed() {
    let gain = DriveGainResult {
        joint: "a".to_owned(),
        factor: Some(1.3),
        standard_deviation: Some(0.01),
        interval_95: Some([1.28, 1.32]),
        payload_rms: 5.0,
        reason: None,
    };
    let near_one = DriveGainResult { factor: Some(0.92), interval_95: Some([0.91, 0.93]), ..gain.clone() };
    assert_eq!(judged(|r| r.drive_gains = vec![gain]), do_not_use(ReasonCode::DriveGain));
    assert_eq!(judged(|r| r.drive_gains = vec![near_one.clone()]).0, Verdict::Good);
    let (_, reasons) = judged(|r| {
        r.drive_gains = vec![near_one];
        r.findings = in_recording(finding(Code::RecordingsContradict, Severity::Problem), false);
    });
    assert_eq!(reasons, [ReasonCode::DriveGain, ReasonCode::RecordingsDisagree]);
}

#[test]
fn a_nominal_run_that_did_not_converge_names_the_numbers_that_hold() {
    let mut results = good();
    results.runs[0].status = Status::Stalled;
    results.runs.push(RunResult::new("gear_ratio_0.9", Method::DIDIM, Status::Diverged));
    assert_eq!(judge(&mut results), Verdict::Care);
    let [reason] = &results.verdict_reasons[..] else { panic!("{:?}", results.verdict_reasons) };
    assert_eq!(reason.subject.method, Some(Method::IDIM_LS));
    assert!(reason.text.contains("the numbers of idim-iv, which the advice takes, hold"), "{}", reason.text);
    results.advice[0] = advice(None);
    assert_eq!(judge(&mut results), Verdict::DoNotUse);
}

#[test]
fn nothing_to_take_is_not_used() {
    assert_eq!(judged(|r| r.advice[0] = advice(None)), do_not_use(ReasonCode::Undecided));
    let undecided = judged(|r| {
        r.advice[0] = advice(None);
        r.diagnostics = vec![CaseDiagnosis {
            case: NOMINAL.to_owned(),
            endogeneity: None,
            instruments: None,
            biased_simulator: Some(simulator(Comparison::Undecided)),
            approximation: None,
        }];
    });
    assert_eq!(undecided, do_not_use(ReasonCode::Undecided));
}

#[test]
fn a_method_whose_simulator_nothing_tests_asks_for_care() {
    let with = |method| {
        judged(|r| {
            r.runs = vec![run(method)];
            r.advice[0] = advice(Some(method));
        })
    };
    assert_eq!(with(Method::DIDIM), care(ReasonCode::LastResort));
    assert_eq!(with(Method::IDIM_LS).0, Verdict::Good);
}

#[test]
fn a_joint_and_a_robot_that_are_not_explained_are_not_used() {
    let joints = |all: Vec<JointResidual>| {
        judged_with(|run| run.residual = Some(ResidualResult { joints: all, homoscedasticity: None }))
    };
    let one = joints(vec![joint(1, 1e-30, None), joint(2, 0.3, Some(1.0))]);
    assert_eq!(one, do_not_use(ReasonCode::JointNotExplained));
    let both = joints(vec![joint(1, 0.2, None), joint(2, 0.3, Some(1.0))]);
    assert_eq!(both, do_not_use(ReasonCode::NothingExplained));
    assert_eq!(joints(vec![joint(1, 1e-30, None), joint(2, 0.3, Some(9.0))]).0, Verdict::Good);
}

/// It said "idim-ls explains the torque of joint 3 no better than a constant does, and leaves 0 % of it".
#[test]
fn few_rows_are_no_fault_of_the_column() {
    let text = |left_percent| {
        let mut results = good();
        let run = &mut results.runs[1];
        let joints = vec![joint(1, 1e-30, None), joint(2, 0.3, None)];
        run.residual = Some(ResidualResult { joints, homoscedasticity: None });
        run.joint_relative_error_percent[1] = Some(left_percent);
        assert_eq!(judge(&mut results), Verdict::DoNotUse);
        results.verdict_reasons[0].text.clone()
    };
    assert!(text(0.3).contains("are too few to distinguish"), "{}", text(0.3));
    assert!(text(0.3).ends_with("record longer, or estimate fewer parameters."), "{}", text(0.3));
    assert!(text(98.0).contains("no better than a constant does, and leaves 98 % of it"), "{}", text(98.0));
}

/// Estimates from a reduction have no rows to test.
#[test]
fn without_rows_the_error_of_a_joint_decides() {
    let found = judged(|r| {
        r.advice.clear();
        r.runs.iter_mut().for_each(|run| run.residual = None);
        r.runs[0].joint_relative_error_percent[1] = Some(98.0);
        r.runs[1].joint_relative_error_percent[1] = Some(97.0);
    });
    assert_eq!(found, do_not_use(ReasonCode::JointNotExplained));
}

#[test]
fn a_joint_of_which_much_is_left_asks_for_care() {
    let with = |percent| judged_with(|run| run.joint_relative_error_percent[1] = Some(percent));
    assert_eq!(with(50.1), care(ReasonCode::JointPoorlyExplained));
    assert_eq!(with(49.9).0, Verdict::Good);
}

#[test]
fn a_joint_that_is_predicted_worse_than_by_zero_is_not_used() {
    let found = judged(|r| r.runs[0].findings = vec![finding(Code::WorseThanMean, Severity::Problem)]);
    assert_eq!(found, do_not_use(ReasonCode::JointNotExplained));
}

#[test]
fn cross_validation_above_the_fit_asks_for_care_and_far_above_for_more() {
    let with = |unseen| judged_with(|run| run.cross_validation_relative_error_percent = Some(unseen));
    assert_eq!(with(9.9).0, Verdict::Good);
    assert_eq!(with(10.1), care(ReasonCode::CrossValidation));
    assert_eq!(with(50.1), do_not_use(ReasonCode::CrossValidation));
    let large = judged_with(|run| {
        (run.relative_error_percent, run.cross_validation_relative_error_percent) = (Some(22.0), Some(51.0));
    });
    assert_eq!(large, do_not_use(ReasonCode::CrossValidation));
}

#[test]
fn what_no_robot_has_is_not_used_where_the_interval_can_be_believed() {
    let with = |severity, autocorrelation| {
        judged_with(|run| {
            run.residual.as_mut().unwrap().joints[1].autocorrelation = autocorrelation;
            run.physical = Some(PhysicalResult {
                consistent: false,
                inconsistent: Vec::new(),
                violations: Vec::new(),
                deviations: Some(3.0),
                smallest_eigenvalue: -1.0,
                findings: vec![finding(Code::NotPhysical, severity)],
                estimate: None,
                reason: None,
            });
        })
    };
    assert_eq!(with(Severity::Problem, 0.2), do_not_use(ReasonCode::NotPhysical));
    assert_eq!(with(Severity::Warning, 0.2), care(ReasonCode::NotPhysical));
    assert_eq!(with(Severity::Note, 0.2).0, Verdict::Good);
    let (verdict, codes) = with(Severity::Problem, 0.9);
    assert_eq!((verdict, codes), (Verdict::Care, vec![ReasonCode::NotPhysical, ReasonCode::CorrelatedResidual]));
}

#[test]
fn a_part_that_decides_asks_for_care() {
    let with = |change| {
        judged_with(|run| {
            run.influence = Some(Influence { part: "move 3".to_owned(), parameter: "fv1".to_owned(), change })
        })
    };
    assert_eq!(with(-4.1), care(ReasonCode::Influence));
    assert_eq!(with(3.9).0, Verdict::Good);
}

#[test]
fn a_residual_that_is_no_noise_asks_for_care() {
    let with = |r1| judged_with(|run| run.residual.as_mut().unwrap().joints[0].autocorrelation = r1);
    assert_eq!(with(0.6), care(ReasonCode::CorrelatedResidual));
    assert_eq!(with(0.4).0, Verdict::Good);
}

#[test]
fn few_rows_ask_for_care() {
    assert_eq!(judged(|r| r.decimated_rows = 99), care(ReasonCode::FewRows));
}

#[test]
fn codes_have_their_names_in_json_and_no_other() {
    for (code, name) in ReasonCode::ALL.map(|code| (code, code.name())) {
        assert_eq!(serde_json::to_string(&code).unwrap(), format!("\"{name}\""));
    }
    for verdict in [Verdict::Good, Verdict::Care, Verdict::DoNotUse] {
        assert_eq!(serde_json::to_string(&verdict).unwrap(), format!("\"{}\"", verdict.name()));
    }
}

/// A model of two joints, whose inertias have these deviations, percent.
fn with_inertias(deviations: [f64; 2]) -> Results {
    let mut results = good();
    let joint = |percent: f64| {
        format!(r#"{{"inertia": 1.0, "inertia_deviation_percent": {percent}, "speed": 1.0, "acceleration": 1.0}}"#)
    };
    let of_joint = r#"{"percent": 1.0, "moving_percent": 1.0, "near_rest_percent": 1.0,
        "near_rest_share_percent": 0.0, "rms": 0.1}"#;
    let model = format!(
        r#"{{"method": "idim-wls", "belief_weight": 1.0, "belief_percent": 141.0, "friction_transition": 0.03,
            "candidates": [], "fit": {{"percent": 1.0, "joints": [{of_joint}, {of_joint}]}}, "unseen": null,
            "joints": [{}, {}], "covariance": [1.0], "standard": [], "seconds": 0.0,
            "parameters": [{{"name": "fv1", "unit": "N m s/rad", "expression": "fv1", "value": 1.0, "a_priori": 1.0,
                "decided_percent": 99.0, "interval_95": [0.9, 1.1]}}]}}"#,
        joint(deviations[0]),
        joint(deviations[1])
    );
    results.model = Some(serde_json::from_str(&model).unwrap());
    judge(&mut results);
    results
}

/// No recorder makes torques early: at reversals it is friction that the model does not have.
#[test]
fn torques_that_look_early_ask_for_care() {
    let late = |size_s: f64, error_percent: f64| {
        let mut results = with_inertias([1.0, 1.0]);
        let cause = format!(
            r#"{{"kind": "late-torque", "subject": "", "log10_probability": -8.0, "size": {size_s}, "standard_deviation": 1e-4,
                "unit": "s", "error_percent": {error_percent}, "moved": []}}"#
        );
        results.model.as_mut().unwrap().causes.push(serde_json::from_str(&cause).unwrap());
        judge(&mut results);
        (results.verdict.unwrap(), results.verdict_reasons.iter().map(|r| r.code).collect::<Vec<_>>())
    };
    let good = (Verdict::Good, Vec::new());
    // Half a period of a controller at 1 kHz, late as the recorders are; early within the noise; early by a friction that is not modelled.
    assert_eq!([late(5e-4, 0.5), late(-2e-3, 0.2), late(-5e-4, 0.5)], [good.clone(), good.clone(), good]);
    assert_eq!(late(-2e-3, 0.5), care(ReasonCode::CorrelatedResidual));
}

#[test]
fn an_inertia_that_is_open_is_care_for_simulations_alone() {
    let uses = |deviations| with_inertias(deviations).model.unwrap().uses;
    let known = uses([1.0, 19.0]);
    assert!(known.iter().all(|u| u.verdict == Verdict::Good && u.why.is_empty()), "{known:?}");
    let open = uses([1.0, 21.0]);
    let verdicts: Vec<Verdict> = open.iter().map(|u| u.verdict).collect();
    assert_eq!(verdicts, [Verdict::Good, Verdict::Care, Verdict::Good]);
    assert_eq!(open[0].why, "on motion like its own");
    assert!(open[1].why.contains("joint 2 (b)") && !open[1].why.contains("joint 1"), "{open:?}");
}
