//! A base that floats: a body with an arm of two joints, simulated with a known wrench, is identified from the six equations of the
//! base alone, from torques alone, from both and in flight; and what needs a fixed base refuses it.

use std::{f64::consts::FRAC_1_SQRT_2, fmt::Write, path::Path};

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use thetahat::{
    Experiment, Method, Results, Robot, Settings,
    base_parameters::BaseParameters,
    checks::Code,
    export::{ExportError, ExportFormat, export_robot},
};
use thetahat_ground::{
    linear_algebra::Matrix,
    vector::{quaternion_rotation, transpose_times},
};
use thetahat_model::dynamics::{DynamicParameters, Model, Sign, State, Workspace, Wrench};
use thetahat_testing::Folder;

const ROBOT: &str = "name = 'arm on a body'\nfloating_base = true\n\
    [[joint]]\nname = 'first'\nkind = 'revolute'\na_m = 0.2\nb_m = 0.1\n\
    [[joint]]\nname = 'second'\nkind = 'revolute'\na_m = 0.3\nalpha_deg = 90\n\
    [parameters]\nm6 = 6.0\nmx6 = 0.3\nmy6 = -0.12\nmz6 = 0.18\nxx6 = 0.09\nyy6 = 0.14\nzz6 = 0.16\nxy6 = 0.004\n\
    m7 = 1.2\nmx7 = 0.18\nmy7 = 0.02\nmz7 = 0.01\nxx7 = 0.016\nyy7 = 0.045\nzz7 = 0.045\nia7 = 0.02\nfv7 = 0.3\nfc7 = 0.4\n\
    m8 = 0.8\nmx8 = 0.05\nmy8 = -0.015\nmz8 = 0.02\nxx8 = 0.012\nyy8 = 0.03\nzz8 = 0.03\nia8 = 0.01\nfv8 = 0.2\nfc8 = 0.3\n";
/// Where the wrench acts on the body.
const POINT: [f64; 3] = [0.09, -0.015, 0.05];
const STEP_S: f64 = 0.002;
const SECONDS: f64 = 24.0;
/// Deviations from the truth that none of 30 normal numbers exceeds in 99.9 % of all cases, and a little for the bias of filtered motion.
const DEVIATIONS: f64 = 5.0;

/// Positions, velocities and accelerations of the joints.
fn joints(t: f64) -> [[f64; 2]; 3] {
    let parts = [[(0.8, 2.1), (0.3, 5.3)], [(0.9, 2.9), (0.25, 6.1)]];
    [0, 1, 2].map(|derivative| {
        parts.map(|parts| {
            let part = |(a, w): (f64, f64)| match derivative {
                0 => a * (w * t).sin(),
                1 => a * w * (w * t).cos(),
                _ => -a * w * w * (w * t).sin(),
            };
            parts.into_iter().map(part).sum()
        })
    })
}

/// How much of the wrench acts: in each three seconds there is nothing from 1.8 to 2.6 s.
fn share(t: f64) -> f64 {
    let s = t.rem_euclid(3.0);
    let fall = |from: f64| 0.5 + 0.5 * (((s - from) / 0.2).clamp(0.0, 1.0) * std::f64::consts::PI).cos();
    if s < 2.3 { fall(1.6) } else { 1.0 - fall(2.6) }
}

struct Body {
    model: Model,
    parameters: DynamicParameters,
}

impl Body {
    fn wrench(&self, t: f64, q: &[f64], dq: &[f64]) -> Wrench {
        let spring = |j: usize, k: f64, c: f64| -k * q[j] - c * dq[j];
        let wave = |a: f64, w: f64| a * (w * t).sin();
        let force = [
            spring(0, 200.0, 60.0) + wave(30.0, 3.1),
            spring(1, 200.0, 60.0) + wave(30.0, 2.3),
            78.5 + spring(2, 200.0, 60.0),
        ];
        let moment = [
            spring(5, 30.0, 6.0) + wave(2.0, 2.7),
            spring(4, 30.0, 6.0) + wave(2.0, 1.9),
            spring(3, 30.0, 6.0) + wave(2.0, 3.7),
        ];
        let [force, moment] = [force, moment].map(|of| of.map(|value| share(t) * value));
        Wrench { joint: 5, point: POINT, in_link: false, force, moment }
    }

    fn inverse(&self, q: &[f64], dq: &[f64], ddq: &[f64]) -> Vec<f64> {
        let mut tau = vec![0.0; q.len()];
        let mut workspace = Workspace::new(&self.model);
        self.model.inverse_dynamics(&self.parameters, State::new(q, dq), ddq, Sign::Exact, &mut workspace, &mut tau);
        tau
    }

    /// Coordinates, velocities and accelerations of all at a state of the base, and what acts.
    fn at(&self, t: f64, base: &[f64]) -> ([Vec<f64>; 3], Wrench) {
        let [qj, dqj, ddqj] = joints(t);
        let (q, dq) = ([&base[..6], &qj].concat(), [&base[6..], &dqj].concat());
        let wrench = self.wrench(t, &q, &dq);
        let mut outer = vec![0.0; 8];
        self.model.add_wrenches(&q, &[wrench], &mut outer);
        let rest = self.inverse(&q, &dq, &[&[0.0; 6][..], &ddqj].concat());
        let mut mass = vec![0.0; 64];
        self.model.mass_matrix(&self.parameters, &q, &mut Workspace::new(&self.model), &mut mass);
        let own = Matrix::from_fn(6, 6, |i, j| mass[8 * i + j]).inverse().unwrap();
        let missing: Vec<f64> = (0..6).map(|i| outer[i] - rest[i]).collect();
        let ddq = [&own.times(&missing)[..], &ddqj].concat();
        ([q, dq, ddq], wrench)
    }

    fn slope(&self, t: f64, base: &[f64]) -> Vec<f64> {
        let ([_, dq, ddq], _) = self.at(t, base);
        [&dq[..6], &ddq[..6]].concat()
    }
}

/// The log of the body in motion, with noise.
fn log(robot: &Robot) -> String {
    let model = Model::new(robot);
    let parameters = DynamicParameters::new(&model, &robot.a_priori_parameters()).unwrap();
    let body = Body { model, parameters };
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    // The sum of six has a deviation of one.
    let mut noise = |size: f64| size * (0..6).map(|_| rng.random_range(-FRAC_1_SQRT_2..FRAC_1_SQRT_2)).sum::<f64>();
    let mut text = "t,px,py,pz,ow,ox,oy,oz,q1,q2,tau1,tau2,fx,fy,fz,nx,ny,nz,sx,sy,sz\n".to_owned();
    let mut base = vec![0.0; 12];
    let moved = |base: &[f64], slope: &[f64], h: f64| -> Vec<f64> {
        base.iter().zip(slope).map(|(value, slope)| value + h * slope).collect()
    };
    for k in 0..(SECONDS / STEP_S) as usize {
        let t = k as f64 * STEP_S;
        let ([q, dq, ddq], wrench) = body.at(t, &base);
        let mut outer = vec![0.0; 8];
        body.model.add_wrenches(&q, &[wrench], &mut outer);
        let tau = body.inverse(&q, &dq, &ddq);
        let [yaw, pitch, roll] = [q[3], q[4], q[5]].map(|angle| (0.5 * angle).sin_cos());
        let o = quaternion(yaw, pitch, roll);
        let of_pose = [q[0], q[1], q[2], o[0], o[1], o[2], o[3], q[6], q[7]].map(|value| value + noise(2e-6));
        let torques = [tau[6] - outer[6], tau[7] - outer[7]].map(|value| value + noise(0.05));
        let forces = [wrench.force, wrench.moment].concat().into_iter().zip([0.2, 0.2, 0.2, 0.02, 0.02, 0.02]);
        let forces: Vec<f64> = forces.map(|(value, size)| value + noise(size)).collect();
        let acceleration = [ddq[0], ddq[1], ddq[2] + 9.81];
        let specific = transpose_times(&quaternion_rotation(o), acceleration).map(|value| value + noise(0.02));
        let row: Vec<String> =
            of_pose.iter().chain(&torques).chain(&forces).chain(&specific).map(|value| format!("{value:.8}")).collect();
        writeln!(text, "{t:.3},{}", row.join(",")).unwrap();
        let h = STEP_S;
        let a = body.slope(t, &base);
        let b = body.slope(t + 0.5 * h, &moved(&base, &a, 0.5 * h));
        let c = body.slope(t + 0.5 * h, &moved(&base, &b, 0.5 * h));
        let d = body.slope(t + h, &moved(&base, &c, h));
        let mean: Vec<f64> = (0..12).map(|i| (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]) / 6.0).collect();
        base = moved(&base, &mean, h);
    }
    text
}

/// w, x, y, z of a rotation about z, then y, then x, of half angles as sine and cosine.
fn quaternion((sz, cz): (f64, f64), (sy, cy): (f64, f64), (sx, cx): (f64, f64)) -> [f64; 4] {
    [cz * cy * cx + sz * sy * sx, cz * cy * sx - sz * sy * cx, cz * sy * cx + sz * cy * sx, sz * cy * cx - cz * sy * sx]
}

fn columns(names: &[&str], unit: &str) -> String {
    format!("{{ file = 'log.csv', columns = {names:?}, unit = {unit} }}")
}

fn experiment(torque: bool, base: &str, more: &str) -> String {
    let torque = if torque { format!("torque = {}\n", columns(&["tau1", "tau2"], "'N m'")) } else { String::new() };
    format!(
        "title = 'a body'\nrobot = 'body.toml'\n[recording]\ntime = {}\nposition = {}\n{torque}[recording.base]\norientation = {}\n\
         order = 'wxyz'\n{base}\n[signal]\ncutoff_hz = 20\ndecimation = 20\n{more}",
        columns(&["t"], "'s'"),
        columns(&["q1", "q2"], "'rad'"),
        columns(&["ow", "ox", "oy", "oz"], "'1'"),
    )
}

fn position() -> String {
    format!("position = {}\n", columns(&["px", "py", "pz"], "'m'"))
}

/// The pose, and the wrench as it was measured.
fn measured() -> String {
    let force = columns(&["fx", "fy", "fz", "nx", "ny", "nz"], "['N', 'N', 'N', 'N m', 'N m', 'N m']");
    format!("{}[[recording.base.contact]]\npoint_m = {POINT:?}\naxes = 'world'\nforce = {force}\n", position())
}

fn run(folder: &Folder, text: &str) -> Result<Results, String> {
    folder.write("experiment.toml", text);
    let experiment =
        Experiment::read(&folder.path().join("experiment.toml"), folder.path()).map_err(|e| e.to_string())?;
    experiment.run(folder.path(), &mut |_| {}).map_err(|e| e.to_string())
}

/// That all estimates are near the truth, and those of some parameters are within a percent.
fn assert_near_truth(results: &Results, robot: &Robot, precise: &[&str]) {
    let theta = robot.a_priori_parameters();
    let base = BaseParameters::of(&Model::new(robot), &[]).unwrap();
    let run = results.run("nominal", Method::IDIM_WLS).unwrap();
    for p in &run.parameters {
        let of_base = base.parameters().iter().find(|b| b.name == p.name).unwrap();
        let truth = theta[of_base.kept] + of_base.regrouped.iter().map(|(i, c)| c * theta[*i]).sum::<f64>();
        let sd = p.standard_deviation_robust.unwrap();
        assert!((p.estimate - truth).abs() < DEVIATIONS * sd, "{}: {} of {truth}, {sd}", p.name, p.estimate);
        if precise.contains(&p.name.as_str()) {
            assert!((p.estimate - truth).abs() < 0.01 * truth.abs(), "{}: {} of {truth}", p.name, p.estimate);
        }
    }
    let found = |name: &&&str| run.parameters.iter().any(|p| p.name == ***name);
    assert_eq!(precise.iter().filter(found).count(), precise.len(), "{:?}", run.parameters);
}

/// The robot, and a folder with it and its log.
fn recorded() -> (Folder, Robot) {
    let (folder, robot) = (Folder::new(), Robot::parse(ROBOT, Path::new("body.toml")).unwrap());
    folder.write("body.toml", ROBOT);
    folder.write("log.csv", log(&robot));
    (folder, robot)
}

#[test]
fn mass_and_first_moments_follow_from_the_equations_of_the_base_and_of_both() {
    let (folder, robot) = recorded();
    for torque in [true, false] {
        let results = run(&folder, &experiment(torque, &measured(), "")).unwrap();
        assert_near_truth(&results, &robot, &["m6r", "mx6r", "mz6r"]);
    }
}

#[test]
#[ignore = "long, each night"]
fn what_is_not_measured_of_the_base_and_its_contacts_is_done_without() {
    let (folder, robot) = recorded();
    let identified = |torque: bool, base: &str| run(&folder, &experiment(torque, base, "")).unwrap();
    let all = ["m6r", "mx6r", "mz6r"];
    // An accelerometer in the place of positions.
    let specific = format!("specific_force = {}\n", columns(&["sx", "sy", "sz"], "'m/s^2'"));
    assert_near_truth(&identified(false, &measured().replace(&position(), &specific)), &robot, &all);
    // The wrench is not known: the joints' equations say nothing of the whole mass.
    let held = identified(true, &format!("{}contacts = 'base'\n", position()));
    assert_near_truth(&held, &robot, &[]);
    assert!(held.run("nominal", Method::IDIM_WLS).unwrap().parameters.iter().all(|p| p.name != "m6r"));
    // In flight the joints' equations alone are used.
    let stated = identified(
        true,
        &format!("{}contacts = [[1.9, 2.5], [4.9, 5.5], [7.9, 8.5], [10.9, 11.5], [13.9, 14.5]]", position()),
    );
    assert_near_truth(&stated, &robot, &[]);
    let found = identified(true, &format!("{}contacts = 'flight'\n", position()));
    assert_near_truth(&found, &robot, &[]);
    let findings = &found.findings[0].findings;
    let used = findings.iter().find(|f| f.code == Code::EquationsUsed).unwrap();
    assert!(used.message.contains("without contact, and used: 1.80 to 2.56 s"), "{}", used.message);
    // The base's equations have zeros alone on the right, and are left out.
    assert!(used.message.contains("of the base are used in 0 % of the window"), "{}", used.message);
    let refused = run(&folder, &experiment(false, &format!("{}contacts = 'flight'\n", position()), "")).unwrap_err();
    assert!(
        refused.contains("rows without any force") && refused.contains("the scale of all masses is free"),
        "{refused}"
    );
}

#[test]
fn what_is_missing_or_needs_a_fixed_base_is_refused() {
    let folder = Folder::new();
    folder.write("body.toml", ROBOT);
    let refused = |text: &str| run(&folder, text).unwrap_err();
    let no_base = experiment(true, "", "").replace("[recording.base]\n", "[recording.channels]\n");
    for (text, part) in [
        (experiment(true, "", ""), "position or specific_force"),
        (experiment(true, &position(), ""), "what touches the robot"),
        (
            experiment(true, &format!("{}contacts = 'measured'", position()), ""),
            "a [[recording.base.contact]] for each",
        ),
        (experiment(true, &format!("{}contacts = [[2, 1]]", position()), ""), "start before end"),
        (experiment(true, &measured(), "[estimation]\nmethods = ['idim-iv']\n"), "idim-ls or idim-wls"),
        (experiment(true, &measured().replace("'m'", "'s'"), ""), "position"),
        (no_base.replace("order = 'wxyz'\n", ""), "[recording.base]"),
    ] {
        folder.write(
            "log.csv",
            "t,px,py,pz,ow,ox,oy,oz,q1,q2,tau1,tau2,fx,fy,fz,nx,ny,nz\n0,0,0,0,1,0,0,0,0,0,1,1,0,0,0,0,0,0\n",
        );
        let found = refused(&text);
        assert!(found.contains(part), "{part}: {found}");
    }
    let upright =
        "t,px,py,pz,ow,ox,oy,oz,q1,q2,tau1,tau2,fx,fy,fz,nx,ny,nz\n0,0,0,0,0.7071,0,0.7071,0,0,0,1,1,0,0,0,0,0,0\n";
    folder.write("log.csv", upright);
    let found = refused(&experiment(true, &measured(), ""));
    assert!(found.contains("sample 0") && found.contains("3 degrees away from 90"), "{found}");
    let robot = Robot::parse(ROBOT, Path::new("body.toml")).unwrap();
    let settings = Settings::new(20.0, 10).for_robot(&robot).unwrap();
    assert!(settings.validate(&robot).is_ok());
}

#[test]
fn exports_have_the_root_body_on_a_free_joint() {
    let robot = Robot::parse(ROBOT, Path::new("body.toml")).unwrap();
    let parameters = robot.a_priori_parameters();
    let export = |urdf: Option<&str>, format| export_robot(&robot, urdf, &parameters, format, &[]);
    for format in [ExportFormat::Mjcf, ExportFormat::Urdf, ExportFormat::Sdf] {
        let exported = export(None, format).unwrap();
        assert!(exported.check().unwrap() < 1e-9, "{format:?}");
        if format == ExportFormat::Mjcf {
            assert!(exported.text.contains("<freejoint name=\"base\"/>"), "{}", exported.text);
        }
        if format == ExportFormat::Urdf {
            // The file of the user's own is edited: the root link as well.
            let toml = format!("floating_base = true\nurdf_text = '''{}'''", exported.text);
            let read = Robot::parse(&toml, Path::new("r.toml")).unwrap();
            let mut heavier = read.a_priori_parameters();
            let mass = read.parameter_table().index_of("m6").unwrap();
            heavier[mass] *= 1.5;
            let edited = export_robot(&read, Some(&exported.text), &heavier, format, &[]).unwrap();
            assert!(edited.check().unwrap() < 1e-9);
            assert!(edited.text.contains("<mass value=\"9\"/>"), "{}", edited.text);
        }
    }
    assert!(matches!(export(None, ExportFormat::Pace), Err(ExportError::FloatingBase { .. })));
}
