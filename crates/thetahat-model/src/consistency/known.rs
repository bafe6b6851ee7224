use super::{elimination::Equality, error::ConsistencyError};
use crate::robot::{LinkQuantity, ParameterTable, Quantity};

/// A known property of the standard parameters, for example from a data sheet.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Known {
    /// A parameter has this value.
    Value {
        /// Name, as `m7`.
        parameter: String,
        /// Value in SI.
        value: f64,
    },
    /// A parameter lies between two bounds, either of which may be infinite.
    Range {
        /// Name, as `fv3`.
        parameter: String,
        /// Lower bound in SI.
        lower: f64,
        /// Upper bound in SI.
        upper: f64,
    },
    /// The mass of all moving links together lies between two bounds, kg; equal bounds fix it.
    TotalMass {
        /// Lower bound, kg.
        lower: f64,
        /// Upper bound, kg; may be infinite.
        upper: f64,
    },
    /// The centre of mass of a link lies in a box along the axes of the link's frame.
    CentreOfMass {
        /// The link, from one.
        link: usize,
        /// Lower corner, m.
        lower: [f64; 3],
        /// Upper corner, m; equal to the lower one if a coordinate is known.
        upper: [f64; 3],
    },
    /// A link is symmetric about the plane through its frame's origin that is normal to one axis.
    MirrorPlane {
        /// The link, from one.
        link: usize,
        /// The axis, 0 to 2 for x to z.
        normal: usize,
    },
    /// A linear combination of parameters has this value.
    Sum {
        /// Names and coefficients.
        terms: Vec<(String, f64)>,
        /// Value in SI.
        value: f64,
    },
}

/// `sum_v coefficient_v x_v + constant >= 0`.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Inequality {
    pub(super) name: String,
    pub(super) terms: Vec<(usize, f64)>,
    pub(super) constant: f64,
}

/// Equalities and inequalities in the parameters of a table.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct LinearConditions {
    pub(super) equalities: Vec<Equality>,
    pub(super) inequalities: Vec<Inequality>,
}

type Terms = Vec<(usize, f64)>;

const MOMENTS: [LinkQuantity; 3] = [LinkQuantity::Mx, LinkQuantity::My, LinkQuantity::Mz];
const MASS: Quantity = Quantity::Link(LinkQuantity::M);
const AXES: [&str; 3] = ["x", "y", "z"];

impl LinearConditions {
    /// Adds a known property.
    ///
    /// # Errors
    /// [`ConsistencyError`] for invalid names, links and values.
    pub(super) fn add(&mut self, table: &ParameterTable, known: &Known) -> Result<(), ConsistencyError> {
        match known {
            Known::Value { parameter, value } => self.sum(table, &[(parameter.clone(), 1.0)], *value),
            Known::Range { parameter, lower, upper } => {
                let terms = vec![(index_of(table, parameter)?, 1.0)];
                self.between(parameter, &terms, *lower, *upper)
            }
            Known::TotalMass { lower, upper } => {
                let masses = (0..table.len()).filter(|&i| table.get(i).quantity == MASS);
                self.between("the total mass", &masses.map(|i| (i, 1.0)).collect::<Terms>(), *lower, *upper)
            }
            Known::CentreOfMass { link, lower, upper } => self.centre_of_mass(table, *link, lower, upper),
            Known::MirrorPlane { link, normal } => self.mirror(table, *link, *normal),
            Known::Sum { terms, value } => self.sum(table, terms, *value),
        }
    }

    fn sum(&mut self, table: &ParameterTable, terms: &[(String, f64)], value: f64) -> Result<(), ConsistencyError> {
        let name = match terms {
            [(parameter, _)] => parameter.clone(),
            _ => terms.iter().map(|(parameter, c)| format!("{c} {parameter}")).collect::<Vec<_>>().join(" + "),
        };
        finite(&name, value)?;
        terms.iter().try_for_each(|(_, c)| finite(&name, *c))?;
        let terms = terms.iter().map(|(parameter, c)| Ok((index_of(table, parameter)?, *c)));
        self.equal(&name, terms.collect::<Result<_, ConsistencyError>>()?, value);
        Ok(())
    }

    fn centre_of_mass(
        &mut self,
        table: &ParameterTable,
        link: usize,
        lower: &[f64; 3],
        upper: &[f64; 3],
    ) -> Result<(), ConsistencyError> {
        let mass = index_in_link(table, LinkQuantity::M, link)?;
        for axis in 0..3 {
            let moment = index_in_link(table, MOMENTS[axis], link)?;
            let name = format!("centre of mass {} of link {link}", AXES[axis]);
            let (lower, upper) = ordered(&name, lower[axis], upper[axis])?;
            if lower == upper {
                self.equal(&name, vec![(moment, 1.0), (mass, -lower)], 0.0);
                continue;
            }
            self.above_if_finite(&name, lower, vec![(moment, 1.0), (mass, -lower)], 0.0);
            self.above_if_finite(&name, upper, vec![(moment, -1.0), (mass, upper)], 0.0);
        }
        Ok(())
    }

    fn mirror(&mut self, table: &ParameterTable, link: usize, normal: usize) -> Result<(), ConsistencyError> {
        let odd = match normal {
            0 => [LinkQuantity::Mx, LinkQuantity::Xy, LinkQuantity::Xz],
            1 => [LinkQuantity::My, LinkQuantity::Xy, LinkQuantity::Yz],
            2 => [LinkQuantity::Mz, LinkQuantity::Xz, LinkQuantity::Yz],
            _ => {
                let what = format!("mirror plane of link {link}");
                return Err(ConsistencyError::BadValue { what, reason: "the axis is 0, 1 or 2".to_owned() });
            }
        };
        for quantity in odd {
            let index = index_in_link(table, quantity, link)?;
            self.equal(&format!("{}{link}", quantity.name()), vec![(index, 1.0)], 0.0);
        }
        Ok(())
    }

    pub(super) fn between(
        &mut self,
        name: &str,
        terms: &[(usize, f64)],
        lower: f64,
        upper: f64,
    ) -> Result<(), ConsistencyError> {
        let (lower, upper) = ordered(name, lower, upper)?;
        if lower == upper {
            self.equal(name, terms.to_vec(), lower);
            return Ok(());
        }
        self.above_if_finite(name, lower, terms.to_vec(), -lower);
        self.above_if_finite(name, upper, terms.iter().map(|&(v, c)| (v, -c)).collect(), upper);
        Ok(())
    }

    fn equal(&mut self, name: &str, terms: Terms, value: f64) {
        self.equalities.push(Equality { name: name.to_owned(), terms, value });
    }

    fn above_if_finite(&mut self, name: &str, bound: f64, terms: Terms, constant: f64) {
        if bound.is_finite() {
            self.inequalities.push(Inequality { name: format!("bound of {name}"), terms, constant });
        }
    }
}

fn index_of(table: &ParameterTable, name: &str) -> Result<usize, ConsistencyError> {
    table.index_of(name).ok_or_else(|| ConsistencyError::UnknownParameter { name: name.to_owned() })
}

fn index_in_link(table: &ParameterTable, quantity: LinkQuantity, link: usize) -> Result<usize, ConsistencyError> {
    let found = link.checked_sub(1).and_then(|k| table.index(Quantity::Link(quantity), k));
    let links = table.iter().filter(|p| p.quantity == MASS).count();
    found.ok_or(ConsistencyError::UnknownLink { number: link, links })
}

fn finite(what: &str, value: f64) -> Result<(), ConsistencyError> {
    let bad = || ConsistencyError::BadValue { what: what.to_owned(), reason: format!("{value} is not finite") };
    if value.is_finite() { Ok(()) } else { Err(bad()) }
}

fn ordered(what: &str, lower: f64, upper: f64) -> Result<(f64, f64), ConsistencyError> {
    if lower <= upper && lower < f64::INFINITY && upper > f64::NEG_INFINITY {
        return Ok((lower, upper));
    }
    let reason = format!("the lower bound {lower} is not below the upper bound {upper}");
    Err(ConsistencyError::BadValue { what: what.to_owned(), reason })
}
