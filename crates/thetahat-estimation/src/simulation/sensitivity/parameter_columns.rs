use super::{columns::ColumnBlocks, sensitive_to::SensitiveTo};
use crate::simulation::{closed_loop::ClosedLoop, plant::Plant};
use thetahat_ground::series::Series;
use thetahat_model::regressor::Regressor;

/// The columns of the observation matrix for the standard parameters among the sensitivity parameters.
pub(super) struct ParameterColumns {
    regressor: Regressor,
    /// Row, column and factor of each entry; the factor is that of a biased friction.
    places: Vec<(usize, usize, f64)>,
    /// The entries of one stage after the other.
    phi: Vec<f64>,
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
        Self { places: places.collect(), phi: Vec::new(), regressor }
    }

    /// Computes the entries at each sample of a motion with its recorded channels.
    pub(super) fn evaluate(&mut self, plant: &Plant<'_>, motion: [&Series; 3], channels: Option<&Series>) {
        if channels.is_some() {
            self.regressor.set_channels(channels);
        }
        let stages = motion[0].len();
        self.phi.resize(stages * self.places.len(), 0.0);
        self.regressor.evaluate_samples(plant.model, motion, 0..stages, plant.sign, &mut self.phi);
    }

    /// Subtracts `phi_p`, the torques for a unit of each parameter, at a sample from the columns.
    pub(super) fn subtract(&self, sample: usize, columns: &mut ColumnBlocks) {
        let phi = &self.phi[sample * self.places.len()..];
        for (&(row, column, factor), value) in self.places.iter().zip(phi) {
            columns.add(row, column, -factor * value);
        }
    }
}
