//! The measurements of one recording: the true motion with noise.

use rand_chacha::ChaCha8Rng;

use super::{NoiseLevel, row::Key};
use crate::experiment::{Experiment, TwinMotion};
use thetahat_estimation::simulation::{NoisySignals, RecordingNoise, Sensors, SignalNoise};

/// Bits of a stream's number that hold the seed, and those that hold the start.
const SEED_BITS: u32 = 20;
const START_BITS: u32 = 20;

/// The stream of the noise of one recording: its number encodes level, start and seed.
pub(super) fn recording_stream(key: Key) -> u64 {
    let place = |number: u32, shift: u32| u64::from(number) << shift;
    place(key.level + 1, SEED_BITS + START_BITS) | place(key.start, SEED_BITS) | u64::from(key.seed)
}

/// Positions and torques of the joints, as one recording has them.
pub(super) fn measure(
    experiment: &Experiment,
    twin: &TwinMotion,
    level: &NoiseLevel,
    rng: &mut ChaCha8Rng,
) -> NoisySignals {
    let joints = experiment.robot.coordinate_count();
    let (position, torque) = match sensors(experiment).filter(|_| level.sensors) {
        Some(sensors) => {
            let transmission = &experiment.robot.transmission;
            let (motors, drives) = sensors.record(&twin.motion, &experiment.robot);
            (transmission.joint_positions(&motors), transmission.joint_torques(&drives))
        }
        None => (twin.motion.q.clone(), twin.motion.tau.clone()),
    };
    let [of_positions, of_torques] = [position_deviations(experiment, level), level.torque_noise.to_list(joints)];
    RecordingNoise { position: SignalNoise::White(&of_positions), torque: SignalNoise::White(&of_torques) }
        .record(position, torque, rng)
}

/// The twin's sensors without their own noise.
fn sensors(experiment: &Experiment) -> Option<Sensors> {
    let sensors = &experiment.file.twin.as_ref()?.sensors;
    let none = vec![0.0; sensors.torque_noise.len()];
    Some(Sensors { torque_noise: none.clone(), position_noise: none, ..sensors.clone() })
}

/// Standard deviations of the positions, rad or m.
fn position_deviations(experiment: &Experiment, level: &NoiseLevel) -> Vec<f64> {
    let given = level.position_noise.to_list(experiment.robot.coordinate_count());
    given.into_iter().zip(experiment.robot.coordinates()).map(|(value, joint)| joint.kind.to_si(value)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn streams_of_different_places_differ() {
        let places = [(0, 0, 0), (0, 0, 1), (0, 1, 0), (1, 0, 0), (0, 1, 1)];
        let streams: std::collections::BTreeSet<u64> =
            places.into_iter().map(|(level, start, seed)| recording_stream(Key { level, start, seed })).collect();
        assert_eq!(streams.len(), places.len());
    }
}
