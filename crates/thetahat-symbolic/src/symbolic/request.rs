//! The request for a generated function.

use super::graph::Array;
use thetahat_model::{dynamics::FrictionTransition, robot::Quantity};

/// A model of a robot as a function.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ModelKind {
    /// Torques of a motion.
    InverseDynamics,
    /// Their derivatives with respect to positions, velocities and accelerations: three blocks of columns.
    InverseDynamicsDerivatives,
    /// The mass matrix, row by row.
    MassMatrix,
    /// Accelerations of torques.
    ForwardDynamics,
    /// The matrix that gives the torques of a motion by the parameters, row by row.
    Regressor,
    /// Torques of gravity.
    Gravity,
    /// Centrifugal and Coriolis torques.
    Coriolis,
    /// Frames of the tips in the frame of the base: three rows of rotation and origin.
    ForwardKinematics,
    /// Jacobians of the tips in the frame of the base: six rows, the angular velocity first.
    Jacobian,
}

/// The parameters of a function.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ParameterSet {
    /// The standard parameters, in the order of the robot's table.
    Standard,
    /// The base parameters.
    Base,
}

/// The torques of the drives in a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DriveTorques {
    /// Inertia of the motors, friction and offsets.
    All,
    /// Only the inertia of the motors.
    Inertia,
    /// None: only the links.
    None,
}

/// A request for a generated function.
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// The model.
    pub model: ModelKind,
    /// Its parameters.
    pub parameters: ParameterSet,
    /// Values of the standard parameters, SI and in the order of the robot's table, inserted into the code; if none, the
    /// parameters are an input of the function.
    pub values: Option<Vec<f64>>,
    /// The torques of the drives that it includes.
    pub drives: DriveTorques,
    /// Where the parameters come from, a line each, for the head of the code.
    pub about: Vec<String>,
    /// Velocities v of `tanh(dq / v)` in place of the sign of a velocity; none for the sign itself.
    pub friction_transition: Option<FrictionTransition>,
}

impl Request {
    /// A model with all torques of the drives and its parameters as an input.
    #[must_use]
    pub fn new(model: ModelKind, parameters: ParameterSet) -> Self {
        Self {
            model,
            parameters,
            values: None,
            drives: DriveTorques::All,
            about: Vec::new(),
            friction_transition: None,
        }
    }
}

impl DriveTorques {
    /// All choices, with their names on the command line.
    pub const ALL: [(&'static str, Self); 3] = [("all", Self::All), ("inertia", Self::Inertia), ("none", Self::None)];

    /// Whether the torque of a parameter is included; torques of links always are.
    pub(super) fn contain(self, quantity: Quantity) -> bool {
        match (self, quantity) {
            (_, Quantity::Link(_)) | (Self::All, _) => true,
            (Self::Inertia, _) => quantity.is_motor_inertia(),
            (Self::None, _) => false,
        }
    }
}

impl ModelKind {
    /// All models, with their names on the command line.
    pub const ALL: [(&'static str, Self); 9] = [
        ("idm", Self::InverseDynamics),
        ("idm-derivatives", Self::InverseDynamicsDerivatives),
        ("mass-matrix", Self::MassMatrix),
        ("ddm", Self::ForwardDynamics),
        ("regressor", Self::Regressor),
        ("gravity", Self::Gravity),
        ("coriolis", Self::Coriolis),
        ("forward-kinematics", Self::ForwardKinematics),
        ("jacobian", Self::Jacobian),
    ];

    /// Its name in code.
    #[must_use]
    pub fn identifier(self) -> &'static str {
        match self {
            Self::InverseDynamics => "inverse_dynamics",
            Self::InverseDynamicsDerivatives => "torque_derivatives",
            Self::MassMatrix => "mass_matrix",
            Self::ForwardDynamics => "forward_dynamics",
            Self::Regressor => "regressor",
            Self::Gravity => "gravity",
            Self::Coriolis => "coriolis",
            Self::ForwardKinematics => "forward_kinematics",
            Self::Jacobian => "jacobian",
        }
    }

    /// The arrays that the function takes, except the parameters.
    #[must_use]
    pub fn inputs(self) -> &'static [Array] {
        match self {
            Self::InverseDynamics | Self::InverseDynamicsDerivatives | Self::Regressor => {
                &[Array::Position, Array::Velocity, Array::Acceleration]
            }
            Self::ForwardDynamics => &[Array::Position, Array::Velocity, Array::Torque],
            Self::Coriolis => &[Array::Position, Array::Velocity],
            Self::MassMatrix | Self::Gravity | Self::ForwardKinematics | Self::Jacobian => &[Array::Position],
        }
    }

    /// Whether the values of the parameters act on the output.
    #[must_use]
    pub fn takes_parameters(self) -> bool {
        match self {
            Self::InverseDynamics
            | Self::InverseDynamicsDerivatives
            | Self::MassMatrix
            | Self::ForwardDynamics
            | Self::Gravity
            | Self::Coriolis => true,
            Self::Regressor | Self::ForwardKinematics | Self::Jacobian => false,
        }
    }

    /// Whether the output is a vector, not a matrix that may have one column.
    pub(super) fn is_vector(self) -> bool {
        match self {
            Self::InverseDynamics | Self::ForwardDynamics | Self::Gravity | Self::Coriolis => true,
            Self::InverseDynamicsDerivatives
            | Self::MassMatrix
            | Self::Regressor
            | Self::ForwardKinematics
            | Self::Jacobian => false,
        }
    }

    /// Whether it has parameters, as inputs or as columns.
    pub(super) fn has_parameters(self) -> bool {
        match self {
            Self::InverseDynamics
            | Self::InverseDynamicsDerivatives
            | Self::MassMatrix
            | Self::ForwardDynamics
            | Self::Regressor
            | Self::Gravity
            | Self::Coriolis => true,
            Self::ForwardKinematics | Self::Jacobian => false,
        }
    }

    pub(super) fn has_drive_torques(self) -> bool {
        match self {
            Self::InverseDynamics | Self::InverseDynamicsDerivatives | Self::ForwardDynamics | Self::Regressor => true,
            Self::MassMatrix | Self::Gravity | Self::Coriolis | Self::ForwardKinematics | Self::Jacobian => false,
        }
    }
}
