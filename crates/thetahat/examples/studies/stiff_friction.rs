//! The explicit and the linearly implicit method on a robot whose friction is stiff against its inertia: the table of
//! `docs/evidence/simulation.md`. A twin of the KUKA LWR4+ follows its recorded motion for 25 s, with Coulomb friction of 1 N m over
//! 0.01 rad/s at every joint and a wrist of 1e-3 kg m^2.
//!
//! `cargo run --release --example studies -p thetahat -- stiff_friction experiments/kuka_lwr4.toml DATA`

use std::{error::Error, path::Path, time::Instant};

use thetahat::{
    ControllerDescription, Experiment, Series,
    dynamics::Model,
    recording::read_channels,
    simulation::{ClosedLoop, OutputGrid, Reference, SampledReference, SimulatedMotion, SimulatorBias, Solver},
};
use thetahat_estimation::simulation::{Job, simulate_all};

/// The rate of the recording.
const RATE_HZ: f64 = 200.0;
/// Simulated time in s.
const DURATION_S: f64 = 25.0;

/// Runs the study.
pub fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = super::arguments().collect();
    let [experiment, data] = &arguments[..] else {
        return Err("usage: stiff_friction EXPERIMENT DATA".into());
    };
    let experiment = Experiment::read(Path::new(experiment), Path::new(data))?;
    let recording = experiment.file.recording.first().ok_or("no recording")?;
    let position = read_channels(&recording.position, Path::new(data))?;
    let model = Model::new(&experiment.robot);
    let reference = Reference::Sampled(SampledReference::new(position, RATE_HZ));
    for hz in [10.0, 40.0] {
        let controller = toml::from_str(&format!(
            "law = \"pd\"\nbandwidth_hz = [{hz}]\nvelocity_feed_forward = 1.0\nacceleration_feed_forward = 1.0"
        ))?;
        let twin = Twin { experiment: &experiment, model: &model, reference: &reference, controller: &controller };
        twin.print_table(hz)?;
    }
    Ok(())
}

struct Twin<'a> {
    experiment: &'a Experiment,
    model: &'a Model,
    reference: &'a Reference,
    controller: &'a ControllerDescription,
}

impl Twin<'_> {
    fn closed_loop(&self, solver: Solver) -> ClosedLoop<'_> {
        ClosedLoop {
            model: self.model,
            transmission: &self.experiment.robot.transmission,
            controller: self.controller,
            reference: self.reference,
            added_signal: None,
            channels: None,
            bias: SimulatorBias::NONE,
            solver,
            sign_velocity_scale: 0.01,
        }
    }

    /// The URDF's values with friction at every joint, and a wrist whose inertia is almost all in its motor.
    fn parameters(&self) -> Vec<f64> {
        let mut theta = self.experiment.robot.a_priori_parameters();
        for (value, parameter) in theta.iter_mut().zip(self.model.parameter_table().iter()) {
            let name = parameter.name();
            match name.as_str() {
                "ia7" => *value = 1e-3,
                "xx7" | "xy7" | "xz7" | "yy7" | "yz7" | "zz7" => *value *= 0.01,
                _ if name.starts_with("fc") => *value = 1.0,
                _ if name.starts_with("fv") => *value = 0.1,
                _ => {}
            }
        }
        theta
    }

    /// Seconds of one simulation, and its motion.
    fn run(&self, solver: Solver, side_by_side: usize) -> Result<(f64, SimulatedMotion), Box<dyn Error>> {
        let (theta, closed_loop) = (self.parameters(), self.closed_loop(solver));
        let inertia = closed_loop.motor_inertia(&theta, DURATION_S);
        let samples = (DURATION_S * RATE_HZ) as usize;
        let grid = OutputGrid { start_s: 0.0, sample_rate_hz: RATE_HZ, samples };
        let jobs = vec![Job { closed_loop, theta: &theta, motor_inertia: &inertia, grid }; side_by_side];
        let clock = Instant::now();
        let motion = simulate_all(&jobs).remove(0)?;
        Ok((clock.elapsed().as_secs_f64() / side_by_side as f64, motion))
    }

    fn print_table(&self, hz: f64) -> Result<(), Box<dyn Error>> {
        let stiffness = self.closed_loop(Solver::default()).stiffness(&self.parameters(), DURATION_S);
        let explicit = |r: f64| Solver::Adaptive { relative_tolerance: r, absolute_tolerance: r / 1e3 };
        let implicit = |r: f64| Solver::Implicit { relative_tolerance: r, absolute_tolerance: r / 1e3 };
        let (_, exact) = self.run(explicit(1e-7), 1)?;
        println!("\n{hz} Hz, stiffness {stiffness:.1e} /s\n");
        println!(
            "| solver | s | s, four side by side | right-hand sides | q rad | dq rad/s | ddq rad/s^2, rms | tau N m, rms |"
        );
        println!("| --- | --- | --- | --- | --- | --- | --- | --- |");
        for (name, solver) in [
            ("explicit 1e-3, 1e-6", explicit(1e-3)),
            ("implicit 1e-3, 1e-6", implicit(1e-3)),
            ("implicit 1e-4, 1e-7", implicit(1e-4)),
            ("implicit 1e-5, 1e-8", implicit(1e-5)),
            ("automatic", Solver::default()),
        ] {
            let ((alone, motion), (of_four, _)) = (self.run(solver, 1)?, self.run(solver, 4)?);
            println!(
                "| {name} | {alone:.3} | {of_four:.3} | {} | {:.1e} | {:.1e} | {:.1e} | {:.1e} |",
                motion.counts.evaluations,
                largest(&motion.q, &exact.q),
                largest(&motion.dq, &exact.dq),
                rms(&motion.ddq, &exact.ddq),
                rms(&motion.tau, &exact.tau),
            );
        }
        Ok(())
    }
}

fn largest(a: &Series, b: &Series) -> f64 {
    a.values().iter().zip(b.values()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

fn rms(a: &Series, b: &Series) -> f64 {
    let squares: f64 = a.values().iter().zip(b.values()).map(|(a, b)| (a - b).powi(2)).sum();
    (squares / a.values().len() as f64).sqrt()
}
