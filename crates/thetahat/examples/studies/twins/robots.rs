use std::{error::Error, path::Path};

use thetahat::Robot;

/// A robot of the table.
pub struct Subject {
    pub name: &'static str,
    pub robot: Robot,
    /// Whether the torques are those of motors, whose inertias they turn too, whatever the file says of them.
    pub has_motor_inertias: bool,
}

/// Name, file, and whether the motors' inertias are felt; files of the data folder begin with `data/`.
const ROBOTS: [(&str, &str, bool); 7] = [
    ("two_joint", "robots/two_joint.toml", true),
    ("TX40", "robots/tx40.toml", true),
    ("UR10", "robots/ur10.toml", true),
    ("LWR4+", "data/kuka_lwr4/kuka_lwr4.urdf", false),
    ("seven axes", "robots/seven_axes.urdf", true),
    ("SCARA", "robots/scara.toml", true),
    ("branching", "robots/branching.urdf", true),
];

/// The robots that are asked for; one that is described in a data folder that is absent is left out with a word.
pub fn robots(containing: &str, data: Option<&Path>) -> Result<Vec<Subject>, Box<dyn Error>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut found = Vec::new();
    for (name, file, has_motor_inertias) in ROBOTS.into_iter().filter(|(name, ..)| name.contains(containing)) {
        let path = match file.strip_prefix("data/") {
            None => root.join(file),
            Some(file) => match data {
                Some(data) if data.join(file).exists() => data.join(file),
                Some(_) | None => {
                    eprintln!("{name} is left out: --data has no {file}");
                    continue;
                }
            },
        };
        found.push(Subject { name, robot: Robot::read(&path)?, has_motor_inertias });
    }
    Ok(found)
}
