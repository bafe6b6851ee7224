//! A robot whose parts move independently.

/// Two legs of two joints each, which are numbered leg by leg; a motor of the second leg turns both of its joints.
pub const TWO_LEGS: &str = "
name = 'legs'
[[joint]]
name = 'left hip'
kind = 'revolute'
alpha_deg = 90
[[joint]]
name = 'right hip'
kind = 'revolute'
alpha_deg = -70
b_m = 0.2
[[joint]]
name = 'left knee'
kind = 'revolute'
parent = 'left hip'
a_m = 0.3
alpha_deg = 20
[[joint]]
name = 'right knee'
kind = 'revolute'
parent = 'right hip'
a_m = 0.25
[transmission]
matrix = [[2, 0, 0, 0], [0, -4, 0, 0], [0, 0, 3, 0], [0, 0, 1, 5]]
";
