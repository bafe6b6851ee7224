//! What must be known of a recording before rows are made of it: its window, and what counts as near rest there.

use std::{collections::BTreeMap, ops::Range};

use super::{
    error::ReductionError,
    pieces::{Look, Pieces},
};
use crate::preparation::{
    MotionOfRecording, SignalOptions, accelerates, distorted_samples, near_ends, near_rest_of_noise, window_of,
};
use thetahat_estimation::{identification::NearRest, signal::densities_of_squares};
use thetahat_ground::pool::in_order;

/// What was found.
pub(super) struct Surveyed {
    pub window: Range<usize>,
    /// What counts as near rest; none if every sample makes rows.
    pub near_rest: Option<NearRest>,
    /// Pieces that were read.
    pub pieces: usize,
}

/// The passes over the positions of a recording.
pub(super) struct Survey<'a> {
    pieces: &'a Pieces<'a>,
    threads: usize,
    /// Called with the pieces done and the pieces to do.
    report: &'a mut dyn FnMut(usize, usize),
    /// Pieces that were looked at, by their range of samples.
    looks: BTreeMap<[usize; 2], Look>,
}

impl<'a> Survey<'a> {
    pub(super) fn new(pieces: &'a Pieces<'a>, threads: usize, report: &'a mut dyn FnMut(usize, usize)) -> Self {
        Self { pieces, threads, report, looks: BTreeMap::new() }
    }

    /// The window, and what counts as near rest in it of a robot whose torques jump where velocities change their sign.
    ///
    /// A window that is not stated or reaches the ends of the recording, and limits that depend on the noise of the positions,
    /// take a pass over the recording: the limits are those of the whole window, and do not depend on the pieces.
    pub(super) fn run(mut self, signal: &SignalOptions, has_jumps: bool) -> Result<Surveyed, ReductionError> {
        let window = self.window(signal)?;
        let near_rest = if has_jumps { self.near_rest(signal, &window)? } else { None };
        Ok(Surveyed { window, near_rest, pieces: self.looks.len() })
    }

    fn window(&mut self, signal: &SignalOptions) -> Result<Range<usize>, ReductionError> {
        let Pieces { experiment, source, .. } = *self.pieces;
        let (samples, rate) = (source.samples, source.sample_rate_hz);
        let of = |moving, accelerates_at| {
            let window = window_of(MotionOfRecording { moving, accelerates_at, samples }, rate, signal);
            window.map_err(|e| ReductionError::from(experiment.refuse(e)))
        };
        let distorted = distorted_samples(rate, signal.cutoff_hz);
        let reaches_ends = |window: &Range<usize>| window.start < distorted || window.end + distorted > samples;
        if signal.window_start_s.is_none() || reaches_ends(&of(0..samples, [false; 2])?) {
            self.look_at(self.pieces.all())?;
            let peaks: Vec<&[f64]> = self.looks.values().map(|look| &look.peaks[..]).collect();
            let moving = self.pieces.moving(&peaks)?;
            let largest = self.largest_accelerations(&of(moving.clone(), [false; 2])?)?;
            let [start, end] = near_ends(samples, rate, signal.cutoff_hz);
            let [at_start, at_end] = [self.pieces.acceleration(&start)?, self.pieces.acceleration(&end)?];
            return of(moving, [accelerates(&at_start, &largest), accelerates(&at_end, &largest)]);
        }
        let window = of(0..samples, [false; 2])?;
        if source.has_stamps() {
            // Outside the window only the stamps are read: they too must be equally spaced.
            [0..window.start + 1, window.end - 1..source.samples].iter().try_for_each(|r| self.check_stamps(r))?;
        }
        Ok(window)
    }

    /// The largest acceleration of each joint in a window.
    fn largest_accelerations(&mut self, window: &Range<usize>) -> Result<Vec<f64>, ReductionError> {
        let joints = self.pieces.experiment.robot.coordinate_count();
        let looks = self.look_in(window)?;
        Ok((0..joints).map(|j| looks.iter().map(|look| look.accelerations[j]).fold(0.0, f64::max)).collect())
    }

    fn check_stamps(&self, range: &Range<usize>) -> Result<(), ReductionError> {
        let Pieces { source, samples, .. } = *self.pieces;
        let mut starts = range.clone().step_by(samples);
        starts.try_for_each(|start| source.check_stamps(start..(start + samples + 1).min(range.end)))
    }

    fn near_rest(&mut self, signal: &SignalOptions, window: &Range<usize>) -> Result<Option<NearRest>, ReductionError> {
        let Pieces { experiment, source, .. } = *self.pieces;
        let scale = experiment.settings.simulation.sign_velocity_scale;
        let joints = experiment.robot.coordinate_count();
        let rate = source.sample_rate_hz;
        near_rest_of_noise(signal, scale, (joints, rate), || {
            let squares = self.squares_taken_off(window, joints)?;
            Ok(densities_of_squares(&squares, window.len(), rate, signal.cutoff_hz))
        })
    }

    /// The sum of the squares of what the position filter takes off in a window. Pieces inside it that were looked at for the
    /// window itself are not read again.
    fn squares_taken_off(&mut self, window: &Range<usize>, joints: usize) -> Result<Vec<f64>, ReductionError> {
        let looks = self.look_in(window)?;
        let mut squares = vec![0.0; joints];
        for look in looks {
            squares.iter_mut().zip(&look.taken_off).for_each(|(sum, s)| *sum += s);
        }
        Ok(squares)
    }

    /// Looks at the parts of all pieces in a window.
    fn look_in(&mut self, window: &Range<usize>) -> Result<Vec<&Look>, ReductionError> {
        let inside = |piece: Range<usize>| piece.start.max(window.start)..piece.end.min(window.end);
        let parts: Vec<Range<usize>> = self.pieces.all().into_iter().map(inside).filter(|p| !p.is_empty()).collect();
        let unknown = parts.iter().filter(|part| !self.looks.contains_key(&key(part))).cloned().collect();
        self.look_at(unknown)?;
        Ok(parts.iter().filter_map(|part| self.looks.get(&key(part))).collect())
    }

    fn look_at(&mut self, ranges: Vec<Range<usize>>) -> Result<(), ReductionError> {
        let (pieces, looks, report) = (self.pieces, &mut self.looks, &mut self.report);
        let to_do = 2 * (looks.len() + ranges.len());
        in_order(
            ranges.len(),
            self.threads,
            |number| pieces.look(&ranges[number]),
            |number, look| {
                looks.insert(key(&ranges[number]), look?);
                report(looks.len(), to_do);
                Ok(())
            },
        )
    }
}

fn key(range: &Range<usize>) -> [usize; 2] {
    [range.start, range.end]
}
