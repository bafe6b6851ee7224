//! A recording of seven axes with known parameters, as a log in a folder.

use std::{fmt::Write as _, fs, path::PathBuf};

use crate::{Experiment, Results};
use thetahat_estimation::simulation::{SignalNoise, random_numbers};
use thetahat_ground::series::Series;
use thetahat_model::{
    consistency::completed_a_priori,
    dynamics::{DynamicParameters, Model, Sign, State, Workspace},
    robot::Robot,
};
use thetahat_report::results::RunResult;
use thetahat_testing::{Folder, project};

pub(super) const RATE_HZ: f64 = 200.0;
const SAMPLES: usize = 4000;
/// Where a joint stays that does not move, rad.
pub(super) const STILL_AT: f64 = 0.4;
/// Noise of a torque, part of its rms.
const NOISE: f64 = 0.01;

/// The log: positions, rad, torques, N m, and times, s, which a fault changes.
pub(super) struct Log {
    pub(super) position: Series,
    pub(super) torque: Series,
    pub(super) time: Vec<f64>,
}

/// The log in a folder with its robot.
pub(super) struct Twin {
    folder: Folder,
    pub(super) log: Log,
}

/// The true friction: 3 / j, 2 / j.
pub(super) fn truth() -> impl Iterator<Item = (String, f64)> {
    (1..=7).flat_map(|j| [("fv", 3.0), ("fc", 2.0)].map(|(name, value)| (format!("{name}{j}"), value / f64::from(j))))
}

fn described() -> Robot {
    Robot::read(&project("robots/seven_axes.urdf")).unwrap()
}

impl Twin {
    pub(super) fn new() -> Self {
        Self::with_friction(&|_, _, _| 0.0)
    }

    /// With a joint, from zero, that stays at [`STILL_AT`].
    pub(super) fn with_still_joint(joint: usize) -> Self {
        Self::on(&described(), moved_but(Some(joint)), &|_, _, _| 0.0)
    }

    /// On a base in whose frame gravity is another one.
    pub(super) fn with_gravity(gravity: [f64; 3]) -> Self {
        Self::on(&Robot { gravity, ..described() }, moved_but(None), &|_, _, _| 0.0)
    }

    /// With another torque of joint j, from its velocity and the torque of gravity.
    pub(super) fn with_friction(other: &dyn Fn(usize, f64, f64) -> f64) -> Self {
        Self::on(&described(), moved_but(None), other)
    }

    fn on(robot: &Robot, [q, dq, ddq]: [Series; 3], other: &dyn Fn(usize, f64, f64) -> f64) -> Self {
        let (model, n) = (Model::new(robot), robot.coordinate_count());
        let table = robot.parameter_table();
        let mut theta = completed_a_priori(robot, None);
        for (name, value) in truth() {
            theta[table.index_of(&name).unwrap()] = value;
        }
        let bodies: Vec<f64> =
            table.iter().zip(&theta).map(|(p, v)| if p.quantity.is_inertial() { *v } else { 0.0 }).collect();
        let [theta, bodies] = [theta, bodies].map(|theta| DynamicParameters::sorted(&model, &theta));
        let (mut workspace, still) = (Workspace::new(&model), vec![0.0; n]);
        let (mut torque, mut gravity) = (Series::zeros(SAMPLES, n), vec![0.0; n]);
        for k in 0..SAMPLES {
            let state = State::new(q.sample(k), dq.sample(k));
            model.inverse_dynamics(&theta, state, ddq.sample(k), Sign::Exact, &mut workspace, torque.sample_mut(k));
            let at_rest = State::new(q.sample(k), &still);
            model.inverse_dynamics(&bodies, at_rest, &still, Sign::Exact, &mut workspace, &mut gravity);
            for (j, tau) in torque.sample_mut(k).iter_mut().enumerate() {
                *tau += other(j, dq.sample(k)[j], gravity[j]);
            }
        }
        let rms = |j: usize| (torque.channel(j).iter().map(|t| t * t).sum::<f64>() / SAMPLES as f64).sqrt();
        let deviations: Vec<f64> = (0..n).map(|j| NOISE * rms(j)).collect();
        let torque = SignalNoise::White(&deviations).added_to(torque, &mut random_numbers(5, 0));
        let time = (0..SAMPLES).map(|k| k as f64 / RATE_HZ).collect();
        let folder = Folder::new();
        fs::copy(project("robots/seven_axes.urdf"), folder.path().join("arm.urdf")).unwrap();
        Self { folder, log: Log { position: q, torque, time } }
    }

    /// The same with a fault in its log.
    pub(super) fn with(mut self, fault: impl FnOnce(&mut Log)) -> Self {
        fault(&mut self.log);
        self
    }

    /// The experiment with this text of its keys below the columns.
    pub(super) fn experiment(&self, keys: &str) -> Experiment {
        let n = self.log.position.channels();
        let names = |name: &str| (1..=n).map(|j| format!("\"{name}{j}\"")).collect::<Vec<_>>().join(", ");
        let mut csv = format!("t,{},{}\n", names("q").replace(['"', ' '], ""), names("tau").replace(['"', ' '], ""));
        for (k, time) in self.log.time.iter().enumerate() {
            write!(csv, "{time}").unwrap();
            let values = self.log.position.sample(k).iter().chain(self.log.torque.sample(k));
            values.for_each(|v| write!(csv, ",{v}").unwrap());
            csv.push('\n');
        }
        fs::write(self.folder.path().join("log.csv"), csv).unwrap();
        let text = format!(
            "title = \"Seven axes\" # of a test\nrobot = \"arm.urdf\"\n\n[recording]\n\
             time = {{ file = \"log.csv\", columns = [\"t\"], unit = \"s\" }}\n\
             position = {{ file = \"log.csv\", columns = [{}], unit = \"rad\" }}\n\n\
             [recording.torque] # at the joints\nfile = \"log.csv\"\ncolumns = [{}]\nunit = \"N m\"\n\n{keys}",
            names("q"),
            names("tau")
        );
        self.read(text)
    }

    pub(super) fn read(&self, text: String) -> Experiment {
        let path = self.path();
        fs::write(&path, text).unwrap();
        Experiment::read(&path, self.folder.path()).unwrap()
    }

    fn path(&self) -> PathBuf {
        self.folder.path().join("experiment.toml")
    }

    pub(super) fn run(&self, experiment: &Experiment) -> Results {
        experiment.run_on_threads(self.folder.path(), 2, &mut |_| ()).unwrap()
    }

    /// The results with the remedies of these codes.
    pub(super) fn remedied(&self, experiment: &Experiment, results: &Results, codes: &[&str]) -> Results {
        let codes: Vec<String> = codes.iter().map(|code| (*code).to_owned()).collect();
        let text = experiment.with_remedies(&results.remedies, &codes).unwrap();
        assert!(text.contains("# of a test") && text.contains("# at the joints"), "comments stay: {text}");
        self.run(&self.read(text))
    }
}

/// The motion of seven joints, one of which may stay where it is.
fn moved_but(still: Option<usize>) -> [Series; 3] {
    let mut all = motion(7);
    for (series, at) in all.iter_mut().zip([STILL_AT, 0.0, 0.0]) {
        (0..series.len()).for_each(|k| still.iter().for_each(|&j| series.sample_mut(k)[j] = at));
    }
    all
}

/// Sines of every joint: position, velocity, acceleration.
fn motion(joints: usize) -> [Series; 3] {
    let mut all = [0, 1, 2].map(|_| Series::zeros(SAMPLES, joints));
    for k in 0..SAMPLES {
        let t = k as f64 / RATE_HZ;
        for j in 0..joints {
            let place = j as f64;
            for (amplitude, rate) in [(0.6, 0.9 + 0.13 * place), (0.3, 2.3 + 0.21 * place), (0.15, 4.1 - 0.17 * place)]
            {
                let phase = rate * t + 1.3 * place;
                all[0].sample_mut(k)[j] += amplitude * phase.sin();
                all[1].sample_mut(k)[j] += amplitude * rate * phase.cos();
                all[2].sample_mut(k)[j] -= amplitude * rate * rate * phase.sin();
            }
        }
    }
    all
}

/// The values that are judged: those of the least squares.
pub(super) fn run_of(results: &Results) -> &RunResult {
    results.runs.first().expect("idim-ls ran")
}

/// Largest difference of a friction value from the truth, part of it.
pub(super) fn largest_error(results: &Results) -> f64 {
    let run = run_of(results);
    let error =
        |(name, value): (String, f64)| run.parameter(&name).map_or(f64::INFINITY, |p| (p.estimate / value - 1.0).abs());
    truth().map(error).fold(0.0, f64::max)
}

/// Largest difference of two estimates, in half widths of the second one's interval.
pub(super) fn largest_difference(results: &Results, clean: &Results) -> f64 {
    let (run, clean) = (run_of(results), run_of(clean));
    assert_eq!(run.parameters.len(), clean.parameters.len());
    let difference = |p: &thetahat_report::results::ParameterResult| {
        let found = run.parameter(&p.name).map_or(f64::INFINITY, |own| own.estimate);
        (found - p.estimate).abs() / p.farther_end().expect("an interval")
    };
    clean.parameters.iter().map(difference).fold(0.0, f64::max)
}
