use std::{fmt, str::FromStr};

/// A format of exported robots.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ExportFormat {
    /// URDF, as ROS, Pinocchio and Drake read it: the robot's own file with its inertias and friction replaced, or a new one.
    Urdf,
    /// MJCF, MuJoCo's.
    Mjcf,
    /// SDF, as Gazebo and Drake read it.
    Sdf,
    /// Plain JSON, which holds everything that the torques depend on.
    Json,
}

impl ExportFormat {
    /// Every format.
    pub const ALL: [Self; 4] = [Self::Urdf, Self::Mjcf, Self::Sdf, Self::Json];

    /// Its name in commands.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Urdf => "urdf",
            Self::Mjcf => "mjcf",
            Self::Sdf => "sdf",
            Self::Json => "json",
        }
    }

    /// Its name for people.
    #[must_use]
    pub fn title(self) -> &'static str {
        match self {
            Self::Urdf => "URDF",
            Self::Mjcf => "MJCF",
            Self::Sdf => "SDF",
            Self::Json => "JSON",
        }
    }

    /// The extension of its files.
    #[must_use]
    pub fn extension(self) -> &'static str {
        match self {
            Self::Urdf => "urdf",
            Self::Mjcf => "xml",
            Self::Sdf => "sdf",
            Self::Json => "json",
        }
    }
}

impl fmt::Display for ExportFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for ExportFormat {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        let found = Self::ALL.into_iter().find(|format| format.name() == name);
        found.ok_or_else(|| {
            format!("there is no format {name}; the formats are {}", Self::ALL.map(Self::name).join(", "))
        })
    }
}
