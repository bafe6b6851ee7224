use std::path::PathBuf;

use clap::{
    Args, Parser, Subcommand, ValueEnum,
    builder::{PossibleValuesParser, TypedValueParser},
    value_parser,
};
use clap_complete::Shell;
use thetahat::{
    Method, OneOrEach,
    experiment::Driver,
    export::ExportFormat,
    recording::{Side, Unit},
    symbolic::{DriveTorques, Language, ModelKind},
};

/// Identifies the dynamic parameters of a robot from its recorded motion and torques.
///
/// Exit codes: 0 the verdict is good or care; 1 finished, but the verdict is do-not-use; 2 error.
#[derive(Parser)]
#[command(name = "thetahat", version)]
pub struct Arguments {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Subcommand)]
pub enum Command {
    /// Identify a simulated TX40 with known parameters by the three methods.
    ///
    /// The simulated robot is recorded with noise and identified nominally and with the simulator's gear ratios at 90 %.
    Demo(Output),
    /// Show the content of recordings, and with --robot the experiment proposed for them.
    Inspect(Inspect),
    /// Write an experiment file for a robot and its recordings.
    Init(Init),
    /// Check the recordings of an experiment for problems.
    Check(Check),
    /// Compare results: settings that differ, differences of parameters in standard deviations, errors.
    Compare(Compare),
    /// Identify the robot of an experiment file.
    Identify(Identify),
    /// Write the identified robot as URDF, MJCF, SDF or JSON, with physically consistent inertias.
    ///
    /// FILE.covariance.json is written with the file: the covariance of its parameters.
    ///
    /// Exit code 1 if the verdict is do-not-use; --untrusted exports anyway.
    Export(Export),
    /// Write random robots from the distribution of the estimates, each physically consistent, for domain randomisation.
    ///
    /// Exit code 1 if the verdict is do-not-use; --untrusted samples anyway.
    Sample(Sample),
    /// Predict the torques of another motion with identified parameters.
    Predict(Predict),
    /// Watch a robot at work: torque residual, collision-like events, changes of friction and payload.
    ///
    /// Its first seconds show the noise and mean of the residual, and are taken for a robot without change. Then each event is a line.
    ///
    /// Exit codes: 0 nothing found; 1 something found; 2 error.
    Watch(Watch),
    /// Run a Monte Carlo campaign on a simulated robot and compare the methods.
    ///
    /// Runs that are already in the folder are not repeated: an interrupted campaign continues.
    Campaign(Campaign),
    /// Sensitivity of the estimates of idim-iv and didim to errors of the simulator.
    ///
    /// Identifies with errors in the simulator's gear ratios, drive gains, controller gains, delay, reference and friction,
    /// in steps, and compares with the estimates without errors.
    Sensitivity(Sensitivity),
    /// Reduce recordings of any length to a small file from which `solve` estimates.
    ///
    /// The file holds the samples of short recordings, and of long ones, which are read in pieces, triangular factors of the
    /// regression. Reductions of the same robot and the same [signal] can be merged.
    Reduce(Reduce),
    /// Identify from reductions, alone or merged: as `identify` from samples; from factors by IDIM-LS, and by IDIM-IV if they
    /// have instruments.
    Solve(Solve),
    /// Design the motion to record, and predict the interval of each parameter before the robot moves.
    ///
    /// The motion is optimal within the limits of the joints for all base parameters, including friction, motor inertias and
    /// offsets. The experiment for its recording is written with it.
    Design(Design),
    /// Record the simulated robot of an experiment ([twin]).
    Simulate(Simulate),
    /// Show a robot: its structure, its standard parameters, and its base parameters with their formulas.
    ///
    /// Exit code 1 if the base parameters are ambiguous: a length or an angle is nearly special.
    Model(Model),
    /// Generate code of a robot's model: C, Rust, Python, MATLAB or LaTeX.
    ///
    /// For example: thetahat generate robots/two_joint.toml --model idm --to c --out two_joint_idm.h
    Generate(Generate),
    /// Print the completions of a shell.
    ///
    /// For example: thetahat completions bash > ~/.local/share/bash-completion/completions/thetahat
    Completions(Completions),
    /// Print the manual page.
    Man(Man),
}

#[derive(Args)]
pub struct Completions {
    /// The shell
    #[arg(value_name = "SHELL")]
    pub shell: Shell,
}

#[derive(Args)]
pub struct Man {
    /// Folder for the manual pages of thetahat and of each command [default: the page of thetahat, printed]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    pub force: Force,
}

/// Options for the output of results.
#[derive(Args, Clone)]
pub struct Shown {
    /// Print every table: all methods and cases, diagnosis, convergence
    #[arg(long, conflicts_with_all = ["quiet", "json"])]
    pub full: bool,
    /// Print the verdict card only
    #[arg(long, conflicts_with = "json")]
    pub quiet: bool,
    /// Print results.json to stdout, and nothing else
    #[arg(long)]
    pub json: bool,
}

#[derive(Args, Clone)]
pub struct Output {
    #[command(flatten)]
    pub shown: Shown,
    /// Folder for results.json, parameters.csv and report.html [default: tables in the terminal only]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    pub force: Force,
}

/// Options for replacing files.
#[derive(Args, Clone)]
pub struct Force {
    /// Replace files that thetahat did not write; inputs and devices are never replaced
    #[arg(long)]
    pub force: bool,
}

#[derive(Args)]
pub struct Inspect {
    /// The recordings: several files of one recording, or several recordings
    #[arg(value_name = "FILE", required_unless_present = "recording", conflicts_with = "recording")]
    pub files: Vec<PathBuf>,
    /// The same as FILE
    #[arg(long, value_name = "FILE")]
    pub recording: Vec<PathBuf>,
    /// The robot description: URDF, xacro, MJCF or TOML
    #[arg(long, value_name = "FILE")]
    pub robot: Option<PathBuf>,
    #[command(flatten)]
    pub columns: Columns,
}

#[derive(Args)]
pub struct Init {
    /// The robot description: URDF, xacro, MJCF or TOML
    #[arg(long, value_name = "FILE", required_unless_present = "from")]
    pub robot: Option<PathBuf>,
    /// A recording; given again: another file of it, or another recording
    #[arg(long, value_name = "FILE", required_unless_present_any = ["from", "design"])]
    pub recording: Vec<PathBuf>,
    /// Write the design of a motion to record, for the robot alone, instead of an experiment
    #[arg(long, conflicts_with = "recording")]
    pub design: bool,
    #[command(flatten)]
    pub columns: Columns,
    /// The file to write; an existing file is kept [default: experiment.toml, or design.toml with --design]
    #[arg(long, value_name = "FILE.toml")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    pub force: Force,
}

/// Options for what the names of a recording's columns do not show.
#[derive(Args)]
pub struct Columns {
    #[arg(long, value_name = "DRIVER", help = drivers())]
    pub from: Option<String>,
    /// Columns of the positions, one for each joint, or one of a matrix: NAME, FILE (all its columns) or FILE:NAME
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub position: Vec<String>,
    /// Columns of the torques
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub torque: Vec<String>,
    /// The time column
    #[arg(long, value_name = "NAME")]
    pub time: Option<String>,
    /// The joints of the columns, in the robot's order, if their names do not show it; other joints are locked
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub joints: Vec<String>,
    /// Samples per second, if there is no time column
    #[arg(long, value_name = "HZ", conflicts_with = "time")]
    pub rate: Option<f64>,
    /// Unit of the positions, such as deg, or one for each joint: mm,mm,deg
    #[arg(long, value_name = "UNITS", value_parser = units)]
    pub position_unit: Option<OneOrEach<Unit>>,
    /// Unit of the torques, such as "mN m", or one for each joint
    #[arg(long, value_name = "UNITS", value_parser = units)]
    pub torque_unit: Option<OneOrEach<Unit>>,
    /// The side of the gears on which positions and torques were measured
    #[arg(long, value_name = "SIDE", value_parser = side())]
    pub side: Option<Side>,
    /// Gains of the position controller, N m/rad, one for all or one for each joint: for a log without torques
    #[arg(long, value_name = "GAINS", value_delimiter = ',')]
    pub kp: Vec<f64>,
    /// Gains of its velocity, N m s/rad
    #[arg(long, value_name = "GAINS", value_delimiter = ',')]
    pub kd: Vec<f64>,
    /// Start and end of the window, s [default: the moving part]
    #[arg(long, value_names = ["START", "END"], num_args = 2)]
    pub window_s: Option<Vec<f64>>,
    /// Joints that do not move, in rad or m, such as head_joint=0.2
    #[arg(long, value_name = "JOINT=VALUE", value_delimiter = ',', value_parser = lock)]
    pub lock: Vec<(String, f64)>,
}

#[derive(Args)]
pub struct Check {
    #[command(flatten)]
    pub described: Described,
    /// Print the findings as one JSON array, and nothing else
    #[arg(long)]
    pub json: bool,
}

#[derive(Args)]
pub struct Compare {
    /// Files or folders of `identify --out` or `solve --out`; the others are compared with the first, which may be the predicted.csv of a
    /// design
    #[arg(value_name = "RESULTS", required = true, num_args = 2..)]
    pub results: Vec<PathBuf>,
    /// The method whose parameters are compared [default: the model]
    #[arg(long, value_parser = method())]
    pub method: Option<Method>,
    /// The case
    #[arg(long, default_value = "nominal")]
    pub case: String,
    /// HTML file for the comparison
    #[arg(long, value_name = "FILE.html")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    pub force: Force,
}

#[derive(Args)]
pub struct Identify {
    #[command(flatten)]
    pub described: Described,
    #[command(flatten)]
    pub output: Output,
    /// Change the experiment as the remedies of these codes say: its next version is written next to it, identified, and
    /// compared with the run before; results.json of that run is looked for in --out, and those of this one go to DIR.2
    #[arg(long, value_name = "CODES", value_delimiter = ',')]
    pub apply: Vec<String>,
}

/// One unit, or one for each joint, between commas.
fn units(text: &str) -> Result<OneOrEach<Unit>, String> {
    let units = text.split(',').map(|unit| unit.trim().parse::<Unit>().map_err(|e| e.to_string()));
    let units: Vec<Unit> = units.collect::<Result<_, _>>()?;
    Ok(if let [unit] = units[..] { OneOrEach::One(unit) } else { OneOrEach::Each(units) })
}

fn at_least_one(text: &str) -> Result<usize, String> {
    text.parse().ok().filter(|n| *n > 0).ok_or_else(|| "expected a whole number, 1 or more".to_owned())
}

#[derive(Args)]
pub struct Sensitivity {
    #[command(flatten)]
    pub described: Described,
    /// Folder for sensitivity.csv and sensitivity.html [default: a table in the terminal only]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    pub force: Force,
    /// Threads; the result does not depend on them [default: one for each core]
    #[arg(long, value_name = "N", value_parser = at_least_one)]
    pub threads: Option<usize>,
}

/// An experiment with its data.
#[derive(Args, Clone)]
pub struct Described {
    /// The experiment file
    #[arg(value_name = "EXPERIMENT.toml")]
    pub experiment: PathBuf,
    /// Folder of the data: the experiment's paths are relative to it [default: that of the experiment]
    #[arg(long, value_name = "DIR")]
    pub data: Option<PathBuf>,
    /// Robot description instead of the one in the experiment
    #[arg(long, value_name = "FILE")]
    pub robot: Option<PathBuf>,
}

#[derive(Args)]
pub struct Campaign {
    /// The campaign file
    #[arg(value_name = "CAMPAIGN.toml")]
    pub campaign: PathBuf,
    /// Folder for runs.parquet, timing.parquet and campaign.html [default: tables in the terminal only]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    pub force: Force,
    /// Threads, each of which works on four recordings at a time [default: one for each processor]
    #[arg(long, value_name = "N", value_parser = at_least_one)]
    pub threads: Option<usize>,
    /// Only the first starts of the campaign
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..))]
    pub starts: Option<u32>,
    /// Only the first seeds of the campaign
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..))]
    pub seeds: Option<u32>,
}

#[derive(Args)]
pub struct Reduce {
    #[command(flatten)]
    pub described: Described,
    /// The file to write
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
    #[command(flatten)]
    pub force: Force,
    /// A results.json whose estimates simulate the instruments for IDIM-IV: its idim-iv, or otherwise idim-ls
    #[arg(long, value_name = "RESULTS.json")]
    pub instruments_from: Option<PathBuf>,
    /// Keep rows alone: `solve` then gives neither a model nor IDIM-IV without instruments
    #[arg(long)]
    pub rows_only: bool,
    /// Pieces processed at a time [default: one for each processor]
    #[arg(long, value_name = "N", value_parser = at_least_one)]
    pub threads: Option<usize>,
}

#[derive(Args)]
pub struct Solve {
    /// Files of `reduce`
    #[arg(value_name = "REDUCTION", required = true)]
    pub reductions: Vec<PathBuf>,
    #[command(flatten)]
    pub output: Output,
    /// File for the merged reduction
    #[arg(long, value_name = "FILE")]
    pub merged: Option<PathBuf>,
}

#[derive(Args)]
pub struct Design {
    /// The design file
    #[arg(value_name = "DESIGN.toml")]
    pub design: PathBuf,
    /// Folder for trajectory.csv, .yaml and .json, predicted.csv, experiment.toml, rehearsal.toml, design.html, and the moves for
    /// robots' controllers [default: tables in the terminal only]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    pub force: Force,
    /// Threads; the result does not depend on them [default: one for each core]
    #[arg(long, value_name = "N", value_parser = at_least_one)]
    pub threads: Option<usize>,
}

#[derive(Args)]
pub struct Simulate {
    /// The experiment file
    #[arg(value_name = "EXPERIMENT.toml")]
    pub experiment: PathBuf,
    /// CSV file for time, joint positions and joint torques
    #[arg(long, value_name = "FILE.csv")]
    pub out: PathBuf,
    #[command(flatten)]
    pub force: Force,
}

#[derive(Args)]
pub struct Model {
    /// The robot: a URDF, a xacro, an MJCF, or a TOML description
    #[arg(value_name = "ROBOT")]
    pub robot: PathBuf,
    /// Print one JSON object, in SI units
    #[arg(long)]
    pub json: bool,
    /// Print the base parameters as formulas in the names of the geometry, such as d3, and nothing else
    #[arg(long, conflicts_with = "json")]
    pub symbolic: bool,
    /// Folder against which the robot's path is resolved [default: the current one]
    #[arg(long, value_name = "DIR")]
    pub data: Option<PathBuf>,
    /// The last joints that move; all joints that are not on the path to them are locked at their neutral values
    #[arg(long, value_name = "JOINTS", value_delimiter = ',')]
    pub until: Vec<String>,
    /// Joints that do not move, in rad or m, such as head_joint=0.2
    #[arg(long, value_name = "JOINT=VALUE", value_delimiter = ',', value_parser = lock)]
    pub lock: Vec<(String, f64)>,
    /// An argument of a xacro, such as prefix:=left_
    #[arg(long, value_name = "NAME:=VALUE")]
    pub xacro_arg: Vec<String>,
    /// The folder of a package that a xacro finds, such as arm_description=robots/arm_description
    #[arg(long, value_name = "NAME=DIR")]
    pub package: Vec<String>,
    /// Write the URDF that a xacro is expanded to, which all commands take
    #[arg(long, value_name = "FILE.urdf")]
    pub expand: Option<PathBuf>,
    #[command(flatten)]
    pub force: Force,
}

#[derive(Args)]
pub struct Generate {
    /// The robot (a URDF or a TOML description), or the results.json of an identification
    #[arg(value_name = "ROBOT|RESULTS.json")]
    pub source: PathBuf,
    /// The model
    #[arg(long, value_parser = named(&ModelKind::ALL))]
    pub model: ModelKind,
    /// The language
    #[arg(long, value_parser = named(&Language::ALL))]
    pub to: Language,
    /// Whether parameters are an input or values in the code: the a-priori values of a robot, the estimates of results
    /// [default: symbolic for a robot, values for results]
    #[arg(long, value_enum)]
    pub parameters: Option<GeneratedParameters>,
    /// The base parameters instead of the standard ones
    #[arg(long)]
    pub base: bool,
    /// The method whose estimates are used [default: the model]
    #[arg(long, value_parser = method())]
    pub method: Option<Method>,
    /// The case whose estimates are used [default: nominal]
    #[arg(long)]
    pub case: Option<String>,
    /// The robot description that the results must belong to, unchanged
    #[arg(long, value_name = "FILE")]
    pub robot: Option<PathBuf>,
    /// The torques of the drives: all, only the inertia of the motors, or none
    #[arg(long, default_value = "all", value_parser = named(&DriveTorques::ALL))]
    pub drives: DriveTorques,
    /// Prefix of the names in the code [default: the robot's name]
    #[arg(long, value_name = "NAME")]
    pub name: Option<String>,
    /// The file to write [default: the code is printed]
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    pub trust: Trust,
    #[command(flatten)]
    pub force: Force,
    /// Folder against which the path is resolved [default: the current one]
    #[arg(long, value_name = "DIR")]
    pub data: Option<PathBuf>,
    /// The last joints that move; all joints that are not on the path to them are locked at their neutral values
    #[arg(long, value_name = "JOINTS", value_delimiter = ',')]
    pub until: Vec<String>,
    /// Joints that do not move, in rad or m, such as head_joint=0.2
    #[arg(long, value_name = "JOINT=VALUE", value_delimiter = ',', value_parser = lock)]
    pub lock: Vec<(String, f64)>,
}

/// The parameters of generated code.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum GeneratedParameters {
    /// An input.
    Symbolic,
    /// Values in the code.
    Values,
}

/// Values by their names, which help and completions list.
fn named<T: Copy + Send + Sync + 'static>(all: &'static [(&'static str, T)]) -> impl TypedValueParser<Value = T> {
    let value = |name: String| all.iter().find(|(known, _)| *known == name).map(|(_, value)| *value);
    PossibleValuesParser::new(all.iter().map(|(name, _)| *name)).try_map(move |name| value(name).ok_or("no such name"))
}

fn side() -> impl TypedValueParser<Value = Side> {
    PossibleValuesParser::new(["joint", "motor"]).map(|name| if name == "motor" { Side::Motor } else { Side::Joint })
}

fn lock(text: &str) -> Result<(String, f64), String> {
    let parts = text.rsplit_once('=').and_then(|(joint, value)| Some((joint.to_owned(), value.parse().ok()?)));
    parts.ok_or_else(|| "expected JOINT=VALUE with a number in rad or m".to_owned())
}

/// The estimate to export.
#[derive(Args)]
pub struct Exported {
    /// The results.json of an identification
    #[arg(value_name = "RESULTS.json")]
    pub results: PathBuf,
    /// The format
    #[arg(long, value_name = "FORMAT", value_parser = format())]
    pub to: ExportFormat,
    /// The method whose parameters are used [default: the model]
    #[arg(long, value_parser = method())]
    pub method: Option<Method>,
    /// Folder of the robot description, which must be unchanged since the identification [default: the text in the results]
    #[arg(long, value_name = "DIR")]
    pub data: Option<PathBuf>,
    /// The robot description itself, which must be unchanged
    #[arg(long, value_name = "FILE", conflicts_with = "data")]
    pub robot: Option<PathBuf>,
    /// Your own MuJoCo model, which gets the robot's inertias, armatures and friction; all else is kept
    #[arg(long, value_name = "MODEL.xml")]
    pub into: Option<PathBuf>,
    #[command(flatten)]
    pub trust: Trust,
    #[command(flatten)]
    pub force: Force,
}

/// Which results can be used.
#[derive(Args)]
pub struct Trust {
    /// Use results even if their verdict is do-not-use
    #[arg(long)]
    pub untrusted: bool,
}

#[derive(Args)]
pub struct Export {
    #[command(flatten)]
    pub exported: Exported,
    /// The file to write [default: the export goes to stdout, remarks to stderr]
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Read the export back and compare inverse dynamics at 1000 random states
    #[arg(long)]
    pub check: bool,
}

#[derive(Args)]
pub struct Sample {
    #[command(flatten)]
    pub exported: Exported,
    /// Number of robots
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..=100_000))]
    pub count: u32,
    /// Folder for the files, named by their numbers
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Seed of the random numbers
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub seed: u64,
}

/// Columns of a recording whose names differ from the experiment.
#[derive(Args)]
pub struct RenamedColumns {
    /// Columns of the positions, if their names differ from the experiment
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub position: Vec<String>,
    /// Columns of the torques, if their names differ from the experiment
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub torque: Vec<String>,
    /// The time column, if its name differs from the experiment
    #[arg(long, value_name = "NAME")]
    pub time: Option<String>,
    /// Unit of the time, such as ms, if it differs from the experiment
    #[arg(long, value_name = "UNIT")]
    pub time_unit: Option<Unit>,
}

#[derive(Args)]
pub struct Predict {
    /// The results.json of an identification
    #[arg(value_name = "RESULTS.json")]
    pub results: PathBuf,
    /// The recording, with the channels of the experiment
    #[arg(long, value_name = "FILE")]
    pub recording: PathBuf,
    /// The file of its torques, if it is another file
    #[arg(long, value_name = "FILE")]
    pub torque_file: Option<PathBuf>,
    #[command(flatten)]
    pub columns: RenamedColumns,
    /// Start and end of the window, s [default: that of the experiment, or otherwise the moving part]
    #[arg(long, value_names = ["START", "END"], num_args = 2)]
    pub window_s: Option<Vec<f64>>,
    /// The case whose parameters are used
    #[arg(long, default_value = "nominal")]
    pub case: String,
    /// The method whose parameters are used [default: the model]
    #[arg(long, value_parser = method())]
    pub method: Option<Method>,
    /// CSV file for the torques, sample by sample
    #[arg(long, value_name = "FILE.csv")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    pub force: Force,
}

#[derive(Args)]
pub struct Watch {
    /// The results.json of an identification, or its folder
    #[arg(value_name = "RESULTS")]
    pub results: PathBuf,
    /// The recording, with the channels of the experiment; - reads text from stdin
    #[arg(long, value_name = "FILE|-")]
    pub recording: PathBuf,
    /// Go on where a text file ends: wait for what is written to it, until interrupted
    #[arg(long)]
    pub follow: bool,
    #[command(flatten)]
    pub columns: RenamedColumns,
    /// Time in which the residual's noise and mean are learned, s
    #[arg(long, value_name = "SECONDS", default_value_t = 30.0)]
    pub settle: f64,
    /// False alarms per hour: half for collisions, half for changes
    #[arg(long, value_name = "RATE", default_value_t = 0.01)]
    pub alarms_per_hour: f64,
    /// Print the residual of each joint every so many seconds
    #[arg(long, value_name = "SECONDS")]
    pub every: Option<f64>,
    /// Print one JSON object per line
    #[arg(long)]
    pub json: bool,
    /// The case whose parameters are used
    #[arg(long, default_value = "nominal")]
    pub case: String,
    /// The method whose parameters are used [default: the model]
    #[arg(long, value_parser = method())]
    pub method: Option<Method>,
}

/// The formats of exports by their names.
fn format() -> impl TypedValueParser<Value = ExportFormat> {
    PossibleValuesParser::new(ExportFormat::ALL.map(ExportFormat::name)).try_map(|name| name.parse::<ExportFormat>())
}

/// The methods by their names, which help and completions list.
fn method() -> impl TypedValueParser<Value = Method> {
    PossibleValuesParser::new(Method::all().map(Method::name)).try_map(|name| name.parse::<Method>())
}

/// The help of `--from` with the names of the presets.
fn drivers() -> String {
    let names: Vec<&str> = Driver::names().collect();
    format!(
        "The driver that wrote the recording, whose columns, units and signs are known: {}; a file of your own, ./my_driver.toml; or \
         list, which shows what each means by effort",
        names.join(", ")
    )
}
