//! What a command prints, and what it says of its result.

use std::io::Write;

use thetahat::{results::Verdict, visible::visible_lines};

/// What a finished command says of its result: its exit code.
pub enum Ending {
    Good,
    NotTrusted,
}

impl Ending {
    /// Of results with this verdict; those without one were not judged.
    pub fn of(verdict: Option<Verdict>) -> Self {
        match verdict {
            Some(Verdict::Good | Verdict::Care) => Self::Good,
            Some(Verdict::DoNotUse) | None => Self::NotTrusted,
        }
    }
}

/// Prints; what names hold cannot steer the terminal. A reader that has gone away (`| head`) is no reason not to write the files.
pub fn print(text: &str) -> Result<(), std::io::Error> {
    match std::io::stdout().write_all(visible_lines(text).as_bytes()) {
        Err(e) if e.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
        result => result,
    }
}
