use std::f64::consts::TAU;

use serde::Deserialize;

use super::own_law::{ControlLaw, LawInput, OwnLaw, ResolvedLaw};
use thetahat_ground::one_or_each;

/// The structure of the control loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Law {
    /// `u = kp e + kv (f_v dr - v) + f_a J ddr`.
    Pd,
    /// A position loop around a velocity loop: `u = kv (kp e + f_v dr - v) + f_a J ddr`.
    Cascaded,
    /// No loop: the recorded drive signals act, from the state of the first samples on. CLOE is an open-loop output error then.
    OpenLoop,
}

/// The velocity that the controller uses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum VelocityEstimate {
    /// The velocity itself.
    #[default]
    Exact,
    /// `(p_k - p_{k-2}) / (2 T)`: the difference of positions averaged over two samples, for sampled controllers.
    AveragedDifference,
}

/// A controller as an experiment file describes it.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ControllerDescription {
    /// The structure of the loop.
    pub law: Law,
    /// Natural frequency of each loop in Hz, one for all or one per motor: the gains follow from the inertia.
    #[serde(default, deserialize_with = "one_or_each::list")]
    pub bandwidth_hz: Vec<f64>,
    /// Damping ratio of the loops where they are given by their bandwidth.
    #[serde(default = "one")]
    pub damping: f64,
    /// Position gains, one for all or one per motor, if they are known.
    #[serde(default, deserialize_with = "one_or_each::list")]
    pub position_gain: Vec<f64>,
    /// Velocity gains, one for all or one per motor, if they are known.
    #[serde(default, deserialize_with = "one_or_each::list")]
    pub velocity_gain: Vec<f64>,
    /// Fraction of the reference velocity that is fed forward.
    #[serde(default)]
    pub velocity_feed_forward: f64,
    /// Fraction of the reference acceleration, times the inertia, that is fed forward.
    #[serde(default)]
    pub acceleration_feed_forward: f64,
    /// Largest drive signal, one for all or one per motor; none means no limit.
    #[serde(default, deserialize_with = "one_or_each::list")]
    pub saturation: Vec<f64>,
    /// Time between samples in s; zero is a continuous controller.
    #[serde(default)]
    pub sample_time_s: f64,
    /// Time in s from a sample to the moment when its drive signal acts.
    #[serde(default)]
    pub delay_s: f64,
    /// What velocity the controller sees.
    #[serde(default)]
    pub velocity: VelocityEstimate,
    /// The user's own law, which acts in the place of `law` and its gains.
    #[serde(skip)]
    pub own: Option<OwnLaw>,
}

fn one() -> f64 {
    1.0
}

/// Why a controller description cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ControllerError {
    /// A list has neither one entry nor one for each motor.
    #[error("[controller] {key} has {found} entries, expected 1 or {motors} (one for each motor)")]
    WrongCount {
        /// The key.
        key: &'static str,
        /// Number of motors.
        motors: usize,
        /// Entries found.
        found: usize,
    },
    /// A value is out of its range.
    #[error("[controller] {key} is {found}, expected {expected}")]
    OutOfRange {
        /// The key.
        key: &'static str,
        /// What is allowed.
        expected: &'static str,
        /// The value.
        found: f64,
    },
    /// Both or neither of the two ways to give the gains.
    #[error("[controller] give either bandwidth_hz, or both position_gain and velocity_gain")]
    Gains,
    /// A continuous controller has no delay or sampled velocity.
    #[error("[controller] {key} needs a sampled controller: set sample_time_s")]
    NotSampled {
        /// The key.
        key: &'static str,
    },
    /// An open loop has no gains.
    #[error("[controller] {key} is not used by law = \"open-loop\": leave it out")]
    GainOfOpenLoop {
        /// The key.
        key: &'static str,
    },
    /// A law of the user's own has its gains in itself.
    #[error("[controller] {key} is not used by a law of your own: leave it out")]
    GainOfOwnLaw {
        /// The key.
        key: &'static str,
    },
}

/// A controller with its gains resolved, one loop for each motor.
#[derive(Debug, Clone, PartialEq)]
pub struct Controller {
    loops: Vec<Loop>,
    own: Option<ResolvedLaw>,
    /// Time between samples in s; zero is a continuous controller.
    pub sample_time_s: f64,
    /// Time in s from a sample to the moment when its drive signal acts.
    pub delay_s: f64,
    /// What velocity the controller sees.
    pub velocity: VelocityEstimate,
}

/// `u = kp e + kv (f_v dr - v) + f_j ddr`, limited: both laws come to this, with the cascade's gains multiplied out.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Loop {
    position: f64,
    velocity: f64,
    velocity_feed_forward: f64,
    acceleration_feed_forward: f64,
    limit: f64,
}

impl ControllerDescription {
    /// A continuous PD loop around each motor, critically damped at a bandwidth in Hz, with the velocity and acceleration
    /// of the reference fed forward: what to simulate where no more is known of the real controller.
    #[must_use]
    pub fn pd(bandwidth_hz: f64) -> Self {
        Self {
            law: Law::Pd,
            bandwidth_hz: vec![bandwidth_hz],
            damping: 1.0,
            position_gain: Vec::new(),
            velocity_gain: Vec::new(),
            velocity_feed_forward: 1.0,
            acceleration_feed_forward: 1.0,
            saturation: Vec::new(),
            sample_time_s: 0.0,
            delay_s: 0.0,
            velocity: VelocityEstimate::Exact,
            own: None,
        }
    }

    /// A continuous controller with a law of the user's own.
    #[must_use]
    pub fn own(law: impl ControlLaw + 'static) -> Self {
        let none = Self { bandwidth_hz: Vec::new(), velocity_feed_forward: 0.0, ..Self::pd(1.0) };
        Self { acceleration_feed_forward: 0.0, own: Some(OwnLaw::new(law)), ..none }
    }

    /// The same sampled, with a time between samples, and one from a sample to the moment when its drive signal acts, s.
    #[must_use]
    pub fn sampled(self, sample_time_s: f64, delay_s: f64) -> Self {
        Self { sample_time_s, delay_s, ..self }
    }

    /// The user's own law, if it has one.
    #[must_use]
    pub fn own_law(&self) -> Option<&dyn ControlLaw> {
        self.own.as_ref().map(OwnLaw::get)
    }

    /// Checks the description for `motors` motors.
    ///
    /// # Errors
    /// [`ControllerError`] with the key.
    pub fn validate(&self, motors: usize) -> Result<(), ControllerError> {
        let lists = [
            ("bandwidth_hz", &self.bandwidth_hz),
            ("position_gain", &self.position_gain),
            ("velocity_gain", &self.velocity_gain),
            ("saturation", &self.saturation),
        ];
        for (key, list) in lists {
            if ![0, 1, motors].contains(&list.len()) {
                return Err(ControllerError::WrongCount { key, motors, found: list.len() });
            }
            // A drive that turns its joint backwards has gains below zero.
            let is_gain = ["position_gain", "velocity_gain"].contains(&key);
            let (is_right, expected): (fn(f64) -> bool, _) = if is_gain {
                (|v| v.is_finite() && v != 0.0, "a number other than zero")
            } else {
                (|v| v.is_finite() && v > 0.0, "a number above zero")
            };
            if let Some(&found) = list.iter().find(|v| !is_right(**v)) {
                return Err(ControllerError::OutOfRange { key, expected, found });
            }
        }
        if let Some(law) = self.own_law() {
            return self.validate_own(law);
        }
        if self.is_open_loop() {
            return self.validate_open_loop();
        }
        let [by_bandwidth, kp, kv] =
            [&self.bandwidth_hz, &self.position_gain, &self.velocity_gain].map(|list| !list.is_empty());
        let given_once = if by_bandwidth { !kp && !kv } else { kp && kv };
        if !given_once {
            return Err(ControllerError::Gains);
        }
        self.validate_times()
    }

    /// The first key of a gain that is given.
    fn given_gain(&self) -> Option<&'static str> {
        let gains = [
            ("bandwidth_hz", self.bandwidth_hz.is_empty()),
            ("position_gain", self.position_gain.is_empty()),
            ("velocity_gain", self.velocity_gain.is_empty()),
            ("velocity_feed_forward", self.velocity_feed_forward == 0.0),
            ("acceleration_feed_forward", self.acceleration_feed_forward == 0.0),
        ];
        gains.into_iter().find(|(_, is_unused)| !is_unused).map(|(key, _)| key)
    }

    fn validate_open_loop(&self) -> Result<(), ControllerError> {
        let unused = [("saturation", self.saturation.is_empty()), ("delay_s", self.delay_s == 0.0)];
        let other = unused.into_iter().find(|(_, is_unused)| !is_unused).map(|(key, _)| key);
        match self.given_gain().or(other) {
            Some(key) => Err(ControllerError::GainOfOpenLoop { key }),
            None => self.validate_times(),
        }
    }

    fn validate_own(&self, law: &dyn ControlLaw) -> Result<(), ControllerError> {
        if let Some(key) = self.given_gain() {
            return Err(ControllerError::GainOfOwnLaw { key });
        }
        if law.memory() > 0 && self.sample_time_s == 0.0 {
            return Err(ControllerError::NotSampled { key: "the memory of a law" });
        }
        self.validate_times()
    }

    fn validate_times(&self) -> Result<(), ControllerError> {
        for (key, found) in [
            ("damping", self.damping),
            ("velocity_feed_forward", self.velocity_feed_forward),
            ("acceleration_feed_forward", self.acceleration_feed_forward),
            ("sample_time_s", self.sample_time_s),
            ("delay_s", self.delay_s),
        ] {
            if !(found.is_finite() && found >= 0.0) {
                return Err(ControllerError::OutOfRange { key, expected: "zero or a positive number", found });
            }
        }
        let sampled = self.sample_time_s > 0.0;
        if !sampled && self.delay_s > 0.0 {
            return Err(ControllerError::NotSampled { key: "delay_s" });
        }
        if !sampled && self.velocity == VelocityEstimate::AveragedDifference {
            return Err(ControllerError::NotSampled { key: "velocity = \"averaged-difference\"" });
        }
        Ok(())
    }

    /// Whether the recorded drive signals act in the place of a controller's.
    #[doc(hidden)]
    #[must_use]
    pub fn is_open_loop(&self) -> bool {
        self.law == Law::OpenLoop && self.own.is_none()
    }

    /// Whether the gains follow from the inertia.
    #[must_use]
    pub fn needs_inertia(&self) -> bool {
        !self.bandwidth_hz.is_empty() || self.acceleration_feed_forward > 0.0
    }

    /// The controller for motors whose inertia, as drive signal per acceleration in joint units, is `inertia`; all gains
    /// but the feed-forward of the reference are multiplied by `scale`. The description must be valid.
    #[must_use]
    pub fn resolve(&self, inertia: &[f64], scale: f64) -> Controller {
        let pick = |list: &[f64], i: usize| list.get(i).or(list.first()).copied();
        let resolve_loop = |(i, &j): (usize, &f64)| {
            let (position, velocity) = match pick(&self.bandwidth_hz, i) {
                Some(hz) => self.gains_of_bandwidth(hz, j),
                None => self.known_gains(&pick, i),
            };
            Loop {
                position: scale * position,
                velocity: scale * velocity,
                velocity_feed_forward: self.velocity_feed_forward,
                acceleration_feed_forward: scale * self.acceleration_feed_forward * j,
                limit: pick(&self.saturation, i).unwrap_or(f64::INFINITY),
            }
        };
        Controller {
            loops: inertia.iter().enumerate().map(resolve_loop).collect(),
            own: self.own.clone().map(|law| ResolvedLaw::new(law, scale, inertia.len())),
            sample_time_s: self.sample_time_s,
            delay_s: self.delay_s,
            velocity: self.velocity,
        }
    }

    /// The description for some of the motors; none of a law of the user's own, which knows motors by their numbers.
    #[doc(hidden)]
    #[must_use]
    pub fn of_motors(&self, motors: &[usize]) -> Option<Self> {
        let part = |list: &[f64]| match list {
            [] | [_] => list.to_vec(),
            all => motors.iter().map(|&i| all[i]).collect(),
        };
        self.own.is_none().then(|| Self {
            bandwidth_hz: part(&self.bandwidth_hz),
            position_gain: part(&self.position_gain),
            velocity_gain: part(&self.velocity_gain),
            saturation: part(&self.saturation),
            ..self.clone()
        })
    }

    /// States the position and velocity gains of each motor, those for its inertia where a bandwidth gave them.
    #[doc(hidden)]
    pub fn state_gains(&mut self, inertia: &[f64]) {
        let pick = |list: &[f64], i: usize| list.get(i).or(list.first()).copied();
        let gains = |(i, &j): (usize, &f64)| match pick(&self.bandwidth_hz, i) {
            None => (pick(&self.position_gain, i).unwrap_or(0.0), pick(&self.velocity_gain, i).unwrap_or(0.0)),
            Some(hz) => {
                let (position, velocity) = self.gains_of_bandwidth(hz, j);
                match self.law {
                    Law::Pd => (position, velocity),
                    Law::Cascaded => (position / velocity, velocity),
                    Law::OpenLoop => (0.0, 0.0),
                }
            }
        };
        let (position, velocity) = inertia.iter().enumerate().map(gains).unzip();
        (self.position_gain, self.velocity_gain, self.bandwidth_hz) = (position, velocity, Vec::new());
    }

    /// Drive signal per position error and per velocity of a loop of this natural frequency around an inertia.
    fn gains_of_bandwidth(&self, hz: f64, inertia: f64) -> (f64, f64) {
        (inertia * (TAU * hz).powi(2), 2.0 * self.damping * TAU * hz * inertia)
    }

    fn known_gains(&self, pick: &dyn Fn(&[f64], usize) -> Option<f64>, i: usize) -> (f64, f64) {
        let kp = pick(&self.position_gain, i).unwrap_or(0.0);
        let kv = pick(&self.velocity_gain, i).unwrap_or(0.0);
        match self.law {
            Law::Pd => (kp, kv),
            Law::Cascaded => (kp * kv, kv),
            Law::OpenLoop => (0.0, 0.0),
        }
    }
}

impl Controller {
    /// The drive signal of motor `i`.
    #[inline]
    #[must_use]
    pub fn command(&self, i: usize, e: f64, v: f64, dr: f64, ddr: f64) -> f64 {
        let l = &self.loops[i];
        if let Some(own) = &self.own {
            return own.command(&LawInput::new(i, [e, v, dr, ddr])).clamp(-l.limit, l.limit);
        }
        let u = l.position * e + l.velocity * (l.velocity_feed_forward * dr - v) + l.acceleration_feed_forward * ddr;
        u.clamp(-l.limit, l.limit)
    }

    /// The drive signal of motor `i` at a sample: a law of the user's own takes note of it.
    pub(crate) fn sample(&mut self, i: usize, e: f64, v: f64, dr: f64, ddr: f64) -> f64 {
        let limit = self.loops[i].limit;
        match &mut self.own {
            Some(own) => own.sample(&LawInput::new(i, [e, v, dr, ddr])).clamp(-limit, limit),
            None => self.command(i, e, v, dr, ddr),
        }
    }

    /// What one more of position and of velocity takes away from the drive signal of motor `i`: its gains, or zeros where
    /// the limit acts.
    #[inline]
    #[must_use]
    pub fn slopes(&self, i: usize, e: f64, v: f64, dr: f64, ddr: f64) -> [f64; 2] {
        if self.is_limited(i, e, v, dr, ddr) {
            return [0.0; 2];
        }
        match &self.own {
            Some(own) => own.slopes(&LawInput::new(i, [e, v, dr, ddr])),
            None => [self.loops[i].position, self.loops[i].velocity],
        }
    }

    /// Whether the limit acts on the drive signal of motor `i`.
    #[inline]
    #[must_use]
    pub fn is_limited(&self, i: usize, e: f64, v: f64, dr: f64, ddr: f64) -> bool {
        self.command(i, e, v, dr, ddr).abs() >= self.loops[i].limit
    }

    /// The drive signal of motor `i` before its limit, as a sum: `kp e`, `kv (f_v dr - v)` and `f_a J ddr`.
    #[inline]
    #[must_use]
    pub fn parts(&self, i: usize, e: f64, v: f64, dr: f64, ddr: f64) -> [f64; 3] {
        let l = &self.loops[i];
        [l.position * e, l.velocity * (l.velocity_feed_forward * dr - v), l.acceleration_feed_forward * ddr]
    }

    /// The derivative of a user's own law at motor `i` in a direction of error, velocity, and velocity and acceleration of the
    /// reference; none of a built-in law, whose [`Controller::parts`] are linear.
    pub(crate) fn derivative_of_own(&self, i: usize, state: [f64; 4], by: [f64; 4]) -> Option<f64> {
        let own = self.own.as_ref()?;
        let size = by.iter().fold(1.0_f64, |size, v| size.max(v.abs()));
        let step = f64::EPSILON.cbrt() / size;
        let at = |factor: f64| own.command(&LawInput::new(i, std::array::from_fn(|k| state[k] + factor * by[k])));
        Some((at(step) - at(-step)) / (2.0 * step))
    }

    /// Number of motors.
    #[must_use]
    pub fn motors(&self) -> usize {
        self.loops.len()
    }

    /// Whether the controller acts at samples only.
    #[must_use]
    pub fn is_sampled(&self) -> bool {
        self.sample_time_s > 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn described(text: &str) -> ControllerDescription {
        toml::from_str(text).unwrap()
    }

    #[test]
    fn a_cascade_multiplies_its_gains() {
        let d = described("law = \"cascaded\"\nposition_gain = [160.0]\nvelocity_gain = [240.0]\nsaturation = [10.0]");
        d.validate(1).unwrap();
        let c = d.resolve(&[1.0], 1.0);
        let (e, v) = (1e-4, 0.01);
        assert!((c.command(0, e, v, 5.0, 0.0) - 240.0 * (160.0 * e - v)).abs() < 1e-12);
        assert_eq!(c.command(0, 1.0, 0.0, 0.0, 0.0), 10.0);
    }

    #[test]
    fn a_number_is_for_all_motors() {
        let list = described("law = \"pd\"\nposition_gain = [5, 5]\nvelocity_gain = [2.0, 2.0]\nsaturation = [3, 3]");
        let scalar = described("law = \"pd\"\nposition_gain = 5\nvelocity_gain = 2.0\nsaturation = 3");
        scalar.validate(2).unwrap();
        assert_eq!(list.resolve(&[1.0, 1.0], 1.0), scalar.resolve(&[1.0, 1.0], 1.0));
        assert_eq!(described("law = \"pd\"\nbandwidth_hz = 20").bandwidth_hz, [20.0]);
    }

    #[test]
    fn a_bandwidth_places_the_poles() {
        let d = described("law = \"pd\"\nbandwidth_hz = [40.0]\ndamping = 0.7");
        let c = d.resolve(&[2.0], 1.0);
        let w = TAU * 40.0;
        assert!((c.command(0, 1.0, 0.0, 0.0, 0.0) - 2.0 * w * w).abs() < 1e-9);
        assert!((c.command(0, 0.0, 1.0, 0.0, 0.0) + 2.0 * 0.7 * w * 2.0).abs() < 1e-9);
    }

    #[test]
    fn bandwidth_and_gains_exclude_one_another() {
        let d = described("law = \"pd\"\nbandwidth_hz = [40.0]\nposition_gain = [1.0]");
        assert_eq!(d.validate(6), Err(ControllerError::Gains));
    }

    #[test]
    fn an_open_loop_has_no_gains_and_asks_for_nothing() {
        let d = described("law = \"open-loop\"\nsample_time_s = 0.001");
        assert_eq!((d.validate(6), d.resolve(&[1.0], 1.0).command(0, 1.0, 2.0, 3.0, 4.0)), (Ok(()), 0.0));
        for (gain, key) in [("position_gain = 3", "position_gain"), ("saturation = 3", "saturation")] {
            let d = described(&format!("law = \"open-loop\"\n{gain}"));
            assert_eq!(d.validate(6), Err(ControllerError::GainOfOpenLoop { key }));
        }
    }

    #[test]
    fn a_list_of_the_wrong_length_is_refused() {
        let d = described("law = \"pd\"\nbandwidth_hz = [40.0, 30.0]");
        assert!(matches!(d.validate(6), Err(ControllerError::WrongCount { found: 2, .. })));
    }

    #[test]
    fn a_continuous_controller_has_no_delay() {
        let d = described("law = \"pd\"\nbandwidth_hz = [40.0]\ndelay_s = 0.001");
        assert!(matches!(d.validate(6), Err(ControllerError::NotSampled { .. })));
    }
}
