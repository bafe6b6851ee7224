//! Forward dynamics over a motion, one sample in each lane.

use std::ops::Range;

use pulp::{Simd, WithSimd};

use super::{
    model::{DynamicsError, Model},
    parameters::DynamicParameters,
    sign::Sign,
    state::State,
    workspace::Workspace,
};
use thetahat_ground::{real::Lanes, series::Series};

impl Model {
    /// Forward dynamics (5) of every sample: the accelerations of the torques `tau`. All series have the same number of samples
    /// and a channel for each coordinate.
    ///
    /// # Errors
    /// The first sample, from zero, at which these parameters have no positive definite mass matrix.
    ///
    /// # Panics
    /// If the series differ in length, or have another number of channels.
    pub fn forward_dynamics_series(
        &self,
        parameters: &DynamicParameters,
        motion: [&Series; 3],
        sign: Sign,
    ) -> Result<Series, (usize, DynamicsError)> {
        self.forward_dynamics_with_channels(parameters, motion, None, sign)
    }

    /// [`Self::forward_dynamics_series`] with the recorded channels that the robot's torque terms use.
    #[doc(hidden)]
    pub fn forward_dynamics_with_channels(
        &self,
        parameters: &DynamicParameters,
        [q, dq, tau]: [&Series; 3],
        channels: Option<&Series>,
        sign: Sign,
    ) -> Result<Series, (usize, DynamicsError)> {
        let mut ddq = Series::zeros(q.len(), q.channels());
        let inputs = [q, dq, tau];
        let done =
            pulp::Arch::new().dispatch(Batches { model: self, parameters, inputs, channels, sign, ddq: &mut ddq });
        // The remaining samples are fewer than a batch, or start with one without a positive definite mass matrix.
        let mut workspace = Workspace::new(self);
        for k in done..q.len() {
            let ddq = ddq.sample_mut(k);
            let recorded = channels.map_or(&[][..], |channels| channels.sample(k));
            let state = State::new(q.sample(k), dq.sample(k)).with_channels(recorded);
            self.forward_dynamics(parameters, state, tau.sample(k), sign, &mut workspace, ddq)
                .map_err(|error| (k, error))?;
        }
        Ok(ddq)
    }
}

/// Loads consecutive samples, one channel into each number.
#[inline(always)]
pub(crate) fn gather<S: Simd>(simd: S, series: &Series, samples: Range<usize>, channels: &mut [Lanes<S>]) {
    let count = series.channels();
    let values = &series.values()[samples.start * count..samples.end * count];
    for (c, channel) in channels.iter_mut().enumerate() {
        *channel = Lanes::from_fn(simd, |lane| values[lane * count + c]);
    }
}

struct Batches<'a> {
    model: &'a Model,
    parameters: &'a DynamicParameters,
    inputs: [&'a Series; 3],
    channels: Option<&'a Series>,
    sign: Sign,
    ddq: &'a mut Series,
}

impl WithSimd for Batches<'_> {
    /// Number of finished samples.
    type Output = usize;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> usize {
        if Lanes::<S>::COUNT == 1 || self.model.has_loops() {
            // With one lane, and of loops, the kernel for one state does all the work.
            return 0;
        }
        let zero = Lanes::splat(simd, 0.0);
        let n = self.model.coordinate_count();
        let mut workspace = Workspace::like(self.model, zero);
        let [mut q, mut dq, mut tau, mut ddq] = [(); 4].map(|()| vec![zero; n]);
        let mut recorded = vec![zero; self.channels.map_or(0, Series::channels)];
        let mut done = 0;
        while done + Lanes::<S>::COUNT <= self.ddq.len() {
            let samples = done..done + Lanes::<S>::COUNT;
            for (series, channels) in self.inputs.into_iter().zip([&mut q, &mut dq, &mut tau]) {
                gather(simd, series, samples.clone(), channels);
            }
            if let Some(channels) = self.channels {
                gather(simd, channels, samples.clone(), &mut recorded);
            }
            let state = State::new(&q, &dq).with_channels(&recorded);
            if self
                .model
                .forward_dynamics_of(self.parameters, state, &tau, self.sign, &mut workspace, &mut ddq)
                .is_err()
            {
                break;
            }
            for (c, accelerations) in ddq.iter().enumerate() {
                let of_lanes = accelerations.to_array();
                samples.clone().zip(of_lanes).for_each(|(k, value)| self.ddq.sample_mut(k)[c] = value);
            }
            done = samples.end;
        }
        done
    }
}
