//! Moves through postures, each as fast as it can be: where searches begin.

use crate::design::{limits::joint_limits::JointLimits, motions::moves::MoveFamily};

impl MoveFamily {
    /// The unknowns of moves through postures, in units of the ranges: each as fast as limits of velocity, acceleration and jerk
    /// allow. The postures are drawn together until the time suffices.
    #[must_use]
    pub fn through(&self, postures: &[f64]) -> Vec<f64> {
        let mut scale = 1.0;
        loop {
            let mut x: Vec<f64> = postures.iter().map(|p| (scale * p).clamp(-1.0, 1.0)).collect();
            for number in 0..self.moves {
                let (from, to) = (self.point(&x, number), self.point(&x, number + 1));
                let widths = self.fastest(&from, &to);
                x.extend((0..self.widths()).map(|i| widths[i] / self.unit(i)));
            }
            if self.time_s(&x) <= self.duration_s || scale < 1e-6 {
                return x;
            }
            scale *= 0.97;
        }
    }

    /// Unknowns of the postures.
    #[must_use]
    pub fn posture_unknowns(&self) -> usize {
        self.of_widths(0)
    }

    /// Widths T1, T2 and T3 of a move within the limits, with `T1 >= T2 + T3`.
    pub(in crate::design) fn fastest(&self, from: &[f64], to: &[f64]) -> [f64; 3] {
        let least = |limit: fn(&JointLimits) -> Option<f64>| {
            let of = |((limits, from), to): ((&JointLimits, &f64), &f64)| limit(limits).map(|l| (to - from).abs() / l);
            self.limits.iter().zip(from).zip(to).filter_map(of).fold(0.0, f64::max)
        };
        let [v, a, j] = [least(|l| Some(l.velocity)), least(|l| Some(l.acceleration)), least(|l| l.jerk)];
        let t1 = v.max(a.sqrt()).max(j.cbrt()).max(2.0 * self.smoothing_s);
        let t2 = (a / t1).max((j / t1).sqrt()).max(self.smoothing_s);
        let t3 = (j / (t1 * t2)).max(self.smoothing_s);
        [t1.max(t2 + t3), t2, t3]
    }
}
