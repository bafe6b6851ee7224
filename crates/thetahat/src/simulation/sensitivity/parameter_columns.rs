use super::{columns::ColumnBlocks, sensitive_to::SensitiveTo};
use crate::{
    dynamics::{State, Workspace},
    regressor::Regressor,
    simulation::{closed_loop::ClosedLoop, plant::Plant},
};

/// The columns of the observation matrix for the standard parameters among what a loop is sensitive to.
pub(super) struct ParameterColumns {
    regressor: Regressor,
    /// Row, column and factor of each entry; the factor is that of a biased friction.
    places: Vec<(usize, usize, f64)>,
    phi: Vec<f64>,
    workspace: Workspace,
}

impl ParameterColumns {
    pub(super) fn new(setup: &ClosedLoop<'_>, to: &[SensitiveTo]) -> Self {
        let parameter = |(column, to): (usize, &SensitiveTo)| to.parameter().map(|index| (column, index));
        let (columns, indices): (Vec<usize>, Vec<usize>) = to.iter().enumerate().filter_map(parameter).unzip();
        let regressor = Regressor::new(setup.model, &indices);
        let factor = |index: usize| {
            let is_friction = setup.model.parameter_table().get(index).quantity.is_friction();
            if is_friction { setup.bias.friction } else { 1.0 }
        };
        let entries = regressor.entries().iter();
        let places = entries.map(|entry| (entry.joint, columns[entry.column], factor(indices[entry.column])));
        Self {
            places: places.collect(),
            phi: vec![0.0; regressor.entries().len()],
            workspace: Workspace::new(setup.model),
            regressor,
        }
    }

    /// Takes `phi_p`, the torques for a unit of each parameter, away from the columns.
    pub(super) fn subtract(&mut self, plant: &Plant<'_>, state: State<'_>, ddq: &[f64], columns: &mut ColumnBlocks) {
        self.regressor.evaluate(plant.model, state, ddq, plant.sign, &mut self.workspace, &mut self.phi);
        for (&(row, column, factor), value) in self.places.iter().zip(&self.phi) {
            columns.add(row, column, -factor * value);
        }
    }
}
