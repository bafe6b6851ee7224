//! The identified robot as a file that simulators and controllers read: URDF, MJCF, SDF or plain JSON; or its drives alone, as PACE,
//! Isaac Lab and BAM read them.
//!
//! Base parameters are not link inertias. [`IdentifiedModel`] takes the physically consistent standard parameters nearest to
//! the a-priori ones (log-det) that keep the base parameters at their estimates, or within their intervals;
//! [`IdentifiedModel::export`] writes them, and says what moved and what the format cannot say. [`export_robot`] does so for
//! any standard parameters. How bodies are split, and what each format says: `docs/manual/use_the_result.md`.
//!
//! ```
//! use std::path::Path;
//! use thetahat::{Robot, export::{ExportFormat, export_robot}};
//!
//! let text = "name = 'pendulum'\n[[joint]]\nname = 'pivot'\nkind = 'revolute'\n[parameters]\nm1 = 2\nmx1 = 0.2\n\
//!             xx1 = 0.01\nyy1 = 0.05\nzz1 = 0.05\nfv1 = 0.3\nia1 = 0.1";
//! let robot = Robot::parse(text, Path::new("pendulum.toml"))?;
//! let export = export_robot(&robot, None, &robot.a_priori_parameters(), ExportFormat::Urdf, &[])?;
//! // Torques of the file, read back, at 1000 random states.
//! assert!(export.check()? < 1e-9);
//! // URDF has no motor inertia.
//! assert!(export.not_represented[0].contains("ia1 = 0.1"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod actuators;
mod body;
mod check;
mod choice;
mod coupling;
mod editor;
mod error;
mod format;
mod frames;
mod header;
mod identified;
mod json;
mod mjcf;
mod pd_loop;
mod posterior;
mod provenance;
mod read_back;
mod render;
mod represented;
mod samples;
mod sdf;
mod sdf_read;
mod sidecar;
mod split;
mod spread;
mod uncertainty;
mod urdf_edit;
mod urdf_new;
mod words;
mod xml;

pub use error::ExportError;
pub use format::ExportFormat;
pub use identified::IdentifiedModel;
#[doc(hidden)]
pub use mjcf::MjcfError;
pub use mjcf::MjcfModel;
#[doc(hidden)]
pub use provenance::{AdjustedParameter, Provenance};
pub use render::{Export, Target, export_robot};
#[doc(hidden)]
pub use samples::Sample;
