use crate::base_parameters::BaseParametersError;

/// Why no code is generated.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SymbolicError {
    /// The base parameters are not clear.
    #[error("{0}")]
    BaseParameters(#[from] BaseParametersError),
    /// A torque term of the robot has no form in generated code.
    #[error(
        "the torque term of `{parameter}` has no form in generated code; take [[term]] out of the robot's description, or \
         generate --model mass-matrix, gravity, coriolis, forward-kinematics or jacobian, which it does not change"
    )]
    Term {
        /// Its parameter.
        parameter: String,
    },
    /// Parameters of other number than the model has.
    #[error("{found} parameter values, and the model has {expected}; give one for each")]
    Values {
        /// Those given.
        found: usize,
        /// Those of the model.
        expected: usize,
    },
    /// The robot states no parameters.
    #[error(
        "{robot}: states no parameter values; give --parameters symbolic, a results.json, or values under [parameters]"
    )]
    NoValues {
        /// The robot.
        robot: String,
    },
    /// A name from which no identifier can be made.
    #[error("`{name}` gives no name that C, Rust, Python and MATLAB can have; give one with --name, such as arm")]
    NoIdentifier {
        /// The name.
        name: String,
    },
    /// A name given by the user that C cannot have.
    #[error("`{name}` is no name that C, Rust, Python and MATLAB can have; use letters, digits and _, a letter first")]
    NotAnIdentifier {
        /// The name.
        name: String,
    },
}
