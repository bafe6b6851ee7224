use std::{error::Error, path::PathBuf};

use thetahat::identification::{Method, Needs};

/// What the command line asks for.
pub struct Arguments {
    /// Folder with recorded data sets, for robots that are described there.
    pub data: Option<PathBuf>,
    /// Few cells on short records.
    pub quick: bool,
    pub methods: Vec<Method>,
    /// Robots whose names contain this.
    pub robot: String,
    /// Of motions and noise.
    pub seed: u64,
}

impl Arguments {
    pub fn read() -> Result<Self, Box<dyn Error>> {
        let iterates = |m: &Method| m.needs() != Needs::Measurement;
        let methods = Method::all().filter(iterates).collect();
        let mut found = Self { data: None, quick: false, methods, robot: String::new(), seed: 1 };
        let mut arguments = std::env::args().skip(1);
        while let Some(name) = arguments.next() {
            let mut value = || arguments.next().ok_or_else(|| format!("{name} needs a value"));
            match name.as_str() {
                "--data" => found.data = Some(value()?.into()),
                "--quick" => found.quick = true,
                "--methods" => found.methods = value()?.split(',').map(str::parse).collect::<Result<_, _>>()?,
                "--robot" => found.robot = value()?,
                "--seed" => found.seed = value()?.parse()?,
                other => return Err(format!("unknown argument {other}").into()),
            }
        }
        Ok(found)
    }

    /// Length of the records.
    pub fn duration_s(&self) -> f64 {
        if self.quick { 5.0 } else { 10.0 }
    }
}
