//! The program `thetahat`.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(thetahat_cli::run(std::env::args_os()))
}
