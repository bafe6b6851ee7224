//! What a fit of positions says against the controller that is described, where no torques are recorded: commands that act before they are
//! given, and gains that explain what is left. With wrong gains every torque is wrong by a factor.

use super::identification::Identification;
use crate::preparation::{LoopParameter, PreparationError};
use thetahat_estimation::{
    checks::{Code, Finding, Severity},
    identification::{Method, Status},
};
use thetahat_ground::number::significant;
use thetahat_report::results::{LoopParameterResult, NOMINAL, RunResult};

/// Samples by which a log may shift commands against positions.
const SHIFTED: f64 = 2.0;
/// Autocorrelation of a joint's residual from which it is looked at.
const CORRELATED: f64 = 0.1;
/// Samples of all joints beyond which two more fits take minutes, and gains are not looked at.
const MOST_SAMPLES: usize = 20_000;
/// Part of the squared error that is left, below which gains are named.
const LEFT: f64 = 0.5;
/// Relative error of a gain that is named, and that from which no number can be used.
const NAMED: f64 = 0.02;
const LARGE: f64 = 0.1;

impl Identification {
    /// What is wrong in the loop: commands that act too early, or else gains.
    ///
    /// # Errors
    /// [`PreparationError`] where a recording cannot be filtered.
    pub(super) fn wrong_loop(
        &self,
        runs: &[RunResult],
        progress: &mut dyn FnMut(&str),
    ) -> Result<Option<Finding>, PreparationError> {
        let of_positions =
            |r: &&RunResult| r.case == NOMINAL && r.method == Method::CLOE && r.status == Status::Converged;
        let Some(run) = runs.iter().find(of_positions) else { return Ok(None) };
        match self.early_commands(run) {
            Some(early) => Ok(Some(early)),
            None => self.wrong_gains(run, progress),
        }
    }

    /// Commands that act before they are given, by more samples than a log shifts them.
    pub(super) fn early_commands(&self, run: &RunResult) -> Option<Finding> {
        let rate_hz = self.main.first()?.filtered.recording.sample_rate_hz;
        let delay = run.loop_parameters.iter().find(|p| p.name == "delay")?;
        let early_ms = significant(-1e3 * delay.estimate, 3);
        (delay.estimate * rate_hz < -SHIFTED).then(|| {
            Finding {
                value: 1e3 * delay.estimate,
                unit: "ms".to_owned(),
                limit: Some(-1e3 * SHIFTED / rate_hz),
                ..mismatch(
                    Severity::Problem,
                    format!("the commands act {early_ms} ms before they are given in the loop that fits best"),
                    "check columns, units, signs and times of commands and positions, the gains, and limits of the controller (saturation in \
                     [controller])"
                        .to_owned(),
                )
            }
        })
    }

    /// Gains that are not those described; none if others explain no more, or are estimated already.
    ///
    /// # Errors
    /// [`PreparationError`] where a recording cannot be filtered.
    fn wrong_gains(
        &self,
        run: &RunResult,
        progress: &mut dyn FnMut(&str),
    ) -> Result<Option<Finding>, PreparationError> {
        let asked = &self.setup().settings.estimation.loop_parameters;
        let is_gain =
            |p: &LoopParameter| p.is_gain() || [LoopParameter::DriveGain, LoopParameter::DriveGains].contains(p);
        let joints = self.setup().robot.coordinate_count();
        let samples: usize = self.main.iter().map(|p| joints * p.filtered.used_samples().count()).sum();
        if !is_correlated(run) || asked.iter().any(is_gain) || samples > MOST_SAMPLES {
            return Ok(None);
        }
        for gains in [LoopParameter::DriveGain, LoopParameter::DriveGains] {
            let mut settings = self.setup().settings.clone();
            settings.estimation.loop_parameters.push(gains);
            let mut with_gains = |line: &str| progress(&format!("with {}: {line}", gains.name()));
            let Some(fitted) = self.with_settings(settings).fitted_positions(&mut with_gains)? else { continue };
            let error = |run: &RunResult| run.relative_error_percent.unwrap_or(f64::INFINITY);
            let left = (error(&fitted.run) / error(run)).powi(2);
            let factors: Vec<&LoopParameterResult> = fitted.run.loop_parameters.iter().filter(|p| is_off(p)).collect();
            if left < LEFT && !factors.is_empty() {
                return Ok(Some(self.finding(gains, &factors, [error(run), error(&fitted.run)])));
            }
        }
        Ok(None)
    }

    fn finding(&self, gains: LoopParameter, factors: &[&LoopParameterResult], [described, left]: [f64; 2]) -> Finding {
        let robot = self.setup().robot;
        let of_motor = |p: &LoopParameterResult| {
            let motor: Option<usize> = p.name.rsplit(' ').next().and_then(|number| number.parse().ok());
            let joint = motor.and_then(|m| Some(&robot.joints[*robot.coordinate_joints().get(m - 1)?].name));
            joint.map_or_else(|| "all motors".to_owned(), |name| format!("the motor of {name}"))
        };
        let off = |p: &LoopParameterResult| (p.estimate - 1.0).abs();
        let largest = factors.iter().map(|p| off(p)).fold(0.0, f64::max);
        let named: Vec<String> =
            factors.iter().map(|p| format!("{} for {}", significant(p.estimate, 3), of_motor(p))).collect();
        let keys = self.setup().settings.estimation.loop_parameters.iter().chain([&gains]);
        let keys: Vec<String> = keys.map(|p| format!("\"{}\"", p.name())).collect();
        Finding {
            value: 100.0 * largest,
            unit: "% of a gain".to_owned(),
            limit: Some(100.0 * NAMED),
            ..mismatch(
                if largest > LARGE { Severity::Problem } else { Severity::Warning },
                format!(
                    "gains of the controller times {} leave {} % error of the simulated positions instead of {} %",
                    named.join(", "),
                    significant(left, 3),
                    significant(described, 3),
                ),
                format!(
                    "check position_gain and velocity_gain of [controller], their order and unit, and the masses of the description: larger \
                     gains and lighter links act alike; loop_parameters = [{}] in [estimation] takes the factors",
                    keys.join(", ")
                ),
            )
        }
    }
}

/// A finding against the controller as a whole.
fn mismatch(severity: Severity, message: String, remedy: String) -> Finding {
    Finding {
        code: Code::ControllerMismatch,
        severity,
        joint: None,
        joint_name: None,
        value: 0.0,
        unit: String::new(),
        limit: None,
        message,
        remedy,
        parameters: Vec::new(),
        step: None,
    }
}

fn is_correlated(run: &RunResult) -> bool {
    run.residual.iter().flat_map(|r| &r.joints).any(|joint| joint.autocorrelation > CORRELATED)
}

/// Whether a factor on gains is not one.
fn is_off(p: &LoopParameterResult) -> bool {
    let excludes_one = p.interval_95.is_some_and(|[low, high]| low > 1.0 || high < 1.0);
    p.name.starts_with("drive gain") && excludes_one && (p.estimate - 1.0).abs() > NAMED
}
