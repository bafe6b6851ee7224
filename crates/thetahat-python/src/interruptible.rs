//! Long work that Ctrl-C ends.

use std::{
    panic::resume_unwind,
    sync::mpsc::{RecvTimeoutError, channel},
    thread,
    time::Duration,
};

use pyo3::prelude::*;

use crate::python_error::PythonError;

/// How often signals are looked at while the work goes on.
const EVERY: Duration = Duration::from_millis(50);

/// Does the work in a thread of its own, without the interpreter's lock. What it is told is passed on to `progress`, and an
/// exception of that, or of a signal such as Ctrl-C, is raised at once: the abandoned thread ends where it next tells something.
pub fn run<T: Send + 'static>(
    py: Python<'_>,
    progress: Option<Bound<'_, PyAny>>,
    work: impl FnOnce(&mut dyn FnMut(&str)) -> Result<T, PythonError> + Send + 'static,
) -> PyResult<T> {
    let (tell, mut told) = channel::<String>();
    let worker = thread::spawn(move || {
        work(&mut |stage| {
            if tell.send(stage.to_owned()).is_err() {
                // Nobody waits any more. This is no panic: nothing is printed.
                resume_unwind(Box::new("abandoned"));
            }
        })
    });
    loop {
        let told = &mut told;
        match py.detach(move || told.recv_timeout(EVERY)) {
            Ok(stage) => progress.as_ref().map_or(Ok(()), |progress| progress.call1((stage,)).map(|_| ()))?,
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => break,
        }
        py.check_signals()?;
    }
    Ok(py.detach(|| worker.join()).unwrap_or_else(|panic| resume_unwind(panic))?)
}
