//! Simulations in the lanes of a vector, bit-identical to single ones.

use pulp::{Simd, WithSimd};

use super::{
    closed_loop::{ClosedLoop, Job},
    error::SimulationError,
    motion::SimulatedMotion,
    running::Running,
};
use thetahat_ground::real::{Lanes, MOST_LANES};
use thetahat_model::dynamics::{DynamicParameters, Sign, State, Workspace};

/// Runs simulations as [`ClosedLoop::simulate`] does. Simulations of one model and one friction scale run together: right-hand sides of
/// several cost little more than right-hand sides of one.
#[must_use]
pub fn simulate_all(jobs: &[Job<'_>]) -> Vec<Result<SimulatedMotion, SimulationError>> {
    let alike = |a: &Job<'_>, b: &Job<'_>| {
        let (a, b) = (&a.closed_loop, &b.closed_loop);
        let same_model = std::ptr::eq(a.model, b.model) || a.model == b.model;
        same_model && a.sign_velocity_scale == b.sign_velocity_scale
    };
    jobs.chunk_by(alike).flat_map(|jobs| pulp::Arch::new().dispatch(SideBySide { jobs })).collect()
}

struct SideBySide<'a> {
    jobs: &'a [Job<'a>],
}

impl WithSimd for SideBySide<'_> {
    type Output = Vec<Result<SimulatedMotion, SimulationError>>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let ClosedLoop { model, sign_velocity_scale, .. } = self.jobs[0].closed_loop;
        // The kernel of lanes takes trees.
        let lanes = if model.has_loops() { 1 } else { Lanes::<S>::COUNT };
        let mut work = Work::new(self.jobs, lanes);
        let (n, zero) = (model.coordinate_count(), Lanes::splat(simd, 0.0));
        let sign = Sign::smooth(sign_velocity_scale);
        let mut workspace = Workspace::like(model, zero);
        let [mut q, mut dq, mut tau, mut ddq] = [(); 4].map(|()| vec![zero; n]);
        let mut channels = vec![zero; model.channels().len() * n];
        while work.fill() {
            let parameters = DynamicParameters::side_by_side(simd, |lane| work.of_lane(lane).parameters());
            let mut all_go_on = true;
            while all_go_on {
                work.gather(simd, [&mut q, &mut dq, &mut tau, &mut channels]);
                let state = State::new(&q, &dq).with_channels(&channels);
                all_go_on = match model.forward_dynamics_of(&parameters, state, &tau, sign, &mut workspace, &mut ddq) {
                    Ok(()) => {
                        work.scatter(&ddq);
                        work.scatter_mass(workspace.factored_mass_matrix());
                        true
                    }
                    // One of them has no acceleration: each is run separately.
                    Err(_) => work.step(|running| running.accelerate().map(|()| true)),
                };
                all_go_on &= work.step(Running::advance);
            }
        }
        work.finish()
    }
}

/// The running simulations, one in each lane, the waiting ones, and the results.
struct Work<'a> {
    jobs: &'a [Job<'a>],
    lanes: usize,
    begun: usize,
    running: Vec<(usize, Running<'a>)>,
    results: Vec<Option<Result<SimulatedMotion, SimulationError>>>,
}

impl<'a> Work<'a> {
    fn new(jobs: &'a [Job<'a>], lanes: usize) -> Self {
        Self { jobs, lanes, begun: 0, running: Vec::new(), results: jobs.iter().map(|_| None).collect() }
    }

    /// Puts waiting simulations into free lanes; returns whether several are running.
    fn fill(&mut self) -> bool {
        while self.running.len() < self.lanes && self.begun < self.jobs.len() {
            let number = self.begun;
            self.begun += 1;
            match Running::new(&self.jobs[number]) {
                Ok(mut running) => match running.advance() {
                    Ok(true) => self.running.push((number, running)),
                    ended => self.end(number, running, ended),
                },
                Err(error) => self.results[number] = Some(Err(error)),
            }
        }
        self.running.len() > 1
    }

    fn end(&mut self, number: usize, running: Running<'a>, ended: Result<bool, SimulationError>) {
        self.results[number] = Some(ended.and_then(|_| running.finish()));
    }

    /// Advances each simulation by a step and ends those that are done or fail; returns whether all continue.
    fn step(&mut self, step: impl Fn(&mut Running<'a>) -> Result<bool, SimulationError>) -> bool {
        let before = self.running.len();
        for lane in (0..before).rev() {
            match step(&mut self.running[lane].1) {
                Ok(true) => {}
                ended => {
                    let (number, running) = self.running.swap_remove(lane);
                    self.end(number, running, ended);
                }
            }
        }
        self.running.len() == before
    }

    /// The simulation in a lane; free lanes repeat the first.
    fn of_lane(&self, lane: usize) -> &Running<'a> {
        &self.running[if lane < self.running.len() { lane } else { 0 }].1
    }

    /// The requested states, and the torques there.
    #[inline(always)]
    fn gather<S: Simd>(&mut self, simd: S, signals: [&mut [Lanes<S>]; 4]) {
        let mut wanted = self.running.iter_mut().map(|(_, running)| running.wanted());
        let Some(first) = wanted.next() else { return };
        let mut of_lanes = [first; MOST_LANES];
        of_lanes[1..].iter_mut().zip(wanted).for_each(|(lane, wanted)| *lane = wanted);
        for (signal, channels) in signals.into_iter().enumerate() {
            for (c, channel) in channels.iter_mut().enumerate() {
                *channel = Lanes::from_fn(simd, |lane| of_lanes[lane][signal][c]);
            }
        }
    }

    #[inline(always)]
    fn scatter<S: Simd>(&mut self, ddq: &[Lanes<S>]) {
        for (c, lanes) in ddq.iter().enumerate() {
            let values = lanes.to_array();
            for ((_, running), value) in self.running.iter_mut().zip(values) {
                running.accelerations_mut()[c] = value;
            }
        }
    }

    /// Distributes the factors of the mass matrices to the simulations that requested them.
    #[inline(always)]
    fn scatter_mass<S: Simd>(&mut self, mass: &[Lanes<S>]) {
        for (lane, (_, running)) in self.running.iter_mut().enumerate() {
            if let Some(to) = running.mass_mut() {
                to.iter_mut().zip(mass).for_each(|(to, from)| *to = from.to_array()[lane]);
            }
        }
    }

    /// Runs the remaining simulations one by one.
    fn finish(mut self) -> Vec<Result<SimulatedMotion, SimulationError>> {
        self.lanes = 1;
        while self.begun < self.jobs.len() || !self.running.is_empty() {
            self.fill();
            self.step(|running| running.run().map(|()| false));
        }
        self.results.into_iter().flatten().collect()
    }
}
