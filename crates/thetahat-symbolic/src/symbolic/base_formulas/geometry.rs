//! A joint's axis and origin in symbols.

use std::collections::BTreeMap;

use super::polynomial::Polynomial;
use crate::symbolic::snapping::exact_sin_cos;
use thetahat_model::robot::{JointKind, Placement, Robot};

/// Entries of vectors and matrices.
pub(super) type Vector = [Polynomial; 3];
pub(super) type Matrix = [Vector; 3];

/// A joint in symbols.
pub(super) struct Joint {
    pub(super) kind: JointKind,
    pub(super) parent: Option<usize>,
    /// Its rotation to the frame before; for a revolute joint without its own turn.
    pub(super) rotation: Matrix,
    pub(super) origin: Vector,
}

/// Symbols of the geometry, with their values in m, or as sines and cosines.
#[derive(Debug, Default)]
pub(super) struct Symbols {
    pub(super) values: BTreeMap<String, f64>,
}

impl Symbols {
    /// A symbol, or zero if the value is zero.
    fn named(&mut self, name: String, value: f64) -> Polynomial {
        if value == 0.0 {
            return Polynomial::default();
        }
        self.values.insert(name.clone(), value);
        Polynomial::symbol(name)
    }

    /// Sine and cosine, as numbers if they are 0, 1 or -1.
    fn sine_and_cosine(&mut self, angle: f64, name: &str) -> [Polynomial; 2] {
        let (s, c) = exact_sin_cos(angle);
        if s == 0.0 || c == 0.0 {
            return [s, c].map(Polynomial::number);
        }
        [("s", s), ("c", c)].map(|(function, value)| self.named(format!("{function}_{name}"), value))
    }
}

/// The joints of a snapped robot.
pub(super) fn joints(robot: &Robot) -> (Vec<Joint>, Symbols) {
    let mut symbols = Symbols::default();
    let joints = robot.joints.iter().enumerate().map(|(j, joint)| {
        let Placement { gamma, alpha, theta, origin } = joint.placement;
        let number = j + 1;
        let mut tilt = about_z(symbols.sine_and_cosine(gamma, &format!("gamma{number}")));
        let [s, c] = symbols.sine_and_cosine(alpha, &format!("alpha{number}"));
        let none = Polynomial::default;
        let about_x = [[Polynomial::number(1.0), none(), none()], [none(), c.clone(), s.scaled(-1.0)], [none(), s, c]];
        tilt = product(&tilt, &about_x);
        let origin = origin_in_symbols(origin, [gamma, alpha], &tilt, number, &mut symbols);
        let rotation = match joint.kind {
            JointKind::Revolute => tilt,
            JointKind::Prismatic => product(&tilt, &about_z(symbols.sine_and_cosine(theta, &format!("theta{number}")))),
        };
        Joint { kind: joint.kind, parent: joint.parent, rotation, origin }
    });
    (joints.collect(), symbols)
}

/// `a` along x and `d` along the axis if gamma is zero and there is no other offset; otherwise the three lengths.
fn origin_in_symbols(
    origin: [f64; 3],
    angles: [f64; 2],
    tilt: &Matrix,
    number: usize,
    symbols: &mut Symbols,
) -> Vector {
    let [gamma, alpha] = angles;
    let (s, c) = exact_sin_cos(alpha);
    let (across, d) = (c * origin[1] + s * origin[2], c * origin[2] - s * origin[1]);
    if gamma != 0.0 || across.abs() > 1e-12 * d.abs() {
        return [("x", 0), ("y", 1), ("z", 2)].map(|(name, i)| symbols.named(format!("{name}{number}"), origin[i]));
    }
    let (a, d) = (symbols.named(format!("a{number}"), origin[0]), symbols.named(format!("d{number}"), d));
    let mut lengths = [a, Polynomial::default(), Polynomial::default()];
    for (i, length) in lengths.iter_mut().enumerate() {
        *length += &(&tilt[i][2] * &d);
    }
    lengths
}

fn about_z([s, c]: [Polynomial; 2]) -> Matrix {
    let none = Polynomial::default;
    [[c.clone(), s.scaled(-1.0), none()], [s, c, none()], [none(), none(), Polynomial::number(1.0)]]
}

pub(super) fn product(a: &Matrix, b: &Matrix) -> Matrix {
    let entry = |i: usize, j: usize| {
        let mut sum = Polynomial::default();
        (0..3).for_each(|k| sum += &(&a[i][k] * &b[k][j]));
        sum
    };
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| entry(i, j)))
}
