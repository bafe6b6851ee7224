//! Long work that Ctrl-C ends.

use std::{
    any::Any,
    panic::resume_unwind,
    sync::mpsc::{RecvTimeoutError, Sender, channel},
    thread,
    time::Duration,
};

use pyo3::{exceptions::PyException, prelude::*};

use crate::python_error::PythonError;

/// Time between checks of signals during the work.
const EVERY: Duration = Duration::from_millis(50);

/// What the work asks of the interpreter's thread.
enum Request {
    Stage(String),
    /// A call of the user's function; its error ends the work at once.
    Call(Box<dyn FnOnce(Python<'_>) -> PyResult<()> + Send>),
}

/// The work's way to the interpreter. The thread of the work never attaches itself: one that is abandoned may outlive the interpreter,
/// and an interpreter that ends aborts the process when such a thread returns to it.
#[derive(Clone)]
pub struct Interpreter(Sender<Request>);

impl Interpreter {
    pub fn report_stage(&self, stage: &str) {
        self.request(Request::Stage(stage.to_owned()));
    }

    /// The function's value, called in the interpreter's thread. An exception that `except Exception` does not catch, such as that
    /// of Ctrl-C, is raised there.
    pub fn call<T: Send + 'static>(
        &self,
        function: impl FnOnce(Python<'_>) -> PyResult<T> + Send + 'static,
    ) -> PyResult<T> {
        let (sender, value) = channel();
        self.request(Request::Call(Box::new(move |py| match function(py) {
            Err(error) if !error.is_instance_of::<PyException>(py) => Err(error),
            value => {
                // Only an abandoned work waits no longer.
                sender.send(value).ok();
                Ok(())
            }
        })));
        value.recv().unwrap_or_else(|_| abandoned())
    }

    fn request(&self, request: Request) {
        if self.0.send(request).is_err() {
            abandoned();
        }
    }
}

/// Ends the thread of a work whose caller has gone. This is not a panic: nothing is printed.
fn abandoned() -> ! {
    resume_unwind(Box::new("abandoned"))
}

/// Does the work in a separate thread, without the interpreter's lock. Its stages are passed to `progress`, and an exception of
/// that, or of a signal such as Ctrl-C, is raised at once: the abandoned thread ends at its next request.
pub fn run<T: Send + 'static>(
    py: Python<'_>,
    progress: Option<Bound<'_, PyAny>>,
    work: impl FnOnce(&Interpreter) -> Result<T, PythonError> + Send + 'static,
) -> PyResult<T> {
    let (sender, mut requests) = channel::<Request>();
    let worker = thread::spawn(move || work(&Interpreter(sender)));
    loop {
        let requests = &mut requests;
        match py.detach(move || requests.recv_timeout(EVERY)) {
            Ok(Request::Stage(stage)) => {
                progress.as_ref().map_or(Ok(()), |progress| progress.call1((stage,)).map(|_| ()))?
            }
            Ok(Request::Call(function)) => function(py)?,
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
