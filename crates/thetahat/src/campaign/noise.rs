//! The measurements of one run: the true motion with noise.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::{NoiseLevel, row::Key};
use crate::experiment::{Experiment, TwinMotion};
use thetahat_estimation::simulation::Sensors;
use thetahat_ground::series::Series;

/// Bits of a stream's number that hold the seed, and those that hold the start.
const SEED_BITS: u32 = 20;
const START_BITS: u32 = 20;

/// The stream of the noise of one record: levels, starts and seeds all have their place in its number.
pub(super) fn record_stream(key: Key) -> u64 {
    let place = |number: u32, shift: u32| u64::from(number) << shift;
    place(key.level + 1, SEED_BITS + START_BITS) | place(key.start, SEED_BITS) | u64::from(key.seed)
}

/// Random numbers of a stream; equal seed and stream give equal numbers whatever was drawn before.
pub(super) fn random(seed: u64, stream: u64) -> ChaCha8Rng {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(stream);
    rng
}

/// Positions and torques as one record holds them.
pub(super) fn measure(
    experiment: &Experiment,
    twin: &TwinMotion,
    level: &NoiseLevel,
    rng: &mut ChaCha8Rng,
) -> (Series, Series) {
    let joints = experiment.robot.coordinate_count();
    let (mut position, mut torque) = match sensors(experiment).filter(|_| level.sensors) {
        Some(sensors) => {
            let transmission = &experiment.robot.transmission;
            let (motors, drives) = sensors.record(&twin.motion, &experiment.robot);
            (transmission.joint_positions(&motors), transmission.joint_torques(&drives))
        }
        None => (twin.motion.q.clone(), twin.motion.tau.clone()),
    };
    position.add_white_noise(&position_deviations(experiment, level), rng);
    torque.add_white_noise(&level.torque_noise.to_list(joints), rng);
    (position, torque)
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
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    #[test]
    fn streams_of_different_places_differ() {
        let places = [(0, 0, 0), (0, 0, 1), (0, 1, 0), (1, 0, 0), (0, 1, 1)];
        let streams: std::collections::BTreeSet<u64> =
            places.into_iter().map(|(level, start, seed)| record_stream(Key { level, start, seed })).collect();
        assert_eq!(streams.len(), places.len());
        let draw = |stream| -> f64 { StandardNormal.sample(&mut random(7, stream)) };
        assert_eq!(draw(3), draw(3));
        assert_ne!(draw(3), draw(4));
    }
}
