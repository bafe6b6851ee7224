//! The observation matrix `phi` of the torque model, `tau = phi(q, dq, ddq) theta` (3).
//!
//! Only the entries that can differ from zero are computed: a parameter of link k acts on the coordinates that move the
//! link, one of joint j on its own coordinate (or that of the joint it follows), one of a coupled motor on the coordinates
//! that move it.

mod batch;
mod inertial;
mod observation;

pub use batch::BufferedRegressor;
pub use observation::{Entry, Regressor};
