//! Base parameters as formulas in symbols of the geometry, such as `2*d3*mz3 + (a3^2 + d3^2)*m3`.
//!
//! Mass on a revolute joint's axis can equally be assigned to the link before (M. Gautier, W. Khalil, "Direct calculation of
//! minimum set of inertial parameters of serial robots", 1990; here on trees, with links in their own axes), and so can the
//! inertia of a prismatic joint's link. These rules transform standard parameters symbolically to others with the same torques;
//! the numeric regrouping completes the work, most of which is then already done.

mod formulas;
mod geometry;
mod polynomial;
mod rules;

pub use formulas::{BaseFormula, BaseFormulas, GeometrySymbol};
