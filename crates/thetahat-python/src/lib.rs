//! The compiled part of thetahat for Python: arrays in, results out. Its users see only the Python package, which
//! checks and documents; here are the calls of the library, without the interpreter's lock.
//!
//! Long work runs in a thread of its own, so that Ctrl-C is answered ([`interruptible`]); work on arrays is done in pieces
//! between which signals are checked ([`arrays`]). Errors keep the library's texts ([`raised`]).

mod arrays;
mod distributed;
mod estimation;
mod identification;
mod interruptible;
mod python_error;
mod recording;
mod remedies;
mod results;
mod robot;
mod signal;
mod simulation;
mod values;

use std::ffi::OsString;

use pyo3::prelude::*;

/// Runs the command `thetahat`; the first argument is the name of the program. Returns the exit code.
#[pyfunction]
fn command(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| thetahat_cli::run(arguments))
}

/// The compiled part of thetahat.
#[pymodule]
mod _thetahat {
    #[pymodule_export]
    use super::{
        command,
        distributed::{
            Bench, campaign_texts, chi_squared_probability, experiment_texts, f_probability, finish_campaign,
            instruments_of, merge, recording_spans, reduce, run_texts, solve, t_quantile,
        },
        estimation::{Fit, estimate, measurement_vector, observation_matrix},
        identification::{choose_filter, identify, require_method, run},
        recording::read_recordings,
        results::Results,
        robot::Robot,
        signal::{band_pass, decimate, derivative, zero_phase},
        simulation::simulate,
    };

    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");
}
