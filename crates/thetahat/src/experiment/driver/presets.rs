/// A preset by its name: the file of this name in the folder `drivers`.
macro_rules! presets {
    ($($name:literal),* $(,)?) => {
        /// Names and texts of the presets, in the order of the alphabet.
        pub(super) const PRESETS: &[(&str, &str)] =
            &[$(($name, include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/drivers/", $name, ".toml")))),*];
    };
}

presets![
    "cia402",
    "doosan",
    "dynamixel-330",
    "dynamixel-x",
    "fairino",
    "flexiv",
    "franka",
    "interbotix",
    "kinova",
    "kinova-ros2",
    "kuka-fri",
    "kuka-ros2",
    "realman",
    "ros-joint-states",
    "unitree-g1",
    "unitree-go2",
    "ur-ros2",
    "ur-rtde",
];
