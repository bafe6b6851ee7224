use std::{
    borrow::Cow,
    collections::{BTreeMap, BTreeSet},
};

use super::{dependencies::Dependencies, error::BaseParametersError, joint_by_joint, whole};
use crate::{
    dynamics::Model,
    robot::{Parameter, ParameterTable},
};

/// A base parameter: the kept standard parameter and those regrouped into it.
#[derive(Debug, Clone, PartialEq)]
pub struct BaseParameter {
    /// Index of the kept parameter in the table.
    pub kept: usize,
    /// Index and coefficient of each regrouped parameter.
    pub regrouped: Vec<(usize, f64)>,
    /// Name: that of the kept parameter, followed by `r` if something is regrouped into it.
    pub name: String,
    /// Formula, such as `zz1 + ia1 + yy2 + 0.07*mz3`.
    pub expression: String,
    /// Unit in SI.
    pub unit: Cow<'static, str>,
}

/// The base parameters of a robot, or a part of them: `X theta = X_b theta_b`.
#[derive(Debug, Clone, PartialEq)]
pub struct BaseParameters {
    parameters: Vec<BaseParameter>,
    standard_count: usize,
    /// Index and value of the standard parameters that are given and not estimated.
    fixed: Vec<(usize, f64)>,
}

/// Number of random states of the first attempt, and of a second one if a decision is not clear.
pub(super) const STATES: [usize; 2] = [48, 192];
/// Coefficients of the formulas are exact to about 1e-12; smaller ones are rounding.
const NEGLIGIBLE: f64 = 1e-9;

impl BaseParameters {
    /// The base parameters of a model, with the standard parameters named in `excluded` set to zero.
    ///
    /// # Errors
    /// [`BaseParametersError`] for an unknown name or a rank that is not clear.
    pub fn of(model: &Model, excluded: &[String]) -> Result<Self, BaseParametersError> {
        model.check_loops().map_err(|source| BaseParametersError::Loops { source })?;
        let considered = considered(model.parameter_table(), excluded)?;
        // Loops carry torques from any joint to any other: there is no order of the joints.
        let attempts = if model.has_loops() { &[][..] } else { &STATES };
        let found = attempts.iter().find_map(|&states| joint_by_joint::dependencies(model, &considered, states));
        let dependencies = found.map_or_else(|| whole::dependencies(model, &considered), Ok)?;
        Ok(Self::from_dependencies(model.parameter_table(), &considered, &dependencies))
    }

    /// The base parameters with some standard parameters at given values, by name, SI: their torques move to the left side.
    ///
    /// # Errors
    /// As [`BaseParameters::of`].
    pub fn with_fixed(
        model: &Model,
        excluded: &[String],
        fixed: &BTreeMap<String, f64>,
    ) -> Result<Self, BaseParametersError> {
        let absent: Vec<String> = excluded.iter().chain(fixed.keys()).cloned().collect();
        let place = |(name, value): (&String, &f64)| Some((model.parameter_table().index_of(name)?, *value));
        let fixed = fixed.iter().filter_map(place).collect();
        Ok(Self { fixed, ..Self::of(model, &absent)? })
    }

    fn from_dependencies(table: &ParameterTable, considered: &[usize], dependencies: &Dependencies) -> Self {
        let Dependencies { kept, spanned, coefficients } = dependencies;
        let parameters = kept.iter().enumerate().map(|(row, &column)| {
            let of = |(k, &other): (usize, &usize)| (considered[other], coefficients.at(row, k));
            let regrouped = spanned.iter().enumerate().map(of).filter(|(_, c)| c.abs() > NEGLIGIBLE).collect();
            BaseParameter::new(table, considered[column], regrouped)
        });
        Self { parameters: parameters.collect(), standard_count: table.len(), fixed: Vec::new() }
    }

    /// The base parameters in order.
    #[must_use]
    pub fn parameters(&self) -> &[BaseParameter] {
        &self.parameters
    }

    /// Number of base parameters.
    #[must_use]
    pub fn len(&self) -> usize {
        self.parameters.len()
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.parameters.is_empty()
    }

    /// Indices in the table of the kept standard parameters: the columns of the observation matrix.
    #[must_use]
    pub fn columns(&self) -> Vec<usize> {
        self.parameters.iter().map(|p| p.kept).collect()
    }

    /// Only the parameters named, in the order of the base parameters.
    ///
    /// # Errors
    /// [`BaseParametersError::UnknownBaseParameter`], which states where a regrouped parameter went.
    pub fn select(&self, table: &ParameterTable, names: &[String]) -> Result<Self, BaseParametersError> {
        if let Some(name) = names.iter().find(|name| self.parameters.iter().all(|p| p.name != **name)) {
            return Err(self.unknown(table, name));
        }
        let parameters = self.parameters.iter().filter(|p| names.contains(&p.name)).cloned().collect();
        Ok(Self { parameters, ..self.clone() })
    }

    /// The base parameters whose kept standard parameter satisfies `is_wanted`.
    #[doc(hidden)]
    pub fn filtered(&self, is_wanted: impl Fn(usize) -> bool) -> Self {
        let parameters = self.parameters.iter().filter(|p| is_wanted(p.kept)).cloned().collect();
        Self { parameters, ..self.clone() }
    }

    /// The base parameters of a vector of standard parameters.
    #[must_use]
    pub fn from_standard(&self, theta: &[f64]) -> Vec<f64> {
        let value = |p: &BaseParameter| theta[p.kept] + p.regrouped.iter().map(|&(i, c)| c * theta[i]).sum::<f64>();
        self.parameters.iter().map(value).collect()
    }

    /// Whether a vector of standard parameters has the given values.
    #[must_use]
    pub fn agrees_with_fixed(&self, theta: &[f64]) -> bool {
        self.fixed.iter().all(|&(i, value)| theta[i] == value)
    }

    /// A vector of standard parameters with the same torques: the kept parameters, the given values, zeros elsewhere.
    #[must_use]
    pub fn to_standard(&self, base: &[f64]) -> Vec<f64> {
        let mut theta = vec![0.0; self.standard_count];
        self.fixed.iter().for_each(|&(i, value)| theta[i] = value);
        self.parameters.iter().zip(base).for_each(|(p, &v)| theta[p.kept] = v);
        theta
    }

    fn unknown(&self, table: &ParameterTable, name: &str) -> BaseParametersError {
        let home = |i: usize| {
            let inside = |p: &&BaseParameter| p.kept == i || p.regrouped.iter().any(|&(k, _)| k == i);
            self.parameters.iter().filter(inside).map(|p| p.name.clone()).collect::<Vec<_>>()
        };
        let hint = match table.index_of(name.trim_end_matches('r')).map(home).as_deref() {
            None => String::new(),
            Some([]) => " (it has no effect on any torque, or is excluded)".to_owned(),
            Some(homes) => format!(" (it is part of {})", homes.join(" and ")),
        };
        let known = self.parameters.iter().map(|p| p.name.clone()).collect();
        BaseParametersError::UnknownBaseParameter { name: name.to_owned(), hint, known }
    }
}

impl BaseParameter {
    fn new(table: &ParameterTable, kept: usize, regrouped: Vec<(usize, f64)>) -> Self {
        let parameter = table.get(kept);
        let suffix = if regrouped.is_empty() { "" } else { "r" };
        Self {
            name: format!("{}{suffix}", parameter.name()),
            expression: expression(table, parameter, &regrouped),
            unit: parameter.unit.clone(),
            kept,
            regrouped,
        }
    }
}

fn expression(table: &ParameterTable, kept: &Parameter, regrouped: &[(usize, f64)]) -> String {
    let mut text = kept.name();
    for &(index, coefficient) in regrouped {
        let sign = if coefficient < 0.0 { '-' } else { '+' };
        let factor = readable(coefficient.abs());
        let factor = if factor == "1" { String::new() } else { format!("{factor}*") };
        text.push_str(&format!(" {sign} {factor}{}", table.get(index).name()));
    }
    text
}

/// Up to nine decimals, without trailing zeros.
fn readable(value: f64) -> String {
    format!("{value:.9}").trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// The indices of the parameters that are not excluded.
pub(super) fn considered(table: &ParameterTable, excluded: &[String]) -> Result<Vec<usize>, BaseParametersError> {
    let names: Vec<String> = table.iter().map(Parameter::name).collect();
    let known: BTreeSet<&String> = names.iter().collect();
    if let Some(name) = excluded.iter().find(|name| !known.contains(name)) {
        return Err(BaseParametersError::UnknownStandardParameter { name: name.clone() });
    }
    let excluded: BTreeSet<&String> = excluded.iter().collect();
    Ok((0..names.len()).filter(|&i| !excluded.contains(&names[i])).collect())
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::{base_parameters::whole::random_observations, robot::Robot};
    use thetahat_ground::linear_algebra::norm;

    const TX40: &str = include_str!("../../../thetahat/demo/tx40.toml");

    fn tx40(excluded: &[&str]) -> (Model, BaseParameters) {
        let model = Model::new(&Robot::parse(TX40, Path::new("tx40.toml")).unwrap());
        let excluded: Vec<String> = excluded.iter().map(|s| (*s).to_owned()).collect();
        let base = BaseParameters::of(&model, &excluded).unwrap();
        (model, base)
    }

    fn names(base: &BaseParameters) -> Vec<&str> {
        base.parameters().iter().map(|p| p.name.as_str()).collect()
    }

    #[test]
    fn the_tx40_has_the_papers_sixty() {
        let (model, base) = tx40(&["iam6"]);
        assert_eq!(base.len(), 60);
        let quantities: Vec<_> = base.columns().iter().map(|&i| model.parameter_table().get(i).quantity).collect();
        // 36 of the links and 4 motor inertias, 12 frictions, 6 offsets, fvm6 and fcm6.
        assert_eq!(quantities.iter().filter(|q| q.is_inertial()).count(), 36);
        assert_eq!(quantities.iter().filter(|q| q.is_motor_inertia()).count(), 4);
        assert_eq!(quantities.iter().filter(|q| q.is_coupled_motor()).count(), 2);
        assert_eq!(tx40(&[]).1.len(), 61);
        let printed = "zz1r fc1 fv1 xx2r xz2r zz2r mx2r fc2 fv2 xx3r zz3r my3r ia3 fc3 fv3 mx4 ia4 fc4 fv4 my5r ia5 \
                       fc5 fv5 ia6 fc6 fv6 fcm6 fvm6";
        for name in printed.split_whitespace() {
            assert!(names(&base).contains(&name), "{name} of the paper's Table I");
        }
    }

    #[test]
    fn formulas_read_like_the_literature() {
        let (_, base) = tx40(&["iam6"]);
        let formula = |name: &str| base.parameters().iter().find(|p| p.name == name).unwrap().expression.clone();
        assert_eq!(
            formula("zz1r"),
            "zz1 + ia1 + yy2 + yy3 + 0.07*mz3 + 0.05185*m3 + 0.05185*m4 + 0.05185*m5 + 0.05185*m6"
        );
        assert_eq!(formula("my5r"), "my5 - mz6");
        assert_eq!(formula("ia3"), "ia3");
    }

    #[test]
    fn base_and_standard_parameters_give_the_same_torques() {
        let (model, base) = tx40(&[]);
        let all: Vec<usize> = (0..model.parameter_table().len()).collect();
        let theta: Vec<f64> = all.iter().map(|&i| (1.7 * i as f64 + 0.3).sin()).collect();
        let x = random_observations(&model, &all);
        let same = base.to_standard(&base.from_standard(&theta));
        let difference: Vec<f64> = x.times(&theta).iter().zip(x.times(&same)).map(|(a, b)| a - b).collect();
        assert!(norm(&difference) < 1e-9 * norm(&x.times(&theta)));
    }

    #[test]
    fn a_regrouped_parameter_is_named_with_its_home() {
        let (model, base) = tx40(&[]);
        let error = base.select(model.parameter_table(), &["yy2".to_owned()]).unwrap_err();
        assert!(error.to_string().contains("it is part of zz1r and xx2r"), "{error}");
    }

    #[test]
    fn an_unknown_exclusion_is_refused() {
        let (model, _) = tx40(&[]);
        let result = BaseParameters::of(&model, &["iam7".to_owned()]);
        assert!(matches!(result, Err(BaseParametersError::UnknownStandardParameter { .. })));
    }

    /// A true vector with another value of a fixed parameter does not give the true estimated ones.
    #[test]
    fn a_standard_vector_agrees_only_with_its_own_fixed_value() {
        let model = Model::new(&Robot::parse(TX40, Path::new("tx40.toml")).unwrap());
        let base = BaseParameters::with_fixed(&model, &[], &[("fv1".to_owned(), 8.0)].into()).unwrap();
        let mut theta = base.to_standard(&vec![0.0; base.parameters().len()]);
        assert!(base.agrees_with_fixed(&theta));
        theta[base.fixed[0].0] = 8.5;
        assert!(!base.agrees_with_fixed(&theta));
    }
}
