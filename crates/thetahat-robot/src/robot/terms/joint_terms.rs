//! Terms of single joints.

use std::sync::Arc;

use super::{
    column::{ChannelFactor, Shape, Stribeck, StribeckLaw, TermColumn},
    description::TermDescription,
    error::TermError,
    expression::Expression,
    resolve::{Meaning, Resolver},
};
use crate::robot::{Bound, JointKind, Role};

/// Allowed exponents of Stribeck friction.
const EXPONENTS: std::ops::RangeInclusive<f64> = 0.3..=10.0;

impl Resolver<'_> {
    /// The columns of a term on one of its joints.
    pub(super) fn of_joint(&self, j: usize) -> Result<Vec<TermColumn>, TermError> {
        let with_bound = |meaning: Meaning, bound| Meaning { bound, ..meaning };
        Ok(match self.description {
            TermDescription::JointSpring { rest_deg, rest_m, .. } => self.joint_spring(j, *rest_deg, *rest_m)?,
            TermDescription::ExponentialStribeck { velocity, exponent, .. } => {
                self.stribeck(j, StribeckLaw::Exponential, *velocity, *exponent)?
            }
            TermDescription::Stribeck { velocity, exponent, .. } => {
                self.stribeck(j, StribeckLaw::Rational, *velocity, *exponent)?
            }
            TermDescription::PolynomialViscous { powers, .. } => self.polynomial(j, powers)?,
            TermDescription::AsymmetricViscous { .. } => {
                let meaning = with_bound(viscous(["N m s/rad", "N s/m"]), Bound::Free);
                vec![self.column(j, "fva", meaning, Shape::AbsoluteVelocity)]
            }
            TermDescription::LoadFriction { .. } => self.load_friction(j)?,
            TermDescription::ChannelCoulomb { channel, reference, .. } => {
                let meaning = with_bound(Meaning::COULOMB, Bound::Free);
                vec![self.of_channel(channel, *reference, self.column(j, "fc", meaning, Shape::Sign))?]
            }
            TermDescription::ChannelViscous { channel, reference, .. } => {
                let meaning = with_bound(viscous(["N m s/rad", "N s/m"]), Bound::Free);
                vec![self.of_channel(channel, *reference, self.column(j, "fv", meaning, Shape::Velocity))?]
            }
            TermDescription::MotorHarmonics { harmonics, .. } => self.harmonics(j, harmonics)?,
            TermDescription::Expression { name, expression, unit, not_negative, .. } => {
                vec![self.expression(j, name, expression, unit, *not_negative)?]
            }
            TermDescription::Spring { .. } | TermDescription::GasSpring { .. } | TermDescription::Hydraulic { .. } => {
                Vec::new()
            }
        })
    }

    fn joint_spring(&self, j: usize, rest_deg: Option<f64>, rest_m: Option<f64>) -> Result<Vec<TermColumn>, TermError> {
        let rest = match (self.robot.joints[j].kind, rest_deg, rest_m) {
            (JointKind::Revolute, degrees, None) => degrees.map(f64::to_radians),
            (JointKind::Prismatic, None, length) => length,
            (JointKind::Revolute, _, Some(length)) => {
                return Err(self.value("rest_m", "rest_deg: the joint is revolute", &length.to_string()));
            }
            (JointKind::Prismatic, Some(degrees), _) => {
                return Err(self.value("rest_deg", "rest_m: the joint is prismatic", &degrees.to_string()));
            }
        };
        let stiffness = |rest| self.column(j, "k", Meaning::STIFFNESS, Shape::Deflection { rest });
        match rest {
            Some(rest) => {
                self.require(rest.is_finite(), "the rest", "a finite number", rest)?;
                Ok(vec![stiffness(rest)])
            }
            None => Ok(vec![stiffness(0.0), self.column(j, "kr", Meaning::TORQUE, Shape::Constant)]),
        }
    }

    fn stribeck(&self, j: usize, law: StribeckLaw, velocity: f64, exponent: f64) -> Result<Vec<TermColumn>, TermError> {
        let positive = velocity > 0.0 && velocity.is_finite();
        self.require(positive, "velocity", "a velocity above zero, rad/s or m/s", velocity)?;
        self.require(EXPONENTS.contains(&exponent), "exponent", "from 0.3 to 10", exponent)?;
        let shape = Shape::Stribeck(Stribeck { law, velocity, exponent });
        Ok(vec![self.column(j, "fs", Meaning::COULOMB, shape)])
    }

    fn polynomial(&self, j: usize, powers: &[u8]) -> Result<Vec<TermColumn>, TermError> {
        let column = |&exponent: &u8| {
            let (name, units) = match exponent {
                2 => ("fvq", ["N m s^2/rad^2", "N s^2/m^2"]),
                3 => ("fvc", ["N m s^3/rad^3", "N s^3/m^3"]),
                _ => return Err(self.value("powers", "2 and 3", &exponent.to_string())),
            };
            let meaning = Meaning { bound: Bound::Free, ..viscous(units) };
            Ok(self.column(j, name, meaning, Shape::VelocityPower { exponent }))
        };
        powers.iter().map(column).collect()
    }

    fn load_friction(&self, j: usize) -> Result<Vec<TermColumn>, TermError> {
        let has_mass = |name: &String| name.starts_with('m') && self.robot.a_priori[name] != 0.0;
        if !self.robot.a_priori.keys().any(has_mass) {
            let expected =
                "masses or first moments in [parameters] or the URDF: the load is the torque of gravity on them";
            return Err(self.value("the a-priori model", expected, "without any"));
        }
        let meaning = Meaning { units: ["1", "1"], ..Meaning::COULOMB };
        Ok(vec![self.column(j, "fl", meaning, Shape::Load)])
    }

    /// A column times a recorded channel.
    fn of_channel(&self, channel: &str, reference: f64, column: TermColumn) -> Result<TermColumn, TermError> {
        self.require(reference.is_finite(), "reference", "a finite number", reference)?;
        self.check_name("channel", channel)?;
        let number = column.joint + 1;
        let letters = column.parameter.trim_end_matches(|c: char| c.is_ascii_digit());
        Ok(TermColumn {
            parameter: format!("{letters}_{channel}{number}"),
            unit: format!("{} per unit of {channel}", column.unit),
            factor: Some(ChannelFactor { channel: channel.to_owned(), reference }),
            ..column
        })
    }

    fn harmonics(&self, j: usize, harmonics: &[f64]) -> Result<Vec<TermColumn>, TermError> {
        let Some(motor) = self.robot.coordinate_joints().iter().position(|&c| c == j) else {
            return Err(self.value("joints", "joints with a motor of their own", &self.robot.joints[j].name));
        };
        let transmission = &self.robot.transmission;
        let row = |matrix: &thetahat_ground::linear_algebra::Matrix| -> Vec<(usize, f64)> {
            (0..transmission.joints()).map(|c| (c, matrix.at(motor, c))).filter(|(_, w)| *w != 0.0).collect()
        };
        let (angle, torque) = (row(transmission.matrix()), row(&transmission.motor_in_joint_units()));
        let mut columns = Vec::new();
        for &multiple in harmonics {
            let usable = multiple > 0.0 && multiple <= 1e4;
            self.require(usable, "harmonics", "multiples above zero, at most 1e4", multiple)?;
            for (name, sine) in [("hs", true), ("hc", false)] {
                let shape = Shape::Harmonic { angle: angle.clone(), torque: torque.clone(), multiple, sine };
                columns.push(self.column(j, &format!("{name}{multiple}_"), Meaning::TORQUE, shape));
            }
        }
        Ok(columns)
    }

    fn expression(
        &self,
        j: usize,
        name: &str,
        text: &str,
        unit: &str,
        not_negative: bool,
    ) -> Result<TermColumn, TermError> {
        self.check_name("name", name)?;
        let refuse = |reason: String| TermError::Expression { term: self.place(), expression: text.to_owned(), reason };
        let expression = Expression::parse(text, j, self.robot.joints.len()).map_err(refuse)?;
        check_finite(&expression).map_err(refuse)?;
        let bound = if not_negative { Bound::NotNegative } else { Bound::Free };
        let meaning = Meaning { bound, ..Meaning::TORQUE };
        let column = self.column(j, "", meaning, Shape::Expression(Arc::new(expression)));
        Ok(TermColumn { parameter: name.to_owned(), unit: unit.to_owned(), ..column })
    }

    /// Names of parameters and channels are written in files and on the command line.
    pub(super) fn check_name(&self, key: &str, name: &str) -> Result<(), TermError> {
        let letters = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let usable = name.starts_with(|c: char| c.is_ascii_alphabetic()) && name.chars().all(letters);
        if usable && name.len() <= 40 {
            return Ok(());
        }
        Err(self.value(key, "up to 40 letters, digits and _, a letter first", &format!("`{name}`")))
    }
}

fn viscous(units: [&'static str; 2]) -> Meaning {
    Meaning { role: Role::ViscousFriction, bound: Bound::NotNegative, units }
}

/// Values of each variable, alone and with the others, at which an expression must be finite.
const PROBES: [f64; 7] = [0.0, 1e-3, -1e-3, 0.7, -1.3, 3.0, -3.0];

fn check_finite(expression: &Expression) -> Result<(), String> {
    let count = expression.variables().len();
    for first in 0..PROBES.len() {
        for stride in 0..PROBES.len() {
            let values: Vec<f64> = (0..count).map(|k| PROBES[(first + k * stride) % PROBES.len()]).collect();
            let value = expression.value(&values);
            if !value.is_finite() {
                let remedy = "make it finite in every state, as with abs or max";
                return Err(format!("it is {value} where its variables are {values:?}; {remedy}"));
            }
        }
    }
    Ok(())
}
