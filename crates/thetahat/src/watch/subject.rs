//! The identified robot: its torque, and what each change adds to it.

use std::path::Path;

use super::error::WatchError;
use crate::{
    experiment::{EstimateRequest, Experiment, ExperimentError, IdentifiedRobot},
    preparation::{PositionFilter, SignalOptions},
};
use thetahat_estimation::signal::CausalBandPass;
use thetahat_model::{
    dynamics::{Model, Sign, State, Workspace},
    regressor::Regressor,
};
use thetahat_report::results::{JointResult, Results, Verdict, VerdictReason};

/// Scales of the friction's transition at which its sign is known: `tanh(4) = 0.9993`.
const SCALES: f64 = 4.0;
/// Part of the sample rate over the decimation that a smoother's motion is filtered at: the band of the rows.
const SMOOTHER: f64 = 1.0;
/// Names of a payload's parameters in the frame of the last link.
pub(super) const PAYLOAD: [&str; 10] = ["m", "mx", "my", "mz", "xx", "xy", "xz", "yy", "yz", "zz"];
/// Changes that act on one joint: viscous and Coulomb friction and offset of its own, and a payload's.
pub(super) const CHANGES: usize = 3 + PAYLOAD.len();

/// A robot with the parameters that were identified.
#[derive(Debug, Clone)]
pub struct WatchedRobot {
    identified: IdentifiedRobot,
    model: Model,
    regressor: Regressor,
    /// Parameters of the regressor's first columns; the payload's follow.
    theta: Vec<f64>,
    sign: Sign,
    rest_velocity: Vec<f64>,
}

/// Torques of an instant, joint by joint.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Row {
    /// Measured torque less the model's, N m or N.
    pub(super) y: f64,
    /// The torque of a unit of each change.
    pub(super) x: [f64; CHANGES],
    /// The model's Coulomb friction, N m or N.
    pub(super) friction: f64,
    /// The square of the measured torque.
    pub(super) square: f64,
}

/// A drive's identified friction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Friction {
    pub(super) viscous: Option<[f64; 2]>,
    pub(super) coulomb: Option<[f64; 2]>,
}

impl WatchedRobot {
    /// The robot of a `results.json`, with the estimates of the model or of a run.
    ///
    /// # Errors
    /// [`WatchError`] for results that cannot be used, and for a base that floats or torque terms that need recorded channels.
    pub fn read(path: &Path, request: &EstimateRequest) -> Result<Self, WatchError> {
        let results = Results::read(path).map_err(ExperimentError::from)?;
        let identified = IdentifiedRobot::of_results(path, &results, request)?;
        if identified.experiment().is_none() {
            return Err(ExperimentError::OfArrays { path: path.to_owned() }.into());
        }
        let model = Model::new(&identified.robot);
        let not_watched = |needs| WatchError::NotWatched { path: path.to_owned(), needs };
        if identified.robot.base_coordinates() > 0 {
            return Err(not_watched("the pose of a base that floats"));
        }
        if !model.channels().is_empty() {
            return Err(not_watched("recorded channels"));
        }
        Ok(Self::of(identified, model, &results))
    }

    fn of(identified: IdentifiedRobot, model: Model, results: &Results) -> Self {
        let table = model.parameter_table();
        let base = identified.base.parameters().iter().map(|parameter| parameter.kept).zip(identified.estimates());
        let fixed = &identified.settings.parameters.fix;
        let fixed = fixed.iter().filter_map(|(name, value)| Some((table.index_of(name)?, *value)));
        let (mut columns, theta): (Vec<usize>, Vec<f64>) = base.chain(fixed).unzip();
        let last = model.link_count();
        columns.extend(PAYLOAD.iter().filter_map(|name| table.index_of(&format!("{name}{last}"))));
        let transition = match &identified.model {
            Some(model) => model.friction_transition,
            None => identified.settings.simulation.sign_velocity_scale,
        };
        let sign = identified.model.as_ref().map_or(Sign::Exact, |_| Sign::Smooth { scale: transition });
        let regressor = Regressor::new(&model, &columns);
        let rest_velocity = rest_velocity(results, SCALES * transition, model.coordinate_count());
        Self { identified, model, regressor, theta, sign, rest_velocity }
    }

    /// Number of its coordinates.
    #[must_use]
    pub fn joint_count(&self) -> usize {
        self.model.coordinate_count()
    }

    /// Its joints.
    #[must_use]
    pub fn joints(&self) -> Vec<JointResult> {
        JointResult::of_coordinates(&self.identified.robot)
    }

    /// Method, case and verdict in a line.
    #[must_use]
    pub fn origin(&self) -> String {
        self.identified.origin()
    }

    /// The verdict on its results.
    #[must_use]
    pub fn verdict(&self) -> (Verdict, &[VerdictReason]) {
        (self.identified.verdict, &self.identified.verdict_reasons)
    }

    /// The experiment that it was identified in.
    pub(super) fn experiment(&self) -> Option<&Experiment> {
        self.identified.experiment()
    }

    /// The results that it was read from.
    pub(super) fn path(&self) -> &Path {
        self.identified.files.first().map_or(Path::new("results"), std::path::PathBuf::as_path)
    }

    /// Velocity of each joint below which the sign of its friction is not known, rad/s or m/s.
    pub(super) fn rest_velocity(&self) -> &[f64] {
        &self.rest_velocity
    }

    /// The cut-off of the positions, Hz: that of the identification; with the smoother, which finds its own, the band of the rows.
    pub(super) fn cutoff_hz(&self, sample_rate_hz: f64) -> f64 {
        let SignalOptions { position, cutoff_hz, decimation, .. } = self.identified.settings.signal;
        match position {
            PositionFilter::Butterworth => cutoff_hz,
            PositionFilter::Smoother => SMOOTHER * sample_rate_hz / decimation as f64,
        }
    }

    /// The identification's filter of the positions, with a delay.
    pub(super) fn filter(&self, sample_rate_hz: f64) -> Result<CausalBandPass, WatchError> {
        let SignalOptions { filter_order, derivative, .. } = self.identified.settings.signal;
        let cutoff_hz = self.cutoff_hz(sample_rate_hz);
        CausalBandPass::new(self.joint_count(), sample_rate_hz, filter_order, cutoff_hz, derivative)
            .map_err(|source| WatchError::Signal { path: self.path().to_owned(), source })
    }

    /// The friction of a joint's drive, with deviations, where it was identified.
    pub(super) fn friction(&self, joint: usize) -> Friction {
        let of = |name: &str| {
            let parameter = self.identified.run.parameter(&format!("{name}{}", joint + 1))?;
            Some([parameter.estimate, parameter.standard_deviation_robust.or(parameter.standard_deviation)?])
        };
        Friction { viscous: of("fv"), coulomb: of("fc") }
    }

    pub(super) fn scratch(&self) -> Scratch {
        Scratch { workspace: Workspace::new(&self.model), phi: vec![0.0; self.regressor.entries().len()] }
    }

    /// The rows of an instant from its motion and measured torques.
    pub(super) fn rows(&self, [q, dq, ddq]: [&[f64]; 3], torque: &[f64], scratch: &mut Scratch, rows: &mut [Row]) {
        let Scratch { workspace, phi } = scratch;
        self.regressor.evaluate(&self.model, State::new(q, dq), ddq, self.sign, workspace, phi);
        for (j, row) in rows.iter_mut().enumerate() {
            let sign = self.sign.of(dq[j]);
            *row = Row { y: torque[j], x: [0.0; CHANGES], friction: sign, square: torque[j].powi(2) };
            row.x[..3].copy_from_slice(&[dq[j], sign, 1.0]);
        }
        for (entry, value) in self.regressor.entries().iter().zip(phi.iter()) {
            match self.theta.get(entry.column) {
                Some(theta) => rows[entry.joint].y -= value * theta,
                None => rows[entry.joint].x[3 + entry.column - self.theta.len()] = *value,
            }
        }
    }
}

/// The largest limit of the identification's recordings, which knows the noise of velocities, and of the friction's transition.
fn rest_velocity(results: &Results, of_friction: f64, joints: usize) -> Vec<f64> {
    let of_recordings = results.recordings.iter().filter_map(|recording| recording.near_rest.as_ref());
    let of_recordings: Vec<&Vec<f64>> = of_recordings.map(|rest| &rest.velocity).collect();
    let limit = |j: usize| of_recordings.iter().filter_map(|limits| limits.get(j)).copied().fold(of_friction, f64::max);
    (0..joints).map(limit).collect()
}

/// Memory of [`WatchedRobot::rows`].
#[derive(Debug)]
pub(super) struct Scratch {
    workspace: Workspace,
    phi: Vec<f64>,
}
