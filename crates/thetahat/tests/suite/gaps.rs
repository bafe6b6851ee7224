//! Records with lost samples: estimates within their intervals of the truth, and near those of the whole record.

use std::{f64::consts::TAU, ops::Range};

use super::followed_twin::{RATE_HZ, controller, record, robot};
use thetahat::{
    Identification, Method, Recording, Results, Series, Settings, checks::Code, identification::Status,
    simulation::Solver,
};

const SECONDS: f64 = 16.0;
const METHODS: [Method; 3] = [Method::IDIM_LS, Method::IDIM_IV, Method::DIDIM];

/// A wave that does not repeat, of three sines for each joint.
fn wave() -> Series {
    let of = |t: f64, j: f64| {
        [0.31, 0.83, 1.37].map(|hz| 0.4 * (TAU * hz * t + 3.0 * hz + j).sin() / (0.5 + hz)).iter().sum()
    };
    let time = (0..(SECONDS * RATE_HZ) as usize).map(|k| k as f64 / RATE_HZ);
    Series::shaped(2, time.flat_map(|t| [of(t, 0.0), of(t, 1.0)]).collect())
}

/// The record with its reference, without the samples of some ranges.
fn without(lost: &[Range<usize>]) -> Recording {
    let reference = wave();
    let whole = record(&reference, 1e-5);
    let (q, tau) = (whole.position, whole.torque.unwrap());
    let kept: Vec<usize> = (0..q.len()).filter(|k| !lost.iter().any(|range| range.contains(k))).collect();
    let take = |series: &Series| {
        Series::shaped(series.channels(), kept.iter().flat_map(|&k| series.sample(k)).copied().collect())
    };
    let time: Vec<f64> = kept.iter().map(|&k| k as f64 / RATE_HZ).collect();
    let with_reference = Recording::at_times(time.clone(), take(&reference), take(&tau)).unwrap().position;
    let recording = Recording::at_times(time, take(&q), take(&tau)).unwrap();
    Recording { truth: whole.truth, ..recording.with_reference(with_reference) }
}

fn identify(recording: Recording) -> Results {
    let mut settings = Settings::new(20.0, 10).with_methods(METHODS);
    settings.controller = Some(controller());
    settings.simulation.sign_velocity_scale = 0.05;
    // With errors of 0.1 % the usual tolerance moves DIDIM by a tenth of a deviation from step to step.
    settings.simulation.solver = Solver::Automatic { relative_tolerance: 1e-7, absolute_tolerance: 1e-10 };
    Identification::new(&robot(), vec![recording], settings).unwrap().run().unwrap()
}

/// Each method against the truth, in deviations, and against its estimates from the whole record, likewise.
fn assert_near(results: &Results, whole: &Results) {
    for method in METHODS {
        let [run, of_whole] = [results, whole].map(|r| r.run("nominal", method).unwrap());
        assert_eq!(run.status, Status::Converged, "{method}: {:?}", run.reason);
        for (p, w) in run.parameters.iter().zip(&of_whole.parameters) {
            let deviation = p.standard_deviation_robust.unwrap();
            let from_truth = (p.estimate - p.true_value.unwrap()).abs() / deviation;
            let truth_of_whole = (w.estimate - w.true_value.unwrap()).abs() / w.standard_deviation_robust.unwrap();
            assert!(from_truth < truth_of_whole.max(3.0) + 1.5, "{method} {}: {from_truth} {truth_of_whole}", p.name);
            let from_whole = (p.estimate - w.estimate).abs() / deviation;
            assert!(from_whole < 2.0, "{method} {}: {from_whole} of {deviation}", p.name);
        }
        let [error, error_of_whole] = [run, of_whole].map(|r| r.relative_error_percent.unwrap());
        assert!(error < 1.1 * error_of_whole, "{method}: {error} {error_of_whole}");
    }
}

/// Single samples lost at random places, a few at a time, and two seconds.
#[test]
fn lost_samples_leave_the_estimates_where_they_were() {
    let whole = identify(without(&[]));
    let single: Vec<Range<usize>> = (1..151).map(|k| 52 * k + 7 * k % 13).map(|k| k..k + 1).collect();
    let few: Vec<Range<usize>> = (1..10).map(|k| 800 * k..800 * k + 9).collect();
    let long = vec![1200..1800, 5000..6000];
    for (lost, name) in [(single, "single"), (few, "few"), (long, "long")] {
        let results = identify(without(&lost));
        let resampling = results.recordings[0].resampling.unwrap();
        let missing: usize = lost.iter().map(Range::len).sum();
        assert_eq!((resampling.gaps, resampling.missing), (lost.len(), missing), "{name}");
        assert_eq!(results.recordings.len(), 1, "{name}: the pieces are one recording");
        assert!((results.recordings[0].sample_rate_hz - RATE_HZ).abs() < 1e-6, "{name}");
        assert!(results.samples_used < whole.samples_used - missing);
        let codes: Vec<Code> = results.findings.iter().flat_map(|f| &f.findings).map(|f| f.code).collect();
        assert!(codes.contains(&Code::DroppedSamples) && !codes.contains(&Code::PoorFit), "{name}: {codes:?}");
        assert_near(&results, &whole);
    }
}

/// Gaps outside the window do nothing.
#[test]
fn gaps_outside_the_window_do_nothing() {
    let windowed = |lost: &[Range<usize>]| Recording { window_s: [Some(4.0), Some(10.0)], ..without(lost) };
    let (results, whole) = (identify(windowed(&[400..900, 7000..7300])), identify(windowed(&[])));
    assert_eq!(results.samples_used, whole.samples_used);
    assert_near(&results, &whole);
}
