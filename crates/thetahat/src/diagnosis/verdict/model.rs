//! What the model says of itself: whether it predicts, and what it is wrong in.

use super::{
    estimates::correlated_from,
    judged::nominal_runs,
    reason::{ReasonText, reason},
};
use thetahat_estimation::checks::Code;
use thetahat_ground::number::significant;
use thetahat_report::results::{
    CauseKind, ModelCause, ModelError, ModelJoint, ModelResult, ModelUse, ReasonCode, ReasonSubject, Results,
    RunResult, UseGrade, Verdict, VerdictReason,
};

/// Unseen error, percent of all torques, from which the model explains too little.
const TOO_LITTLE_PERCENT: f64 = 50.0;
/// The same of one joint, from which its torque is not explained.
const UNEXPLAINED_PERCENT: f64 = 95.0;
/// The same from which much of it is left.
const POORLY_PERCENT: f64 = 50.0;
/// Torque of a joint, relative to the largest, below which an error of it does not count against the model as a whole.
const SMALL_TORQUE: f64 = 0.05;
/// Unseen error over the error of the fit, from which the recordings are too little for the model.
const FAR_FROM_FIT: f64 = 2.0;
/// Unseen error, percent of all torques, below which predictions are good.
const PREDICTS_PERCENT: f64 = 10.0;
/// Part of the residual that its neighbour rows predict, percent of all torques, from which it is no noise.
const STRUCTURE_PERCENT: f64 = 1.0;
/// Errors that last for a part of the motion's period, percent of all torques, from which the model lacks something. Clean recordings have
/// none: in a narrow band few rows look like noise, and the correlation of neighbours does not show it.
const LASTING_PERCENT: f64 = 0.7;
/// What a payload that is picked up explains, percent, from which the recording is not one robot's.
const PAYLOAD_PERCENT: f64 = 2.0;
/// Delay of the torques that is worth a correction: in sample periods, and in s. Torques that are held are half a period of their
/// controller old.
const LATE_SAMPLES: f64 = 0.75;
const LATE_S: f64 = 1e-3;
/// Sample periods of a delay where a filter of the torques is estimated, of which it is a part: a torque that is held is half a sample late.
const LATE_FILTER_SAMPLES: f64 = 0.6;
/// Part by which times may be too long or too short: velocities are wrong by as much, inertias by twice of it.
const WRONG_CLOCK: f64 = 0.02;
/// Torque of a joint, relative to the largest, that is rounding.
const NO_TORQUE: f64 = 1e-9;
/// Percent of the base parameters that the recordings must have decided for simulations to rest on them.
const MOSTLY_DECIDED: f64 = 50.0;

/// Deviation of a joint's inertia, percent, from which a simulation of the joint rests on a guess. The demonstration leaves 9 at its
/// lightest joint.
const OPEN_INERTIA_PERCENT: f64 = 20.0;

pub(super) fn reasons(results: &Results, model: &ModelResult) -> Vec<VerdictReason> {
    let error = model.judged_error();
    let mut reasons: Vec<VerdictReason> = too_little(error).into_iter().collect();
    if reasons.is_empty() {
        reasons.extend(joints(results, error));
    }
    reasons.extend(far_from_fit(model));
    // A delay that is weaker than another cause may be what that one left, and noise in a stiff loop looks like one: the check
    // of lags must have found it too.
    let has_lag = results.findings.iter().flat_map(|r| &r.findings).any(|f| f.code == Code::Lag);
    let is_own = |(k, c): &(usize, &ModelCause)| {
        c.kind != CauseKind::LateTorque || !c.subject.is_empty() || (*k == 0 && has_lag)
    };
    let causes = model.causes.iter().enumerate().filter(is_own);
    let mut causes: Vec<VerdictReason> = causes.filter_map(|(_, c)| cause(results, c)).collect();
    if causes.is_empty() {
        causes.extend(structure(results, model).or_else(|| early_at_reversals(results, model)));
    }
    reasons.extend(causes);
    reasons
}

fn too_little(error: &ModelError) -> Option<VerdictReason> {
    let seen = format!("The model leaves {:.0} % of the torques of unseen motion", error.percent);
    let said = ReasonText::new(seen, "check that the torques belong to this motion and this robot");
    let numbers = [("unseen_percent", Some(error.percent)), ("limit", Some(TOO_LITTLE_PERCENT))];
    let found = || reason(ReasonCode::NothingExplained, Verdict::DoNotUse, &numbers, ReasonSubject::default(), said);
    (error.percent > TOO_LITTLE_PERCENT).then(found)
}

/// Joints of which much is left.
fn joints(results: &Results, error: &ModelError) -> Vec<VerdictReason> {
    let torque = |j: usize| {
        let joint = &error.joints[j];
        joint.percent.filter(|p| *p > 0.0).map_or(0.0, |p| 100.0 * joint.rms / p)
    };
    let largest = (0..error.joints.len()).map(torque).fold(0.0, f64::max);
    let of_joint = |j: usize| {
        let percent = error.joints[j].percent.filter(|p| *p > POORLY_PERCENT && torque(j) > NO_TORQUE * largest)?;
        let is_small = torque(j) < SMALL_TORQUE * largest;
        let label = results.joint_label(j);
        let (code, verdict) = match (percent > UNEXPLAINED_PERCENT, is_small) {
            (true, false) => (ReasonCode::JointNotExplained, Verdict::DoNotUse),
            (true, true) => (ReasonCode::JointNotExplained, Verdict::Care),
            (false, _) => (ReasonCode::JointPoorlyExplained, Verdict::Care),
        };
        let of_all = if is_small { ", which is small against the others" } else { "" };
        let seen = format!("The model leaves {percent:.0} % of the torque of {label} on unseen motion{of_all}");
        let remedy = match verdict {
            Verdict::DoNotUse => format!("check the torque column of {label}"),
            Verdict::Care | Verdict::Good => format!("do not use its torque of {label} by itself"),
        };
        let joint = results.robot_joints.get(j).map(|joint| joint.name.clone());
        let numbers = [("unseen_percent", Some(percent)), ("limit", Some(POORLY_PERCENT))];
        let subject = ReasonSubject { joint, ..ReasonSubject::default() };
        Some(reason(code, verdict, &numbers, subject, ReasonText::new(seen, remedy)))
    };
    (0..error.joints.len()).filter_map(of_joint).collect()
}

fn far_from_fit(model: &ModelResult) -> Option<VerdictReason> {
    let (unseen, fit) = (model.judged_error().percent, model.fit.percent);
    let times = unseen / fit;
    let seen = format!(
        "The model's error on unseen motion is {} %, {times:.1} times the {} % of its fit",
        significant(unseen, 3),
        significant(fit, 3)
    );
    let said = ReasonText::new(seen, "record more motion, of all joints together");
    let numbers = [("unseen_percent", Some(unseen)), ("fit_percent", Some(fit)), ("limit", Some(FAR_FROM_FIT))];
    let is_far = times > FAR_FROM_FIT && unseen > STRUCTURE_PERCENT;
    is_far.then(|| reason(ReasonCode::CrossValidation, Verdict::Care, &numbers, ReasonSubject::default(), said))
}

/// A cause that matters.
fn cause(results: &Results, found: &ModelCause) -> Option<VerdictReason> {
    let verdict = match found.kind {
        CauseKind::LateTorque => {
            let late = found.size.unwrap_or(0.0).abs();
            (late > least_delay_s(results)).then_some(Verdict::Care)?
        }
        CauseKind::Payload if found.error_percent > PAYLOAD_PERCENT => Verdict::DoNotUse,
        CauseKind::TimeScale if found.rivals.is_empty() && found.size.is_some_and(|size| size.abs() > WRONG_CLOCK) => {
            Verdict::DoNotUse
        }
        CauseKind::Payload
        | CauseKind::EncoderZero
        | CauseKind::GearRatio
        | CauseKind::DriveGain
        | CauseKind::OffsetDrift
        | CauseKind::Elasticity
        | CauseKind::Length
        | CauseKind::Coupling
        | CauseKind::LoadFriction
        | CauseKind::SpeedFriction
        | CauseKind::FrictionDrift
        | CauseKind::GravityDirection
        | CauseKind::Crosstalk
        | CauseKind::FallingConstant
        | CauseKind::JointSpring
        | CauseKind::AsymmetricFriction
        | CauseKind::GainDrift
        | CauseKind::TorqueRipple
        | CauseKind::ZeroShift
        | CauseKind::LatePosition
        | CauseKind::TorqueFilter
        | CauseKind::TimeScale => Verdict::Care,
    };
    let size = found.size_in_words().map(|size| format!(", {size}")).unwrap_or_default();
    let rivals = match found.rivals.as_slice() {
        [] => String::new(),
        rivals => format!("; the recordings do not separate it from {}", rivals.join(", ")),
    };
    let moved: Vec<&str> = found.moved.iter().take(4).map(|m| m.parameter.as_str()).collect();
    let moved = if moved.is_empty() { String::new() } else { format!("; it moved {}", moved.join(", ")) };
    let in_model = if found.in_model { "; the model has a torque term for it, the description has none" } else { "" };
    let seen = format!(
        "The residual shows {}{size} (chance: 1e{:.0}){rivals}{moved}{in_model}",
        found.kind.with_subject(&found.subject),
        found.log10_probability
    );
    let numbers = [
        ("log10_probability", Some(found.log10_probability)),
        ("size", found.size),
        ("error_percent", Some(found.error_percent)),
    ];
    let parameter = found.moved.first().map(|m| m.parameter.clone());
    let late = (found.kind == CauseKind::LateTorque).then(|| found.subject.clone());
    let joint = late.filter(|joint| !joint.is_empty());
    let subject = ReasonSubject { joint, parameter, cause: Some(found.kind), ..ReasonSubject::default() };
    let or = if found.rivals.is_empty() { "" } else { ", and what the recordings do not separate from it" };
    let said = ReasonText::new(seen, format!("{}{or}", remedy(results, found)));
    Some(reason(ReasonCode::Cause, verdict, &numbers, subject, said))
}

fn remedy(results: &Results, found: &ModelCause) -> String {
    let terms = results.model.iter().flat_map(|model| model.kinds_of_terms()).collect::<Vec<_>>();
    match found.kind {
        CauseKind::LoadFriction | CauseKind::SpeedFriction if found.in_model => {
            format!("add the model's [[term]] to the experiment, kind {}", terms.join(" and "))
        }
        CauseKind::LateTorque if found.subject.is_empty() => {
            "set delay_s of the torque as the finding lag says".to_owned()
        }
        CauseKind::LateTorque => format!("set delay_s of the torque to a list with the delay of {}", found.subject),
        CauseKind::EncoderZero => format!("check the zero of {} against the description", found.subject),
        CauseKind::GearRatio => format!("check the gear ratio of {}", found.subject),
        CauseKind::DriveGain => format!("check the torque constant and the gear ratio of {}", found.subject),
        CauseKind::OffsetDrift => {
            "start the window after the change, or set the torque sensors to zero again".to_owned()
        }
        CauseKind::Elasticity => "stay below its resonance, or record at the link".to_owned(),
        CauseKind::Length => "check the lengths of the description".to_owned(),
        CauseKind::Coupling => "state the coupling in [transmission] of the robot".to_owned(),
        CauseKind::LoadFriction => "add a [[term]] of kind load-friction".to_owned(),
        CauseKind::SpeedFriction => {
            "compare_terms = true in [estimation], and add the [[term]] that it recommends".to_owned()
        }
        CauseKind::FrictionDrift => "warm the robot up before recording".to_owned(),
        CauseKind::Payload => "cut the recording where the load changes, or state [[payload]]".to_owned(),
        CauseKind::GravityDirection => "check how the base is mounted, and state gravity in the experiment".to_owned(),
        CauseKind::Crosstalk => "calibrate the torque sensors".to_owned(),
        CauseKind::FallingConstant => {
            "take the drive's torque instead of its current, or record with smaller torques".to_owned()
        }
        CauseKind::GainDrift => "record with warm motors and a steady supply, or in shorter parts".to_owned(),
        CauseKind::TorqueRipple => {
            "add a [[term]] of kind motor-harmonics; its harmonics are multiples of the motor's angle".to_owned()
        }
        CauseKind::LatePosition => "record the positions of all joints at the same instants".to_owned(),
        CauseKind::TimeScale => "check sample_rate_hz, or the unit and the clock of the times".to_owned(),
        CauseKind::TorqueFilter => {
            "record the torques without the filter, or with a cut-off far above the motion".to_owned()
        }
        CauseKind::ZeroShift => "cut the recording there, and check the encoder and what turns it".to_owned(),
        CauseKind::AsymmetricFriction => "add a [[term]] of kind asymmetric-viscous".to_owned(),
        CauseKind::JointSpring => "add a [[term]] of kind joint-spring, if a spring or a cable acts there".to_owned(),
    }
}

/// What neighbouring rows predict of the residual, or what of it lasts, percent of all torques, where no cause that was tested explains it.
fn structure(results: &Results, model: &ModelResult) -> Option<VerdictReason> {
    let run = nominal_runs(results).find(|r| r.residual.is_some() && !r.is_of_positions())?;
    let of_rows = (structure_percent(results, run, model), STRUCTURE_PERCENT);
    let of_samples = (model.lasting_percent.unwrap_or_default(), LASTING_PERCENT);
    let (percent, limit) = [of_rows, of_samples].into_iter().find(|(percent, limit)| percent > limit)?;
    let seen = format!(
        "{} % of the torques are left in errors that last, and no cause that was tested explains them: the model predicts as \
         its error says, but true values may lie outside the intervals of single parameters",
        significant(percent, 2)
    );
    let said = ReasonText::new(seen, "look at the residual over velocity, position and load in the report");
    let numbers = [("structure_percent", Some(percent)), ("limit", Some(limit))];
    Some(reason(ReasonCode::CorrelatedResidual, Verdict::Care, &numbers, ReasonSubject::default(), said))
}

/// Torques at reversals that look early, which the check of lags does not find: friction near rest that the model does not have, as of
/// Stribeck.
fn early_at_reversals(results: &Results, model: &ModelResult) -> Option<VerdictReason> {
    let counts = |c: &&ModelCause| c.looks_early() && c.size < Some(-least_delay_s(results));
    let found = model.causes.iter().find(counts)?;
    let seen = format!(
        "{} % of the torques are left at reversals, as of torques that are early by {} ms, which no lag confirms: friction near rest \
         has another law than the model's",
        significant(found.error_percent, 2),
        significant(-1e3 * found.size?, 2)
    );
    let said = ReasonText::new(seen, "record each joint at several constant speeds, which show the law");
    let numbers = [("structure_percent", Some(found.error_percent))];
    Some(reason(ReasonCode::CorrelatedResidual, Verdict::Care, &numbers, ReasonSubject::default(), said))
}

/// The least delay of torques that is worth a correction.
fn least_delay_s(results: &Results) -> f64 {
    let period = results.recordings.first().map_or(0.0, |r| 1.0 / r.sample_rate_hz);
    let is_filtered = results.model.iter().flat_map(|model| &model.estimated_sizes).any(|size| size == "torque-filter");
    if is_filtered { LATE_FILTER_SAMPLES * period } else { (LATE_SAMPLES * period).max(LATE_S) }
}

/// `100 sqrt(sum_j r_j e_j^2 / sum_j tau_j^2)` of the joints' residuals e, with the correlation r of neighbouring rows above that of
/// white noise after the filters.
fn structure_percent(results: &Results, run: &RunResult, model: &ModelResult) -> f64 {
    let correlated = |j: usize| {
        let residual = run.residual.iter().flat_map(|r| &r.joints).find(|r| r.joint == j + 1);
        residual.map_or(0.0, |r| (r.autocorrelation - correlated_from(results, run)).max(0.0))
    };
    let joints = &model.fit.joints;
    let lasting: f64 = joints.iter().enumerate().map(|(j, e)| correlated(j) * e.rms.powi(2)).sum();
    let all: f64 = joints.iter().map(|e| e.rms.powi(2)).sum();
    if all > 0.0 { model.fit.percent * (lasting / all).sqrt() } else { 0.0 }
}

/// What the model may be used for, from the reasons of the verdict.
pub(super) fn uses(results: &Results, model: &ModelResult) -> Vec<ModelUse> {
    let reasons = &results.verdict_reasons;
    let gravest = reasons.iter().map(|r| r.verdict).max().unwrap_or(Verdict::Good);
    let error = model.judged_error();
    let forbidden = gravest == Verdict::DoNotUse;
    let of = |for_what: UseGrade, care: Option<String>, condition: &str| {
        let (verdict, why) = match care {
            _ if forbidden => (Verdict::DoNotUse, "the data forbid it".to_owned()),
            Some(why) => (Verdict::Care, why),
            None => (Verdict::Good, condition.to_owned()),
        };
        ModelUse { for_what, verdict, why }
    };
    let open = open_inertias(results, model);
    let far = reasons.iter().any(|r| r.code == ReasonCode::CrossValidation);
    let predict = match (error.percent > PREDICTS_PERCENT, far) {
        (true, _) => Some(format!("its error on unseen motion is {} %", significant(error.percent, 3))),
        (false, true) => Some("the recordings are little for it: it is good on motion like theirs".to_owned()),
        (false, false) => None,
    };
    let decided = model.parameters.iter().filter(|p| p.is_decided()).count();
    let share = 100.0 * decided as f64 / model.parameters.len().max(1) as f64;
    let simulate = predict.clone().or_else(|| open.clone()).or_else(|| {
        (share < MOSTLY_DECIDED).then(|| {
            let of = model.parameters.len();
            format!("the recordings decided {decided} of {of} parameters: the others are of the a-priori robot")
        })
    });
    let moves_values = |r: &&VerdictReason| {
        matches!(
            r.code,
            ReasonCode::Cause
                | ReasonCode::Undecided
                | ReasonCode::CorrelatedResidual
                | ReasonCode::Lag
                | ReasonCode::CheckWarning
        )
    };
    let quote = match reasons.iter().find(moves_values) {
        Some(reason) => Some(reason.seen().to_owned()),
        None if decided == 0 => Some("the recordings decided no single parameter".to_owned()),
        None => None,
    };
    vec![
        of(UseGrade::PredictTorques, predict, if open.is_some() { "on motion like its own" } else { "" }),
        of(UseGrade::Simulate, simulate, ""),
        of(UseGrade::QuoteSingleValues, quote, ""),
    ]
}

/// The joints whose inertia the recordings leave open: simulated, they would accelerate wrongly.
fn open_inertias(results: &Results, model: &ModelResult) -> Option<String> {
    let of_joint = |(j, joint): (usize, &ModelJoint)| {
        let percent = joint.inertia_deviation_percent;
        (percent > OPEN_INERTIA_PERCENT)
            .then(|| format!("{} (deviation {} %)", results.joint_label(j), significant(percent, 2)))
    };
    let open: Vec<String> = model.joints.iter().enumerate().filter_map(of_joint).collect();
    let why = || {
        format!(
            "the recordings did not determine the inertia, with that of the motor, of {}: record faster motion of these joints",
            open.join(", ")
        )
    };
    (!open.is_empty()).then(why)
}
