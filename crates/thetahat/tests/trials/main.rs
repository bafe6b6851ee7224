//! Tests whose number is known when they run, and those on recorded data, in one program: it links the library once.
//!
//! A test is `MODULE::NAME`; where the data that it reads is absent, it counts as ignored.

mod base_parameter_counts;
mod clean_records;
mod consistency_reference;
// Shared with the studies, which use other parts of it.
#[allow(dead_code)]
mod corruption_suite;
mod corruptions;
mod defects;
mod design_reference;
mod design_tx40;
mod dynamics_reference;
mod generated_code;
mod model;
mod models;
mod prediction_error;
mod recorded_emps;
mod recorded_others;
mod recorded_tx40;
mod recordings;
mod reduction;
mod signal_reference;
mod trajectory_record;

use libtest_mimic::Arguments;
use thetahat_testing::Module;

const MODULES: [Module; 19] = [
    ("base_parameter_counts", base_parameter_counts::all_trials),
    ("clean_records", clean_records::all_trials),
    ("consistency_reference", consistency_reference::all_trials),
    ("corruptions", corruptions::all_trials),
    ("defects", defects::all_trials),
    ("design_reference", design_reference::all_trials),
    ("design_tx40", design_tx40::all_trials),
    ("dynamics_reference", dynamics_reference::all_trials),
    ("generated_code", generated_code::all_trials),
    ("model", model::all_trials),
    ("models", models::all_trials),
    ("prediction_error", prediction_error::all_trials),
    ("recorded_emps", recorded_emps::all_trials),
    ("recorded_others", recorded_others::all_trials),
    ("recorded_tx40", recorded_tx40::all_trials),
    ("recordings", recordings::all_trials),
    ("reduction", reduction::all_trials),
    ("signal_reference", signal_reference::all_trials),
    ("trajectory_record", trajectory_record::all_trials),
];

fn main() {
    thetahat_testing::run_modules(Arguments::from_args(), &MODULES)
}
