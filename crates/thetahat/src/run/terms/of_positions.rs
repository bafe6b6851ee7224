//! Laws of torque terms compared by what they change in simulated positions, where no torques are recorded: each law is added to all
//! joints at once, the loop is fitted anew by CLOE, and the error of each joint's position decides.

use super::comparison::recommend;
use crate::{
    preparation::PreparationError,
    run::{fitted_positions::FittedPositions, identification::Identification},
};
use thetahat_estimation::signal::Motion;
use thetahat_model::robot::TermDescription;
use thetahat_report::results::{JointTermComparison, ParameterResult, TermComparison, TermLaw};

/// Velocity at which a friction falls off, as a part of the largest velocity of its joint.
const FALLS_OFF_AT: f64 = 0.1;

impl Identification {
    /// Compares laws of torque terms by the simulated positions; none if the model as described does not converge.
    ///
    /// # Errors
    /// [`PreparationError`] where a recording cannot be filtered.
    pub(in crate::run) fn compare_terms_of_positions(
        &self,
        progress: &mut dyn FnMut(&str),
    ) -> Result<Option<TermComparison>, PreparationError> {
        let Some(as_described) = self.fitted_positions(progress)? else { return Ok(None) };
        let robot = self.setup().robot;
        let of_coordinates = robot.coordinate_joints();
        let names: Vec<&str> = of_coordinates.iter().map(|&joint| robot.joints[joint].name.as_str()).collect();
        let of_joints: Vec<Vec<TermDescription>> =
            names.iter().zip(self.largest_velocities()).map(|(name, velocity)| laws(name, velocity)).collect();
        let mut compared: Vec<Vec<TermLaw>> = names.iter().map(|_| Vec::new()).collect();
        for number in 0..of_joints[0].len() {
            let law: Vec<TermDescription> = of_joints.iter().map(|laws| laws[number].clone()).collect();
            let Some(other) = self.with_terms(&law) else { continue };
            let mut with_law = |line: &str| progress(&format!("with {}: {line}", law[0].kind()));
            let Some(fitted) = other.fitted_positions(&mut with_law)? else { continue };
            let added = &other.setup().robot.terms[robot.terms.len()..];
            for (coordinate, laws) in compared.iter_mut().enumerate() {
                let own = added.iter().filter(|column| column.joint == of_coordinates[coordinate]);
                let parameters = own.map(|column| column.parameter.clone()).collect();
                laws.push(as_described.compared_to(&fitted, coordinate, &law[coordinate], parameters));
            }
        }
        let left_out = as_described.run.cross_validation_relative_error_percent;
        compared.iter_mut().for_each(|laws| recommend(laws, left_out));
        let joints = names.iter().zip(compared).map(|(name, laws)| JointTermComparison {
            joint: (*name).to_owned(),
            cross_validation_relative_error_percent: left_out,
            laws,
        });
        Ok(Some(TermComparison {
            effective_samples: as_described.residual.effective.iter().sum(),
            joints: joints.collect(),
        }))
    }

    /// The largest velocity of each coordinate, rad/s or m/s.
    fn largest_velocities(&self) -> Vec<f64> {
        let largest = |c: usize| {
            let of_recording =
                |motion: &Motion| motion.dq.channel(c).iter().fold(0.0_f64, |most, dq| most.max(dq.abs()));
            self.main.iter().map(|p| of_recording(&p.filtered.motion)).fold(0.0, f64::max)
        };
        (0..self.setup().robot.coordinate_count()).map(largest).collect()
    }
}

impl FittedPositions {
    /// A law of a joint, with the change of `n log(squares) + k log(n)` of the joint's n independent samples, of which no more counts than
    /// the joint's own parameters explain.
    fn compared_to(
        &self,
        with_law: &Self,
        coordinate: usize,
        description: &TermDescription,
        parameters: Vec<String>,
    ) -> TermLaw {
        let independent = self.residual.effective[coordinate];
        let fit = independent * (with_law.residual.squares[coordinate] / self.residual.squares[coordinate]).ln();
        let found: Vec<&ParameterResult> = parameters.iter().filter_map(|name| with_law.run.parameter(name)).collect();
        // What the law of another joint does to this one is in the squares, and not in the estimates.
        let in_deviations = |p: &&ParameterResult| p.deviation().map_or(0.0, |deviation| p.estimate / deviation);
        let own = found.iter().map(in_deviations).fold(0.0_f64, |most, t| most.max(t * t));
        TermLaw {
            law: description.kind().to_owned(),
            estimates: found.iter().map(|p| p.estimate).collect(),
            cross_validation_relative_error_percent: with_law.run.cross_validation_relative_error_percent,
            criterion_change: fit.max(-own) + parameters.len() as f64 * independent.ln(),
            parameters,
            recommended: false,
            description: description.to_toml(),
        }
    }
}

/// The laws that can be added to a joint.
fn laws(joint: &str, largest_velocity: f64) -> Vec<TermDescription> {
    let joints = Some(vec![joint.to_owned()]);
    let velocity = (FALLS_OFF_AT * largest_velocity).max(f64::MIN_POSITIVE);
    vec![
        TermDescription::LoadFriction { joints: joints.clone() },
        TermDescription::ExponentialStribeck { joints: joints.clone(), velocity, exponent: 1.0, profile: false },
        TermDescription::PolynomialViscous { joints: joints.clone(), powers: vec![2] },
        TermDescription::AsymmetricViscous { joints: joints.clone() },
        TermDescription::JointSpring { joints, rest_deg: None, rest_m: None },
    ]
}
