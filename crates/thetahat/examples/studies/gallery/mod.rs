//! Makes the reports of recorded robots, and a page that shows their verdicts.
//!
//! ```sh
//! cargo run --release -p thetahat --example studies -- gallery DATA OUT
//! ```
//!
//! DATA is the folder with `tx40`, `emps`, `kuka_lwr4` and `ur10`. OUT gets a folder for each report and `index.html`, with
//! pictures of the reports where Chromium is installed.

mod entry;
mod picture;

use std::{
    error::Error,
    fs,
    path::{Path, PathBuf},
};

use self::entry::entry;
use minijinja::{Environment, Value, context};
use thetahat::{Experiment, report::Published, results::Verdict};
use thetahat_ground::output::replace_file;
use thetahat_report::report;

/// The experiments, in the order of the page.
const EXPERIMENTS: [&str; 4] = ["tx40_paper", "emps", "kuka_lwr4", "ur10"];
const INDEX: &str = include_str!("index.html");

/// Runs the study.
pub fn main() -> Result<(), Box<dyn Error>> {
    let [data, out] = folders()?;
    let entries = EXPERIMENTS.iter().map(|name| report(name, &data, &out)).collect::<Result<Vec<Value>, _>>()?;
    let mut environment = Environment::new();
    // The extension of the name switches escaping on.
    environment.add_template("index.html", INDEX)?;
    let page = environment.get_template("index.html")?.render(context! { entries })?;
    let index = out.join("index.html");
    replace_file(&index, page.as_bytes())?;
    println!("{}", index.display());
    Ok(())
}

fn folders() -> Result<[PathBuf; 2], Box<dyn Error>> {
    let folders: Vec<PathBuf> = super::arguments().map(PathBuf::from).collect();
    folders.try_into().map_err(|_| "usage: gallery DATA OUT".into())
}

/// Identifies, and writes the report and its picture.
fn report(name: &str, data: &Path, out: &Path) -> Result<Value, Box<dyn Error>> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../experiments").join(format!("{name}.toml"));
    let experiment = Experiment::read(&file, data)?;
    let published = experiment.published_path().map(|path| Published::read(&path)).transpose()?;
    let results = experiment.run(data, &mut |_| {})?;
    let folder = out.join(name);
    fs::create_dir_all(&folder)?;
    report::write_all(&results, published.as_ref(), &folder)?;
    let has_picture = picture::take(&folder.join("report.html"), &folder.join("report.png"))?;
    let note = if has_picture { "" } else { "; no chromium: no picture" };
    println!("{name}: {}{note}", results.verdict.map_or("no verdict", Verdict::name));
    Ok(entry(name, &results, has_picture))
}
