//! Sines and cosines of a period, each with a quintic that brings it to rest at zero at both ends.
//!
//! Of each harmonic `w = 2 pi l / T` there are two: `sin w t - w T P1(t / T)` and `1 - cos w t - (w T)^2 P2(t / T)`.

use std::f64::consts::TAU;

/// Derivatives of a motion that are computed: position, velocity, acceleration, jerk.
pub(in crate::design) const ORDERS: usize = 4;

/// The harmonics with their quintics, order by order: sine and cosine of the first, of the second ...
pub(in crate::design) fn raw(period_s: f64, harmonics: usize, t: f64) -> [Vec<f64>; ORDERS] {
    let (first, second) = quintics(t / period_s);
    let mut orders = [(); ORDERS].map(|()| Vec::with_capacity(2 * harmonics));
    for l in 1..=harmonics {
        let w = TAU * l as f64 / period_s;
        let (sin, cos) = (w * t).sin_cos();
        let sine = [sin, w * cos, -w * w * sin, -w * w * w * cos];
        let cosine = [1.0 - cos, w * sin, w * w * cos, -w * w * w * sin];
        for (order, values) in orders.iter_mut().enumerate() {
            let rate = period_s.powi(-(order as i32));
            let turns = w * period_s;
            values.push(sine[order] - turns * rate * first[order]);
            values.push(cosine[order] - turns * turns * rate * second[order]);
        }
    }
    orders
}

/// `P1 = s - 10 s^3 + 15 s^4 - 6 s^5` and `P2 = (s^2 - 2 s^3 + s^4) / 2` with their derivatives: both are zero at 0 and 1,
/// where P1 has the slope one and P2 the second derivative one, and their other derivatives up to the second are zero.
fn quintics(s: f64) -> ([f64; ORDERS], [f64; ORDERS]) {
    let u = 1.0 - s;
    let first = [
        s - s.powi(3) * (10.0 - 15.0 * s + 6.0 * s * s),
        1.0 - 30.0 * s * s * u * u,
        -60.0 * s * u * (u - s),
        -60.0 * (1.0 - 6.0 * s * u),
    ];
    let second = [0.5 * s * s * u * u, s * u * (u - s), 1.0 - 6.0 * s * u, 6.0 * (s - u)];
    (first, second)
}
