use std::ops::Range;

use super::{columns::ColumnBlocks, sensitive_to::SensitiveTo, stages::StageMotion};
use crate::simulation::{closed_loop::ClosedLoop, plant::Plant};
use thetahat_model::dynamics::{Sign, State, Workspace};

/// Change of the logarithm of the velocity for which torques are differenced: errors of `STEP^2`.
const STEP: f64 = 1e-4;

/// The change of the torques of friction with the logarithm of the velocity at which it changes its sign.
pub(super) struct TransitionColumns {
    columns: Vec<usize>,
    scale: f64,
    workspace: Workspace,
    /// The derivatives, one stage after the other.
    slopes: Vec<f64>,
    /// Scratch: torques with the larger velocity, and with the smaller one.
    torques: [Vec<f64>; 2],
}

impl TransitionColumns {
    /// None if no column is asked for.
    pub(super) fn new(setup: &ClosedLoop<'_>, to: &[SensitiveTo]) -> Option<Self> {
        let n = setup.model.coordinate_count();
        let columns = SensitiveTo::FrictionTransition.columns_of(to);
        (!columns.is_empty()).then(|| Self {
            columns,
            scale: setup.sign_velocity_scale,
            workspace: Workspace::new(setup.model),
            slopes: Vec::new(),
            torques: [vec![0.0; n], vec![0.0; n]],
        })
    }

    /// Computes the derivatives in these stages of a step.
    pub(super) fn evaluate(&mut self, plant: &Plant<'_>, motion: &StageMotion, stages: Range<usize>) {
        let [q, dq, ddq] = motion.series();
        let n = q.channels();
        self.slopes.resize(stages.end * n, 0.0);
        for stage in stages {
            let channels = motion.channels().map_or(&[][..], |channels| channels.sample(stage));
            let state = State::new(q.sample(stage), dq.sample(stage)).with_channels(channels);
            for (torques, step) in self.torques.iter_mut().zip([STEP, -STEP]) {
                let sign = Sign::smooth(self.scale * step.exp());
                let parameters = &plant.parameters;
                plant.model.inverse_dynamics(parameters, state, ddq.sample(stage), sign, &mut self.workspace, torques);
            }
            let [larger, smaller] = &self.torques;
            let slopes = &mut self.slopes[stage * n..(stage + 1) * n];
            let differences = larger.iter().zip(smaller).map(|(larger, smaller)| (larger - smaller) / (2.0 * STEP));
            slopes.iter_mut().zip(differences).for_each(|(slope, difference)| *slope = difference);
        }
    }

    /// Subtracts the derivatives in a stage from the columns.
    pub(super) fn subtract(&self, stage: usize, out: &mut ColumnBlocks) {
        let n = self.torques[0].len();
        for &column in &self.columns {
            let slopes = &self.slopes[stage * n..(stage + 1) * n];
            out.add_column(column, slopes.iter().map(|slope| -slope));
        }
    }
}
