//! Identification of the dynamic parameters of robots from recorded motion and torques.
//!
//! A robot's torque model is linear in its dynamic parameters, `tau = phi(q, dq, ddq) theta`. From a robot description and
//! arrays of positions and torques to estimates with intervals, without a file:
//!
//! ```
//! use thetahat::{ControllerDescription, Identification, Method, Recording, Robot, Series, Settings};
//!
//! # const URDF: &str = r#"<robot name="pendulum"><link name="base"/><link name="arm"><inertial><origin xyz="0.3 0 0"/>
//! #   <mass value="2"/><inertia ixx="0.01" iyy="0.05" izz="0.05" ixy="0" ixz="0" iyz="0"/></inertial></link>
//! #   <joint name="shoulder" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/>
//! #   <limit lower="-3" upper="3" effort="50" velocity="5"/></joint></robot>"#;
//! # use std::path::Path;
//! # // 10 s at 1 kHz: tau = 0.23 ddq - 5.886 cos q + 0.4 dq + 0.6 sign(dq), with noise on the torque.
//! # fn logged() -> Result<(f64, Series, Series), thetahat::SeriesError> {
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
//! # The way of the data
//!
//! | step | modules |
//! | --- | --- |
//! | The robot | [`robot`], [`dynamics`], [`regressor`], [`base_parameters`], [`consistency`], [`symbolic`] |
//! | The recording | [`recording`], [`signal`], [`preparation`], [`checks`], [`filter_choice`] |
//! | The closed loop | [`control`], [`trajectory`], [`simulation`] |
//! | The estimates | [`regression`], [`identification`], [`statistics`], [`Identification`] |
//! | The results | [`results`], [`report`], [`export`] |
//! | From files, and many runs | [`experiment`], [`campaign`], [`reduction`], [`design`] |
//!
//! [`Series`] and [`Matrix`] hold all arrays. Every error converts to [`enum@Error`]. Six programs are in the manual:
//! `docs/manual/rust.md`.

// What the modules that are left out would use.
#![cfg_attr(not(all(feature = "campaign", feature = "design", feature = "export")), allow(dead_code, unused_imports))]

/// A robot: its joints and transmission, from URDF or TOML, and the table of its standard parameters.
pub mod robot {
    #[doc(inline)]
    #[doc(hidden)]
    pub use thetahat_model::robot::XacroOptions;
    #[doc(inline)]
    pub use thetahat_model::robot::{
        DenavitHartenberg, Friction, Joint, JointKind, Limits, LockError, LockedJoint, Locks, Mimic, Parameter,
        ParameterTable, Placement, Quantity, RobotError, RobotSource, Share, Transmission,
    };
    pub use thetahat_model::robot_summary::{FrameJoint, MovingFrames, RobotSummary};
}

/// Channels of a log: text, NumPy, MATLAB, Parquet and ROS 2 bags; their units and clock.
pub mod recording {
    #[doc(inline)]
    pub use thetahat_data::recording::{
        ChannelSource, ColumnSummary, Contents, Dialect, Format, RecordingError, Resampling, Side, Unit, inspect,
        inspect_with_time, read_channels,
    };
}

/// Inverse and forward dynamics, mass matrix and energy, without allocation.
pub mod dynamics {
    #[doc(inline)]
    pub use thetahat_model::dynamics::{
        DynamicParameters, DynamicsError, FrictionTransition, Model, Sign, State, Workspace,
    };
}

/// The regressor `phi` of `tau = phi(q, dq, ddq) theta`.
pub mod regressor {
    #[doc(inline)]
    pub use thetahat_model::regressor::{BufferedRegressor, Entry, Regressor};
}

/// The parameters that torques depend on, and how they are regrouped.
pub mod base_parameters {
    #[doc(inline)]
    pub use thetahat_model::base_parameters::{BaseParameter, BaseParameters, BaseParametersError};
}

/// Physically consistent parameters: the set, and estimates in it.
pub mod consistency {
    #[doc(inline)]
    pub use thetahat_model::consistency::{
        ConsistencyError, ConsistentFit, ConsistentSet, Examination, Known, LeastSquares, Prior, Symmetric,
        completed_a_priori, examine, fit,
    };
}

/// Models as code in C, Rust, Python, MATLAB and LaTeX.
#[cfg(feature = "symbolic")]
pub mod symbolic {
    #[doc(inline)]
    pub use thetahat_symbolic::symbolic::{
        BaseFormulas, DriveTorques, Function, Language, ModelKind, ParameterSet, Request, SymbolicError,
    };
}

/// Filters without phase, derivatives and decimation.
pub mod signal {
    #[doc(inline)]
    pub use thetahat_estimation::signal::{
        Decimator, Derivative, Motion, Padding, SecondOrderSections, SignalError, band_pass, central_difference,
        zero_phase,
    };
}

/// Point-to-point moves and Fourier series.
pub mod trajectory {
    #[doc(inline)]
    pub use thetahat_estimation::trajectory::{
        FourierSeries, MotionLimits, Move, Moves, Periodic, TrajectoryError, plan,
    };
}

/// Controllers, as data or as a law of your own.
pub mod control {
    #[doc(inline)]
    pub use thetahat_estimation::control::{ControlLaw, Controller, ControllerError, Law, LawInput, VelocityEstimate};
}

/// The closed loop of robot and controller, its sensitivities, and how a simulator is biased.
pub mod simulation {
    #[doc(inline)]
    pub use thetahat_estimation::simulation::{
        BiasKind, ClosedLoop, OutputGrid, PeriodicReference, Reference, SampledReference, SensitiveTo, Sensitivities,
        Sensors, SimulatedMotion, SimulationError, SimulatorBias, Solver,
    };
}

/// Rows `X`, `y` with their weights and layout.
pub mod regression {
    #[doc(inline)]
    pub use thetahat_estimation::regression::{InstrumentalVariables, Regression, RowLayout, relative_error_percent};
}

/// Covariances and tests.
pub mod statistics {
    #[doc(inline)]
    pub use thetahat_estimation::statistics::{
        ChiSquaredTest, FTest, Sandwich, chi_squared_test, f_probability, f_test, t_quantile,
    };
}

/// The estimators, and an estimator of your own.
pub mod identification {
    #[doc(inline)]
    pub use thetahat_estimation::identification::{
        Assembly, EstimationError, Fit, Needs, Outcome, Response, SimulatedResponse, Status, Uncertainty,
        UnknownMethod, UserError, UserEstimate, UserEstimator, UserRegression, Weighting, idim_iv, idim_ls,
        uncertainty,
    };
}

/// What is wrong with a recording: findings with a code.
pub mod checks {
    #[doc(inline)]
    pub use thetahat_estimation::checks::{Code, Finding, Severity};
}

/// What a run yields, as plain data.
pub mod results {
    #[doc(hidden)]
    pub use thetahat_report::results::NOMINAL;
    #[doc(inline)]
    pub use thetahat_report::results::{
        CampaignResults, Card, DesignResults, JointResult, ModelResult, NotExamined, ParameterResult, Prediction,
        ProfiledTerm, ReasonCode, RecordingFindings, ResultsError, RunResult, SideBySide, Verdict, VerdictReason,
    };
}

/// Results as text, HTML, JSON and CSV.
#[cfg(feature = "report")]
pub mod report {
    #[doc(inline)]
    pub use thetahat_report::report::{Published, ReportError, card_text, file_names, model_text, render, write_all};
}

pub mod preparation;

pub mod filter_choice;

mod scheduling;

mod diagnosis;

#[doc(hidden)]
pub mod run;

pub mod experiment;

#[cfg(feature = "campaign")]
pub mod campaign;

pub mod reduction;

#[cfg(feature = "design")]
pub mod design;
#[cfg(feature = "export")]
pub mod export;

#[doc(hidden)]
pub mod watch;

mod error;

pub use error::Error;
#[doc(inline)]
pub use experiment::Experiment;
#[doc(inline)]
pub use preparation::{Recording, Settings};
#[doc(inline)]
pub use run::Identification;
#[doc(inline)]
pub use thetahat_estimation::control::ControllerDescription;
#[doc(inline)]
pub use thetahat_estimation::identification::Method;
#[doc(inline)]
pub use thetahat_ground::linear_algebra::Matrix;
#[doc(inline)]
pub use thetahat_ground::one_or_each::OneOrEach;
#[doc(inline)]
pub use thetahat_ground::series::{Series, SeriesError};
#[doc(inline)]
pub use thetahat_model::robot::Robot;
#[doc(inline)]
pub use thetahat_report::results::Results;

/// The programs of the manual and the README, which are compiled and run as documentation tests.
#[cfg(doctest)]
mod documents {
    #[doc = include_str!("../../../docs/manual/rust.md")]
    mod rust {}
    #[doc = include_str!("../../../README.md")]
    mod readme {}
}
