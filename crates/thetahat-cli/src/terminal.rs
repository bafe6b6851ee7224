//! Output and exit code of a command.

use std::io::{self, Write};

use anstyle::{AnsiColor, Style};
use thetahat::{Results, results::Verdict};
use thetahat_ground::visible::visible_lines;
use thetahat_report::report::{self, TextWidth};

/// The outcome of a finished command: its exit code.
pub enum Ending {
    Good,
    NotTrusted,
}

impl Ending {
    /// The ending for results with this verdict, or without any.
    pub fn of(verdict: Option<Verdict>) -> Self {
        match verdict {
            Some(Verdict::Good | Verdict::Care) => Self::Good,
            Some(Verdict::DoNotUse) | None => Self::NotTrusted,
        }
    }
}

/// The columns for the layout of texts: those of the terminal, or 80 without a terminal.
pub fn width() -> TextWidth {
    terminal_size::terminal_size_of(io::stdout())
        .map_or_else(TextWidth::default, |(columns, _)| TextWidth::new(columns.0.into()))
}

/// Prints with control characters made visible. A closed pipe (`| head`) is not an error: files are still written.
pub fn print(text: &str) -> Result<(), io::Error> {
    whole(io::stdout().write_all(visible_lines(text).as_bytes()))
}

/// Prints a remark on stderr.
pub fn remark(text: &str) -> Result<(), io::Error> {
    whole(io::stderr().write_all(visible_lines(text).as_bytes()))
}

/// Prints the verdict in its colour, if stdout is a terminal with colours and NO_COLOR is not set.
pub fn print_verdict(results: &Results) -> Result<(), io::Error> {
    let (headline, style) = (report::headline(results), style(results.verdict));
    whole(writeln!(anstream::stdout(), "{style}{}{style:#}", visible_lines(&headline)))
}

fn style(verdict: Option<Verdict>) -> Style {
    let colour = match verdict {
        Some(Verdict::Good) => AnsiColor::Green,
        Some(Verdict::Care) | None => AnsiColor::Yellow,
        Some(Verdict::DoNotUse) => AnsiColor::Red,
    };
    colour.on_default().bold()
}

fn whole(written: Result<(), io::Error>) -> Result<(), io::Error> {
    match written {
        Err(e) if e.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        result => result,
    }
}
