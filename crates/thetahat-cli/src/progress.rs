//! Progress on stderr for anything over a second.

use std::{
    io::IsTerminal,
    time::{Duration, Instant},
};

use indicatif::{ProgressBar, ProgressStyle};

/// How long to be silent.
const PATIENCE: Duration = Duration::from_secs(1);

/// A spinner on a terminal, lines elsewhere; neither before a second has passed.
pub struct Progress {
    started: Instant,
    bar: Option<ProgressBar>,
}

impl Progress {
    pub fn new() -> Self {
        Self { started: Instant::now(), bar: None }
    }

    pub fn tell(&mut self, stage: &str) {
        if self.started.elapsed() < PATIENCE {
            return;
        }
        if !std::io::stderr().is_terminal() {
            eprintln!("{:5.1} s  {stage}", self.started.elapsed().as_secs_f64());
            return;
        }
        let bar = self.bar.get_or_insert_with(spinner);
        bar.set_message(stage.to_owned());
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
    if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed}  {msg}") {
        bar.set_style(style);
    }
    bar.enable_steady_tick(Duration::from_millis(100));
    bar
}
