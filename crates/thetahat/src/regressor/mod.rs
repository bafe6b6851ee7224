//! The observation matrix `phi` of the torque model, `tau = phi(q, dq, ddq) theta` (3).
//!
//! Only the entries that can differ from zero are computed: a parameter of link k acts on joints 1 to k, one of joint j
//! on joint j alone, one of a coupled motor on the joints that move it.

mod observation;

pub use observation::{Entry, Regressor};
