//! The class that the page's worker calls. Texts are JSON; an error is a JavaScript `Error` with the library's message and the page's remedy.

use std::{path::Path, sync::Mutex};

use wasm_bindgen::prelude::*;

#[cfg(all(target_family = "wasm", target_os = "unknown"))]
use crate::threads;
use crate::{
    remedies::with_remedy,
    session::{self, Session},
};

/// A session in the page.
#[wasm_bindgen(js_name = Session)]
pub struct PageSession(Session);

type Outcome<T> = Result<T, JsError>;

fn to_js<T>(outcome: session::Outcome<T>) -> Outcome<T> {
    outcome.map_err(|error| JsError::new(&with_remedy(error.as_ref())))
}

#[wasm_bindgen(js_class = Session)]
impl PageSession {
    /// A session without files that works on this many threads: one, or those of `start_threads`.
    #[wasm_bindgen(constructor)]
    #[must_use]
    pub fn new(threads: usize) -> Self {
        keep_panics();
        Self(Session::in_folder(Path::new("")).on_threads(threads))
    }

    /// The version of the program.
    #[must_use]
    pub fn version(&self) -> String {
        env!("CARGO_PKG_VERSION").to_owned()
    }

    /// Puts a file into the session's folder.
    ///
    /// # Errors
    /// A path that leaves the folder.
    pub fn put(&mut self, path: &str, bytes: Vec<u8>) -> Outcome<()> {
        to_js(self.0.put(path, bytes))
    }

    /// Removes a file.
    ///
    /// # Errors
    /// A path that leaves the folder.
    pub fn remove(&mut self, path: &str) -> Outcome<()> {
        to_js(self.0.remove(path))
    }

    /// The files with their sizes.
    ///
    /// # Errors
    /// Infallible in practice.
    pub fn files(&self) -> Outcome<String> {
        to_js(self.0.files())
    }

    /// The kind of a file, by its content.
    ///
    /// # Errors
    /// A missing file.
    pub fn kind(&self, path: &str) -> Outcome<String> {
        to_js(self.0.kind(path).map(str::to_owned))
    }

    /// The robot and the recordings as they are read, and the proposed experiment.
    ///
    /// # Errors
    /// A malformed request.
    pub fn understand(&self, request: &str) -> Outcome<String> {
        to_js(self.0.understand(request))
    }

    /// The text of the proposed experiment file.
    ///
    /// # Errors
    /// The errors of the command `init`.
    pub fn propose(&self, request: &str, progress: &js_sys::Function) -> Outcome<String> {
        to_js(self.0.propose(request, &mut |stage| report_stage(progress, stage)))
    }

    /// The findings in the recordings of an experiment.
    ///
    /// # Errors
    /// The errors of the command `check`.
    pub fn check(&self, experiment: &str) -> Outcome<String> {
        to_js(self.0.check(experiment))
    }

    /// The results of an experiment, and their files.
    ///
    /// # Errors
    /// The errors of the command `identify`.
    pub fn identify(&self, experiment: &str, progress: &js_sys::Function) -> Outcome<String> {
        to_js(self.0.identify(experiment, &mut |stage| report_stage(progress, stage)))
    }

    /// An experiment with remedies of its findings.
    ///
    /// # Errors
    /// A code that no remedy has, or an experiment that has no place for it.
    pub fn apply(&self, experiment: &str, remedies: &str, codes: &str) -> Outcome<String> {
        to_js(self.0.apply(experiment, remedies, codes))
    }

    /// What a run changed against the run before.
    ///
    /// # Errors
    /// Texts that are not results.
    pub fn changed(&self, before: &str, after: &str) -> Outcome<String> {
        to_js(self.0.changed(before, after))
    }

    /// Puts the files of a sample into the folder, and returns its request, and its experiment if it has one.
    ///
    /// # Errors
    /// A sample of another name.
    pub fn sample(&mut self, name: &str) -> Outcome<String> {
        to_js(self.0.sample(name))
    }

    /// The identified robot of a `results.json` as a file.
    ///
    /// # Errors
    /// The errors of the command `export`.
    pub fn export(&self, results: &str, format: &str, untrusted: bool) -> Outcome<String> {
        to_js(self.0.export(results, format, untrusted))
    }

    /// The bodies of the identified robot of a `results.json`.
    ///
    /// # Errors
    /// The errors of the command `export`.
    pub fn bodies(&self, results: &str) -> Outcome<String> {
        to_js(self.0.bodies(results))
    }

    /// The URDF of a robot; empty for a robot of another format.
    ///
    /// # Errors
    /// A file that is no robot.
    pub fn urdf(&self, path: &str) -> Outcome<String> {
        to_js(self.0.urdf(path))
    }
}

/// Starts threads, once per memory: waits until as many other workers have called `serve_thread`.
///
/// # Errors
/// Threads already exist.
#[cfg(all(target_family = "wasm", target_os = "unknown"))]
#[wasm_bindgen]
pub fn start_threads(count: usize) -> Outcome<()> {
    to_js(threads::start(count))
}

/// Works as a thread for the lifetime of the worker.
#[cfg(all(target_family = "wasm", target_os = "unknown"))]
#[wasm_bindgen]
pub fn serve_thread() {
    threads::serve();
}

/// The message of the last panic, after which the module must not be used; empty without a panic.
#[wasm_bindgen]
#[must_use]
pub fn last_panic() -> String {
    LAST_PANIC.lock().map_or_else(|held| held.into_inner().clone(), |text| text.clone())
}

static LAST_PANIC: Mutex<String> = Mutex::new(String::new());

fn keep_panics() {
    std::panic::set_hook(Box::new(|panic| {
        if let Ok(mut text) = LAST_PANIC.lock() {
            *text = panic.to_string();
        }
    }));
}

/// Reports a stage. Errors of the page's function are ignored.
fn report_stage(progress: &js_sys::Function, stage: &str) {
    let _ = progress.call1(&JsValue::NULL, &JsValue::from_str(stage));
}
