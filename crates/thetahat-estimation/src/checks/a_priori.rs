//! Torques beside those of the a-priori masses: the one scale that a fit of all parameters cannot see.
//!
//! Where every torque is on the other side of the gears, or in another unit, the parameters take the factor up. A
//! description with masses contradicts it. Masses may be placeholders, so the factor must be large, and the a-priori model
//! must explain the form of the torque.

use super::{
    examination::{Evidence, Examination, Words},
    finding::{Code, Severity},
    thinned_record::ThinnedRecord,
};
use crate::{signal::Motion, statistics::median};
use thetahat_ground::{
    linear_algebra::{Matrix, PivotedQr, dot},
    series::Series,
};
use thetahat_model::{
    dynamics::{Model, Sign},
    regressor::Regressor,
    robot::{Quantity, Robot},
};

/// Factor between a torque and that of the a-priori masses, either way. Clean: recorded TX40 at most 1.1, KUKA 1.4, twins
/// whose masses are right 1.1.
const LIMIT: f64 = 5.0;
/// Part of a torque's squares, beside friction, offset and motor inertia, whose form the a-priori model must explain.
const EXPLAINED: f64 = 0.5;
/// Factor by which two scales may differ and be one.
const ALIKE: f64 = 1.5;
/// Joints with the same factor from which the masses are not the cause.
const SEVERAL: usize = 3;

/// How many times larger a joint's torque is than its a-priori masses make it.
struct Scale {
    coordinate: usize,
    factor: f64,
}

pub(super) fn check(exam: &mut Examination<'_>, record: &ThinnedRecord<'_>) {
    let scales = scales(record);
    let off = |factor: f64| factor.max(1.0 / factor);
    for scale in &scales {
        exam.note_measure(evidence(Some(scale.coordinate), off(scale.factor)));
    }
    let wrong: Vec<&Scale> = scales.iter().filter(|s| off(s.factor) > LIMIT).collect();
    if wrong.is_empty() {
        return;
    }
    let factors: Vec<f64> = wrong.iter().map(|s| s.factor).collect();
    let middle = median(&factors);
    let common = wrong.len() >= SEVERAL.min(scales.len()) && wrong.len() > 1;
    let severity = if common { Severity::Problem } else { Severity::Warning };
    let only = if wrong.len() == 1 { Some(wrong[0].coordinate) } else { None };
    exam.raise(evidence(only, off(middle)), severity, words(exam.subject.robot, &wrong, middle, common));
}

fn evidence(coordinate: Option<usize>, value: f64) -> Evidence {
    Evidence {
        code: Code::APrioriScale,
        coordinate,
        value,
        unit: "times the a-priori torque, or the reverse",
        limit: LIMIT,
    }
}

/// Gear ratios are named where several joints have theirs as a factor: one alone may have it by chance.
fn words(robot: &Robot, wrong: &[&Scale], middle: f64, several: bool) -> Words {
    let joints: Vec<String> = wrong.iter().map(|s| (robot.joint_of(s.coordinate) + 1).to_string()).collect();
    let joints =
        if joints.len() == 1 { format!("joint {}", joints[0]) } else { format!("joints {}", joints.join(" ")) };
    let how = if middle < 1.0 { format!("{:.3e} of", middle) } else { format!("{middle:.1} times") };
    let message =
        format!("{joints}: the torque is {how} what the masses of the robot description make it, with the same form");
    let is_ratio = |s: &&Scale, power: i32| {
        let ratio = robot.transmission.matrix().at(s.coordinate, s.coordinate).abs();
        let expected = ratio.powi(power);
        ratio > 1.0 && (s.factor / expected).max(expected / s.factor) < ALIKE
    };
    let remedy = if several && wrong.iter().all(|s| is_ratio(s, -1)) {
        "these are the gear ratios: set side = \"motor\" of torque in [recording]"
    } else if several && wrong.iter().all(|s| is_ratio(s, 1)) {
        "these are the gear ratios: set side = \"joint\" of torque in [recording]"
    } else {
        "check the unit of torque, and the side of the gears of torque and position (side = \"motor\" in [recording] with the \
         ratios in [transmission] matrix, or gain = ... of the channel); else the masses of the description are placeholders"
    };
    Words::new(message, remedy)
}

/// The joints whose torque has the form that the a-priori masses give it, with its factor.
fn scales(record: &ThinnedRecord<'_>) -> Vec<Scale> {
    let Some(a_priori) = a_priori_torque(record) else { return Vec::new() };
    let of_coordinate = |coordinate: usize| {
        let own = own_columns(record, coordinate)?;
        let qr = PivotedQr::new(&own);
        let less_own = |y: Vec<f64>| -> Vec<f64> {
            let by_own = own.times(&qr.solve(&y));
            y.iter().zip(by_own).map(|(y, own)| y - own).collect()
        };
        let expected = less_own(record.stack_channel(&a_priori, coordinate));
        let torque = less_own(record.stack_channel(&record.torque, coordinate));
        let (size, common, squares) = (dot(&expected, &expected), dot(&expected, &torque), dot(&torque, &torque));
        let explained = common * common / (size * squares);
        (common > 0.0 && explained > EXPLAINED).then_some(Scale { coordinate, factor: common / size })
    };
    (0..record.coordinates()).filter_map(of_coordinate).collect()
}

/// Velocity, its sign, acceleration and one of a coordinate, low-passed as the rows are; none where two of them are one.
fn own_columns(record: &ThinnedRecord<'_>, j: usize) -> Option<Matrix> {
    let motion = &record.motion;
    let values = (0..motion.q.len()).flat_map(|k| {
        let v = motion.dq.sample(k)[j];
        [v, Sign::Exact.of(v), motion.ddq.sample(k)[j], 1.0]
    });
    record.columns_of(&Series::shaped(4, values.collect()))
}

/// The torques of the links' a-priori parameters, low-passed as the rows are; none where there are no masses.
fn a_priori_torque(record: &ThinnedRecord<'_>) -> Option<Series> {
    let (robot, model): (&Robot, &Model) = (record.subject.robot, record.subject.model);
    let table = model.parameter_table();
    let theta = robot.a_priori_parameters_for(table);
    let is_given = |i: &usize| matches!(table.get(*i).quantity, Quantity::Link(_)) && theta[*i] != 0.0;
    let given: Vec<usize> = (0..theta.len()).filter(is_given).collect();
    if given.is_empty() {
        return None;
    }
    let Motion { q, dq, ddq } = &record.motion;
    let values: Vec<f64> = given.iter().map(|&i| theta[i]).collect();
    let torque = Regressor::new(model, &given).torques(model, [q, dq, ddq], Sign::Exact, &values);
    record.decimator.filter(&torque).ok()
}
