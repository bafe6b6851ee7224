//! The error of simulated steps from every sample of a recording: the metric of `docs/evidence/benchmarks.md` for an industrial robot.
//!
//! `cargo run --release -p thetahat --example studies -- forward_error EXPERIMENT DATA RESULTS STEPS [METHOD]`
//!
//! The robot of RESULTS, by METHOD or its model, is moved for STEPS steps from the recorded state of each sample of the experiment's
//! validation by its recorded torques, which hold from sample to sample. Prints, for positions and velocities of each joint, the
//! root mean square of the error over all starts and steps, over the standard deviation of the channel; and their mean.

use std::{error::Error, path::Path};

use thetahat::{
    Experiment, Series,
    dynamics::{DynamicParameters, Model, Sign},
    experiment::{EstimateRequest, IdentifiedRobot},
    recording::read_channels,
};

/// Runs the study.
pub fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = super::arguments().collect();
    let (paths, steps, method) = match &arguments[..] {
        [paths @ .., steps] if paths.len() == 3 => (paths, steps, None),
        [paths @ .., steps, method] if paths.len() == 3 => (paths, steps, Some(method.parse()?)),
        _ => return Err("usage: forward_error EXPERIMENT DATA RESULTS STEPS [METHOD]".into()),
    };
    let (data, steps) = (Path::new(&paths[1]), steps.parse()?);
    let request = EstimateRequest { method, untrusted: true, ..EstimateRequest::default() };
    let identified = IdentifiedRobot::read(Path::new(&paths[2]), &request)?;
    let recorded = Recorded::read(&Experiment::read(Path::new(&paths[0]), data)?, data)?;
    let simulator = Simulator::of(&identified, recorded.rate_hz);
    let errors = simulator.errors(&recorded, steps)?;
    println!("{}", identified.origin());
    println!("{} starts, {steps} steps", recorded.q.len() - steps);
    for (what, of_joints) in ["positions", "velocities"].iter().zip(errors.chunks(recorded.q.channels())) {
        let each: Vec<String> = of_joints.iter().map(|e| format!("{e:.4}")).collect();
        println!("{what}: {}", each.join(" "));
    }
    println!("mean: {:.5}", errors.iter().sum::<f64>() / errors.len() as f64);
    Ok(())
}

/// Recorded states, and the torques of the joints.
struct Recorded {
    rate_hz: f64,
    q: Series,
    dq: Series,
    tau: Series,
}

impl Recorded {
    fn read(experiment: &Experiment, data: &Path) -> Result<Self, Box<dyn Error>> {
        let held_back = experiment.file.validation.first().ok_or("the experiment has no [[validation]]")?;
        let [torque, velocity] = [&held_back.torque, &held_back.velocity].map(Option::as_ref);
        let (torque, velocity) = torque.zip(velocity).ok_or("the validation needs torque and velocity")?;
        let read = |source| read_channels(source, data);
        Ok(Self {
            rate_hz: held_back.sample_rate_hz.ok_or("the validation needs sample_rate_hz")?,
            q: read(&held_back.position)?,
            dq: read(velocity)?,
            tau: experiment.robot.transmission.joint_torques(&read(torque)?),
        })
    }
}

/// The identified robot, and how it is integrated.
struct Simulator {
    model: Model,
    parameters: DynamicParameters,
    sign: Sign,
    step_s: f64,
}

impl Simulator {
    fn of(identified: &IdentifiedRobot, rate_hz: f64) -> Self {
        let model = Model::new(&identified.robot);
        let of_settings = identified.settings.simulation.sign_velocity_scale;
        Self {
            parameters: DynamicParameters::sorted(&model, &identified.theta()),
            sign: Sign::smooth(identified.model.as_ref().map_or(of_settings, |m| m.friction_transition)),
            step_s: 1.0 / rate_hz,
            model,
        }
    }

    /// The errors of positions, then of velocities, over the standard deviations of their channels. All starts move side by side.
    fn errors(&self, recorded: &Recorded, steps: usize) -> Result<Vec<f64>, Box<dyn Error>> {
        let starts = recorded.q.len() - steps;
        let mut state = [&recorded.q, &recorded.dq].map(|series| series.window(0..starts));
        let mut squares = vec![0.0; 2 * recorded.q.channels()];
        for step in 0..steps {
            self.advance(&mut state, &recorded.tau.window(step..step + starts))?;
            let reached = [&recorded.q, &recorded.dq].map(|series| series.window(step + 1..step + 1 + starts));
            let joints = recorded.q.channels();
            for (simulated, (measured, squares)) in state.iter().zip(reached.iter().zip(squares.chunks_mut(joints))) {
                for (k, (s, m)) in simulated.values().iter().zip(measured.values()).enumerate() {
                    squares[k % joints] += (s - m).powi(2);
                }
            }
        }
        let channels = [&recorded.q, &recorded.dq].map(deviations).concat();
        let rms = |squares: f64| (squares / (starts * steps) as f64).sqrt();
        Ok(squares.into_iter().zip(channels).map(|(squares, deviation)| rms(squares) / deviation).collect())
    }

    /// One step of the classical Runge-Kutta method.
    fn advance(&self, [q, dq]: &mut [Series; 2], tau: &Series) -> Result<(), Box<dyn Error>> {
        let h = self.step_s;
        let slope = |q: &Series, dq: &Series| {
            let found = self.model.forward_dynamics_series(&self.parameters, [q, dq, tau], self.sign);
            found.map_err(|(k, error)| format!("start {k}: {error}"))
        };
        let a1 = slope(q, dq)?;
        let v2 = plus(dq, h / 2.0, &a1);
        let a2 = slope(&plus(q, h / 2.0, dq), &v2)?;
        let v3 = plus(dq, h / 2.0, &a2);
        let a3 = slope(&plus(q, h / 2.0, &v2), &v3)?;
        let v4 = plus(dq, h, &a3);
        let a4 = slope(&plus(q, h, &v3), &v4)?;
        let mean = |first: &Series, [b, c, d]: [&Series; 3]| plus(&plus(&plus(first, 2.0, b), 2.0, c), 1.0, d);
        *q = plus(q, h / 6.0, &mean(dq, [&v2, &v3, &v4]));
        *dq = plus(dq, h / 6.0, &mean(&a1, [&a2, &a3, &a4]));
        Ok(())
    }
}

/// `x + factor y`.
fn plus(x: &Series, factor: f64, y: &Series) -> Series {
    Series::shaped(x.channels(), x.values().iter().zip(y.values()).map(|(x, y)| x + factor * y).collect())
}

fn deviations(series: &Series) -> Vec<f64> {
    let means = series.means();
    let of = |c: usize| {
        let squares: f64 = series.channel(c).iter().map(|v| (v - means[c]).powi(2)).sum();
        (squares / series.len() as f64).sqrt()
    };
    (0..series.channels()).map(of).collect()
}
