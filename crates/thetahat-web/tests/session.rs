//! The session of the page in a folder of the system: the same answers as in a browser.

use serde_json::{Value, json};
use thetahat_testing::Folder;
use thetahat_web::{Outcome, Session};

fn answer(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

/// The demonstration goes the whole way by what the page calls: files, understanding, experiment, results, export.
#[test]
fn the_demonstration_goes_the_whole_way() -> Outcome<()> {
    let folder = Folder::new();
    let mut session = Session::in_folder(folder.path());
    let demo = answer(&session.sample("demo")?);
    let kinds = ["tx40.toml", "tx40_demo.csv"].map(|file| session.kind(file).unwrap());
    assert_eq!(kinds, ["robot", "recording"]);
    let understood = answer(&session.understand(&demo["request"].to_string())?);
    for (key, expected) in
        [("robot_error", Value::Null), ("recording_errors", json!([])), ("proposal_error", Value::Null)]
    {
        assert_eq!(understood[key], expected, "{key}");
    }
    assert_eq!(understood["robot"]["joints"].as_array().map(Vec::len), Some(6));
    let (skeleton, series) = (&understood["skeleton"], &understood["series"]);
    let moments = skeleton["frames"].as_array().unwrap();
    assert!(moments.len() > 100 && moments.iter().all(|joints| joints.as_array().unwrap().len() == 6));
    assert_eq!(skeleton["time_s"].as_array().map(Vec::len), Some(moments.len()));
    let times = series["time_s"].as_array().unwrap().len();
    assert!((1000..=2000).contains(&times));
    for signal in ["position", "torque"] {
        let rows = series[signal].as_array().unwrap();
        assert!(rows.len() == 6 && rows.iter().all(|row| row.as_array().unwrap().len() == times), "{signal}");
    }
    let proposal = &understood["proposal"];
    assert_eq!(proposal["position"]["columns"][5], "position_6");
    assert_eq!(proposal["time"], "time_s");
    let toml = proposal["toml"].as_str().unwrap();
    let identified = answer(&session.identify(toml, &mut |_| ())?);
    assert!(identified["report"].as_str().unwrap().starts_with("<!DOCTYPE html>"));
    assert!(identified["text"].as_str().unwrap().lines().all(|line| line.chars().count() <= 80));
    let results = identified["files"]["results.json"].as_str().unwrap();
    assert_drawn(skeleton, &identified["residual"], &answer(&session.bodies(results)?));
    let exported = answer(&session.export(identified["files"]["results.json"].as_str().unwrap(), "mjcf", true)?);
    assert!(exported["file"].as_str().unwrap().contains("<mujoco"));
    assert!(exported["covariance"].as_str().is_some());
    Ok(())
}

/// What the drawing in 3D needs: axes of links, bodies, and the residual, whose root mean square is its noise but for the parameters,
/// by which the noise is divided by fewer rows.
fn assert_drawn(skeleton: &Value, residual: &Value, bodies: &Value) {
    /// Of the TX40: no joint has more.
    const PARAMETERS: f64 = 61.0;
    let list = |value: &Value| value.as_array().unwrap().clone();
    let number = |value: &Value| value.as_f64().unwrap();
    let moments = list(&skeleton["rotations"]);
    assert_eq!(moments.len(), list(&skeleton["frames"]).len());
    assert!(moments.iter().all(|links| list(links).len() == 6));
    let names = |bodies: &Value| list(bodies).iter().map(|body| body["joint"].clone()).collect::<Vec<Value>>();
    assert_eq!(names(bodies), names(&skeleton["bodies"]));
    assert!(list(bodies).iter().all(|link| number(&link["body"]["mass"]) > 0.0), "{bodies}");
    let (rows, noise) = (list(&residual["residual"]), list(&residual["noise"]));
    assert_eq!((rows.len(), noise.len()), (6, 6));
    for (row, noise) in rows.iter().zip(&noise) {
        let row = list(row);
        assert_eq!(row.len(), list(&residual["time_s"]).len());
        let mean_square = row.iter().map(|v| number(v).powi(2)).sum::<f64>() / row.len() as f64;
        let ratio = mean_square / number(noise).powi(2);
        assert!(ratio < 1.0 && ratio > 1.0 - PARAMETERS / row.len() as f64, "{ratio}");
    }
}

const ARM: &str = r#"<robot name="arm"><link name="base"/><link name="a"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="j" type="revolute"><parent link="base"/><child link="a"/><axis xyz="0 1 0"/>
<limit lower="-3" upper="3" effort="50" velocity="5"/></joint></robot>"#;

/// What is wrong with a file is said beside what is understood of the others.
#[test]
fn a_broken_file_is_an_answer() -> Outcome<()> {
    let folder = Folder::new();
    let mut session = Session::in_folder(folder.path());
    session.put("arm.urdf", ARM.as_bytes().to_vec())?;
    assert_eq!(session.urdf("arm.urdf")?, ARM);
    session.put("log.csv", b"t,tau_1\n0,1\n0.01,2\n".to_vec())?;
    session.put("broken.npz", b"PK\x03\x04 and no more".to_vec())?;
    let request = json!({ "robot": "arm.urdf", "recordings": ["log.csv", "broken.npz"] });
    let understood = answer(&session.understand(&request.to_string())?);
    assert_eq!(understood["recordings"][0]["channels"][1]["name"], "tau_1");
    let error = &understood["recording_errors"][0];
    assert!(error["path"] == "broken.npz" && error["message"].as_str().unwrap().contains("broken.npz"), "{error}");
    assert!(understood["proposal_error"].as_str().unwrap().contains("under Corrections"), "{understood}");
    assert_eq!(understood["skeleton"]["frames"].as_array().map(Vec::len), Some(1));
    Ok(())
}

/// A gain that no file holds is asked for beside the text in which it is to be filled in; filled in, it runs.
#[test]
fn a_gain_is_filled_in_by_hand() -> Outcome<()> {
    let folder = Folder::new();
    let mut session = Session::in_folder(folder.path());
    let row = |k: usize| {
        let (t, angle) = (0.001 * k as f64, 0.004 * k as f64);
        let (q, dq) = (angle.sin(), 4.0 * angle.cos());
        format!("{t},{q},{}\n", 50.0 * (q + 0.5 * dq + 0.3 * dq.signum()))
    };
    session.put("arm.urdf", ARM.as_bytes().to_vec())?;
    session
        .put("log.csv", ("t,q_1,torque_1 [%]\n".to_owned() + &(0..4000).map(row).collect::<String>()).into_bytes())?;
    let understood =
        answer(&session.understand(&json!({ "robot": "arm.urdf", "recordings": ["log.csv"] }).to_string())?);
    assert!(understood["proposal"].is_null());
    assert!(understood["proposal_error"].as_str().unwrap().contains("Fill in gain = [...]"), "{understood}");
    let text = understood["unfinished"].as_str().unwrap();
    assert!(session.identify(text, &mut |_| ()).unwrap_err().to_string().contains("to be filled in"));
    let filled = text.replace("gain = []", "gain = [2.0]");
    let results = answer(&session.identify(&filled, &mut |_| ())?)["results"].clone();
    let parameters = results["runs"][0]["parameters"].as_array().unwrap();
    let viscous = parameters.iter().find(|p| p["name"] == "fv1").unwrap()["estimate"].as_f64().unwrap();
    // 50 % times 2 N m at 100 %, over 100, times 0.5.
    assert!((viscous - 0.5).abs() < 0.01, "{viscous}");
    Ok(())
}

/// The samples can be identified as they are proposed; of the faulty one the fault is found, and has its remedy.
#[test]
fn samples_are_recorded() -> Outcome<()> {
    for (name, joints, is_faulty) in [("arm", 3, false), ("axis", 1, false), ("exchanged", 3, true)] {
        let folder = Folder::new();
        let mut session = Session::in_folder(folder.path());
        let sample = answer(&session.sample(name)?);
        let understood = answer(&session.understand(&sample["request"].to_string())?);
        assert_eq!(understood["proposal_error"], Value::Null, "{name}");
        assert_eq!(understood["proposal"]["joints"].as_array().map(Vec::len), Some(joints), "{name}");
        let remedies = understood["remedies"].as_array().unwrap();
        let is_found = remedies.iter().any(|remedy| remedy["code"] == "joints-swapped-1-2");
        assert_eq!(is_found, is_faulty, "{name}: {remedies:?}");
    }
    let folder = Folder::new();
    let error = Session::in_folder(folder.path()).sample("other").unwrap_err();
    assert!(error.to_string().contains("demo, arm, axis and exchanged"), "{error}");
    Ok(())
}

/// Gains and methods of a request stand in the proposal.
#[test]
fn gains_and_methods_of_a_request_are_proposed() -> Outcome<()> {
    let folder = Folder::new();
    let mut session = Session::in_folder(folder.path());
    let mut request = answer(&session.sample("arm")?)["request"].clone();
    request["methods"] = json!(["idim-wls", "didim"]);
    request["position_gain"] = json!([4000.0]);
    request["velocity_gain"] = json!([100.0]);
    request["gain"] = json!([2.0]);
    let proposal = answer(&session.understand(&request.to_string())?)["proposal"].clone();
    assert_eq!(proposal["gain"], json!([2.0]));
    let toml = proposal["toml"].as_str().unwrap();
    assert!(toml.contains("methods = [\"idim-wls\", \"didim\"]") && toml.contains("position_gain = 4000"), "{toml}");
    request["methods"] = json!(["idim"]);
    let error = session.understand(&request.to_string()).unwrap_err().to_string();
    assert!(error.contains("idim") && error.contains("idim-wls"), "{error}");
    Ok(())
}

/// Requests that are not of the form, and files that are not there, are errors.
#[test]
fn what_cannot_be_done_is_an_error() -> Outcome<()> {
    let folder = Folder::new();
    let mut session = Session::in_folder(folder.path());
    assert!(session.understand("{\"robots\": 1}").unwrap_err().to_string().contains("robots"));
    assert!(session.kind("absent.csv").unwrap_err().to_string().starts_with("absent.csv"));
    assert!(session.identify("title = 1", &mut |_| ()).is_err());
    session.put("arm.urdf", ARM.as_bytes().to_vec())?;
    assert_eq!(session.files()?, format!("[{{\"path\":\"arm.urdf\",\"bytes\":{}}}]", ARM.len()));
    session.remove("arm.urdf")?;
    assert_eq!(session.files()?, "[]");
    Ok(())
}

/// A finding whose remedy is a setting has a code; applied, the finding is gone and the columns are those of the log.
#[test]
fn a_remedy_is_applied_to_the_experiment() -> Outcome<()> {
    let folder = Folder::new();
    let mut session = Session::in_folder(folder.path());
    let mut request = answer(&session.sample("demo")?)["request"].clone();
    request["torque"] = json!(["torque_2", "torque_1", "torque_3", "torque_4", "torque_5", "torque_6"]);
    let understood = answer(&session.understand(&request.to_string())?);
    let finding = understood["findings"].as_array().unwrap().iter().find(|f| f["code"] == "joints-swapped").unwrap();
    assert_eq!(finding["apply"], json!(["joints-swapped-1-2"]), "{finding}");
    let remedies = &understood["remedies"];
    assert_eq!(remedies[0]["label"], "Exchange the torques of joints 1 and 2");
    let toml = understood["proposal"]["toml"].as_str().unwrap();
    let mended = session.apply(toml, &remedies.to_string(), "[\"joints-swapped-1-2\"]")?;
    assert!(mended.contains("\"torque_1\", \"torque_2\", \"torque_3\""), "{mended}");
    assert!(!session.check(&mended)?.contains("joints-swapped"));
    let error = session.apply(toml, &remedies.to_string(), "[\"lag\"]").unwrap_err();
    assert!(error.to_string().contains("joints-swapped-1-2"), "{error}");
    assert!(session.changed("{}", "{}").is_err());
    Ok(())
}
