//! Rigid-body dynamics of a serial robot with friction, motor inertia and coupled motors.
//!
//! [`Model`] is constant, [`Workspace`] is scratch: no function here allocates. Every algorithm is linear in the
//! dynamic parameters and needs nothing of them but numbers, so an identified set that no rigid body could have is
//! used as it is; only the mass matrix must be positive definite, and [`Model::forward_dynamics`] says where it is not.
//!
//! Legend of the kernels (Khalil and Dombre, *Modeling, Identification and Control of Robots*, chapter 9):
//!
//! | letter | word | shape | unit |
//! | --- | --- | --- | --- |
//! | `q dq ddq` | joint positions and their derivatives | n | rad, rad/s, rad/s^2 (m for prismatic joints) |
//! | `tau` | joint torques | n | N m (N) |
//! | `r` | rotation from frame j to frame j-1 | 3 x 3 | |
//! | `p` | origin of frame j in frame j-1 | 3 | m |
//! | `w dw` | angular velocity and acceleration of link j, in frame j | 3 | rad/s, rad/s^2 |
//! | `dv` | acceleration of the origin of frame j less gravity, in frame j | 3 | m/s^2 |
//! | `inertia ms m` | inertia about the origin of frame j, first moments, mass | 3 x 3, 3, 1 | kg m^2, kg m, kg |

mod algorithms;
mod model;
mod parameters;
mod vector;

pub use algorithms::Workspace;
pub use model::{CoupledMotor, DynamicsError, Model};
pub use parameters::{DynamicParameters, Sign};

pub(crate) use algorithms::{LinkMotion, Twist};
pub(crate) use vector::{add, cross, dot};
