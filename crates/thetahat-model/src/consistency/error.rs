/// Why there is no consistent estimate.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ConsistencyError {
    /// A name that is not a standard parameter of the robot.
    #[error("there is no standard parameter `{name}`; names are like zz1, ia2, fcm6")]
    UnknownParameter {
        /// The name.
        name: String,
    },
    /// A link that the robot does not have.
    #[error("there is no link {number}; the links are numbered from 1 to {links}")]
    UnknownLink {
        /// The number given.
        number: usize,
        /// Number of links.
        links: usize,
    },
    /// A value that is not finite, or a lower bound above the upper one.
    #[error("{what}: {reason}")]
    BadValue {
        /// The given value.
        what: String,
        /// What is wrong with it.
        reason: String,
    },
    /// An a-priori pseudo-inertia matrix that is not positive definite.
    #[error(
        "the a-priori parameters of link {link} are those of no body with volume (smallest eigenvalue of the \
         pseudo-inertia matrix {smallest_eigenvalue:.3e}); complete them first"
    )]
    APrioriNotDefinite {
        /// The link, from one.
        link: usize,
        /// The smallest eigenvalue.
        smallest_eigenvalue: f64,
    },
    /// Known values that contradict each other.
    #[error("{known} contradicts the other known values: they give {found:.6e} where it says {expected:.6e}")]
    ContradictoryValues {
        /// The contradicted value.
        known: String,
        /// The value implied by the others.
        found: f64,
        /// The value stated.
        expected: f64,
    },
    /// The known values leave no physically possible parameters, or only bodies without volume.
    #[error(
        "no set of parameters meets all conditions with room to spare (best margin {margin:.3e} of the a-priori values); \
         those in conflict: {}", conflicting.join(", ")
    )]
    NoInterior {
        /// The largest margin, relative to the a-priori values, that all conditions can have together.
        margin: f64,
        /// The conditions that limit the margin.
        conflicting: Vec<String>,
    },
    /// A matrix or vector has a wrong size.
    #[error("{what} must have {expected} entries, but has {found}")]
    WrongSize {
        /// The matrix or vector.
        what: &'static str,
        /// The size needed.
        expected: usize,
        /// The size found.
        found: usize,
    },
    /// A matrix or vector with an entry that is not finite.
    #[error("the regression has entries that are not finite")]
    NotFinite,
    /// The numbers of a solution overflow or vanish.
    #[error(
        "no consistent parameters can be computed, as numbers overflow: masses or inertias of the description are wrong by many powers of \
         ten, as those in g and g mm^2 are; correct them, or remove them, and identify again"
    )]
    NotSolved,
}
