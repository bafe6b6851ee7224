//! Our TOML description: joints in Denavit-Hartenberg form, or a URDF or MJCF, with transmission, friction model, gravity and a-priori
//! parameters.

mod bounds;
mod embedding;
mod file;
mod joints;
mod loops;
mod reader;
mod transmission;

pub(super) use embedding::{Urdf, has_embedded_urdf, urdf_of, with_embedded_urdf};
pub(super) use reader::{Underlying, read};

#[cfg(test)]
mod tests;
