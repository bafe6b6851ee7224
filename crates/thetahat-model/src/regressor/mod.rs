//! The observation matrix `phi` of the torque model, `tau = phi(q, dq, ddq) theta` (3).
//!
//! Only the entries that can differ from zero are computed: a parameter of link k acts on the coordinates that move the
//! link, a parameter of joint j acts on its own coordinate (or on the coordinate of the joint it follows), a parameter
//! of a coupled motor acts on the coordinates that move it.
//!
//! ```
//! use std::path::Path;
//! use thetahat_ground::series::Series;
//! use thetahat_model::{dynamics::{Model, Sign}, regressor::Regressor, robot::Robot};
//! let text = "name = 'pendulum'\n[[joint]]\nname = 'pivot'\nkind = 'revolute'\n";
//! let robot = Robot::parse(text, Path::new("pendulum.toml"))?;
//! let model = Model::new(&robot);
//! // Viscous friction: its entry of phi is the velocity.
//! let column = model.parameter_table().index_of("fv1").into_iter().collect::<Vec<_>>();
//! let [q, dq, ddq] = [0.1, 0.2, 0.3].map(|value| Series::from_values(1, vec![value]));
//! let (q, dq, ddq) = (q?, dq?, ddq?);
//! let phi = Regressor::new(&model, &column).evaluate_series(&model, &q, &dq, &ddq, Sign::Exact);
//! assert_eq!(phi.values(), [0.2]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod batch;
mod inertial;
mod loops;
mod observation;
mod slopes;

pub use batch::BufferedRegressor;
pub use observation::{Entry, Regressor};
