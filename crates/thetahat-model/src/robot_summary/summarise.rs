use super::values::{
    BaseParameterSummary, JointSummary, MimicSummary, ParameterCount, ParameterCounts, RobotSummary, ShareSummary,
    StandardParameterSummary, TransmissionSummary,
};
use crate::{
    base_parameters::{BaseParameter, BaseParameters},
    dynamics::Model,
    robot::{Joint, Parameter, Placement, Robot, RobotSource, Role},
};

impl RobotSummary {
    /// The summary of a robot that was read from `source`.
    #[must_use]
    pub fn new(source: &RobotSource, robot: &Robot) -> Self {
        let model = Model::new(robot);
        let (base, problem) = match BaseParameters::of(&model, &[]) {
            Ok(base) => (Some(base), None),
            Err(error) => (None, Some(error.to_string())),
        };
        let a_priori = robot.a_priori_parameters();
        let standard = standard_parameters(&model, &a_priori, base.as_ref());
        let base_parameters = base.as_ref().map(|base| base_parameters(&model, base, &a_priori)).unwrap_or_default();
        Self {
            name: robot.name.clone(),
            source: source.path().display().to_string(),
            format: source.format(),
            gravity: robot.gravity,
            friction: robot.friction.name(),
            joints: joints(robot),
            locked: robot.locked.clone(),
            doubts: robot.doubts.clone(),
            transmission: transmission(robot),
            counts: counts(&model, &standard, base.as_ref()),
            standard_parameters: standard,
            base_parameters,
            problem,
        }
    }
}

fn joints(robot: &Robot) -> Vec<JointSummary> {
    let coordinates = robot.coordinate_joints();
    let joint = |(j, joint): (usize, &Joint)| {
        let Placement { gamma, alpha, theta, origin } = joint.placement;
        JointSummary {
            number: j + 1,
            name: joint.name.clone(),
            kind: joint.kind,
            parent: joint.parent.map(|p| p + 1),
            coordinate: coordinates.iter().position(|&c| c == j).map(|c| c + 1),
            passive: joint.passive,
            mimic: joint.mimic.map(|m| MimicSummary { joint: m.of + 1, ratio: m.ratio, offset: m.offset }),
            also_follows: joint
                .also_follows
                .iter()
                .map(|share| ShareSummary { joint: share.of + 1, ratio: share.ratio })
                .collect(),
            gamma_alpha_theta: [gamma, alpha, theta],
            origin,
            link_axes: joint.link_axes,
            lower: joint.limits.lower,
            upper: joint.limits.upper,
            velocity: joint.limits.velocity,
            effort: joint.limits.effort,
        }
    };
    robot.joints.iter().enumerate().map(joint).collect()
}

fn transmission(robot: &Robot) -> TransmissionSummary {
    let transmission = &robot.transmission;
    let n = transmission.joints();
    let row = |i: usize| (0..n).map(|j| transmission.matrix().at(i, j)).collect();
    TransmissionSummary {
        matrix: (0..n).map(row).collect(),
        offset: transmission.offset().to_vec(),
        drive_to_joint: transmission.drive_to_joint_units(),
        coupled_motors: transmission.coupled_motors().iter().map(|i| i + 1).collect(),
    }
}

fn standard_parameters(
    model: &Model,
    a_priori: &[f64],
    base: Option<&BaseParameters>,
) -> Vec<StandardParameterSummary> {
    let mut acts = vec![false; a_priori.len()];
    for parameter in base.iter().flat_map(|base| base.parameters()) {
        acts[parameter.kept] = true;
        parameter.regrouped.iter().for_each(|&(i, _)| acts[i] = true);
    }
    let summary = |(i, parameter): (usize, &Parameter)| StandardParameterSummary {
        name: parameter.name(),
        unit: parameter.unit.clone(),
        a_priori: a_priori[i],
        has_effect: base.map(|_| acts[i]),
        parameter: parameter.clone(),
    };
    model.parameter_table().iter().enumerate().map(summary).collect()
}

fn base_parameters(model: &Model, base: &BaseParameters, a_priori: &[f64]) -> Vec<BaseParameterSummary> {
    let name = |i: usize| model.parameter_table().get(i).name();
    let values = base.from_standard(a_priori);
    let summary = |(parameter, a_priori): (&BaseParameter, f64)| BaseParameterSummary {
        name: parameter.name.clone(),
        kept: name(parameter.kept),
        expression: parameter.expression.clone(),
        regrouped: parameter.regrouped.iter().map(|&(i, c)| (name(i), c)).collect(),
        unit: parameter.unit.clone(),
        a_priori,
    };
    base.parameters().iter().zip(values).map(summary).collect()
}

fn counts(model: &Model, standard: &[StandardParameterSummary], base: Option<&BaseParameters>) -> ParameterCounts {
    let table = model.parameter_table();
    let idle = standard.iter().filter(|p| p.has_effect == Some(false));
    ParameterCounts {
        standard: count(table.iter()),
        without_effect: count(idle.map(|p| &p.parameter)),
        base: count(base.iter().flat_map(|base| base.parameters()).map(|p| table.get(p.kept))),
    }
}

fn count<'p>(parameters: impl Iterator<Item = &'p Parameter>) -> ParameterCount {
    let mut count = ParameterCount::default();
    for parameter in parameters {
        if parameter.quantity.is_term() {
            count.terms += 1;
            continue;
        }
        let of_role = match parameter.quantity.role() {
            Role::Inertial => &mut count.inertial,
            Role::MotorInertia => &mut count.motor_inertia,
            Role::ViscousFriction | Role::CoulombFriction => &mut count.friction,
            Role::Load => &mut count.offset,
        };
        *of_role += 1;
    }
    count
}
