//! Times at which nothing drives the robot: brakes hold it, or its motors are off.

use std::ops::Range;

use super::{Recording, Setup};
use thetahat_ground::{series::Series, stretches::stretches_where};
use thetahat_model::dynamics::{DynamicParameters, Model, Sign, State, Workspace};

/// Means of torques over the shortest time below this part of each joint's root mean square are noise.
const NO_TORQUE: f64 = 0.05;
/// Distances of positions below this part of each joint's whole range are rest.
const NO_MOTION: f64 = 0.01;
/// Part of a joint's root mean square torque that gravity asks for, from which there is no reason for a torque of zero.
const GRAVITY: f64 = 0.2;
/// Shortest time that counts, s.
const SHORTEST_S: f64 = 0.3;

impl Setup<'_> {
    /// The samples at which all torques are zero, and the robot stands or comes to rest where gravity of the described links would move it.
    pub(super) fn unpowered(&self, recording: &Recording, window: &Range<usize>) -> Vec<Range<usize>> {
        let Some(torque) = &recording.torque else { return Vec::new() };
        if self.robot.base_coordinates() > 0 {
            return Vec::new();
        }
        let rms: Vec<f64> = squares(torque, window).iter().map(|square| square.sqrt()).collect();
        let ranges = spans(&recording.position, window);
        let shortest = (SHORTEST_S * recording.sample_rate_hz).ceil() as usize;
        let stands = |at: &Range<usize>| {
            let near = |k: usize, end: usize| {
                let [at, end] = [k, end].map(|k| recording.position.sample(k));
                at.iter().zip(end).zip(&ranges).all(|((at, end), range)| (at - end).abs() <= NO_MOTION * range)
            };
            // Brakes stop a robot that moves, and one that they have held is switched on before it moves.
            let at_end = at.clone().rev().take_while(|k| near(*k, at.end - 1)).count();
            let at_start = at.clone().take_while(|k| near(*k, at.start)).count();
            at_end.max(at_start) >= shortest
        };
        // Where brakes stop the robot, most of the time in which they hold it is not in the window.
        let whole = 0..torque.len();
        let mut found = without_torque(torque, &whole, shortest, &rms);
        found.retain(stands);
        if found.is_empty() {
            return found;
        }
        let model = Model::new(self.robot);
        let falls = |at: &Range<usize>| {
            let gravity = self.gravity(&model, recording.position.sample(at.start + at.len() / 2));
            gravity.iter().zip(&rms).any(|(gravity, rms)| *rms > 0.0 && gravity.abs() > GRAVITY * rms)
        };
        found.retain(falls);
        // Means near its ends have torques of the motion in them.
        let wider = |at: Range<usize>| at.start.saturating_sub(shortest / 2)..at.end + shortest / 2;
        let within = |at: Range<usize>| at.start.max(window.start)..at.end.min(window.end);
        found.into_iter().map(wider).map(within).filter(|at| !at.is_empty()).collect()
    }

    /// The torques with which the described links would be held.
    fn gravity(&self, model: &Model, q: &[f64]) -> Vec<f64> {
        let zero = vec![0.0; q.len()];
        let parameters = DynamicParameters::sorted(model, &self.robot.a_priori_parameters());
        let (mut tau, mut workspace) = (zero.clone(), Workspace::new(model));
        model.inverse_dynamics(&parameters, State::new(q, &zero), &zero, Sign::Exact, &mut workspace, &mut tau);
        tau
    }
}

/// Stretches of at least `shortest` samples over which the means of all torques are zero but for a part of their root mean squares.
fn without_torque(torque: &Series, window: &Range<usize>, shortest: usize, rms: &[f64]) -> Vec<Range<usize>> {
    let (sums, half) = (sums(torque, window), shortest / 2);
    let is_zero = |k: usize| {
        let [from, to] = [k.saturating_sub(half).max(window.start), (k + half + 1).min(window.end)];
        let [before, until] = [from, to].map(|k| sums.sample(k - window.start));
        let means = until.iter().zip(before).map(|(until, before)| (until - before) / (to - from) as f64);
        means.zip(rms).all(|(mean, rms)| mean.abs() <= NO_TORQUE * rms)
    };
    let mut stretches = stretches_where(window.clone(), is_zero);
    stretches.retain(|stretch| stretch.len() >= shortest);
    stretches
}

/// Sums of each channel over the samples before each of a range.
fn sums(series: &Series, at: &Range<usize>) -> Series {
    let mut sums = Series::zeros(at.len() + 1, series.channels());
    for k in at.clone() {
        for j in 0..series.channels() {
            let before = sums.sample(k - at.start)[j];
            sums.sample_mut(k - at.start + 1)[j] = before + series.sample(k)[j];
        }
    }
    sums
}

/// Mean squares of each channel.
fn squares(series: &Series, at: &Range<usize>) -> Vec<f64> {
    let mean = |j: usize| at.clone().map(|k| series.sample(k)[j].powi(2)).sum::<f64>() / at.len().max(1) as f64;
    (0..series.channels()).map(mean).collect()
}

/// From the smallest to the largest value of each channel.
fn spans(series: &Series, at: &Range<usize>) -> Vec<f64> {
    let values = |j: usize| at.clone().map(move |k| series.sample(k)[j]);
    let span = |j: usize| values(j).fold(f64::NEG_INFINITY, f64::max) - values(j).fold(f64::INFINITY, f64::min);
    (0..series.channels()).map(span).collect()
}
