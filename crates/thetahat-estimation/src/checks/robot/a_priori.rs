//! Compares torques with those of the a-priori masses: the one scale that a fit of all parameters cannot see.
//!
//! If all torques are on the other side of the gears, or in another unit, the parameters absorb the factor. The masses of a
//! description contradict it. Masses may be placeholders, so the factor must be large, and the a-priori model must explain
//! the shape of the torque.

use crate::{
    checks::{
        examination::{Evidence, Examination, FindingText},
        finding::{Code, Severity},
        fit::thinned_recording::ThinnedRecording,
        remedy_step::{RemedySignal, RemedyStep},
    },
    signal::Motion,
    statistics::median,
};
use thetahat_ground::{
    linear_algebra::{Matrix, PivotedQr, dot},
    real::sign_or,
    series::Series,
};
use thetahat_model::{
    dynamics::{Model, Sign},
    regressor::Regressor,
    robot::{Quantity, Robot},
};

/// Largest factor between a torque and that of the a-priori masses, either way. Clean recordings: TX40 at most 1.1, KUKA 1.4,
/// twins with the right masses 1.1.
const LIMIT: f64 = 5.0;
/// The same from which no masses of a robot are so wrong, be it at one joint.
const ABSURD: f64 = 1000.0;
/// Smallest part of a torque's squares, without friction, offset and motor inertia, that the a-priori model must explain.
const EXPLAINED: f64 = 0.5;
/// Largest factor between two scales that count as equal.
const ALIKE: f64 = 1.5;
/// Factor between a torque in mN m and one in N m, and between masses in g and in kg.
const THOUSAND: f64 = 1e3;
/// Largest factor between the middle scale and a thousand that offers mN m as a setting. A current in mA has some hundred to a few
/// thousand times the torque, and masses of descriptions that are right are right to some percent.
const AS_A_UNIT: f64 = 1.05;
/// Largest factor of torques that a description in g explains: 1/1000, and a description that is wrong by half.
const OF_GRAMS: f64 = ALIKE / THOUSAND;
/// Units of time that are taken for seconds, with their number in a second: accelerations are wrong by its square.
const TIMES: [(&str, f64); 3] = [("ms", 1e3), ("us", 1e6), ("ns", 1e9)];
/// Number of joints with the same factor from which wrong masses are no explanation.
const SEVERAL: usize = 3;
/// Part of a joint's torque that its links take, below which wrong masses of them are likelier than a wrong torque, and the factor from
/// which they are not.
const OF_LINKS: f64 = 0.2;
const SURE: f64 = 30.0;
/// Number of other joints that agree with the masses from which the torque of one joint is wrong, not its masses.
const WITNESSES: usize = 2;

/// How many times larger a joint's torque is than the torque of its a-priori masses.
struct Scale {
    coordinate: usize,
    factor: f64,
    /// Part of the joint's torque, root mean square, without friction, offset and motor inertia.
    part: f64,
}

impl Scale {
    /// How far the factor is from one, either way.
    fn off(&self) -> f64 {
        self.factor.max(1.0 / self.factor)
    }

    /// Whether the torque is wrong, not a small body's masses.
    fn is_wrong(&self) -> bool {
        self.off() > LIMIT && (self.part > OF_LINKS || self.off() > SURE)
    }
}

pub(in crate::checks) fn check(exam: &mut Examination<'_>, recording: &ThinnedRecording<'_>) {
    let scales = scales(recording);
    let off = |factor: f64| factor.max(1.0 / factor);
    for scale in &scales {
        exam.note_measure(evidence(Some(scale.coordinate), scale.off()));
    }
    let wrong = wrong_of(&scales);
    if wrong.is_empty() {
        return;
    }
    let factors: Vec<f64> = wrong.iter().map(|s| s.factor).collect();
    let middle = median(&factors);
    let common = wrong.len() > 1 && wrong.len() >= SEVERAL.min(scales.len());
    let agreeing = scales.iter().filter(|s| s.off() < ALIKE).count();
    let is_single = wrong.len() == 1 && agreeing >= WITNESSES;
    let is_absurd = off(middle) > ABSURD;
    let severity = if common || is_single || is_absurd { Severity::Problem } else { Severity::Warning };
    let only = if wrong.len() == 1 { Some(wrong[0].coordinate) } else { None };
    exam.raise(evidence(only, off(middle)), severity, finding_text(exam.subject.robot, &wrong, middle, common));
}

/// The joints whose torque is wrong: all of several where one is for sure and none agrees with the masses.
fn wrong_of(scales: &[Scale]) -> Vec<&Scale> {
    let is_sure = scales.iter().any(Scale::is_wrong);
    scales.iter().filter(|s| s.is_wrong() || (is_sure && none_agrees(scales))).collect()
}

/// Whether all of several torques are far from those of the masses, be the part of the links small.
fn none_agrees(scales: &[Scale]) -> bool {
    scales.len() >= SEVERAL && scales.iter().all(|s| s.off() > LIMIT)
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

/// The text names the gear ratios only if several joints have theirs as the factor: one joint alone may have it by chance.
fn finding_text(robot: &Robot, wrong: &[&Scale], middle: f64, several: bool) -> FindingText {
    let joints: Vec<String> = wrong.iter().map(|s| (robot.joint_of(s.coordinate) + 1).to_string()).collect();
    let joints =
        if joints.len() == 1 { format!("joint {}", joints[0]) } else { format!("joints {}", joints.join(" ")) };
    let how = if middle < 1.0 { format!("{:.3e} of", middle) } else { format!("{middle:.1} times") };
    let message = format!(
        "{joints}: the torque is {how} the torque that the masses of the robot description give, with the same shape"
    );
    let is_ratio = |s: &&Scale, power: i32| {
        let ratio = robot.transmission.matrix().at(s.coordinate, s.coordinate).abs();
        let expected = ratio.powi(power);
        ratio > 1.0 && (s.factor / expected).max(expected / s.factor) < ALIKE
    };
    let all_have_ratio = |power: i32| several && wrong.iter().all(|s| is_ratio(s, power));
    let side = |at_motor: bool| Some(RemedyStep::Side { signal: RemedySignal::Torque, at_motor });
    let (at_motor, at_joint) = (all_have_ratio(-1), all_have_ratio(1));
    let step = match (at_motor, at_joint) {
        (true, _) => side(true),
        (false, true) => side(false),
        (false, false) => has_unit_of_thousands(wrong, middle, several).then(|| RemedyStep::Scale {
            position: Vec::new(),
            torque: vec![1.0 / THOUSAND; robot.coordinate_count()],
        }),
    };
    let remedy = if at_motor {
        "these are the gear ratios: set side = \"motor\" of torque in [recording]"
    } else if at_joint {
        "these are the gear ratios: set side = \"joint\" of torque in [recording]"
    } else if let Some(times) = of_times(wrong) {
        return FindingText::new(message, times);
    } else if step.is_some() {
        "that is near 1000, so a guess: the torque is in mN m. Of a current in mA the factor may be near 1000 by chance: then state \
         unit = \"mA\" with gain = [...] in N m/A, or run init with --from DRIVER"
    } else if wrong.iter().all(|s| s.factor < OF_GRAMS) {
        "masses of the description in g, which are 1000 times too large, or inertias in g mm^2, 1e9 times, are likely: a URDF has kg and \
         kg m^2. Correct them, or remove the <inertial> elements, without which everything is estimated from the recording. If the \
         description is right, check the unit of torque"
    } else {
        "check the unit of torque, and the side of the gears of torque and position (side = \"motor\" in [recording] with the \
         ratios in [transmission] matrix). A current in A or mA, or a raw value, needs its unit and gain = [...], or init --from DRIVER. \
         If these are right, the masses of the description are placeholders: remove its <inertial> elements, without which everything \
         is estimated from the recording"
    };
    FindingText::new(message, remedy).with_step(step)
}

/// The remedy where all factors are the square of a unit of time in seconds: joints without gravity whose times have another unit.
fn of_times(wrong: &[&Scale]) -> Option<String> {
    let all_are = |expected: f64| are_near(wrong, expected);
    TIMES.into_iter().find_map(|(unit, parts)| {
        let (found, taken) = match (all_are(parts * parts), all_are(1.0 / (parts * parts))) {
            (true, _) => (unit, "s"),
            (_, true) => ("s", unit),
            (false, false) => return None,
        };
        Some(format!(
            "that is {parts:e} squared, as of accelerations whose times are in {found} and are read as {taken}: correct the unit of time \
             in [recording], or sample_rate_hz there; if the times are right, check the unit of torque"
        ))
    })
}

/// Whether the torques of several joints are so near a thousand times too large that they are in mN m.
fn has_unit_of_thousands(wrong: &[&Scale], middle: f64, several: bool) -> bool {
    let off = (middle / THOUSAND).max(THOUSAND / middle);
    several && off < AS_A_UNIT && are_near(wrong, THOUSAND)
}

/// Whether all scales are near a size.
fn are_near(wrong: &[&Scale], size: f64) -> bool {
    wrong.iter().all(|s| (s.factor / size).max(size / s.factor) < ALIKE)
}

/// The joints whose torque has the shape that the a-priori masses give, with its factor.
fn scales(recording: &ThinnedRecording<'_>) -> Vec<Scale> {
    let Some(a_priori) = a_priori_torque(recording) else { return Vec::new() };
    let scale = |coordinate: usize| {
        let own = own_columns(recording, coordinate)?;
        let qr = PivotedQr::new(&own);
        let without_own = |y: Vec<f64>| -> Vec<f64> {
            let by_own = own.times(&qr.solve(&y));
            y.iter().zip(by_own).map(|(y, own)| y - own).collect()
        };
        let expected = without_own(recording.stack_channel(&a_priori, coordinate));
        let recorded = recording.stack_channel(&recording.torque, coordinate);
        let all = dot(&recorded, &recorded);
        let torque = without_own(recorded);
        let (size, common, squares) = (dot(&expected, &expected), dot(&expected, &torque), dot(&torque, &torque));
        let explained = common * common / (size * squares);
        let part = (squares / all).sqrt();
        (common > 0.0 && explained > EXPLAINED).then_some(Scale { coordinate, factor: common / size, part })
    };
    (0..recording.coordinates()).filter_map(scale).collect()
}

/// Velocity, its sign, acceleration and a constant one of a coordinate, low-passed like the rows; `None` if they are linearly
/// dependent.
fn own_columns(recording: &ThinnedRecording<'_>, j: usize) -> Option<Matrix> {
    let motion = &recording.motion;
    let values = (0..motion.q.len()).flat_map(|k| {
        let v = motion.dq.sample(k)[j];
        [v, sign_or(v, v), motion.ddq.sample(k)[j], 1.0]
    });
    recording.columns_of(&Series::shaped(4, values.collect()))
}

/// The torques of the links' a-priori parameters, low-passed like the rows; `None` without masses.
fn a_priori_torque(recording: &ThinnedRecording<'_>) -> Option<Series> {
    let (robot, model): (&Robot, &Model) = (recording.subject.robot, recording.subject.model);
    let table = model.parameter_table();
    let theta = robot.a_priori_parameters_for(table);
    let is_given = |i: &usize| matches!(table.get(*i).quantity, Quantity::Link(_)) && theta[*i] != 0.0;
    let given: Vec<usize> = (0..theta.len()).filter(is_given).collect();
    if given.is_empty() {
        return None;
    }
    let Motion { q, dq, ddq } = &recording.motion;
    let values: Vec<f64> = given.iter().map(|&i| theta[i]).collect();
    let torque = Regressor::new(model, &given).torques(model, [q, dq, ddq], Sign::Exact, &values);
    recording.decimator.filter(&torque).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether mN m is offered for joints with these factors.
    fn is_offered(factors: &[f64]) -> bool {
        let scales: Vec<Scale> =
            factors.iter().enumerate().map(|(coordinate, &factor)| Scale { coordinate, factor, part: 1.0 }).collect();
        has_unit_of_thousands(&scales.iter().collect::<Vec<_>>(), median(factors), true)
    }

    #[test]
    fn a_unit_is_offered_only_where_the_factor_is_its_own() {
        assert!(is_offered(&[980.0, 1010.0, 1040.0]));
        assert!(is_offered(&[700.0, 1010.0, 1040.0]));
        // Currents in mA of 1.8 N m/A, on descriptions that are wrong by some percent and by half.
        assert!(!is_offered(&[532.0, 530.0, 535.0]));
        assert!(!is_offered(&[757.0, 760.0, 750.0]));
        assert!(!is_offered(&[980.0, 1010.0, 100.0]));
        assert!(!is_offered(&[0.001, 0.001, 0.001]));
    }

    /// An arm whose torques are currents, of which the links take a fifth at most joints.
    #[test]
    fn torques_of_which_none_agrees_with_the_masses_are_wrong_at_all_joints() {
        let scale = |(coordinate, (factor, part)): (usize, (f64, f64))| Scale { coordinate, factor, part };
        let scales = |of: [(f64, f64); 4]| of.into_iter().enumerate().map(scale).collect::<Vec<_>>();
        let currents = scales([(0.035, 0.17), (0.036, 0.24), (0.042, 0.21), (0.075, 0.08)]);
        let wrong = |scales: &[Scale]| wrong_of(scales).iter().map(|s| s.coordinate).collect::<Vec<_>>();
        assert_eq!(wrong(&currents), [0, 1, 2, 3]);
        assert_eq!(wrong(&currents[..2]), [1]);
        assert_eq!(wrong(&scales([(0.035, 0.17), (0.036, 0.24), (0.042, 0.21), (1.1, 0.08)])), [1, 2]);
        // Of one joint alone the links take a fifth.
        assert_eq!(wrong(&scales([(0.035, 0.17), (0.036, 0.24), (0.042, 0.11), (0.075, 0.08)])), [0, 1, 2, 3]);
        assert!(wrong(&scales([(0.035, 0.17), (0.036, 0.14), (0.042, 0.11), (0.075, 0.08)])).is_empty());
    }
}
