//! Whether the described controller gives the recorded drive signals from the recorded reference and motion.

use super::reference_fit::explanation;
use crate::{
    checks::{
        examination::{Evidence, Examination, FindingText},
        finding::{Code, Severity},
        numbers::{deviation, rms},
        signals::Signals,
        subject::Subject,
    },
    control::{Controller, ControllerDescription, VelocityEstimate},
    signal::{Decimator, central_difference},
};
use thetahat_ground::{
    linear_algebra::{Matrix, PivotedQr, dot},
    number::significant,
    series::Series,
};

/// Rms difference of the drive signal and the controller's, in the band of the estimate's rows, percent of the drive signal's
/// standard deviation. EMPS has 0.3, the twin with its torque noise at most 13 (clean).
const LIMIT_PERCENT: f64 = 25.0;
/// Correlation of the changes of command and drive signal above which they have the same shape, and the factor between them
/// above which the unit of a gain is wrong, not its value.
const SAME_SHAPE: f64 = 0.8;
const OTHER_UNIT: f64 = 3.0;
/// Largest relative difference of such a factor from a power of the gear ratio.
const NEAR_RATIO: f64 = 0.3;

/// Compares nothing if the reference is not recorded, if an unknown signal is added to the drives, or if the loop is open.
pub(in crate::checks) fn check(exam: &mut Examination<'_>, signals: &Signals) {
    let subject = exam.subject;
    let (Some(reference), Some(description)) = (subject.reference, subject.controller) else { return };
    let Some(torque) = subject.torque_in_window() else { return };
    // What a law with a memory gives depends on where its memory began.
    let has_memory = description.own_law().is_some_and(|law| law.memory() > 0);
    if subject.added_signal
        || has_memory
        || description.is_open_loop()
        || description.validate(signals.coordinates()).is_err()
    {
        return;
    }
    let law = LawInputs::new(subject, signals, reference, description);
    let drive = subject.robot.transmission.drive_signals(&torque);
    let direction: Vec<f64> = subject.robot.transmission.drive_to_joint_units().iter().map(|d| d.signum()).collect();
    let inertia = law.inertia(description, &drive, &direction);
    let controller = description.resolve(&inertia, 1.0);
    let commands: Vec<Vec<f64>> = (0..signals.coordinates()).map(|i| law.command(&controller, i)).collect();
    let smooth =
        |series: &Series| Decimator::new(subject.signal.decimation, series.len()).and_then(|d| d.filter(series));
    let (Ok(command), Ok(drive)) = (smooth(&Series::side_by_side(&commands)), smooth(&drive)) else { return };
    let ratios: Vec<f64> = subject.robot.transmission.drive_to_joint_units().iter().map(|d| d.abs()).collect();
    for (i, &gear_ratio) in ratios.iter().enumerate().take(signals.coordinates()) {
        compare(exam, &DriveSignal { command: command.channel(i), recorded: drive.channel(i), gear_ratio }, i);
    }
}

/// The drive signal of one motor.
struct DriveSignal {
    /// From the controller, for the recorded reference and motion.
    command: Vec<f64>,
    recorded: Vec<f64>,
    gear_ratio: f64,
}

fn compare(exam: &mut Examination<'_>, signal: &DriveSignal, i: usize) {
    let DriveSignal { command, recorded: drive, gear_ratio } = signal;
    let difference: Vec<f64> = command.iter().zip(drive).map(|(a, b)| a - b).collect();
    let value = 100.0 * rms(&difference) / deviation(drive);
    let rate = exam.subject.sample_rate_hz;
    let evidence = Evidence {
        code: Code::ControllerMismatch,
        coordinate: Some(i),
        value,
        unit: "% of the drive signal",
        limit: LIMIT_PERCENT,
    };
    exam.judge(evidence, Severity::Warning, || {
        let seen = format!(
            "motor {}: the drive signal differs by {value:.0} % from what the controller gives for this reference and motion",
            i + 1
        );
        if let Some(factor) = other_unit(command, drive) {
            return FindingText::new(
                format!("{seen}; it has the same shape but is {}", times_as_large(factor, *gear_ratio)),
                "give the gains in joint units (docs/reference/experiments.md): multiply velocity_gain of a cascaded law, or both gains \
                 of pd, by that factor",
            );
        }
        let cause = explanation(drive, command, rate).map_or(String::new(), |cause| format!("; {cause}"));
        FindingText::new(
            format!("{seen}{cause}"),
            "check [controller]'s law, gains and delay; IDIM-IV and DIDIM simulate the loop with it",
        )
    });
}

/// Ratio of the changes of the drive signal to those of the command, if their shape is the same and the ratio far from one. An
/// integrator's part of the changes follows the command itself; gravity changes slowly.
fn other_unit(command: &[f64], drive: &[f64]) -> Option<f64> {
    let changes = |x: &[f64]| -> Vec<f64> { x.windows(2).map(|w| w[1] - w[0]).collect() };
    let (of_command, of_drive) = (changes(command), changes(drive));
    let both = Matrix::from_fn(of_command.len(), 2, |k, c| if c == 0 { of_command[k] } else { command[k] });
    let solution = PivotedQr::new(&both).solve(&of_drive);
    let followed = both.times(&solution);
    let correlation = (dot(&followed, &followed) / dot(&of_drive, &of_drive)).sqrt();
    let factor = *solution.first()?;
    (correlation > SAME_SHAPE && !(1.0 / OTHER_UNIT..=OTHER_UNIT).contains(&factor)).then_some(factor)
}

/// How many times as large the drive signal of a motor with a gear ratio is.
fn times_as_large(factor: f64, ratio: f64) -> String {
    let is_near = |power: i32| ratio > OTHER_UNIT && (factor / ratio.powi(power) - 1.0).abs() < NEAR_RATIO;
    let near_ratio = match (is_near(1), is_near(2)) {
        (true, _) => format!(", about the gear ratio, {ratio:.1}"),
        (false, true) => format!(", about the square of the gear ratio, {ratio:.1}"),
        (false, false) => String::new(),
    };
    format!("{} times as large{near_ratio}", significant(factor, 3))
}

/// The controller's inputs, motor by motor in joint units.
struct LawInputs {
    error: Series,
    velocity: Series,
    reference_velocity: Series,
    reference_acceleration: Series,
}

impl LawInputs {
    fn new(subject: &Subject<'_>, signals: &Signals, reference: &Series, description: &ControllerDescription) -> Self {
        let (rate, window) = (subject.sample_rate_hz, &subject.signal.window);
        let n = subject.robot.transmission.motor_in_joint_units();
        let reference = motors(&n, reference);
        let position = motors(&n, subject.position);
        let dr = central_difference(&reference, rate);
        let ddr = central_difference(&dr, rate);
        let velocity = match description.velocity {
            VelocityEstimate::Exact => motors(&n, &signals.dq),
            VelocityEstimate::AveragedDifference => averaged_difference(&position, rate).window(window.clone()),
        };
        let error = reference.values().iter().zip(position.values()).map(|(r, q)| r - q).collect();
        let delay = (description.delay_s * rate).round() as usize;
        let cut = |series: &Series| series.window(window.clone());
        let delayed = |series: Series| delayed(&series, delay);
        Self {
            error: delayed(cut(&Series::shaped(position.channels(), error))),
            velocity: delayed(velocity),
            reference_velocity: delayed(cut(&dr)),
            reference_acceleration: delayed(cut(&ddr)),
        }
    }

    fn command(&self, controller: &Controller, i: usize) -> Vec<f64> {
        let at = |series: &Series, k: usize| series.sample(k)[i];
        (0..self.error.len())
            .map(|k| {
                let (dr, ddr) = (at(&self.reference_velocity, k), at(&self.reference_acceleration, k));
                controller.command(i, at(&self.error, k), at(&self.velocity, k), dr, ddr)
            })
            .collect()
    }

    /// The inertia, in the direction of each drive, that explains the drive signals best; one if the gains do not depend on it.
    fn inertia(&self, description: &ControllerDescription, drive: &Series, direction: &[f64]) -> Vec<f64> {
        let motors = drive.channels();
        if !description.needs_inertia() {
            return vec![1.0; motors];
        }
        let unlimited = ControllerDescription { saturation: Vec::new(), ..description.clone() };
        let [none, unit] = [0.0, 1.0].map(|j| unlimited.resolve(&vec![j; motors], 1.0));
        (0..motors)
            .map(|i| {
                let fixed = self.command(&none, i);
                let slope: Vec<f64> = self.command(&unit, i).iter().zip(&fixed).map(|(a, b)| a - b).collect();
                let rest: Vec<f64> = drive.channel(i).iter().zip(&fixed).map(|(u, f)| u - f).collect();
                let best = dot(&slope, &rest) / dot(&slope, &slope);
                direction[i] * (direction[i] * best).max(0.0)
            })
            .collect()
    }
}

/// Joint positions to motor positions in joint units, without offsets.
fn motors(n: &Matrix, series: &Series) -> Series {
    let values = (0..series.len()).flat_map(|k| n.times(series.sample(k))).collect();
    Series::shaped(series.channels(), values)
}

/// `(p_k - p_{k-2}) / (2 T)`.
fn averaged_difference(position: &Series, rate: f64) -> Series {
    let difference = |k: usize| {
        let before = position.sample(k.saturating_sub(2));
        position.sample(k).iter().zip(before).map(|(a, b)| 0.5 * rate * (a - b)).collect::<Vec<_>>()
    };
    Series::shaped(position.channels(), (0..position.len()).flat_map(difference).collect())
}

/// The series delayed by some samples; the first sample is repeated.
fn delayed(series: &Series, samples: usize) -> Series {
    let values = (0..series.len()).flat_map(|k| series.sample(k.saturating_sub(samples)).iter().copied()).collect();
    Series::shaped(series.channels(), values)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A PI loop that is described without its integrator and with gains of the motor side.
    #[test]
    fn a_gain_in_another_unit_is_found_despite_an_integrator_and_gravity() {
        let command: Vec<f64> = (0..2000).map(|k| (0.03 * k as f64).sin() + 0.4 * (0.11 * k as f64).cos()).collect();
        let mut integral = 0.0;
        let with_gain = |gain: f64, integral: &mut f64| -> Vec<f64> {
            let drive = |(k, c): (usize, &f64)| {
                *integral += 0.01 * c;
                gain * (c + *integral) + 3.0 * (1e-3 * k as f64).cos()
            };
            command.iter().enumerate().map(drive).collect()
        };
        let factor = other_unit(&command, &with_gain(100.0, &mut integral)).unwrap();
        assert!((factor - 100.0).abs() < 2.0, "{factor}");
        assert_eq!(
            times_as_large(factor, 95.0),
            format!("{} times as large, about the gear ratio, 95.0", significant(factor, 3))
        );
        assert!(times_as_large(factor, 10.0).contains("the square of the gear ratio, 10.0"));
        assert!(other_unit(&command, &with_gain(1.2, &mut integral)).is_none());
        let unlike: Vec<f64> = (0..2000).map(|k| 100.0 * (0.07 * k as f64).sin()).collect();
        assert!(other_unit(&command, &unlike).is_none());
    }
}
