//! The formulas of the base parameters.

use std::{collections::BTreeMap, fmt};

use super::{
    geometry::joints,
    polynomial::Polynomial,
    rules::{Form, add, regrouped},
};
use crate::symbolic::snapping::snapped;
use thetahat_model::{
    base_parameters::{BaseParameter, BaseParameters, BaseParametersError},
    dynamics::Model,
    robot::{INERTIAL, ParameterTable, Quantity, Robot},
};

/// Distance from an integer, or from zero, within which a coefficient is replaced by it.
const ROUNDING: f64 = 1e-8;

/// A symbol of the geometry.
#[derive(Debug, Clone, PartialEq)]
pub struct GeometrySymbol {
    /// Such as `d3`, or `s_alpha3` for a sine.
    pub name: String,
    /// Its value: a length in m, a sine or a cosine.
    pub value: f64,
}

/// A base parameter as a formula.
#[derive(Debug, Clone, PartialEq)]
pub struct BaseFormula {
    /// Its name.
    pub name: String,
    /// Its formula in standard parameters and symbols of the geometry.
    pub expression: String,
    /// Index and coefficient of each standard parameter, with the geometry's values inserted.
    pub coefficients: Vec<(usize, f64)>,
}

/// The base parameters of a robot as formulas.
#[derive(Debug, Clone, PartialEq)]
pub struct BaseFormulas {
    /// The base parameters in order.
    pub parameters: Vec<BaseFormula>,
    /// The symbols of the geometry that occur in them.
    pub symbols: Vec<GeometrySymbol>,
}

impl BaseFormulas {
    /// The formulas of a robot, whose right angles and zeros are treated as exact.
    ///
    /// # Errors
    /// [`BaseParametersError`] if the base parameters are not unique.
    pub fn of(robot: &Robot) -> Result<Self, BaseParametersError> {
        let robot = snapped(robot).0;
        let model = Model::new(&robot);
        let base = BaseParameters::of(&model, &[])?;
        let (joints, symbols) = joints(&robot);
        let table = model.parameter_table();
        let rules = Rules::new(table, regrouped(&robot, table, &joints));
        let forms: Vec<Form> = base.parameters().iter().map(|parameter| rules.form(parameter)).collect();
        let value = |name: &str| symbols.values.get(name).copied().unwrap_or(0.0);
        let formula = |(parameter, form): (&BaseParameter, &Form)| BaseFormula {
            name: parameter.name.clone(),
            expression: expression(table, parameter.kept, form),
            coefficients: form.iter().map(|(index, factor)| (*index, factor.value(&value))).collect(),
        };
        let is_used = |name: &String| forms.iter().flat_map(Form::values).any(|p| p.symbols().any(|n| n == name));
        let used = symbols.values.iter().filter(|(name, _)| is_used(name));
        Ok(Self {
            parameters: base.parameters().iter().zip(&forms).map(formula).collect(),
            symbols: used.map(|(name, value)| GeometrySymbol { name: name.clone(), value: *value }).collect(),
        })
    }
}

/// The expression of each standard parameter of a link after the rules.
struct Rules {
    by_index: BTreeMap<usize, Form>,
}

impl Rules {
    fn new(table: &ParameterTable, links: Vec<[Form; 10]>) -> Self {
        let mut by_index = BTreeMap::new();
        for (link, forms) in links.into_iter().enumerate() {
            for (quantity, form) in INERTIAL.into_iter().zip(forms) {
                by_index.extend(table.index(Quantity::Link(quantity), link).map(|index| (index, form)));
            }
        }
        Self { by_index }
    }

    /// A base parameter: its numeric regrouping applied to the result of the rules.
    fn form(&self, parameter: &BaseParameter) -> Form {
        let mut form = Form::new();
        for (index, coefficient) in std::iter::once((parameter.kept, 1.0)).chain(parameter.regrouped.iter().copied()) {
            let coefficient = meant(coefficient);
            let own = || Form::from([(index, Polynomial::number(1.0))]);
            let of_rules = self.by_index.get(&index).cloned().unwrap_or_else(own);
            add(&mut form, &of_rules, &Polynomial::number(coefficient));
        }
        form
    }
}

/// An integer if the coefficient is one except for rounding.
fn meant(coefficient: f64) -> f64 {
    let whole = coefficient.round();
    if (coefficient - whole).abs() < ROUNDING { whole } else { coefficient }
}

/// The kept parameter first, then the others in the order of the table.
fn expression(table: &ParameterTable, kept: usize, form: &Form) -> String {
    let others = form.iter().filter(|(index, _)| **index != kept);
    let mut text = String::new();
    for (index, factor) in form.get_key_value(&kept).into_iter().chain(others) {
        let (sign, factor) = factor.factor();
        let name = table.get(*index).name();
        let product = if factor.is_empty() { name } else { format!("{factor}*{name}") };
        match (text.is_empty(), sign) {
            (true, '-') => text += &format!("-{product}"),
            (true, _) => text += &product,
            (false, sign) => text += &format!(" {sign} {product}"),
        }
    }
    text
}

impl fmt::Display for BaseFormulas {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for BaseFormula { name, expression, .. } in &self.parameters {
            if name == expression { writeln!(f, "{name}")? } else { writeln!(f, "{name} = {expression}")? }
        }
        if !self.symbols.is_empty() {
            writeln!(f, "\nwith (lengths in m; s_ and c_ are sines and cosines)")?;
        }
        self.symbols.iter().try_for_each(|symbol| writeln!(f, "{} = {}", symbol.name, symbol.value))
    }
}
