//! Links that are as the robot's description has them: only the drives are estimated.

use super::{
    error::PreparationError,
    physical::validate_known,
    settings::{EstimationOptions, NamedChoice, ParameterChoice, Settings},
};
use thetahat_estimation::identification::Method;
use thetahat_model::robot::{LinkQuantity, Quantity, Robot};

impl Settings {
    /// The settings for a robot: where only the drives are estimated, its links have the values of its description, and values that
    /// are given stay. On a base that floats the default methods are those that simulate nothing.
    ///
    /// # Errors
    /// [`PreparationError::Value`] for a link without a mass in the description.
    pub fn for_robot(mut self, robot: &Robot) -> Result<Self, PreparationError> {
        if robot.base_coordinates() > 0 && self.estimation.methods == EstimationOptions::default().methods {
            self.estimation.methods = vec![Method::IDIM_LS, Method::IDIM_WLS];
        }
        if self.parameters.estimate != ParameterChoice::Named(NamedChoice::Drives) {
            return Ok(self);
        }
        if let Some(link) = link_without_mass(robot) {
            let expected = format!(
                "\"base\", since the description gives the link of joint {link} no mass, or a description that does"
            );
            return Err(PreparationError::value("[parameters] estimate", &expected, "\"drives\""));
        }
        for (name, value) in inertial_parameters(robot) {
            if !self.parameters.exclude.contains(&name) {
                self.parameters.fix.entry(name).or_insert(value);
            }
        }
        Ok(self)
    }
}

/// Whether the drives of a robot can be estimated alone: its description gives physical links.
pub(crate) fn describes_links(robot: &Robot) -> bool {
    let fix = inertial_parameters(robot).into_iter().collect();
    link_without_mass(robot).is_none() && validate_known(robot, &fix, &[]).is_ok()
}

/// The name of the first joint whose link has no mass in the description.
fn link_without_mass(robot: &Robot) -> Option<&str> {
    let (table, values) = (robot.parameter_table(), robot.a_priori_parameters());
    let is_massless = |j: &usize| table.value(&values, Quantity::Link(LinkQuantity::M), *j) <= 0.0;
    let with_link = robot.base_coordinates().saturating_sub(1)..robot.joints.len();
    with_link.into_iter().find(is_massless).map(|j| robot.joints[j].name.as_str())
}

/// Names and described values of all inertial parameters of links.
fn inertial_parameters(robot: &Robot) -> Vec<(String, f64)> {
    let values = robot.a_priori_parameters();
    let of_links = |quantity: Quantity| matches!(quantity, Quantity::Link(_));
    let table = robot.parameter_table();
    let all = table.iter().zip(values).filter(|(p, _)| of_links(p.quantity));
    all.map(|(p, value)| (p.name(), value)).collect()
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    fn settings_for(a_priori: &str) -> Result<Settings, PreparationError> {
        let text = format!("name = 'r'\n[[joint]]\nname = 'a'\nkind = 'revolute'\n[parameters]\n{a_priori}\n");
        let robot = Robot::parse(&text, Path::new("r.toml")).unwrap();
        let mut settings = Settings::new(20.0, 10);
        settings.parameters.estimate = ParameterChoice::Named(NamedChoice::Drives);
        settings.parameters.fix = [("zz1".to_owned(), 0.3)].into();
        settings.for_robot(&robot)
    }

    #[test]
    fn links_are_fixed_as_described_and_drives_are_not() {
        let fix = settings_for("m1 = 2\nxx1 = 0.1\nzz1 = 0.2\nia1 = 0.01\nfv1 = 1").unwrap().parameters.fix;
        assert_eq!((fix.len(), fix["m1"], fix["xx1"], fix["zz1"], fix["mx1"]), (10, 2.0, 0.1, 0.3, 0.0));
    }

    #[test]
    fn physical_links_alone_are_taken_as_described() {
        let text = "name = 'r'\n[[joint]]\nname = 'a'\nkind = 'revolute'\n[parameters]\nm1 = 2\nxx1 = 0.1\nyy1 = 0.1\nzz1 = 0.1";
        let described = Robot::parse(text, Path::new("r.toml")).unwrap();
        let with = |name: &str, value: f64| {
            let mut robot = described.clone();
            robot.a_priori.insert(name.to_owned(), value);
            robot
        };
        assert!(describes_links(&described));
        // No body has one moment of inertia above the sum of the others, and none has inertia without mass.
        assert!(!describes_links(&with("xx1", 0.3)) && !describes_links(&with("m1", 0.0)));
    }

    #[test]
    fn a_link_without_mass_is_named() {
        let error = settings_for("zz1 = 0.2").unwrap_err().to_string();
        assert!(error.contains("the link of joint a no mass") && error.contains("\"drives\""), "{error}");
    }
}
