//! Interpolation by the polynomial through a few values.

/// Weights of the values at `places` in the polynomial through them, at `place`.
pub fn lagrange_weights(places: &[f64], place: f64) -> impl Iterator<Item = f64> {
    let factor = move |i: usize, j: usize| (place - places[j]) / (places[i] - places[j]);
    (0..places.len()).map(move |i| (0..places.len()).filter(|&j| j != i).map(|j| factor(i, j)).product())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cubic_is_met_exactly() {
        let cubic = |t: f64| t.powi(3) - 2.0 * t + 1.0;
        let places: [f64; 4] = [-1.0, 0.3, 0.5, 2.0];
        for place in [-1.0, 0.0, 0.4, 3.0] {
            let found: f64 = lagrange_weights(&places, place).zip(places).map(|(weight, t)| weight * cubic(t)).sum();
            assert!((found - cubic(place)).abs() < 1e-12, "{place}: {found}");
        }
    }
}
