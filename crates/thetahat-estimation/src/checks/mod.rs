//! What is wrong with a recording, found before anything is estimated from it.
//!
//! [`examine`] looks at one recording on the joint side: at its samples (missing, repeated, outliers, coarse steps, limits,
//! rests), at what the filter makes of them, at velocities and references that were recorded beside, and at the fit of the
//! robot's model, which shows units, sides of the gears, signs, exchanged joints, ratios, lags, and what the motion does not
//! excite. Each [`Finding`] has a stable [`Code`], a [`Severity`], its evidence as a number, and what to do. Limits,
//! their margins on clean records, and what is not detected are in `docs/evidence/checks.md`.
//!
//! A check is a file with a function `check`, a [`Code`], and a line in the order of the checks, which stands here.
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

mod a_priori;
mod across_recordings;
mod affine;
mod companion;
mod contradiction;
mod controller;
mod cutoff;
mod description;
mod dither;
mod drift;
mod examination;
mod excitation;
mod fault;
mod finding;
mod friction;
mod friction_shapes;
mod gear;
mod gravity;
mod hypotheses;
mod lag;
mod lag_search;
mod late_stamps;
mod levels;
mod motion;
mod numbers;
mod orthogonal_fit;
mod position_range;
mod reference;
mod reference_fit;
mod repeats;
mod resolution;
mod same_recording;
mod signals;
mod spikes;
mod stamps;
mod subject;
mod thinned_record;
mod torque;
mod unexplained;
mod velocity;
mod wrong_robot;

#[cfg(test)]
mod tests;

pub use across_recordings::{compare, measure_together};
pub use companion::Companion;
pub use description::examine_robot;
pub use finding::{Code, Finding, Measure, Severity};
pub use subject::{SignalSettings, Subject};

use examination::Examination;
use signals::Signals;
use thinned_record::ThinnedRecord;

/// What the checks find in a recording: most severe first, then by code and joint.
///
/// Every check stands by itself. The checks of the fit look at the record with the faults found so far corrected, so that
/// a fault is named once. A record too short for the filters has no findings of the fit.
///
/// # Panics
/// If the series differ in length or channels, or the window is not in them.
#[must_use]
pub fn examine(subject: &Subject<'_>) -> Vec<Finding> {
    examination(subject).into_findings()
}

/// The numbers behind the findings, and those that were below their limits, by code and joint.
///
/// # Panics
/// As [`examine`].
#[must_use]
pub fn measure(subject: &Subject<'_>) -> Vec<Measure> {
    examination(subject).into_measures()
}

/// All checks in their order.
fn examination<'a>(subject: &'a Subject<'a>) -> Examination<'a> {
    let mut exam = Examination::new(subject);
    check_samples(&mut exam);
    if let Ok(signals) = Signals::new(subject, subject.signal.cutoff_hz) {
        check_motion(&mut exam, &signals);
        if let Some(mut record) = ThinnedRecord::new(subject, subject.signal.cutoff_hz) {
            check_fit(&mut exam, &signals, &mut record);
        }
    }
    exam
}

/// The samples as recorded.
fn check_samples(exam: &mut Examination<'_>) {
    stamps::check(exam);
    torque::check(exam);
    spikes::check(exam);
}

/// The band-passed motion, and what was recorded beside it.
fn check_motion(exam: &mut Examination<'_>, signals: &Signals) {
    motion::check(exam, signals);
    dither::check(exam, signals);
    levels::check(exam, signals);
    if !exam.has(&[Code::PositionSpikes]) {
        repeats::check(exam, signals);
    }
    resolution::check(exam, signals);
    velocity::check(exam, signals);
    reference::check(exam);
    if !exam.has(&[Code::ReferenceMismatch]) {
        controller::check(exam, signals);
    }
}

/// The fit. What a defect that was found makes meaningless is left out.
fn check_fit(exam: &mut Examination<'_>, signals: &Signals, record: &mut ThinnedRecord<'_>) {
    let blind = exam.has(&[Code::TorqueConstant, Code::JointStill, Code::JointDither])
        || !record.has_rows_for(record.parameters());
    if blind {
        return excitation::check(exam, &record.of_estimated());
    }
    if record.is_long_enough() && gravity::check(exam, record) {
        return excitation::check(exam, &record.of_estimated());
    }
    fault::check(exam, record);
    if !exam.has(&[Code::PositionScale]) {
        position_range::check(exam, signals);
    }
    friction::check(exam, record);
    let shapes = friction_shapes::friction_shapes(record);
    if record.is_long_enough() {
        unexplained::check(exam, record);
        if let Some(shapes) = &shapes {
            wrong_robot::check(exam, record, shapes);
        }
        a_priori::check(exam, record);
    }
    cutoff::check(exam, record);
    excitation::check(exam, &record.of_estimated());
    if exam.has(&[Code::CutoffLow]) || !record.has_full_rank() {
        return;
    }
    if let Some(shapes) = &shapes {
        lag::check(exam, record, shapes);
    }
    if !exam.has(&[Code::PoorFit]) {
        gear::check(exam, record);
        if record.is_long_enough() {
            drift::check(exam, record);
        }
    }
}
