//! Whether the described controller gives the recorded drive signals from the recorded reference and motion.

use super::{
    examination::{Evidence, Examination, Words},
    finding::{Code, Severity},
    numbers::{deviation, rms},
    reference_fit::explanation,
    signals::Signals,
    subject::Subject,
};
use crate::{
    control::{Controller, ControllerDescription, VelocityEstimate},
    linear_algebra::{Matrix, dot},
    series::Series,
    signal::{Decimator, central_difference},
};

/// Rms of the drive signal that the law does not give, in the band of the estimate's rows, percent of its standard
/// deviation. EMPS has 0.3, the twin with its torque noise at most 13 (clean).
const LIMIT_PERCENT: f64 = 25.0;

/// Nothing to compare where the reference is not recorded, or where a signal is added that the subject does not hold.
pub(super) fn check(exam: &mut Examination<'_>, signals: &Signals) {
    let subject = exam.subject;
    let (Some(reference), Some(description)) = (subject.reference, subject.controller) else { return };
    let Some(torque) = subject.torque_in_window() else { return };
    if subject.added_signal || description.validate(signals.coordinates()).is_err() {
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
    let (Ok(command), Ok(drive)) = (smooth(&Series::from_channels(&commands)), smooth(&drive)) else { return };
    (0..signals.coordinates()).for_each(|i| compare(exam, &command.channel(i), &drive.channel(i), i));
}

fn compare(exam: &mut Examination<'_>, command: &[f64], drive: &[f64], i: usize) {
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
        let cause = explanation(drive, command, rate).map_or(String::new(), |cause| format!("; {cause}"));
        Words::new(
            format!(
                "motor {}: {value:.0} % of the drive signal is not what the controller gives for this reference and \
                 motion{cause}",
                i + 1
            ),
            "check [controller]'s law, gains and delay; IDIM-IV and DIDIM simulate the loop with it",
        )
    });
}

/// What the law acts on, motor by motor in joint units.
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
        let late = (description.delay_s * rate).round() as usize;
        let cut = |series: &Series| series.window(window.clone());
        let delayed = |series: Series| delayed(&series, late);
        Self {
            error: delayed(cut(&Series::from_values(position.channels(), error))),
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

    /// The inertia, in the direction of each drive, that explains the drive signals best, where the gains follow from it.
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
    Series::from_values(series.channels(), values)
}

/// `(p_k - p_{k-2}) / (2 T)`.
fn averaged_difference(position: &Series, rate: f64) -> Series {
    let difference = |k: usize| {
        let before = position.sample(k.saturating_sub(2));
        position.sample(k).iter().zip(before).map(|(a, b)| 0.5 * rate * (a - b)).collect::<Vec<_>>()
    };
    Series::from_values(position.channels(), (0..position.len()).flat_map(difference).collect())
}

/// The series some samples later; the first one stands for those before it.
fn delayed(series: &Series, samples: usize) -> Series {
    let values = (0..series.len()).flat_map(|k| series.sample(k.saturating_sub(samples)).iter().copied()).collect();
    Series::from_values(series.channels(), values)
}
