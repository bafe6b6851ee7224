//! The recording and its regression for the checks: the band of the estimate at a fraction of its cost.
//!
//! The motion is band-passed as for the estimate, but the model is evaluated at only ten samples per period of the cut-off.
//! Torque and observation matrix then pass the same second decimation. On the TX40 this takes 10 ms instead of 110, and the
//! relative error agrees to 0.01 %.

use std::{cell::OnceCell, ops::Range, rc::Rc};

use super::{affine::Affine, orthogonal_fit::OrthogonalFit};
use crate::{
    checks::{numbers::deviation, subject::Subject},
    identification::Assembly,
    regression::{Regression, RowLayout},
    signal::{Decimator, Derivative, Motion, SignalError, band_pass},
};
use thetahat_ground::{
    linear_algebra::{Matrix, PivotedQr},
    series::Series,
    stretches::stretches_where,
};
use thetahat_model::{
    base_parameters::BaseParameters,
    dynamics::{Model, Sign},
    regressor::Regressor,
    robot::Quantity,
};

/// Samples per period of the cut-off at which the motion is evaluated.
const SAMPLES_PER_PERIOD: f64 = 10.0;
/// Most samples at which the motion is evaluated, to bound the time of a check.
const MOST_SAMPLES: usize = 20_000;
/// Thinned samples next to a gap that the low-pass of the thinning affects.
const AROUND: usize = 2;
/// Rows of a coordinate beyond which more add nothing.
const ENOUGH_ROWS: usize = 2_000;
/// Most work of one factorisation, rows times squared columns: beyond it only every n-th row is used.
const MOST_WORK: f64 = 2e7;

/// Speed, part of the coordinate's largest, up to which it is near rest.
const NEAR_REST: f64 = 0.02;
/// Rows after which a step that passes the filter of the rows has settled to 2 %.
const MEMORY_ROWS: usize = 4;
/// Fewest rows of a coordinate for meaningful statistics.
const FEWEST_ROWS: usize = 40;
/// Relative size of the last diagonal entries of R below which columns made of a motion are linearly dependent.
const DEPENDENT: f64 = 1e-8;
/// Fewest rows per column of a fit that is checked.
const ROWS_PER_COLUMN: usize = 2;
/// Fewest rows per parameter that a reduction keeps: with as many rows as parameters any motion fits.
const FEWEST_ROWS_PER_PARAMETER: usize = 6;

/// The left-out samples in the thinned recording, with those that the low-pass of the thinning affects.
fn thinned(left_out: &[Range<usize>], first: &Decimator, stride: usize) -> Vec<Range<usize>> {
    let offset = first.kept().next().unwrap_or(0);
    let index = |k: usize| k.saturating_sub(offset) / stride;
    let around =
        |gap: &Range<usize>| index(gap.start).saturating_sub(AROUND)..(index(gap.end) + 1 + AROUND).min(first.rows());
    let mut thinned: Vec<Range<usize>> = Vec::new();
    for gap in left_out.iter().map(around) {
        match thinned.last_mut().filter(|last| last.end >= gap.start) {
            Some(last) => last.end = last.end.max(gap.end),
            None => thinned.push(gap),
        }
    }
    thinned
}

/// Motion and torque between the two decimations, corrected as faults are found, with their fit.
#[derive(Clone)]
pub(in crate::checks) struct ThinnedRecording<'a> {
    pub(in crate::checks) subject: &'a Subject<'a>,
    /// The parameters of the fit.
    base: &'a BaseParameters,
    pub(in crate::checks) motion: Motion,
    /// Low-passed like the rows.
    pub(in crate::checks) torque: Series,
    pub(in crate::checks) decimator: Decimator,
    /// Samples per second of motion and torque.
    pub(in crate::checks) rate_hz: f64,
    /// Samples that become rows.
    pub(in crate::checks) kept: Vec<usize>,
    /// One of this many rows is used.
    every: usize,
    /// Recorded samples from one row to the next, before rows are left out.
    factor: usize,
    regressor: Regressor,
    fit: OnceCell<Rc<OrthogonalFit>>,
    corrected: bool,
}

impl<'a> ThinnedRecording<'a> {
    /// The recording of a subject, for a fit of all base parameters; `None` if its torques were not recorded or it is too short
    /// for the filters.
    pub(in crate::checks) fn new(subject: &'a Subject<'a>, cutoff_hz: f64) -> Option<Self> {
        let bounded = bounded_factor(subject.signal.window.len(), subject.sample_rate_hz, cutoff_hz);
        Self::with_factor(subject, subject.signal.decimation.max(bounded), cutoff_hz)
    }

    /// The original recording, with another filter of the positions and the same filter of the torques.
    pub(in crate::checks) fn with_cutoff(&self, cutoff_hz: f64) -> Option<Self> {
        Self::with_factor(self.subject, self.factor, cutoff_hz)
    }

    fn with_factor(subject: &'a Subject<'a>, factor: usize, cutoff_hz: f64) -> Option<Self> {
        Self::from_torque(subject, &subject.centred_torque_in_window()?, factor, cutoff_hz).ok()
    }

    fn from_torque(
        subject: &'a Subject<'a>,
        torque: &Series,
        factor: usize,
        cutoff_hz: f64,
    ) -> Result<Self, SignalError> {
        let (window, rate) = (subject.signal.window.clone(), subject.sample_rate_hz);
        let base = subject.all;
        let stride = ((rate / (SAMPLES_PER_PERIOD * cutoff_hz)) as usize).max(window.len().div_ceil(MOST_SAMPLES));
        let stride = stride.clamp(1, factor);
        let motion = band_pass(subject.position, rate, subject.signal.filter_order, cutoff_hz, Derivative::Central)?;
        let first = Decimator::new(stride, window.len())?;
        let samples: Vec<usize> = first.kept().map(|k| k + window.start).collect();
        let motion = motion_at(&motion, &samples);
        let decimator = Decimator::new((factor as f64 / stride as f64).round() as usize, samples.len())?;
        let decimator = decimator.leaving_out(&thinned(subject.left_out, &first, stride));
        let torque = decimator.filter(&first.decimate(torque)?)?;
        let rows = decimator.rows() * subject.position.channels();
        let work = rows as f64 * (base.len() as f64).powi(2);
        let spare = rows / (FEWEST_ROWS_PER_PARAMETER * base.len()).max(1);
        let every = ((work / MOST_WORK).ceil() as usize).min(spare).max(1);
        let kept = decimator.kept().step_by(every).collect();
        let regressor = Regressor::new(subject.model, &base.columns());
        let rate_hz = rate / stride as f64;
        let (fit, corrected) = (OnceCell::new(), false);
        Ok(Self { subject, base, motion, torque, decimator, rate_hz, kept, every, factor, regressor, fit, corrected })
    }

    /// The recording as corrected so far, for a fit of the estimated parameters.
    pub(in crate::checks) fn with_estimated_parameters(&self) -> Self {
        let Subject { model, base, .. } = *self.subject;
        if base.columns() == self.base.columns() {
            return self.clone();
        }
        Self { base, regressor: Regressor::new(model, &base.columns()), fit: OnceCell::new(), ..self.clone() }
    }

    /// Whether there are enough rows for checks of a fit of so many columns.
    pub(in crate::checks) fn has_rows_for(&self, columns: usize) -> bool {
        self.rows() * self.coordinates() >= ROWS_PER_COLUMN * columns
    }

    /// Number of parameters.
    pub(in crate::checks) fn parameters(&self) -> usize {
        self.base.len()
    }

    /// Samples of the thinned recording from one row to the next, before rows are left out.
    pub(in crate::checks) fn steps_per_row(&self) -> usize {
        match self.kept[..] {
            [first, second, ..] => (second - first) / self.every,
            _ => 1,
        }
    }

    /// Rows of a coordinate in a second, where none is left out.
    pub(in crate::checks) fn rows_per_second(&self) -> f64 {
        self.rate_hz / (self.steps_per_row() * self.every) as f64
    }

    /// The times of stretches of rows for which a condition holds, s from the start of the recording, to a hundredth.
    pub(in crate::checks) fn times_where(&self, condition: impl Fn(usize) -> bool) -> Vec<[f64; 2]> {
        let at_start = self.subject.signal.window.start as f64 / self.subject.sample_rate_hz;
        let time = |row: usize| (100.0 * (at_start + self.kept[row] as f64 / self.rate_hz)).round() / 100.0;
        let stretches = stretches_where(0..self.rows(), condition);
        stretches.into_iter().map(|rows| [time(rows.start), time(rows.end - 1)]).collect()
    }

    pub(in crate::checks) fn coordinates(&self) -> usize {
        self.torque.channels()
    }

    /// Rows of a coordinate.
    pub(in crate::checks) fn rows(&self) -> usize {
        self.kept.len()
    }

    /// Whether there are enough rows for statistics.
    pub(in crate::checks) fn is_long_enough(&self) -> bool {
        self.rows() >= FEWEST_ROWS
    }

    /// Corrects the recording.
    pub(in crate::checks) fn correct(&mut self, correction: &Affine) {
        self.motion = correction.motion(&self.motion);
        self.torque = correction.torque(&self.torque);
        self.corrected = true;
        self.fit = OnceCell::new();
    }

    /// Replaces the recorded torques.
    pub(in crate::checks) fn replace_torque(&mut self, torque: Series) {
        self.torque = torque;
        self.corrected = true;
        self.fit = OnceCell::new();
    }

    /// Whether the recording was corrected.
    pub(in crate::checks) fn is_corrected(&self) -> bool {
        self.corrected
    }

    /// A corrected copy.
    pub(in crate::checks) fn corrected(&self, correction: &Affine) -> Self {
        let mut other = self.clone();
        other.correct(correction);
        other
    }

    /// The fit of the recording as corrected so far, computed once.
    pub(in crate::checks) fn fit(&self) -> Result<Rc<OrthogonalFit>, SignalError> {
        if let Some(fit) = self.fit.get() {
            return Ok(Rc::clone(fit));
        }
        let fit = Rc::new(OrthogonalFit::new(&self.regression()?));
        Ok(Rc::clone(self.fit.get_or_init(|| fit)))
    }

    /// The fit with further columns in addition to those of the parameters, without some rows.
    pub(in crate::checks) fn fit_with_columns(
        &self,
        columns: &Matrix,
        left_out: &[bool],
    ) -> Result<OrthogonalFit, SignalError> {
        let regression = self.regression()?;
        let all = Matrix::side_by_side(&[&regression.x, columns]);
        Ok(OrthogonalFit::without(&regression.with_matrix(all), left_out))
    }

    /// The rows of the recording as corrected so far, without weights.
    pub(in crate::checks) fn regression(&self) -> Result<Regression, SignalError> {
        self.regression_of(self.subject.model, &self.base.columns())
    }

    /// The same for some columns of another model of the robot.
    pub(in crate::checks) fn regression_of(&self, model: &Model, columns: &[usize]) -> Result<Regression, SignalError> {
        let assembly = Assembly::new(model, columns, self.decimator.clone());
        let Motion { q, dq, ddq } = &self.motion;
        let x = assembly.observation_matrix(q, dq, ddq, Sign::Exact)?;
        let all = self.decimator.rows();
        let used: Vec<bool> = (0..x.rows()).map(|i| (i % all).is_multiple_of(self.every)).collect();
        let x = if self.every == 1 { x } else { x.select_rows(&used) };
        let layout = RowLayout::new(self.coordinates(), &[self.rows()]);
        Ok(Regression::new(x, self.stack(&self.torque), layout))
    }

    /// Whether each row counts where rests do not: those of a coordinate that stands for more than a part of the time are left out where it
    /// is near rest, or is so within the memory of the rows' filter.
    pub(in crate::checks) fn rows_without_long_rests(&self, part: f64) -> Vec<bool> {
        let memory = MEMORY_ROWS * self.steps_per_row();
        let of_coordinate = |j: usize| {
            let speeds: Vec<f64> = self.motion.dq.channel(j).into_iter().map(f64::abs).collect();
            let limit = NEAR_REST * speeds.iter().copied().fold(0.0, f64::max);
            let stands = speeds.iter().filter(|speed| **speed <= limit).count() as f64 > part * speeds.len() as f64;
            let last = speeds.len();
            let around = move |k: usize| k.saturating_sub(memory)..(k + memory + 1).min(last);
            self.kept.iter().map(move |&k| !stands || speeds[around(k)].iter().all(|speed| *speed > limit))
        };
        (0..self.coordinates()).flat_map(of_coordinate).collect()
    }

    /// Whether the motion separates all parameters.
    pub(in crate::checks) fn has_full_rank(&self) -> bool {
        self.fit().is_ok_and(|r| r.rank == r.x.columns())
    }

    /// The rows of a series that is already low-passed, coordinate by coordinate.
    pub(in crate::checks) fn stack(&self, series: &Series) -> Vec<f64> {
        (0..series.channels()).flat_map(|j| self.kept.iter().map(move |&k| series.sample(k)[j])).collect()
    }

    /// The rows of one channel of a series that is already low-passed.
    pub(in crate::checks) fn stack_channel(&self, series: &Series, channel: usize) -> Vec<f64> {
        self.kept.iter().map(|&k| series.sample(k)[channel]).collect()
    }

    /// The channels of a series as columns, low-passed like the rows; `None` if they are linearly dependent.
    pub(in crate::checks) fn columns_of(&self, series: &Series) -> Option<Matrix> {
        let filtered = self.decimator.filter(series).ok()?;
        let rows = self.stack(&filtered);
        let height = self.rows();
        let columns = Matrix::from_fn(height, series.channels(), |i, c| rows[c * height + i]);
        (PivotedQr::new(&columns).rank(DEPENDENT) == series.channels()).then_some(columns)
    }

    /// The rows of coordinate `j`.
    pub(in crate::checks) fn rows_of<'r>(&self, rows: &'r [f64], j: usize) -> &'r [f64] {
        &rows[j * self.rows()..(j + 1) * self.rows()]
    }

    /// The torques of a motion with parameters `theta`, not filtered.
    pub(in crate::checks) fn predict(&self, motion: &Motion, theta: &[f64]) -> Series {
        let Motion { q, dq, ddq } = motion;
        self.regressor.torques(self.subject.model, [q, dq, ddq], Sign::Exact, theta)
    }

    /// Standard deviation of each joint's predicted friction, relative to that of the rest of its torque.
    pub(in crate::checks) fn friction_share(&self, theta: &[f64]) -> Vec<f64> {
        let part = |friction: bool| {
            let own = |(c, t): (usize, &f64)| if self.is_friction(c) == friction { *t } else { 0.0 };
            self.predict(&self.motion, &theta.iter().enumerate().map(own).collect::<Vec<_>>())
        };
        let (friction, rest) = (part(true), part(false));
        (0..self.coordinates()).map(|j| deviation(&friction.channel(j)) / deviation(&rest.channel(j))).collect()
    }

    /// Whether a column is friction.
    pub(in crate::checks) fn is_friction(&self, column: usize) -> bool {
        self.quantity(column).is_friction()
    }

    fn quantity(&self, column: usize) -> Quantity {
        let kept = self.base.parameters()[column].kept;
        self.subject.model.parameter_table().get(kept).quantity
    }

    /// The regression of a motion and its torques, not filtered: for hypotheses with large effects.
    pub(in crate::checks) fn unfiltered_regression(&self, motion: &Motion, torque: &Series) -> Regression {
        let phi = self.regressor.evaluate_series(self.subject.model, &motion.q, &motion.dq, &motion.ddq, Sign::Exact);
        let rows = phi.len();
        let mut x = Matrix::zeros(rows * self.coordinates(), self.regressor.columns());
        for (e, entry) in self.regressor.entries().iter().enumerate() {
            for k in 0..rows {
                *x.at_mut(entry.joint * rows + k, entry.column) = phi.sample(k)[e];
            }
        }
        let y = (0..torque.channels()).flat_map(|j| torque.channel(j)).collect();
        Regression::new(x, y, RowLayout::new(self.coordinates(), &[rows]))
    }
}

/// The decimation that leaves about [`ENOUGH_ROWS`], or a smaller one that keeps the band of the position filter.
fn bounded_factor(samples: usize, rate: f64, cutoff_hz: f64) -> usize {
    let keeps_the_band = (0.4 * rate / (2.0 * cutoff_hz)) as usize;
    keeps_the_band.min(samples / ENOUGH_ROWS)
}

/// The samples of a motion with given indices.
pub(in crate::checks) fn motion_at(motion: &Motion, samples: &[usize]) -> Motion {
    let Motion { q, dq, ddq } = motion;
    Motion { q: at(q, samples), dq: at(dq, samples), ddq: at(ddq, samples) }
}

/// The samples of a series with given indices.
pub(in crate::checks) fn at(series: &Series, samples: &[usize]) -> Series {
    let values = samples.iter().flat_map(|&k| series.sample(k).iter().copied()).collect();
    Series::shaped(series.channels(), values)
}
