//! The sweeps after the moves, as moves themselves.

use crate::design::motions::moves::{MoveFamily, Sweep};
use thetahat_estimation::{
    signal::Motion,
    trajectory::{Move, Moves, TimeLaw},
};
use thetahat_ground::series::Series;

impl MoveFamily {
    /// Time of all sweeps with their rests, s.
    pub(in crate::design) fn sweeps_s(&self) -> f64 {
        self.sweeps.iter().map(|sweep| sweep.seconds() + self.rest_s).sum()
    }

    /// The sweeps from a time on, as moves.
    pub(in crate::design) fn swept_from(&self, start_s: f64) -> Vec<Move> {
        self.laws(start_s, |_| true)
    }

    fn laws(&self, start_s: f64, is_taken: impl Fn(&Sweep) -> bool) -> Vec<Move> {
        let mut time_s = start_s;
        let one = |sweep: &Sweep| {
            let [t1_s, t2_s, t3_s] = sweep.widths;
            let law = TimeLaw { start_s: time_s, t1_s, t2_s, t3_s };
            time_s = law.end_s() + self.rest_s;
            Move { law, end: sweep.end.clone() }
        };
        self.sweeps.iter().filter(|sweep| is_taken(sweep)).map(one).collect()
    }

    /// The sweeps of one joint alone.
    pub(in crate::design) fn sweep_motion(&self, joint: usize, rate_hz: f64) -> Motion {
        let laws = self.laws(0.0, |sweep| sweep.joint == joint);
        let start = self.start.clone().unwrap_or_default();
        let samples = laws.last().map_or(0, |last| (last.law.end_s() * rate_hz) as usize);
        let none = || Series::zeros(0, self.joints());
        match Moves::new(start, laws) {
            Ok(moves) => moves.sample(rate_hz, samples),
            Err(_) => Motion { q: none(), dq: none(), ddq: none() },
        }
    }
}
