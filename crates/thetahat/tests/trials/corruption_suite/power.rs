//! The smallest corruptions that are found.

use thetahat::checks::{Code, Severity};

use super::{
    corruptions::{insert_rest, late, limit, peak, quantise, remove, repeat, scale, wrong_ratio},
    record::Record,
};

/// A corruption by size, the largest first.
pub struct Power {
    pub name: &'static str,
    pub code: Code,
    pub unit: &'static str,
    pub sizes: &'static [f64],
    pub apply: fn(&mut Record, f64),
}

impl Power {
    /// The smallest size that is found, as are all larger ones.
    pub fn smallest(&self, record: &Record) -> Option<f64> {
        let found = |size: &f64| {
            let mut record = record.clone();
            (self.apply)(&mut record, *size);
            record.findings().iter().any(|f| f.code == self.code && f.severity <= Severity::Warning)
        };
        self.sizes.iter().copied().take_while(found).last()
    }
}

pub fn powers() -> Vec<Power> {
    use Code::{
        CutoffHigh, CutoffLow, DroppedSamples, GearRatio, Lag, PositionQuantised, PositionSpikes, PositionZero,
        RepeatedSamples, StillPeriod, TorqueQuantised, TorqueSaturated, TorqueSpikes,
    };
    let by = |name, code, unit, sizes, apply| Power { name, code, unit, sizes, apply };
    const PERCENT: &[f64] = &[50.0, 40.0, 30.0, 25.0, 20.0, 15.0, 10.0, 8.0, 6.0, 4.0];
    const SAMPLES: &[f64] = &[100.0, 80.0, 60.0, 50.0, 40.0, 30.0, 20.0, 15.0, 10.0];
    vec![
        by("all torques late", Lag, "samples", SAMPLES, |r, d| (1..=6).for_each(|j| late(&mut r.torque, j, d))),
        by("torque 2 late", Lag, "samples", SAMPLES, |r, d| late(&mut r.torque, 2, d)),
        by("torque 5 late", Lag, "samples", SAMPLES, |r, d| late(&mut r.torque, 5, d)),
        by("ratio of motor 1 too large", GearRatio, "%", PERCENT, |r, p| wrong_ratio(r, 1, 1.0 + p / 100.0)),
        by("ratio of motor 2 too large", GearRatio, "%", PERCENT, |r, p| wrong_ratio(r, 2, 1.0 + p / 100.0)),
        by("ratio of motor 3 too large", GearRatio, "%", PERCENT, |r, p| wrong_ratio(r, 3, 1.0 + p / 100.0)),
        by("ratio of motor 4 too large", GearRatio, "%", PERCENT, |r, p| wrong_ratio(r, 4, 1.0 + p / 100.0)),
        by("ratio of motor 5 too large", GearRatio, "%", PERCENT, |r, p| wrong_ratio(r, 5, 1.0 + p / 100.0)),
        by("torque 2 too large", GearRatio, "%", PERCENT, |r, p| scale(&mut r.torque, 2, 1.0 + p / 100.0)),
        by("torque 5 too large", GearRatio, "%", PERCENT, |r, p| scale(&mut r.torque, 5, 1.0 + p / 100.0)),
        by("zero of position 2 off by its offset times", PositionZero, "", &[1.0, 0.8, 0.6, 0.4], |r, part| {
            let offset = r.robot.transmission.offset()[1];
            (0..r.position.len()).for_each(|k| r.position.sample_mut(k)[1] -= part * offset);
        }),
        by("samples missing at full speed", DroppedSamples, "samples", &[3.0, 2.0, 1.0], |r, n| {
            let places: Vec<usize> = (0..n as usize).map(|i| 12_100 + i).collect();
            remove(r, &places);
        }),
        by("samples repeated", RepeatedSamples, "samples", &[200.0, 100.0, 50.0, 20.0, 10.0], |r, n| {
            (0..n as usize).for_each(|i| repeat(r, 6000 + 120 * i));
        }),
        by("torque 2 limited to part of its peak", TorqueSaturated, "", &[0.7, 0.8, 0.9, 0.95, 0.99], |r, part| {
            limit(&mut r.torque, 2, part);
        }),
        by("steps of position 3", PositionQuantised, "rad", &[3e-2, 2e-2, 1e-2, 5e-3, 3e-3, 2e-3], |r, step| {
            quantise(&mut r.position, 3, step);
        }),
        by("steps of torque 1, part of its peak", TorqueQuantised, "", &[0.2, 0.1, 0.05, 0.02, 0.01], |r, part| {
            let step = part * peak(&r.torque, 1);
            quantise(&mut r.torque, 1, step);
        }),
        by("an outlier of position 2", PositionSpikes, "rad", &[0.3, 0.1, 0.05, 0.02, 0.01], |r, size| {
            r.position.sample_mut(10_000)[1] += size;
        }),
        by("an outlier of torque 3, times its peak", TorqueSpikes, "", &[4.0, 3.0, 2.0, 1.0, 0.5], |r, part| {
            let size = part * peak(&r.torque, 3);
            r.torque.sample_mut(10_000)[2] += size;
        }),
        by("a rest in the window", StillPeriod, "s", &[1.5, 1.0, 0.7, 0.5, 0.3], |r, seconds| {
            let rest = r.signal.window.start + 20_000;
            let samples = (seconds * r.rate_hz) as usize;
            insert_rest(r, rest, samples);
        }),
        by("position filter", CutoffLow, "Hz", &[3.0, 4.0, 5.0, 7.0, 10.0, 15.0], |r, hz| r.signal.cutoff_hz = hz),
        by(
            "position filter, every sample a row",
            CutoffHigh,
            "Hz",
            &[2000.0, 1500.0, 1000.0, 700.0, 500.0],
            |r, hz| {
                (r.signal.cutoff_hz, r.signal.decimation) = (hz, 1);
            },
        ),
    ]
}
