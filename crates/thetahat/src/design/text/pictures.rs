//! What the report draws of a motion: the robot's posture, and the spectrum.

use crate::design::text::description::Design;
use crate::run::skeleton_in;
use thetahat_estimation::signal::Spectrum;
use thetahat_ground::series::Series;
use thetahat_model::dynamics::Model;
use thetahat_report::results::{CollisionResults, MotionSpectrum, Skeleton, SpectrumBound};

/// The parallel filter cuts at this part of the rate of the rows.
const OF_ROWS: f64 = 0.4;
/// Part of the variance below the end of a spectrum.
const MOST: f64 = 0.99;
/// Frequencies are drawn up to this multiple of the highest bound.
const BEYOND: f64 = 1.5;

impl Design {
    /// The robot at the instant of its least distance, or else at the start.
    pub(in crate::design) fn skeleton(
        &self,
        model: &Model,
        q: &Series,
        collision: Option<&CollisionResults>,
    ) -> Option<Skeleton> {
        let nearest = collision.and_then(|c| c.pairs.first()?.at_s).unwrap_or(0.0);
        let sample = ((nearest * self.file.sample_rate_hz).round() as usize).min(q.len() - 1);
        skeleton_in(&self.robot, model, q.sample(sample), &[q])
    }

    /// The spectrum of accelerations, and the cut-offs of the filters and of the controller.
    pub(in crate::design) fn spectrum(&self, ddq: &Series) -> MotionSpectrum {
        let bounds = self.bounds();
        let highest = bounds.iter().map(|b| b.frequency_hz).fold(0.0, f64::max);
        let spectrum = Spectrum::of(ddq, self.file.sample_rate_hz);
        let frequency_hz: Vec<f64> = spectrum.frequencies_hz().take_while(|f| *f <= BEYOND * highest).collect();
        let of_joint = |density: &Vec<f64>| {
            let largest = density.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
            density.iter().take(frequency_hz.len()).map(|d| (d / largest).sqrt()).collect()
        };
        MotionSpectrum {
            of_joints: spectrum.density.iter().map(of_joint).collect(),
            end_hz: spectrum.density.iter().map(|density| end_hz(density, spectrum.step_hz)).collect(),
            frequency_hz,
            bounds,
            position_cutoff_hz: self.file.signal.cutoff_hz,
        }
    }

    fn bounds(&self) -> Vec<SpectrumBound> {
        let signal = &self.file.signal;
        let rows = OF_ROWS * self.file.sample_rate_hz / signal.decimation as f64;
        let bound = |name, frequency_hz| SpectrumBound { name, frequency_hz };
        let loops = self.settings.controller.iter().flat_map(|controller| &controller.bandwidth_hz);
        let slowest = loops.copied().reduce(f64::min).map(|hz| bound("controller", hz));
        let filters = [bound("position filter", signal.cutoff_hz), bound("rows", rows)];
        filters.into_iter().chain(slowest).collect()
    }
}

/// The frequency below which most of the variance lies.
fn end_hz(density: &[f64], step_hz: f64) -> f64 {
    let all: f64 = density.iter().sum();
    let mut sum = 0.0;
    let end = density.iter().position(|d| {
        sum += d;
        sum >= MOST * all
    });
    end.unwrap_or(0) as f64 * step_hz
}
