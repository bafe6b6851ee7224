//! Payloads of an experiment file: a slider with 20 kg, and with 3 kg more.

use thetahat_testing::{Folder, refused, run, shown, succeeded};

const PROGRAM: &str = env!("CARGO_BIN_EXE_thetahat");

const ROBOT: &str = "name = \"slider\"\n[[joint]]\nname = \"slide\"\nkind = \"prismatic\"\nalpha_deg = 90\n\
                     [transmission]\nmatrix = [[1]]\n[parameters]\nm1 = 10\n";
/// Mass of the slider with its motor, and of the payload, kg.
const MASSES: [f64; 2] = [20.0, 3.0];

/// 20 s at 200 Hz of a mass with friction, with a force that is `factor` times what is recorded; columns `t,q,f`.
fn record(mass: f64, factor: f64, first: f64) -> String {
    let row = |k: usize| {
        let t = k as f64 / 200.0;
        let sum = |f: &dyn Fn(f64, f64) -> f64| f(0.2, first) + f(0.1, 2.7 * first);
        let q = sum(&|a, w| a * (w * t).sin());
        let v = sum(&|a, w| a * w * (w * t).cos());
        let a = sum(&|a, w| -a * w * w * (w * t).sin());
        let noise = 0.5 * (((12.9898 * k as f64).sin() * 43758.5453).fract() - 0.5);
        format!("{t:.3},{q},{}\n", (mass * a + 30.0 * v + 5.0 * v.signum() + 2.0 + noise) / factor)
    };
    format!("t,q,f\n{}", (0..4000).map(row).collect::<String>())
}

fn recording(file: &str, rest: &str) -> String {
    format!(
        "[[recording]]\nname = \"{file}\"\ntime = {{ file = \"{file}.csv\", columns = [\"t\"], unit = \"s\" }}\n\
         position = {{ file = \"{file}.csv\", columns = [\"q\"], unit = \"m\" }}\n\
         torque = {{ file = \"{file}.csv\", columns = [\"f\"], unit = \"N\" }}\n{rest}"
    )
}

/// A folder with both records and an experiment with this payload.
fn case(payload: &str, factor: f64) -> Folder {
    let folder = Folder::with("robot.toml", ROBOT);
    folder.write("bare.csv", record(MASSES[0], factor, 2.0));
    folder.write("loaded.csv", record(MASSES[0] + MASSES[1], factor, 1.7));
    let experiment = format!(
        "title = \"a slider\"\nrobot = \"robot.toml\"\n{}{}[signal]\ncutoff_hz = 30\ndecimation = 5\n\
         [estimation]\nmethods = [\"idim-ls\"]\n[[payload]]\nname = \"block\"\n{payload}",
        recording("bare", ""),
        recording("loaded", "payload = \"block\"\n"),
    );
    folder.write("experiment.toml", experiment);
    folder
}

fn identify(folder: &Folder) -> std::process::Output {
    run(PROGRAM, folder.path(), ["identify", "experiment.toml", "--out", "out"])
}

/// Along one axis without gravity, nothing but the mass has a number.
#[test]
fn a_slider_tells_the_mass_of_its_payload_alone() {
    let folder = case("", 1.0);
    let text = succeeded(&identify(&folder));
    assert!(text.contains("Payload block") && text.contains("not identified"), "{text}");
    let payload = &folder.json("out/results.json")["payloads"][0];
    for parameter in payload["parameters"].as_array().unwrap() {
        let (name, estimate) = (parameter["name"].as_str().unwrap(), parameter["estimate"].as_f64());
        assert_eq!(estimate.is_some(), name == "m", "{parameter}");
        if let Some(mass) = estimate {
            let interval = &parameter["interval_95"];
            assert!((mass - MASSES[1]).abs() < 0.1, "{mass}");
            assert!(interval[0].as_f64().unwrap() < mass && mass < interval[1].as_f64().unwrap());
        }
    }
    assert!(payload["centre_m"].is_null() && payload["physical"].is_null());
    assert!(folder.text("out/report.html").contains("Payload block"));
}

#[test]
fn a_known_payload_calibrates_the_drive() {
    let folder = case("mass_kg = 3\ncentre_m = [0, 0, 0.1]\n", 2.0);
    let output = identify(&folder);
    let text = shown(&output);
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(text.contains("PROBLEM: the torques of slide contradict the payload"), "{text}");
    let factor = folder.json("out/results.json")["drive_gains"][0]["factor"].as_f64().unwrap();
    assert!((factor - 2.0).abs() < 0.1, "{factor}");
    folder.replace(
        "experiment.toml",
        "unit = \"N\" }\npayload",
        "unit = \"N\", gain = [2] }\npayload",
        "experiment.toml",
    );
    folder.replace("experiment.toml", "unit = \"N\" }\n[[rec", "unit = \"N\", gain = [2] }\n[[rec", "experiment.toml");
    let text = succeeded(&identify(&folder));
    assert!(text.contains("Drive gains by the known payload") && !text.contains("PROBLEM"), "{text}");
    let predicted =
        succeeded(&run(PROGRAM, folder.path(), ["predict", "out/results.json", "--recording", "loaded.csv"]));
    assert!(predicted.contains("slide"), "{predicted}");
}

#[test]
fn what_a_payload_cannot_be_is_refused() {
    let says = |payload: &str, from: &str, to: &str, words: &[&str]| {
        let folder = case(payload, 1.0);
        if !from.is_empty() {
            folder.replace("experiment.toml", from, to, "experiment.toml");
        }
        let message = refused(&identify(&folder));
        assert!(words.iter().all(|word| message.contains(word)), "{message}");
    };
    says("mass_kg = -3", "", "", &["[[payload]] block: mass_kg is -3"]);
    says("joint = \"wrist\"", "", "", &["joint is wrist, expected one of slide"]);
    says("", "payload = \"block\"", "payload = \"brick\"", &["payload is brick, expected one of [[payload]]: block"]);
    says("", "\"idim-ls\"", "\"idim-iv\"", &["recording loaded: methods is idim-iv", "simulations carry none"]);
    let folder = case("", 1.0);
    let message = refused(&run(PROGRAM, folder.path(), ["reduce", "experiment.toml", "--out", "a.reduction"]));
    assert!(message.contains("a reduction has no columns of payloads"), "{message}");
}
