//! The identified robot: its torque, and what each change adds to it.

use std::path::Path;

use super::{
    error::WatchError,
    layout::{CURVE, Layout, OWN, PAYLOAD},
    step::Row,
};
use crate::{
    experiment::{EstimateRequest, Experiment, ExperimentError, IdentifiedRobot},
    preparation::{PositionFilter, SignalOptions},
};
use thetahat_estimation::signal::CausalBandPass;
use thetahat_ground::linear_algebra::Matrix;
use thetahat_model::{
    base_parameters::BaseParameter,
    dynamics::{FrictionTransition, Model, Sign, State, Workspace},
    regressor::Regressor,
    robot::JointKind,
};
use thetahat_report::results::{JointResult, ParameterResult, Results, Verdict, VerdictReason};

/// Scales of the friction's transition at which its sign is known: `tanh(4) = 0.9993`.
const SCALES: f64 = 4.0;
/// Part of the sample rate over the decimation that a smoother's motion is filtered at: the band of the rows.
const SMOOTHER: f64 = 1.0;
/// Rest velocities over which the curves of friction near rest fall by a factor e.
const NEAR_REST: [f64; 3] = [2.0, 6.0, 20.0];

/// A robot with the parameters that were identified.
#[derive(Debug, Clone)]
pub struct WatchedRobot {
    identified: IdentifiedRobot,
    model: Model,
    regressor: Regressor,
    /// Parameters of the regressor's first columns; the payload's follow.
    theta: Vec<f64>,
    /// The place of each regressor's column in a row; `None` of friction and of what was given.
    places: Vec<Option<usize>>,
    layout: Layout,
    /// Covariance of the model's parameters in a row.
    covariance: Matrix,
    sign: Sign,
    /// Whether each joint turns or slides.
    kinds: Vec<JointKind>,
    rest_velocity: Vec<f64>,
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
        let (last, joints) = (model.link_count(), model.coordinate_count());
        let uncertain = Uncertain::of(&identified, &own_names(joints));
        let layout = Layout { joints, model: uncertain.columns.len() };
        let mut places = vec![None; columns.len()];
        (layout.of_joint() - layout.model..)
            .zip(&uncertain.columns)
            .for_each(|(place, column)| places[*column] = Some(place));
        for (place, name) in (OWN..).zip(PAYLOAD) {
            if let Some(column) = table.index_of(&format!("{name}{last}")) {
                columns.push(column);
                places.push(Some(place));
            }
        }
        let transition = match &identified.model {
            Some(model) => model.transition(),
            None => FrictionTransition::of_all(identified.settings.simulation.sign_velocity_scale),
        };
        let sign = identified.model.as_ref().map_or(Sign::Exact, |_| Sign::Smooth(transition));
        let regressor = Regressor::new(&model, &columns);
        let kinds = model.coordinate_kinds();
        let settled: Vec<f64> = kinds.iter().map(|kind| SCALES * transition.of(*kind)).collect();
        let rest_velocity = rest_velocity(results, &settled);
        let covariance = uncertain.covariance;
        Self { identified, model, regressor, theta, places, layout, covariance, sign, kinds, rest_velocity }
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
        Scratch {
            workspace: Workspace::new(&self.model),
            phi: vec![0.0; self.regressor.entries().len()],
            before: Vec::new(),
        }
    }

    pub(super) fn layout(&self) -> Layout {
        self.layout
    }

    /// The covariance of the model's parameters without friction and offsets.
    pub(super) fn covariance(&self) -> &Matrix {
        &self.covariance
    }

    /// The rows of an instant from its motion and measured torques.
    pub(super) fn rows(
        &self,
        [q, dq, ddq]: [&[f64]; 3],
        torque: &[f64],
        sample_s: f64,
        scratch: &mut Scratch,
        rows: &mut [Row],
    ) {
        let Scratch { workspace, phi, .. } = scratch;
        self.regressor.evaluate(&self.model, State::new(q, dq), ddq, self.sign, workspace, phi);
        for (j, row) in rows.iter_mut().enumerate() {
            let sign = self.sign.of(dq[j], self.kinds[j]);
            (row.y, row.friction, row.square) = (torque[j], sign, torque[j].powi(2));
            row.x.fill(0.0);
            row.x[..OWN].copy_from_slice(&[dq[j], sign, 1.0]);
            let curve = &mut row.x[OWN + PAYLOAD.len()..][..CURVE];
            for (curve, times) in curve.iter_mut().zip(NEAR_REST) {
                *curve = sign * (-dq[j].abs() / (times * self.rest_velocity[j])).exp();
            }
            curve[CURVE - 2] = dq[j].abs();
        }
        for (entry, value) in self.regressor.entries().iter().zip(phi.iter()) {
            if let Some(theta) = self.theta.get(entry.column) {
                rows[entry.joint].y -= value * theta;
            }
            if let Some(place) = self.places[entry.column] {
                rows[entry.joint].x[place] = *value;
            }
        }
        for (j, row) in rows.iter_mut().enumerate() {
            let now = torque[j] - row.y;
            let before = scratch.before.get(j).copied().unwrap_or(now);
            row.x[OWN + PAYLOAD.len() + CURVE - 1] = (now - before) / sample_s;
        }
        scratch.before.clear();
        scratch.before.extend(rows.iter().zip(torque).map(|(row, torque)| torque - row.y));
    }
}

/// Names of the joints' own friction and offsets.
fn own_names(joints: usize) -> Vec<String> {
    (1..=joints).flat_map(|j| ["fv", "fc", "off"].map(|name| format!("{name}{j}"))).collect()
}

/// Parameters that the recordings know within a covariance.
struct Uncertain {
    /// Their columns among those of the base parameters.
    columns: Vec<usize>,
    covariance: Matrix,
}

impl Uncertain {
    /// Those of a robot without some.
    fn of(identified: &IdentifiedRobot, without: &[String]) -> Self {
        let run = &identified.run;
        let deviation = |p: usize| {
            let ParameterResult { standard_deviation_robust, standard_deviation, .. } = run.parameters[p];
            standard_deviation_robust.or(standard_deviation).unwrap_or(0.0)
        };
        let count = run.parameters.len();
        let deviations_alone = || Matrix::from_fn(count, count, |i, k| if i == k { deviation(i).powi(2) } else { 0.0 });
        let all = Matrix::from_lower_half(count, &run.covariance).unwrap_or_else(deviations_alone);
        let found = |(column, parameter): (usize, &BaseParameter)| {
            let place = run.parameters.iter().position(|p| p.name == parameter.name)?;
            let is_own = without.contains(&parameter.name);
            (!is_own && all.at(place, place) > 0.0).then_some((column, place))
        };
        let (columns, places): (Vec<_>, Vec<_>) =
            identified.base.parameters().iter().enumerate().filter_map(found).unzip();
        let covariance = Matrix::from_fn(places.len(), places.len(), |i, k| all.at(places[i], places[k]));
        Self { columns, covariance }
    }
}

/// The largest limit of the identification's recordings, which knows the noise of velocities, and of the friction's transition.
fn rest_velocity(results: &Results, of_friction: &[f64]) -> Vec<f64> {
    let of_recordings = results.recordings.iter().filter_map(|recording| recording.near_rest.as_ref());
    let of_recordings: Vec<&Vec<f64>> = of_recordings.map(|rest| &rest.velocity).collect();
    let limit =
        |(j, own): (usize, &f64)| of_recordings.iter().filter_map(|limits| limits.get(j)).copied().fold(*own, f64::max);
    of_friction.iter().enumerate().map(limit).collect()
}

/// Memory of [`WatchedRobot::rows`].
#[derive(Debug)]
pub(super) struct Scratch {
    workspace: Workspace,
    phi: Vec<f64>,
    /// The model's torques of the sample before; empty after a gap.
    before: Vec<f64>,
}

impl Scratch {
    pub(super) fn restart(&mut self) {
        self.before.clear();
    }
}
