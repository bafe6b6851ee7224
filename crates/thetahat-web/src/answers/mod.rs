//! The answers of the session.

mod channels;
mod demo;
mod exported;
mod identified;
mod proposed;
mod series;
mod skeleton;
mod understanding;

pub(crate) use demo::Demo;
pub(crate) use exported::Exported;
pub(crate) use identified::Identified;
pub(crate) use understanding::Understanding;
