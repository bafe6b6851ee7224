//! Drive gains from recordings with and without a known payload.
//!
//! A drive's recorded torque is `s = k (phi theta + p) + e`, with the known torque p of the payload and `k` one over the gain
//! that the recorded torque lacks. Joint by joint, `s - p = phi (k theta) + (k - 1) p + e`: least squares with noise on the
//! left side only, which is the maximum-likelihood estimate of the joint, and no total least squares is needed. What the
//! parameters of the robot can mimic of p gives no information about k: recordings without the payload separate the two (M. Gautier,
//! S. Briot, "Global identification of joint drive gains and dynamic parameters of robots", 2014).

use crate::{
    preparation::{PreparationError, Problem},
    run::identification::Identification,
};
use thetahat_estimation::{
    identification::{Method, idim_ls, uncertainty},
    regression::{Regression, RowLayout},
};
use thetahat_ground::{
    linear_algebra::{Matrix, PivotedQr},
    series::Series,
};
use thetahat_report::results::DriveGainResult;

/// Size of a diagonal entry of R, relative to the largest, below which a column depends on others.
const RANK_TOLERANCE: f64 = 1e-10;
/// Half the width of an interval, relative to the gain, above which the payload does not identify it.
const TOO_WIDE: f64 = 0.25;

impl Identification {
    /// The gain of each joint's drive; empty unless some of the recordings carry a known payload, and not all the same one.
    pub(crate) fn drive_gains(&self, problem: &Problem) -> Result<Vec<DriveGainResult>, PreparationError> {
        let mut names: Vec<_> = self.main.iter().map(|p| p.filtered.recording.payload.as_deref()).collect();
        names.sort_unstable();
        names.dedup();
        if names.len() < 2 {
            return Ok(Vec::new());
        }
        let mut vectors = Vec::with_capacity(self.main.len());
        for (number, prepared) in self.main.iter().enumerate() {
            let filtered = &prepared.filtered;
            let none = || Series::zeros(filtered.window.len(), problem.model.coordinate_count());
            let torque = filtered.payload_torque.as_ref().map_or_else(none, |t| t.window(filtered.window.clone()));
            let assembly = problem.assembly_of(number, &problem.model, &[]);
            vectors.push(assembly.measurement_vector(&torque)?);
        }
        let payload = problem.regression.layout.stack_vectors(vectors);
        let names = self.setup().robot.coordinates().map(|j| j.name.clone());
        Ok(names.enumerate().map(|(joint, name)| self.drive_gain(problem, &payload, (joint, name))).collect())
    }

    fn drive_gain(&self, problem: &Problem, payload: &[f64], (joint, name): (usize, String)) -> DriveGainResult {
        let all = problem.all_columns();
        let rows: Vec<usize> = all.layout.rows_of_joint(joint).collect();
        let payload: Vec<f64> = rows.iter().map(|&k| payload[k]).collect();
        let loaded = payload.iter().filter(|v| **v != 0.0).count().max(1);
        let payload_rms = (payload.iter().map(|v| v * v).sum::<f64>() / loaded as f64).sqrt();
        let result = |found: Result<Gain, String>| {
            let none = DriveGainResult {
                joint: name.clone(),
                factor: None,
                standard_deviation: None,
                interval_95: None,
                payload_rms,
                reason: None,
            };
            match found {
                Err(reason) => DriveGainResult { reason: Some(reason), ..none },
                Ok(Gain { factor, standard_deviation, interval_95 }) => DriveGainResult {
                    factor: Some(factor),
                    standard_deviation: Some(standard_deviation),
                    interval_95: Some(interval_95),
                    ..none
                },
            }
        };
        if self.setup().robot.transmission.has_several_motors(joint) {
            return result(Err("its torque comes from several motors".to_owned()));
        }
        let acts = |c: usize| rows.iter().any(|&k| all.x.at(k, c) != 0.0);
        let acting: Vec<usize> = (0..all.x.columns()).filter(|&c| acts(c)).collect();
        let x = Matrix::from_fn(rows.len(), acting.len(), |k, c| all.x.at(rows[k], acting[c]));
        let y: Vec<f64> = rows.iter().map(|&k| all.y[k]).collect();
        let rows_of_recordings: Vec<usize> =
            (0..all.layout.recordings()).map(|r| all.layout.block(joint, r).len()).collect();
        result(Gain::of(&x, &payload, y, RowLayout::new(1, &rows_of_recordings)))
    }
}

/// A gain with its interval.
struct Gain {
    factor: f64,
    standard_deviation: f64,
    interval_95: [f64; 2],
}

impl Gain {
    /// From the columns of the robot that act on a joint, the payload's torque p, and the recorded torque less p.
    fn of(x: &Matrix, payload: &[f64], y: Vec<f64>, layout: RowLayout) -> Result<Self, String> {
        let qr = PivotedQr::with_equal_columns(x);
        let independent = &qr.pivots()[..qr.rank(RANK_TOLERANCE)];
        let column = Matrix::from_fn(payload.len(), 1, |k, _| payload[k]);
        let x = Matrix::side_by_side(&[&x.select_columns(independent), &column]);
        let regression = Regression::new(x, y, layout);
        let not_loaded = || "the payload does not load it, or only as the robot's own parameters do".to_owned();
        let fit = idim_ls(&regression, Default::default()).map_err(|_| not_loaded())?;
        let found = uncertainty(Method::IDIM_LS, &regression, None, &fit).map_err(|e| e.to_string())?;
        let last = independent.len();
        let inverse = 1.0 + fit.theta[last];
        let [low, high] = found.interval_95[last].map(|end| 1.0 + end);
        let half_width_percent = 50.0 * (high - low) / inverse.abs();
        if inverse.is_nan() || low <= 0.0 || half_width_percent > 100.0 * TOO_WIDE {
            return Err(format!("the payload determines it to {half_width_percent:.0} % only"));
        }
        let factor = 1.0 / inverse;
        let standard_deviation = factor * factor * found.standard_deviation[last];
        Ok(Self { factor, standard_deviation, interval_95: [1.0 / high, 1.0 / low] })
    }
}
