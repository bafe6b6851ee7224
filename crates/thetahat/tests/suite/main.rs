//! Tests of the library that need no recorded data, in one program: it links the library once.

mod actuators;
mod advice;
#[cfg(feature = "parquet")]
mod campaign;
mod closed_loop;
// Shared with the studies, which use other parts of it.
#[allow(dead_code)]
mod coverage;
mod demo;
mod described_arm;
mod design;
mod design_collision;
mod dynamics_identities;
mod ends_in_motion;
mod exports;
mod filter_choice;
mod floating;
mod followed_twin;
mod gaps;
mod hidden_bias;
mod lasting;
mod locked_joints;
#[cfg(feature = "parquet")]
mod long_parquet;
mod loops;

mod missing_values;
mod model;
mod models;
mod near_rest;
mod nist_strd;
mod not_separated;
mod open_loop;
mod operation_counts;
mod passive;
mod payload;
mod physical;
mod positions_alone;
mod reduced_model;
mod reductions_merged;
mod references;
mod report;
mod robustness;
mod sensitivities;
mod several_recordings;
mod smoother;
mod stiff_simulation;
mod torque_terms;
mod transition;
#[path = "../../examples/studies/twins/mod.rs"]
#[allow(dead_code)]
mod twins;
mod uncertain_parameters;
mod unpowered;
mod user_estimator;
mod verdict;
mod watch;
