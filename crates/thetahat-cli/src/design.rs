//! The command `design`.

use std::{
    error::Error,
    ops::ControlFlow,
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
};

use thetahat::design::{Design, DesignProgress};
use thetahat_ground::output::OutputGuard;
use thetahat_report::report;

use crate::{
    arguments,
    inputs::threads,
    progress::{Counter, Progress},
    terminal::{Ending, print, width},
};

pub fn run(request: &arguments::Design) -> Result<Ending, Box<dyn Error>> {
    let design = Design::read(&request.design)?;
    if let Some(directory) = &request.out {
        let guard = OutputGuard::new(design.input_files(), request.force.force);
        guard
            .folder(directory, report::DESIGN_FILES.into_iter().chain(report::MOVE_FILES).chain(report::POINT_FILES))?;
    }
    let display = Display::new();
    let results = design.run_watched(threads(request.threads), &|progress| display.show(progress))?;
    drop(display);
    print(&report::design_text(&results, width()))?;
    let Some(directory) = &request.out else {
        print(&format!(
            "\nno files written; with --out DIR: {}\n",
            report::DESIGN_FILES.map(|(name, _)| name).join(", ")
        ))?;
        return Ok(Ending::Good);
    };
    let files = report::write_design(&results, directory)?;
    let names: String = files.iter().map(|f| format!("  {}\n", f.display())).collect();
    let recording = directory.join("recording.csv");
    print(&format!(
        "\nwritten:\n{names}Rehearse: thetahat simulate {} --out {}\nThen: thetahat identify {}\n",
        directory.join("rehearsal.toml").display(),
        recording.display(),
        directory.join("experiment.toml").display()
    ))?;
    Ok(Ending::Good)
}

/// The progress of a design on stderr. Ctrl-C stops the search, which ends with its best motion so far; the second one ends the program.
struct Display {
    shown: Mutex<Shown>,
    is_interrupted: Arc<AtomicBool>,
}

/// A stage: with a bar where it is counted.
enum Shown {
    Stage(Progress),
    Descents(&'static str, Counter),
}

impl Display {
    fn new() -> Self {
        let is_interrupted = Arc::new(AtomicBool::new(false));
        let flag = is_interrupted.clone();
        // Where no handler can be set, Ctrl-C ends the program as anywhere else.
        let _ = ctrlc::set_handler(move || {
            if flag.swap(true, Ordering::Relaxed) {
                std::process::exit(INTERRUPTED);
            }
            eprintln!("\nstopping: the best motion so far is verified and written; Ctrl-C again ends at once");
        });
        Self { shown: Mutex::new(Shown::Stage(Progress::new())), is_interrupted }
    }

    fn show(&self, progress: &DesignProgress) -> ControlFlow<()> {
        self.shown.lock().unwrap_or_else(PoisonError::into_inner).show(progress);
        if self.is_interrupted.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// The exit code of a program that Ctrl-C ended.
const INTERRUPTED: i32 = 130;

impl Shown {
    fn show(&mut self, &DesignProgress { stage, descents, best }: &DesignProgress) {
        let Some([done, of]) = descents else {
            if let Self::Descents(..) = self {
                *self = Self::Stage(Progress::new());
            }
            if let Self::Stage(progress) = self {
                progress.show(stage);
            }
            return;
        };
        if !matches!(self, Self::Descents(shown, _) if *shown == stage) {
            *self = Self::Descents(stage, Counter::new("descents"));
        }
        if let Self::Descents(_, counter) = self {
            let best = best.map_or_else(String::new, |best| format!(", criterion {best:.1} so far"));
            counter.show(done, of, format!("{stage}{best}: "));
        }
    }
}
