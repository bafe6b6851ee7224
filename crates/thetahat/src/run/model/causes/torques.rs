//! The derivatives of the predicted torque by what can be wrong.

use super::{cause::Cause, signal_rows::SignalRows, tested_rows::TestedRows};
use crate::{
    preparation::{EstimatedSize, FilteredRecording, Problem},
    run::{identification::Identification, model::kinds},
};
use statrs::statistics::Statistics;
use thetahat_estimation::{
    identification::Assembly,
    signal::{Derivative, Motion, Padding, SecondOrderSections, zero_phase},
    statistics::median,
};
use thetahat_ground::{pool::in_parallel, series::Series, vector::IDENTITY};
use thetahat_model::{
    dynamics::{DynamicParameters, Model, Sign, State, Workspace},
    robot::{INERTIAL, JointKind, Quantity, Robot},
};
use thetahat_report::results::CauseKind;

/// Instants at which a payload may have been picked up, or offsets may have changed.
const INSTANTS: usize = 15;
/// Step of the differences: of a ratio, rad or m.
pub(super) const STEP: f64 = 1e-3;
/// Velocities of the laws of friction over speed, over the peak velocity of the joint.
pub(super) const SPEEDS: [f64; 2] = [0.05, 0.2];
/// The filter's cut-off over that of the torques whose slope a delay is measured by, and its order.
const SMOOTHER: f64 = 5.0;
const SMOOTHING_ORDER: usize = 4;
/// Compliance of the difference for elastic joints, rad per N m.
const COMPLIANCE: f64 = 1e-6;

/// Friction of a joint over the rest of its torque from which it is no witness of a delay: friction that builds up over a way looks late.
const MOST_FRICTION: f64 = 1.3;
/// Joints up to which crosstalk is tested between all pairs, whose number grows with the square; of more between neighbours.
const ALL_PAIRS: usize = 8;
/// Names of the axes of a frame.
const AXES: [&str; 3] = ["x", "y", "z"];

/// What is tried.
#[derive(Debug, Clone, Copy)]
enum Tried {
    LateTorque(Option<usize>),
    TorqueFilter,
    TimeScale,
    LoadFriction,
    SpeedFriction,
    FrictionDrift,
    OffsetDrift,
    Zero(usize),
    Gear(usize),
    DriveGain(usize),
    Elastic(usize),
    Length(usize, usize),
    Coupling(usize),
    Gravity(usize),
    Crosstalk([usize; 2]),
    FallingConstant(usize),
    Spring(usize),
    Asymmetric(usize),
    LatePosition(usize),
    GainDrift(Option<usize>),
}

pub(super) struct Torques<'a> {
    pub(super) identification: &'a Identification,
    pub(super) problem: &'a Problem,
    pub(super) tested: &'a TestedRows<'a>,
    pub(super) standard: &'a [f64],
    pub(super) sign: Sign,
    /// Whether each joint turns or slides.
    pub(super) kinds: Vec<JointKind>,
    pub(super) robot: &'a Robot,
    /// Of each recording, with the model as it is.
    pub(super) predicted: Vec<Series>,
    /// Of each recording, the torques of the bodies alone, and their first and second derivatives.
    pub(super) of_bodies: Vec<[Series; 3]>,
    /// Signals of all joints in the tested rows, of which those of one joint are a cause's column.
    signals: SignalRows,
}

impl<'a> Torques<'a> {
    pub(super) fn new(
        identification: &'a Identification,
        problem: &'a Problem,
        tested: &'a TestedRows<'a>,
        standard: &'a [f64],
        sign: Sign,
    ) -> Option<Self> {
        let (robot, kinds) = (identification.setup().robot, kinds(identification.setup()));
        let (predicted, of_bodies, signals) = (Vec::new(), Vec::new(), SignalRows::default());
        let mut torques =
            Self { identification, problem, tested, standard, sign, kinds, robot, predicted, of_bodies, signals };
        let predicted = |r: &FilteredRecording| torques.of(&torques.problem.model, standard, &r.motion, r);
        torques.predicted = torques.recordings().map(predicted).collect::<Option<Vec<_>>>()?;
        torques.of_bodies = torques.torques_of_bodies()?;
        torques.signals = torques.signals();
        Some(torques)
    }

    pub(super) fn recordings(&self) -> impl Iterator<Item = &'a FilteredRecording> {
        self.identification.main.iter().map(|p| &p.filtered)
    }

    pub(super) fn joints(&self) -> usize {
        self.problem.model.coordinate_count()
    }

    /// The torques of a motion; none for parameters that the model does not have.
    pub(super) fn of(
        &self,
        model: &Model,
        standard: &[f64],
        motion: &Motion,
        recording: &FilteredRecording,
    ) -> Option<Series> {
        let parameters = DynamicParameters::new(model, standard).ok()?;
        let mut workspace = Workspace::new(model);
        let mut torque = Series::zeros(motion.q.len(), motion.q.channels());
        let channels = recording.channels_in_window();
        for k in 0..torque.len() {
            let mut state = State::new(motion.q.sample(k), motion.dq.sample(k));
            if let Some(channels) = &channels {
                state = state.with_channels(channels.sample(k));
            }
            let tau = torque.sample_mut(k);
            model.inverse_dynamics(&parameters, state, motion.ddq.sample(k), self.sign, &mut workspace, tau);
        }
        Some(torque)
    }

    /// A column in the tested rows, from the torques of each recording.
    pub(super) fn column(&self, torques: Vec<Series>) -> Option<Vec<f64>> {
        Some(self.tested.select(self.column_of_all(&torques)?))
    }

    /// The same in all rows.
    fn column_of_all(&self, torques: &[Series]) -> Option<Vec<f64>> {
        let mut parts = Vec::new();
        for (torque, decimator) in torques.iter().zip(&self.tested.all.decimators) {
            let assembly = Assembly::new(&self.problem.model, &[], decimator.clone());
            parts.push(assembly.measurement_vector(torque).ok()?);
        }
        Some(self.tested.all.layout.stack_vectors(parts))
    }

    /// The torques that `changed` gives, as differences over a step.
    pub(super) fn differences(
        &self,
        step: f64,
        changed: impl Fn(&FilteredRecording) -> Option<Series>,
    ) -> Option<Vec<Series>> {
        let mut torques = Vec::new();
        for (recording, predicted) in self.recordings().zip(&self.predicted) {
            let mut torque = changed(recording)?;
            let pairs = torque.values_mut().iter_mut().zip(predicted.values());
            pairs.for_each(|(t, p)| *t = (*t - p) / step);
            torques.push(torque);
        }
        Some(torques)
    }

    /// The column of one number for each sample and joint.
    pub(super) fn each(&self, value: impl Fn(&FilteredRecording, usize, usize) -> f64) -> Option<Vec<f64>> {
        let torques = self.recordings().map(|recording| {
            let mut torque = Series::zeros(recording.motion.q.len(), self.joints());
            for k in 0..torque.len() {
                torque.sample_mut(k).iter_mut().enumerate().for_each(|(j, t)| *t = value(recording, k, j));
            }
            torque
        });
        self.column(torques.collect())
    }

    /// Everything that is tested, of what the motion can show.
    pub(super) fn causes(&self, threads: usize) -> Vec<Cause> {
        let tried = self.tried();
        let found: Vec<Cause> =
            in_parallel(tried.len(), threads, |k| self.cause(tried[k])).into_iter().flatten().collect();
        let together = [CauseKind::EncoderZero, CauseKind::GearRatio, CauseKind::DriveGain, CauseKind::Length]
            .map(|k| Cause::together(k, &found));
        found.iter().cloned().chain(together.into_iter().flatten()).chain(self.instants(&found)).collect()
    }

    fn tried(&self) -> Vec<Tried> {
        let joints = self.joints();
        let revolute = (0..joints).filter(|&j| self.kind(j) == JointKind::Revolute);
        let lengths = (1..self.robot.joints.len()).flat_map(|k| (0..3).map(move |axis| Tried::Length(k, axis)));
        let mut tried = vec![
            Tried::LateTorque(None),
            Tried::TorqueFilter,
            Tried::TimeScale,
            Tried::LoadFriction,
            Tried::SpeedFriction,
            Tried::FrictionDrift,
            Tried::OffsetDrift,
            Tried::GainDrift(None),
        ];
        let driven: Vec<usize> = (0..joints).filter(|&j| self.is_driven(j)).collect();
        tried.extend((0..joints).flat_map(|j| [Tried::Zero(j), Tried::Gear(j)]));
        tried.extend(driven.iter().copied().map(Tried::DriveGain));
        tried.extend(revolute.map(Tried::Elastic));
        tried.extend(lengths);
        tried.extend((1..joints).map(|j| Tried::Coupling(j - 1)));
        if joints > 1 {
            let friction = self.friction_shares().unwrap_or_else(|| vec![0.0; joints]);
            let without_friction = driven.iter().copied().filter(|&j| friction[j] < MOST_FRICTION);
            tried.extend(without_friction.map(|j| Tried::LateTorque(Some(j))));
            tried.extend(driven.iter().map(|&j| Tried::GainDrift(Some(j))));
        }
        tried.extend((0..3).filter(|&axis| self.can_tilt_about(axis)).map(Tried::Gravity));
        let is_near = |from: usize, into: usize| joints <= ALL_PAIRS || from.abs_diff(into) == 1;
        let others = |from: usize| (0..joints).filter(move |&into| into != from && is_near(from, into));
        tried.extend(driven.iter().flat_map(|&from| others(from).map(move |into| Tried::Crosstalk([from, into]))));
        tried.extend(driven.into_iter().map(Tried::FallingConstant));
        tried.extend((0..joints).flat_map(|j| [Tried::Spring(j), Tried::Asymmetric(j)]));
        if joints > 1 {
            tried.extend((0..joints).map(Tried::LatePosition));
        }
        tried
    }

    /// Whether a joint has a torque that is not zero: what is predicted for others is their residual.
    fn is_driven(&self, joint: usize) -> bool {
        let mut torques = self.recordings().filter_map(|recording| recording.recording.torque.as_ref());
        torques.any(|torque| torque.channel(joint).iter().any(|torque| *torque != 0.0))
    }

    /// Standard deviation of each joint's predicted friction over that of the rest of its torque.
    fn friction_shares(&self) -> Option<Vec<f64>> {
        let table = self.problem.model.parameter_table();
        let bodies: Vec<f64> = table
            .iter()
            .zip(self.standard)
            .map(|(parameter, value)| if parameter.quantity.is_friction() { 0.0 } else { *value })
            .collect();
        let rests: Vec<Series> =
            self.recordings().map(|r| self.of(&self.problem.model, &bodies, &r.motion, r)).collect::<Option<_>>()?;
        let share = |j: usize| {
            let rest: Vec<f64> = rests.iter().flat_map(|rest| rest.channel(j)).collect();
            let all = self.predicted.iter().flat_map(|torque| torque.channel(j));
            let friction = all.zip(&rest).map(|(all, rest)| all - rest);
            friction.population_std_dev() / rest.iter().population_std_dev()
        };
        Some((0..self.joints()).map(share).collect())
    }

    fn cause(&self, tried: Tried) -> Option<Cause> {
        let (kind, subject, unit) = self.named(tried);
        let columns = self.columns(tried).into_iter().collect::<Option<Vec<_>>>().filter(|c| !c.is_empty())?;
        let instrument = if let Tried::LateTorque(j) = tried {
            self.late_instrument(j)
        } else {
            self.signals.smoothed_filtered.clone().filter(|_| kind == CauseKind::TorqueFilter)
        };
        Some(Cause { kind, subject, unit, columns, instrument, members: Vec::new(), searched: 1 })
    }

    /// Kind, subject and unit.
    fn named(&self, tried: Tried) -> (CauseKind, String, &'static str) {
        let joint = |j: usize| format!("joint {}", j + 1);
        let all = String::new;
        let unit = |j: usize, turns: &'static str, slides| match self.kind(j) {
            JointKind::Revolute => turns,
            JointKind::Prismatic => slides,
        };
        match tried {
            Tried::LateTorque(j) => (CauseKind::LateTorque, j.map_or_else(all, joint), "s"),
            Tried::TimeScale => (CauseKind::TimeScale, all(), ""),
            Tried::TorqueFilter => (CauseKind::TorqueFilter, all(), "s"),
            Tried::GainDrift(j) => (CauseKind::GainDrift, j.map_or_else(all, joint), ""),
            Tried::LoadFriction => (CauseKind::LoadFriction, all(), ""),
            Tried::SpeedFriction => (CauseKind::SpeedFriction, all(), ""),
            Tried::FrictionDrift => (CauseKind::FrictionDrift, all(), ""),
            Tried::OffsetDrift => (CauseKind::OffsetDrift, all(), ""),
            Tried::Zero(j) => (CauseKind::EncoderZero, joint(j), unit(j, "rad", "m")),
            Tried::Gear(j) => (CauseKind::GearRatio, joint(j), ""),
            Tried::DriveGain(j) => (CauseKind::DriveGain, joint(j), ""),
            Tried::Elastic(j) => (CauseKind::Elasticity, joint(j), "rad/(N m)"),
            Tried::Length(k, axis) => (CauseKind::Length, self.place_of(k, axis), "m"),
            Tried::Coupling(j) => (CauseKind::Coupling, format!("joints {} and {}", j + 1, j + 2), ""),
            Tried::Gravity(axis) => (CauseKind::GravityDirection, format!("about {}", AXES[axis]), "rad"),
            Tried::Crosstalk([from, into]) => {
                (CauseKind::Crosstalk, format!("joint {} in joint {}", from + 1, into + 1), "")
            }
            Tried::FallingConstant(j) => (CauseKind::FallingConstant, joint(j), ""),
            Tried::Spring(j) => (CauseKind::JointSpring, joint(j), unit(j, "N m/rad", "N/m")),
            Tried::LatePosition(j) => (CauseKind::LatePosition, joint(j), "s"),
            Tried::Asymmetric(j) => (CauseKind::AsymmetricFriction, joint(j), unit(j, "N m s/rad", "N s/m")),
        }
    }

    fn columns(&self, tried: Tried) -> Vec<Option<Vec<f64>>> {
        match tried {
            Tried::LateTorque(None) => vec![self.signals.late.clone()],
            Tried::LateTorque(Some(j)) => vec![self.of_joint(&self.signals.late, j)],
            Tried::TimeScale => vec![self.time_scale().and_then(|torques| self.column(torques))],
            Tried::TorqueFilter => vec![self.signals.filtered.clone()],
            Tried::GainDrift(None) => vec![self.signals.aging.clone()],
            Tried::GainDrift(Some(j)) => vec![self.of_joint(&self.signals.aging, j)],
            Tried::LoadFriction => {
                let kinds = self.signals.gravity_friction.iter().chain(&self.signals.load_friction);
                kinds.flat_map(|rows| self.of_each_joint(rows)).collect()
            }
            Tried::SpeedFriction => self.speed_friction(),
            Tried::FrictionDrift => self.friction_drift(),
            Tried::OffsetDrift => self.of_each_joint(&self.signals.time),
            Tried::Zero(j) => vec![self.moved_zero(j).and_then(|torques| self.column(torques))],
            Tried::Gear(j) => vec![self.gear(j).and_then(|torques| self.column(torques))],
            Tried::DriveGain(j) => vec![self.of_joint(&self.signals.torque, j)],
            Tried::Elastic(j) => vec![self.elastic(j)],
            Tried::Length(k, axis) => vec![self.length(k, axis).and_then(|torques| self.column(torques))],
            Tried::Coupling(j) => self.coupling(j),
            Tried::Gravity(axis) => vec![self.tilt(axis).and_then(|torques| self.column(torques))],
            Tried::Crosstalk([from, into]) => vec![self.moved(&self.signals.torque, from, into)],
            Tried::FallingConstant(j) => vec![self.of_joint(&self.signals.cube, j)],
            Tried::Spring(j) => vec![self.of_joint(&self.signals.position, j)],
            Tried::LatePosition(j) => vec![self.late_position(j)],
            Tried::Asymmetric(j) => vec![self.of_joint(&self.signals.speed, j)],
        }
    }

    fn late_instrument(&self, joint: Option<usize>) -> Option<Vec<f64>> {
        let smoothed = &self.signals.smoothed_late;
        joint.map_or_else(|| smoothed.clone(), |j| self.of_joint(smoothed, j))
    }

    pub(super) fn kind(&self, j: usize) -> JointKind {
        self.robot.joints[self.robot.joint_of(j)].kind
    }

    /// The columns, in all rows, of a size that was estimated from the recordings.
    pub(super) fn of_estimated(&self, size: EstimatedSize) -> Vec<Vec<f64>> {
        let of_joint = |number: usize, torques: &dyn Fn(usize) -> Option<Vec<Series>>| {
            vec![self.robot.coordinate_of_number(number).and_then(torques)]
        };
        let slopes = || self.slopes(&self.predicted);
        let torques = match size {
            EstimatedSize::GearRatio(joint) => of_joint(joint, &|j| self.gear(j)),
            EstimatedSize::PositionScale(joint) => of_joint(joint, &|j| self.scaled_position(j)),
            EstimatedSize::DriveGain(joint) => of_joint(joint, &|j| Some(self.of_one_joint(&self.predicted, j))),
            EstimatedSize::Lag(Some(joint)) => of_joint(joint, &|j| Some(self.of_one_joint(&slopes(), j))),
            EstimatedSize::Lag(None) => vec![Some(slopes())],
            EstimatedSize::TorqueFilter => vec![Some(self.slopes(&slopes()))],
            EstimatedSize::GravityDirection => {
                (0..3).filter(|&axis| self.can_tilt_about(axis)).map(|axis| self.tilt(axis)).collect()
            }
        };
        torques.into_iter().flatten().filter_map(|torques| self.column_of_all(&torques)).collect()
    }

    /// Torques that are d late are `tau - d dtau/dt`, by the slope of the predicted torque, which has no noise.
    pub(super) fn slopes(&self, torques: &[Series]) -> Vec<Series> {
        let slopes = self.recordings().zip(torques).map(|(recording, torque)| {
            let mut slope = Derivative::Central.of(torque, recording.recording.sample_rate_hz);
            slope.values_mut().iter_mut().for_each(|v| *v = -*v);
            slope
        });
        slopes.collect()
    }

    /// The predicted torques without the noise that the loop brings into both the motion and the torques.
    pub(super) fn smoothed(&self) -> Option<Vec<Series>> {
        let cutoff_hz = self.identification.setup().settings.signal.cutoff_hz / SMOOTHER;
        let smoothed = |(recording, torque): (&FilteredRecording, &Series)| {
            let rate = recording.recording.sample_rate_hz;
            let filter = SecondOrderSections::butterworth_lowpass(SMOOTHING_ORDER, cutoff_hz, rate).ok()?;
            zero_phase(&filter, torque, Padding::Matlab).ok()
        };
        self.recordings().zip(&self.predicted).map(smoothed).collect()
    }

    /// The torques of one joint; those of the others are zero.
    fn of_one_joint(&self, torques: &[Series], joint: usize) -> Vec<Series> {
        let n = self.joints();
        let mut all = torques.to_vec();
        let values = all.iter_mut().flat_map(|torque| torque.values_mut().iter_mut().enumerate());
        values.filter(|(i, _)| i % n != joint).for_each(|(_, tau)| *tau = 0.0);
        all
    }

    fn moved_zero(&self, j: usize) -> Option<Vec<Series>> {
        self.differences(STEP, |recording| {
            let mut motion = recording.motion.clone();
            (0..motion.q.len()).for_each(|k| motion.q.sample_mut(k)[j] += STEP);
            self.of(&self.problem.model, self.standard, &motion, recording)
        })
    }

    /// Positions that are too large by a ratio, and torques that are too small by it.
    fn gear(&self, j: usize) -> Option<Vec<Series>> {
        self.differences(STEP, |recording| {
            let mut torque = self.of_scaled_position(recording, j)?;
            (0..torque.len()).for_each(|k| torque.sample_mut(k)[j] /= 1.0 + STEP);
            Some(torque)
        })
    }

    /// Positions that are too large by a ratio.
    fn scaled_position(&self, j: usize) -> Option<Vec<Series>> {
        self.differences(STEP, |recording| self.of_scaled_position(recording, j))
    }

    /// The torques with positions of a joint that are smaller by the step.
    fn of_scaled_position(&self, recording: &FilteredRecording, j: usize) -> Option<Series> {
        let mut motion = recording.motion.clone();
        for series in [&mut motion.q, &mut motion.dq, &mut motion.ddq] {
            (0..series.len()).for_each(|k| series.sample_mut(k)[j] /= 1.0 + STEP);
        }
        self.of(&self.problem.model, self.standard, &motion, recording)
    }

    /// Times that are too long by a ratio: velocities and accelerations are larger.
    fn time_scale(&self) -> Option<Vec<Series>> {
        self.differences(STEP, |recording| {
            let mut motion = recording.motion.clone();
            motion.dq.values_mut().iter_mut().for_each(|dq| *dq *= 1.0 + STEP);
            motion.ddq.values_mut().iter_mut().for_each(|ddq| *ddq *= (1.0 + STEP).powi(2));
            self.of(&self.problem.model, self.standard, &motion, recording)
        })
    }

    /// A length as a description states it: the origin of a joint in the axes of the link that carries it.
    fn place_of(&self, joint: usize, axis: usize) -> String {
        let link = self.robot.joints[joint].parent.map_or(0, |parent| parent + 1);
        format!("link {link} along {} (origin of joint {})", AXES[axis], joint + 1)
    }

    fn length(&self, joint: usize, axis: usize) -> Option<Vec<Series>> {
        let mut robot = self.robot.clone();
        let axes_of = |parent: usize| robot.joints[parent].link_axes;
        let axes = robot.joints[joint].parent.and_then(axes_of).unwrap_or(IDENTITY);
        let origin = &mut robot.joints[joint].placement.origin;
        origin.iter_mut().zip(&axes).for_each(|(coordinate, row)| *coordinate += STEP * row[axis]);
        let model = Model::new(&robot);
        self.differences(STEP, |r| self.of(&model, self.standard, &r.motion, r))
    }

    fn torques_of_bodies(&self) -> Option<Vec<[Series; 3]>> {
        let bodies = self.only(|quantity| quantity.is_inertial());
        let of_bodies = |recording: &FilteredRecording| {
            let torque = self.of(&self.problem.model, &bodies, &recording.motion, recording)?;
            let first = Derivative::Central.of(&torque, recording.recording.sample_rate_hz);
            let second = Derivative::Central.of(&first, recording.recording.sample_rate_hz);
            Some([torque, first, second])
        };
        self.recordings().map(of_bodies).collect()
    }

    /// The link of an elastic joint is at `q - tau / k`, where the encoder is at the motor.
    fn elastic(&self, j: usize) -> Option<Vec<f64>> {
        let negative = |series: &Series| series.channel(j).iter().map(|value| -value).collect();
        self.moved_bodies(j, COMPLIANCE, |_, of_bodies| of_bodies.each_ref().map(negative))
    }

    /// Positions of a joint that are those of a moment before: `q + s dq` now. What it makes of a joint's own friction is that of a late
    /// torque.
    fn late_position(&self, j: usize) -> Option<Vec<f64>> {
        self.moved_bodies(j, STEP, |recording, _| {
            let [dq, ddq] = [&recording.motion.dq, &recording.motion.ddq].map(|series| series.channel(j));
            let ddq = Series::shaped(1, ddq);
            let jerk = Derivative::Central.of(&ddq, recording.recording.sample_rate_hz);
            [dq, ddq.into_values(), jerk.into_values()]
        })
    }

    /// The derivative of the bodies' torques by a change of a joint's position, which has this shape with its two derivatives.
    fn moved_bodies(
        &self,
        j: usize,
        step: f64,
        shape: impl Fn(&FilteredRecording, &[Series; 3]) -> [Vec<f64>; 3],
    ) -> Option<Vec<f64>> {
        let bodies = self.only(|quantity| quantity.is_inertial());
        let mut torques = Vec::new();
        for (recording, of_bodies) in self.recordings().zip(&self.of_bodies) {
            let Motion { mut q, mut dq, mut ddq } = recording.motion.clone();
            for (series, change) in [&mut q, &mut dq, &mut ddq].into_iter().zip(shape(recording, of_bodies)) {
                change.iter().enumerate().for_each(|(k, change)| series.sample_mut(k)[j] += step * change);
            }
            let mut torque = self.of(&self.problem.model, &bodies, &Motion { q, dq, ddq }, recording)?;
            let pairs = torque.values_mut().iter_mut().zip(of_bodies[0].values());
            pairs.for_each(|(t, p)| *t = (*t - p) / step);
            torques.push(torque);
        }
        self.column(torques)
    }

    pub(super) fn only(&self, keep: impl Fn(Quantity) -> bool) -> Vec<f64> {
        let table = self.problem.model.parameter_table();
        table.iter().zip(self.standard).map(|(p, v)| if keep(p.quantity) { *v } else { 0.0 }).collect()
    }

    /// A motor that turns with two joints has its inertia and friction in both.
    fn coupling(&self, i: usize) -> Vec<Option<Vec<f64>>> {
        if !self.problem.model.coupled_motors().is_empty() || self.kinds[i] != self.kinds[i + 1] {
            return Vec::new();
        }
        let crossed = |of: fn(&Motion) -> &Series| {
            self.each(move |r, k, j| {
                let values = of(&r.motion).sample(k);
                if j == i {
                    values[i + 1]
                } else if j == i + 1 {
                    values[i]
                } else {
                    0.0
                }
            })
        };
        let friction = self.each(|r, k, j| {
            let dq = r.motion.dq.sample(k);
            if j == i || j == i + 1 { self.sign.of(dq[i] + dq[i + 1], self.kinds[i]) } else { 0.0 }
        });
        vec![crossed(|m| &m.ddq), crossed(|m| &m.dq), friction]
    }

    fn of_each_joint(&self, rows: &Option<Vec<f64>>) -> Vec<Option<Vec<f64>>> {
        (0..self.joints()).map(|joint| self.of_joint(rows, joint)).collect()
    }

    /// Friction that falls with the speed: Coulomb friction that fades at two velocities.
    fn speed_friction(&self) -> Vec<Option<Vec<f64>>> {
        let peaks = self.peak_velocities();
        let fading = |joint: usize| {
            let resolved =
                SPEEDS.iter().zip(&self.signals.fading).filter(|(part, _)| self.resolves(joint, *part * peaks[joint]));
            resolved.map(|(_, rows)| self.of_joint(rows, joint)).collect::<Vec<_>>()
        };
        (0..self.joints()).flat_map(fading).collect()
    }

    /// Friction that changes with time, as while a gear warms up; each recording from its own beginning.
    fn friction_drift(&self) -> Vec<Option<Vec<f64>>> {
        let kinds = [&self.signals.viscous_drift, &self.signals.coulomb_drift];
        (0..self.joints()).flat_map(|joint| kinds.map(|rows| self.of_joint(rows, joint))).collect()
    }

    /// Whether the filter passes what happens below a velocity: a joint that reverses within less than a period of the cut-off
    /// leaves a pulse there, whose shape is that of the filter and of the samples.
    fn resolves(&self, joint: usize, velocity: f64) -> bool {
        let slow = |r: &'a FilteredRecording| {
            let is_slow = move |k: &usize| r.motion.dq.sample(*k)[joint].abs() < velocity;
            (0..r.motion.dq.len()).filter(is_slow).map(move |k| r.motion.ddq.sample(k)[joint].abs())
        };
        let accelerations: Vec<f64> = self.recordings().flat_map(slow).collect();
        let cutoff_hz = self.identification.setup().settings.signal.cutoff_hz;
        !accelerations.is_empty() && 2.0 * velocity * cutoff_hz >= median(&accelerations)
    }

    /// Another last link, other offsets, or another zero of a joint from some instant on, in one recording.
    fn instants(&self, found: &[Cause]) -> Vec<Cause> {
        let mut recordings = self.recordings();
        let (Some(recording), None) = (recordings.next(), recordings.next()) else { return Vec::new() };
        let table = self.problem.model.parameter_table();
        let last = self.robot.link_count() - 1;
        let indices = INERTIAL.into_iter().filter_map(|quantity| table.index(Quantity::Link(quantity), last));
        let unit = |i: usize| {
            let mut theta = vec![0.0; table.len()];
            theta[i] = 1.0;
            self.column(vec![self.of(&self.problem.model, &theta, &recording.motion, recording)?])
        };
        let Some(body) = indices.map(unit).collect::<Option<Vec<_>>>() else { return Vec::new() };
        let offsets = self.of_each_joint(&self.signals.constant).into_iter().collect::<Option<Vec<_>>>();
        let Some(offsets) = offsets else { return Vec::new() };
        let zeros: Vec<&Cause> = found.iter().filter(|cause| cause.kind == CauseKind::EncoderZero).collect();
        let searched = INSTANTS * zeros.len();
        let of_instant = |instant: usize| {
            let (start, at) = self.instant(instant, recording);
            let after = |columns: &[Vec<f64>]| columns.iter().map(|column| self.after(start, column)).collect();
            let cause = |kind, subject: &str, columns: &[Vec<f64>]| {
                let (subject, columns) = (subject.to_owned(), after(columns));
                Cause { kind, subject, unit: "", columns, instrument: None, members: Vec::new(), searched: 1 }
            };
            let shifted = |zero: &&Cause| {
                let subject = format!("{} {at}", zero.subject);
                Cause { unit: zero.unit, searched, ..cause(CauseKind::ZeroShift, &subject, &zero.columns) }
            };
            let mut all = vec![cause(CauseKind::Payload, &at, &body), cause(CauseKind::OffsetDrift, &at, &offsets)];
            all.extend(zeros.iter().map(shifted));
            all
        };
        (0..INSTANTS).flat_map(of_instant).collect()
    }

    /// The row of a joint at an instant, and its time in words.
    fn instant(&self, instant: usize, recording: &FilteredRecording) -> (usize, String) {
        let start = self.tested.rows.rows_of_joint() * (instant + 2) / (INSTANTS + 3);
        let sample = self.tested.all.decimators[0].kept().nth(start * self.tested.step).unwrap_or_default();
        let time_s = recording.start_s() + sample as f64 / recording.recording.sample_rate_hz;
        (start, format!("at {time_s:.1} s"))
    }

    /// A column of one recording that is zero before a row of each joint.
    fn after(&self, start: usize, column: &[f64]) -> Vec<f64> {
        let per_joint = self.tested.rows.rows_of_joint();
        column.iter().enumerate().map(|(k, v)| if k % per_joint < start { 0.0 } else { *v }).collect()
    }
}
