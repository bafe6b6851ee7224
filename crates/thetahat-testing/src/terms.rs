//! A robot for tests of torque terms.

/// A tree with a prismatic joint, a follower and a coupled motor; every kind of term except those of channels and
/// accelerations.
pub const ROBOT_WITH_TERMS: &str = r#"
name = "all"
gravity = [0.3, -1.2, -9.7]
[[joint]]
name = "a"
kind = "revolute"
[[joint]]
name = "b"
parent = "a"
kind = "prismatic"
alpha_deg = 90
a_m = 0.2
[[joint]]
name = "c"
parent = "b"
kind = "revolute"
alpha_deg = -40
gamma_deg = 20
d_m = 0.3
[[joint]]
name = "d"
kind = "revolute"
parent = "b"
a_m = 0.4
mimic = { joint = "a", ratio = -1.5 }
[transmission]
matrix = [[45, 0, 0], [0, 20, 0], [3, 0, 32]]
[parameters]
m2 = 2.0
mx3 = 0.4
m3 = 1.5
my4 = 0.3
m4 = 0.7
[[term]]
kind = "joint-spring"
joints = ["a", "d"]
rest_deg = 25
[[term]]
kind = "joint-spring"
joints = ["b"]
[[term]]
kind = "exponential-stribeck"
velocity = 0.4
exponent = 1.3
[[term]]
kind = "polynomial-viscous"
powers = [2, 3]
[[term]]
kind = "asymmetric-viscous"
[[term]]
kind = "load-friction"
[[term]]
kind = "motor-harmonics"
harmonics = [0.05, 0.1]
[[term]]
kind = "spring"
name = "first"
from = { point_m = [0.5, -0.8, 0.9] }
to = { link_of = "c", point_m = [0.1, 0.2, -0.3] }
free_length_m = 0.6
[[term]]
kind = "gas-spring"
name = "second"
from = { link_of = "d", point_m = [0.3, 0.1, 0.0] }
to = { link_of = "c", point_m = [-0.2, 0.25, 0.1] }
extended_length_m = 0.9
[[term]]
kind = "hydraulic"
name = "third"
direction = "pull"
from = { point_m = [-0.6, 0.3, 1.0] }
to = { link_of = "b", point_m = [0.2, 0.0, 0.1] }
length_m = 1.0
gas_length_m = 0.8
exponent = 1.2
[[term]]
kind = "expression"
name = "own"
joint = "c"
expression = "sin(2*q) * dq1 + 0.3*s*abs(dq)^0.7 + q2^2"
"#;
