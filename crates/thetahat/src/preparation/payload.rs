//! A load that some recordings carry and others do not: where it is fixed, and what is known of it.

use serde::Deserialize;

use super::error::PreparationError;
use thetahat_ground::{
    linear_algebra::Matrix,
    vector::{Mat3, Vec3, dot, product, times, turned},
};
use thetahat_model::{
    consistency::pseudo_inertia,
    robot::{INERTIAL, ParameterTable, Quantity, Robot},
};

/// A body fixed to a link: an entry of `[[payload]]`, carried in recordings with `payload = "name"`. Without mass it is
/// estimated.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Payload {
    /// Its name, by which recordings name it.
    pub name: String,
    /// The joint to whose link it is fixed; none means the last.
    pub joint: Option<String>,
    /// The frame to which its quantities refer, in the frame of the link.
    #[serde(default)]
    pub frame: PayloadFrame,
    /// Its mass, kg; none if it is to be estimated.
    pub mass_kg: Option<f64>,
    /// Its centre of mass in its frame, m.
    #[serde(default)]
    pub centre_m: Option<[f64; 3]>,
    /// `[xx, xy, xz, yy, yz, zz]` of its inertia about its centre of mass, along the axes of its frame, kg m^2; none means
    /// a point mass.
    #[serde(default)]
    pub inertia_kgm2: Option<[f64; 6]>,
}

/// A frame in the frame of a link.
#[derive(Debug, Clone, Copy, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PayloadFrame {
    /// Its origin, m.
    pub xyz_m: [f64; 3],
    /// Its axes: turned about the fixed x, y and z axes, in this order, degrees, as URDF's `rpy`.
    pub rpy_deg: [f64; 3],
}

/// Relative size of a negative eigenvalue of a known payload's pseudo-inertia that is rounding: a point mass has zeros.
const ROUNDING: f64 = 1e-9;

impl Payload {
    /// Whether its ten parameters are known.
    #[must_use]
    pub fn is_known(&self) -> bool {
        self.mass_kg.is_some()
    }

    /// Its ten inertial parameters in its frame and about the frame's origin, in the order of [`INERTIAL`]; none if it
    /// is to be estimated.
    #[must_use]
    pub fn parameters(&self) -> Option<[f64; 10]> {
        let (m, c) = (self.mass_kg?, self.centre_m?);
        let moved = moved_inertia(m, [0.0; 3], c);
        let about_centre = self.inertia_kgm2.unwrap_or_default();
        let [xx, xy, xz, yy, yz, zz] = std::array::from_fn(|i| about_centre[i] + moved[i]);
        Some([xx, xy, xz, yy, yz, zz, m * c[0], m * c[1], m * c[2], m])
    }

    /// The link that carries it, by its index among the robot's joints.
    ///
    /// # Errors
    /// [`PreparationError::Value`] for a joint that the robot does not have.
    pub fn link(&self, robot: &Robot) -> Result<usize, PreparationError> {
        let Some(name) = &self.joint else { return Ok(robot.joints.len() - 1) };
        let names = || robot.joints.iter().map(|j| j.name.as_str()).collect::<Vec<_>>().join(" ");
        let found = robot.joints.iter().position(|j| j.name == *name);
        found.ok_or_else(|| self.refuse("joint", &format!("one of {}", names()), name))
    }

    /// `T`, 10 x 10: the parameters of its link gain `T theta` by a payload of parameters theta in its frame.
    #[must_use]
    pub fn to_link(&self) -> Matrix {
        let (r, p) = (self.frame.rotation(), self.frame.xyz_m);
        let mut t = Matrix::zeros(10, 10);
        for column in 0..10 {
            let unit: [f64; 10] = std::array::from_fn(|i| f64::from(u8::from(i == column)));
            t.column_mut(column).copy_from_slice(&in_link(&r, p, unit));
        }
        t
    }

    /// What a known payload adds to the standard parameters of the robot; zeros for one to be estimated.
    ///
    /// # Errors
    /// As [`Payload::link`].
    pub fn standard_parameters(&self, robot: &Robot, table: &ParameterTable) -> Result<Vec<f64>, PreparationError> {
        let mut standard = vec![0.0; table.len()];
        let columns = self.columns(robot, table)?;
        let of_link = self.parameters().map(|theta| self.to_link().times(&theta)).unwrap_or_default();
        columns.iter().zip(of_link).for_each(|(column, value)| standard[*column] = value);
        Ok(standard)
    }

    /// The places of its link's ten parameters in a table.
    ///
    /// # Errors
    /// As [`Payload::link`].
    pub fn columns(&self, robot: &Robot, table: &ParameterTable) -> Result<Vec<usize>, PreparationError> {
        let link = self.link(robot)?;
        Ok(INERTIAL.into_iter().filter_map(|quantity| table.index(Quantity::Link(quantity), link)).collect())
    }

    /// Refuses what no body is.
    pub(super) fn validate(&self, robot: &Robot) -> Result<(), PreparationError> {
        self.link(robot)?;
        let numbers = self.frame.xyz_m.iter().chain(&self.frame.rpy_deg).chain(self.centre_m.iter().flatten());
        if let Some(value) = numbers.chain(self.inertia_kgm2.iter().flatten()).find(|v| !v.is_finite()) {
            return Err(self.refuse("its numbers", "finite", value));
        }
        let Some(mass) = self.mass_kg else {
            let stated = self.centre_m.is_some() || self.inertia_kgm2.is_some();
            let expected = "given with centre_m and inertia_kgm2, or none of the three for a payload to be estimated";
            return if stated { Err(self.refuse("mass_kg", expected, "missing")) } else { Ok(()) };
        };
        if !(mass > 0.0 && mass.is_finite()) {
            return Err(self.refuse("mass_kg", "a finite number above zero", mass));
        }
        let Some(parameters) = self.parameters() else {
            return Err(self.refuse("centre_m", "given where the mass is", "missing"));
        };
        let eigenvalues = pseudo_inertia(parameters).eigenvalues();
        let largest = eigenvalues.iter().copied().fold(0.0, f64::max);
        match eigenvalues.iter().all(|v| *v >= -ROUNDING * largest) {
            true => Ok(()),
            false => Err(self.refuse("inertia_kgm2", "that of a body, about its centre of mass", "that of none")),
        }
    }

    fn refuse(&self, key: &str, expected: &str, found: impl std::fmt::Display) -> PreparationError {
        PreparationError::value(&format!("[[payload]] {}: {key}", self.name), expected, found)
    }
}

impl PayloadFrame {
    /// The rotation from the frame to the link's axes.
    fn rotation(&self) -> Mat3 {
        let [(sr, cr), (sp, cp), (sy, cy)] = self.rpy_deg.map(|angle| angle.to_radians().sin_cos());
        let x: Mat3 = [[1.0, 0.0, 0.0], [0.0, cr, -sr], [0.0, sr, cr]];
        let y: Mat3 = [[cp, 0.0, sp], [0.0, 1.0, 0.0], [-sp, 0.0, cp]];
        let z: Mat3 = [[cy, -sy, 0.0], [sy, cy, 0.0], [0.0, 0.0, 1.0]];
        product(&z, &product(&y, &x))
    }
}

/// Inertial parameters about the link's origin and along its axes, of those about a frame at `p` whose axes are turned by r.
fn in_link(r: &Mat3, p: Vec3, theta: [f64; 10]) -> [f64; 10] {
    let [xx, xy, xz, yy, yz, zz, hx, hy, hz, m] = theta;
    let inertia = turned(r, &[[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]);
    let h = times(r, [hx, hy, hz]);
    let own = [inertia[0][0], inertia[0][1], inertia[0][2], inertia[1][1], inertia[1][2], inertia[2][2]];
    let moved = moved_inertia(m, h, p);
    let [xx, xy, xz, yy, yz, zz] = std::array::from_fn(|i| own[i] + moved[i]);
    let [x, y, z] = std::array::from_fn(|i| h[i] + m * p[i]);
    [xx, xy, xz, yy, yz, zz, x, y, z, m]
}

/// What a shift by p adds to an inertia about the origin: `m (p^2 1 - p p^T) + 2 (p h) 1 - p h^T - h p^T`, with the mass m and
/// the first moments h before the shift; `[xx, xy, xz, yy, yz, zz]`.
fn moved_inertia(m: f64, h: Vec3, p: Vec3) -> [f64; 6] {
    let trace = m * dot(p, p) + 2.0 * dot(p, h);
    let entry = |i: usize, j: usize| {
        let diagonal = if i == j { trace } else { 0.0 };
        diagonal - m * p[i] * p[j] - p[i] * h[j] - h[i] * p[j]
    };
    [entry(0, 0), entry(0, 1), entry(0, 2), entry(1, 1), entry(1, 2), entry(2, 2)]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn payload(text: &str) -> Payload {
        toml::from_str(&format!("name = 'p'\n{text}")).unwrap()
    }

    /// The sum over points `m r r^T` in another frame is that of the points carried there.
    #[test]
    fn parameters_move_with_the_points_that_make_them() {
        let points = [([0.1, -0.2, 0.3], 1.5), ([-0.4, 0.05, 0.2], 0.7), ([0.0, 0.3, -0.1], 2.0)];
        let of_points = |place: &dyn Fn(Vec3) -> Vec3| {
            points.iter().fold([0.0; 10], |sum, (r, m)| {
                let one = Payload { mass_kg: Some(*m), centre_m: Some(place(*r)), ..payload("") };
                let one = one.parameters().unwrap();
                std::array::from_fn(|i| sum[i] + one[i])
            })
        };
        let with_frame = payload("frame = { xyz_m = [0.3, -0.1, 0.25], rpy_deg = [20, -50, 110] }");
        let (r, p) = (with_frame.frame.rotation(), with_frame.frame.xyz_m);
        let expected = of_points(&|x| std::array::from_fn(|i| times(&r, x)[i] + p[i]));
        let found = with_frame.to_link().times(&of_points(&|x| x));
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-14), "{found:?} {expected:?}");
    }

    #[test]
    fn a_body_is_known_by_mass_centre_and_inertia() {
        let known = payload("mass_kg = 2\ncentre_m = [0.1, 0, 0.2]\ninertia_kgm2 = [0.01, 0, 0, 0.02, 0, 0.015]");
        let expected = [0.01 + 0.08, 0.0, -0.04, 0.02 + 0.1, 0.0, 0.015 + 0.02, 0.2, 0.0, 0.4, 2.0];
        let found = known.parameters().unwrap();
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15), "{found:?}");
        assert!(!payload("").is_known());
    }

    #[test]
    fn what_no_body_is_is_refused() {
        let robot = "name = 'r'\n[[joint]]\nname = 'a'\nkind = 'revolute'\n";
        let robot = Robot::parse(robot, std::path::Path::new("r.toml")).unwrap();
        let says = |text: &str| payload(text).validate(&robot).unwrap_err().to_string();
        assert_eq!(says("joint = 'b'"), "[[payload]] p: joint is b, expected one of a");
        assert_eq!(says("mass_kg = -1"), "[[payload]] p: mass_kg is -1, expected a finite number above zero");
        assert_eq!(says("mass_kg = 1"), "[[payload]] p: centre_m is missing, expected given where the mass is");
        assert!(says("centre_m = [0, 0, 0]").contains("mass_kg is missing"));
        let flat = "mass_kg = 1\ncentre_m = [0, 0, 0]\ninertia_kgm2 = [1, 0, 0, 0.1, 0, 0.1]";
        assert!(says(flat).contains("inertia_kgm2 is that of none"));
        assert!(payload("mass_kg = 1\ncentre_m = [0, 0, 0.1]").validate(&robot).is_ok());
    }
}
