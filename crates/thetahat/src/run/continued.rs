//! Motions continued beyond their ends, so that filters have nothing to assume there.
//!
//! A filter that reflects a series at its ends turns an acceleration there into its opposite: torques of the last samples of a motion that
//! does not end at rest were wrong by many times themselves.

use thetahat_ground::{
    linear_algebra::{Matrix, PivotedQr},
    series::Series,
};

/// Numbers of the polynomial with which a motion continues: up to the third power.
const NUMBERS: usize = 4;

/// A series continued at both ends by as many samples as each polynomial is fitted to: twice its numbers at least. A shorter series stays.
pub(super) fn continued(series: &Series, samples: usize) -> Series {
    let samples = samples.max(2 * NUMBERS);
    if series.len() < samples {
        return series.clone();
    }
    // Time runs from -1 to 1 over the fitted samples, and to 3 after them.
    let time = |k: usize| 2.0 * k as f64 / (samples - 1) as f64 - 1.0;
    let powers = |k: usize, power: usize| time(k).powi(power as i32);
    let factor = PivotedQr::new(&Matrix::from_fn(samples, NUMBERS, powers));
    let continuation = Matrix::from_fn(samples, NUMBERS, |k, power| powers(samples + k, power));
    let column = |c: usize| {
        let values = series.channel(c);
        let first: Vec<f64> = values[..samples].iter().rev().copied().collect();
        let mut before = continuation.times(&factor.solve(&first));
        before.reverse();
        let after = continuation.times(&factor.solve(&values[values.len() - samples..]));
        [before, values, after].concat()
    };
    Series::side_by_side(&(0..series.channels()).map(column).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cubic_goes_on_as_it_is() {
        let cubic = |k: i32| {
            let t = f64::from(k) / 50.0;
            [1.0 - 2.0 * t + 0.3 * t * t - 0.7 * t * t * t, t]
        };
        let series = Series::shaped(2, (0..60).flat_map(cubic).collect());
        let continued = continued(&series, 20);
        assert_eq!(continued.len(), 100);
        for k in 0..100 {
            let expected = cubic(k as i32 - 20);
            let found = continued.sample(k);
            assert!(found.iter().zip(expected).all(|(f, e)| (f - e).abs() < 1e-9), "{k}: {found:?} {expected:?}");
        }
    }

    #[test]
    fn a_series_that_is_too_short_stays() {
        let series = Series::shaped(1, vec![1.0, 2.0, 4.0]);
        assert_eq!(continued(&series, 20).values(), series.values());
    }
}
