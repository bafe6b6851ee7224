//! What the motion of a design file must be.

use super::{description::Design, error::DesignError, options::MotionKind};

/// Most harmonics and starts.
const MOST_HARMONICS: usize = 50;
const MOST_STARTS: usize = 1000;
/// Most moves, and the shortest that is of use, in times of its smoothing.
const MOST_MOVES: usize = 200;
const LEAST_MOVE: f64 = 8.0;

impl Design {
    pub(super) fn validate_motion(&self) -> Result<(), DesignError> {
        let motion = &self.file.motion;
        self.require((1..=MOST_STARTS).contains(&motion.starts), "[motion] starts", "from 1 to 1000", motion.starts)?;
        match motion.kind {
            MotionKind::Fourier => self.validate_harmonics()?,
            MotionKind::Moves => self.validate_moves()?,
        }
        let joints = self.robot.coordinate_count();
        if let Some(start) = &motion.start {
            self.require(start.len() == joints, "[motion] start", &format!("{joints} positions"), start.len())?;
        }
        Ok(())
    }

    fn validate_harmonics(&self) -> Result<(), DesignError> {
        let motion = &self.file.motion;
        let of_moves = [
            ("moves", motion.moves.is_some()),
            ("smoothing_s", motion.smoothing_s.is_some()),
            ("rest_s", motion.rest_s.is_some()),
        ];
        for (key, is_given) in of_moves {
            self.require(
                !is_given,
                &format!("[motion] {key}"),
                "kind = \"moves\" with it",
                "given for a Fourier series",
            )?;
        }
        let harmonics = motion.harmonics();
        self.require((1..=MOST_HARMONICS).contains(&harmonics), "[motion] harmonics", "from 1 to 50", harmonics)?;
        let (highest, cutoff) = (harmonics as f64 / self.file.duration_s, self.file.signal.cutoff_hz);
        let expected = format!("above {highest:.3}, the highest harmonic of the motion");
        self.require(cutoff > highest, "[signal] cutoff_hz", &expected, cutoff)
    }

    fn validate_moves(&self) -> Result<(), DesignError> {
        let motion = &self.file.motion;
        let expected = "kind = \"fourier\" with it";
        self.require(motion.harmonics.is_none(), "[motion] harmonics", expected, "given for moves")?;
        let (moves, smoothing, rest) = (motion.moves(), motion.smoothing_s(), motion.rest_s());
        self.require((2..=MOST_MOVES).contains(&moves), "[motion] moves", "from 2 to 200", moves)?;
        let positive = "a finite number above zero";
        self.require(smoothing > 0.0 && smoothing.is_finite(), "[motion] smoothing_s", positive, smoothing)?;
        self.require(rest >= 0.0 && rest.is_finite(), "[motion] rest_s", "zero or above", rest)?;
        let least = moves as f64 * (LEAST_MOVE * smoothing + rest);
        let expected =
            format!("above {least:.3}, which {moves} moves with smoothing and rest take; ask for fewer [motion] moves");
        self.require(self.file.duration_s > least, "duration_s", &expected, self.file.duration_s)
    }
}
