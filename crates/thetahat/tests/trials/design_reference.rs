//! Designs against another program's: SciPy's SLSQP with Pinocchio, `reference/excitation` of the shared data.

use std::path::Path;

use libtest_mimic::{Failed, Trial};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use serde_json::Value;
use thetahat::{
    Series,
    base_parameters::BaseParameters,
    design::{Criterion, Design, Information},
    dynamics::{Model, Sign},
};
use thetahat_testing::{data, ensure, shared};

/// Samples and velocity scale of the sign in the criterion of the files.
const SAMPLES: usize = 400;
const SIGN: Sign = Sign::smooth(0.01);

/// Differences of the criterion are exact to rounding in both programs.
const TOLERANCE: f64 = 1e-6;

/// Random motions of which the mean is taken.
const RANDOM_MOTIONS: i32 = 60;

/// Largest accelerations of the TX40's record, rad/s^2.
const OF_THE_RECORD: [f64; 6] = [27.0, 26.0, 46.0, 55.0, 43.0, 76.0];

/// How much smaller the deviations of the TX40's base parameters can be than those of its record in the same time, in the
/// geometric mean.
const SMALLER_THAN_OF_THE_RECORD: f64 = 1.84;

struct Reference {
    name: &'static str,
    urdf: &'static str,
    data: Value,
}

impl Reference {
    fn read(name: &'static str, urdf: &'static str) -> Result<Self, Failed> {
        let text = std::fs::read_to_string(shared().join("reference/excitation/excitation.json"))?;
        let all: Value = serde_json::from_str(&text)?;
        Ok(Self { name, urdf, data: all[name].clone() })
    }

    fn tx40() -> Result<Self, Failed> {
        Self::read("tx40", "tx40/tx40_mdh_modified.urdf")
    }

    fn kuka() -> Result<Self, Failed> {
        Self::read("kuka", "kuka_lwr4/kuka_lwr4.urdf")
    }

    fn numbers(&self, key: &str) -> Vec<f64> {
        self.data[key].as_array().into_iter().flatten().filter_map(Value::as_f64).collect()
    }

    /// The design of these files' robot, limits, noise and samples, with the limits of acceleration of a run.
    fn design(&self, motion: &str, starts: usize, acceleration: &[f64]) -> Result<Design, Failed> {
        let degrees = |values: &[f64]| values.iter().map(|v| v.to_degrees()).collect::<Vec<_>>();
        let position: Vec<[f64; 2]> = self
            .numbers("qlo")
            .iter()
            .zip(self.numbers("qhi"))
            .map(|(l, h)| [l.to_degrees(), h.to_degrees()])
            .collect();
        let text = format!(
            "title = 'reference'\nrobot = '{}'\nduration_s = 10\nsample_rate_hz = 40\n[motion]\n{motion}\n\
             starts = {starts}\n[limits]\nmargin = 0\nposition = {position:?}\nvelocity = {:?}\nacceleration = {:?}\n\
             torque = {:?}\n[noise]\ntorque = {:?}\n[signal]\ncutoff_hz = 10\ndecimation = 1\n",
            data().join(self.urdf).display(),
            degrees(&self.numbers("vmax")),
            degrees(acceleration),
            self.numbers("taumax"),
            self.numbers("noise_sd"),
        );
        Ok(Design::parse(&text, Path::new("design.toml"))?)
    }

    /// The criterion of the files for a motion of [`SAMPLES`] samples.
    fn value(&self, design: &Design, motion: [&Series; 3]) -> Result<f64, Failed> {
        let model = Model::new(&design.robot);
        let base = BaseParameters::of(&model, &[])?;
        let information = Information::new(&model, &base.columns(), &self.numbers("noise_sd"));
        let value = Criterion::D.value(&information.of(motion, 1.0, SIGN));
        value.ok_or_else(|| "the motion does not show every parameter".into())
    }

    /// What another choice of base parameters adds to the criterion: from the samples of the best run.
    fn shift(&self, design: &Design) -> Result<f64, Failed> {
        let path = shared().join(format!("reference/excitation/excitation_{}_best.csv", self.name));
        let text = std::fs::read_to_string(path)?;
        let rows: Vec<Vec<f64>> =
            text.lines().skip(1).map(|line| line.split(',').filter_map(|v| v.parse().ok()).collect()).collect();
        let n = design.robot.coordinate_count();
        let series = |from: usize| Series::shaped(n, rows.iter().flat_map(|r| r[from..from + n].to_vec()).collect());
        let [q, dq, ddq] = [1, 1 + n, 1 + 2 * n].map(series);
        Ok(self.best_of_scipy(5, "")? - self.value(design, [&q, &dq, &ddq])?)
    }

    /// The best criterion that SciPy found; an error where the files have no such run, which would bound nothing.
    fn best_of_scipy(&self, harmonics: u64, tag: &str) -> Result<f64, Failed> {
        let best = self.runs(harmonics, tag).filter_map(|run| run["J"].as_f64()).reduce(f64::min);
        best.ok_or_else(|| format!("{}: no run of {harmonics} harmonics {tag}", self.name).into())
    }

    fn runs<'a>(&'a self, harmonics: u64, tag: &'a str) -> impl Iterator<Item = &'a Value> {
        let runs = self.data["runs"].as_array().into_iter().flatten();
        runs.filter(move |run| run["nh"] == harmonics && run["tag"] == tag)
    }

    fn differences(&self) -> Result<(), Failed> {
        let design = self.design("harmonics = 5", 1, &self.numbers("amax"))?;
        let shift = self.shift(&design)?;
        let mut runs = 0;
        for (harmonics, tag) in [(5, ""), (5, "rec"), (10, ""), (10, "rec")] {
            for run in self.runs(harmonics, tag) {
                runs += 1;
                let [q, dq, ddq] = motion_of_run(run);
                let (found, expected) =
                    (self.value(&design, [&q, &dq, &ddq])? + shift, run["J"].as_f64().unwrap_or(f64::NAN));
                ensure(
                    (found - expected).abs() < TOLERANCE,
                    format!("{harmonics} {tag}: {found}, expected {expected}"),
                )?;
            }
        }
        ensure(runs > 6, format!("{runs} runs in the files"))
    }

    /// Six searches of five harmonics within the accelerations of the files: the best, and none further from it than 4 nats.
    fn best_of_six(&self) -> Result<(), Failed> {
        let found = self.best("harmonics = 5", 6, &self.numbers("amax"), self.best_of_scipy(5, "")?)?;
        let [least, most] = [f64::min, f64::max].map(|of| found.iter().copied().reduce(of).unwrap_or(f64::NAN));
        ensure(most - least < 4.0, format!("{}: searches are {} nats apart", self.name, most - least))
    }

    /// The criterion of the record of the files.
    fn record(&self) -> f64 {
        self.data["record_J_per_10s_400"].as_f64().unwrap_or(f64::NAN)
    }

    /// As many splines as five harmonics have functions tell more than the record does in the same time.
    fn best_splines(&self) -> Result<(), Failed> {
        self.best("kind = 'splines'\nsplines = 10", 6, &self.numbers("amax"), self.record()).map(drop)
    }

    /// The mean criterion of random motions: normal coefficients of five harmonics about the middle of the ranges, those of each
    /// joint as large as its limits of position, velocity and acceleration allow. Those of torque are not looked at.
    fn random_motions(&self, design: &Design, acceleration: &[f64]) -> Result<f64, Failed> {
        let range: Vec<[f64; 2]> =
            self.numbers("qlo").into_iter().zip(self.numbers("qhi")).map(|(l, h)| [l, h]).collect();
        let half = range.iter().map(|[lower, upper]| 0.5 * (upper - lower)).collect();
        let middle: Vec<f64> = range.iter().map(|[lower, upper]| 0.5 * (lower + upper)).collect();
        let limits = [half, self.numbers("vmax"), acceleration.to_vec()];
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let mut sum = 0.0;
        for _ in 0..RANDOM_MOTIONS {
            let mut draw = || (0..10).map(|_| StandardNormal.sample(&mut rng)).collect::<Vec<f64>>();
            let coefficients: Vec<Vec<f64>> = middle.iter().map(|_| [vec![0.0], draw()].concat()).collect();
            let [q, dq, ddq] = as_large_as_allowed(&motion_of(&coefficients), &limits, &middle);
            sum += self.value(design, [&q, &dq, &ddq])? + self.shift(design)?;
        }
        Ok(sum / f64::from(RANDOM_MOTIONS))
    }

    /// The best design within limits of acceleration is at or below `bound`; says how much smaller its deviations are, in the
    /// geometric mean, than those of the record of the files, of random motions, and of the random motions that the searches begin with.
    fn best(&self, motion: &str, starts: usize, acceleration: &[f64], bound: f64) -> Result<Vec<f64>, Failed> {
        let design = self.design(motion, starts, acceleration)?;
        let began = std::time::Instant::now();
        let results = design.run(2)?;
        let seconds = began.elapsed().as_secs_f64() / starts as f64;
        let [q, dq, ddq] = [&results.q, &results.dq, &results.ddq].map(|series| series.window(0..SAMPLES));
        let position = self.numbers("qlo").into_iter().zip(self.numbers("qhi")).map(|(l, h)| [l, h]);
        require_within(&q, "position", position)?;
        for (series, name, limits) in [
            (&dq, "velocity", self.numbers("vmax")),
            (&ddq, "acceleration", acceleration.to_vec()),
            (&results.torque, "torque", self.numbers("taumax")),
        ] {
            require_within(series, name, limits.into_iter().map(|limit| [-limit, limit]))?;
        }
        let value = self.value(&design, [&q, &dq, &ddq])? + self.shift(&design)?;
        let begun = results.starts.iter().map(|s| s.first - s.found).sum::<f64>() / starts as f64;
        let random = self.random_motions(&design, acceleration)?;
        let times = |nats: f64| (0.5 * nats / results.predicted.len() as f64).exp();
        let found: Vec<f64> = results.starts.iter().map(|s| s.found).collect();
        let mean = found.iter().sum::<f64>() / starts as f64;
        let deviation = (found.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (starts as f64 - 1.0)).sqrt();
        println!(
            "{}, {motion}: {value:.2}; deviations {:.2} times smaller than of the record, {:.2} than of random motions, \
             {:.2} than where searches begin; searches {found:.1?}, deviation {deviation:.1}; {seconds:.2} s a start with \
             the prediction",
            self.name,
            times(self.record() - value),
            times(random - value),
            times(begun)
        );
        ensure(value <= bound, format!("{}: {value} with {:?}, bound {bound}", self.name, results.starts))?;
        Ok(found)
    }
}

/// The motion of a run of the files from its coefficients.
fn motion_of_run(run: &Value) -> [Series; 3] {
    let row = |row: &Value| row.as_array().into_iter().flatten().filter_map(Value::as_f64).collect();
    motion_of(&run["coef"].as_array().into_iter().flatten().map(row).collect::<Vec<_>>())
}

/// The motion of coefficients by the formula of the files.
fn motion_of(coefficients: &[Vec<f64>]) -> [Series; 3] {
    let harmonics = (coefficients[0].len() - 1) / 2;
    let mut motion = [(); 3].map(|()| Series::zeros(SAMPLES, coefficients.len()));
    for k in 0..SAMPLES {
        let t = 10.0 * k as f64 / SAMPLES as f64;
        for (j, coefficients) in coefficients.iter().enumerate() {
            motion[0].sample_mut(k)[j] = coefficients[0];
            for l in 1..=harmonics {
                let (sine, cosine) = functions(t, l);
                for (order, series) in motion.iter_mut().enumerate() {
                    series.sample_mut(k)[j] +=
                        coefficients[l] * sine[order] + coefficients[harmonics + l] * cosine[order];
                }
            }
        }
    }
    motion
}

/// A motion about zero, moved to `middle`, each joint times the factor with which it touches the first of its limits.
fn as_large_as_allowed(motion: &[Series; 3], limits: &[Vec<f64>; 3], middle: &[f64]) -> [Series; 3] {
    let most = |order: usize, joint: usize| motion[order].channel(joint).into_iter().map(f64::abs).fold(0.0, f64::max);
    let used = |joint: usize| (0..3).map(|order| most(order, joint) / limits[order][joint]).fold(0.0, f64::max);
    [0, 1, 2].map(|order| {
        let of_joint = |(joint, middle): (usize, &f64)| {
            let centre = if order == 0 { *middle } else { 0.0 };
            motion[order].channel(joint).iter().map(|v| centre + v / used(joint)).collect()
        };
        Series::side_by_side(&middle.iter().enumerate().map(of_joint).collect::<Vec<_>>())
    })
}

/// Every sample of each joint is within its limits.
fn require_within(series: &Series, name: &str, limits: impl Iterator<Item = [f64; 2]>) -> Result<(), Failed> {
    for (joint, [lower, upper]) in limits.enumerate() {
        let outside = series.channel(joint).into_iter().find(|v| !(lower..=upper).contains(v));
        let joint = joint + 1;
        ensure(outside.is_none(), format!("{name} {joint} is {outside:?}, from {lower} to {upper}"))?;
    }
    Ok(())
}

/// The functions of the files and two derivatives at a time: a sine and a cosine with their quintics.
fn functions(t: f64, l: usize) -> ([f64; 3], [f64; 3]) {
    let (period, s) = (10.0, t / 10.0);
    let w = std::f64::consts::TAU * l as f64 / period;
    let (wt, sin, cos) = (w * period, (w * t).sin(), (w * t).cos());
    let first = [
        s - 10.0 * s.powi(3) + 15.0 * s.powi(4) - 6.0 * s.powi(5),
        (1.0 - 30.0 * s.powi(2) + 60.0 * s.powi(3) - 30.0 * s.powi(4)) / period,
        (-60.0 * s + 180.0 * s.powi(2) - 120.0 * s.powi(3)) / (period * period),
    ];
    let second = [
        0.5 * (s.powi(2) - 2.0 * s.powi(3) + s.powi(4)),
        (s - 3.0 * s.powi(2) + 2.0 * s.powi(3)) / period,
        (1.0 - 6.0 * s + 6.0 * s.powi(2)) / (period * period),
    ];
    let sine = [sin, w * cos, -w * w * sin];
    let cosine = [1.0 - cos, w * sin, w * w * cos];
    ([0, 1, 2].map(|o| sine[o] - wt * first[o]), [0, 1, 2].map(|o| cosine[o] - wt * wt * second[o]))
}

const DATA: [&str; 3] = ["reference/excitation", "datasets/tx40", "datasets/kuka_lwr4"];

/// Searches with many starts, four minutes together, count as ignored: `.ci/nightly` runs them.
pub fn all_trials() -> Vec<Trial> {
    let quick = thetahat_testing::trials_on_shared_data(
        &DATA,
        vec![
            ("criterion_of_the_tx40", || Reference::tx40()?.differences()),
            ("criterion_of_the_lwr4", || Reference::kuka()?.differences()),
        ],
    );
    quick.into_iter().chain(slow_trials()).collect()
}

fn slow_trials() -> Vec<Trial> {
    thetahat_testing::slow_trials(
        &DATA,
        vec![
            ("best_of_the_lwr4", || Reference::kuka()?.best_of_six()),
            ("best_of_the_tx40", || Reference::tx40()?.best_of_six()),
            ("five_harmonics_of_the_tx40_as_the_record", || {
                let tx40 = Reference::tx40()?;
                tx40.best("harmonics = 5", 6, &OF_THE_RECORD, tx40.best_of_scipy(5, "rec")?).map(drop)
            }),
            ("ten_harmonics_of_the_tx40", || {
                let tx40 = Reference::tx40()?;
                tx40.best("harmonics = 10", 6, &OF_THE_RECORD, tx40.best_of_scipy(10, "rec")?).map(drop)
            }),
            ("fourteen_harmonics_of_the_tx40", || {
                let tx40 = Reference::tx40()?;
                let parameters = tx40.data["base_names"].as_array().map_or(0, Vec::len) as f64;
                let bound = tx40.record() - 2.0 * parameters * SMALLER_THAN_OF_THE_RECORD.ln();
                tx40.best("harmonics = 14", 6, &OF_THE_RECORD, bound).map(drop)
            }),
            ("ten_harmonics_of_the_lwr4", || {
                let lwr4 = Reference::kuka()?;
                lwr4.best("harmonics = 10", 6, &lwr4.numbers("amax"), lwr4.best_of_scipy(10, "")?).map(drop)
            }),
            ("splines_of_the_tx40", || Reference::tx40()?.best_splines()),
            ("splines_of_the_lwr4", || Reference::kuka()?.best_splines()),
        ],
    )
}
