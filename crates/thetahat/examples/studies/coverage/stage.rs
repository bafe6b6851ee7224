//! What the program does with a recording before it estimates, step by step.

use std::{error::Error, sync::Arc};

use thetahat::{
    Matrix, Series,
    dynamics::Sign,
    preparation::{Mask, NamedMask, SignalOptions, near_rest},
    regression::Regression,
    signal::{Derivative, Motion, band_pass},
};
use thetahat_estimation::{identification::RowMask, signal::centred_hold};
use thetahat_model::dynamics::Jump;

use super::twin::Twin;

/// The steps, each with those before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// The torques as recorded, central differences, every sample.
    Recorded,
    /// The torque that the controller holds is centred on its sample.
    Hold,
    /// Samples near rest make no rows.
    Mask,
    /// Derivatives over nine points: all that the program does.
    Derivative,
}

impl Stage {
    pub const ALL: [Self; 4] = [Self::Recorded, Self::Hold, Self::Mask, Self::Derivative];

    pub fn name(self) -> &'static str {
        match self {
            Self::Recorded => "as recorded",
            Self::Hold => "+ hold",
            Self::Mask => "+ mask",
            Self::Derivative => "+ derivative",
        }
    }

    fn has(self, step: Self) -> bool {
        self as usize >= step as usize
    }

    fn options(self, twin: &Twin) -> SignalOptions {
        let derivative = if self.has(Self::Derivative) { Derivative::NinePoint } else { Derivative::Central };
        let mask = if self.has(Self::Mask) { NamedMask::NearRest } else { NamedMask::None };
        SignalOptions { derivative, mask: Mask::Named(mask), ..twin.experiment.settings.signal }
    }

    /// What the program makes of recorded positions.
    pub fn measured<'a>(self, twin: &'a Twin, positions: &Series) -> Result<Measured<'a>, Box<dyn Error>> {
        let options = self.options(twin);
        let SignalOptions { filter_order, cutoff_hz, derivative, .. } = options;
        let rate = twin.sample_rate_hz;
        let Motion { q, dq, ddq } = band_pass(positions, rate, filter_order, cutoff_hz, derivative)?;
        let cut = |s: &Series| s.window(twin.window.clone());
        let motion = [&q, &dq, &ddq].map(cut);
        let scale = twin.experiment.settings.simulation.sign_velocity_scale;
        let rule = near_rest(&options, scale, [&cut(positions), &motion[0]], rate);
        let jumps = Jump::among(&twin.model, &twin.base.columns());
        let mask = rule.and_then(|rule| RowMask::near_rest(&jumps, &motion[1], &rule)).map(Arc::new);
        Ok(Measured { twin, stage: self, motion, mask })
    }
}

/// A recording between two steps on the way to rows.
pub struct Measured<'a> {
    twin: &'a Twin,
    stage: Stage,
    motion: [Series; 3],
    pub mask: Option<Arc<RowMask>>,
}

impl Measured<'_> {
    /// X.
    pub fn matrix(&self, sign: Sign) -> Result<Matrix, Box<dyn Error>> {
        let [q, dq, ddq] = &self.motion;
        Ok(self.twin.assembly(self.mask.clone()).observation_matrix(q, dq, ddq, sign)?)
    }

    /// Z of an exact simulator.
    pub fn instruments(&self) -> Result<Matrix, Box<dyn Error>> {
        let [q, dq, ddq] = self.twin.cut_motion();
        let held = if self.stage.has(Stage::Hold) { self.twin.held_part_of_step } else { 0.0 };
        let assembly = self.twin.assembly(self.mask.clone()).of_held_torques(held);
        Ok(assembly.observation_matrix(&q, &dq, &ddq, self.twin.smooth_sign())?)
    }

    /// The regression of recorded torques on a matrix.
    pub fn regression(&self, x: Matrix, torque: &Series) -> Result<Regression, Box<dyn Error>> {
        let held = self.stage.has(Stage::Hold);
        let centred = if held { centred_hold(torque, self.twin.held_part_of_step) } else { torque.clone() };
        let y = self.twin.assembly(self.mask.clone()).measurement_vector(&centred.window(self.twin.window.clone()))?;
        Ok(Regression::new(x, y, self.twin.masked_layout(self.mask.as_ref())?))
    }
}
