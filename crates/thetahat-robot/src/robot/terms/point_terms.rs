//! Forces between two points.

use super::{
    column::{Cylinder, LinkPoint, Shape, TermColumn, TwoPoints},
    description::{Direction, PointDescription, TermDescription},
    error::TermError,
    resolve::{Meaning, Resolver},
};
use crate::robot::{Bound, LARGEST};

impl Resolver<'_> {
    /// The columns of a force between two points; none if the term is of another kind.
    pub(super) fn between_points(&self) -> Result<Option<Vec<TermColumn>>, TermError> {
        let columns = match self.description {
            TermDescription::Spring { name, from, to, free_length_m } => {
                let ends = self.ends(name, [from, to])?;
                let stiffness = |length| self.force(&ends, "k", STIFFNESS, Cylinder::Linear { length });
                match free_length_m {
                    Some(length) => vec![stiffness(self.length("free_length_m", *length)?)],
                    None => {
                        let preload = Meaning { bound: Bound::Free, ..FORCE };
                        vec![stiffness(0.0), self.force(&ends, "p", preload, Cylinder::Constant(-1.0))]
                    }
                }
            }
            TermDescription::GasSpring { name, from, to, extended_length_m } => {
                let ends = self.ends(name, [from, to])?;
                let mut columns = vec![self.force(&ends, "f", FORCE, Cylinder::Constant(-1.0))];
                if let Some(length) = extended_length_m {
                    let length = self.length("extended_length_m", *length)?;
                    columns.push(self.force(&ends, "k", STIFFNESS, Cylinder::Linear { length }));
                }
                columns
            }
            TermDescription::Hydraulic { name, from, to, direction, length_m, gas_length_m, exponent } => {
                let ends = self.ends(name, [from, to])?;
                let length = self.length("length_m", *length_m)?;
                let gas_length = self.length("gas_length_m", *gas_length_m)?;
                let sign = match direction {
                    Direction::Pull => 1.0,
                    Direction::Push => -1.0,
                };
                let Some(exponent) = *exponent else {
                    let force = self.force(&ends, "f", FORCE, Cylinder::Constant(sign));
                    return Ok(Some(vec![force, self.force(&ends, "k", STIFFNESS, Cylinder::Linear { length })]));
                };
                self.require((0.5..=3.0).contains(&exponent), "exponent", "from 0.5 to 3, such as 1.2", exponent)?;
                let gas = Cylinder::Gas { sign, length, gas_length, exponent };
                vec![self.force(&ends, "f", FORCE, gas)]
            }
            TermDescription::JointSpring { .. }
            | TermDescription::ExponentialStribeck { .. }
            | TermDescription::Stribeck { .. }
            | TermDescription::PolynomialViscous { .. }
            | TermDescription::AsymmetricViscous { .. }
            | TermDescription::LoadFriction { .. }
            | TermDescription::ChannelCoulomb { .. }
            | TermDescription::ChannelViscous { .. }
            | TermDescription::MotorHarmonics { .. }
            | TermDescription::Expression { .. } => return Ok(None),
        };
        Ok(Some(columns))
    }

    fn ends(&self, name: &str, ends: [&PointDescription; 2]) -> Result<Ends, TermError> {
        self.check_name("name", name)?;
        let [from, to] = [self.point("from", ends[0])?, self.point("to", ends[1])?];
        if from.joint == to.joint {
            let expected = "another link than from: a force inside one link moves nothing";
            let of = |joint: Option<usize>| joint.map_or("the base", |j| self.robot.joints[j].name.as_str());
            return Err(self.value("to.link_of", expected, of(to.joint)));
        }
        Ok(Ends { name: name.to_owned(), from, to })
    }

    fn point(&self, key: &str, point: &PointDescription) -> Result<LinkPoint, TermError> {
        if let Some(found) = point.point_m.iter().find(|v| v.is_nan() || v.abs() > LARGEST) {
            return Err(self.value(&format!("{key}.point_m"), "finite lengths in m", &found.to_string()));
        }
        let joint = point.link_of.as_ref().map(|name| self.joint(name)).transpose()?;
        Ok(LinkPoint { joint, position: point.point_m })
    }

    fn length(&self, key: &str, length: f64) -> Result<f64, TermError> {
        self.require(length > 0.0 && length <= LARGEST, key, "a length above zero in m", length)?;
        Ok(length)
    }

    fn force(&self, ends: &Ends, letter: &str, meaning: Meaning, tension: Cylinder) -> TermColumn {
        let Ends { name, from, to } = ends;
        let joint = from.joint.max(to.joint).unwrap_or(0);
        let shape = Shape::BetweenPoints(TwoPoints { from: *from, to: *to, tension });
        TermColumn { parameter: format!("{letter}_{name}"), ..self.column(joint, "", meaning, shape) }
    }
}

struct Ends {
    name: String,
    from: LinkPoint,
    to: LinkPoint,
}

const STIFFNESS: Meaning = Meaning { units: ["N/m", "N/m"], ..Meaning::STIFFNESS };
const FORCE: Meaning = Meaning { bound: Bound::NotNegative, units: ["N", "N"], ..Meaning::TORQUE };
