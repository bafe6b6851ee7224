use thetahat_ground::{linear_algebra::Matrix, series::Series};

/// The map between motors and joints: `q = N^-1 q_motor + offset`, `tau = N^T (g_tau tau_motor)`.
#[derive(Debug, Clone, PartialEq)]
pub struct Transmission {
    matrix: Matrix,
    inverse: Matrix,
    offset: Vec<f64>,
    drive_gain: Vec<f64>,
}

impl Transmission {
    /// A transmission from the motor-joint matrix `N` (motors by joints), the joint offsets in rad or m, and the drive gains
    /// `g_tau`. `None` if `N` is singular.
    #[must_use]
    pub fn new(matrix: Matrix, offset: Vec<f64>, drive_gain: Vec<f64>) -> Option<Self> {
        let inverse = matrix.inverse()?;
        Some(Self { matrix, inverse, offset, drive_gain })
    }

    /// One motor on each joint, ratio one.
    #[must_use]
    pub fn direct(joints: usize) -> Self {
        let identity = Matrix::identity(joints);
        Self { matrix: identity.clone(), inverse: identity, offset: vec![0.0; joints], drive_gain: vec![1.0; joints] }
    }

    /// Multiplies the drive gain of a motor.
    #[doc(hidden)]
    pub fn scale_drive_gain(&mut self, motor: usize, factor: f64) {
        self.drive_gain[motor] *= factor;
    }

    /// The motor-joint matrix `N`.
    #[must_use]
    pub fn matrix(&self) -> &Matrix {
        &self.matrix
    }

    /// The joint positions at the motors' zero, in rad or m.
    #[must_use]
    pub fn offset(&self) -> &[f64] {
        &self.offset
    }

    /// The drive gains, torque per unit of each motor's drive signal.
    #[must_use]
    pub fn drive_gain(&self) -> &[f64] {
        &self.drive_gain
    }

    /// Number of joints.
    #[must_use]
    pub fn joints(&self) -> usize {
        self.offset.len()
    }

    /// The motor velocities in joint units: `n = D^-1 N`, where D holds each motor's own gear ratio (the diagonal of N, or the
    /// largest entry of the row if that is zero). `n` is the identity if nothing is coupled.
    #[must_use]
    pub fn motor_in_joint_units(&self) -> Matrix {
        let ratio: Vec<f64> = (0..self.joints()).map(|i| self.own_ratio(i)).collect();
        Matrix::from_fn(self.joints(), self.joints(), |i, j| self.matrix.at(i, j) / ratio[i])
    }

    /// `n^-1`: joint velocities per motor velocities in joint units.
    #[must_use]
    pub fn joints_per_motor(&self) -> Matrix {
        Matrix::from_fn(self.joints(), self.joints(), |i, j| self.inverse.at(i, j) * self.own_ratio(j))
    }

    /// Torque of each motor in joint units per drive signal: its own gear ratio times its drive gain.
    #[must_use]
    pub fn drive_to_joint_units(&self) -> Vec<f64> {
        self.drive_gain.iter().enumerate().map(|(i, gain)| self.own_ratio(i) * gain).collect()
    }

    fn own_ratio(&self, motor: usize) -> f64 {
        let row = (0..self.joints()).map(|j| self.matrix.at(motor, j));
        let diagonal = self.matrix.at(motor, motor);
        let larger = |a: f64, b: f64| if b.abs() > a.abs() { b } else { a };
        if diagonal == 0.0 { row.fold(0.0, larger) } else { diagonal }
    }

    /// The gear ratio of each coordinate's own motor; none if motors are coupled.
    #[must_use]
    pub fn ratios(&self) -> Option<Vec<f64>> {
        let of_coordinate = |j: usize| (0..self.joints()).map(|i| self.matrix.at(i, j)).find(|ratio| *ratio != 0.0);
        let ratios: Option<Vec<f64>> = (0..self.joints()).map(of_coordinate).collect();
        ratios.filter(|_| self.coupled_motors().is_empty())
    }

    /// The motors, from zero, that turn with more than one joint.
    #[must_use]
    pub fn coupled_motors(&self) -> Vec<usize> {
        let moves = |i: usize| (0..self.joints()).filter(|&j| self.matrix.at(i, j) != 0.0).count();
        (0..self.joints()).filter(|&i| moves(i) > 1).collect()
    }

    /// The coordinates, from zero, with which a motor turns.
    #[doc(hidden)]
    #[must_use]
    pub fn coordinates_of(&self, motor: usize) -> Vec<usize> {
        (0..self.joints()).filter(|&j| self.matrix.at(motor, j) != 0.0).collect()
    }

    /// The transmission of some motors to some coordinates; none if these motors do not determine them.
    #[doc(hidden)]
    #[must_use]
    pub fn part(&self, motors: &[usize], coordinates: &[usize]) -> Option<Self> {
        if motors.len() != coordinates.len() {
            return None;
        }
        let size = motors.len();
        let matrix = Matrix::from_fn(size, size, |i, j| self.matrix.at(motors[i], coordinates[j]));
        let offset = coordinates.iter().map(|&j| self.offset[j]).collect();
        Self::new(matrix, offset, motors.iter().map(|&i| self.drive_gain[i]).collect())
    }

    /// Whether several motors contribute to a joint's torque; the joint counts from zero.
    #[must_use]
    pub fn has_several_motors(&self, joint: usize) -> bool {
        (0..self.joints()).filter(|&i| self.matrix.at(i, joint) != 0.0).count() > 1
    }

    /// `q = N^-1 q_motor + offset` for each sample.
    #[must_use]
    pub fn joint_positions(&self, motor: &Series) -> Series {
        product(&self.inverse, motor, |_, x| x, |j, q| q + self.offset[j])
    }

    /// `dq = N^-1 dq_motor` for each sample.
    #[must_use]
    pub fn joint_velocities(&self, motor: &Series) -> Series {
        product(&self.inverse, motor, |_, x| x, |_, dq| dq)
    }

    /// `tau = N^T (g_tau tau_motor)` for each sample.
    #[must_use]
    pub fn joint_torques(&self, drive: &Series) -> Series {
        product(&self.matrix.transpose(), drive, |i, u| u * self.drive_gain[i], |_, tau| tau)
    }

    /// `q_motor = N (q - offset)`.
    #[must_use]
    pub fn motor_positions(&self, joint: &Series) -> Series {
        product(&self.matrix, joint, |j, q| q - self.offset[j], |_, x| x)
    }

    /// `tau_motor = N^-T tau / g_tau`.
    #[must_use]
    pub fn drive_signals(&self, joint_torques: &Series) -> Series {
        product(&self.inverse.transpose(), joint_torques, |_, tau| tau, |i, u| u / self.drive_gain[i])
    }
}

/// `after(A before(x))` for each sample x: `before` and `after` receive a channel and its value.
fn product(
    a: &Matrix,
    series: &Series,
    before: impl Fn(usize, f64) -> f64,
    after: impl Fn(usize, f64) -> f64,
) -> Series {
    let mut products = Series::zeros(series.len(), a.rows());
    let mut x = vec![0.0; a.columns()];
    for k in 0..series.len() {
        x.iter_mut().zip(series.sample(k)).enumerate().for_each(|(j, (x, value))| *x = before(j, *value));
        for (i, y) in products.sample_mut(k).iter_mut().enumerate() {
            let sum = x.iter().enumerate().map(|(j, x)| a.at(i, j) * x).sum();
            *y = after(i, sum);
        }
    }
    products
}

#[cfg(test)]
mod tests {
    use super::*;

    fn coupled_wrist() -> Transmission {
        let matrix = Matrix::from_fn(2, 2, |i, j| [[45.0, 0.0], [32.0, 32.0]][i][j]);
        Transmission::new(matrix, vec![0.1, -0.2], vec![2.0, 0.5]).unwrap()
    }

    #[test]
    fn positions_and_torques_go_there_and_back() {
        let t = coupled_wrist();
        let q = Series::shaped(2, vec![0.3, -0.7, 1.1, 0.4]);
        let back = t.joint_positions(&t.motor_positions(&q));
        let tau = t.joint_torques(&t.drive_signals(&q));
        for k in 0..4 {
            assert!((back.values()[k] - q.values()[k]).abs() < 1e-14);
            assert!((tau.values()[k] - q.values()[k]).abs() < 1e-14);
        }
    }

    /// Power at the motors is power at the joints: tau^T dq = tau_motor^T dq_motor.
    #[test]
    fn power_is_kept() {
        let t = Transmission::new(coupled_wrist().matrix().clone(), vec![0.0; 2], vec![1.0; 2]).unwrap();
        let (dq, motor_torque) = (Series::shaped(2, vec![0.3, -0.7]), Series::shaped(2, vec![1.5, 0.2]));
        let power = |a: &Series, b: &Series| a.values().iter().zip(b.values()).map(|(a, b)| a * b).sum::<f64>();
        let joint = power(&t.joint_torques(&motor_torque), &dq);
        assert!((joint - power(&motor_torque, &t.motor_positions(&dq))).abs() < 1e-12);
    }

    #[test]
    fn only_the_second_motor_is_coupled() {
        let t = coupled_wrist();
        assert_eq!(t.coupled_motors(), vec![1]);
        let n = t.motor_in_joint_units();
        assert_eq!((n.at(0, 0), n.at(0, 1), n.at(1, 0), n.at(1, 1)), (1.0, 0.0, 1.0, 1.0));
    }
}
