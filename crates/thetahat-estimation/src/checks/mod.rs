//! Finds what is wrong with a recording before anything is estimated from it.
//!
//! [`examine`] checks one recording on the joint side: its samples (missing, repeated, outliers, coarse steps, limits,
//! rests), the filtered samples, recorded velocities and references, and the fit of the robot's model. The fit shows wrong
//! units, sides of the gears, signs, exchanged joints, gear ratios and lags, and parameters that the motion does not excite.
//! Each [`Finding`] has a stable [`Code`], a [`Severity`], its evidence as a number, and a remedy.
//! `docs/evidence/checks.md` lists the limits, their margins on clean recordings, and what is not detected.
//!
//! A check is a file with a function `check`, a [`Code`], and a line in the order of the checks in this file.
//!
//! ```
//! use thetahat_estimation::checks::{Code, Severity};
//! // Codes and severities have names that stay, for scripts that look for them.
//! assert_eq!((Code::DroppedSamples.name(), Severity::Problem.name()), ("dropped-samples", "problem"));
//! let mut names = Code::ALL.map(Code::name).to_vec();
//! names.sort_unstable();
//! names.dedup();
//! assert_eq!(names.len(), Code::ALL.len());
//! ```

mod control;
mod examination;
mod finding;
mod fit;
mod motion;
mod numbers;
mod recordings;
mod remedy_step;
mod robot;
mod signals;
mod subject;
mod time;
mod torque;

#[cfg(test)]
mod tests;

pub use finding::{Code, Finding, Measure, Severity};
pub use recordings::across_recordings::{compare, measure_across_recordings};
pub use recordings::companion::Companion;
#[doc(hidden)]
pub use remedy_step::{OrderedStep, RemedySignal, RemedyStep};
pub use robot::description::examine_robot;
pub use subject::{SignalSettings, Subject};

use examination::Examination;
use fit::thinned_recording::ThinnedRecording;
use signals::Signals;

/// The findings in a recording: most severe first, then by code and joint.
///
/// The checks are independent of each other, but the checks of the fit correct the faults found so far, so that each fault is
/// reported once. A recording that is too short for the filters has no findings of the fit.
///
/// # Panics
/// If the series differ in length or channels, or the window reaches beyond them.
#[must_use]
pub fn examine(subject: &Subject<'_>) -> Vec<Finding> {
    examination(subject).into_findings()
}

/// The evidence of every check, whether above or below its limit, by code and joint.
///
/// # Panics
/// As [`examine`].
#[must_use]
pub fn measure(subject: &Subject<'_>) -> Vec<Measure> {
    examination(subject).into_measures()
}

/// Runs all checks in order.
fn examination<'a>(subject: &'a Subject<'a>) -> Examination<'a> {
    let mut exam = Examination::new(subject);
    check_samples(&mut exam);
    if let Ok(signals) = Signals::new(subject, subject.signal.cutoff_hz) {
        check_motion(&mut exam, &signals);
        if let Some(mut recording) = ThinnedRecording::new(subject, subject.signal.cutoff_hz) {
            check_fit(&mut exam, &signals, &mut recording);
        }
    }
    exam
}

/// Checks of the samples as recorded.
fn check_samples(exam: &mut Examination<'_>) {
    time::stamps::check(exam);
    torque::levels::check(exam);
    torque::copies::check(exam);
    torque::spikes::check(exam);
}

/// Checks of the band-passed motion, and of recorded velocities and references.
fn check_motion(exam: &mut Examination<'_>, signals: &Signals) {
    motion::still::check(exam, signals);
    motion::dither::check(exam, signals);
    motion::levels::check(exam, signals);
    if !exam.has(&[Code::PositionSpikes]) {
        motion::repeats::check(exam, signals);
    }
    if !exam.has(&[Code::DroppedSamples]) {
        motion::jumps::check(exam, signals);
    }
    motion::resolution::check(exam, signals);
    motion::velocity::check(exam, signals);
    control::reference::check(exam);
    if !exam.has(&[Code::ReferenceMismatch]) {
        control::controller::check(exam, signals);
    }
}

/// Checks of the fit, without those that a defect found earlier makes meaningless.
fn check_fit(exam: &mut Examination<'_>, signals: &Signals, recording: &mut ThinnedRecording<'_>) {
    let is_uninformative = exam.has(&[Code::TorqueConstant, Code::JointStill, Code::JointDither])
        || exam.has_problem(Code::PositionJump)
        || !recording.has_rows_for(recording.parameters());
    if exam.has(&[Code::TorqueConstant]) && recording.has_rows_for(recording.parameters()) {
        torque::passive::check(exam, recording);
    }
    if is_uninformative {
        return motion::excitation::check(exam, &recording.with_estimated_parameters());
    }
    let hypotheses = torque::fault::affordable(recording);
    if recording.is_long_enough() && torque::gravity::check(exam, recording, &hypotheses) {
        return motion::excitation::check(exam, &recording.with_estimated_parameters());
    }
    torque::fault::check(exam, recording, &hypotheses);
    if recording.is_long_enough() {
        let is_limited = torque::limit::check(exam, recording) || exam.has(&[Code::TorqueSaturated]);
        if !is_limited && torque::external_force::check(exam, recording) {
            return motion::excitation::check(exam, &recording.with_estimated_parameters());
        }
        time::long_lag::check(exam, recording);
    }
    if !exam.has(&[Code::PositionScale]) {
        motion::position_range::check(exam, signals);
    }
    torque::friction::check(exam, recording);
    let shapes = fit::friction_shapes::friction_shapes(recording);
    if recording.is_long_enough() {
        torque::unexplained::check(exam, recording);
        if let Some(shapes) = &shapes {
            robot::wrong_robot::check(exam, recording, shapes);
        }
        robot::a_priori::check(exam, recording);
        if !recording.is_corrected() && !exam.has(&[Code::WrongRobot, Code::APrioriScale]) {
            robot::mirrored::check(exam, recording);
        }
    }
    time::cutoff::check(exam, recording);
    motion::excitation::check(exam, &recording.with_estimated_parameters());
    if exam.has(&[Code::CutoffLow]) || !recording.has_full_rank() {
        return;
    }
    if let Some(shapes) = &shapes {
        time::lag::check(exam, recording, shapes);
    }
    if !exam.has(&[Code::PoorFit]) {
        torque::gear::check(exam, recording);
        if recording.is_long_enough() {
            time::drift::check(exam, recording);
        }
    }
}
