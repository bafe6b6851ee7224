//! The long recording and its experiment.

use std::{
    error::Error,
    fmt,
    fs::File,
    io::{BufWriter, Write},
    path::{Path, PathBuf},
};
use thetahat_estimation::simulation::{SignalNoise, random_numbers};

use thetahat::{Experiment, Series};

const RATE_HZ: f64 = 5000.0;

/// The files of a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// `record.csv`.
    Csv,
    /// `position.npy` and `torque.npy`.
    Npy,
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Csv => "csv",
            Self::Npy => "npy",
        })
    }
}

/// One motion, and the noise of its torque sensors.
pub struct Twin {
    position: Series,
    torque: Series,
    noise: Vec<f64>,
    text: String,
    robot: String,
}

impl Twin {
    /// The twin of the demonstration.
    pub fn new() -> Result<Self, Box<dyn Error>> {
        let mut experiment = Experiment::demo()?;
        let (text, robot) = (experiment.text.clone(), experiment.robot_text.clone());
        let twin = experiment.file.twin.as_mut().ok_or("a twin")?;
        let noise = std::mem::replace(&mut twin.sensors.torque_noise, vec![0.0; 6]);
        let record = experiment.record_twin()?;
        Ok(Self { position: record.position, torque: record.torque, noise, text, robot })
    }

    /// Writes so many samples with their experiment into a folder; the path of the experiment.
    pub fn write(&self, kind: Kind, folder: &Path, samples: usize) -> Result<PathBuf, Box<dyn Error>> {
        std::fs::create_dir_all(folder)?;
        match kind {
            Kind::Csv => write_csv(self, &folder.join("record.csv"), samples)?,
            Kind::Npy => write_npy(self, folder, samples)?,
        }
        std::fs::write(folder.join("tx40.toml"), &self.robot)?;
        let experiment = folder.join(format!("long_{kind}.toml"));
        std::fs::write(&experiment, self.experiment(kind, samples)?)?;
        Ok(experiment)
    }

    /// Positions and torques of all samples, in order. A counter of the encoder is as fine as the twin's.
    fn each(
        &self,
        samples: usize,
        mut sample: impl FnMut(&[f64], &[f64]) -> Result<(), Box<dyn Error>>,
    ) -> Result<(), Box<dyn Error>> {
        let mut random = random_numbers(1, 0);
        let noise = SignalNoise::White(&self.noise);
        let mut torque = self.torque.clone();
        for k in 0..samples {
            let in_motion = k % self.position.len();
            if in_motion == 0 {
                torque = noise.added_to(self.torque.clone(), &mut random);
            }
            sample(self.position.sample(in_motion), torque.sample(in_motion))?;
        }
        Ok(())
    }

    /// The demonstration with the recording instead of the twin, and a window without the edges of the filter.
    fn experiment(&self, kind: Kind, samples: usize) -> Result<String, Box<dyn Error>> {
        let (before, rest) = self.text.split_once("[twin]").ok_or("the twin")?;
        let (_, rest) = rest.split_once("[signal]").ok_or("its end")?;
        let rest = rest.split_once("[[case]]").map_or(rest, |(rest, _)| rest);
        let before = before.replace("../robots/tx40.toml", "tx40.toml");
        let end_s = samples as f64 / RATE_HZ - 0.1;
        let channels = |name: &str| match kind {
            Kind::Csv => {
                let columns: Vec<String> = (1..=6).map(|j| format!("\"{name}_{j}\"")).collect();
                format!("file = \"record.csv\", columns = [{}]", columns.join(", "))
            }
            Kind::Npy => format!("file = \"{name}.npy\""),
        };
        let time = match kind {
            Kind::Csv => "time = { file = \"record.csv\", columns = [\"time\"], unit = \"s\" }".to_owned(),
            Kind::Npy => format!("sample_rate_hz = {RATE_HZ}"),
        };
        Ok(format!(
            "{before}[recording]\n{time}\nposition = {{ {}, unit = \"rad\" }}\ntorque = {{ {}, unit = \"N m\" }}\n\n\
             [signal]\nwindow_start_s = 0.1\nwindow_end_s = {end_s}{rest}",
            channels("position"),
            channels("torque"),
        ))
    }
}

fn write_csv(twin: &Twin, path: &Path, samples: usize) -> Result<(), Box<dyn Error>> {
    let mut file = BufWriter::with_capacity(1 << 20, File::create(path)?);
    let names = |name: &str| (1..=6).map(|j| format!(",{name}_{j}")).collect::<String>();
    writeln!(file, "time{}{}", names("position"), names("torque"))?;
    let mut k = 0_u64;
    twin.each(samples, |q, tau| {
        write!(file, "{:.4}", k as f64 / RATE_HZ)?;
        q.iter().try_for_each(|q| write!(file, ",{q}"))?;
        tau.iter().try_for_each(|tau| write!(file, ",{tau}"))?;
        writeln!(file)?;
        k += 1;
        Ok(())
    })?;
    Ok(file.flush()?)
}

fn write_npy(twin: &Twin, folder: &Path, samples: usize) -> Result<(), Box<dyn Error>> {
    let open = |name: &str| -> Result<BufWriter<File>, Box<dyn Error>> {
        let mut file = BufWriter::with_capacity(1 << 20, File::create(folder.join(name))?);
        let text = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({samples}, 6), }}");
        let header = format!("{text:<117}\n");
        file.write_all(b"\x93NUMPY\x01\x00")?;
        file.write_all(&u16::try_from(header.len())?.to_le_bytes())?;
        file.write_all(header.as_bytes())?;
        Ok(file)
    };
    let (mut position, mut torque) = (open("position.npy")?, open("torque.npy")?);
    twin.each(samples, |q, tau| {
        q.iter().try_for_each(|q| position.write_all(&q.to_le_bytes()))?;
        tau.iter().try_for_each(|tau| torque.write_all(&tau.to_le_bytes()))?;
        Ok(())
    })?;
    position.flush()?;
    Ok(torque.flush()?)
}
