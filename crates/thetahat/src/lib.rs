//! Identification of the dynamic parameters of robots from recorded motion and torques.
//!
//! A robot's torque model is linear in its dynamic parameters, `tau = phi(q, dq, ddq) theta`. From a robot description and
//! arrays of positions and torques to estimates with intervals, without a file:
//!
//! ```
//! use thetahat::{ControllerDescription, Identification, Method, Recording, Robot, Settings};
//!
//! # const URDF: &str = r#"<robot name="pendulum"><link name="base"/><link name="arm"><inertial><origin xyz="0.3 0 0"/>
//! #   <mass value="2"/><inertia ixx="0.01" iyy="0.05" izz="0.05" ixy="0" ixz="0" iyz="0"/></inertial></link>
//! #   <joint name="shoulder" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/>
//! #   <limit lower="-3" upper="3" effort="50" velocity="5"/></joint></robot>"#;
//! # use std::path::Path;
//! # use thetahat::series::{Series, SeriesError};
//! # // 10 s at 1 kHz: tau = 0.23 ddq - 5.886 cos q + 0.4 dq + 0.6 sign(dq), with noise on the torque.
//! # fn logged() -> Result<(f64, Series, Series), SeriesError> {
//! #     let (w, a) = ([1.7_f64, 4.1], [0.7_f64, 0.15]);
//! #     let (mut q, mut tau) = (Vec::new(), Vec::new());
//! #     for k in 0..10_000 {
//! #         let t = 1e-3 * f64::from(k);
//! #         let wave = |f: &dyn Fn(f64, f64) -> f64| f(a[0], w[0]) + f(a[1], w[1]);
//! #         let x = wave(&|a, w| a * (1.0 - (w * t).cos()));
//! #         let (v, acc) = (wave(&|a, w| a * w * (w * t).sin()), wave(&|a, w| a * w * w * (w * t).cos()));
//! #         let noise = 0.1 * ((12.9898 * f64::from(k)).sin() * 43758.5453).fract();
//! #         q.push(x);
//! #         tau.push(0.23 * acc - 5.886 * x.cos() + 0.4 * v + 0.6 * v.signum() + noise);
//! #     }
//! #     Ok((1000.0, Series::from_values(1, q)?, Series::from_values(1, tau)?))
//! # }
//! let robot = Robot::parse(URDF, Path::new("pendulum.urdf"))?;
//! let (rate_hz, positions, torques) = logged()?; // one channel per joint, in rad and N m
//! let recording = Recording::new(rate_hz, positions.clone(), torques).with_reference(positions);
//! let settings = Settings::new(25.0, 10) // cut-off of the position filter in Hz, decimation
//!     .with_methods([Method::IDIM_LS, Method::IDIM_IV])
//!     .with_controller(ControllerDescription::pd(10.0));
//! let results = Identification::new(&robot, vec![recording], settings)?.run()?;
//! for run in &results.runs {
//!     for parameter in &run.parameters {
//!         println!("{}: {} = {} {}", run.method, parameter.name, parameter.estimate, parameter.unit);
//!         println!("    95 % within {:?}", parameter.interval_95);
//!     }
//! }
//! # for method in [Method::IDIM_LS, Method::IDIM_IV] {
//! #     let run = results.run("nominal", method).unwrap();
//! #     for (name, truth) in [("fv1", 0.4), ("fc1", 0.6)] {
//! #         let found = run.parameter(name).unwrap().estimate;
//! #         assert!((found - truth).abs() < 0.02, "{method} {name}: {found}");
//! #     }
//! # }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The rooms follow the way of the data, from the robot and the recording to the report; a room uses only rooms listed
//! above it. A file that describes a run is read by [`experiment`], and lowers to the same.

pub use thetahat_data::recording;
pub use thetahat_estimation::{
    checks, control, identification, regression, signal, simulation, statistics, trajectory,
};
pub use thetahat_ground::{
    clock, digest, files, linear_algebra, number, one_or_each, output, pool, real, series, vector, visible,
};
pub use thetahat_model::{
    base_parameters, collision, consistency, dynamics, regressor, robot, robot_summary, symbolic,
};
pub use thetahat_report::{report, results};

pub mod preparation;

pub mod filter_choice;

mod scheduling;

mod diagnosis;

pub mod run;

pub mod experiment;

pub mod campaign;

pub mod reduction;

pub mod design;
pub mod export;

pub use control::ControllerDescription;
pub use experiment::Experiment;
pub use identification::Method;
pub use preparation::{Recording, Settings};
pub use results::Results;
pub use robot::Robot;
pub use run::Identification;
pub use thetahat_ground::one_or_each::OneOrEach;
