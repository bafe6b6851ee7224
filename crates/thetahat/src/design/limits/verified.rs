//! The limits of a motion at 1 kHz, and its repair if it violates one.

use crate::design::{
    error::DesignError,
    limits::{
        clearances::Clearances,
        joint_limits::JointLimits,
        loads::Loads,
        verification::{RATE_HZ, uses},
    },
    motions::family::Motions,
    search::{
        optimiser::Problem,
        searches::{Start, sign_scales},
        starts::fitted,
    },
    text::description::Design,
};
use thetahat_estimation::signal::Motion;
use thetahat_ground::series::Series;
use thetahat_model::dynamics::{Model, Sign};
use thetahat_report::results::{CollisionResults, ExecutedMotion, JointResult, LimitUse};

/// Most descents that repair a motion that violates a limit at 1 kHz, and the gain of the last step of each, nats.
const REPAIRS: usize = 3;
const REPAIR_GAIN: f64 = 0.05;
/// Largest part by which an assumed controller may exceed limits for the motion to be repaired.
const MOST_OF_ASSUMED: f64 = 0.1;

/// The use of limits and the distances of a motion at 1 kHz.
pub(in crate::design) struct Verified {
    pub(in crate::design) uses: Vec<LimitUse>,
    pub(in crate::design) collision: Option<CollisionResults>,
    /// In the simulated loop.
    pub(in crate::design) executed: ExecutedMotion,
}

impl Verified {
    fn worst(&self) -> Option<&LimitUse> {
        self.uses.iter().max_by(|a, b| a.part.total_cmp(&b.part))
    }

    /// The part by which the simulated loop exceeds a limit. An assumed controller that exceeds it by much is not that of the robot: this is
    /// reported, and costs no motion.
    fn excess_of_loop(&self) -> f64 {
        let over = self.executed.uses.iter().map(|used| used.part - 1.0).fold(-1.0, f64::max);
        if self.executed.is_stated || over <= MOST_OF_ASSUMED { over } else { -1.0 }
    }

    /// The part by which a limit is exceeded, and the distance that is missing, m; negative if nothing is violated.
    fn violation(&self) -> (f64, f64) {
        let over = self.worst().map_or(-1.0, |worst| worst.part - 1.0).max(self.excess_of_loop());
        let nearest = self.collision.as_ref().and_then(|c| Some(c.margin - c.pairs.first()?.distance));
        (over, nearest.unwrap_or(-1.0))
    }
}

impl Design {
    /// The motion of a search, verified at 1 kHz. If it violates a limit or a distance between the instants of the search, it descends
    /// again within limits that are tighter by as much.
    pub(in crate::design) fn repaired(
        &self,
        model: &Model,
        problem: &Problem,
        limits: &[JointLimits],
        start: &Start,
    ) -> Result<(Vec<f64>, Verified), DesignError> {
        let [_, scale] = sign_scales(limits);
        let (mut tight, mut x) = (problem.clone(), start.x.clone());
        let mut verified = self.verify(model, &problem.watched, limits, &x)?;
        for _ in 0..REPAIRS {
            let (over, missing) = verified.violation();
            if over <= 0.0 && missing <= 0.0 {
                break;
            }
            tight.tighten(1.2 * over.max(0.0), 1.2 * missing.max(0.0), verified.excess_of_loop() > 0.0);
            let Some(found) = tight.optimise(fitted(&tight, &x), Sign::smooth(scale), REPAIR_GAIN) else { break };
            x = found.x;
            verified = self.verify(model, &problem.watched, limits, &x)?;
        }
        match self.error_of(&verified) {
            Some(error) => Err(error),
            None => Ok((x, verified)),
        }
    }

    /// Why a motion cannot be used.
    fn error_of(&self, verified: &Verified) -> Option<DesignError> {
        let worst = verified.worst().filter(|worst| worst.part > 1.0);
        let error = worst.map(|worst| self.infeasible(worst, format!("at {:.3} s", worst.at_s)));
        error.or_else(|| verified.collision.as_ref().and_then(|collision| self.too_near(collision)))
    }

    /// The distances along a motion at 1 kHz and along the path from home.
    fn collision(&self, model: &Model, q: &Series) -> Result<Option<CollisionResults>, DesignError> {
        let (Some(options), Some(surroundings)) = (&self.file.collision, self.surroundings(model)?) else {
            return Ok(None);
        };
        let clearances = Clearances { scene: surroundings.scene, margin: 1e-3 * options.margin };
        Ok(Some(clearances.results(q, RATE_HZ, self.home_posture().as_deref(), &surroundings.uncovered)))
    }

    /// Why distances are too small.
    fn too_near(&self, collision: &CollisionResults) -> Option<DesignError> {
        let nearest = collision.pairs.first().filter(|pair| pair.distance < collision.margin)?;
        Some(DesignError::TooNear {
            path: self.path.clone(),
            first: nearest.first.clone(),
            second: nearest.second.clone(),
            distance_mm: 1e3 * nearest.distance,
            margin_mm: 1e3 * collision.margin,
            when: nearest.at_s.map_or_else(|| "on the path from home".to_owned(), |at| format!("at {at:.3} s")),
        })
    }

    /// Verifies the limits along each joint's sweeps, which no search changes.
    pub(in crate::design) fn verify_sweeps(
        &self,
        model: &Model,
        motions: &Motions,
        limits: &[JointLimits],
    ) -> Result<(), DesignError> {
        let Some(family) = motions.move_family().filter(|family| !family.sweeps.is_empty()) else { return Ok(()) };
        let loads = Loads::new(model, &self.possible_robots(model)?, limits.to_vec());
        for (sweeping, own) in limits.iter().enumerate() {
            let Motion { q, dq, ddq } = family.sweep_motion(sweeping, RATE_HZ);
            let jerk = Series::zeros(q.len(), q.channels());
            let motion = [q, dq, ddq, jerk];
            let uses = uses(limits, &motion, &loads.torques(&motion, Sign::Exact));
            let worst = uses.iter().max_by(|a, b| a.part.total_cmp(&b.part));
            if let Some(worst) = worst.filter(|worst| worst.part > 1.0) {
                let at = motion[0].sample((worst.at_s * RATE_HZ).round() as usize)[sweeping];
                let at = format!("{:.4} {}", own.kind.to_file(at), own.kind.file_unit());
                return Err(self.infeasible(worst, format!("in the sweep of {} at {at}", own.joint)));
            }
        }
        Ok(())
    }

    fn infeasible(&self, worst: &LimitUse, place: String) -> DesignError {
        let [lower, upper] = worst.reached;
        let is_lower = (worst.limit[0] - lower) > (upper - worst.limit[1]);
        let (limit, needed) = if is_lower { (worst.limit[0], lower) } else { (worst.limit[1], upper) };
        let joint = &JointResult::of_coordinates(&self.robot)[worst.coordinate];
        let in_file = |value: f64| worst.quantity.to_file(joint.kind, value);
        DesignError::Infeasible {
            path: self.path.clone(),
            joint: worst.joint.clone(),
            quantity: worst.quantity.name(),
            limit: in_file(limit),
            needed: in_file(needed),
            unit: worst.quantity.file_unit(joint.kind),
            place,
        }
    }

    /// The use of limits by a motion at 1 kHz, and its distances.
    fn verify(
        &self,
        model: &Model,
        motions: &Motions,
        limits: &[JointLimits],
        x: &[f64],
    ) -> Result<Verified, DesignError> {
        let count = (self.file.duration_s * RATE_HZ).ceil() as usize;
        let grid: Vec<f64> = (0..=count).map(|k| (k as f64 / RATE_HZ).min(self.file.duration_s)).collect();
        let motion = motions.on(x, &grid);
        let loads = Loads::new(model, &self.possible_robots(model)?, limits.to_vec());
        let torques = loads.torques(&motion, Sign::Exact);
        let (uses, collision) = (uses(limits, &motion, &torques), self.collision(model, &motion[0])?);
        let executed = self.executed(model, limits, &self.sampled(motions, x)[0])?;
        Ok(Verified { uses, collision, executed })
    }
}
