//! The answers of the session.

mod channels;
mod exported;
mod identified;
mod proposed;
mod sample;
mod series;
mod skeleton;
mod understanding;

pub(crate) use exported::Exported;
pub(crate) use identified::Identified;
pub(crate) use sample::Sample;
pub(crate) use understanding::Understanding;
