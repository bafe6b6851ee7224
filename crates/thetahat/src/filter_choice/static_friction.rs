//! The static friction of a twin, whose simulated friction is smooth.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use thetahat_ground::series::Series;

/// Static friction: at each rest it is somewhere between the Coulomb friction of either direction.
pub(super) struct StaticFriction {
    /// What the smooth friction of the simulation leaves of the Coulomb friction.
    missing: Series,
    /// Whether a joint rests at a sample, sample by sample.
    rests: Vec<bool>,
}

impl StaticFriction {
    /// The static friction of joints with this Coulomb friction along velocities, for a simulated sign that is smooth over a velocity scale.
    pub(super) fn new(coulomb: &[f64], dq: &Series, sign_velocity_scale: f64) -> Self {
        let joints = coulomb.len();
        let missing = |(i, dq): (usize, &f64)| coulomb[i % joints] * (1.0 - (dq / sign_velocity_scale).tanh().abs());
        let missing = dq.values().iter().enumerate().map(missing).collect();
        let rests = dq.values().iter().map(|dq| dq.abs() < sign_velocity_scale).collect();
        Self { missing: Series::shaped(joints, missing), rests }
    }

    /// Some part of what is missing, another one at each rest.
    pub(super) fn draw(&self, rng: &mut ChaCha8Rng) -> Series {
        let joints = self.missing.channels();
        let mut level = vec![0.0; joints];
        let drawn = self.missing.values().iter().enumerate().map(|(i, missing)| {
            let begins = self.rests[i] && !(i >= joints && self.rests[i - joints]);
            if begins {
                level[i % joints] = rng.random_range(-1.0..1.0);
            }
            level[i % joints] * missing
        });
        Series::shaped(joints, drawn.collect())
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::*;

    #[test]
    fn a_joint_at_rest_has_one_level_and_a_moving_one_none() {
        // The first joint rests twice, the second moves.
        let dq = Series::side_by_side(&[vec![0.0, 0.0, 1.0, 0.0], vec![1.0, -1.0, 1.0, 1.0]]);
        let drawn = StaticFriction::new(&[2.0, 3.0], &dq, 1e-3).draw(&mut ChaCha8Rng::seed_from_u64(1));
        let [first, second] = [drawn.channel(0), drawn.channel(1)];
        assert!(first[0] == first[1] && first[0] != first[3] && first[2].abs() < 1e-12 && first[0].abs() <= 2.0);
        assert!(second.iter().all(|torque| torque.abs() < 1e-12));
    }
}
