use serde::{Deserialize, Serialize};

use super::{TimeLaw, TrajectoryError};
use crate::signal::Motion;
use thetahat_ground::series::Series;

/// One move: a time law shared by all joints, and its end point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Move {
    /// Start and duration.
    pub law: TimeLaw,
    /// The end point P_k, in rad (m for prismatic joints).
    pub end: Vec<f64>,
}

/// A trajectory of point-to-point moves, synchronised over the joints.
///
/// `q(t) = P_0 + sum_k (P_k - P_(k-1)) s_k(t)`, and the same sum of `ds_k` and `dds_k` for the velocity and the
/// acceleration. Starts and ends are in the order of time; a move may start before the previous one has ended, as moves of a real
/// controller do by some milliseconds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Unchecked")]
pub struct Moves {
    start: Vec<f64>,
    moves: Vec<Move>,
}

/// The content of a file, not yet checked.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Unchecked {
    start: Vec<f64>,
    #[serde(default)]
    moves: Vec<Move>,
}

impl TryFrom<Unchecked> for Moves {
    type Error = TrajectoryError;

    fn try_from(data: Unchecked) -> Result<Self, TrajectoryError> {
        Self::new(data.start, data.moves)
    }
}

impl Moves {
    /// A trajectory from its start point P_0 and its moves. Without moves the robot stands still.
    ///
    /// # Errors
    /// Where an end point has another number of joints, a number is not finite, the times of a law do not satisfy
    /// `T1 >= T2 >= T3 > 0`, or the moves are not in the order of time.
    pub fn new(start: Vec<f64>, moves: Vec<Move>) -> Result<Self, TrajectoryError> {
        check_finite("the start point", &start)?;
        for (k, motion) in moves.iter().enumerate() {
            check_move(k + 1, motion, start.len())?;
        }
        check_order(&moves)?;
        Ok(Self { start, moves })
    }

    /// The start point P_0, in rad (m for prismatic joints).
    #[must_use]
    pub fn start(&self) -> &[f64] {
        &self.start
    }

    /// The moves, in the order of time.
    #[must_use]
    pub fn moves(&self) -> &[Move] {
        &self.moves
    }

    /// Number of joints.
    #[must_use]
    pub fn joints(&self) -> usize {
        self.start.len()
    }

    /// When the first move starts, in s; zero without moves.
    #[must_use]
    pub fn start_s(&self) -> f64 {
        self.moves.first().map_or(0.0, |m| m.law.start_s)
    }

    /// When the last move ends, in s; zero without moves.
    #[must_use]
    #[inline]
    pub fn end_s(&self) -> f64 {
        self.moves.last().map_or(0.0, |m| m.law.end_s())
    }

    /// Positions, velocities and accelerations at time `t`, in s. Does not allocate.
    ///
    /// # Panics
    /// If `q` does not have one entry for each joint.
    pub fn evaluate(&self, t: f64, q: &mut [f64], dq: &mut [f64], ddq: &mut [f64]) {
        let finished = self.moves.partition_point(|m| m.law.end_s() <= t);
        q.copy_from_slice(self.start_of(finished));
        dq.fill(0.0);
        ddq.fill(0.0);
        for k in finished..self.moves.len() {
            if self.moves[k].law.start_s >= t {
                break;
            }
            self.add_move(k, t, q, dq, ddq);
        }
    }

    /// `samples` samples of positions, velocities and accelerations, the first at time zero.
    ///
    /// # Panics
    /// If the trajectory has no joint.
    #[must_use]
    pub fn sample(&self, sample_rate_hz: f64, samples: usize) -> Motion {
        let zeros = || Series::zeros(samples, self.joints());
        let (mut q, mut dq, mut ddq) = (zeros(), zeros(), zeros());
        for k in 0..samples {
            self.evaluate(k as f64 / sample_rate_hz, q.sample_mut(k), dq.sample_mut(k), ddq.sample_mut(k));
        }
        Motion { q, dq, ddq }
    }

    /// The trajectory with each point mapped; an affine map gives the same motion in other coordinates.
    pub(crate) fn mapped(&self, point: &dyn Fn(&[f64]) -> Vec<f64>) -> Self {
        let moves = self.moves.iter().map(|m| Move { law: m.law, end: point(&m.end) }).collect();
        Self { start: point(&self.start), moves }
    }

    /// The derivative of the accelerations at time `t`; at a jump, its value after the jump.
    #[doc(hidden)]
    pub fn jerk(&self, t: f64, dddq: &mut [f64]) {
        dddq.fill(0.0);
        let finished = self.moves.partition_point(|m| m.law.end_s() <= t);
        let begun = self.moves.iter().enumerate().skip(finished).take_while(|(_, m)| m.law.start_s <= t);
        for (k, motion) in begun {
            let ddds = motion.law.jerk(t);
            let from_to = self.start_of(k).iter().zip(&motion.end);
            dddq.iter_mut().zip(from_to).for_each(|(dddq, (from, to))| *dddq += (to - from) * ddds);
        }
    }

    /// The start point of move `k`, from zero.
    fn start_of(&self, k: usize) -> &[f64] {
        if k == 0 { &self.start } else { &self.moves[k - 1].end }
    }

    fn add_move(&self, k: usize, t: f64, q: &mut [f64], dq: &mut [f64], ddq: &mut [f64]) {
        let (s, ds, dds) = self.moves[k].law.evaluate(t);
        for (j, (from, to)) in self.start_of(k).iter().zip(&self.moves[k].end).enumerate() {
            let displacement = to - from;
            q[j] += displacement * s;
            dq[j] += displacement * ds;
            ddq[j] += displacement * dds;
        }
    }
}

fn check_move(number: usize, motion: &Move, joints: usize) -> Result<(), TrajectoryError> {
    let what = format!("the end point of move {number}");
    if motion.end.len() != joints {
        return Err(TrajectoryError::JointCount { what, expected: joints, found: motion.end.len() });
    }
    check_finite(&what, &motion.end)?;
    let TimeLaw { start_s, t1_s, t2_s, t3_s } = motion.law;
    check_finite(&format!("a time of move {number}"), &[start_s, t1_s, t2_s, t3_s])?;
    if t1_s >= t2_s && t2_s >= t3_s && t3_s > 0.0 {
        Ok(())
    } else {
        Err(TrajectoryError::TimeLaw { number, t1_s, t2_s, t3_s })
    }
}

fn check_order(moves: &[Move]) -> Result<(), TrajectoryError> {
    let unordered = |pair: &[Move]| {
        let (a, b) = (pair[0].law, pair[1].law);
        b.start_s < a.start_s || b.end_s() < a.end_s()
    };
    match moves.windows(2).position(unordered) {
        Some(k) => {
            let law = moves[k + 1].law;
            Err(TrajectoryError::Order { number: k + 2, start_s: law.start_s, end_s: law.end_s() })
        }
        None => Ok(()),
    }
}

fn check_finite(what: &str, values: &[f64]) -> Result<(), TrajectoryError> {
    match values.iter().find(|v| !v.is_finite()) {
        Some(&found) => Err(TrajectoryError::Value { what: what.to_owned(), expected: "a finite number", found }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three moves of two joints: the second starts 8 ms before the first has ended, the third after a rest.
    fn moves() -> Vec<Move> {
        let law = |start_s, t1_s| TimeLaw { start_s, t1_s, t2_s: 0.1, t3_s: 0.02 };
        vec![
            Move { law: law(0.1, 0.2), end: vec![1.0, -0.5] },
            Move { law: law(0.412, 0.3), end: vec![0.2, 0.7] },
            Move { law: law(1.0, 0.2), end: vec![0.2, 0.0] },
        ]
    }

    fn example() -> Moves {
        Moves::new(vec![0.1, 0.2], moves()).unwrap()
    }

    fn at(m: &Moves, t: f64) -> [Vec<f64>; 3] {
        let mut out = [vec![9.0; 2], vec![9.0; 2], vec![9.0; 2]];
        let [q, dq, ddq] = &mut out;
        m.evaluate(t, q, dq, ddq);
        out
    }

    #[test]
    fn it_rests_at_the_end_points() {
        let m = example();
        for (t, point) in [(0.0, [0.1, 0.2]), (0.9, [0.2, 0.7]), (1.4, [0.2, 0.0])] {
            assert_eq!(at(&m, t), [point.to_vec(), vec![0.0; 2], vec![0.0; 2]]);
        }
        assert!((m.start_s(), m.end_s()) == (0.1, m.moves()[2].law.end_s()));
    }

    /// The jerk is at most D / (T1 T2 T3), here 2 * 1.2 / 4e-4 where two moves overlap.
    #[test]
    fn overlapping_moves_add_up_without_a_step() {
        let (m, h) = (example(), 1e-6);
        let mut t = 0.40;
        while t < 0.44 {
            let ([q0, dq0, ddq0], [q1, dq1, ddq1]) = (at(&m, t), at(&m, t + h));
            for j in 0..2 {
                assert!((q1[j] - q0[j] - dq0[j] * h).abs() < 1e-9, "q at {t}");
                assert!((dq1[j] - dq0[j] - ddq0[j] * h).abs() < 1e-8, "dq at {t}");
                assert!((ddq1[j] - ddq0[j]).abs() < 6e3 * h, "ddq at {t}");
            }
            t += 7e-6;
        }
    }

    #[test]
    fn the_overlap_is_the_sum_of_both_moves() {
        let (m, t) = (example(), 0.416);
        let (a, b) = (m.moves()[0].law.evaluate(t).0, m.moves()[1].law.evaluate(t).0);
        assert!(a < 1.0 && b > 0.0);
        assert!((at(&m, t)[0][0] - (0.1 + 0.9 * a - 0.8 * b)).abs() < 1e-15);
    }

    #[test]
    fn samples_are_those_of_evaluate() {
        let m = example();
        let Motion { q, dq, ddq } = m.sample(100.0, 60);
        assert_eq!([q.sample(42).to_vec(), dq.sample(42).to_vec(), ddq.sample(42).to_vec()], at(&m, 0.42));
    }

    #[test]
    fn it_goes_through_a_file_unchanged() {
        let text = toml::to_string(&example()).unwrap();
        assert_eq!(toml::from_str::<Moves>(&text).unwrap(), example());
    }

    #[test]
    fn a_file_is_checked() {
        let text = toml::to_string(&example()).unwrap().replace("t3_s = 0.02", "t3_s = 0.0");
        assert!(toml::from_str::<Moves>(&text).unwrap_err().to_string().contains("t3_s > 0"));
    }

    fn error_after(change: impl Fn(&mut Vec<Move>)) -> TrajectoryError {
        let mut changed = moves();
        change(&mut changed);
        Moves::new(vec![0.1, 0.2], changed).unwrap_err()
    }

    #[test]
    fn each_defect_is_refused() {
        use TrajectoryError::{JointCount, Order, TimeLaw, Value};
        assert!(matches!(error_after(|m| m[1].end.push(0.0)), JointCount { expected: 2, found: 3, .. }));
        assert!(matches!(error_after(|m| m[1].end[0] = f64::NAN), Value { .. }));
        assert!(matches!(error_after(|m| m[2].law.start_s = f64::INFINITY), Value { .. }));
        assert!(matches!(error_after(|m| m[0].law.t2_s = 0.25), TimeLaw { number: 1, .. }));
        assert!(matches!(error_after(|m| m[2].law.start_s = 0.3), Order { number: 3, .. }));
    }
}
