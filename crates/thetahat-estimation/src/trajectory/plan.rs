use super::{Move, Moves, TimeLaw, TrajectoryError};

/// Limits of a planned trajectory.
#[derive(Debug, Clone, PartialEq)]
pub struct MotionLimits {
    /// Largest velocity of each joint, in rad/s (m/s for prismatic joints).
    pub max_velocity: Vec<f64>,
    /// T2, the time in which the velocity rises and falls, in s.
    pub acceleration_time_s: f64,
    /// T3, the time over which the acceleration is smoothed, in s; at most T2.
    pub smoothing_time_s: f64,
    /// Rest after each move, in s.
    pub dwell_s: f64,
}

/// Plans synchronised moves through `end_points`, the first starting at `start_s`, separated by the dwell.
///
/// `T1 = max_j |D_j| / max_velocity_j`, at least T2: the slowest joint runs at its limit and the others below theirs.
///
/// ```
/// use thetahat_estimation::trajectory::{plan, MotionLimits};
/// let limits = MotionLimits { max_velocity: vec![2.0], acceleration_time_s: 0.1, smoothing_time_s: 0.02, dwell_s: 0.1 };
/// let moves = plan(vec![0.0], &[vec![1.0], vec![0.4]], &limits, 0.5)?;
/// let (mut q, mut dq, mut ddq) = ([0.0], [0.0], [0.0]);
/// moves.evaluate(0.5 + 0.31, &mut q, &mut dq, &mut ddq);
/// assert!((q[0] - 0.5).abs() < 1e-12 && (dq[0] - 2.0).abs() < 1e-12 && ddq[0].abs() < 1e-9);
/// # Ok::<(), thetahat_estimation::trajectory::TrajectoryError>(())
/// ```
///
/// # Errors
/// If a point or the limits have another number of joints than `start`, or a limit is out of range.
pub fn plan(
    start: Vec<f64>,
    end_points: &[Vec<f64>],
    limits: &MotionLimits,
    start_s: f64,
) -> Result<Moves, TrajectoryError> {
    check(limits, start.len())?;
    let (mut from, mut time_s) = (start.clone(), start_s);
    let mut moves = Vec::with_capacity(end_points.len());
    for end in end_points {
        let law = limits.law(&from, end, time_s);
        time_s = law.end_s() + limits.dwell_s;
        from.clone_from(end);
        moves.push(Move { law, end: end.clone() });
    }
    Moves::new(start, moves)
}

impl MotionLimits {
    fn law(&self, from: &[f64], to: &[f64], start_s: f64) -> TimeLaw {
        let times = from.iter().zip(to).zip(&self.max_velocity).map(|((from, to), v)| (to - from).abs() / v);
        let t1_s = times.fold(self.acceleration_time_s, f64::max);
        TimeLaw { start_s, t1_s, t2_s: self.acceleration_time_s, t3_s: self.smoothing_time_s }
    }
}

fn check(limits: &MotionLimits, joints: usize) -> Result<(), TrajectoryError> {
    if limits.max_velocity.len() != joints {
        let found = limits.max_velocity.len();
        return Err(TrajectoryError::JointCount { what: "max_velocity".to_owned(), expected: joints, found });
    }
    let (t2, t3) = (limits.acceleration_time_s, limits.smoothing_time_s);
    for &v in &limits.max_velocity {
        require(v > 0.0 && v.is_finite(), "max_velocity", "a finite number above zero", v)?;
    }
    require(t2 > 0.0 && t2.is_finite(), "acceleration_time_s", "a finite number above zero", t2)?;
    require(t3 > 0.0 && t3 <= t2, "smoothing_time_s", "above zero and at most acceleration_time_s", t3)?;
    require(limits.dwell_s >= 0.0 && limits.dwell_s.is_finite(), "dwell_s", "zero or more", limits.dwell_s)
}

fn require(holds: bool, what: &str, expected: &'static str, found: f64) -> Result<(), TrajectoryError> {
    if holds { Ok(()) } else { Err(TrajectoryError::Value { what: what.to_owned(), expected, found }) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn limits() -> MotionLimits {
        MotionLimits { max_velocity: vec![2.0, 5.0], acceleration_time_s: 0.15, smoothing_time_s: 0.03, dwell_s: 0.05 }
    }

    fn points() -> Vec<Vec<f64>> {
        vec![vec![1.0, -1.0], vec![0.9, 2.0], vec![0.9, 2.1]]
    }

    #[test]
    fn velocities_stay_at_or_below_their_limits() {
        let moves = plan(vec![0.0, 0.0], &points(), &limits(), 0.2).unwrap();
        let dq = moves.sample(10_000.0, 30_000).dq;
        let peak = |j: usize| dq.channel(j).into_iter().fold(0.0, |a: f64, v| a.max(v.abs()));
        assert!((peak(0) - 2.0).abs() < 1e-9 && (peak(1) - 5.0).abs() < 1e-9);
    }

    #[test]
    fn moves_follow_each_other_after_the_dwell() {
        let moves = plan(vec![0.0, 0.0], &points(), &limits(), 0.2).unwrap();
        let laws: Vec<TimeLaw> = moves.moves().iter().map(|m| m.law).collect();
        assert_eq!(laws[0].start_s, 0.2);
        assert_eq!((laws[0].t1_s, laws[1].t1_s, laws[2].t1_s), (0.5, 0.6, 0.15));
        assert!(laws.windows(2).all(|w| (w[1].start_s - w[0].end_s() - 0.05).abs() < 1e-15));
        assert!(moves.moves().iter().map(|m| &m.end).eq(points().iter()));
    }

    fn error_of(limits: &MotionLimits) -> TrajectoryError {
        plan(vec![0.0, 0.0], &points(), limits, 0.0).unwrap_err()
    }

    #[test]
    fn each_defect_is_refused() {
        use TrajectoryError::{JointCount, Value};
        assert!(matches!(error_of(&MotionLimits { max_velocity: vec![1.0], ..limits() }), JointCount { found: 1, .. }));
        assert!(matches!(error_of(&MotionLimits { max_velocity: vec![1.0, 0.0], ..limits() }), Value { .. }));
        assert!(matches!(error_of(&MotionLimits { smoothing_time_s: 0.2, ..limits() }), Value { .. }));
        assert!(matches!(error_of(&MotionLimits { dwell_s: -0.1, ..limits() }), Value { .. }));
        let short = plan(vec![0.0, 0.0], &[vec![1.0]], &limits(), 0.0);
        assert!(matches!(short, Err(JointCount { found: 1, .. })));
    }
}
