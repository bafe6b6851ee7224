use std::{fmt::Write as _, path::PathBuf};

use super::{control::ProposedControl, joints::ProposedLock, set_aside::SetAside, stated::Stated};
use thetahat_data::recording::{Side, Unit};
use thetahat_ground::{one_or_each::OneOrEach, output::PROPOSAL, visible::visible};
use thetahat_report::results::{Filter, FilterChoice};

/// How the reason of a guess says that it is one.
const GUESS: &str = "a guess";

/// Columns that are left out and shown by name.
const SHOWN: usize = 8;

/// An experiment as it is proposed. [`Proposal::text`] is its file.
#[derive(Debug, Clone, PartialEq)]
pub struct Proposal {
    /// A line that says what it is.
    pub title: String,
    /// The robot description.
    pub robot_file: PathBuf,
    /// The joints that are locked, as the log lacks them.
    pub locks: Vec<ProposedLock>,
    /// Columns of signals that are not used, as those of joints that are not identified.
    pub unused: Vec<String>,
    /// Files of which nothing is used.
    pub unused_files: Vec<PathBuf>,
    /// The controller, where the log has no torques.
    pub control: Option<ProposedControl>,
    /// What is known of the driver that wrote the log.
    pub driver: Option<ProposedDriver>,
    /// The recordings.
    pub recordings: Vec<ProposedRecording>,
    /// Filters, decimation and window.
    pub signal: ProposedSignal,
    pub(super) stated: Stated,
    pub(super) set_aside: Vec<SetAside>,
    /// Drivers that may have written the log, where none was named.
    pub(super) likely_drivers: Vec<String>,
}

/// What is known of the driver that wrote the log.
#[derive(Debug, Clone, PartialEq)]
pub struct ProposedDriver {
    /// The driver, and what it means by torque.
    pub head: String,
    /// Where that is documented.
    pub sources: Vec<String>,
    /// What the user should know of it.
    pub notes: Vec<String>,
    /// What in the log contradicts it.
    pub contradictions: Vec<String>,
}

/// A recording with its signals.
#[derive(Debug, Clone, PartialEq)]
pub struct ProposedRecording {
    /// Its name, where there are several.
    pub name: Option<String>,
    /// Its times or its rate.
    pub clock: ProposedClock,
    /// Positions, torques and what else was found, by the name of the key.
    pub channels: Vec<(&'static str, ProposedChannels)>,
}

/// Times, or a rate alone.
#[derive(Debug, Clone, PartialEq)]
pub struct ProposedClock {
    /// Samples per second.
    pub rate_hz: f64,
    /// The times; `None` if the rate is stated.
    pub time: Option<ProposedChannels>,
}

/// The channels of a signal.
#[derive(Debug, Clone, PartialEq)]
pub struct ProposedChannels {
    /// Their file, as the experiment is to name it.
    pub file: PathBuf,
    /// Their topic, where the file has several.
    pub topic: Option<String>,
    /// Their columns.
    pub columns: Vec<String>,
    /// Their unit, or that of each joint where some turn and others slide.
    pub unit: OneOrEach<Unit>,
    /// Their side of the gears.
    pub side: Side,
    /// Whether the last line of their file is cut.
    pub drop_cut_line: bool,
    /// Whether they are rows of a matrix.
    pub channels_in_rows: bool,
    /// What the user should know of them.
    pub comment: String,
    /// What their gain is, for the user to fill in, where the unit alone gives no torque or position.
    pub gain: Option<String>,
    /// Their gain where it is known.
    pub factor: Option<OneOrEach<f64>>,
    /// Whether some channels may as well be in another unit.
    pub unit_guessed: bool,
    /// What in the log contradicts the driver.
    pub contradiction: Option<String>,
    /// Whether they stand in a comment, for the user to put right.
    pub left_out: bool,
}

/// The `[signal]` table.
#[derive(Debug, Clone, PartialEq)]
pub struct ProposedSignal {
    /// Cut-off of the position filter, Hz.
    pub cutoff_hz: f64,
    /// Factor of the parallel decimation.
    pub decimation: usize,
    /// Start and end of the window, s; `None` for the default one.
    pub window_s: [Option<f64>; 2],
    /// Why, in lines of up to 118 characters.
    pub comment: Vec<String>,
}

/// The dynamics of robots of this size: their motion and torques lie below, in Hz (the paper's section V-A).
const DYNAMICS_HZ: f64 = 10.0;
/// Cut-off of the position filter and of the parallel filter, in multiples of the dynamics' (section V-A).
const CUT_OFFS: [f64; 2] = [5.0, 2.0];
/// Part of the sample rate above which no position filter is proposed.
const HIGHEST_CUT_OFF: f64 = 0.2;
/// The parallel filter cuts at this part of the sample rate over the factor.
const DECIMATION_CUT_OFF: f64 = 0.4;

impl ProposedSignal {
    /// The usual filter of industrial robots, from the rate alone.
    #[must_use]
    pub fn usual(rate_hz: f64) -> Self {
        Self {
            cutoff_hz: (CUT_OFFS[0] * DYNAMICS_HZ).min((HIGHEST_CUT_OFF * rate_hz * 100.0).round() / 100.0),
            decimation: (DECIMATION_CUT_OFF * rate_hz / (CUT_OFFS[1] * DYNAMICS_HZ)).round().max(1.0) as usize,
            window_s: [None; 2],
            comment: vec![format!(
                "Cut-offs for motion and torques below {DYNAMICS_HZ} Hz: 5 times that for the positions, 2 times for the rows."
            )],
        }
    }

    /// What was chosen from the recordings, with its neighbours.
    #[must_use]
    pub fn chosen(choice: &FilterChoice) -> Self {
        let Filter { cutoff_hz, decimation } = choice.best;
        let head = [
            "Chosen from the data: on a simulated twin of the recording the estimates with this filter are nearest to the truth."
                .to_owned(),
            format!("The motion lies below {:.1} Hz. Errors with other filters, over the least;", choice.dynamics_hz),
            "\"every\" is decimation, the frequencies are cutoff_hz:".to_owned(),
        ];
        let comment = head.into_iter().chain(choice.lines().into_iter().map(|line| format!("  {line}"))).collect();
        Self { cutoff_hz, decimation, window_s: [None; 2], comment }
    }

    /// The same filter on another window.
    #[must_use]
    pub fn with_window(self, window_s: [Option<f64>; 2]) -> Self {
        Self { window_s, ..self }
    }

    /// The usual filter, where none could be chosen, with the reason.
    #[must_use]
    pub fn not_chosen(rate_hz: f64, reason: &str) -> Self {
        let usual = Self::usual(rate_hz);
        let why = format!("No filter could be chosen from the data: {}.", reason.replace('\n', " "));
        Self { comment: std::iter::once(why).chain(usual.comment).collect(), ..usual }
    }

    fn text(&self) -> String {
        let mut text = String::from("\n");
        self.comment.iter().for_each(|line| text += &format!("# {}\n", visible(line)));
        let _ = write!(text, "[signal]\ncutoff_hz = {}\ndecimation = {}\n", self.cutoff_hz, self.decimation);
        for (key, end) in ["window_start_s", "window_end_s"].into_iter().zip(self.window_s) {
            end.into_iter().for_each(|s| text += &format!("{key} = {s}\n"));
        }
        text
    }
}

impl Proposal {
    /// The text of the experiment file, with what was guessed in its comments.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = format!(
            "{PROPOSAL}{}. Read every line, then run `thetahat check`: it examines the units and signs.\n\
             title = {}\nrobot = {}\n",
            visible(&self.files()),
            quoted(&self.title),
            quoted(&self.robot_file.display().to_string()),
        );
        text += &self.driver_text();
        text += &self.locks_text();
        text += &self.unused_text();
        let head = if self.recordings.len() == 1 { "[recording]" } else { "[[recording]]" };
        self.recordings.iter().for_each(|recording| text += &format!("\n{head}\n{}", recording.text()));
        text += &self.signal.text();
        text += &self.control.as_ref().map_or_else(|| self.stated.text(), ProposedControl::text);
        text
    }

    /// What could not be known of the recordings and was guessed, a sentence each.
    #[must_use]
    pub fn guesses(&self) -> Vec<String> {
        let of_recording = |recording: &ProposedRecording| {
            let place = recording.name.iter().map(|name| format!("{name}: ")).collect::<String>();
            let time = recording.clock.time.iter().map(|time| ("time", time));
            let channels = recording.channels.iter().map(|(signal, channels)| (*signal, channels));
            let guessed = time.chain(channels).filter(|(_, channels)| channels.comment.contains(GUESS));
            guessed.map(|(signal, channels)| format!("{place}{signal}: {}", channels.assumption())).collect::<Vec<_>>()
        };
        let locks = self.locks.iter().filter(|lock| lock.why.contains(GUESS));
        let locks = locks.map(|lock| format!("{} is locked at {}: {}", lock.joint, lock.value, lock.why));
        self.recordings.iter().flat_map(of_recording).chain(locks).collect()
    }

    /// What the user must fill in before the experiment can run, a sentence each.
    #[must_use]
    pub fn to_fill_in(&self) -> Vec<String> {
        let channels = self.recordings.iter().flat_map(|recording| &recording.channels);
        let mut sentences: Vec<String> = channels.filter_map(|(_, channels)| channels.gain.clone()).collect();
        sentences.dedup();
        sentences.extend(self.control.as_ref().map_or_else(|| self.stated.to_fill_in(), ProposedControl::to_fill_in));
        sentences
    }

    /// What is known of the driver that wrote the log, and what in it contradicts that, a sentence each.
    #[must_use]
    pub fn of_driver(&self) -> Vec<String> {
        let Some(driver) = &self.driver else {
            let is_known = !self.likely_drivers.is_empty();
            return is_known
                .then(|| visible(&format!("Note: {}.", said_of(&self.likely_drivers))).into_owned())
                .into_iter()
                .collect();
        };
        let contradictions =
            driver.contradictions.iter().map(|what| format!("The log contradicts the driver: {what}."));
        let sources = driver.sources.iter().map(|source| format!("Source: {source}"));
        let head = [driver.head.clone()].into_iter().chain(sources);
        let lines = head.chain(driver.notes.iter().cloned()).chain(contradictions);
        lines.map(|line| visible(&line).into_owned()).collect()
    }

    fn driver_text(&self) -> String {
        let lines: String = self.of_driver().iter().map(|line| format!("# {line}\n")).collect();
        if lines.is_empty() { lines } else { format!("\n{lines}") }
    }

    fn locks_text(&self) -> String {
        if self.locks.is_empty() {
            return String::new();
        }
        let line = |lock: &ProposedLock| format!("{} = {:?}  # {}\n", quoted_key(&lock.joint), lock.value, lock.why);
        let lines: String = self.locks.iter().map(line).collect();
        "\n# Joints that stand or have no torques in the log, in rad or m: they do not move, and their links are parts of\n\
         # those that carry them. The other joints are numbered anew in the names of parameters.\n[locked]\n"
            .to_owned()
            + &lines
    }

    /// What is not used of the recordings, a sentence for each reason: files, and columns of signals.
    #[must_use]
    pub fn not_used(&self) -> Vec<String> {
        let files = self.unused_files.iter().map(|file| file.display().to_string());
        let all: Vec<String> = files.chain(self.unused.iter().cloned()).collect();
        let others = [("no signal of a joint that is identified", &all)];
        let set_aside = self.set_aside.iter().map(|set_aside| (set_aside.why, &set_aside.columns));
        let not_empty = set_aside.chain(others).filter(|(_, names)| !names.is_empty());
        not_empty.map(|(why, names)| format!("Not used, as {why}: {}.", shortened(names))).collect()
    }

    fn unused_text(&self) -> String {
        let lines: String = self.not_used().iter().map(|line| format!("# {line}\n")).collect();
        if lines.is_empty() { lines } else { format!("\n{lines}") }
    }

    fn files(&self) -> String {
        let mut files: Vec<String> = Vec::new();
        for (_, channels) in self.recordings.iter().flat_map(|r| &r.channels) {
            let file = channels.file.display().to_string();
            if !files.contains(&file) {
                files.push(file);
            }
        }
        files.join(", ")
    }
}

impl ProposedRecording {
    fn text(&self) -> String {
        let mut text = String::new();
        self.name.iter().for_each(|name| text += &format!("name = {}\n", quoted(name)));
        text += &match &self.clock.time {
            Some(time) => time.line("time"),
            None => format!("sample_rate_hz = {}\n", self.clock.rate_hz),
        };
        self.channels.iter().for_each(|(name, channels)| text += &channels.line(name));
        text
    }
}

impl ProposedChannels {
    /// The unit that was assumed, and why.
    fn assumption(&self) -> String {
        let why = self.comment.split_once("; unit ").map_or(self.comment.as_str(), |(_, why)| why);
        let why = why.strip_prefix("a guess: ").or_else(|| why.strip_prefix("a guess ")).unwrap_or(why);
        let mut units: Vec<&str> = self.unit.given().iter().map(|unit| unit.symbol()).collect();
        units.dedup();
        format!("we assumed {} ({})", units.join(", "), why.trim_end_matches('.'))
    }

    fn line(&self, name: &str) -> String {
        let names: Vec<String> = self.columns.iter().map(|c| quoted(c)).collect();
        let topic = self.topic.iter().map(|t| format!(", topic = {}", quoted(t))).collect::<String>();
        let side = match self.side {
            Side::Motor => ", side = \"motor\"",
            Side::Joint => "",
        };
        let gain = match (&self.gain, &self.factor) {
            (Some(_), _) => ", gain = []".to_owned(),
            (None, Some(factor)) => format!(", gain = {}", numbers(factor)),
            (None, None) => String::new(),
        };
        let to_fill = self.gain.iter().map(|gain| format!("# {}\n", visible(gain))).collect::<String>();
        let cut = if self.drop_cut_line { ", drop_cut_line = true" } else { "" };
        let rows = if self.channels_in_rows { ", channels_in_rows = true" } else { "" };
        let guessed = if self.unit_guessed { ", unit_guessed = true" } else { "" };
        format!(
            "# {}\n{to_fill}{}{name} = {{ file = {}{topic}, columns = [{}], unit = {}{guessed}{side}{gain}{rows}{cut} }}\n",
            self.comment,
            if self.left_out { "# " } else { "" },
            quoted(&self.file.display().to_string()),
            names.join(", "),
            unit_text(&self.unit),
        )
    }
}

/// The first of some names, and how many more there are.
fn shortened(names: &[String]) -> String {
    let more = names.len().saturating_sub(SHOWN);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    visible(&names[..names.len().min(SHOWN)].join(" ")).into_owned() + &more
}

fn unit_text(unit: &OneOrEach<Unit>) -> String {
    let symbols: Vec<String> = unit.given().iter().map(|unit| quoted(unit.symbol())).collect();
    match unit {
        OneOrEach::One(_) => symbols.concat(),
        OneOrEach::Each(_) => format!("[{}]", symbols.join(", ")),
    }
}

fn numbers(factor: &OneOrEach<f64>) -> String {
    let numbers: Vec<String> = factor.given().iter().map(f64::to_string).collect();
    match factor {
        OneOrEach::One(_) => numbers.concat(),
        OneOrEach::Each(_) => format!("[{}]", numbers.join(", ")),
    }
}

/// A TOML key: bare where it may be.
fn quoted_key(name: &str) -> String {
    let is_bare = !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-');
    if is_bare { name.to_owned() } else { quoted(name) }
}

/// A TOML string.
fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

/// That a log may be of a driver.
pub(super) fn said_of(drivers: &[String]) -> String {
    let names = drivers.join(" or ");
    format!(
        "the names are those of the driver {names}: where it wrote the log, --from {names} knows what its torques are"
    )
}
