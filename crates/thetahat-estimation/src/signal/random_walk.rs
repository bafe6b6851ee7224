//! A position as an integrated random walk, measured with white noise: its Kalman filter in the steady state.

/// A square matrix as large as the state.
pub(super) type Square<const P: usize> = [[f64; P]; P];

/// Steps of scaled time after which the covariance of the filter has settled to rounding: its slowest error decays as `exp(-0.6 t)` up
/// to order 5.
const SETTLED: f64 = 60.0;
/// Fewest steps until it has settled, where a step is long.
const FEWEST_STEPS: usize = 60;

/// The random walk whose derivative of order P is white noise, in time scaled by its frequency w0: the state is the position and its
/// derivatives below P, each over w0 to its order. The variance of the measurement is one, the density of the noise is the step `w0 h`.
#[derive(Debug, Clone, Copy)]
pub(super) struct RandomWalk<const P: usize> {
    transition: Square<P>,
    noise: Square<P>,
}

/// What the filter of a sample needs.
#[derive(Debug, Clone, Copy)]
pub(super) struct Gain<const P: usize> {
    /// What the prediction of the next sample takes of the innovation; zero where nothing is measured.
    pub(super) gain: [f64; P],
    /// Variance of the innovation.
    pub(super) innovation: f64,
    /// Covariance of the prediction of this sample.
    pub(super) covariance: Square<P>,
    /// Whether the sample is measured.
    pub(super) is_measured: bool,
}

impl<const P: usize> RandomWalk<P> {
    /// The walk sampled in steps of scaled time `w0 h`.
    pub(super) fn new(step: f64) -> Self {
        let power = |n: usize| step.powi(n as i32);
        let mut walk = Self { transition: [[0.0; P]; P], noise: [[0.0; P]; P] };
        for i in 0..P {
            for j in 0..P {
                if j >= i {
                    walk.transition[i][j] = power(j - i) / factorial(j - i);
                }
                let (a, b) = (P - 1 - i, P - 1 - j);
                walk.noise[i][j] = step * power(a + b + 1) / ((a + b + 1) as f64 * factorial(a) * factorial(b));
            }
        }
        walk
    }

    /// The state a step later.
    pub(super) fn next(&self, state: &[f64; P]) -> [f64; P] {
        std::array::from_fn(|i| (i..P).map(|j| self.transition[i][j] * state[j]).sum())
    }

    /// The gain of the steady state, in which a step of `step` leaves the covariance.
    pub(super) fn steady(&self, step: f64) -> Gain<P> {
        let mut covariance: Square<P> = std::array::from_fn(|i| std::array::from_fn(|j| f64::from(i == j) * step));
        for _ in 0..(SETTLED / step).ceil() as usize + FEWEST_STEPS {
            covariance = self.next_covariance(&self.gain(covariance, true));
        }
        self.gain(covariance, true)
    }

    /// The gain for a covariance of the prediction.
    pub(super) fn gain(&self, covariance: Square<P>, is_measured: bool) -> Gain<P> {
        let innovation = covariance[0][0] + 1.0;
        let along = self.next(&std::array::from_fn(|i| covariance[i][0]));
        let gain = along.map(|value| if is_measured { value / innovation } else { 0.0 });
        Gain { gain, innovation, covariance, is_measured }
    }

    /// The covariance of the prediction a step later: `F P (F - K H)^T + Q`.
    pub(super) fn next_covariance(&self, gain: &Gain<P>) -> Square<P> {
        let rows: Square<P> = std::array::from_fn(|i| self.next(&gain.covariance[i]));
        // rows = P F^T, as P is symmetric.
        let full: Square<P> = std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let moved: f64 = (i..P).map(|k| self.transition[i][k] * rows[k][j]).sum();
                moved - gain.gain[i] * gain.gain[j] * gain.innovation + self.noise[i][j]
            })
        });
        std::array::from_fn(|i| std::array::from_fn(|j| 0.5 * (full[i][j] + full[j][i])))
    }

    /// `(F - K H)^T r`, a step back in time.
    pub(super) fn back(&self, gain: &Gain<P>, later: &[f64; P]) -> [f64; P] {
        let mut earlier: [f64; P] = std::array::from_fn(|j| (0..=j).map(|i| self.transition[i][j] * later[i]).sum());
        earlier[0] -= dot(&gain.gain, later);
        earlier
    }
}

pub(super) fn dot<const P: usize>(a: &[f64; P], b: &[f64; P]) -> f64 {
    std::iter::zip(a, b).map(|(a, b)| a * b).sum()
}

pub(super) fn factorial(n: usize) -> f64 {
    (1..=n).map(|k| k as f64).product()
}
