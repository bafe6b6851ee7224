//! Recordings of robots on bases that float: the pose of the base, what touches the robot, and the rows that are known.

use std::{ops::Range, path::Path};

use super::{
    base::{BaseDescription, ContactDescription, Contacts, NamedContacts, SPECIFIC_FORCE, WrenchAxes, channel},
    description::{Experiment, RecordingDescription},
    error::ExperimentError,
};
use crate::preparation::{PreparationError, Recording, torques};
use thetahat_data::recording::{self, ChannelSource, Side};
use thetahat_ground::{number::significant, series::Series, stretches::stretches_where, vector::norm};
use thetahat_model::{
    dynamics::{Model, Wrench},
    robot::{LinkQuantity, Quantity},
};

/// Coordinates of a base that floats.
const BASE: usize = 6;
/// Cosine of the pitch below which yaw and roll are not distinguished: within 3 degrees of 90.
const UPRIGHT: f64 = 0.05;
/// Part of its weight that may act on a robot of the described masses that counts as in flight.
const FLIGHT: f64 = 0.2;
/// Shortest time in flight, in periods of the cut-off, after one at each end is left out: there the position filter blends it with
/// the contact before and after.
const SHORTEST_FLIGHT: f64 = 1.0;

/// The coordinates that the recorded channels of the joints do not have: zeros in front of them.
pub(super) fn after_base(series: &Series, base: usize) -> Series {
    let zeros = (0..base).map(|_| vec![0.0; series.len()]);
    Series::side_by_side(&zeros.chain((0..series.channels()).map(|j| series.channel(j))).collect::<Vec<_>>())
}

impl Experiment {
    /// The description of the base, which a robot on a floating base must have, and no other.
    fn base_of<'d>(
        &self,
        description: &'d RecordingDescription,
    ) -> Result<Option<&'d BaseDescription>, ExperimentError> {
        match (&description.base, self.robot.base_coordinates()) {
            (None, 0) => Ok(None),
            (Some(base), BASE) => Ok(Some(base)),
            (None, _) => Err(self.missing("[recording.base]", "the base of the robot floats: its pose is needed")),
            (Some(_), _) => {
                Err(self.missing("floating_base = true", "[recording.base] belongs to a robot whose base floats"))
            }
        }
    }

    /// The positions of the joints with the pose of the base in front, where it floats.
    pub(super) fn with_pose_of_base(
        &self,
        description: &RecordingDescription,
        data: &Path,
        mut position: Series,
    ) -> Result<Series, ExperimentError> {
        let Some(base) = self.base_of(description)? else { return Ok(position) };
        self.validate_base(base)?;
        let read = |source: &ChannelSource, name: &str, columns: usize| {
            let series = recording::read_channels_with_missing_values(source, data)?;
            self.require_columns(name, columns, &series)?;
            let file = description.position.path(data);
            recording::same_length(&position, "position", &file, &series, name, &source.path(data))?;
            Ok::<Series, ExperimentError>(series)
        };
        let origin = base.position.as_ref().map(|source| read(source, "[recording.base] position", 3)).transpose()?;
        let turned = read(&base.orientation, "[recording.base] orientation", base.order.columns())?;
        for k in 0..position.len() {
            let angles = base.order.yaw_pitch_roll(turned.sample(k));
            if angles[1].cos().abs() < UPRIGHT {
                return Err(self.upright(k));
            }
            let sample = position.sample_mut(k);
            origin.iter().for_each(|origin| sample[..3].copy_from_slice(origin.sample(k)));
            sample[3..BASE].copy_from_slice(&angles);
        }
        Ok(position)
    }

    fn upright(&self, sample: usize) -> ExperimentError {
        let expected = "a pitch that stays 3 degrees away from 90: yaw and roll are one angle there; turn the axes of the root body in \
                        the description, so that x is not along the world's z, or leave these samples out";
        self.refuse(PreparationError::value("[recording.base] orientation", expected, format!("sample {sample}")))
    }

    fn require_columns(&self, name: &str, expected: usize, series: &Series) -> Result<(), ExperimentError> {
        let found = series.channels();
        let check = PreparationError::require(found == expected, name, &format!("{expected} columns"), found);
        check.map_err(|e| self.refuse(e))
    }

    /// Refuses a description that does not say what touches the robot, or says it twice.
    fn validate_base(&self, base: &BaseDescription) -> Result<(), ExperimentError> {
        let refuse =
            |key: &str, expected: &str, found: &str| Err(self.refuse(PreparationError::value(key, expected, found)));
        if base.position.is_some() == base.specific_force.is_some() {
            let found = if base.position.is_some() { "both" } else { "neither" };
            return refuse("[recording.base]", "position or specific_force", found);
        }
        if let Some(source) = base.sources().find(|source| source.is_delayed() || source.side == Side::Motor) {
            let found = source.file.display().to_string();
            return refuse("[recording.base]", "channels without delay_s and side = \"motor\"", &found);
        }
        let has_forces = !base.contact.is_empty();
        let key = "[recording.base] contacts";
        match &base.contacts {
            None if has_forces => Ok(()),
            None => {
                let expected = "what touches the robot: \"none\", \"base\" (held there), \"flight\" (contacts that were not \
                                measured, times in flight are found), [[start, end], ...] in s of times without contact, or \
                                \"measured\" with a [[recording.base.contact]] for each";
                refuse(key, expected, "nothing")
            }
            Some(Contacts::Named(NamedContacts::Measured)) if has_forces => Ok(()),
            Some(Contacts::Named(NamedContacts::Measured)) => {
                refuse(key, "a [[recording.base.contact]] for each", "none")
            }
            Some(Contacts::Named(NamedContacts::Base)) => Ok(()),
            Some(Contacts::Named(NamedContacts::None | NamedContacts::Flight)) | Some(Contacts::NoneFrom(_))
                if has_forces =>
            {
                refuse(key, "\"measured\" or \"base\" with [[recording.base.contact]]", "measured forces as well")
            }
            Some(Contacts::Named(NamedContacts::None | NamedContacts::Flight)) => Ok(()),
            Some(Contacts::NoneFrom(times)) => {
                let is_valid = times.iter().all(|[start, end]| *start >= 0.0 && start < end && end.is_finite());
                if is_valid && !times.is_empty() {
                    Ok(())
                } else {
                    refuse(key, "[start, end] with start before end", "others")
                }
            }
        }
    }

    /// A recording at equal steps with the generalised forces of measured contacts added to its torques, and without the rows that are
    /// not known.
    pub(super) fn with_contacts(
        &self,
        description: &RecordingDescription,
        mut recording: Recording,
    ) -> Result<Recording, ExperimentError> {
        let Some(base) = self.base_of(description)? else { return Ok(recording) };
        if let Some(force) = recording.channels.remove(SPECIFIC_FORCE) {
            self.require_columns(SPECIFIC_FORCE, 3, &force)?;
            self.integrate(&mut recording, &force);
        }
        let forces = self.contact_forces(base, &mut recording)?;
        let has_torque = recording.torque.is_some();
        let samples = recording.position.len();
        let mut torque =
            recording.torque.take().unwrap_or_else(|| Series::zeros(samples, recording.position.channels()));
        for k in 0..samples {
            let applied = forces.sample(k).iter();
            torque.sample_mut(k).iter_mut().zip(applied).for_each(|(tau, force)| *tau += force);
        }
        recording.torque = Some(torque);
        let coordinates = recording.position.channels();
        if !has_torque {
            recording.unused_rows.push((BASE..coordinates, 0..samples));
            recording
                .notes_of_base
                .push("no torques: the six equations of the base are used, those of the joints are not".to_owned());
        }
        match &base.contacts {
            Some(Contacts::Named(NamedContacts::Measured)) | None => {}
            Some(Contacts::Named(NamedContacts::Base)) => {
                let why = "the force that holds the base is not known, and its own six equations are not used";
                leave_out_base(&mut recording, why);
            }
            Some(Contacts::Named(NamedContacts::None)) => leave_out_base(&mut recording, ZEROS),
            Some(Contacts::Named(NamedContacts::Flight)) => {
                let found = self.flight(&recording)?;
                leave_out_base(&mut recording, ZEROS);
                leave_out_but(&mut recording, &found, BASE..coordinates);
            }
            Some(Contacts::NoneFrom(times)) => {
                let sample = |t: f64| ((t * recording.sample_rate_hz).round() as usize).min(samples);
                let stated: Vec<Range<usize>> = times.iter().map(|[start, end]| sample(*start)..sample(*end)).collect();
                leave_out_base(&mut recording, ZEROS);
                leave_out_but(&mut recording, &stated, BASE..coordinates);
            }
        }
        Ok(recording)
    }

    /// The position whose second differences are the acceleration of the base's origin, from the specific force. Its drift is in no
    /// equation: they know the position's acceleration alone.
    fn integrate(&self, recording: &mut Recording, force: &Series) {
        let step = 1.0 / recording.sample_rate_hz;
        let model = Model::new(&self.robot);
        let gravity = self.robot.gravity;
        let (mut velocity, mut position) = ([0.0; 3], [0.0; 3]);
        for k in 0..recording.position.len() {
            let sample = recording.position.sample_mut(k);
            sample[..3].copy_from_slice(&position);
            let measured = force.sample(k);
            let wrench = Wrench {
                joint: BASE - 1,
                point: [0.0; 3],
                in_link: true,
                force: [measured[0], measured[1], measured[2]],
                moment: [0.0; 3],
            };
            // The rows along the world's axes of a unit mass's force: the force itself, turned into these axes.
            let mut turned = vec![0.0; sample.len()];
            model.add_wrenches(sample, &[wrench], &mut turned);
            for i in 0..3 {
                velocity[i] += step * (turned[i] + gravity[i]);
                position[i] += step * velocity[i];
            }
        }
    }

    /// `J^T w` of the measured contacts, whose channels are taken out of the recording.
    fn contact_forces(&self, base: &BaseDescription, recording: &mut Recording) -> Result<Series, ExperimentError> {
        let position = &recording.position;
        let mut forces = Series::zeros(position.len(), position.channels());
        let mut contacts = Vec::new();
        for (k, contact) in base.contact.iter().enumerate() {
            let Some(force) = recording.channels.remove(&channel(k)) else { continue };
            if force.channels() != 3 {
                self.require_columns(&channel(k), 6, &force)?;
            }
            contacts.push((self.link_of(contact)?, contact, force));
        }
        let model = Model::new(&self.robot);
        for k in 0..position.len() {
            let wrench = |(joint, contact, force): &(usize, &ContactDescription, Series)| {
                let at = |i: usize| force.sample(k).get(i).copied().unwrap_or(0.0);
                Wrench {
                    joint: *joint,
                    point: contact.point_m,
                    in_link: contact.axes == WrenchAxes::Link,
                    force: [at(0), at(1), at(2)],
                    moment: [at(3), at(4), at(5)],
                }
            };
            let wrenches: Vec<Wrench> = contacts.iter().map(wrench).collect();
            model.add_wrenches(position.sample(k), &wrenches, forces.sample_mut(k));
        }
        Ok(forces)
    }

    fn link_of(&self, contact: &ContactDescription) -> Result<usize, ExperimentError> {
        let Some(name) = &contact.link_of else { return Ok(BASE - 1) };
        let names: Vec<&str> = self.robot.joints.iter().skip(BASE).map(|joint| joint.name.as_str()).collect();
        let expected = format!("one of {}", names.join(", "));
        let found = self.robot.joints.iter().position(|joint| joint.name == *name);
        let refuse = || self.refuse(PreparationError::value("[[recording.base.contact]] link_of", &expected, name));
        found.ok_or_else(refuse)
    }

    /// The times in flight: what acts on a robot of the described masses is a fifth of its weight or less.
    fn flight(&self, recording: &Recording) -> Result<Vec<Range<usize>>, ExperimentError> {
        let model = Model::new(&self.robot);
        let (table, theta) = (model.parameter_table(), self.robot.a_priori_parameters());
        let links = self.robot.link_count();
        let mass: f64 = (0..links).map(|k| table.value(&theta, Quantity::Link(LinkQuantity::M), k)).sum();
        let weight = mass * norm(self.robot.gravity);
        let key = "[recording.base] contacts = \"flight\"";
        let expected =
            "a description with masses, from which flight is found, or times without contact, [[start, end], ...] in s";
        PreparationError::require(weight > 0.0, key, expected, "no mass").map_err(|e| self.refuse(e))?;
        let motion = self.setup().measured_motion(recording).map_err(|e| self.refuse(e))?;
        let bodies: Vec<f64> =
            table.iter().zip(theta).map(|(p, v)| if p.quantity.is_inertial() { v } else { 0.0 }).collect();
        let forces = torques(&model, &bodies, &motion, None);
        let flies = |k: usize| norm([0, 1, 2].map(|i| forces.sample(k)[i])) <= FLIGHT * weight;
        let period = recording.sample_rate_hz / self.settings.signal.cutoff_hz;
        let found = flights(forces.len(), flies, period);
        let expected =
            "times in which the robot is in flight for three periods of cutoff_hz; state them, or measure the contacts";
        PreparationError::require(!found.is_empty(), key, expected, "none").map_err(|e| self.refuse(e))?;
        Ok(found)
    }
}

/// Why the equations of a base on which nothing acts are left out: their right-hand sides are zeros, and least squares would draw all
/// masses to zero by the noise of the base's acceleration.
const ZEROS: &str =
    "nothing acts on the base, whose own six equations say only that masses times noise are zero, and are not used";

/// Leaves out the equations of the base.
fn leave_out_base(recording: &mut Recording, why: &str) {
    recording.unused_rows.push((0..BASE, 0..recording.position.len()));
    recording.notes_of_base.push(why.to_owned());
}

/// The stretches of samples that fly, without a period at each end, that are long enough.
fn flights(samples: usize, flies: impl Fn(usize) -> bool, period: f64) -> Vec<Range<usize>> {
    let edge = period.ceil() as usize;
    let without_ends = |stretch: Range<usize>| stretch.start + edge..stretch.end.saturating_sub(edge);
    let mut found: Vec<Range<usize>> = stretches_where(0..samples, flies).into_iter().map(without_ends).collect();
    found.retain(|range| range.end > range.start && range.len() as f64 >= SHORTEST_FLIGHT * period);
    found
}

/// Leaves out all rows but those of some samples.
fn leave_out_but(recording: &mut Recording, used: &[Range<usize>], all: Range<usize>) {
    let samples = recording.position.len();
    let ends = used.iter().map(|range| range.start).chain([samples]);
    let starts = [0].into_iter().chain(used.iter().map(|range| range.end));
    let between = starts.zip(ends).filter(|(start, end)| start < end);
    recording.unused_rows.extend(between.map(|(start, end)| (all.clone(), start..end)));
    const LISTED: usize = 6;
    let second = |k: usize| significant(k as f64 / recording.sample_rate_hz, 3);
    let listed = used.iter().take(LISTED).map(|range| format!("{} to {} s", second(range.start), second(range.end)));
    let more = used.len().saturating_sub(LISTED);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    let times = listed.collect::<Vec<_>>().join(", ");
    recording.notes_of_base.push(format!("without contact, and used: {times}{more}; all other times are left out"));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flight_is_cut_at_both_ends_and_must_last() {
        let flies = |k: usize| (10..40).contains(&k) || (60..75).contains(&k) || k >= 90;
        assert_eq!(flights(120, flies, 4.5), [15..35, 65..70, 95..115]);
        assert_eq!(flights(120, flies, 8.0), [18..32, 98..112]);
    }
}
