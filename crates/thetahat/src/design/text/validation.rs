//! What a design file must hold before anything is searched.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::design::{
    error::DesignError,
    limits::{joint_limits::JointLimits, verification::RATE_HZ},
    search::criterion::CriterionName,
    text::{description::Design, options::UncertaintyOptions},
};
use thetahat_estimation::identification::Needs;
use thetahat_ground::one_or_each::OneOrEach;
use thetahat_model::{
    dynamics::Model,
    robot::{Joint, Limits},
};

/// Most samples of a motion, at its own rate and at 1 kHz, at which its limits are verified.
const MOST_SAMPLES: f64 = 1e6;
/// Part of a sample by which a motion may miss a whole number of them: rounding.
pub(in crate::design) const WHOLE: f64 = 1e-6;
/// Most robots that are drawn: each costs its torques in every step.
const MOST_DRAWS: usize = 100;
/// Shortest motion, in periods of the position filter's cut-off: the edges cost five at either end.
const FEWEST_PERIODS: f64 = 15.0;

/// Positions within the limits at which loops are looked at, and the seed from which they are drawn.
const POSITIONS: usize = 2000;
const SEED: u64 = 1;

impl Design {
    pub(in crate::design) fn validate(&self) -> Result<(), DesignError> {
        let fixed = "a robot whose base is fixed: what a base that floats does depends on what touches it";
        self.require(self.robot.base_coordinates() == 0, "robot", fixed, "a base that floats")?;
        self.settings.validate(&self.robot).map_err(|source| self.refuse(source))?;
        self.settings.require_stated_cutoff("a design has none").map_err(|source| self.refuse(source))?;
        self.validate_duration()?;
        self.validate_motion()?;
        self.validate_noise()?;
        self.validate_wanted()?;
        self.validate_uncertainty()?;
        self.validate_payload()?;
        self.validate_identification()?;
        self.validate_collision()?;
        let limits = self.limits()?;
        self.validate_loops(&limits)?;
        self.validate_sweeps(&limits)
    }

    /// Requires that loops are closed, and passive joints within their limits, wherever the driven joints may be.
    fn validate_loops(&self, limits: &[JointLimits]) -> Result<(), DesignError> {
        if self.robot.loops.is_empty() {
            return Ok(());
        }
        let nothing_near = "left out: the distances of mechanisms that close are not computed yet";
        self.require(self.file.collision.is_none(), "[collision]", nothing_near, "given")?;
        let (model, mut rng) = (Model::new(&self.robot), ChaCha8Rng::seed_from_u64(SEED));
        for _ in 0..POSITIONS {
            // Corners of the ranges are where loops open first.
            let part = |rng: &mut ChaCha8Rng| {
                if rng.random_bool(0.5) {
                    f64::from(u8::from(rng.random_bool(0.5)))
                } else {
                    rng.random_range(0.0..1.0)
                }
            };
            let q: Vec<f64> = limits.iter().map(|l| l.lower + part(&mut rng) * (l.upper - l.lower)).collect();
            let joints = self.robot.joints.iter().zip(model.joint_positions(&q));
            let outside = |(joint, position): &(&Joint, f64)| {
                let Limits { lower, upper, .. } = joint.limits;
                let is_beyond = lower.is_some_and(|l| *position < l) || upper.is_some_and(|u| *position > u);
                joint.passive && (position.is_nan() || is_beyond)
            };
            let Some((joint, position)) = joints.into_iter().find(outside) else { continue };
            let expected = format!(
                "ranges within which the loops are closed and passive joint `{}` is within its limits (it is at {position:.4} rad or m)",
                joint.name
            );
            self.require(false, "[limits] position", &expected, format!("a range that has {q:.4?} rad or m"))?;
        }
        Ok(())
    }

    /// Requires an identification of all base parameters, with torques that the motion alone decides.
    fn validate_identification(&self) -> Result<(), DesignError> {
        let parameters = &self.settings.parameters;
        let expected =
            "\"base\": the motion serves all base parameters, and each recording would choose its own part of them";
        self.require(parameters.estimate.takes_all(), "[parameters] estimate", expected, "a part of them")?;
        let moved =
            self.settings.controller.as_ref().and_then(|_| self.robot.term_of_acceleration().map(str::to_owned));
        let term = self.robot.channels().pop().or(moved);
        let expected = "terms of positions and velocities alone: a design has no recorded channels, and a closed loop no \
                        torques that depend on accelerations";
        self.require(term.is_none(), "[[term]]", expected, term.unwrap_or_default())
    }

    fn validate_duration(&self) -> Result<(), DesignError> {
        let (duration, rate) = (self.file.duration_s, self.file.sample_rate_hz);
        let positive = "a finite number above zero";
        self.require(duration > 0.0 && duration.is_finite(), "duration_s", positive, duration)?;
        self.require(rate > 0.0 && rate.is_finite(), "sample_rate_hz", positive, rate)?;
        let points = self.file.points_hz.unwrap_or(rate);
        self.require(
            points > 0.0 && points * duration <= MOST_SAMPLES,
            "points_hz",
            "above zero, and at most 1e6 points",
            points,
        )?;
        let (samples, verified) = (duration * rate, duration * rate.max(RATE_HZ));
        let expected = "at most 1e6 samples, at 1 kHz and above";
        self.require(verified <= MOST_SAMPLES, "duration_s times sample_rate_hz", expected, verified)?;
        let is_whole = (samples - samples.round()).abs() <= WHOLE;
        self.require(is_whole, "duration_s times sample_rate_hz", "a whole number of samples", samples)?;
        let cutoff = self.file.signal.cutoff_hz;
        self.require(cutoff < 0.5 * rate, "[signal] cutoff_hz", "below half of sample_rate_hz", cutoff)?;
        let shortest = FEWEST_PERIODS / self.file.signal.cutoff_hz;
        let expected = format!("at least {shortest:.3}: [signal] cutoff_hz cuts five of its periods off at both ends");
        self.require(duration >= shortest, "duration_s", &expected, duration)
    }

    fn validate_noise(&self) -> Result<(), DesignError> {
        let joints = self.robot.coordinate_count();
        let (torque, position) = (self.file.noise.torque.as_ref(), &self.file.noise.position);
        let lists = torque.map(|list| ("[noise] torque", list));
        for (key, list) in lists.into_iter().chain([("[noise] position", position)]) {
            self.require(list.fits(joints), key, &format!("one value, or {joints}"), list.given().len())?;
        }
        let expected = "above zero: a recording without noise predicts estimates without error; take the standard deviation \
                        of a torque at rest";
        for &noise in torque.map_or(&[][..], OneOrEach::given) {
            self.require(noise > 0.0 && noise.is_finite(), "[noise] torque", expected, noise)?;
        }
        for &noise in position.given() {
            self.require(noise >= 0.0 && noise.is_finite(), "[noise] position", "zero or above", noise)?;
        }
        Ok(())
    }

    fn validate_wanted(&self) -> Result<(), DesignError> {
        let wanted = &self.file.wanted;
        let is_chosen = wanted.criterion == CriterionName::SelectedParameters;
        let expected = "names of base parameters with criterion = \"chosen\", and only with it";
        self.require(
            is_chosen != wanted.parameters.is_empty(),
            "[wanted] parameters",
            expected,
            if is_chosen { "none".to_owned() } else { wanted.parameters.join(" ") },
        )?;
        let torque = wanted.torque_percent;
        self.require(torque > 0.0 && torque.is_finite(), "[wanted] torque_percent", "above zero", torque)?;
        let percent = wanted.half_width_percent;
        self.require(percent > 0.0 && percent.is_finite(), "[wanted] half_width_percent", "above zero", percent)
    }

    fn validate_uncertainty(&self) -> Result<(), DesignError> {
        let UncertaintyOptions { draws, percent, friction_percent, motor_inertia_percent, overshoot_percent } =
            self.file.uncertainty;
        self.require(draws <= MOST_DRAWS, "[uncertainty] draws", "at most 100", draws)?;
        let expected = "from 0 to below 100";
        self.require((0.0..100.0).contains(&percent), "[uncertainty] percent", expected, percent)?;
        self.require(
            (0.0..100.0).contains(&friction_percent),
            "[uncertainty] friction_percent",
            expected,
            friction_percent,
        )?;
        let is_overshoot = (0.0..100.0).contains(&overshoot_percent);
        self.require(is_overshoot, "[uncertainty] overshoot_percent", expected, overshoot_percent)?;
        let is_inertia = motor_inertia_percent >= 0.0 && motor_inertia_percent.is_finite();
        self.require(is_inertia, "[uncertainty] motor_inertia_percent", "zero or above", motor_inertia_percent)?;
        let expected = "above zero with [uncertainty] percent, and only with it";
        self.require((draws > 0) == (percent > 0.0), "[uncertainty] draws", expected, draws)
    }

    /// One payload whose torques are known, and methods that can take them off.
    fn validate_payload(&self) -> Result<(), DesignError> {
        let Some(payload) = self.payload() else { return Ok(()) };
        let (payloads, name) = (self.settings.payloads.len(), &payload.name);
        self.require(payloads == 1, "[[payload]]", "the one that the robot carries", payloads)?;
        let expected = "given with centre_m: the limits of torque need them";
        self.require(payload.is_known(), &format!("[[payload]] {name}: mass_kg"), expected, "missing")?;
        let simulating = self.settings.all_methods().into_iter().find(|m| m.needs() != Needs::Measurement);
        let expected = "idim-ls or idim-wls where the robot carries a payload: simulations carry none";
        let found = simulating.map(|method| method.name()).unwrap_or_default();
        self.require(simulating.is_none(), "[estimation] methods", expected, found)
    }

    fn validate_collision(&self) -> Result<(), DesignError> {
        let Some(options) = &self.file.collision else { return Ok(()) };
        let (margin, joints) = (options.margin, self.robot.coordinate_count());
        self.require(
            margin >= 0.0 && margin.is_finite(),
            "[collision] margin",
            "a finite number of mm, zero or above",
            margin,
        )?;
        if let Some(home) = &options.home {
            self.require(home.len() == joints, "[collision] home", &format!("{joints} positions"), home.len())?;
            let found = format!("{home:?}");
            self.require(home.iter().all(|v| v.is_finite()), "[collision] home", "finite numbers", found)?;
        }
        self.surroundings(&Model::new(&self.robot)).map(|_| ())
    }

    /// The noise of each joint's position, rad or m.
    pub(in crate::design) fn position_noise(&self) -> Vec<f64> {
        let joints = self.robot.coordinates().enumerate();
        joints.map(|(j, joint)| joint.kind.to_si(*self.file.noise.position.of(j))).collect()
    }
}
