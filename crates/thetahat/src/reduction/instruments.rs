//! The simulated motion from which instruments are computed, in pieces where the recording comes in pieces.

use std::ops::Range;

use super::{error::ReductionError, source::Source};
use crate::{
    experiment::Experiment,
    preparation::{Gains, propose_controller},
    scheduling::closed_loop,
};
use thetahat_estimation::{
    control::ControllerDescription,
    signal::Motion,
    simulation::{ClosedLoop, OutputGrid, Reference, SampledReference, SimulatedMotion, SimulatorBias, Solver},
};
use thetahat_ground::series::Series;
use thetahat_model::{
    base_parameters::BaseParameters,
    dynamics::{Model, Sign},
};

/// Time that a piece is simulated before its first sample: the loop starts at rest on its reference, and must have forgotten
/// that.
const WARM_UP_S: f64 = 2.0;
/// Times along the recording at which the inertia seen by the motors is averaged, as a simulation of the whole recording does.
const INERTIA_SAMPLES: usize = 50;
/// How far two pieces may be apart where they meet, in tolerances of the integration.
const SEAM: f64 = 30.0;
/// The tolerance taken for steps of a fixed size.
const FIXED_TOLERANCE: f64 = 1e-3;

/// The closed loop with given parameters along one recording.
pub(super) struct Simulated<'a> {
    experiment: &'a Experiment,
    model: &'a Model,
    controller: ControllerDescription,
    source: &'a Source<'a>,
    /// Standard parameters.
    theta: Vec<f64>,
    inertia: Vec<f64>,
    /// Samples that the position filter looks back and ahead.
    reach: usize,
    /// The motion in the window, where the recording is in memory.
    whole: Option<(usize, SimulatedPiece)>,
}

/// The simulated motion of a piece.
pub(super) struct SimulatedPiece {
    pub motion: Motion,
    /// Positions at the sample after the last, where there is one.
    pub next: Option<Vec<f64>>,
}

impl<'a> Simulated<'a> {
    /// The loop of a recording with base parameters `theta`, to be simulated in a window.
    pub(super) fn new(
        experiment: &'a Experiment,
        (model, base): (&'a Model, &BaseParameters),
        source: &'a Source<'a>,
        theta: &[f64],
        (reach, window): (usize, &Range<usize>),
    ) -> Result<Self, ReductionError> {
        // A recording that comes in pieces is not in memory to show a bandwidth.
        let controller = experiment.settings.controller.clone();
        let controller = controller.unwrap_or_else(|| propose_controller(&[]).description);
        let (theta, inertia) = (base.to_standard(theta), Vec::new());
        let mut simulated = Self { experiment, model, controller, source, theta, inertia, reach, whole: None };
        let reference = simulated.reference_in_memory()?;
        let parameters = simulated.parameters_of_gains(base);
        simulated.inertia = match &reference {
            Some(reference) => {
                let duration_s = source.samples as f64 / source.sample_rate_hz;
                simulated.closed_loop(reference, None).motor_inertia(&parameters, duration_s)
            }
            None => simulated.mean_inertia(&parameters)?,
        };
        if let Some(reference) = &reference {
            simulated.whole = Some((window.start, simulated.whole_motion(reference, window)?));
        }
        Ok(simulated)
    }

    /// The regularised sign of the simulated friction.
    pub(super) fn sign(&self) -> Sign {
        Sign::smooth(self.experiment.settings.simulation.sign_velocity_scale)
    }

    /// The part of a step over which its rows are centred: that for which the recorded torques hold. A motion that is filtered
    /// as the recording is has accelerations that are centred already.
    pub(super) fn held_part_of_step(&self) -> f64 {
        if self.experiment.settings.simulation.band_pass { 0.0 } else { self.source.held_part_of_step() }
    }

    /// The motion in a range of samples of the recording.
    pub(super) fn motion(&self, range: &Range<usize>) -> Result<SimulatedPiece, ReductionError> {
        if let Some((start, whole)) = &self.whole {
            let motion = cut(&whole.motion, range.start - start..range.end - start);
            return Ok(SimulatedPiece { motion, next: None });
        }
        if !self.experiment.settings.simulation.band_pass {
            return self.simulate_piece(range);
        }
        let ahead = self.reach + 2 * self.experiment.settings.signal.derivative.reach();
        let extended = range.start.saturating_sub(ahead)..(range.end + ahead).min(self.source.samples);
        let piece = self.simulate_piece(&extended)?;
        self.filtered(&piece.motion.q, range.start - extended.start..range.end - extended.start)
    }

    /// Refuses pieces that do not meet: the loop remembers longer than it was simulated before each.
    pub(super) fn require_seam(&self, expected: &[f64], found: &[f64], sample: usize) -> Result<(), ReductionError> {
        let (relative, absolute) = match self.experiment.settings.simulation.solver {
            Solver::Automatic { relative_tolerance, absolute_tolerance }
            | Solver::Adaptive { relative_tolerance, absolute_tolerance }
            | Solver::Implicit { relative_tolerance, absolute_tolerance } => (relative_tolerance, absolute_tolerance),
            Solver::Fixed { .. } => (FIXED_TOLERANCE, FIXED_TOLERANCE),
        };
        let apart = |(e, f): (&f64, &f64)| (e - f).abs() / (absolute + relative * e.abs());
        let worst = expected.iter().zip(found).map(apart).fold(0.0, f64::max);
        if worst <= SEAM {
            return Ok(());
        }
        let (recording, time_s) = (self.source.name.clone(), sample as f64 / self.source.sample_rate_hz);
        Err(ReductionError::Seam { recording, time_s, tolerances: worst, warm_up_s: WARM_UP_S })
    }

    fn closed_loop<'b>(&'b self, reference: &'b Reference, added: Option<&'b Series>) -> ClosedLoop<'b> {
        let added = added.map(|series| (series, self.source.sample_rate_hz));
        let setup = self.experiment.setup();
        closed_loop(setup, self.model, &self.controller, reference, added, SimulatorBias::NONE)
    }

    /// The parameters for whose inertia the gains of a controller given by its bandwidth are.
    fn parameters_of_gains(&self, base: &BaseParameters) -> Vec<f64> {
        match self.experiment.settings.estimation.gains {
            Gains::Updated => self.theta.clone(),
            Gains::Kept => {
                let start = self.experiment.setup().start(self.model.parameter_table());
                base.to_standard(&base.from_standard(&start))
            }
        }
    }

    /// The reference of a recording in memory: recorded, planned, or reconstructed.
    fn reference_in_memory(&self) -> Result<Option<Reference>, ReductionError> {
        let Some(recording) = self.source.recording() else { return Ok(None) };
        let reference = self.experiment.setup().reference(recording);
        Ok(Some(reference.map_err(|e| self.experiment.refuse(e))?.reference))
    }

    fn whole_motion(&self, reference: &Reference, window: &Range<usize>) -> Result<SimulatedPiece, ReductionError> {
        let added = self.source.recording().and_then(|recording| recording.added_signal.as_ref());
        let closed_loop = self.closed_loop(reference, added);
        if self.experiment.settings.simulation.band_pass {
            let whole = self.run(&closed_loop, 0, 0..self.source.samples)?;
            return self.filtered(&whole.q, window.clone());
        }
        let SimulatedMotion { q, dq, ddq, .. } = self.run(&closed_loop, 0, window.clone())?;
        Ok(SimulatedPiece { motion: Motion { q, dq, ddq }, next: None })
    }

    /// Simulates from the sample `origin` on, and gives a range of samples.
    fn run(
        &self,
        closed_loop: &ClosedLoop<'_>,
        origin: usize,
        range: Range<usize>,
    ) -> Result<SimulatedMotion, ReductionError> {
        let rate = self.source.sample_rate_hz;
        let start_s = (range.start - origin) as f64 / rate;
        let grid = OutputGrid { start_s, sample_rate_hz: rate, samples: range.len() };
        closed_loop.simulate(&self.theta, &self.inertia, &grid).map_err(|source| ReductionError::Simulation {
            recording: self.source.name.clone(),
            from_s: origin as f64 / rate,
            source,
        })
    }

    fn filtered(&self, q: &Series, range: Range<usize>) -> Result<SimulatedPiece, ReductionError> {
        let filtered = self.experiment.setup().band_pass(q, self.source.sample_rate_hz);
        let motion = filtered.map_err(|e| self.experiment.refuse(e))?;
        let next = (range.end < motion.q.len()).then(|| motion.q.sample(range.end).to_vec());
        Ok(SimulatedPiece { motion: cut(&motion, range), next })
    }

    fn simulate_piece(&self, range: &Range<usize>) -> Result<SimulatedPiece, ReductionError> {
        let warm_up = (WARM_UP_S * self.source.sample_rate_hz).ceil() as usize;
        let origin = range.start.saturating_sub(warm_up);
        let end = (range.end + 1).min(self.source.samples);
        let (reference, added) = self.source.reference(origin..end)?;
        let reference = Reference::Sampled(SampledReference::new(reference, self.source.sample_rate_hz));
        let SimulatedMotion { q, dq, ddq, .. } =
            self.run(&self.closed_loop(&reference, added.as_ref()), origin, range.start..end)?;
        let next = (end > range.end).then(|| q.sample(range.len()).to_vec());
        Ok(SimulatedPiece { motion: cut(&Motion { q, dq, ddq }, 0..range.len()), next })
    }

    /// The inertia that each motor sees, averaged along the recording.
    fn mean_inertia(&self, theta: &[f64]) -> Result<Vec<f64>, ReductionError> {
        let mut values = Vec::new();
        for k in 0..INERTIA_SAMPLES {
            let last = self.source.samples - 1;
            let place = (self.source.samples as f64 * k as f64 / (INERTIA_SAMPLES - 1) as f64).min(last as f64);
            let first = place as usize;
            let (near, _) = self.source.reference(first..(first + 2).min(last + 1))?;
            let (from, to) = (near.sample(0), near.sample(near.len() - 1));
            values.extend(from.iter().zip(to).map(|(a, b)| a + (place - first as f64) * (b - a)));
        }
        let series = Series::shaped(self.model.coordinate_count(), values);
        let reference = Reference::Sampled(SampledReference::new(series, 1.0));
        Ok(self.closed_loop(&reference, None).motor_inertia(theta, (INERTIA_SAMPLES - 1) as f64))
    }
}

fn cut(motion: &Motion, range: Range<usize>) -> Motion {
    let cut = |series: &Series| series.window(range.clone());
    Motion { q: cut(&motion.q), dq: cut(&motion.dq), ddq: cut(&motion.ddq) }
}
