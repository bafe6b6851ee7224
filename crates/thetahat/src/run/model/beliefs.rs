//! What is believed of motors, friction and offsets before the recordings are fitted: their usual sizes.

use super::law_factors::{LawFactors, Stacked};
use crate::preparation::{Problem, Setup};
use thetahat_ground::linear_algebra::{Matrix, norm};
use thetahat_model::{
    consistency::{Beliefs, ConsistentSet, stated_links},
    dynamics::Model,
    robot::{Bound, Role},
};

/// Part of the belief's weight for a body that is guessed from the geometry.
const GUESSED: f64 = 0.1;
/// Part of a joint's inertia that its motor usually has.
const MOTOR_PART: f64 = 0.5;
/// Deviations by which the torques must show a motor inertia, with the a-priori bodies, that is as many times larger than usual: motors
/// of light wrists are often heavier than the links. The mean of both on a logarithmic scale is believed then.
const BEYOND_DOUBT: f64 = 10.0;
const MUCH_LARGER: f64 = 100.0;
/// Least size relative to the largest of its kind.
const LEAST: f64 = 1e-2;
/// Usual part of a joint's torque in a number of which the torques show nothing.
const USUAL_PART: f64 = 0.05;
/// How far a number of either sign may usually lie from zero, in its size.
const FREE: f64 = 3.0;
/// Part of each diagonal entry that is added to the normal equations of the sizes.
const RIDGE: f64 = 1e-6;

/// The beliefs of a robot: sizes of friction and offsets are those that fit the torques with its a-priori bodies, sizes of
/// motor inertias follow from the mass matrix where none is given, unless the torques show a larger one.
pub(super) fn beliefs(
    setup: Setup<'_>,
    problem: &Problem,
    (rows, mean_position): (&LawFactors, &[f64]),
    set: &ConsistentSet,
) -> Beliefs {
    let part = |is_stated: bool| if is_stated { 1.0 } else { GUESSED };
    Beliefs {
        sizes: sizes(setup, problem, (&rows.stacked(), mean_position), set),
        link_parts: stated_links(setup.robot).into_iter().map(part).collect(),
    }
}

/// The set in which a motor inertia that nothing states may be as far from its guess as true ones are: motors of one robot
/// are alike, and those of light wrists many times the guess, so that the geometric mean of the guess and the largest of the robot is
/// its size.
pub(super) fn with_open_motors(set: &ConsistentSet) -> ConsistentSet {
    let (table, believed) = (set.parameter_table(), set.believed());
    let is_guessed = |i: usize| table.get(i).quantity.is_motor_inertia() && set.a_priori()[i] <= 0.0;
    let largest = |i: usize| {
        let alike = (0..table.len()).filter(|k| table.get(*k).quantity.is_motor_inertia());
        alike.filter(|k| table.get(*k).unit == table.get(i).unit).map(|k| believed[k]).fold(0.0, f64::max)
    };
    let size = |i: usize| if is_guessed(i) { (believed[i].max(0.0) * largest(i)).sqrt() } else { 0.0 };
    set.clone().with_sizes_at_least(&(0..table.len()).map(size).collect::<Vec<_>>())
}

fn sizes(
    setup: Setup<'_>,
    problem: &Problem,
    (rows, mean_position): (&Stacked, &[f64]),
    set: &ConsistentSet,
) -> Vec<f64> {
    let table = set.parameter_table();
    let FittedDrives { values: fitted_values, .. } = fitted(problem, rows, set, false);
    let shown = fitted(problem, rows, set, true);
    let usual = usual(problem, rows);
    let motors = motor_inertias(setup, mean_position, set);
    let largest = |i: usize| {
        let same = |k: &usize| table.get(*k).quantity == table.get(i).quantity;
        (0..table.len()).filter(same).map(|k| fitted_values[k].abs()).fold(0.0, f64::max)
    };
    let excluded = &setup.settings.parameters.exclude;
    let size = |i: usize| {
        let parameter = table.get(i);
        if excluded.contains(&parameter.name()) {
            return 0.0;
        }
        let of_kind = fitted_values[i].abs().max(LEAST * largest(i));
        let size = if of_kind > 0.0 { of_kind } else { usual[i] };
        match parameter.quantity.role() {
            Role::Inertial => 0.0,
            Role::MotorInertia if set.a_priori()[i] > 0.0 => set.a_priori()[i],
            Role::MotorInertia => {
                let least = shown.values[i] - BEYOND_DOUBT * shown.deviations[i];
                let of_joint = motors[parameter.number - 1];
                if least > MUCH_LARGER * of_joint { (least * of_joint).sqrt() } else { of_joint }
            }
            Role::ViscousFriction | Role::CoulombFriction | Role::Load => {
                if parameter.quantity.bound() == Bound::NotNegative { size } else { FREE * size.max(usual[i]) }
            }
        }
    };
    (0..table.len()).map(size).collect()
}

/// Standard parameters that fit the torques with the a-priori bodies, with their deviations; zero where the rows show nothing of them.
struct FittedDrives {
    values: Vec<f64>,
    deviations: Vec<f64>,
}

/// Friction, offsets and, if `motors`, motor inertias.
fn fitted(problem: &Problem, rows: &Stacked, set: &ConsistentSet, motors: bool) -> FittedDrives {
    let table = set.parameter_table();
    let columns = problem.base.columns();
    let of_drive = |c: &usize| {
        let quantity = table.get(columns[*c]).quantity;
        !quantity.is_inertial() && (motors || !quantity.is_motor_inertia())
    };
    let drives: Vec<usize> = (0..columns.len()).filter(of_drive).collect();
    let bodies: Vec<f64> =
        (0..table.len()).map(|i| if table.get(i).quantity.is_inertial() { set.a_priori()[i] } else { 0.0 }).collect();
    let of_bodies = rows.x.times(&problem.base.from_standard(&bodies));
    let rest: Vec<f64> = rows.y.iter().zip(of_bodies).map(|(y, b)| y - b).collect();
    let x = rows.x.select_columns(&drives);
    let gram = x.transposed_times(&x);
    let entry = |i: usize, j: usize| match i == j {
        true if gram.at(i, i) > 0.0 => gram.at(i, i) * (1.0 + RIDGE),
        true => 1.0,
        false => gram.at(i, j),
    };
    let mut out = FittedDrives { values: vec![0.0; table.len()], deviations: vec![f64::INFINITY; table.len()] };
    let Some(factor) = Matrix::from_fn(drives.len(), drives.len(), entry).cholesky() else { return out };
    let solved = factor.solve(&x.transpose_times(&rest));
    let residual: Vec<f64> = rest.iter().zip(x.times(&solved)).map(|(y, p)| y - p).collect();
    for (c, value) in solved.into_iter().enumerate() {
        let joints = rows.joints_of(x.column(c));
        let mut unit = vec![0.0; drives.len()];
        unit[c] = 1.0;
        let place = columns[drives[c]];
        out.values[place] = value;
        out.deviations[place] = joints.rms(&residual) * factor.solve(&unit)[c].sqrt();
    }
    out
}

/// The value with which each parameter makes a usual part of its joint's torque.
fn usual(problem: &Problem, rows: &Stacked) -> Vec<f64> {
    let columns = problem.base.columns();
    let mut out = vec![1.0; problem.model.parameter_table().len()];
    for (c, &i) in columns.iter().enumerate() {
        let column = rows.x.column(c);
        let torque = rows.joints_of(column).norm(&rows.y);
        let size = norm(column);
        if size > 0.0 && torque > 0.0 {
            out[i] = USUAL_PART * torque / size;
        }
    }
    out
}

/// The joints on which a column acts.
struct JointsOfColumn<'a> {
    rows: &'a Stacked,
    joints: Vec<bool>,
}

impl Stacked {
    fn joints_of(&self, column: &[f64]) -> JointsOfColumn<'_> {
        let mut joints = vec![false; self.rows.len()];
        column.iter().zip(&self.joint_of_row).filter(|(x, _)| **x != 0.0).for_each(|(_, joint)| joints[*joint] = true);
        JointsOfColumn { rows: self, joints }
    }
}

impl JointsOfColumn<'_> {
    /// Of the values of all rows those of the joints.
    fn norm(&self, values: &[f64]) -> f64 {
        let own = values.iter().zip(&self.rows.joint_of_row).filter(|(_, joint)| self.joints[**joint]);
        norm(&own.map(|(value, _)| *value).collect::<Vec<_>>())
    }

    fn rms(&self, values: &[f64]) -> f64 {
        let count: f64 = self.rows.rows.iter().zip(&self.joints).filter(|(_, own)| **own).map(|(rows, _)| rows).sum();
        self.norm(values) / count.max(1.0).sqrt()
    }
}

/// Half of each joint's inertia at the mean position, of the a-priori bodies; by joints in the numbering of parameters.
fn motor_inertias(setup: Setup<'_>, mean_position: &[f64], set: &ConsistentSet) -> Vec<f64> {
    let robot = setup.robot;
    let mut sizes = vec![1.0; robot.link_count()];
    let Ok(inertias) = Model::new(robot).joint_inertias(set.a_priori(), mean_position) else { return sizes };
    for (joint, inertia) in robot.coordinate_joints().iter().zip(inertias).filter(|(_, inertia)| *inertia > 0.0) {
        sizes[*joint] = MOTOR_PART * inertia;
    }
    sizes
}
