//! Rigid-body dynamics of a robot, serial or a tree, with friction, motor inertia and coupled motors.
//!
//! [`Model`] is constant, [`Workspace`] is scratch: no function here allocates. Every algorithm is linear in the dynamic
//! parameters and accepts any numbers, also an identified set that is physically impossible; only the mass matrix must be
//! positive definite, and [`Model::forward_dynamics`] reports where it is not.
//!
//! Legend of the kernels (Khalil and Dombre, *Modeling, Identification and Control of Robots*, chapter 9):
//!
//! | letter | word | shape | unit |
//! | --- | --- | --- | --- |
//! | `q dq ddq` | joint positions and their derivatives | n | rad, rad/s, rad/s^2 (m for prismatic joints) |
//! | `tau` | joint torques | n | N m (N) |
//! | `r` | rotation from frame j to its parent's frame | 3 x 3 | |
//! | `p` | origin of frame j in its parent's frame | 3 | m |
//! | `w dw` | angular velocity and acceleration of link j, in frame j | 3 | rad/s, rad/s^2 |
//! | `dv` | acceleration of the origin of frame j less gravity, in frame j | 3 | m/s^2 |
//! | `inertia ms m` | inertia about the origin of frame j, first moments, mass | 3 x 3, 3, 1 | kg m^2, kg m, kg |
//!
//! A joint that follows another (a mimic) moves by `ratio q + offset` of the other's coordinate, and its torque acts on that
//! coordinate times the ratio: with the ratios in a matrix `G`, `tau = G^T tau_joints` and `M = G^T M_joints G`.
//!
//! ```
//! use std::path::Path;
//! use thetahat_model::{dynamics::{DynamicParameters, Model, Workspace}, robot::Robot};
//! let text = "name = 'pendulum'\n[[joint]]\nname = 'pivot'\nkind = 'revolute'\n[parameters]\nzz1 = 0.5\nia1 = 0.3";
//! let robot = Robot::parse(text, Path::new("pendulum.toml"))?;
//! let model = Model::new(&robot);
//! let parameters = DynamicParameters::new(&model, &robot.a_priori_parameters())?;
//! let mut mass = [0.0];
//! model.mass_matrix(&parameters, &[0.1], &mut Workspace::new(&model), &mut mass);
//! assert!((mass[0] - (0.5 + 0.3)).abs() < 1e-15);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod adjoint;
#[cfg(test)]
mod branch_tests;
mod coupled_motor;
mod damping;
mod energy;
#[cfg(test)]
mod follower_tests;
mod forward_dynamics;
mod frames;
mod geometry;
mod inertial;
mod inverse_dynamics;
mod jacobian;
mod jump;
mod loops;
mod mass_matrix;
mod model;
mod motion;
#[cfg(test)]
mod mujoco_reference;
mod one_state;
mod parameters;
mod propagation;
mod rotation;
mod series;
mod sign;
mod solve;
mod state;
#[cfg(test)]
mod sum_tests;
mod term_columns;
#[cfg(test)]
mod term_tests;
mod term_torques;
mod terms;
mod twist;
mod workspace;
mod wrenches;

pub use coupled_motor::CoupledMotor;
pub(crate) use frames::JointFrame;
pub use jump::Jump;
pub(crate) use loops::DIFFERENCES;
pub use model::{DynamicsError, Model};
pub use parameters::DynamicParameters;
pub use sign::{FrictionTransition, Sign};
pub use state::{JointCoordinate, State};
pub(crate) use workspace::LoopScratch;
pub use workspace::Workspace;
#[doc(hidden)]
pub use wrenches::Wrench;

pub(crate) use adjoint::{Adjoint, LinkAdjoint};
#[doc(hidden)]
pub use damping::DampingWorkspace;
#[doc(hidden)]
pub use jacobian::Jacobian;
pub(crate) use motion::LinkMotion;
pub(crate) use series::gather;
#[doc(hidden)]
pub use solve::{factorise, multiply_factors, solve_factorised};
#[doc(hidden)]
pub use term_torques::LEAST_GAS;
pub(crate) use twist::Twist;
