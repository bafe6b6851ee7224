//! How an identified link is split among the links of a file that make it up.
//!
//! A file may fix other links to the link that a joint moves. Motion shows them as one body. The rule: the fixed links keep the
//! inertia that the file gives them, and the link that the joint moves gets the rest, if that is a body. If not, all fixed links
//! are scaled by half the largest factor that leaves a body.

use super::xml::number;
use thetahat_model::consistency::{Symmetric, pseudo_inertia};

/// Smallest eigenvalue of a pseudo-inertia matrix, relative to the largest, of a body that a simulator can use.
const DEFINITE: f64 = 1e-9;
/// Halvings of the interval in which the largest factor lies.
const HALVINGS: usize = 60;

/// The inertial parameters that links of a URDF get, each about the origin of its own frame, in the order of the robot's table.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Shares {
    /// Of the link that the joint moves.
    pub(super) carrier: [f64; 10],
    /// The factor of the fixed links.
    pub(super) factor: f64,
}

impl Shares {
    /// What was done, in words: `fixed` are the names of the fixed links.
    pub(super) fn in_words(&self, fixed: &[&str], carrier: &str) -> String {
        let kept = if self.factor == 1.0 {
            "keep their inertia".to_owned()
        } else {
            format!("have {} of theirs", number(self.factor))
        };
        let fixed = fixed.join(", ");
        format!("{fixed} {kept}; `{carrier}`, to which they are fixed, has the rest of the identified link")
    }
}

/// The split of a moving link with inertial parameters `whole` among its parts: the fixed links, in the frame of the link that
/// carries them.
pub(super) fn split(whole: [f64; 10], fixed: &[[f64; 10]]) -> Shares {
    let sum = fixed.iter().fold([0.0; 10], |sum, part| plus(sum, *part, 1.0));
    let is_body = |factor: &f64| has_volume(&pseudo_inertia(plus(whole, sum, -factor)));
    let factor = if is_body(&1.0) { 1.0 } else { 0.5 * largest(&is_body) };
    Shares { carrier: plus(whole, sum, -factor), factor }
}

/// The largest factor between zero and one, to rounding.
fn largest(is_body: &impl Fn(&f64) -> bool) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if is_body(&middle) { low = middle } else { high = middle }
    }
    low
}

fn plus(a: [f64; 10], b: [f64; 10], factor: f64) -> [f64; 10] {
    std::array::from_fn(|i| a[i] + factor * b[i])
}

fn has_volume(p: &Symmetric) -> bool {
    matches!(p.eigenvalues().as_slice(), [smallest, .., largest] if *smallest > DEFINITE * largest)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ball(mass: f64) -> [f64; 10] {
        let i = 0.4 * mass * 0.01;
        [i, 0.0, 0.0, i, 0.0, i, 0.0, 0.0, 0.0, mass]
    }

    #[test]
    fn fixed_links_keep_theirs_where_the_rest_is_a_body() {
        let shares = split(ball(3.0), &[ball(1.0)]);
        assert_eq!(shares.factor, 1.0);
        assert_eq!(shares.carrier[9], 2.0);
    }

    #[test]
    fn fixed_links_that_are_too_heavy_are_scaled() {
        let shares = split(ball(3.0), &[ball(2.0), ball(2.0)]);
        assert!((shares.factor - 0.375).abs() < 1e-6, "{}", shares.factor);
        assert!((shares.carrier[9] - 1.5).abs() < 1e-5);
    }
}
