//! Completions for shells and manual pages, from the description of the arguments.

use std::{error::Error, fs};

use clap::CommandFactory;
use clap_complete::Shell;
use thetahat_ground::output::{FileKind, OutputGuard};

use crate::{
    arguments::{Arguments, Man},
    terminal::{Ending, print},
};

/// Name of the program.
const NAME: &str = "thetahat";

pub fn print_completions(shell: Shell) -> Result<Ending, Box<dyn Error>> {
    // In memory first: the generator panics if it cannot write, as into a closed pipe.
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Arguments::command(), NAME, &mut script);
    print(&String::from_utf8(script)?)?;
    Ok(Ending::Good)
}

pub fn write_manual(request: &Man) -> Result<Ending, Box<dyn Error>> {
    let command = Arguments::command();
    match &request.out {
        Some(folder) => {
            let refuse = |e| format!("{}: {e}", folder.display());
            OutputGuard::new([], request.force.force)
                .folder(folder, pages().iter().map(|page| (page.as_str(), FileKind::ManualPage)))?;
            fs::create_dir_all(folder).map_err(refuse)?;
            clap_mangen::generate_to(command, folder).map_err(refuse)?;
        }
        None => {
            let mut page = Vec::new();
            clap_mangen::Man::new(command).render(&mut page)?;
            print(&String::from_utf8(page)?)?;
        }
    }
    Ok(Ending::Good)
}

/// The files of the manual: one for thetahat and one for each command.
fn pages() -> Vec<String> {
    let command = Arguments::command();
    let of = |c: &clap::Command| format!("{NAME}-{}.1", c.get_name());
    command.get_subcommands().map(of).chain([format!("{NAME}.1")]).collect()
}
