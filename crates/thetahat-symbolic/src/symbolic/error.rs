use thetahat_model::base_parameters::BaseParametersError;

/// Why no code is generated.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SymbolicError {
    /// The base parameters are not unique.
    #[error("{0}")]
    BaseParameters(#[from] BaseParametersError),
    /// A joint follows several others.
    #[error(
        "joint `{joint}` follows several others, which generated code does not have; give each share of it a joint of its own: a \
         chain of joints that follow one each (docs/reference/robots.md)"
    )]
    FollowsSeveral {
        /// The joint.
        joint: String,
    },
    /// Loops of links move some of the joints.
    #[error(
        "the robot has loops of links, which generated code does not solve yet; `thetahat predict`, Python and Rust compute its torques"
    )]
    Loops,
    /// A torque term uses a recorded channel.
    #[error(
        "the torque term of `{parameter}` takes the recorded channel `{channel}`, which is no input of generated code; take the term \
         out of the robot's description, or generate a function that it does not change (mass matrix, gravity torques, Coriolis \
         matrix, forward kinematics or Jacobian)"
    )]
    Channel {
        /// The term's parameter.
        parameter: String,
        /// The channel.
        channel: String,
    },
    /// A torque term depends on accelerations, which direct dynamics computes.
    #[error(
        "the torque term of `{parameter}` takes accelerations, which direct dynamics would have to find from themselves; take the \
         term out of the robot's description, or generate the inverse dynamic model or the regressor"
    )]
    Acceleration {
        /// The term's parameter.
        parameter: String,
    },
    /// A user-defined expression cannot be written as generated code.
    #[error("the expression of `{parameter}` has no form in generated code: {problem}; write it with other operators")]
    Expression {
        /// The expression's parameter.
        parameter: String,
        /// Why.
        problem: String,
    },
    /// The number of parameter values differs from that of the model.
    #[error("{found} parameter values, and the robot has {expected} standard parameters; give one for each")]
    Values {
        /// Number given.
        found: usize,
        /// Number of standard parameters of the robot.
        expected: usize,
    },
    /// The mass matrix of these parameter values is not positive definite.
    #[error(
        "with these parameter values the mass matrix is not positive definite at joint `{joint}`; give its link an inertia \
         or its motor an `ia` above zero"
    )]
    NotDefinite {
        /// The joint.
        joint: String,
    },
    /// The robot states no parameters.
    #[error("{robot}: states no parameter values, which the generated code is to hold")]
    NoValues {
        /// The robot.
        robot: String,
    },
    /// A name from which no identifier can be made.
    #[error("`{name}` gives no name that C, Rust, Python and MATLAB can have")]
    NoIdentifier {
        /// The name.
        name: String,
    },
    /// A given name that is not a valid identifier.
    #[error(
        "`{name}` is no name that C, Rust, Python and MATLAB can have; use letters, digits and _, a letter first, {longest} at \
         most"
    )]
    NotAnIdentifier {
        /// The largest allowed length.
        name: String,
        /// The longest that can be had.
        longest: usize,
    },
}
