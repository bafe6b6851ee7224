//! The answers of the session.

mod channels;
mod ellipsoid;
mod exported;
mod identified;
mod proposed;
mod residual;
mod sample;
mod series;
mod skeleton;
mod understanding;

pub(crate) use ellipsoid::LinkBody;
pub(crate) use exported::Exported;
pub(crate) use identified::Identified;
pub(crate) use sample::Sample;
pub(crate) use understanding::Understanding;
