//! Start values around the a-priori parameters.

use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::{Campaign, CampaignError};
use crate::experiment::Experiment;
use thetahat_estimation::simulation::random_numbers;

/// Most draws of one start until one is physical.
const DRAWS: u32 = 10_000;
/// The streams of the starts, apart from those of the recordings.
const STREAM: u64 = 1 << 63;

impl Campaign {
    /// The experiment with the a-priori values of start number `start`, from zero.
    pub(super) fn start(&self, start: u32) -> Result<Experiment, CampaignError> {
        let mut experiment = self.experiment.clone();
        let deviation = self.file.starts.relative_deviation;
        if deviation == 0.0 {
            return Ok(experiment);
        }
        let mut rng = random_numbers(self.file.seed, STREAM | u64::from(start));
        let table = experiment.robot.parameter_table();
        let centre = experiment.robot.a_priori_parameters();
        let mut reason = String::new();
        for _ in 0..DRAWS {
            let drawn = draw(&centre, deviation, &mut rng);
            match table.check_physical(&drawn) {
                Err(found) => reason = found.to_string(),
                Ok(()) => {
                    let named = table.iter().zip(&drawn).filter(|(_, v)| **v != 0.0);
                    experiment.robot.a_priori = named.map(|(p, v)| (p.name(), *v)).collect();
                    return Ok(experiment);
                }
            }
        }
        let reason = match table.check_physical(&centre) {
            Ok(()) => format!("The last one failed at {reason}. Lower relative_deviation in [starts]"),
            Err(found) => format!("They are not physical themselves: {found}. Correct them"),
        };
        Err(CampaignError::NoPhysicalStart { path: self.path.clone(), draws: DRAWS, reason })
    }
}

fn draw(centre: &[f64], deviation: f64, rng: &mut ChaCha8Rng) -> Vec<f64> {
    let factor = |value: &f64| {
        let normal: f64 = StandardNormal.sample(rng);
        value * (1.0 + deviation * normal)
    };
    centre.iter().map(factor).collect()
}
