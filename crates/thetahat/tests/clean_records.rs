//! No finding on records of robots without a defect: other robots, rates, frictions and sensors than those of the
//! corruption suite.

#[path = "clean_records/twin.rs"]
mod twin;

use libtest_mimic::{Arguments, Failed, Trial};
use thetahat::checks::{Code, Finding, Severity};
use thetahat_testing::ensure;
use twin::{Friction, Twin};

const ROBOTS: [&str; 6] =
    ["seven_axes.urdf", "branching.urdf", "quadruped.urdf", "scara.toml", "ur10.toml", "tx40.toml"];

const SIGN: Friction = Friction { coulomb: [0.1, 0.1], stribeck: 0.0, stribeck_velocity: 1.0, presliding: 0.0 };

/// Frictions by name: as the model has it, of a wrist that is friction alone, with hysteresis, with a Stribeck curve.
const FRICTIONS: [(&str, Friction); 4] = [
    ("coulomb friction", SIGN),
    ("wrists of friction", Friction { coulomb: [0.1, 3.0], ..SIGN }),
    ("hysteresis", Friction { coulomb: [0.1, 3.0], presliding: 0.02, ..SIGN }),
    ("a stribeck curve", Friction { coulomb: [0.1, 1.0], stribeck: 0.5, stribeck_velocity: 0.05, presliding: 0.002 }),
];

/// Sample rate, seconds, highest frequency of the motion, cut-off.
const RATES: [[f64; 4]; 4] =
    [[50.0, 60.0, 0.4, 5.0], [125.0, 40.0, 0.6, 10.0], [1000.0, 20.0, 0.8, 20.0], [5000.0, 10.0, 1.0, 40.0]];

fn twins() -> Vec<(String, Twin)> {
    let mut all = Vec::new();
    for (r, robot) in ROBOTS.into_iter().enumerate() {
        for (f, (friction_name, friction)) in FRICTIONS.into_iter().enumerate() {
            for (k, [rate_hz, seconds, motion_hz, cutoff_hz]) in RATES.into_iter().enumerate() {
                let torque_steps = [0.0, 400.0][(r + f + k) % 2];
                let seed = (100 * r + 10 * f + k) as u64;
                let (noise, late) = (0.02, 0.0);
                let twin = Twin { robot, rate_hz, seconds, motion_hz, cutoff_hz, friction, noise, torque_steps, late, seed };
                all.push((format!("{robot} with {friction_name} at {rate_hz} Hz"), twin));
            }
        }
    }
    all
}

/// What is true of some twins: friction that the model does not have is not explained, and the offset of the branching
/// robot's slide is nearly its weight.
fn is_true(twin: &Twin, finding: &Finding) -> bool {
    match finding.code {
        Code::PoorFit => twin.friction.presliding > 0.0,
        Code::NotExcited => twin.robot == "branching.urdf",
        _ => false,
    }
}

fn is_clean(twin: &Twin) -> Result<(), Failed> {
    let serious = |f: &Finding| (f.severity < Severity::Note || f.code == Code::Lag) && !is_true(twin, f);
    let found: Vec<String> =
        twin.record().findings().iter().filter(|f| serious(f)).map(|f| format!("[{}] {}", f.code, f.message)).collect();
    ensure(found.is_empty(), found.join("\n"))
}

fn main() {
    let trial = |(name, twin): (String, Twin)| Trial::test(name, move || is_clean(&twin));
    libtest_mimic::run(&Arguments::from_args(), twins().into_iter().map(trial).collect()).exit()
}
