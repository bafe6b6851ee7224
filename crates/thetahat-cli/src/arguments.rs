use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use thetahat::identification::Method;

/// Identifies the dynamic parameters of a robot from its recorded motion and torques.
///
/// Exit codes: 0 good; 1 finished, but a nominal run is not to be trusted; 2 error.
#[derive(Parser)]
#[command(version)]
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
    /// Identify the robot of an experiment file.
    Identify(Identify),
    /// Predict the torques of another motion with identified parameters.
    Predict(Predict),
    /// What errors of the simulator do to the estimates of idim-iv and didim.
    ///
    /// Identifies with the simulator's gear ratios, drive gains, controller gains, delay, reference and friction wrong by
    /// steps, and compares with the estimates without error.
    Sensitivity(Sensitivity),
    /// Record the simulated robot that an experiment describes in [twin].
    Simulate(Simulate),
}

#[derive(Args)]
pub struct Output {
    /// Folder for results.json, parameters.csv and report.html [default: tables in the terminal only]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

#[derive(Args)]
pub struct Identify {
    #[command(flatten)]
    pub described: Described,
    #[command(flatten)]
    pub output: Output,
}

#[derive(Args)]
pub struct Sensitivity {
    #[command(flatten)]
    pub described: Described,
    /// Folder for sensitivity.csv and sensitivity.html [default: a table in the terminal only]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Threads; the result does not depend on them [default: one for each core]
    #[arg(long, value_name = "N")]
    pub threads: Option<std::num::NonZeroUsize>,
}

/// An experiment with its data.
#[derive(Args)]
pub struct Described {
    /// The experiment file
    #[arg(value_name = "EXPERIMENT.toml")]
    pub experiment: PathBuf,
    /// Folder of the data, against which the experiment's paths are resolved [default: that of the experiment]
    #[arg(long, value_name = "DIR")]
    pub data: Option<PathBuf>,
    /// Robot description instead of the one that the experiment names
    #[arg(long, value_name = "FILE")]
    pub robot: Option<PathBuf>,
}

#[derive(Args)]
pub struct Simulate {
    /// The experiment file
    #[arg(value_name = "EXPERIMENT.toml")]
    pub experiment: PathBuf,
    /// CSV file for time, joint positions and joint torques
    #[arg(long, value_name = "FILE.csv")]
    pub out: PathBuf,
}

#[derive(Args)]
pub struct Predict {
    /// The results.json of an identification
    #[arg(value_name = "RESULTS.json")]
    pub results: PathBuf,
    /// The recording; its channels are described as in the experiment
    #[arg(long, value_name = "FILE")]
    pub recording: PathBuf,
    /// The file of its torques, where they are not in the same one
    #[arg(long, value_name = "FILE")]
    pub torque: Option<PathBuf>,
    /// The case whose parameters are taken
    #[arg(long, default_value = "nominal")]
    pub case: String,
    /// The method whose parameters are taken [default: the first of the case with an estimate]
    #[arg(long)]
    pub method: Option<MethodName>,
    /// CSV file for the torques, sample by sample
    #[arg(long, value_name = "FILE.csv")]
    pub out: Option<PathBuf>,
}

#[derive(Clone, Copy, ValueEnum)]
pub enum MethodName {
    IdimLs,
    IdimIv,
    Didim,
}

impl From<MethodName> for Method {
    fn from(name: MethodName) -> Self {
        match name {
            MethodName::IdimLs => Self::IdimLs,
            MethodName::IdimIv => Self::IdimIv,
            MethodName::Didim => Self::Didim,
        }
    }
}
