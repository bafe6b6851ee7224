//! The criterion with its derivatives, the optimiser, and the searches.

pub(in crate::design) mod criterion;
pub(in crate::design) mod crossing;
pub(in crate::design) mod information;
pub(in crate::design) mod optimiser;
pub(in crate::design) mod problem;
pub(in crate::design) mod searches;
pub(in crate::design) mod starts;
pub(in crate::design) mod watch;
