//! Rows in the order of time to the factors from which the model is chosen.

use std::ops::Range;

use super::{
    candidates::kinds,
    columns::ModelColumns,
    factors::{ModelCollector, ModelFactors, Slow, near_rest_limits},
    law_factors::ModelData,
    parts::{RowParts, memory, places},
    rows::ModelRows,
};
use crate::{
    preparation::{Problem, Setup},
    run::prepared::PreparedRecording,
};
use thetahat_estimation::signal::Decimator;
use thetahat_ground::linear_algebra::Matrix;
use thetahat_model::dynamics::FrictionTransition;

/// Rows of a joint that are taken at once: of a short recording all.
const ROWS_OF_PIECE: usize = 8192;

/// What the model is chosen from, of rows for each transition.
pub(super) fn data_of_rows(
    setup: Setup<'_>,
    prepared: &[PreparedRecording],
    problem: &Problem,
    rows: &[(FrictionTransition, ModelRows)],
) -> ModelData {
    let columns = ModelColumns::of_model(&problem.model, &problem.base, rows.len());
    let recording = |(k, p): (usize, &PreparedRecording)| {
        let weight = p.filtered.recording.weight.sqrt();
        (weight, factors_of(setup, (k, p), &columns, rows))
    };
    let recordings = prepared.iter().enumerate().map(recording).collect();
    ModelData { columns, recordings }
}

fn factors_of(
    setup: Setup<'_>,
    (number, prepared): (usize, &PreparedRecording),
    columns: &ModelColumns,
    rows: &[(FrictionTransition, ModelRows)],
) -> ModelFactors {
    let first = &rows[0].1;
    let decimator = &first.decimators[number];
    let parts = row_parts(setup, prepared, decimator);
    let near_rest = near_rest_limits(prepared.filtered.near_rest.as_ref(), columns.joints());
    let slow =
        Slow { near_rest, transitions: rows.iter().map(|(transition, _)| *transition).collect(), kinds: kinds(setup) };
    let mut collector = ModelCollector::new(columns.clone(), (parts, decimator.rows()), slow, None);
    decimator.kept().for_each(|k| collector.take_velocities(prepared.filtered.motion.dq.sample(k)));
    let of_joint = |joint: usize, piece: &Range<usize>| {
        let start = first.layout.block(joint, number).start;
        let block = start + piece.start..start + piece.end;
        let mut values = Vec::with_capacity(block.len() * columns.count(joint));
        for (transition, column) in columns.of_joint(joint) {
            values.extend_from_slice(&rows[transition].1.x.column(column)[block.clone()]);
        }
        values.extend_from_slice(&first.y[block.clone()]);
        Matrix::from_columns(block.len(), values)
    };
    let count = decimator.rows();
    for piece in (0..count).step_by(ROWS_OF_PIECE).map(|start| start..(start + ROWS_OF_PIECE).min(count)) {
        collector.take(&(0..columns.joints()).map(|joint| of_joint(joint, &piece)).collect::<Vec<_>>());
    }
    collector.finish(prepared.filtered.motion.q.means())
}

fn row_parts(setup: Setup<'_>, prepared: &PreparedRecording, decimator: &Decimator) -> RowParts {
    let (signal, rate) = (&setup.settings.signal, prepared.filtered.recording.sample_rate_hz);
    let samples: Vec<usize> = decimator.kept().collect();
    let times_s = samples.iter().map(|k| prepared.filtered.start_s() + *k as f64 / rate);
    RowParts::new(places(times_s, prepared.frequency_hz()), memory(rate, signal.cutoff_hz, signal.decimation))
}
