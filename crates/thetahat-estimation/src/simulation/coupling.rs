use thetahat_ground::linear_algebra::Matrix;

/// The nonzero entries of a coupling matrix: most joints move only one motor.
pub(super) struct Coupling {
    entries: Vec<(usize, usize, f64)>,
}

impl Coupling {
    pub(super) fn new(n: &Matrix, factor: f64) -> Self {
        let all = (0..n.columns()).flat_map(|j| (0..n.rows()).map(move |i| (i, j)));
        let entries = all.map(|(i, j)| (i, j, factor * n.at(i, j))).filter(|(_, _, w)| *w != 0.0).collect();
        Self { entries }
    }

    /// Motor, joint and weight of each entry.
    pub(super) fn entries(&self) -> &[(usize, usize, f64)] {
        &self.entries
    }

    /// `motors = n joints`.
    #[inline]
    pub(super) fn to_motors(&self, joints: &[f64], motors: &mut [f64]) {
        motors.fill(0.0);
        self.entries.iter().for_each(|&(i, j, w)| motors[i] += w * joints[j]);
    }

    /// `joints = n^T motors`.
    #[inline]
    pub(super) fn transpose_to_joints(&self, motors: &[f64], joints: &mut [f64]) {
        joints.fill(0.0);
        self.entries.iter().for_each(|&(i, j, w)| joints[j] += w * motors[i]);
    }

    /// Adds `n^T diag(of_motor) n` to a matrix of the joints, row by row.
    pub(super) fn add_quadratic(&self, of_motor: impl Fn(usize) -> f64, joints: usize, matrix: &mut [f64]) {
        for &(i, j, w) in &self.entries {
            let weighted = w * of_motor(i);
            for &(_, k, w) in self.entries.iter().filter(|(other, ..)| *other == i) {
                matrix[j * joints + k] += weighted * w;
            }
        }
    }
}
