//! Robots from MJCF, the format of MuJoCo (<https://mujoco.readthedocs.io/en/stable/XMLreference.html>).
//!
//! The reader follows MuJoCo's compiler: classes of `<default>`, `<frame>`, every notation of an orientation, `<inertial>` or the
//! inertia of geoms, the bounds of `<compiler>`. Bodies without joints are part of the body that carries them. The frame of the
//! base is that of the world. The coordinates are MuJoCo's `qpos`, in the order of the bodies, depth first.
//!
//! A joint's `armature` is the a-priori motor inertia, with `gear^2 armature` of each actuator; `damping` is viscous friction and
//! `frictionloss` Coulomb friction. A `stiffness` is the term `joint-spring`, and damping by the square and the cube of
//! the velocity the term `polynomial-viscous`. The gear of an actuator is its row of the transmission. An equality of two
//! joints makes one follow the other.
//!
//! A body with a free joint is fixed where the model places it. What a [`Robot`](crate::robot::Robot) cannot hold is among its
//! doubts; closed loops, ball joints and meshes whose mass counts are refused. Text of an `<include>` is joined to that of
//! the file, and places in messages stay those of the files.

mod actuators;
mod assembly;
mod classes;
mod compiler;
mod element;
mod equality;
mod error;
mod inertia;
mod joined;
mod joint;
mod loops;
mod notes;
mod pose;
mod principal;
mod reader;
mod shape;
mod terms;
mod world;

pub use error::MjcfError;

pub(super) use joined::{Origins, join};
pub(super) use reader::{is_mjcf, read};

#[cfg(test)]
mod tests;
