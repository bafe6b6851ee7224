//! Base parameters as formulas in the names of the geometry, such as `2*d3*mz3 + (a3^2 + d3^2)*m3`.
//!
//! What stands on a revolute joint's axis belongs as well to the link before (M. Gautier, W. Khalil, "Direct calculation of
//! minimum set of inertial parameters of serial robots", 1990; here on trees, with links in their own axes), and a link
//! behind a prismatic joint has the inertia of the link before. These rules take standard parameters to others with the same
//! torques, symbolically; the numeric regrouping says what is left to do, most of which is nothing.

mod formulas;
mod geometry;
mod polynomial;
mod rules;

pub use formulas::{BaseFormula, BaseFormulas, GeometrySymbol};
