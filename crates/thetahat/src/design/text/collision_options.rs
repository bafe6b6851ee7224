use serde::Deserialize;

/// The robot's own shape and what stands around it; mm and degrees.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CollisionOptions {
    /// Least distance of two shapes, mm.
    pub margin: f64,
    /// Capsules of links, in the place of the shapes that the URDF has for them.
    #[serde(default)]
    pub capsules: Vec<CapsuleOptions>,
    /// What stands around the robot.
    #[serde(default)]
    pub obstacles: Vec<ObstacleOptions>,
    /// Pairs of names, of links and obstacles, that may touch.
    #[serde(default)]
    pub ignore: Vec<[String; 2]>,
    /// Posture from which the robot comes and to which it returns, in a straight line of its coordinates: degrees or mm.
    pub home: Option<Vec<f64>>,
}

/// A capsule of a link.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CapsuleOptions {
    /// The link of the URDF, or the joint of a TOML; its frame is that of the ends.
    pub link: String,
    /// One end of the segment, mm.
    pub from: [f64; 3],
    /// The other end, mm.
    pub to: [f64; 3],
    /// Radius, mm.
    pub radius: f64,
}

/// An obstacle in the frame of the base.
#[derive(Debug, Clone, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum ObstacleOptions {
    /// Everything on one side of a plane.
    Plane {
        /// Its name.
        name: String,
        /// A point of the plane, mm.
        #[serde(default)]
        point: [f64; 3],
        /// The direction out of it.
        normal: [f64; 3],
    },
    /// A box.
    Box {
        /// Its name.
        name: String,
        /// Its centre, mm.
        centre: [f64; 3],
        /// Its edges, mm.
        edges: [f64; 3],
        /// How it is turned, degrees: about x, then y, then z.
        #[serde(default)]
        rpy: [f64; 3],
    },
    /// A cylinder along its own z axis.
    Cylinder {
        /// Its name.
        name: String,
        /// Its centre, mm.
        centre: [f64; 3],
        /// Its radius, mm.
        radius: f64,
        /// Its length, mm.
        length: f64,
        /// How it is turned, degrees: about x, then y, then z.
        #[serde(default)]
        rpy: [f64; 3],
    },
}
