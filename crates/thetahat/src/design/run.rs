//! The steps of a design: limits, searches, verification, prediction.

use std::ops::ControlFlow;

use crate::design::{
    error::DesignError,
    limits::{joint_limits::JointLimits, loads::Loads, verified::Verified},
    motions::{family::Motions, sums::Derivatives},
    prediction::{
        expected::{Expected, ExpectedRecording},
        prior_data::Compared,
    },
    search::{
        optimiser::Problem,
        searches::{Searches, Start, sign_scales},
        watch::{Descents, DesignProgress, Watch},
    },
    text::{description::Design, validation::WHOLE},
};
use thetahat_estimation::trajectory::Moves;
use thetahat_ground::series::Series;
use thetahat_model::{
    base_parameters::BaseParameters,
    dynamics::{Model, Sign},
};
use thetahat_report::results::{DesignResults, PredictedGain, PredictedTorques, TrajectoryPoints};

/// Points per second for controllers whose rate the design does not state.
const POINTS_HZ: f64 = 125.0;

/// The predicted intervals, and what they are compared with.
pub(in crate::design) struct Forecast {
    pub(in crate::design) expected: Expected,
    /// For what stays unknown: how many times narrower its interval is with a motion for it.
    pub(in crate::design) remedies: Vec<Option<f64>>,
    /// Of the drive gains, with a second recording without the payload.
    pub(in crate::design) gains: Vec<PredictedGain>,
    pub(in crate::design) compared: Option<Compared>,
    /// Recording time for the wanted half width of each parameter, s.
    pub(in crate::design) seconds: Vec<Option<f64>>,
    /// Whether `seconds` adds to earlier recordings.
    pub(in crate::design) knows_earlier: bool,
    pub(in crate::design) torques: Option<PredictedTorques>,
}

/// A motion within its limits.
pub(in crate::design) struct FeasibleMotion {
    pub(in crate::design) motion: Derivatives,
    /// For files of trajectories, and for `points.csv`.
    pub(in crate::design) points: [TrajectoryPoints; 2],
    pub(in crate::design) torque: Series,
    pub(in crate::design) verified: Verified,
    pub(in crate::design) starts: Vec<Start>,
    /// The moves, if the motion consists of moves.
    pub(in crate::design) moves: Option<Moves>,
    /// The criterion if the last earlier recording were repeated.
    pub(in crate::design) repeated: Option<f64>,
    /// Descents that had ended when the search was stopped, and all of them.
    pub(in crate::design) stopped_after: Option<[usize; 2]>,
}

impl Design {
    /// Searches the best motion, verifies its limits at 1 kHz, and predicts the intervals of the parameters.
    ///
    /// The result does not depend on the number of `threads`.
    ///
    /// # Errors
    /// [`DesignError`] if no motion within the limits identifies every parameter, or a limit cannot hold.
    pub fn run(&self, threads: usize) -> Result<DesignResults, DesignError> {
        self.run_watched(threads, &|_| ControlFlow::Continue(()))
    }

    /// The same with its progress shown. Once `show` breaks, searches end with the best motion so far, which is verified and predicted.
    ///
    /// # Errors
    /// As [`Design::run`].
    #[doc(hidden)]
    pub fn run_watched(
        &self,
        threads: usize,
        show: &(dyn Fn(&DesignProgress) -> ControlFlow<()> + Sync),
    ) -> Result<DesignResults, DesignError> {
        let watch = Watch::new(show);
        let limits = self.limits()?;
        let model = Model::new(&self.robot);
        let base = BaseParameters::with_fixed(&model, &self.settings.parameters.exclude, &self.settings.parameters.fix)
            .map_err(|source| DesignError::BaseParameters { path: self.path.clone(), source })?;
        let compared = self.compared(threads, &watch)?;
        let problem = self.problem(&model, &base, &limits)?;
        self.verify_sweeps(&model, &problem.watched, &limits)?;
        let chosen = self.choose(&model, &problem, &limits, (threads, &watch))?;
        watch.stage("predicting intervals");
        let [loaded, unloaded] = self.true_motions(&model, &chosen)?;
        let noise = self.position_noise();
        let recording = self.expected_recording(&loaded, &noise);
        let expected = recording.predict(&self.path, self.file.motion.seed, threads)?;
        let gains = match self.payload() {
            Some(_) => {
                let unloaded = self.expected_recording(&unloaded, &noise);
                recording.gains(&unloaded, &self.path, self.file.motion.seed, threads)?
            }
            None => Vec::new(),
        };
        let remedies = self.remedies((&problem, &base, &limits), &chosen.motion, &expected, (threads, &watch));
        let wanted = self.wanted_torques(&model, &base)?;
        let torques = wanted.and_then(|wanted| self.predicted_torques(&wanted, &problem, &chosen.motion));
        let seconds = self.recording_times(&base, &problem, &chosen.motion, &expected);
        let knows_earlier = problem.information.prior().is_some();
        let forecast = Forecast { expected, remedies, gains, compared, seconds, knows_earlier, torques };
        self.results(&model, &base, chosen, forecast)
    }

    /// The best motion of the searches that holds its limits.
    fn choose(
        &self,
        model: &Model,
        problem: &Problem,
        limits: &[JointLimits],
        (threads, watch): (usize, &Watch<'_>),
    ) -> Result<FeasibleMotion, DesignError> {
        let motion = &self.file.motion;
        let searches = Searches { count: motion.starts, seed: motion.seed, threads, sign_scales: sign_scales(limits) };
        let descents = Descents::new(watch, "searching motions", searches.descents(problem));
        let mut starts = searches.run(problem, &descents);
        let stopped_after = descents.stopped_after();
        starts.sort_by(|a, b| a.value.total_cmp(&b.value));
        let mut first_error = None;
        for k in 0..starts.len() {
            match self.repaired(model, problem, limits, &starts[k]) {
                Ok((x, verified)) => {
                    // The chosen one comes first.
                    starts[..=k].rotate_right(1);
                    let motion = self.sampled(&problem.watched, &x);
                    let points = self.points(&problem.watched, &x);
                    let torque = problem.loads.torques(&motion, Sign::Exact).swap_remove(0);
                    let moves = problem.watched.moves(&x);
                    let repeated = self.repeated(problem)?;
                    return Ok(FeasibleMotion {
                        motion,
                        points,
                        torque,
                        verified,
                        starts,
                        moves,
                        repeated,
                        stopped_after,
                    });
                }
                Err(error) => _ = first_error.get_or_insert(error),
            }
        }
        let (path, parameters) = (self.path.clone(), problem.information.parameters());
        let starts = self.file.motion.starts;
        Err(first_error.unwrap_or(DesignError::ShowsTooLittle { path, starts, parameters }))
    }

    /// The motion at the rate of the trajectory.
    pub(in crate::design) fn sampled(&self, motions: &Motions, x: &[f64]) -> Derivatives {
        self.sampled_at(motions, x, self.file.sample_rate_hz)
    }

    /// The motion at a rate, its end included.
    fn sampled_at(&self, motions: &Motions, x: &[f64], rate_hz: f64) -> Derivatives {
        let count = (self.file.duration_s * rate_hz - WHOLE).ceil() as usize;
        let grid: Vec<f64> = (0..=count).map(|k| (k as f64 / rate_hz).min(self.file.duration_s)).collect();
        motions.on(x, &grid)
    }

    /// The motion for a robot's controller: as a trajectory, and as points.
    fn points(&self, motions: &Motions, x: &[f64]) -> [TrajectoryPoints; 2] {
        let stated = self.file.points_hz;
        [stated.unwrap_or(self.file.sample_rate_hz), stated.unwrap_or(POINTS_HZ)].map(|rate_hz| {
            let [q, dq, ddq, _] = self.sampled_at(motions, x, rate_hz);
            TrajectoryPoints { rate_hz, q, dq, ddq }
        })
    }

    /// The true motion and torques of the expected robot and of the robot without its payload: in the closed loop if a controller is
    /// described.
    fn true_motions(&self, model: &Model, chosen: &FeasibleMotion) -> Result<[TrueMotion; 2], DesignError> {
        let of = |theta: &[f64]| -> Result<TrueMotion, DesignError> {
            match &self.settings.controller {
                Some(controller) => {
                    let motion = self
                        .followed(model, controller, &chosen.motion[0], theta, self.file.sample_rate_hz)
                        .map_err(|source| DesignError::Loop { path: self.path.clone(), source })?;
                    Ok(TrueMotion { q: motion.q, tau: motion.tau })
                }
                None => {
                    let loads = Loads::new(model, &[theta.to_vec()], Vec::new());
                    let tau = loads.torques(&chosen.motion, Sign::Exact).swap_remove(0);
                    Ok(TrueMotion { q: chosen.motion[0].clone(), tau })
                }
            }
        };
        let loaded = of(&self.expected_robot(model)?)?;
        let unloaded = if self.payload().is_some() { of(&self.robot.a_priori_parameters())? } else { loaded.clone() };
        Ok([loaded, unloaded])
    }

    fn expected_recording<'a>(&'a self, motion: &'a TrueMotion, position_noise: &'a [f64]) -> ExpectedRecording<'a> {
        ExpectedRecording {
            robot: &self.robot,
            settings: &self.settings,
            sample_rate_hz: self.file.sample_rate_hz,
            q: &motion.q,
            tau: &motion.tau,
            torque_noise: &self.noise.deviations,
            torque_spectrum: self.noise.spectrum.as_ref(),
            position_noise,
        }
    }
}

/// The true motion of a robot and its torques.
#[derive(Clone)]
struct TrueMotion {
    q: Series,
    tau: Series,
}
