//! Progress on stderr for work longer than a second.

use std::{
    io::IsTerminal,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    thread,
    time::{Duration, Instant},
};

use indicatif::{ProgressBar, ProgressStyle};
use thetahat_ground::visible::visible;

/// Time without output.
const PATIENCE: Duration = Duration::from_secs(1);

/// Time between lines for counted work without a terminal.
const LINE_EVERY: Duration = Duration::from_secs(10);

/// A spinner on a terminal, lines elsewhere; neither before a second has passed.
pub struct Progress(Arc<Mutex<Stages>>);

/// The stages of some work.
struct Stages {
    started: Instant,
    /// The stage in the first second, which is shown at its end.
    waiting: Option<String>,
    bar: Option<ProgressBar>,
    has_ended: bool,
}

impl Progress {
    pub fn new() -> Self {
        let stages = Stages { started: Instant::now(), waiting: None, bar: None, has_ended: false };
        let stages = Arc::new(Mutex::new(stages));
        let shown_later = stages.clone();
        thread::spawn(move || {
            thread::sleep(PATIENCE);
            lock(&shown_later).show_waiting();
        });
        Self(stages)
    }

    /// For one stage of some seconds: shown at once on a terminal, not elsewhere.
    pub fn of(stage: &str) -> Self {
        let bar = std::io::stderr().is_terminal().then(spinner);
        bar.iter().for_each(|bar| bar.set_message(stage.to_owned()));
        Self(Arc::new(Mutex::new(Stages { started: Instant::now(), waiting: None, bar, has_ended: false })))
    }

    pub fn show(&mut self, stage: &str) {
        let mut stages = lock(&self.0);
        if stages.started.elapsed() < PATIENCE {
            stages.waiting = Some(stage.to_owned());
        } else {
            stages.waiting = None;
            stages.show(stage);
        }
    }
}

impl Stages {
    fn show_waiting(&mut self) {
        if let Some(stage) = self.waiting.take().filter(|_| !self.has_ended) {
            self.show(&stage);
        }
    }

    fn show(&mut self, stage: &str) {
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
        let mut stages = lock(&self.0);
        stages.has_ended = true;
        if let Some(bar) = &stages.bar {
            bar.finish_and_clear();
        }
    }
}

fn lock(stages: &Mutex<Stages>) -> MutexGuard<'_, Stages> {
    stages.lock().unwrap_or_else(PoisonError::into_inner)
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
