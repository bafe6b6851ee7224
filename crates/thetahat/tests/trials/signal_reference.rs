//! Filters, decimation and differentiation against SciPy and NumPy.
//!
//! The reference, `reference/signal.json` with the script that made it, lies in the folder `shared` beside the
//! checkout or where the environment variable `THETAHAT_SHARED` says. Without it every test is reported as ignored.

use std::path::Path;

use libtest_mimic::{Failed, Trial};
use serde::Deserialize;
use thetahat::Series;
use thetahat::signal::{Decimator, Padding, SecondOrderSections, central_difference, zero_phase};

/// Largest difference over the largest value: the rounding of SciPy's polynomial form, and margin for other machines.
const TOLERANCE: f64 = 1e-9;

#[derive(Deserialize)]
struct Reference {
    source: String,
    fs_hz: f64,
    x: Vec<f64>,
    cases: Vec<Case>,
}

#[derive(Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
enum Case {
    Butterworth { order: usize, cutoff_hz: f64, sos: Vec<[f64; 6]>, filtfilt: Vec<f64>, sosfiltfilt: Vec<f64> },
    Decimate { factor: usize, sos: Vec<[f64; 6]>, y: Vec<f64> },
    CentralDifference { y: Vec<f64> },
}

impl Case {
    fn name(&self) -> String {
        match self {
            Self::Butterworth { order, cutoff_hz, .. } => format!("butterworth_order_{order}_at_{cutoff_hz}_hz"),
            Self::Decimate { factor, .. } => format!("decimate_by_{factor}"),
            Self::CentralDifference { .. } => "central_difference".into(),
        }
    }

    fn check(&self, fs_hz: f64, x: &Series) -> Result<(), Failed> {
        match self {
            Self::Butterworth { order, cutoff_hz, sos, filtfilt, sosfiltfilt } => {
                let filter = SecondOrderSections::butterworth_lowpass(*order, *cutoff_hz, fs_hz)?;
                compare_sections(&filter, sos)?;
                compare("filtfilt", zero_phase(&filter, x, Padding::Matlab)?.values(), filtfilt)?;
                compare("sosfiltfilt", zero_phase(&filter, x, Padding::Scipy)?.values(), sosfiltfilt)
            }
            Self::Decimate { factor, sos, y } => {
                let filter = SecondOrderSections::chebyshev1_lowpass(8, 0.05, 0.8 / *factor as f64, 2.0)?;
                compare_sections(&filter, sos)?;
                compare("decimate", Decimator::new(*factor, x.len())?.decimate(x)?.values(), y)
            }
            Self::CentralDifference { y } => compare("gradient", central_difference(x, fs_hz).values(), y),
        }
    }
}

/// Numerators and denominators apart, as the first numerator may be smaller than any tolerance on the others.
fn compare_sections(filter: &SecondOrderSections, expected: &[[f64; 6]]) -> Result<(), Failed> {
    if filter.sections().len() != expected.len() {
        return Err(format!("{} sections, expected {}", filter.sections().len(), expected.len()).into());
    }
    for (ours, theirs) in std::iter::zip(filter.sections(), expected) {
        compare("numerator", &ours[..3], &theirs[..3])?;
        compare("denominator", &ours[3..], &theirs[4..])?;
    }
    Ok(())
}

fn compare(what: &str, ours: &[f64], theirs: &[f64]) -> Result<(), Failed> {
    if ours.len() != theirs.len() {
        return Err(format!("{what}: {} values, expected {}", ours.len(), theirs.len()).into());
    }
    let largest = theirs.iter().fold(0.0_f64, |m, y| m.max(y.abs()));
    let difference = std::iter::zip(ours, theirs).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs())) / largest;
    println!("{what}: largest relative difference {difference:.1e}");
    if difference <= TOLERANCE { Ok(()) } else { Err(format!("{what} differs by {difference:e}").into()) }
}

fn trials(path: &Path) -> Result<Vec<Trial>, Box<dyn std::error::Error>> {
    if !path.exists() {
        println!("\n!!! NOT COMPARED WITH SCIPY: {} is absent; set THETAHAT_SHARED !!!\n", path.display());
        return Ok(vec![Trial::test("signal_reference", || Ok(())).with_ignored_flag(true)]);
    }
    let reference: Reference = serde_json::from_reader(std::io::BufReader::new(std::fs::File::open(path)?))?;
    println!("reference: {}", reference.source);
    let (fs_hz, x) = (reference.fs_hz, Series::shaped(1, reference.x));
    Ok(reference.cases.into_iter().map(|case| trial(case, fs_hz, x.clone())).collect())
}

fn trial(case: Case, fs_hz: f64, x: Series) -> Trial {
    Trial::test(case.name(), move || case.check(fs_hz, &x))
}

/// The trials of this module.
pub fn all_trials() -> Vec<Trial> {
    trials(&thetahat_testing::shared().join("reference/signal.json")).expect("the reference can be read")
}
