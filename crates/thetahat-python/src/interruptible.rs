//! Long work that Ctrl-C ends.

use std::{
    any::Any,
    panic::resume_unwind,
    sync::mpsc::{RecvTimeoutError, channel},
    thread,
    time::Duration,
};

use pyo3::prelude::*;

use crate::python_error::PythonError;

/// Time between checks of signals during the work.
const EVERY: Duration = Duration::from_millis(50);

/// Does the work in a separate thread, without the interpreter's lock. Its stages are passed to `progress`, and an exception of
/// that, or of a signal such as Ctrl-C, is raised at once: the abandoned thread ends when it next reports a stage.
pub fn run<T: Send + 'static>(
    py: Python<'_>,
    progress: Option<Bound<'_, PyAny>>,
    work: impl FnOnce(&mut dyn FnMut(&str)) -> Result<T, PythonError> + Send + 'static,
) -> PyResult<T> {
    let (sender, mut stages) = channel::<String>();
    let worker = thread::spawn(move || {
        work(&mut |stage| {
            if sender.send(stage.to_owned()).is_err() {
                // The caller has gone. This is not a panic: nothing is printed.
                resume_unwind(Box::new("abandoned"));
            }
        })
    });
    loop {
        let stages = &mut stages;
        match py.detach(move || stages.recv_timeout(EVERY)) {
            Ok(stage) => progress.as_ref().map_or(Ok(()), |progress| progress.call1((stage,)).map(|_| ()))?,
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => break,
        }
        py.check_signals()?;
    }
    Ok(py.detach(|| worker.join()).unwrap_or_else(|panic| Err(of_panic(panic.as_ref())))?)
}

/// A panic is a mistake of the library, and still an exception that `except Exception` catches.
fn of_panic(panic: &(dyn Any + Send)) -> PythonError {
    let text = panic.downcast_ref::<&str>().copied().or_else(|| panic.downcast_ref::<String>().map(String::as_str));
    let text = text.unwrap_or("without a message");
    PythonError::new("ThetahatError", format!("a mistake in thetahat, which its makers want to know of: {text}"))
}
