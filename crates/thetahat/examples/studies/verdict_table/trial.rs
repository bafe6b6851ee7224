use std::error::Error;

use thetahat::{
    Recording, Robot,
    checks::Code,
    results::{ReasonCode, VerdictReason},
    simulation::SimulatorBias,
};
use thetahat_estimation::simulation::{Autoregression, SignalNoise, random_numbers};

use super::specimen::Specimen;

/// A way to mislead the verdict.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Trial {
    Clean,
    /// A tenth of the noise.
    Quiet,
    /// The torque is logged 5 ms late.
    Late,
    /// The robot has friction that the model lacks, half of Coulomb friction, over 0.05 rad/s (20 mm/s).
    Stribeck,
    /// The true loop has gear ratios 3 % larger and 3 ms more delay than the simulated one.
    WrongLoop,
    /// The robot follows the reference scaled by 0.95.
    ScaledReference,
    WrongRobot,
    /// The torques grow by 20 % over the recording.
    DriftingGain,
    /// White noise as large as the torques.
    Noise,
    /// Noise with a correlation of 0.98 from sample to sample.
    SlowNoise,
    /// The torques of another motion.
    OtherRecording,
}

/// What is identified: a robot as described, and its recording.
pub type Made = (Robot, Recording);

impl Trial {
    pub const ALL: [Self; 11] = [
        Self::Clean,
        Self::Quiet,
        Self::Late,
        Self::Stribeck,
        Self::WrongLoop,
        Self::ScaledReference,
        Self::WrongRobot,
        Self::DriftingGain,
        Self::Noise,
        Self::SlowNoise,
        Self::OtherRecording,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Self::Clean => "clean",
            Self::Quiet => "clean, a tenth of the noise",
            Self::Late => "torque logged 5 ms late",
            Self::Stribeck => "Stribeck friction that the model lacks",
            Self::WrongLoop => "gear ratios and delay wrong in the simulator",
            Self::ScaledReference => "reference scaled by 0.95",
            Self::WrongRobot => "a robot described with lengths 1.5 times as large",
            Self::DriftingGain => "torques grow by 20 %",
            Self::Noise => "torques of white noise",
            Self::SlowNoise => "torques of slow noise",
            Self::OtherRecording => "torques of another recording",
        }
    }

    /// The robot and the recording; `None` if the specimen does not allow the trial.
    pub fn make(self, specimen: &Specimen, seed: u64) -> Result<Option<Made>, Box<dyn Error>> {
        let robot = specimen.experiment.robot.clone();
        let recording = match self {
            Self::Clean => specimen.clean(),
            Self::Quiet => specimen.quiet(),
            Self::Late => late(specimen),
            Self::Stribeck => specimen.with_stribeck(STRIBECK_VELOCITY, 0.5)?,
            Self::WrongLoop => {
                specimen.of_another_loop(SimulatorBias { gear_ratio: 1.03, delay_s: 3e-3, ..SimulatorBias::NONE })?
            }
            Self::ScaledReference => {
                specimen.of_another_loop(SimulatorBias { reference_scale: 0.95, ..SimulatorBias::NONE })?
            }
            Self::WrongRobot => {
                let Some(wrong) = specimen.wrong_robot() else { return Ok(None) };
                return Ok(Some((wrong, without_truth(specimen.clean()))));
            }
            Self::DriftingGain => {
                let samples = specimen.motion.motion.q.len() as f64;
                specimen.with_torques(|_, k, t| t * (1.0 + 0.2 * k as f64 / samples))
            }
            Self::Noise => without_truth(noise(specimen, seed, 0.0)),
            Self::SlowNoise => without_truth(noise(specimen, seed, 0.98)),
            Self::OtherRecording => without_truth(specimen.with_torques_of_another_motion()?),
        };
        Ok(Some((robot, recording)))
    }

    /// Records with other seeds of what is random.
    pub fn seeds(self) -> u64 {
        match self {
            Self::Noise | Self::SlowNoise => 20,
            Self::Clean
            | Self::Quiet
            | Self::Late
            | Self::Stribeck
            | Self::WrongLoop
            | Self::ScaledReference
            | Self::WrongRobot
            | Self::DriftingGain
            | Self::OtherRecording => 1,
        }
    }

    /// Whether a reason names what is wrong.
    pub fn is_cause(self, reason: &VerdictReason) -> bool {
        let lacking = matches!(reason.code, ReasonCode::CorrelatedResidual);
        let found = |codes: &[Code]| reason.subject.finding.is_some_and(|code| codes.contains(&code));
        match self {
            Self::Late => found(&[Code::Lag]),
            Self::Stribeck => lacking || found(&[Code::PoorFit]),
            Self::DriftingGain => found(&[Code::GainDrift, Code::FrictionDrift]),
            Self::WrongRobot => lacking || found(&[Code::WrongRobot, Code::PoorFit]),
            Self::OtherRecording => found(&[Code::WrongRobot, Code::PoorFit, Code::WorseThanMean]),
            Self::Clean | Self::Quiet | Self::WrongLoop | Self::ScaledReference | Self::Noise | Self::SlowNoise => {
                false
            }
        }
    }
}

/// rad/s or m/s.
const STRIBECK_VELOCITY: f64 = 0.05;
const LATE_S: f64 = 5e-3;

/// Such a recording has no true parameters of the robot as described.
fn without_truth(recording: Recording) -> Recording {
    Recording { truth: None, ..recording }
}

fn late(specimen: &Specimen) -> Recording {
    let samples = (LATE_S * specimen.rate_hz()).round() as usize;
    let torque = specimen.torque();
    specimen.with_torques(|j, k, _| torque.sample(k.saturating_sub(samples))[j])
}

fn noise(specimen: &Specimen, seed: u64, correlation: f64) -> Recording {
    let torque = specimen.torque();
    let rms = |j: usize| (torque.channel(j).iter().map(|t| t * t).sum::<f64>() / torque.len() as f64).sqrt();
    let size: Vec<f64> = (0..torque.channels()).map(rms).collect();
    let fresh = vec![f64::sqrt(1.0 - correlation * correlation); torque.channels()];
    let unit = Autoregression { correlation, first: fresh.clone(), innovation: fresh };
    let noise = SignalNoise::Autoregressive(&unit).draw(torque.len(), &mut random_numbers(seed, 0));
    specimen.with_torques(|j, k, _| size[j] * noise.sample(k)[j])
}
