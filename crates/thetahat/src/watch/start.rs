//! Friction that is another at the start than the identified one.

use super::{
    drift::{Cause, Drift},
    step::Step,
    subject::Friction,
    words::Words,
};
use thetahat_report::results::WatchDrift;

/// Deviations by which a joint's friction at its rms speed is another at the start.
const START_DEVIATIONS: f64 = 4.5;
/// Part of the friction by which it is another: less is the model's error.
const START_PART: f64 = 0.1;

/// The joints whose friction is another, at the rms of their speed in some blocks.
pub(super) fn starts(words: &Words<'_>, drift: &Drift, blocks: &[Step]) -> Vec<WatchDrift> {
    (0..words.joints.len())
        .filter(|&j| drift.noise()[j].is_some())
        .filter_map(|j| start(words, drift, blocks, j))
        .collect()
}

fn start(words: &Words<'_>, drift: &Drift, blocks: &[Step], joint: usize) -> Option<WatchDrift> {
    let (baseline, covariance) = drift.first();
    let Friction { viscous: Some([fv, of_fv]), coulomb: Some([fc, of_fc]) } = words.robot.friction(joint) else {
        return None;
    };
    let moving = blocks.iter().filter(|block| !block.rest[joint]).map(|block| block.rows[joint].x[0].powi(2));
    let [squares, count] = moving.fold([0.0, 1e-9], |[sum, n], square| [sum + square, n + 1.0]);
    let speed = (squares / count).sqrt();
    let places = Cause::Friction(joint).parameters(words.joints.len());
    let [v, c] = [places[0], places[1]];
    let variance = speed * speed * (covariance.at(v, v) + of_fv * of_fv) + covariance.at(c, c) + of_fc * of_fc;
    let deviation = (variance + 2.0 * speed * covariance.at(v, c)).max(0.0).sqrt();
    let torque = (speed * baseline[v] + baseline[c]).abs();
    if !(torque > START_DEVIATIONS * deviation && torque > START_PART * (speed * fv + fc).abs()) {
        return None;
    }
    let deviations = [(v, of_fv), (c, of_fc)].map(|(place, of)| covariance.at(place, place).sqrt().hypot(of));
    Some(WatchDrift {
        time_s: words.time_s,
        began_s: 0.0,
        cause: words.cause(Cause::Friction(joint)),
        rivals: Vec::new(),
        changes: words.changes(&places, &[baseline[v], baseline[c]], &deviations, places.len()),
        evidence: 0.5 * (torque / deviation).powi(2),
    })
}
