//! Sums of lagged products of series: the inner loops of the covariances, compiled for the widest vectors of the machine.

/// Partial sums side by side, so that they fill vectors.
const LANES: usize = 16;
/// Samples of a series that stay in the fastest memory while all lags pass.
const BLOCK: usize = 1024;
/// Lags that are summed at a time.
const TOGETHER: usize = 4;
/// Groups of outputs that are summed at a time.
const TILES: usize = 4;

/// `sums[l] += sum_t a[t] b[t + l]`.
pub(super) fn add_lagged_products(a: &[f64], b: &[f64], sums: &mut [f64]) {
    pulp::Arch::new().dispatch(LaggedProducts { a, b, sums });
}

/// `out = sum_l c[|l|] a[t - l]`, the product of the symmetric band matrix of `c` with a vector.
pub(super) fn convolve(c: &[f64], a: &[f64], out: &mut [f64]) {
    pulp::Arch::new().dispatch(Convolution { c, a, out });
}

/// `out += sum_(l >= 0) c[l] a[t - l]`, the product of the lower half of such a matrix with a vector.
pub(super) fn add_lower_half(c: &[f64], a: &[f64], out: &mut [f64]) {
    pulp::Arch::new().dispatch(LowerHalf { c, a, out });
}

struct LaggedProducts<'a> {
    a: &'a [f64],
    b: &'a [f64],
    sums: &'a mut [f64],
}

impl pulp::WithSimd for LaggedProducts<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let Self { a, b, sums } = self;
        let lags = sums.len().min(a.len());
        for start in (0..a.len()).step_by(BLOCK) {
            let here = &a[start..a.len().min(start + BLOCK)];
            for (group, sums) in sums[..lags].chunks_mut(TOGETHER).enumerate() {
                add_products(here, b.get(start + TOGETHER * group..).unwrap_or_default(), sums);
            }
        }
    }
}

/// `sums[l] += sum_t a[t] b[t + l]` of a few lags, so that `a` is read once for all of them.
#[inline(always)]
fn add_products(a: &[f64], b: &[f64], sums: &mut [f64]) {
    let together = b.len().saturating_sub(TOGETHER - 1).min(a.len()) / LANES * LANES;
    let mut partial = [[0.0; LANES]; TOGETHER];
    for t in (0..together).step_by(LANES) {
        let a = &a[t..t + LANES];
        for (lag, partial) in partial.iter_mut().enumerate() {
            let b = &b[t + lag..t + lag + LANES];
            for l in 0..LANES {
                partial[l] += a[l] * b[l];
            }
        }
    }
    for (lag, (sum, partial)) in sums.iter_mut().zip(partial).enumerate() {
        let rest = a[together..].iter().zip(b.get(together + lag..).unwrap_or_default());
        *sum += partial.iter().sum::<f64>() + rest.map(|(a, b)| a * b).sum::<f64>();
    }
}

struct Convolution<'a> {
    c: &'a [f64],
    a: &'a [f64],
    out: &'a mut [f64],
}

impl pulp::WithSimd for Convolution<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let Self { c, a, out } = self;
        // Zeros on both sides: every output has all lags, and every tile is full.
        let reach = c.len().min(a.len()).saturating_sub(1);
        let mut padded = vec![0.0; reach + a.len() + reach + TILES * LANES];
        padded[reach..reach + a.len()].copy_from_slice(a);
        for (tile, out) in out.chunks_mut(TILES * LANES).enumerate() {
            let middle = reach + tile * TILES * LANES;
            let sums = tile_of_convolution(&c[..c.len().min(reach + 1)], &padded, middle);
            out.iter_mut().zip(sums.as_flattened()).for_each(|(out, sum)| *out = *sum);
        }
    }
}

/// The outputs from `middle` on, summed over all lags before they are stored.
#[inline(always)]
fn tile_of_convolution(c: &[f64], padded: &[f64], middle: usize) -> [[f64; LANES]; TILES] {
    let mut sums = [[0.0; LANES]; TILES];
    for (lag, &c) in c.iter().enumerate() {
        // At lag zero the two sides are one.
        let c = if lag == 0 { 0.5 * c } else { c };
        let before = &padded[middle - lag..][..TILES * LANES];
        let after = &padded[middle + lag..][..TILES * LANES];
        for (k, sums) in sums.iter_mut().enumerate() {
            let (before, after) = (&before[k * LANES..][..LANES], &after[k * LANES..][..LANES]);
            for l in 0..LANES {
                sums[l] += c * (before[l] + after[l]);
            }
        }
    }
    sums
}

struct LowerHalf<'a> {
    c: &'a [f64],
    a: &'a [f64],
    out: &'a mut [f64],
}

impl pulp::WithSimd for LowerHalf<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        for (lag, &c) in self.c.iter().enumerate().take(self.a.len()) {
            add_scaled(c, self.a, &mut self.out[lag..]);
        }
    }
}

/// `out += c a`, up to the shorter of the two.
#[inline(always)]
fn add_scaled(c: f64, a: &[f64], out: &mut [f64]) {
    out.iter_mut().zip(a).for_each(|(o, a)| *o += c * a);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series(seed: f64) -> Vec<f64> {
        (0..53).map(|k| (seed * f64::from(k)).sin()).collect()
    }

    /// Longer than a block, and not a multiple of anything.
    #[test]
    fn long_series_are_summed_block_by_block() {
        let long = |seed: f64| -> Vec<f64> { (0..2 * BLOCK + 77).map(|k| (seed * k as f64).sin()).collect() };
        let (a, b, c) = (long(0.7), long(1.9), long(0.3)[..61].to_vec());
        let mut sums = vec![0.0; 61];
        add_lagged_products(&a, &b, &mut sums);
        for (lag, sum) in sums.iter().enumerate() {
            let expected: f64 = a.iter().zip(&b[lag..]).map(|(a, b)| a * b).sum();
            assert!((sum - expected).abs() < 1e-10, "lag {lag}");
        }
        let mut out = vec![9.0; a.len()];
        convolve(&c, &a, &mut out);
        for t in 0..a.len() {
            let near = t.saturating_sub(60)..(t + 61).min(a.len());
            let expected: f64 = near.map(|s| c[t.abs_diff(s)] * a[s]).sum();
            assert!((out[t] - expected).abs() < 1e-11, "row {t}");
        }
    }

    #[test]
    fn products_and_convolutions_are_their_definitions() {
        let (a, b, c) = (series(0.7), series(1.9), [2.0, -1.0, 0.5]);
        let mut sums = vec![1.0; 60];
        add_lagged_products(&a, &b, &mut sums);
        for (lag, sum) in sums.iter().enumerate() {
            let expected: f64 = 1.0 + a.iter().zip(b.iter().skip(lag)).map(|(a, b)| a * b).sum::<f64>();
            assert!((sum - expected).abs() < 1e-12, "lag {lag}");
        }
        let mut out = vec![9.0; a.len()];
        convolve(&c, &a, &mut out);
        for t in 0..a.len() {
            let expected: f64 = (0..a.len()).filter(|s| t.abs_diff(*s) < 3).map(|s| c[t.abs_diff(s)] * a[s]).sum();
            assert!((out[t] - expected).abs() < 1e-12, "row {t}");
        }
        let mut lower = vec![1.0; a.len()];
        add_lower_half(&c, &a, &mut lower);
        for t in 0..a.len() {
            let expected: f64 = 1.0 + (0..=t).filter(|s| t - s < 3).map(|s| c[t - s] * a[s]).sum::<f64>();
            assert!((lower[t] - expected).abs() < 1e-12, "row {t}");
        }
    }
}
