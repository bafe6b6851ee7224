//! Pictures of pages.

use std::{
    env, fs,
    io::{self, ErrorKind},
    path::Path,
    process::{Command, Stdio},
};

/// Names under which Chromium is installed.
const CHROMIUM: [&str; 3] = ["chromium", "chromium-browser", "google-chrome"];

/// Takes a picture of the first screen of `page`; false where there is no Chromium, or it takes none.
pub fn take(page: &Path, picture: &Path) -> io::Result<bool> {
    let page = fs::canonicalize(page)?;
    let named = env::var("CHROMIUM").ok();
    for program in named.iter().map(String::as_str).chain(CHROMIUM) {
        match run(program, &page, picture) {
            Err(error) if error.kind() == ErrorKind::NotFound => {}
            ended => return ended,
        }
    }
    Ok(false)
}

fn run(program: &str, page: &Path, picture: &Path) -> io::Result<bool> {
    let mut command = Command::new(program);
    command.args(["--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--window-size=1400,1000"]);
    command.arg(format!("--screenshot={}", picture.display())).arg(format!("file://{}", page.display()));
    let status = command.stdout(Stdio::null()).stderr(Stdio::null()).status()?;
    Ok(status.success() && picture.is_file())
}
