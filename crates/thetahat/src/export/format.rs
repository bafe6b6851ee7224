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
    /// PACE's vector of parameters in JSON: the drives alone.
    Pace,
    /// The arguments of Isaac Lab's actuators in JSON: the drives alone.
    Isaac,
    /// BAM's parameters of one actuator in JSON.
    Bam,
}

/// A format of drives alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ActuatorFormat {
    Pace,
    Isaac,
    Bam,
}

impl ActuatorFormat {
    pub(super) fn of_exports(self) -> ExportFormat {
        match self {
            Self::Pace => ExportFormat::Pace,
            Self::Isaac => ExportFormat::Isaac,
            Self::Bam => ExportFormat::Bam,
        }
    }
}

impl ExportFormat {
    /// Every format.
    pub const ALL: [Self; 7] = [Self::Urdf, Self::Mjcf, Self::Sdf, Self::Json, Self::Pace, Self::Isaac, Self::Bam];

    /// Its name in commands.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Urdf => "urdf",
            Self::Mjcf => "mjcf",
            Self::Sdf => "sdf",
            Self::Json => "json",
            Self::Pace => "pace",
            Self::Isaac => "isaac",
            Self::Bam => "bam",
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
            Self::Pace => "PACE",
            Self::Isaac => "Isaac Lab",
            Self::Bam => "BAM",
        }
    }

    /// The extension of its files.
    #[must_use]
    pub fn extension(self) -> &'static str {
        match self {
            Self::Urdf => "urdf",
            Self::Mjcf => "xml",
            Self::Sdf => "sdf",
            Self::Json | Self::Pace | Self::Isaac | Self::Bam => "json",
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
