//! Causes whose columns are one signal of one joint: errors of torque sensors and drives, delays, springs; and a tilted base.

use super::{
    signal_rows::SignalRows,
    torques::{SPEEDS, STEP, Torques},
};
use crate::preparation::FilteredRecording;
use thetahat_estimation::signal::Motion;
use thetahat_ground::series::Series;
use thetahat_ground::vector::{IDENTITY, axis_angle, norm, times};
use thetahat_model::{dynamics::Model, robot::Robot};

impl Torques<'_> {
    /// Whether the base may be tilted about an axis of its frame: about the two that are furthest from gravity.
    pub(super) fn can_tilt_about(&self, axis: usize) -> bool {
        let along = self.robot.gravity.map(f64::abs);
        let nearest = (0..3).fold(0, |nearest, k| if along[k] > along[nearest] { k } else { nearest });
        norm(self.robot.gravity) > 0.0 && axis != nearest
    }

    /// A base that is turned about an axis of its frame: in it gravity is turned back.
    pub(super) fn tilt(&self, axis: usize) -> Option<Vec<Series>> {
        let gravity = times(&axis_angle(IDENTITY[axis], -STEP), self.robot.gravity);
        let model = Model::new(&Robot { gravity, ..self.robot.clone() });
        self.differences(STEP, |r| self.of(&model, self.standard, &r.motion, r))
    }

    pub(super) fn signals(&self) -> SignalRows {
        let gravity = self.gravity();
        let smoothed = self.smoothed().map(|torques| self.slopes(&torques));
        SignalRows {
            torque: self.column(self.predicted.clone()),
            late: self.column(self.slopes(&self.predicted)),
            filtered: self.column(self.slopes(&self.slopes(&self.predicted))),
            smoothed_filtered: smoothed.as_ref().and_then(|slopes| self.column(self.slopes(slopes))),
            smoothed_late: smoothed.and_then(|slopes| self.column(slopes)),
            cube: self.column(self.cubes()),
            aging: self.column(self.aging()),
            position: self.each(|r, k, j| r.motion.q.sample(k)[j]),
            speed: self.each(|r, k, j| r.motion.dq.sample(k)[j].abs()),
            constant: self.each(|_, _, _| 1.0),
            time: self.each(|r, k, _| part_passed(r, k)),
            viscous_drift: self.each(|r, k, j| part_passed(r, k) * r.motion.dq.sample(k)[j]),
            coulomb_drift: self.each(|r, k, j| part_passed(r, k) * self.sign_of(r.motion.dq.sample(k)[j], j)),
            gravity_friction: gravity.map_or([None, None], |gravity| self.load_friction(gravity.into_iter())),
            load_friction: self.load_friction(self.of_bodies.iter().map(|[torque, ..]| torque.clone())),
            fading: self.fading(),
        }
    }

    /// The torques of gravity.
    fn gravity(&self) -> Option<Vec<Series>> {
        let bodies = self.only(|quantity| quantity.is_inertial());
        let of_recording = |recording: &FilteredRecording| {
            let still = || Series::zeros(recording.motion.q.len(), self.joints());
            let motion = Motion { q: recording.motion.q.clone(), dq: still(), ddq: still() };
            self.of(&self.problem.model, &bodies, &motion, recording)
        };
        self.recordings().map(of_recording).collect()
    }

    /// Friction in proportion to the size of loads: against the motion, and the part by which it differs with the direction.
    fn load_friction(&self, loads: impl Iterator<Item = Series>) -> [Option<Vec<f64>>; 2] {
        let mut sizes: Vec<Series> = loads.collect();
        sizes.iter_mut().flat_map(|load| load.values_mut()).for_each(|load| *load = load.abs());
        let mut against = sizes.clone();
        for (load, recording) in against.iter_mut().zip(self.recordings()) {
            let pairs = load.values_mut().iter_mut().zip(recording.motion.dq.values()).enumerate();
            pairs.for_each(|(i, (load, dq))| *load *= self.sign_of(*dq, i % self.joints()));
        }
        [against, sizes].map(|loads| self.column(loads))
    }

    /// The smooth sign of a joint's velocity.
    fn sign_of(&self, dq: f64, joint: usize) -> f64 {
        self.sign.of(dq, self.kinds[joint])
    }

    fn fading(&self) -> [Option<Vec<f64>>; 2] {
        let peaks = self.peak_velocities();
        SPEEDS.map(|part| {
            self.each(|r, k, j| {
                let dq = r.motion.dq.sample(k)[j];
                self.sign_of(dq, j) * (-(dq / (part * peaks[j]).max(f64::MIN_POSITIVE)).powi(2)).exp()
            })
        })
    }

    /// Of each joint, over all recordings.
    pub(super) fn peak_velocities(&self) -> Vec<f64> {
        let mut peaks = vec![0.0_f64; self.joints()];
        for dq in self.recordings().map(|r| &r.motion.dq) {
            for k in 0..dq.len() {
                peaks.iter_mut().zip(dq.sample(k)).for_each(|(peak, dq)| *peak = peak.max(dq.abs()));
            }
        }
        peaks
    }

    /// Each predicted torque times its square, which is one at the joint's largest torque.
    fn cubes(&self) -> Vec<Series> {
        let mut largest = vec![f64::MIN_POSITIVE; self.joints()];
        for torque in &self.predicted {
            for k in 0..torque.len() {
                largest.iter_mut().zip(torque.sample(k)).for_each(|(most, t)| *most = most.max(t.abs()));
            }
        }
        let mut cubes = self.predicted.clone();
        for cube in &mut cubes {
            for k in 0..cube.len() {
                cube.sample_mut(k).iter_mut().zip(&largest).for_each(|(t, most)| *t *= (*t / most).powi(2));
            }
        }
        cubes
    }

    /// Each predicted torque times the part of its recording that has passed.
    fn aging(&self) -> Vec<Series> {
        let mut aging = self.predicted.clone();
        for torque in &mut aging {
            let count = torque.len() as f64;
            (0..torque.len()).for_each(|k| torque.sample_mut(k).iter_mut().for_each(|t| *t *= k as f64 / count));
        }
        aging
    }

    /// The rows of one joint; those of the others are zero.
    pub(super) fn of_joint(&self, rows: &Option<Vec<f64>>, joint: usize) -> Option<Vec<f64>> {
        self.moved(rows, joint, joint)
    }

    /// The rows of one joint as those of another; all others are zero.
    pub(super) fn moved(&self, rows: &Option<Vec<f64>>, from: usize, into: usize) -> Option<Vec<f64>> {
        let rows = rows.as_ref()?;
        let layout = &self.tested.rows.layout;
        let mut moved = vec![0.0; rows.len()];
        for recording in 0..layout.recordings() {
            let [source, target] = [from, into].map(|joint| layout.block(joint, recording));
            moved[target].copy_from_slice(&rows[source]);
        }
        Some(moved)
    }
}

/// The part of a recording that has passed at a sample.
fn part_passed(recording: &FilteredRecording, sample: usize) -> f64 {
    sample as f64 / recording.motion.dq.len() as f64
}
