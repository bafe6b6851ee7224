//! The rows of every sample, from which the model is chosen: with a smooth sign of the velocity, and friction for each velocity at
//! which it changes.

use std::ops::Range;

use super::{factors::rows_of_segment, identity::Identity};
use crate::{
    preparation::SignalOptions,
    run::{InPlaceOfRows, ModelCollector, ModelColumns, ModelFactors, RowParts, Slow},
};
use thetahat_estimation::signal::{DecimatedPiece, Decimator, Joiner, Motion, SignalError};
use thetahat_ground::{linear_algebra::Matrix, series::Series};
use thetahat_model::{
    base_parameters::BaseParameters,
    dynamics::{FrictionTransition, Model, Sign},
    regressor::{BufferedRegressor, Entry, Regressor},
    robot::JointKind,
};

/// Longest period of a motion that repeats, over the recording.
const LONGEST_PERIOD: f64 = 0.875;

/// What makes the rows of a recording.
pub(super) struct ModelRows {
    columns: ModelColumns,
    decimator: Decimator,
    /// Entries of all base parameters, with the first transition.
    first: Regressor,
    /// Entries of those that change, with each further one.
    changing: Regressor,
    /// The base parameter of each column of these.
    changing_columns: Vec<usize>,
    transitions: Vec<FrictionTransition>,
    /// Whether each joint turns or slides.
    kinds: Vec<JointKind>,
}

/// The measured motion of a piece, with the torques that act around each sample.
#[derive(Clone, Copy)]
pub(super) struct MeasuredPiece<'a> {
    pub motion: &'a Motion,
    pub torque: &'a Series,
    /// The first sample of the piece.
    pub first: usize,
}

/// What one piece gives.
pub(super) struct ModelPiece {
    decimated: DecimatedPiece,
    /// Velocities at the rows.
    velocities: Series,
    /// The sum of the positions of its samples.
    positions: Vec<f64>,
}

impl ModelRows {
    /// Of a window of so many samples.
    ///
    /// # Errors
    /// [`SignalError`] for a window that is too short to decimate.
    pub(super) fn new(
        (model, base): (&Model, &BaseParameters),
        identity: &Identity,
        signal: &SignalOptions,
        samples: usize,
    ) -> Result<Self, SignalError> {
        let columns = base.columns();
        let changing: Vec<usize> = identity.changing.iter().map(|&c| columns[c]).collect();
        Ok(Self {
            columns: identity.model_columns(),
            decimator: signal.model_decimator(samples)?,
            first: Regressor::new(model, &columns),
            changing: Regressor::new(model, &changing),
            changing_columns: identity.changing.clone(),
            transitions: identity.friction_transitions(),
            kinds: model.coordinate_kinds(),
        })
    }

    /// Values of one sample: the entries of phi with the first transition, those that change with each further one, and the
    /// torques.
    pub(super) fn channels(&self) -> usize {
        self.torque() + self.columns.joints()
    }

    fn torque(&self) -> usize {
        self.first.entries().len() + (self.transitions.len() - 1) * self.changing.entries().len()
    }

    /// The piece with these rows.
    pub(super) fn piece(
        &self,
        model: &Model,
        measured: MeasuredPiece<'_>,
        rows: Range<usize>,
    ) -> Result<ModelPiece, SignalError> {
        let MeasuredPiece { motion, torque, first } = measured;
        let own = self.decimator.samples_of(&rows);
        let mut positions = vec![0.0; self.columns.joints()];
        for k in first..first + own.len() {
            positions.iter_mut().zip(motion.q.sample(k)).for_each(|(sum, q)| *sum += q);
        }
        let last_of = |row: usize| self.decimator.samples_of(&(row..row + 1)).end - 1 - own.start + first;
        let velocities = rows.clone().flat_map(|row| motion.dq.sample(last_of(row)).to_vec()).collect();
        let mut entries = self.entries(model, motion);
        let decimated = self.decimator.decimate_piece(rows, self.channels(), |k, values| {
            let k = k - own.start + first;
            let mut rest = values;
            for of_transition in &mut entries {
                let (own, after) = rest.split_at_mut(of_transition.count());
                of_transition.write(k, own);
                rest = after;
            }
            rest.copy_from_slice(torque.sample(k));
        })?;
        Ok(ModelPiece { decimated, velocities: Series::shaped(self.columns.joints(), velocities), positions })
    }

    /// The entries of each transition along a motion.
    fn entries<'a>(&'a self, model: &'a Model, motion: &'a Motion) -> Vec<BufferedRegressor<'a>> {
        let regressors = [&self.first].into_iter().chain(std::iter::repeat(&self.changing));
        let of = |(transition, regressor): (&FrictionTransition, &'a Regressor)| {
            BufferedRegressor::new(regressor, model, [&motion.q, &motion.dq, &motion.ddq], Sign::Smooth(*transition))
        };
        self.transitions.iter().zip(regressors).map(of).collect()
    }

    /// The channel of each column of each joint, and of its torque.
    fn channels_of_joints(&self) -> Vec<Vec<usize>> {
        let place = |entries: &[Entry], joint: usize, column: usize| {
            entries.iter().position(|e| e.joint == joint && e.column == column)
        };
        let further = |transition: usize| self.first.entries().len() + (transition - 1) * self.changing.entries().len();
        let channel = |joint: usize, (transition, column): (usize, usize)| {
            if transition == 0 {
                return place(self.first.entries(), joint, column);
            }
            let own = self.changing_columns.iter().position(|c| *c == column)?;
            Some(further(transition) + place(self.changing.entries(), joint, own)?)
        };
        let of_joint = |joint: usize| {
            let columns = self.columns.of_joint(joint).into_iter().filter_map(|column| channel(joint, column));
            columns.chain([self.torque() + joint]).collect()
        };
        (0..self.columns.joints()).map(of_joint).collect()
    }

    /// Takes the pieces in order, of a motion that repeats after so many rows.
    pub(super) fn taker(&self, parts: RowParts, near_rest: Vec<f64>, period: Option<f64>) -> ModelTaker<'_> {
        let rows = self.decimator.rows();
        let slow = Slow { near_rest, transitions: self.transitions.clone(), kinds: self.kinds.clone() };
        let period = period.filter(|period| *period < LONGEST_PERIOD * rows as f64);
        let in_place = Some(InPlaceOfRows { stretch: rows_of_segment(rows), period });
        ModelTaker {
            joiner: self.decimator.joiner(),
            collector: ModelCollector::new(self.columns.clone(), (parts, rows), slow, in_place),
            channels: self.channels_of_joints(),
            positions: vec![0.0; self.columns.joints()],
        }
    }
}

/// What the pieces taken so far have given.
pub(super) struct ModelTaker<'a> {
    joiner: Joiner<'a>,
    collector: ModelCollector,
    channels: Vec<Vec<usize>>,
    positions: Vec<f64>,
}

impl ModelTaker<'_> {
    pub(super) fn take(&mut self, piece: ModelPiece) {
        self.positions.iter_mut().zip(&piece.positions).for_each(|(sum, q)| *sum += q);
        (0..piece.velocities.len()).for_each(|row| self.collector.take_velocities(piece.velocities.sample(row)));
        for rows in self.joiner.take(piece.decimated) {
            let matrix =
                |channels: &Vec<usize>| Matrix::from_fn(rows.len(), channels.len(), |k, c| rows.sample(k)[channels[c]]);
            self.collector.take(&self.channels.iter().map(matrix).collect::<Vec<_>>());
        }
    }

    /// The factors of a window of so many samples.
    pub(super) fn finish(self, samples: usize) -> ModelFactors {
        self.collector.finish(self.positions.into_iter().map(|sum| sum / samples as f64).collect())
    }
}
