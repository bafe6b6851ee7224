//! What the motion of a design file must be.

use crate::design::{
    error::DesignError,
    limits::joint_limits::JointLimits,
    text::{description::Design, options::MotionKind},
};
use thetahat_model::dynamics::Model;

/// Most harmonics and starts.
const MOST_HARMONICS: usize = 50;
const MOST_STARTS: usize = 1000;
/// Most repetitions of a motion.
const MOST_PERIODS: usize = 1000;
/// Most moves, and the shortest that is of use, in times of its smoothing.
const MOST_MOVES: usize = 200;
const LEAST_MOVE: f64 = 8.0;
/// Most velocities of sweeps.
const MOST_SWEEPS: usize = 20;

impl Design {
    pub(in crate::design) fn validate_motion(&self) -> Result<(), DesignError> {
        let motion = &self.file.motion;
        self.require((1..=MOST_STARTS).contains(&motion.starts), "[motion] starts", "from 1 to 1000", motion.starts)?;
        self.require_own_keys()?;
        match motion.kind {
            MotionKind::Fourier => self.validate_harmonics()?,
            MotionKind::Splines => self.validate_splines()?,
            MotionKind::Moves => self.validate_moves()?,
        }
        let joints = self.robot.coordinate_count();
        if let Some(start) = &motion.start {
            self.require(start.len() == joints, "[motion] start", &format!("{joints} positions"), start.len())?;
        }
        Ok(())
    }

    /// Keys of another kind of motion are refused.
    fn require_own_keys(&self) -> Result<(), DesignError> {
        let motion = &self.file.motion;
        let keys = [
            ("harmonics", motion.harmonics.is_some(), MotionKind::Fourier),
            ("splines", motion.splines.is_some(), MotionKind::Splines),
            ("moves", motion.moves.is_some(), MotionKind::Moves),
            ("smoothing_s", motion.smoothing_s.is_some(), MotionKind::Moves),
            ("rest_s", motion.rest_s.is_some(), MotionKind::Moves),
            ("sweeps", motion.sweeps.is_some(), MotionKind::Moves),
            ("sweep_slowest", motion.sweep_slowest.is_some(), MotionKind::Moves),
            ("sweep_s", motion.sweep_s.is_some(), MotionKind::Moves),
        ];
        let periods = motion.periods.unwrap_or(1);
        let is_repeatable = motion.periods.is_none() || motion.kind != MotionKind::Moves;
        self.require(is_repeatable, "[motion] periods", "kind = \"fourier\" or \"splines\" with it", periods)?;
        self.require((1..=MOST_PERIODS).contains(&periods), "[motion] periods", "from 1 to 1000", periods)?;
        for (key, is_given, kind) in keys {
            let expected = format!("kind = \"{}\" with it", kind.name());
            let found = format!("given with kind = \"{}\"", motion.kind.name());
            self.require(!is_given || motion.kind == kind, &format!("[motion] {key}"), &expected, found)?;
        }
        Ok(())
    }

    fn validate_harmonics(&self) -> Result<(), DesignError> {
        let harmonics = self.file.motion.harmonics(self.file.duration_s);
        self.require((1..=MOST_HARMONICS).contains(&harmonics), "[motion] harmonics", "from 1 to 50", harmonics)?;
        self.require_cutoff_above(harmonics as f64 / self.period_s(), "the highest harmonic of the motion")
    }

    fn validate_splines(&self) -> Result<(), DesignError> {
        let splines = self.file.motion.splines();
        self.require((2..=2 * MOST_HARMONICS).contains(&splines), "[motion] splines", "from 2 to 100", splines)?;
        let highest = 0.5 * splines as f64 / self.period_s();
        self.require_cutoff_above(highest, "the frequency of splines that change their sides")
    }

    fn require_cutoff_above(&self, highest_hz: f64, what: &str) -> Result<(), DesignError> {
        let cutoff = self.file.signal.cutoff_hz;
        let expected = format!("above {highest_hz:.3}, {what}");
        self.require(cutoff > highest_hz, "[signal] cutoff_hz", &expected, cutoff)
    }

    fn validate_moves(&self) -> Result<(), DesignError> {
        let motion = &self.file.motion;
        let (moves, smoothing, rest) = (motion.moves(), motion.smoothing_s(self.file.duration_s), motion.rest_s());
        self.require((2..=MOST_MOVES).contains(&moves), "[motion] moves", "from 2 to 200", moves)?;
        let positive = "a finite number above zero";
        self.require(smoothing > 0.0 && smoothing.is_finite(), "[motion] smoothing_s", positive, smoothing)?;
        self.require(rest >= 0.0 && rest.is_finite(), "[motion] rest_s", "zero or above", rest)?;
        let least = self.least_moves_s();
        let expected =
            format!("above {least:.3}, which {moves} moves with smoothing and rest take; ask for fewer [motion] moves");
        self.require(self.file.duration_s > least, "duration_s", &expected, self.file.duration_s)
    }

    /// Sweeps from a posture that is given, in a part of the time.
    pub(in crate::design) fn validate_sweeps(&self, limits: &[JointLimits]) -> Result<(), DesignError> {
        let motion = &self.file.motion;
        let sweeps = motion.sweeps();
        if sweeps == 0 {
            let is_given = motion.sweep_slowest.is_some() || motion.sweep_s.is_some();
            let expected = "from 1 to 20 with [motion] sweep_slowest or sweep_s";
            return self.require(!is_given, "[motion] sweeps", expected, "none");
        }
        self.require((1..=MOST_SWEEPS).contains(&sweeps), "[motion] sweeps", "from 1 to 20", sweeps)?;
        let expected = "given with sweeps, which begin and end there";
        self.require(motion.start.is_some(), "[motion] start", expected, "missing")?;
        let (slowest, longest_s) = (motion.sweep_slowest(), motion.sweep_s());
        let is_part = slowest > 0.0 && slowest <= 1.0;
        self.require(is_part, "[motion] sweep_slowest", "above zero and at most 1", slowest)?;
        let is_time = longest_s > 0.0 && longest_s.is_finite();
        self.require(is_time, "[motion] sweep_s", "a finite number above zero", longest_s)?;
        let kept = self.kept(limits);
        let sweeps_s = self.move_family(&kept, self.sweeps(&Model::new(&self.robot), &kept)?).sweeps_s();
        let least = sweeps_s + self.least_moves_s();
        let expected = format!(
            "above {least:.3}: sweeps take {sweeps_s:.3} s of it; ask for fewer [motion] sweeps, or a shorter sweep_s"
        );
        self.require(self.file.duration_s > least, "duration_s", &expected, self.file.duration_s)
    }

    /// The shortest time of all moves.
    fn least_moves_s(&self) -> f64 {
        let motion = &self.file.motion;
        motion.moves() as f64 * (LEAST_MOVE * motion.smoothing_s(self.file.duration_s) + motion.rest_s())
    }
}
