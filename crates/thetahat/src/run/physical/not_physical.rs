//! What is found in estimates that no robot made of bodies has.

use thetahat_estimation::{
    checks::{Code, Finding, Severity},
    statistics::t_quantile,
};
use thetahat_ground::number::significant;
use thetahat_model::{
    base_parameters::{BaseParameter, BaseParameters},
    consistency::{ConsistentSet, bounds_of},
    robot::{ParameterTable, Robot, Role},
};
use thetahat_report::results::{PhysicalResult, RunResult};

/// Probability with which noise alone makes one of all conditions look broken.
const CHANCE: f64 = 0.005;
/// Deviations on each side of an interval of 95 %.
const OF_INTERVAL: f64 = 1.96;
/// Links and parameters that a message names.
const NAMED: usize = 5;

/// The findings of a run, the gravest first. `asked` is `physical = true`.
pub(in crate::run) fn not_physical(
    robot: &Robot,
    set: &ConsistentSet,
    base: &BaseParameters,
    run: &RunResult,
    physical: &PhysicalResult,
    asked: bool,
) -> Vec<Finding> {
    let table = set.parameter_table();
    let has_bound = |p: &&BaseParameter| bounds_of(set, p)[0] >= 0.0 && what_is(table, p).is_some();
    let bounded: Vec<&BaseParameter> = base.parameters().iter().filter(has_bound).collect();
    let of_parameter = |p: &&BaseParameter| negative(robot, table, p, bounded.len(), run, asked);
    let mut findings: Vec<Finding> = bounded.iter().filter_map(of_parameter).collect();
    findings.extend(outside(table, physical, more_than_noise(set.links() + bounded.len()), asked));
    findings.sort_by_key(|f| (f.severity, f.joint));
    findings
}

/// What a parameter that cannot be negative is called; none for those of links and loads.
fn what_is(table: &ParameterTable, parameter: &BaseParameter) -> Option<&'static str> {
    match table.get(parameter.kept).quantity.role() {
        Role::MotorInertia => Some("motor inertia"),
        Role::ViscousFriction | Role::CoulombFriction => Some("friction coefficient"),
        Role::Inertial | Role::Load => None,
    }
}

/// One of so many motor inertias and friction coefficients below zero: a problem where the interval that holds all of them excludes zero, else a
/// warning where its own does, else a note.
fn negative(
    robot: &Robot,
    table: &ParameterTable,
    parameter: &BaseParameter,
    bounded: usize,
    run: &RunResult,
    asked: bool,
) -> Option<Finding> {
    let standard = table.get(parameter.kept);
    let result = run.parameter(&parameter.name).filter(|p| p.estimate < 0.0)?;
    let joint_name = robot.joints.get(standard.number - 1).map(|j| j.name.clone());
    let joint = joint_name.clone().unwrap_or_else(|| standard.number.to_string());
    let what = what_is(table, parameter)?;
    let remedy = if standard.quantity.role() == Role::MotorInertia {
        inertia_remedy(asked, &standard.name(), &joint)
    } else {
        friction_remedy(asked, run, &joint)
    };
    let (name, unit, value) = (&result.name, &result.unit, result.estimate);
    let high = result.interval_95.map(|[_, high]| high);
    let (severity, noise) = match high {
        Some(high) if high >= 0.0 => (Severity::Note, "noise explains it: its 95 % interval contains zero".to_owned()),
        Some(high) if value + (high - value) * more_than_noise(bounded) / OF_INTERVAL >= 0.0 => (
            Severity::Warning,
            format!("noise may explain it: by chance about one of {bounded} such intervals lies below zero"),
        ),
        Some(_) => (Severity::Problem, "noise does not explain it".to_owned()),
        None => (Severity::Warning, "it has no interval".to_owned()),
    };
    Some(Finding {
        code: Code::NotPhysical,
        severity,
        joint: Some(standard.number),
        joint_name,
        value: high.unwrap_or(value),
        unit: unit.clone(),
        limit: Some(0.0),
        message: format!("the {what} {name} is negative, {} {unit}; {noise}", significant(value, 2)),
        remedy,
        parameters: vec![name.clone()],
        step: None,
    })
}

/// Deviations beyond which one of so many conditions is broken by more than noise (C. E. Bonferroni).
fn more_than_noise(conditions: usize) -> f64 {
    t_quantile(1.0 - CHANCE / conditions.max(1) as f64, f64::MAX).unwrap_or(f64::INFINITY)
}

/// Links and parameters that are physically impossible together.
fn outside(table: &ParameterTable, physical: &PhysicalResult, limit: f64, asked: bool) -> Option<Finding> {
    let lacking = |(name, lacking): (&String, &f64)| {
        let unit = table.index_of(name).map_or("kg m^2", |i| &*table.get(i).unit);
        format!("{name} by {} {unit}", significant(*lacking, 2))
    };
    let all: Vec<String> = physical.inconsistent.iter().zip(&physical.violations).map(lacking).collect();
    if all.is_empty() {
        return None;
    }
    let more = all.len().saturating_sub(NAMED);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    let named = all.iter().take(NAMED).cloned().collect::<Vec<_>>().join(", ");
    let deviations = physical.deviations.unwrap_or(f64::INFINITY);
    let is_noise = deviations < limit;
    let noise = if is_noise { "no more than noise explains" } else { "more than noise explains" };
    Some(Finding {
        code: Code::NotPhysical,
        severity: if is_noise { Severity::Note } else { Severity::Warning },
        joint: None,
        joint_name: None,
        value: deviations,
        unit: "standard deviations".to_owned(),
        limit: Some(limit),
        message: format!(
            "these estimates are physically impossible: they are {deviations:.1} standard deviations from a consistent set, {noise}; too small are {named}{more}"
        ),
        remedy: link_remedy(asked, is_noise).to_owned(),
        parameters: physical.inconsistent.clone(),
        step: None,
    })
}

fn link_remedy(asked: bool, is_noise: bool) -> &'static str {
    match (asked, is_noise) {
        (false, _) => {
            "set physical = true in [parameters]: the consistent parameters nearest to the estimate are added, with a \
             test whether the data reject them"
        }
        (true, true) => "take the consistent estimate where parameters are simulated or used in a controller",
        (true, false) => {
            "take the consistent estimate for simulation; look at what makes the difference: elasticity, signs, gains and \
             units of the torques, geometry"
        }
    }
}

fn inertia_remedy(asked: bool, name: &str, joint: &str) -> String {
    let physical = if asked { "" } else { "physical = true and " };
    format!(
        "give {name} from the data sheet (rotor inertia times the gear ratio squared), with {physical}fix = {{ {name} = ... }} in \
         [parameters], or record faster changes of velocity of {joint}"
    )
}

fn friction_remedy(asked: bool, run: &RunResult, joint: &str) -> String {
    if run.is_of_positions() {
        return format!(
            "check the gains of the controller, the description's masses, and the signs of positions and commands of {joint}; one factor on all \
             gains is estimated with loop_parameters = [\"drive-gain\"]"
        );
    }
    let consistent = if asked { "take the consistent estimate" } else { "set physical = true in [parameters]" };
    format!("{consistent}; look at the sign of the torque of {joint}, and record slow and fast motion of it")
}
