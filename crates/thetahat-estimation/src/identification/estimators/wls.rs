//! Least squares weighted by the noise of each joint: LS with a weighting.

use super::{
    estimator::{Estimator, Weighting},
    ls::IDIM_LS,
};

pub(super) static IDIM_WLS: Estimator = Estimator { name: "idim-wls", weighting: Some(Weighting::PerJoint), ..IDIM_LS };
