//! The command `design`.

use std::error::Error;

use thetahat::design::Design;
use thetahat_ground::output::OutputGuard;
use thetahat_report::report;

use crate::{
    arguments,
    inputs::threads,
    progress::Progress,
    terminal::{Ending, print, width},
};

pub fn run(request: &arguments::Design) -> Result<Ending, Box<dyn Error>> {
    let design = Design::read(&request.design)?;
    if let Some(directory) = &request.out {
        let guard = OutputGuard::new(design.input_files(), request.force.force);
        guard.folder(directory, report::DESIGN_FILES.into_iter().chain(report::MOVE_FILES))?;
    }
    let mut progress = Progress::new();
    let results = design.run(threads(request.threads), &mut |stage| progress.show(stage))?;
    drop(progress);
    print(&report::design_text(&results, width()))?;
    let Some(directory) = &request.out else {
        print(&format!("\nno files written; with --out DIR: {}\n", report::DESIGN_FILES.join(", ")))?;
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
