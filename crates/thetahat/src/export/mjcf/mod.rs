//! MuJoCo's model files: new ones, a user's own with other inertias and friction, and both read back.

mod defaults;
mod edited;
mod element;
mod error;
mod loops;
mod matched;
mod model;
mod read;
mod servos;
mod settings;
mod tree;
mod written;

pub use error::MjcfError;
pub use model::MjcfModel;

pub(super) use edited::edited;
pub(super) use read::read;
pub(super) use servos::Servos;
pub(super) use written::mjcf;
