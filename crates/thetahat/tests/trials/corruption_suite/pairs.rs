//! Defects of two recordings beside one another.

use thetahat::{
    base_parameters::BaseParameters,
    checks::{Code, Finding},
    dynamics::{DynamicParameters, Model, Sign, State, Workspace},
    signal::{Derivative, band_pass},
};
use thetahat_estimation::checks::{Companion, Measure, compare, measure_across_recordings};

use super::{
    corruptions::{scale, set},
    defects::part,
    record::Record,
    robots::Specimen,
};

/// Two recordings and whether the second is held back.
pub struct Pair {
    pub first: Record,
    pub second: Record,
    pub held_back: bool,
}

/// A defect of two recordings.
pub struct PairDefect {
    pub name: &'static str,
    pub code: Code,
    /// Robots in which it is not found, with the reason.
    pub unseen: &'static [(Specimen, &'static str)],
    pub apply: fn(&mut Pair),
}

pub fn pair_defects() -> Vec<PairDefect> {
    use Code::{RecordingsContradict, SameRecording};
    let by = |name, code, apply| PairDefect { name, code, unseen: &[], apply };
    vec![
        by("the same recording twice", SameRecording, |p| p.second = p.first.clone()),
        by("the same recording in training and validation", SameRecording, |p| {
            (p.second, p.held_back) = (p.first.clone(), true);
        }),
        by("a recording with a payload and one without", RecordingsContradict, |p| payload(&mut p.second)),
        by("torque 2 with another gain in one of two recordings (1.3)", RecordingsContradict, |p| {
            scale(&mut p.second.torque, 2, 1.3);
        }),
        by("torque 2 with another offset in one of two recordings", RecordingsContradict, |p| {
            let size = super::corruptions::peak(&p.second.torque, 2);
            set(&mut p.second.torque, 2, |_, t| t + 0.2 * size);
        }),
    ]
}

impl Pair {
    /// The halves of a record.
    pub fn halves(record: &Record) -> Self {
        let window = record.signal.window.clone();
        let middle = window.start + window.len() / 2;
        let [first, second] = [part(record, window.start..middle), part(record, middle..window.end)];
        Self { first, second, held_back: false }
    }

    pub fn findings(&self) -> Vec<Finding> {
        self.with_companions(compare)
    }

    /// The evidence of the checks.
    pub fn measures(&self) -> Vec<Measure> {
        self.with_companions(measure_across_recordings)
    }

    fn with_companions<T>(&self, f: impl FnOnce(&[Companion<'_>]) -> T) -> T {
        beside_one_another(&[("a", &self.first, false), ("b", &self.second, self.held_back)], f)
    }
}

/// Calls `f` with records of one robot, their names, and whether they are held back.
pub fn beside_one_another<T>(records: &[(&str, &Record, bool)], f: impl FnOnce(&[Companion<'_>]) -> T) -> T {
    let first = records[0].1;
    let model = Model::new(&first.robot);
    let base = BaseParameters::of(&model, &first.excluded).unwrap();
    let mut companions = Vec::new();
    for (name, record, held_back) in records {
        companions.push(Companion { name, held_back: *held_back, subject: record.subject(&model, &base) });
    }
    f(&companions)
}

/// Mass of the payload, kg, and its distance from the last joint's frame, m.
const PAYLOAD_KG: f64 = 3.0;
const PAYLOAD_M: f64 = 0.1;

/// Adds the torques of a payload at the last link.
pub fn payload(record: &mut Record) {
    let model = Model::new(&record.robot);
    let n = model.link_count();
    let mut theta = vec![0.0; model.parameter_table().len()];
    for (name, value) in [("mz", PAYLOAD_M), ("m", 1.0), ("xx", PAYLOAD_M.powi(2)), ("yy", PAYLOAD_M.powi(2))] {
        let index = model.parameter_table().index_of(&format!("{name}{n}")).unwrap();
        theta[index] = PAYLOAD_KG * value;
    }
    let parameters = DynamicParameters::sorted(&model, &theta);
    let signal = &record.signal;
    let motion =
        band_pass(&record.position, record.rate_hz, signal.filter_order, signal.cutoff_hz, Derivative::Central)
            .unwrap();
    let (mut workspace, mut added) = (Workspace::new(&model), vec![0.0; record.torque.channels()]);
    for k in 0..record.torque.len() {
        let state = State::new(motion.q.sample(k), motion.dq.sample(k));
        model.inverse_dynamics(&parameters, state, motion.ddq.sample(k), Sign::Exact, &mut workspace, &mut added);
        record.torque.sample_mut(k).iter_mut().zip(&added).for_each(|(t, a)| *t += a);
    }
}
