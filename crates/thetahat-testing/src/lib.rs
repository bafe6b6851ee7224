//! What the tests of the crates share: temporary folders, runs of the program, the shared data, models of other programs, and assertions.
//!
//! Functions here panic on failure, except checks that return their failure.

mod assertions;
mod folder;
mod legs;
mod mcap;
mod mjcf;
mod noise;
mod program;
mod shared;
mod terms;

pub use assertions::{assert_close, ensure, ensure_printed};
pub use folder::Folder;
pub use legs::TWO_LEGS;
pub use mcap::{Cdr, mcap};
pub use mjcf::users_mjcf;
pub use noise::noise;
pub use program::{refused, run, shown, succeeded};
pub use shared::{
    Module, Named, data, each_night, has_shared, project, root, run_modules, shared, slow_trials, thinned,
    trials_on_shared_data,
};
pub use terms::ROBOT_WITH_TERMS;
