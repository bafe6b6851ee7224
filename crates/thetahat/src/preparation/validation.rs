//! What settings must hold before anything is read or run.

use std::collections::BTreeSet;

use super::{
    error::PreparationError,
    physical::{PriorWeight, validate_known},
    settings::{
        Case, Mask, ModelOptions, ParameterChoice, ParameterSelection, PositionFilter, Settings, SignalOptions,
        StatedMask,
    },
};
use thetahat_estimation::{
    control::ControllerDescription,
    identification::{DesignMatrix, Method, Needs, Response, Weighting},
    simulation::Solver,
};
use thetahat_model::{base_parameters::BaseParametersError, robot::Robot};

/// Highest order of the position filter: beyond it, its transients are longer than what it is to keep.
const HIGHEST_ORDER: usize = 20;
/// Longest time by which a mask is widened, s.
const LONGEST_WIDENING_S: f64 = 10.0;

type Checked = Result<(), PreparationError>;

impl Settings {
    /// Refuses values that cannot be used for a robot.
    ///
    /// # Errors
    /// [`PreparationError`], which names the key.
    pub fn validate(&self, robot: &Robot) -> Checked {
        robot.check_sound()?;
        self.validate_signal()?;
        self.validate_parameters()?;
        self.validate_excluded(robot)?;
        self.validate_physical(robot)?;
        self.validate_fixed(robot)?;
        self.validate_methods()?;
        self.validate_terms(robot)?;
        self.validate_floating(robot)?;
        self.validate_weighting()?;
        self.validate_convergence()?;
        if let Some(controller) = &self.controller {
            controller.validate(robot.coordinate_count())?;
            self.validate_own_law(controller)?;
            self.validate_open_loop(controller)?;
        }
        self.validate_payloads(robot)?;
        self.validate_model(robot)?;
        self.validate_simulation()
    }

    /// Of a user's own law there are neither gains to estimate nor derivatives of a memory.
    fn validate_own_law(&self, controller: &ControllerDescription) -> Checked {
        let Some(law) = controller.own_law() else { return Ok(()) };
        if let Some(gain) = self.estimation.loop_parameters.iter().find(|p| p.is_gain()) {
            let expected = "no position or velocity gain with a control law of your own";
            return Err(PreparationError::value("[estimation] loop_parameters", expected, gain.name()));
        }
        let with_sensitivities = |m: &Method| m.needs() == Needs::Sensitivities && law.memory() > 0;
        match self.all_methods().into_iter().find(with_sensitivities) {
            Some(method) => {
                let expected = "no method that needs sensitivities, which a control law with a memory does not have";
                Err(PreparationError::value("[estimation] methods", expected, method))
            }
            None => Ok(()),
        }
    }

    /// Recorded drive signals are no response that is compared, and positions that drift make no instruments.
    fn validate_open_loop(&self, controller: &ControllerDescription) -> Checked {
        if !controller.is_open_loop() {
            return Ok(());
        }
        if let Some(gain) = self.estimation.loop_parameters.iter().find(|p| p.is_gain()) {
            let expected = "no position or velocity gain with law = \"open-loop\"";
            return Err(PreparationError::value("[estimation] loop_parameters", expected, gain.name()));
        }
        let is_usable = |m: &Method| m.needs() == Needs::Measurement || m.response() == Response::Position;
        match self.all_methods().into_iter().find(|m| !is_usable(m)) {
            Some(method) => {
                let expected = "idim-ls, idim-wls or cloe with law = \"open-loop\"";
                Err(PreparationError::value("[estimation] methods", expected, method))
            }
            None => Ok(()),
        }
    }

    fn validate_model(&self, robot: &Robot) -> Checked {
        let ModelOptions { belief_weight, friction_transition, friction_transition_sliding, ref estimated } =
            self.model;
        if let Some(size) = estimated.iter().find(|size| !size.is_of(robot)) {
            return Err(PreparationError::value("[model] estimated", "numbers of joints that move", size));
        }
        let stated = [
            ("[model] belief_weight", belief_weight),
            ("[model] friction_transition", friction_transition),
            ("[model] friction_transition_sliding", friction_transition_sliding),
        ];
        let check =
            |(key, value): (&str, Option<f64>)| value.map_or(Ok(()), |v| PreparationError::require_positive(key, v));
        stated.into_iter().try_for_each(check)?;
        match (friction_transition, friction_transition_sliding) {
            (None, Some(sliding)) => {
                let expected = "stated with friction_transition, that of joints that turn";
                Err(PreparationError::value(
                    "[model] friction_transition_sliding",
                    expected,
                    format!("{sliding} alone"),
                ))
            }
            (None | Some(_), None) | (Some(_), Some(_)) => Ok(()),
        }
    }

    fn validate_payloads(&self, robot: &Robot) -> Checked {
        let mut names = BTreeSet::new();
        for payload in &self.payloads {
            let (key, expected) = ("[[payload]] name", "a name of its own for each payload");
            PreparationError::require(names.insert(&payload.name), key, expected, &payload.name)?;
            payload.validate(robot)?;
        }
        Ok(())
    }

    fn validate_signal(&self) -> Checked {
        let signal = &self.signal;
        let orders = 1..=HIGHEST_ORDER;
        let (key, expected) = ("[signal] filter_order", format!("from 1 to {HIGHEST_ORDER}"));
        PreparationError::require(orders.contains(&signal.filter_order), key, &expected, signal.filter_order)?;
        self.validate_position_filter()?;
        PreparationError::require(signal.decimation > 0, "[signal] decimation", "at least 1", signal.decimation)?;
        if let Mask::Stated(StatedMask { velocity, widened_s }) = signal.mask {
            PreparationError::require_positive("[signal] mask.velocity", velocity)?;
            let (key, expected) = ("[signal] mask.widened_s", "from 0 to 10 s");
            PreparationError::require((0.0..=LONGEST_WIDENING_S).contains(&widened_s), key, expected, widened_s)?;
        }
        validate_window("[signal]", [signal.window_start_s, signal.window_end_s])
    }

    fn validate_position_filter(&self) -> Checked {
        let SignalOptions { position, filter_order, cutoff_hz, .. } = self.signal;
        match position {
            PositionFilter::Butterworth => {
                let expected = "a finite number above zero, or position = \"smoother\", which finds its own";
                let is_positive = cutoff_hz > 0.0 && cutoff_hz.is_finite();
                let found = if cutoff_hz == 0.0 { "0 or missing".to_owned() } else { cutoff_hz.to_string() };
                PreparationError::require(is_positive, "[signal] cutoff_hz", expected, found)
            }
            PositionFilter::Smoother => {
                let expected = "3, 4 or 5 with position = \"smoother\"";
                let is_known = (3..=5).contains(&filter_order);
                PreparationError::require(is_known, "[signal] filter_order", expected, filter_order)?;
                let expected = "none with position = \"smoother\", which finds its own";
                PreparationError::require(cutoff_hz == 0.0, "[signal] cutoff_hz", expected, cutoff_hz)
            }
        }
    }

    /// Refuses the smoother where there is no whole recording to find its cut-off from.
    pub(crate) fn require_stated_cutoff(&self, why: &str) -> Checked {
        let expected = format!("\"butterworth\" with a cutoff_hz: the smoother takes a whole recording, and {why}");
        let is_stated = self.signal.position == PositionFilter::Butterworth;
        PreparationError::require(is_stated, "[signal] position", &expected, "\"smoother\"")
    }

    /// Fixed parameters are taken off torques: what compares simulated torques with whole ones cannot have any.
    fn validate_fixed(&self, robot: &Robot) -> Checked {
        let ParameterSelection { fix, exclude, .. } = &self.parameters;
        if fix.is_empty() {
            return Ok(());
        }
        if let Some(name) = fix.keys().find(|name| exclude.contains(name)) {
            return Err(PreparationError::value("[parameters] fix", "parameters that are not excluded", name));
        }
        let compares_torques = |m: &Method| m.needs() == Needs::Sensitivities && m.response() == Response::Torque;
        if let Some(method) = self.all_methods().into_iter().find(compares_torques) {
            let expected = "idim-ls, idim-wls, idim-iv, didim or cloe where [parameters] fix gives values";
            return Err(PreparationError::value("methods", expected, method));
        }
        validate_known(robot, fix, &[])
    }

    fn validate_physical(&self, robot: &Robot) -> Checked {
        let ParameterSelection { physical, fix, known, prior, estimate, .. } = &self.parameters;
        if !physical {
            let why = "known values hold for the physically consistent estimates, which it asks for; fix holds for all";
            let missing = PreparationError::Missing { missing: "[parameters] physical = true", why };
            return if known.is_empty() { Ok(()) } else { Err(missing) };
        }
        let expected = "\"base\" where physical = true: a robot's parameters are consistent only all together";
        PreparationError::require(estimate.takes_all(), "[parameters] estimate", expected, "a part of them")?;
        if let PriorWeight::Number(weight) = prior.weight {
            PreparationError::require_positive("[parameters] prior.weight", weight)?;
        }
        validate_known(robot, fix, known)
    }

    fn validate_parameters(&self) -> Checked {
        let parameters = &self.parameters;
        if matches!(&parameters.estimate, ParameterChoice::List(names) if names.is_empty()) {
            return Err(PreparationError::value("[parameters] estimate", "at least one parameter", "an empty list"));
        }
        let rule = parameters.elimination;
        let limit = rule.relative_standard_deviation_percent;
        PreparationError::require_positive("[parameters] elimination.relative_standard_deviation_percent", limit)?;
        let level = rule.significance;
        let key = "[parameters] elimination.significance";
        PreparationError::require((0.0..1.0).contains(&level) && level > 0.0, key, "between 0 and 1", level)
    }

    /// The names of excluded parameters are those of the robot's table.
    fn validate_excluded(&self, robot: &Robot) -> Checked {
        let table = robot.parameter_table();
        match self.parameters.exclude.iter().find(|name| table.index_of(name).is_none()) {
            None => Ok(()),
            Some(name) => Err(BaseParametersError::UnknownStandardParameter { name: name.clone() }.into()),
        }
    }

    fn validate_methods(&self) -> Checked {
        let mut names = BTreeSet::new();
        for case in self.all_cases() {
            if !names.insert(case.name.clone()) {
                return Err(PreparationError::value("[[case]] name", "a name of its own for each case", case.name));
            }
            if !case.simulator.is_valid() {
                let key = format!("[[case]] {}: simulator", case.name);
                let expected = "factors above zero and a delay not below zero";
                return Err(PreparationError::value(&key, expected, "out of range"));
            }
            if let Some(scale) = case.sign_velocity_scale {
                PreparationError::require_positive(&format!("[[case]] {}: sign_velocity_scale", case.name), scale)?;
            }
            self.validate_method_list(case.methods.as_ref().unwrap_or(&self.estimation.methods))?;
        }
        Ok(())
    }

    /// Simulations have no terms of accelerations.
    fn validate_terms(&self, robot: &Robot) -> Checked {
        let methods = |case: Case| case.methods.unwrap_or_else(|| self.estimation.methods.clone());
        let Some(term) = robot.term_of_acceleration() else { return Ok(()) };
        let simulates = |method: &Method| method.needs() != Needs::Measurement;
        match self.all_cases().into_iter().flat_map(methods).find(simulates) {
            None => Ok(()),
            Some(method) => {
                let expected = format!(
                    "idim-ls or idim-wls: the torque term of {term} depends on ddq, which {method} does not simulate"
                );
                Err(PreparationError::value("methods", &expected, method))
            }
        }
    }

    /// A loop of joints alone does not move a base that floats: nothing simulates what touches it.
    fn validate_floating(&self, robot: &Robot) -> Checked {
        if robot.base_coordinates() == 0 {
            return Ok(());
        }
        match self.all_methods().into_iter().find(|method| method.needs() != Needs::Measurement) {
            None => Ok(()),
            Some(method) => {
                let expected = format!(
                    "idim-ls or idim-wls for a robot on a base that floats: {method} simulates a closed loop, and none moves the base"
                );
                Err(PreparationError::value("[estimation] methods", &expected, method))
            }
        }
    }

    /// The weights of joints are those of their torques.
    fn validate_weighting(&self) -> Checked {
        let of_positions = |(method, weighting): &(&Method, &Weighting)| {
            method.response() == Response::Position && **weighting != Weighting::None
        };
        match self.estimation.weighting.iter().find(of_positions) {
            None => Ok(()),
            Some((method, weighting)) => {
                let key = format!("[estimation] weighting.{method}");
                let expected = "\"none\": the weights of joints are those of torques, and it fits positions";
                Err(PreparationError::value(&key, expected, weighting.name()))
            }
        }
    }

    fn validate_method_list(&self, methods: &[Method]) -> Checked {
        if methods.is_empty() {
            return Err(PreparationError::value("methods", "at least one method", "an empty list"));
        }
        if let Some(i) = (1..methods.len()).find(|&i| methods[..i].contains(&methods[i])) {
            let found = format!("a list with {} twice", methods[i]);
            return Err(PreparationError::value("methods", "each method once", found));
        }
        let simulates = |method: &Method| match method.needs() {
            Needs::Measurement => false,
            Needs::Instruments | Needs::Sensitivities => true,
        };
        let needs_stated = |m: &Method| simulates(m) && m.design() == DesignMatrix::Simulated;
        if methods.iter().any(needs_stated) && self.controller.is_none() {
            let why = "didim, clie and cloe fit the simulated closed loop; describe it, or set [estimation] methods = \
                       [\"idim-ls\", \"idim-iv\"]";
            return Err(PreparationError::Missing { missing: "[controller]", why });
        }
        Ok(())
    }

    fn validate_convergence(&self) -> Checked {
        let convergence = self.estimation.convergence;
        PreparationError::require_positive("[estimation] convergence.parameter_change", convergence.parameter_change)?;
        PreparationError::require_positive("[estimation] convergence.error_change", convergence.error_change)?;
        let (key, iterations) = ("[estimation] convergence.iterations", convergence.iterations);
        PreparationError::require(iterations > 0, key, "at least 1", iterations)
    }

    fn validate_simulation(&self) -> Checked {
        let simulation = &self.simulation;
        let positive = PreparationError::require_positive;
        positive("[simulation] sign_velocity_scale", simulation.sign_velocity_scale)?;
        match simulation.solver {
            Solver::Automatic { relative_tolerance, absolute_tolerance } => {
                positive("[simulation] solver.automatic.relative_tolerance", relative_tolerance)?;
                positive("[simulation] solver.automatic.absolute_tolerance", absolute_tolerance)
            }
            Solver::Implicit { relative_tolerance, absolute_tolerance } => {
                positive("[simulation] solver.implicit.relative_tolerance", relative_tolerance)?;
                positive("[simulation] solver.implicit.absolute_tolerance", absolute_tolerance)
            }
            Solver::Adaptive { relative_tolerance, absolute_tolerance } => {
                positive("[simulation] solver.adaptive.relative_tolerance", relative_tolerance)?;
                positive("[simulation] solver.adaptive.absolute_tolerance", absolute_tolerance)
            }
            Solver::Fixed { step_s } => positive("[simulation] solver.fixed.step_s", step_s),
        }
    }
}

/// Refuses a window that ends before it starts; `table` is its place in an experiment file.
///
/// # Errors
/// [`PreparationError::Value`].
pub(crate) fn validate_window(table: &str, [start, end]: [Option<f64>; 2]) -> Checked {
    let start = start.unwrap_or(0.0);
    let key = format!("{table} window_start_s");
    PreparationError::require(start >= 0.0 && start.is_finite(), &key, "zero or later", start)?;
    let end = end.unwrap_or(f64::MAX);
    let key = format!("{table} window_end_s");
    PreparationError::require(end > start && end.is_finite(), &key, "later than window_start_s", end)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    const ARM: &str = "name = 'arm'\n[[joint]]\nname = 'a'\nkind = 'revolute'";

    fn validated(name: &str) -> Checked {
        let mut settings = Settings::new(20.0, 10);
        settings.parameters.exclude = vec![name.to_owned()];
        settings.validate(&Robot::parse(ARM, Path::new("arm.toml")).unwrap())
    }

    /// What a value of `position` with an order and a cut-off is refused for; none if it is not.
    fn refused(position: PositionFilter, filter_order: usize, cutoff_hz: f64) -> Option<String> {
        let mut settings = Settings::new(cutoff_hz, 10);
        (settings.signal.position, settings.signal.filter_order) = (position, filter_order);
        settings.validate_position_filter().err().map(|error| error.to_string())
    }

    #[test]
    fn a_filter_has_a_cut_off_and_a_smoother_has_none() {
        assert_eq!(refused(PositionFilter::Butterworth, 2, 20.0), None);
        assert_eq!(refused(PositionFilter::Smoother, 4, 0.0), None);
        let missing = refused(PositionFilter::Butterworth, 4, 0.0).unwrap();
        assert!(missing.contains("[signal] cutoff_hz"), "{missing}");
        let stated = refused(PositionFilter::Smoother, 4, 20.0).unwrap();
        assert!(stated.contains("[signal] cutoff_hz") && stated.contains("finds its own"), "{stated}");
        let order = refused(PositionFilter::Smoother, 2, 0.0).unwrap();
        assert!(order.contains("[signal] filter_order") && order.contains("3, 4 or 5"), "{order}");
    }

    #[test]
    fn what_reads_in_pieces_refuses_the_smoother() {
        let mut settings = Settings::new(0.0, 10);
        settings.signal.position = PositionFilter::Smoother;
        assert!(settings.require_stated_cutoff("a reduction reads in pieces").is_err());
        assert!(Settings::new(20.0, 10).require_stated_cutoff("a reduction reads in pieces").is_ok());
    }

    #[test]
    fn a_parameter_of_the_robot_is_excluded() {
        assert!(validated("ia1").is_ok());
    }

    #[test]
    fn an_unknown_name_in_exclude_is_refused_before_anything_is_read() {
        let error = validated("ia9").unwrap_err();
        let PreparationError::Parameters { source: BaseParametersError::UnknownStandardParameter { name } } = &error
        else {
            panic!("{error}")
        };
        assert_eq!(name, "ia9");
    }
}
