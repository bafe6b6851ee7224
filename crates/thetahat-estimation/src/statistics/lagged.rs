//! Sums of lagged products of series: the inner loops of the covariances, compiled for the widest vectors of the machine.

/// Partial sums side by side, so that they fill vectors.
const LANES: usize = 16;

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
        for (lag, sum) in self.sums.iter_mut().enumerate().take(self.a.len()) {
            *sum += dot(&self.a[..self.a.len() - lag], &self.b[lag..]);
        }
    }
}

#[inline(always)]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut partial = [0.0; LANES];
    let (a_chunks, b_chunks) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let rest: f64 = a_chunks.remainder().iter().zip(b_chunks.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in a_chunks.zip(b_chunks) {
        for l in 0..LANES {
            partial[l] += a[l] * b[l];
        }
    }
    rest + partial.iter().sum::<f64>()
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
        out.fill(0.0);
        for (lag, &c) in c.iter().enumerate().take(a.len()) {
            add_scaled(c, &a[lag..], out);
            if lag > 0 {
                add_scaled(c, a, &mut out[lag..]);
            }
        }
    }
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
