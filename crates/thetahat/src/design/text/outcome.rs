//! The results of a design, as plain data.

use crate::design::{
    error::DesignError,
    limits::verified::Verified,
    prediction::expected::{Expected, predicted_method},
    run::{FeasibleMotion, Forecast},
    text::{description::Design, experiment_text::experiment_text, options::UncertaintyOptions},
};
use thetahat_model::{
    base_parameters::{BaseParameter, BaseParameters},
    dynamics::Model,
};
use thetahat_report::results::{
    DesignResults, JointResult, PredictedGain, PredictedParameter, PredictedPayload, SearchResult,
};

/// A sum below this part of its terms is rounding; a value below that part of its predicted half width comes from rounded frames of the
/// description.
const ROUNDING: f64 = 1e-12;
const ROUNDING_OF_FRAMES: f64 = 1e-9;

impl Design {
    /// The a-priori values of the expected parameters; zero if a value is rounding.
    pub(in crate::design) fn a_priori_of(&self, base: &BaseParameters, expected: &Expected) -> Vec<f64> {
        let all = without_rounding(base, &self.robot.a_priori_parameters());
        let place = |parameter: &BaseParameter| base.parameters().iter().position(|p| p.name == parameter.name);
        let value = |(parameter, half): (&BaseParameter, &f64)| {
            place(parameter).map(|i| all[i]).filter(|value| value.abs() > ROUNDING_OF_FRAMES * half).unwrap_or(0.0)
        };
        expected.parameters.iter().zip(&expected.half_width_95).map(value).collect()
    }

    pub(in crate::design) fn results(
        &self,
        model: &Model,
        base: &BaseParameters,
        chosen: FeasibleMotion,
        forecast: Forecast,
    ) -> Result<DesignResults, DesignError> {
        let predicted = self.predicted(model, base, &forecast);
        let FeasibleMotion { motion, points, torque, verified, starts, moves, repeated, stopped_after } = chosen;
        let Verified { uses, collision, executed } = verified;
        if let Some(file) = self.compared_file().filter(|_| predicted.iter().all(|p| p.compared.is_none())) {
            return Err(DesignError::NothingToCompare { path: self.path.clone(), file });
        }
        let [q, dq, ddq, _] = motion;
        let (skeleton, spectrum) = (self.skeleton(model, &q, collision.as_ref()), self.spectrum(&ddq));
        let UncertaintyOptions { draws, percent, friction_percent, motor_inertia_percent, .. } = self.file.uncertainty;
        Ok(DesignResults {
            title: self.file.title.clone(),
            robot: self.robot.name.clone(),
            joints: JointResult::of_coordinates(&self.robot),
            sample_rate_hz: self.file.sample_rate_hz,
            q,
            dq,
            ddq,
            torque,
            points,
            executed,
            assumed_overshoot: self.assumed_overshoot(),
            sweeps: moves.as_ref().map_or(0, |moves| moves.moves().len() - self.file.motion.moves()),
            moves,
            skeleton,
            spectrum,
            collision,
            repeated,
            stopped_after,
            payload: self.predicted_payload(forecast.gains),
            assumed_percent: [friction_percent, motor_inertia_percent],
            uncertainty: (draws > 0).then_some((draws, percent)),
            compared: forecast.compared.map(|c| [c.title, c.method]),
            criterion: self.file.wanted.criterion.name().to_owned(),
            starts: starts
                .iter()
                .map(|s| SearchResult { first: s.first_value, found: s.value, steps: s.steps })
                .collect(),
            limits: uses,
            rated: self.rated(),
            without_friction: self.joint_names(self.joints_without_friction()),
            without_motor_inertia: self.joint_names(self.joints_without_motor_inertia()),
            predicted,
            method: predicted_method(&self.settings).name().to_owned(),
            rows: forecast.expected.rows,
            knows_earlier: forecast.knows_earlier,
            wanted_torques: forecast.torques,
            is_closed_loop: self.settings.controller.is_some(),
            half_width_percent: self.file.wanted.half_width_percent,
            experiment: experiment_text(self, model)?,
        })
    }

    fn joint_names(&self, joints: Vec<usize>) -> Vec<String> {
        joints.into_iter().map(|joint| self.robot.joints[joint].name.clone()).collect()
    }

    /// The prediction for each parameter.
    fn predicted(&self, model: &Model, base: &BaseParameters, forecast: &Forecast) -> Vec<PredictedParameter> {
        let Forecast { expected, remedies, compared, .. } = forecast;
        let values = self.a_priori_of(base, expected);
        let coordinates = self.robot.coordinate_joints();
        let predicted = expected.parameters.iter().enumerate().map(|(i, parameter)| {
            let a_priori = values[i];
            let half = expected.half_width_95[i];
            let joint = model.parameter_table().get(parameter.kept).number;
            PredictedParameter {
                name: parameter.name.clone(),
                unit: parameter.unit.to_string(),
                expression: parameter.expression.clone(),
                joint,
                coordinate: coordinates.iter().position(|&of_coordinate| of_coordinate + 1 == joint),
                a_priori,
                standard_deviation: expected.standard_deviation[i],
                half_width_95: half,
                compared: compared.iter().flat_map(|c| &c.parameters).find(|p| p.name == parameter.name).cloned(),
                narrower_by_own_motion: remedies[i],
                seconds: forecast.seconds[i],
            }
        });
        predicted.collect()
    }

    fn predicted_payload(&self, gains: Vec<PredictedGain>) -> Option<PredictedPayload> {
        let payload = self.payload()?;
        Some(PredictedPayload { name: payload.name.clone(), mass_kg: payload.mass_kg?, gains })
    }
}

/// The base parameters of standard ones; zero if the sum is rounding.
fn without_rounding(base: &BaseParameters, standard: &[f64]) -> Vec<f64> {
    let value = |(parameter, value): (&BaseParameter, f64)| {
        let terms = parameter.regrouped.iter().map(|&(i, factor)| (factor * standard[i]).abs());
        let size = standard[parameter.kept].abs() + terms.sum::<f64>();
        if value.abs() <= ROUNDING * size { 0.0 } else { value }
    };
    base.parameters().iter().zip(base.from_standard(standard)).map(value).collect()
}
