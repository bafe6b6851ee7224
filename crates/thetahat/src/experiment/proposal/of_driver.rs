//! What is said of the driver that wrote the log: what it means by torque, and where the log differs from it.

use super::{
    super::{
        column_names::Signal,
        driver::{Driver, DriverColumns},
    },
    clock::RATE_TOLERANCE,
    error::ProposalError,
    request::ProposalRequest,
    source::Source,
    text::{ProposedDriver, ProposedRecording, said_of},
};
use thetahat_data::recording::Contents;
use thetahat_model::robot::RobotSource;

/// The names of the robot's joints, which stand in the names of a driver's columns; empty without a driver.
pub(super) fn joint_names(request: &ProposalRequest, robot: &RobotSource) -> Result<Vec<String>, ProposalError> {
    if request.driver.is_none() {
        return Ok(Vec::new());
    }
    let robot = robot.robot_without_transmission();
    let robot = robot.map_err(|error| ProposalError::Robot { problem: error.to_string() })?;
    Ok(robot.coordinates().map(|joint| joint.name.clone()).collect())
}

/// The drivers that have the names of positions, torques and references of a log for which none was named, without references where the
/// names are long; none if too many do.
pub(super) fn likely_drivers(request: &ProposalRequest, contents: &[Contents]) -> Vec<String> {
    const FEW: usize = 2;
    // Letters of a name that others hardly give: present_position is one, q is none.
    const LONG: usize = 10;
    if request.driver.is_some() || !(request.position.is_empty() && request.torque.is_empty()) {
        return Vec::new();
    }
    let has = |driver: &Driver| {
        contents.iter().flat_map(|of| &of.tables).any(|table| {
            let names: Vec<&str> = table.columns.iter().map(|c| c.name.as_str()).collect();
            let columns = DriverColumns::of(driver, &names, &[]);
            let is_own = driver.columns(Signal::Position).iter().all(|name| name.len() > LONG);
            let has_both = columns.has(Signal::Position) && columns.has(Signal::Torque);
            has_both && (is_own || columns.has(Signal::Reference))
        })
    };
    let presets = Driver::presets().unwrap_or_default();
    let found: Vec<String> = presets.into_iter().filter(has).map(|driver| driver.name).collect();
    if found.len() > FEW { Vec::new() } else { found }
}

/// An error about columns with the drivers that have them.
pub(super) fn with_drivers(mut error: ProposalError, drivers: &[String]) -> ProposalError {
    if let (false, ProposalError::UnclearColumns { problem, .. }) = (drivers.is_empty(), &mut error) {
        *problem = format!("{problem}; {}", said_of(drivers));
    }
    error
}

/// That some file has columns of the driver, other than times.
pub(super) fn require_columns(request: &ProposalRequest, sources: &[Source<'_>]) -> Result<(), ProposalError> {
    let (Some(driver), Some(first)) = (&request.driver, sources.first()) else { return Ok(()) };
    let signals = [Signal::Position, Signal::Torque, Signal::Reference, Signal::Velocity];
    if sources.iter().any(|source| signals.into_iter().any(|signal| source.driver_has(signal))) {
        return Ok(());
    }
    Err(ProposalError::NotOfDriver {
        file: first.file.to_owned(),
        driver: driver.name.clone(),
        expected: signals.into_iter().flat_map(|signal| driver.columns(signal)).cloned().collect(),
        columns: first.listed(),
    })
}

/// What is known of the driver, and what the recordings contradict.
pub(super) fn proposed(
    request: &ProposalRequest,
    sources: &[Source<'_>],
    recordings: &[ProposedRecording],
) -> Option<ProposedDriver> {
    let driver = request.driver.as_ref()?;
    let of_rates = recordings.iter().filter_map(|recording| of_rate(request, driver, recording));
    let of_channels = recordings.iter().flat_map(|recording| &recording.channels).filter_map(|(signal, channels)| {
        let what = channels.contradiction.as_ref()?;
        Some(format!("{signal} of {}: {what}", channels.file.display()))
    });
    let of_columns = missing(driver, sources).into_iter();
    Some(ProposedDriver {
        head: format!("Driver {} ({}). What it means by effort: {}.", driver.name, driver.title, driver.effort),
        sources: driver.source.clone(),
        notes: driver.note.clone(),
        contradictions: of_columns.chain(of_channels).chain(of_rates).collect(),
    })
}

/// Signals whose columns the log has under other names than the driver's.
fn missing(driver: &Driver, sources: &[Source<'_>]) -> Vec<String> {
    let of_signal = |(signal, word): (Signal, &str)| {
        let names = driver.columns(signal);
        let is_there = names.is_empty() || sources.iter().any(|source| source.driver_has(signal));
        (!is_there).then(|| format!("it has no columns {} of the {word}", names.join(" ")))
    };
    [(Signal::Position, "positions"), (Signal::Torque, "torques")].into_iter().filter_map(of_signal).collect()
}

fn of_rate(request: &ProposalRequest, driver: &Driver, recording: &ProposedRecording) -> Option<String> {
    let (rate, found) = (driver.rate_hz?, recording.clock.rate_hz);
    let is_other = (found / rate - 1.0).abs() > RATE_TOLERANCE;
    match (&recording.clock.time, request.sample_rate_hz) {
        (None, None) => Some(format!("it has no times; the driver's rate of {rate} Hz is assumed")),
        (Some(_), _) | (None, Some(_)) => is_other.then(|| {
            format!(
                "its rate is {found:.2} Hz, the driver's {rate} Hz; values between that are left out may be aliased"
            )
        }),
    }
}
