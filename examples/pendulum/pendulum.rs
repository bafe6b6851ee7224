// The robot and the recording of the programs in docs/manual/rust.md, which include this file.

/// A pendulum: 2 kg at 0.3 m.
const URDF: &str = r#"<robot name="pendulum"><link name="base"/><link name="arm"><inertial><origin xyz="0.3 0 0"/>
  <mass value="2"/><inertia ixx="0.01" iyy="0.05" izz="0.05" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/>
  <limit lower="-3" upper="3" effort="50" velocity="5"/></joint></robot>"#;

/// The pendulum's description.
#[allow(dead_code)]
fn robot() -> thetahat::Robot {
    thetahat::Robot::parse(URDF, "pendulum.urdf".as_ref()).unwrap()
}

/// Positions in rad and torques in N m of 10 s at 1 kHz, along a motion with a phase:
/// `tau = 0.23 ddq - 5.886 cos q + 0.4 dq + 0.6 sign(dq)`, with noise.
fn logged(phase: f64) -> (Vec<f64>, Vec<f64>) {
    let waves = [(1.7, 0.7), (4.1, 0.15)];
    let of = |t: f64, f: fn(f64, f64, f64, f64) -> f64| waves.iter().map(|&(w, a)| f(w, a, t, phase)).sum::<f64>();
    let sample = |k: i32| {
        let t = 1e-3 * f64::from(k);
        let q = of(t, |w, a, t, p| a * (p.cos() - (w * t + p).cos()));
        let dq = of(t, |w, a, t, p| a * w * (w * t + p).sin());
        let ddq = of(t, |w, a, t, p| a * w * w * (w * t + p).cos());
        let noise = 0.1 * ((12.9898 * f64::from(k)).sin() * 43758.5453).fract();
        (q, 0.23 * ddq - 5.886 * q.cos() + 0.4 * dq + 0.6 * dq.signum() + noise)
    };
    (0..10_000).map(sample).unzip()
}

/// The same in a text file with columns `q`, in degrees, and `tau`.
#[allow(dead_code)]
fn log_file(name: &str, phase: f64) -> std::path::PathBuf {
    let (q, tau) = logged(phase);
    let rows: String = q.iter().zip(tau).map(|(q, tau)| format!("{},{tau}\n", q.to_degrees())).collect();
    let path = std::env::temp_dir().join(format!("thetahat-{}-{name}", std::process::id()));
    std::fs::write(&path, format!("q,tau\n{rows}")).unwrap();
    path
}
