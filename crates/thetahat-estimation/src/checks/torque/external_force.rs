//! Times at which something else acts on the robot: a push, a table, a person.
//!
//! What pushes a robot is in its torques for a short time, in which the model errs by many times its usual error. The fit without these
//! times finds more of them, until no more are found. Friction near a reversal errs for less time, and a load that the robot takes for
//! longer.

use thetahat_ground::stretches::stretches_where;

use crate::checks::{
    examination::{Evidence, Examination, FindingText},
    finding::{Code, Severity},
    fit::{orthogonal_fit::OrthogonalFit, thinned_recording::ThinnedRecording},
    numbers::{NORMAL_PER_MEDIAN, quantile_abs},
    remedy_step::RemedyStep,
};

/// Error of the joints, root mean square relative to the usual one, that an external force makes.
const HIGH: f64 = 3.5;
/// Time over which it is averaged, and the shortest time for which it lasts, s.
const AVERAGED_S: f64 = 0.2;
const SHORTEST_S: f64 = 0.3;
/// Rows in the shortest time below which single errors would look like a force.
const FEWEST_ROWS: f64 = 3.0;
/// Time that is left out on either side, s.
const MARGIN_S: f64 = 0.1;
/// Part of the torques that is left where they act: a fit whose errors are smaller is good enough with them.
const LEAST_ERROR: f64 = 0.025;
/// Largest part of the rows, and most times.
const LARGEST_PART: f64 = 0.2;
const MOST_TIMES: usize = 40;
/// Factor by which the mean squared residual of the other times must be smaller.
const GAIN: f64 = 4.0;
/// Most fits without the times that were found.
const ROUNDS: usize = 5;
/// Times that a message names.
const NAMED: usize = 3;

/// Checks for external forces; returns whether there are any.
pub(in crate::checks) fn check(exam: &mut Examination<'_>, recording: &ThinnedRecording<'_>) -> bool {
    if SHORTEST_S * recording.rows_per_second() < FEWEST_ROWS {
        return false;
    }
    let Some(Forces { times, gain }) = forces(recording) else { return false };
    let evidence = Evidence {
        code: Code::ExternalForce,
        coordinate: None,
        value: gain,
        unit: "times smaller mean squared residual",
        limit: GAIN,
    };
    exam.judge(evidence, Severity::Problem, || finding_text(gain, times))
}

fn finding_text(gain: f64, times: Vec<[f64; 2]>) -> FindingText {
    let named: Vec<String> = times.iter().take(NAMED).map(|[from, to]| format!("{from:.2} to {to:.2} s")).collect();
    let others = match times.len().saturating_sub(NAMED) {
        0 => String::new(),
        1 => " and once more".to_owned(),
        others => format!(" and {others} times more"),
    };
    let message = format!(
        "something else acts on the robot from {}{others}: the torques of the other times fit {:.1} times better",
        named.join(", from "),
        gain.sqrt()
    );
    let remedy = format!(
        "record without contacts and pushes, or leave these times out: left_out_s = {times:?} in [recording], in s from its start"
    );
    FindingText::new(message, remedy).with_step(RemedyStep::LeaveOutTimes { times })
}

/// Times of external forces.
struct Forces {
    /// From start to end, s from the start of the recording.
    times: Vec<[f64; 2]>,
    /// Factor by which the mean squared residual is smaller without them.
    gain: f64,
}

fn forces(recording: &ThinnedRecording<'_>) -> Option<Forces> {
    let regression = recording.regression().ok()?;
    let (rows, joints) = (recording.rows(), recording.coordinates());
    let all = recording.fit().ok().filter(|all| all.relative_error() > LEAST_ERROR)?;
    let mut left_out = vec![false; rows];
    let mut theta = all.theta();
    let mut squares = all.squares;
    for _ in 0..ROUNDS {
        let predicted = regression.x.times(&theta);
        let errors: Vec<f64> = regression.y.iter().zip(predicted).map(|(y, p)| y - p).collect();
        let found = disturbed(recording, &errors, &left_out);
        let count = found.iter().filter(|is_out| **is_out).count();
        if count == 0 || count as f64 > LARGEST_PART * rows as f64 {
            return None;
        }
        if found == left_out {
            break;
        }
        left_out = found;
        let fit = OrthogonalFit::without(&regression, &left_out.repeat(joints));
        (theta, squares) = (fit.theta(), fit.squares);
    }
    let kept = left_out.iter().filter(|is_out| !**is_out).count();
    let gain = (all.squares / rows as f64) / (squares / kept as f64);
    let times = recording.times_where(|i| left_out[i]);
    (times.len() <= MOST_TIMES).then_some(Forces { times, gain })
}

/// The rows around which the errors are far above the usual ones for long enough.
fn disturbed(recording: &ThinnedRecording<'_>, errors: &[f64], left_out: &[bool]) -> Vec<bool> {
    let (rows, joints) = (recording.rows(), recording.coordinates());
    let usual = |j: usize| {
        let own = errors[j * rows..][..rows].iter().zip(left_out).filter(|(_, is_out)| !**is_out);
        NORMAL_PER_MEDIAN * quantile_abs(own.map(|(e, _)| *e), 0.5)
    };
    let usual: Vec<f64> = (0..joints).map(usual).collect();
    let square = |i: usize| {
        let relative = (0..joints).filter(|&j| usual[j] > 0.0).map(|j| (errors[j * rows + i] / usual[j]).powi(2));
        relative.sum::<f64>() / joints as f64
    };
    let squares: Vec<f64> = (0..rows).map(square).collect();
    let in_rows = |seconds: f64| (seconds * recording.rows_per_second()).round().max(1.0) as usize;
    let half = in_rows(AVERAGED_S) / 2;
    let mean = |i: usize| {
        let around = &squares[i.saturating_sub(half)..(i + half + 1).min(rows)];
        around.iter().sum::<f64>() / around.len() as f64
    };
    let margin = in_rows(MARGIN_S);
    let mut disturbed = vec![false; rows];
    let mut high = stretches_where(0..rows, |i| mean(i) > HIGH * HIGH);
    high.retain(|stretch| stretch.len() >= in_rows(SHORTEST_S));
    for stretch in high {
        disturbed[stretch.start.saturating_sub(margin)..(stretch.end + margin).min(rows)].fill(true);
    }
    disturbed
}
