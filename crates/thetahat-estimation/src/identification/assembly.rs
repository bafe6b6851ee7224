use std::sync::Arc;

use super::{fit::SimulatedResponse, row_mask::RowMask};
use crate::{
    signal::{CentredHold, Decimator, SignalError},
    simulation::SimulationError,
};
use thetahat_ground::{linear_algebra::Matrix, series::Series};
use thetahat_model::{
    dynamics::{Model, Sign},
    regressor::{BufferedRegressor, Regressor},
};

/// Builds `y`, `X` and `Z` with the same rows: torques and every column of the observation matrix pass the same parallel
/// filter and the same down-sampling (6), (7).
#[derive(Debug, Clone)]
pub struct Assembly<'a> {
    model: &'a Model,
    regressor: Regressor,
    decimator: Decimator,
    mask: Option<Arc<RowMask>>,
    held_part_of_step: f64,
}

impl<'a> Assembly<'a> {
    /// An assembly of the columns at `indices` of the model's table, for recordings that fit `decimator`.
    #[must_use]
    pub fn new(model: &'a Model, indices: &[usize], decimator: Decimator) -> Self {
        Self { model, regressor: Regressor::new(model, indices), decimator, mask: None, held_part_of_step: 0.0 }
    }

    /// The assembly with some samples of each joint set to zero in y, X and Z; none uses every sample.
    #[must_use]
    pub fn masked(self, mask: Option<Arc<RowMask>>) -> Self {
        Self { mask, ..self }
    }

    /// The assembly for motions recorded with these channels, as the robot's torque terms use them.
    #[must_use]
    pub fn with_channels(self, channels: Option<Series>) -> Self {
        Self { regressor: self.regressor.with_channels(channels), ..self }
    }

    /// The assembly for a simulated motion whose torques hold for a fraction of a step: its accelerations are those just after each sample,
    /// like its torques. Its rows are centred on the samples as [`centred_hold`](crate::signal::centred_hold) centres torques.
    #[must_use]
    pub fn of_held_torques(self, part_of_step: f64) -> Self {
        Self { held_part_of_step: part_of_step, ..self }
    }

    /// Rows of each joint.
    #[must_use]
    pub fn rows_per_joint(&self) -> usize {
        self.decimator.rows()
    }

    /// Index, in the samples before decimation, of each decimated row of a joint.
    #[must_use]
    pub fn kept_samples(&self) -> Vec<usize> {
        self.decimator.kept().collect()
    }

    /// The vector `y` of decimated torques.
    ///
    /// # Errors
    /// [`SignalError`] where the recording is too short for the filter.
    pub fn measurement_vector(&self, tau: &Series) -> Result<Vec<f64>, SignalError> {
        let decimated = match &self.mask {
            None => self.decimator.decimate(tau)?,
            Some(mask) => self.decimator.decimate(&mask.applied_to(tau))?,
        };
        Ok((0..tau.channels()).flat_map(|j| decimated.channel(j)).collect())
    }

    /// The vectors `y` of several torques, from a sample on, in one pass of the filter.
    ///
    /// # Errors
    /// [`SignalError`] where the recording is too short for the filter.
    #[doc(hidden)]
    pub fn measurement_vectors(&self, torques: &[Series], first: usize) -> Result<Vec<Vec<f64>>, SignalError> {
        let joints = self.model.coordinate_count();
        let decimated = self.decimator.decimate_computed(joints * torques.len(), |k, sample| {
            for (tau, values) in torques.iter().zip(sample.chunks_exact_mut(joints)) {
                values.copy_from_slice(tau.sample(first + k));
            }
            if let Some(mask) = &self.mask {
                mask.scale(k, sample, |channel| channel % joints);
            }
        })?;
        let of_torque = |i: usize| (0..joints).flat_map(|j| decimated.channel(i * joints + j)).collect();
        Ok((0..torques.len()).map(of_torque).collect())
    }

    /// A simulated response and its sensitivities in the rows of y of some joints. `fill` is called for each sample in order and writes one
    /// value for each of them, followed by `parameters` derivatives for each.
    ///
    /// # Errors
    /// The errors of `fill`, and [`SimulationError::TooShortToFilter`].
    #[doc(hidden)]
    pub fn response_with_sensitivities(
        &self,
        of: &[usize],
        parameters: usize,
        mut fill: impl FnMut(&mut [f64], &mut [f64]) -> Result<(), SimulationError>,
    ) -> Result<SimulatedResponse, SimulationError> {
        let (joints, rows) = (of.len(), self.rows_per_joint());
        let mut failure = None;
        let [mut centred_values, mut centred_slopes] = [0, 1].map(|_| CentredHold::new(self.held_part_of_step));
        let decimated = self.decimator.decimate_computed(joints * (1 + parameters), |k, sample| {
            let (values, slopes) = sample.split_at_mut(joints);
            if failure.is_none() {
                failure = fill(values, slopes).err();
            }
            centred_values.pass(values);
            centred_slopes.pass(slopes);
            if let Some(mask) = &self.mask {
                mask.scale(k, values, |joint| of[joint]);
                mask.scale(k, slopes, |slope| of[slope / parameters]);
            }
        });
        if let Some(failure) = failure {
            return Err(failure);
        }
        let decimated = decimated.map_err(|_| SimulationError::TooShortToFilter)?;
        let response = (0..joints).flat_map(|j| decimated.channel(j)).collect();
        let of_joint = |row: usize, parameter: usize| joints + row / rows * parameters + parameter;
        let sensitivities =
            Matrix::from_fn(joints * rows, parameters, |row, p| decimated.sample(row % rows)[of_joint(row, p)]);
        Ok(SimulatedResponse { response, sensitivities })
    }

    /// The observation matrix of a motion: `X` of a measured one, `Z` of a simulated one.
    ///
    /// # Errors
    /// [`SignalError`] where the recording is too short for the filter.
    pub fn observation_matrix(&self, q: &Series, dq: &Series, ddq: &Series, sign: Sign) -> Result<Matrix, SignalError> {
        let mut samples = BufferedRegressor::new(&self.regressor, self.model, [q, dq, ddq], sign);
        let entries = self.regressor.entries();
        let mut centred = CentredHold::new(self.held_part_of_step);
        let decimated = self.decimator.decimate_computed(entries.len(), |k, phi| {
            samples.write(k, phi);
            centred.pass(phi);
            if let Some(mask) = &self.mask {
                mask.scale(k, phi, |entry| entries[entry].joint);
            }
        })?;
        let rows = self.rows_per_joint();
        let mut x = Matrix::zeros(rows * self.model.coordinate_count(), self.regressor.columns());
        for (e, entry) in entries.iter().enumerate() {
            let column = &mut x.column_mut(entry.column)[entry.joint * rows..][..rows];
            for (k, value) in column.iter_mut().enumerate() {
                *value = decimated.sample(k)[e];
            }
        }
        Ok(x)
    }
}
