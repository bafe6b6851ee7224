//! Curves for the report: what the figures show of a run and of the robot, as plain data.

pub(in crate::run) mod residual;

use super::prepared::{PreparedRecording, times};
use crate::preparation::Problem;
use thetahat_estimation::simulation::SimulatedMotion;
use thetahat_ground::series::Series;
use thetahat_model::{base_parameters::BaseParameters, dynamics::Model, robot::Robot};
use thetahat_report::results::{Frame, HeldBackPlots, Plots, RecordStart, RunPlots, Skeleton};

/// Most points of the tool's way.
const WAY: usize = 400;

/// The curves that all runs share.
pub(super) fn shared(robot: &Robot, prepared: &[PreparedRecording], problem: &Problem) -> Plots {
    let positions: Vec<&Series> = prepared.iter().map(|p| &p.filtered.motion.q).collect();
    let regression = &problem.regression;
    Plots {
        time_s: times(prepared, problem),
        measured: regression.layout.by_joint(&regression.y),
        position: problem.at_rows(&positions),
        recordings: starts(prepared, problem),
        held_back: HeldBackPlots::default(),
        skeleton: skeleton(robot, &problem.model, &positions),
    }
}

/// The curves of a prediction, and of simulated motions where there are any.
pub(super) fn of_prediction(problem: &Problem, prediction: &[f64], simulated: &[SimulatedMotion]) -> RunPlots {
    let positions: Vec<&Series> = simulated.iter().map(|m| &m.q).collect();
    RunPlots {
        predicted: problem.regression.layout.by_joint(prediction),
        simulated_position: if positions.is_empty() { Vec::new() } else { problem.at_rows(&positions) },
        ..RunPlots::default()
    }
}

/// The curves that all runs share of the recordings held back.
pub(super) fn held_back(validation: &[PreparedRecording], problem: &Problem) -> HeldBackPlots {
    let regression = &problem.regression;
    HeldBackPlots {
        time_s: times(validation, problem),
        measured: regression.layout.by_joint(&regression.y),
        recordings: starts(validation, problem),
    }
}

/// The first row of each recording.
fn starts(prepared: &[PreparedRecording], problem: &Problem) -> Vec<RecordStart> {
    let mut row = 0;
    let start = |(p, rows): (&PreparedRecording, usize)| {
        let start = RecordStart { name: p.filtered.recording.name.clone(), row };
        row += rows;
        start
    };
    prepared.iter().zip(problem.decimators.iter().map(|d| d.rows())).map(start).collect()
}

/// The frames of a robot at the mean of its motion, and the way of the last one.
fn skeleton(robot: &Robot, model: &Model, positions: &[&Series]) -> Option<Skeleton> {
    let samples: usize = positions.iter().map(|q| q.len()).sum();
    let mean = |c: usize| positions.iter().flat_map(|q| q.channel(c)).sum::<f64>() / samples.max(1) as f64;
    let mean: Vec<f64> = (0..model.coordinate_count()).map(mean).collect();
    skeleton_in(robot, model, &mean, positions)
}

/// The frames of a robot in a posture, and the way of the last one along positions.
pub(crate) fn skeleton_in(robot: &Robot, model: &Model, posture: &[f64], positions: &[&Series]) -> Option<Skeleton> {
    let samples: usize = positions.iter().map(|q| q.len()).sum();
    let last = model.link_count().checked_sub(1)?;
    let frame = |j: usize| {
        let (origin, axis) = model.frame(j, posture);
        Frame { parent: model.carrier(j), origin, axis }
    };
    let step = samples.div_ceil(WAY).max(1);
    let visited = positions.iter().flat_map(|q| (0..q.len()).step_by(step).map(|k| q.sample(k)));
    Some(Skeleton {
        frames: (0..=last).map(frame).collect(),
        tool_path: visited.map(|q| model.frame(last, q).0).collect(),
        gravity: robot.gravity,
    })
}

/// The number of the link, joint or motor that each parameter is of, from one.
pub(super) fn numbers(model: &Model, estimated: &BaseParameters) -> Vec<usize> {
    estimated.parameters().iter().map(|p| model.parameter_table().get(p.kept).number).collect()
}

/// The a-priori value of each parameter; none if one of those that it is made of is not known a priori.
pub(super) fn a_priori(robot: &Robot, model: &Model, estimated: &BaseParameters) -> Vec<Option<f64>> {
    let table = model.parameter_table();
    let values = estimated.from_standard(&robot.a_priori_parameters_for(table));
    let is_known = |i: usize| robot.a_priori.contains_key(&table.get(i).name());
    let known = estimated.parameters().iter().map(|p| is_known(p.kept) && p.regrouped.iter().all(|r| is_known(r.0)));
    known.zip(values).map(|(known, value)| known.then_some(value)).collect()
}
