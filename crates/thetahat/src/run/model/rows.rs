//! The rows that the model is fitted to: those of every sample of the windows, with a smooth sign of the velocity.

use crate::{
    preparation::{FilteredRecording, PreparationError, Problem, Setup},
    run::{identification::Identification, prepared::PreparedRecording},
};
use thetahat_estimation::{identification::Assembly, regression::RowLayout, signal::Decimator};
use thetahat_ground::linear_algebra::Matrix;
use thetahat_model::dynamics::{FrictionTransition, Sign};

/// X and y of all base parameters.
#[derive(Debug, Clone)]
pub(super) struct ModelRows {
    pub(super) x: Matrix,
    pub(super) y: Vec<f64>,
    pub(super) layout: RowLayout,
    /// The decimation of each recording.
    pub(super) decimators: Vec<Decimator>,
    /// The root of each row's weight, by its recording.
    pub(super) weights: Vec<f64>,
}

/// The part of a row's samples that are used from which on it counts.
const USED: f64 = 0.5;

/// Whether each row is left out because most of its samples have no known right-hand side; none if none is.
fn unused(recordings: &[&FilteredRecording], rows: &ModelRows) -> Result<Option<Vec<bool>>, PreparationError> {
    if recordings.iter().all(|r| r.unused.is_none()) {
        return Ok(None);
    }
    let shares = |(r, decimator): (&&FilteredRecording, &Decimator)| match &r.unused {
        Some(unused) => unused.shares(decimator),
        None => Ok(vec![1.0; decimator.rows() * rows.layout.joints()]),
    };
    let shares = recordings.iter().zip(&rows.decimators).map(shares).collect::<Result<_, _>>()?;
    Ok(Some(rows.layout.stack_vectors(shares).into_iter().map(|share| share < USED).collect()))
}

impl ModelRows {
    /// The rows whose Coulomb friction is `fc tanh(dq / transition)`.
    pub(super) fn new(
        setup: Setup<'_>,
        prepared: &[PreparedRecording],
        problem: &Problem,
        transition: FrictionTransition,
    ) -> Result<Self, PreparationError> {
        let signal = &setup.settings.signal;
        let recordings: Vec<&FilteredRecording> = prepared.iter().map(|p| &p.filtered).collect();
        let decimators = recordings.iter().map(|r| r.model_decimator(signal)).collect::<Result<Vec<_>, _>>()?;
        let rows: Vec<usize> = decimators.iter().map(Decimator::rows).collect();
        let layout = RowLayout::new(problem.model.coordinate_count(), &rows);
        let columns = problem.base.columns();
        let (mut matrices, mut vectors) = (Vec::new(), Vec::new());
        for (recording, decimator) in recordings.iter().zip(&decimators) {
            let assembly = Assembly::new(&problem.model, &columns, decimator.clone()).masked(recording.unused.clone());
            matrices.push(recording.observation_matrix_of(&assembly, Sign::Smooth(transition))?);
            vectors.push(assembly.measurement_vector(&recording.centred_torque())?);
        }
        let weights = layout.spread(|block| recordings[block.recording].recording.weight.sqrt());
        let (x, y) = (layout.stack_matrices(matrices), layout.stack_vectors(vectors));
        let rows = Self { x, y, layout, decimators, weights };
        match unused(&recordings, &rows)? {
            None => Ok(rows),
            Some(unused) => Ok(rows.without(&unused)),
        }
    }

    /// The same rows with another velocity of the transition: the columns of bodies stay.
    pub(super) fn with_transition(
        &self,
        identification: &Identification,
        problem: &Problem,
        transition: FrictionTransition,
    ) -> Result<Self, PreparationError> {
        let columns = problem.base.columns();
        let table = problem.model.parameter_table();
        let changing: Vec<usize> =
            (0..columns.len()).filter(|&c| !table.get(columns[c]).quantity.is_inertial()).collect();
        let indices: Vec<usize> = changing.iter().map(|&c| columns[c]).collect();
        let mut matrices = Vec::new();
        for (prepared, decimator) in identification.main.iter().zip(&self.decimators) {
            let unused = prepared.filtered.unused.clone();
            let assembly = Assembly::new(&problem.model, &indices, decimator.clone()).masked(unused);
            matrices.push(prepared.filtered.observation_matrix_of(&assembly, Sign::Smooth(transition))?);
        }
        let found = self.layout.stack_matrices(matrices);
        let found = found.scale_rows(&self.kept());
        let mut rows = self.clone();
        for (k, &column) in changing.iter().enumerate() {
            rows.x.column_mut(column).copy_from_slice(found.column(k));
        }
        Ok(rows)
    }

    /// The rows without those that are left out, which become zero.
    pub(super) fn without(&self, left_out: &[bool]) -> Self {
        let kept: Vec<f64> = left_out.iter().map(|out| if *out { 0.0 } else { 1.0 }).collect();
        let y = self.y.iter().zip(&kept).map(|(y, kept)| y * kept).collect();
        let layout = self.layout.clone().with_shares(Some(kept.clone()));
        Self { x: self.x.scale_rows(&kept), y, layout, ..self.clone() }
    }

    /// One for each row that counts, zero for each that is left out.
    pub(super) fn kept(&self) -> Vec<f64> {
        self.layout.shares_or_ones(0..self.layout.len()).into_owned()
    }

    /// Rows of one joint.
    pub(super) fn rows_of_joint(&self) -> usize {
        self.layout.len() / self.layout.joints().max(1)
    }
}
