//! Progress on stderr for work longer than a second.

use std::{
    io::IsTerminal,
    time::{Duration, Instant},
};

use indicatif::{ProgressBar, ProgressStyle};
use thetahat_ground::visible::visible;

/// Time without output.
const PATIENCE: Duration = Duration::from_secs(1);

/// Time between lines for counted work without a terminal.
const LINE_EVERY: Duration = Duration::from_secs(10);

/// A spinner on a terminal, lines elsewhere; neither before a second has passed.
pub struct Progress {
    started: Instant,
    bar: Option<ProgressBar>,
}

impl Progress {
    pub fn new() -> Self {
        Self { started: Instant::now(), bar: None }
    }

    /// For one stage of some seconds: shown at once on a terminal, not elsewhere.
    pub fn of(stage: &str) -> Self {
        let bar = std::io::stderr().is_terminal().then(spinner);
        bar.iter().for_each(|bar| bar.set_message(stage.to_owned()));
        Self { started: Instant::now(), bar }
    }

    pub fn show(&mut self, stage: &str) {
        if self.started.elapsed() < PATIENCE {
            return;
        }
        let stage = visible(stage);
        if !std::io::stderr().is_terminal() {
            eprintln!("{:5.1} s  {stage}", self.started.elapsed().as_secs_f64());
            return;
        }
        let bar = self.bar.get_or_insert_with(spinner);
        bar.set_message(stage.into_owned());
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

fn spinner() -> ProgressBar {
    let bar = ProgressBar::new_spinner();
    if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed}  {wide_msg}") {
        bar.set_style(style);
    }
    bar.enable_steady_tick(Duration::from_millis(100));
    bar
}

/// Counted work done, and the time left: a bar on a terminal, lines elsewhere. Dropping it removes the bar.
pub struct Counter {
    unit: &'static str,
    started: Instant,
    last_shown: Option<Instant>,
    bar: Option<ProgressBar>,
}

impl Counter {
    /// A counter of pieces of work with this name.
    pub fn new(unit: &'static str) -> Self {
        let bar = std::io::stderr().is_terminal().then(|| ProgressBar::new(0));
        let template = format!("{{msg}} {{wide_bar}} {{pos}} of {{len}} {unit}, {{elapsed}} gone, {{eta}} left");
        if let Some((bar, style)) = bar.as_ref().zip(ProgressStyle::with_template(&template).ok()) {
            bar.set_style(style);
            bar.enable_steady_tick(Duration::from_millis(200));
        }
        Self { unit, started: Instant::now(), last_shown: None, bar }
    }

    /// Shows the progress with an additional message.
    pub fn show(&mut self, done: usize, to_do: usize, message: String) {
        if let Some(bar) = &self.bar {
            bar.set_length(to_do as u64);
            bar.set_position(done as u64);
            bar.set_message(message);
        } else if self.last_shown.is_none_or(|last| last.elapsed() >= LINE_EVERY) {
            self.last_shown = Some(Instant::now());
            let elapsed = self.started.elapsed().as_secs_f64();
            let left = elapsed / done.max(1) as f64 * to_do.saturating_sub(done) as f64;
            let left = if done > 0 { format!(", {left:.0} s left") } else { String::new() };
            eprintln!("{elapsed:5.0} s  {message}{done} of {to_do} {}{left}", self.unit);
        }
    }
}

impl Drop for Counter {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
