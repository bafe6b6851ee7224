//! A robot watched while it works: events as lines, as they happen.

use std::{
    error::Error,
    fs::File,
    io::{self, Read},
    path::Path,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::Duration,
};

use thetahat::{
    experiment::{EstimateRequest, PredictionRequest},
    watch::{GrowingText, Sample, Watch, WatchOptions, WatchedRobot, recorded_samples},
};
use thetahat_report::{
    report,
    results::{JointResult, WatchEvent},
};

use crate::{
    arguments,
    inputs::results_file,
    terminal::{Ending, print, width},
};

/// Bytes that are read at a time.
const BUFFER: usize = 1 << 16;
/// Time between two looks at a file that is followed.
const LOOK: Duration = Duration::from_millis(20);
/// The name of stdin.
const STDIN: &str = "-";

pub fn run(request: &arguments::Watch) -> Result<Ending, Box<dyn Error>> {
    let asked = asked(request);
    let chosen = EstimateRequest {
        case: request.case.clone(),
        method: request.method,
        // The verdict is said.
        untrusted: true,
        ..EstimateRequest::default()
    };
    let robot = WatchedRobot::read(&asked.results, &chosen)?;
    let output = Output { joints: robot.joints(), is_json: request.json, alarms: 0 };
    output.head(&robot)?;
    if request.recording == Path::new(STDIN) {
        let text = GrowingText::new(&robot, &asked)?;
        return Live { request, robot, text, watch: None, output }.run(io::stdin().lock(), false);
    }
    if request.follow {
        let text = GrowingText::new(&robot, &asked)?;
        let file = File::open(&request.recording)
            .map_err(|e| format!("{}: cannot be read: {e}", request.recording.display()))?;
        return Live { request, robot, text, watch: None, output }.run(file, true);
    }
    recorded(request, robot, &asked, output)
}

/// What is asked of the experiment's description of recordings.
fn asked(request: &arguments::Watch) -> PredictionRequest {
    PredictionRequest {
        results: results_file(&request.results),
        recording: request.recording.clone(),
        torque_file: None,
        position: request.columns.position.clone(),
        torque: request.columns.torque.clone(),
        time: request.columns.time.clone(),
        time_unit: request.columns.time_unit,
        window_s: None,
        case: request.case.clone(),
        method: request.method,
    }
}

fn options(request: &arguments::Watch) -> WatchOptions {
    WatchOptions { settle_s: request.settle, alarms_per_hour: request.alarms_per_hour, every_s: request.every }
}

/// Watches a recording that is complete.
fn recorded(
    request: &arguments::Watch,
    robot: WatchedRobot,
    asked: &PredictionRequest,
    mut output: Output,
) -> Result<Ending, Box<dyn Error>> {
    let (rate_hz, samples) = recorded_samples(&robot, asked)?;
    let mut watch = Watch::new(robot, rate_hz, options(request), &request.recording)?;
    for sample in samples {
        output.say_all(watch.push(&sample)?)?;
    }
    output.end(watch)
}

/// A text that grows.
struct Live<'a> {
    request: &'a arguments::Watch,
    robot: WatchedRobot,
    text: GrowingText,
    watch: Option<Watch>,
    output: Output,
}

impl Live<'_> {
    /// Watches until the text ends, or, where it is followed, until the user interrupts.
    fn run(mut self, mut source: impl Read, is_followed: bool) -> Result<Ending, Box<dyn Error>> {
        let is_interrupted = Arc::new(AtomicBool::new(false));
        let seen = Arc::clone(&is_interrupted);
        // Without it an interrupt ends the program without a summary.
        let _ = ctrlc::set_handler(move || seen.store(true, Ordering::Relaxed));
        let mut buffer = vec![0; BUFFER];
        while !is_interrupted.load(Ordering::Relaxed) {
            let count = match source.read(&mut buffer) {
                Err(e) if e.kind() == io::ErrorKind::Interrupted => continue,
                read => read.map_err(|e| format!("{}: cannot be read: {e}", self.request.recording.display()))?,
            };
            match (count, is_followed) {
                (0, false) => break,
                (0, true) => thread::sleep(LOOK),
                _ => {
                    let samples = self.text.read(&buffer[..count], false)?;
                    self.take(samples)?;
                }
            }
        }
        // A line that a logger has not finished is no line.
        let samples = if is_followed { Vec::new() } else { self.text.read(&[], true)? };
        self.take(samples)?;
        match self.watch {
            Some(watch) => self.output.end(watch),
            None => {
                Err(format!("{}: ended before its rate was known; record longer", self.request.recording.display())
                    .into())
            }
        }
    }

    fn take(&mut self, samples: Vec<Sample>) -> Result<(), Box<dyn Error>> {
        let Some(rate_hz) = self.text.rate_hz() else { return Ok(()) };
        if self.watch.is_none() {
            let options = options(self.request);
            self.watch = Some(Watch::new(self.robot.clone(), rate_hz, options, &self.request.recording)?);
        }
        let Some(watch) = &mut self.watch else { return Ok(()) };
        for sample in &samples {
            self.output.say_all(watch.push(sample)?)?;
        }
        Ok(())
    }
}

/// Where events go.
struct Output {
    joints: Vec<JointResult>,
    is_json: bool,
    alarms: usize,
}

impl Output {
    fn head(&self, robot: &WatchedRobot) -> Result<(), io::Error> {
        if self.is_json { Ok(()) } else { print(&report::watch_head(&robot.origin(), width())) }
    }

    fn say_all(&mut self, events: Vec<WatchEvent>) -> Result<(), Box<dyn Error>> {
        events.iter().try_for_each(|event| self.say(event))
    }

    fn say(&mut self, event: &WatchEvent) -> Result<(), Box<dyn Error>> {
        self.alarms += usize::from(event.is_alarm());
        let text =
            if self.is_json { report::watch_json(event)? } else { report::watch_text(event, &self.joints, width()) };
        Ok(print(&text)?)
    }

    fn end(mut self, watch: Watch) -> Result<Ending, Box<dyn Error>> {
        self.say(&WatchEvent::Summary(watch.finish()?))?;
        Ok(if self.alarms == 0 { Ending::Good } else { Ending::NotTrusted })
    }
}
