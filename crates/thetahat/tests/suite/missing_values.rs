//! Logs in which cells are empty or NaN: the figures of the log without these rows, and refused where most rows lack a value.

use std::path::Path;

use thetahat::{Experiment, Results};
use thetahat_testing::Folder;

const ROBOT: &str = "name = \"slider\"\n[[joint]]\nname = \"slide\"\nkind = \"prismatic\"\nalpha_deg = 90\n\
                     [transmission]\nmatrix = [[1]]\n[parameters]\nm1 = 10\n";
const SAMPLES: usize = 5000;
const RATE_HZ: f64 = 500.0;

/// The rows `t,q1,tau1` of 20 kg with friction over two sines.
fn rows() -> Vec<[String; 3]> {
    let row = |k: usize| {
        let t = k as f64 / RATE_HZ;
        let sum = |f: &dyn Fn(f64, f64) -> f64| f(0.2, 2.0) + f(0.1, 5.3);
        let q = sum(&|a, w| a * (w * t).sin());
        let v = sum(&|a, w| a * w * (w * t).cos());
        let a = sum(&|a, w| -a * w * w * (w * t).sin());
        let noise = 0.1 * (1e3 * t).sin();
        [format!("{t:.3}"), q.to_string(), (20.0 * a + 30.0 * v + 5.0 * v.signum() + 2.0 + noise).to_string()]
    };
    (0..SAMPLES).map(row).collect()
}

fn identified(rows: &[[String; 3]], time: &str) -> Result<Results, String> {
    let text: String = rows.iter().map(|row| row.join(",") + "\n").collect();
    let experiment = format!(
        "title = \"a slider\"\nrobot = \"robot.toml\"\n[recording]\n{time}\n\
         position = {{ file = \"log.csv\", columns = [\"q1\"], unit = \"m\" }}\n\
         torque = {{ file = \"log.csv\", columns = [\"tau1\"], unit = \"N\" }}\n\
         [signal]\ncutoff_hz = 50\ndecimation = 10\n[estimation]\nmethods = [\"idim-ls\"]\n"
    );
    let folder = Folder::with("robot.toml", ROBOT);
    folder.write("log.csv", format!("t,q1,tau1\n{text}")).write("experiment.toml", experiment);
    let experiment = Experiment::read(&folder.at("experiment.toml"), Path::new("")).map_err(|e| e.to_string())?;
    experiment.run(folder.path(), &mut |_| ()).map_err(|e| e.to_string())
}

const STAMPS: &str = "time = { file = \"log.csv\", columns = [\"t\"], unit = \"s\" }";

/// The mass, with its deviation.
fn mass(results: &Results) -> (f64, f64) {
    let run = &results.runs[0];
    let of_mass = run.parameters.iter().find(|p| p.name.contains("m1")).unwrap();
    (of_mass.estimate, of_mass.standard_deviation_robust.unwrap())
}

#[test]
fn rows_that_lack_a_value_are_gaps() {
    let is_lost = |k: &usize| (1000..1040).contains(k) || k % 97 == 5;
    let mut with_holes = rows();
    for (n, k) in (0..SAMPLES).filter(is_lost).enumerate() {
        let hole = ["", "nan", " ", "NaN"][n % 4];
        with_holes[k][1 + n % 2] = hole.to_owned();
    }
    let lost = (0..SAMPLES).filter(is_lost).count();
    let kept: Vec<_> = rows().into_iter().enumerate().filter(|(k, _)| !is_lost(k)).map(|(_, row)| row).collect();
    let [holes, without] = [&with_holes, &kept].map(|rows| identified(rows, STAMPS).unwrap());
    assert_eq!(mass(&holes), mass(&without));
    let note = format!("{lost} of {SAMPLES} samples lack a value");
    assert!(holes.recordings[0].notes.iter().any(|n| n.starts_with(&note)), "{:?}", holes.recordings[0].notes);
    // Of a stated rate alike, but for the rounding of stamps.
    let (stated, deviation) = mass(&identified(&with_holes, "sample_rate_hz = 500").unwrap());
    assert!((stated - mass(&without).0).abs() < 1e-3 * deviation, "{stated}");
}

#[test]
fn a_column_that_mostly_lacks_values_is_refused_with_its_place() {
    let mut rows = rows();
    (0..SAMPLES).filter(|k| k % 5 != 0).for_each(|k| rows[k][2] = "nan".to_owned());
    let error = identified(&rows, STAMPS).unwrap_err();
    assert!(error.contains("log.csv: only 1000 of 5000 samples") && error.contains("\"tau1\""), "{error}");
    rows[700][2] = "x".to_owned();
    let error = identified(&rows, STAMPS).unwrap_err();
    assert!(error.contains("line 702") && error.contains("\"x\""), "{error}");
}
