//! One piece of a recording on its way to rows.

use std::ops::Range;

use super::{
    error::ReductionError,
    fingerprint::Fingerprint,
    instruments::{Simulated, SimulatedPiece},
    model_rows::{MeasuredPiece, ModelPiece, ModelRows},
    near_rest::{MaskedPiece, NearRestMask},
    overlap::Marks,
    pieces::{Pieces, refuse},
};
use thetahat_estimation::signal::{CentredHold, DecimatedPiece, Decimator, Motion, centred_hold};
use thetahat_ground::series::Series;
use thetahat_model::{
    dynamics::{Model, Sign, State, Workspace},
    regressor::{BufferedRegressor, Regressor},
};

/// What makes rows of the pieces of a window.
pub(super) struct Rows<'a> {
    pub pieces: &'a Pieces<'a>,
    pub window: Range<usize>,
    pub decimator: &'a Decimator,
    pub model: &'a Model,
    pub regressor: &'a Regressor,
    /// The simulation of the instruments.
    pub simulated: Option<&'a Simulated<'a>>,
    /// Which samples make no rows; none if all do.
    pub mask: Option<&'a NearRestMask>,
    /// The rows of every sample.
    pub model_rows: &'a ModelRows,
}

/// What one piece gives.
pub(super) struct Piece {
    pub decimated: DecimatedPiece,
    pub fingerprint: Fingerprint,
    pub marks: Marks,
    /// Largest velocity.
    pub peak: f64,
    pub has_torque: bool,
    /// Samples of each coordinate that make no rows.
    pub left_out: Vec<usize>,
    pub model: ModelPiece,
    /// Simulated positions at the first sample, and at the one after the last.
    pub seam: Option<(Vec<f64>, Option<Vec<f64>>)>,
}

/// Where the channels of a sample stand: the entries of phi from the simulated motion, where there is one, then the entries
/// from the measured motion, the torques, and the mask, where there is one.
#[derive(Debug, Clone, Copy)]
pub(super) struct Channels {
    entries: usize,
    joints: usize,
    is_simulated: bool,
    is_masked: bool,
}

impl Channels {
    pub(super) fn joints(self) -> usize {
        self.joints
    }

    /// The first entry of each matrix.
    pub(super) fn matrices(self) -> Vec<usize> {
        if self.is_simulated { vec![0, self.entries] } else { vec![0] }
    }

    /// The first entry from the measured motion.
    pub(super) fn measured(self) -> usize {
        if self.is_simulated { self.entries } else { 0 }
    }

    /// The first joint's torque.
    pub(super) fn torque(self) -> usize {
        self.measured() + self.entries
    }

    /// The first joint's mask.
    pub(super) fn mask(self) -> Option<usize> {
        self.is_masked.then_some(self.torque() + self.joints)
    }

    pub(super) fn count(self) -> usize {
        self.torque() + self.joints * if self.is_masked { 2 } else { 1 }
    }
}

impl Rows<'_> {
    pub(super) fn channels(&self) -> Channels {
        Channels {
            entries: self.regressor.entries().len(),
            joints: self.model.coordinate_count(),
            is_simulated: self.simulated.is_some(),
            is_masked: self.mask.is_some(),
        }
    }

    /// The piece with these rows.
    pub(super) fn piece(&self, rows: Range<usize>) -> Result<Piece, ReductionError> {
        let own = self.decimator.samples_of(&rows);
        let range = own.start + self.window.start..own.end + self.window.start;
        let measured = self.measured(&range)?;
        let mut workspace = Workspace::new(self.model);
        let mut simulated = self.simulated.map(|s| self.simulated(s, &range, &mut workspace)).transpose()?;
        let (channels, entries) = (self.channels(), self.regressor.entries());
        let Motion { q, dq, ddq } = &measured.motion;
        let mut measured_phi = BufferedRegressor::new(self.regressor, self.model, [q, dq, ddq], Sign::Exact);
        let decimated = self.decimator.decimate_piece(rows.clone(), channels.count(), |k, values| {
            let k = k - own.start;
            let (z, values) = values.split_at_mut(channels.measured());
            let (phi, values) = values.split_at_mut(channels.entries);
            let (tau, used) = values.split_at_mut(channels.joints);
            if let Some(simulated) = &mut simulated {
                simulated.write(self, k, z, &mut workspace);
            }
            let i = k + measured.first;
            measured_phi.write(i, phi);
            tau.copy_from_slice(measured.centred_torque.sample(i));
            if let Some(mask) = &measured.mask {
                used.copy_from_slice(mask.used.sample(k));
                if used.iter().all(|used| *used == 1.0) {
                    return;
                }
                let scale = |row: &mut [f64]| row.iter_mut().zip(entries).for_each(|(v, e)| *v *= used[e.joint]);
                scale(z);
                scale(phi);
                tau.iter_mut().zip(&*used).for_each(|(tau, used)| *tau *= used);
            }
        });
        let motion =
            MeasuredPiece { motion: &measured.motion, torque: &measured.centred_torque, first: measured.first };
        let model = self.model_rows.piece(self.model, motion, rows);
        Ok(Piece {
            model: model.map_err(|e| refuse(self.pieces.experiment, e))?,
            decimated: decimated.map_err(|e| refuse(self.pieces.experiment, e))?,
            fingerprint: measured.fingerprint,
            marks: measured.marks,
            peak: measured.peak,
            has_torque: measured.has_torque,
            left_out: measured.mask.map_or_else(|| vec![0; channels.joints], |mask| mask.left_out),
            seam: simulated.map(|simulated| simulated.seam),
        })
    }

    /// The entries of phi of a sample of a motion.
    fn write(&self, motion: &Motion, k: usize, sign: Sign, phi: &mut [f64], workspace: &mut Workspace) {
        let state = State::new(motion.q.sample(k), motion.dq.sample(k));
        self.regressor.evaluate(self.model, state, motion.ddq.sample(k), sign, workspace, phi);
    }

    fn measured(&self, range: &Range<usize>) -> Result<Measured, ReductionError> {
        let Pieces { source, .. } = *self.pieces;
        let around = self.mask.map_or_else(|| range.clone(), |mask| mask.around(range));
        let extended = self.pieces.extended(&around);
        let (position, mut torque) = source.motion(extended.clone())?;
        let motion = self.pieces.band_pass(&position)?;
        let in_extended = |range: &Range<usize>| range.start - extended.start..range.end - extended.start;
        let (own, around) = (in_extended(range), in_extended(&around));
        let mut fingerprint = Fingerprint::EMPTY;
        for k in own.clone() {
            fingerprint.add(position.sample(k));
            fingerprint.add(torque.sample(k));
        }
        let mut marks = Marks::default();
        let end = (self.window.end.min(extended.end)) - extended.start;
        marks.add([&position, &torque], own.clone(), (extended.start, end));
        let largest = |series: &Series| {
            own.clone().flat_map(|k| series.sample(k)).fold(0.0, |largest: f64, v| largest.max(v.abs()))
        };
        let has_torque = largest(&torque) > 0.0;
        if let Some(fixed) = self.pieces.experiment.setup().fixed_torque(&motion, None) {
            torque.values_mut().iter_mut().zip(fixed.values()).for_each(|(torque, fixed)| *torque -= fixed);
        }
        Ok(Measured {
            peak: largest(&motion.dq),
            has_torque,
            marks,
            mask: self.mask.map(|mask| mask.of(range, &motion.dq.window(around))),
            centred_torque: centred_hold(&torque, source.held_part_of_step()),
            motion,
            first: own.start,
            fingerprint,
        })
    }

    fn simulated(
        &self,
        simulated: &Simulated<'_>,
        range: &Range<usize>,
        workspace: &mut Workspace,
    ) -> Result<SimulatedRows, ReductionError> {
        let held = simulated.held_part_of_step();
        // Where torques hold, the first row of a piece takes the sample before it; the window's first one has none.
        let before = usize::from(held > 0.0 && range.start > self.window.start);
        let SimulatedPiece { motion, next } = simulated.motion(&(range.start - before..range.end))?;
        let seam = (motion.q.sample(before).to_vec(), next);
        let mut rows = SimulatedRows { motion, sign: simulated.sign(), first: 0, hold: CentredHold::new(held), seam };
        if before > 0 {
            rows.write(self, 0, &mut vec![0.0; self.regressor.entries().len()], workspace);
        }
        Ok(SimulatedRows { first: before, ..rows })
    }
}

/// The measured motion of a piece, with what is read around it.
struct Measured {
    motion: Motion,
    /// The torques that act around each sample.
    centred_torque: Series,
    /// The first sample of the piece.
    first: usize,
    mask: Option<MaskedPiece>,
    /// Of the piece as it was recorded.
    fingerprint: Fingerprint,
    marks: Marks,
    peak: f64,
    has_torque: bool,
}

/// The rows of Z of a piece before the decimation, one after the other.
struct SimulatedRows {
    motion: Motion,
    sign: Sign,
    /// The first sample of the piece.
    first: usize,
    hold: CentredHold,
    seam: (Vec<f64>, Option<Vec<f64>>),
}

impl SimulatedRows {
    fn write(&mut self, rows: &Rows<'_>, k: usize, z: &mut [f64], workspace: &mut Workspace) {
        rows.write(&self.motion, k + self.first, self.sign, z, workspace);
        self.hold.pass(z);
    }
}
