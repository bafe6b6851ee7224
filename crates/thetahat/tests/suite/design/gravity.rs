//! What sweeps tell of gravity, against static postures that are passed slowly in both directions.

use std::path::Path;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use thetahat::{
    Robot, Series, Settings,
    base_parameters::BaseParameters,
    design::{Criterion, Design, ExpectedRecording, Information},
    dynamics::{DynamicParameters, Model, Sign, State, Workspace},
    signal::Motion,
    trajectory::{Move, Moves},
};
use thetahat_estimation::trajectory::TimeLaw;
use thetahat_testing::project;

const RATE_HZ: f64 = 500.0;
const NOISE: [f64; 3] = [0.25, 0.35, 0.12];
const START: [f64; 3] = [0.0, 30.0, 45.0];
/// Half of the way of a slow pass, and its velocity: degrees and degrees/s.
const HALF: f64 = 1.5;
const SLOW: f64 = 6.0;
const POSTURES: usize = 12;
/// Sets of postures of which the best is taken.
const SETS: usize = 60;
/// What dry friction is larger near rest, N m, and the velocity over which it falls, rad/s: the model does not have it.
const STRIBECK: (f64, f64) = (1.0, 0.1);

/// A design of the arm with moves for a time.
fn design(duration_s: f64, more: &str, wanted: &str) -> Design {
    let text = format!(
        "title = 'gravity'\nrobot = 'arm.urdf'\nduration_s = {duration_s}\nsample_rate_hz = {RATE_HZ}\n{wanted}\n[motion]\nkind = 'moves'\n\
         moves = 10\nstarts = 2\nstart = {START:?}\nsmoothing_s = 0.002\n{more}\n[limits]\nacceleration = [600, 600, 1000]\n[noise]\ntorque = {NOISE:?}\n\
         [signal]\ncutoff_hz = 40\ndecimation = 20\n[uncertainty]\novershoot_percent = 0\n"
    );
    Design::parse(&text, &project("examples/arm/design.toml")).unwrap()
}

fn motion_of(design: &Design) -> Motion {
    let results = design.run(2).unwrap();
    Motion { q: results.q, dq: results.dq, ddq: results.ddq }
}

/// Ways through postures in turn from the start: to one side of each, slowly to its other side and back.
fn passes(postures: &[Vec<f64>]) -> Motion {
    let start: Vec<f64> = START.iter().map(|q| q.to_radians()).collect();
    let (mut moves, mut time_s, mut from) = (Vec::new(), 0.0, start.clone());
    let mut go = |end: Vec<f64>, velocity: f64| {
        let way = end.iter().zip(&from).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let t2_s = velocity / 600f64.to_radians();
        let t1_s = (way / velocity).max(t2_s + 0.002);
        moves.push(Move {
            law: TimeLaw { start_s: time_s, t1_s, t2_s: t2_s.max(0.002), t3_s: 0.002 },
            end: end.clone(),
        });
        time_s += t1_s + t2_s.max(0.002) + 0.002;
        from = end;
    };
    for posture in postures {
        let side = |by: f64| posture.iter().map(|q| q + by.to_radians()).collect::<Vec<_>>();
        go(side(-HALF), 2.5);
        go(side(HALF), SLOW.to_radians());
        go(side(-HALF), SLOW.to_radians());
    }
    go(start.clone(), 2.5);
    Moves::new(start, moves).unwrap().sample(RATE_HZ, (time_s * RATE_HZ) as usize)
}

/// Of random sets of postures the one whose passes tell most of the gravity parameters.
fn best_passes(model: &Model, columns: &[usize], gravity: &[usize], rng: &mut ChaCha8Rng) -> Motion {
    let information = Information::new(model, columns, &NOISE);
    let criterion = Criterion::SelectedParameters { columns: gravity.to_vec() };
    let set = |rng: &mut ChaCha8Rng| {
        let posture = |rng: &mut ChaCha8Rng| [2.6, 1.9, 2.3].map(|end: f64| rng.random_range(-end..end)).to_vec();
        passes(&(0..POSTURES).map(|_| posture(rng)).collect::<Vec<_>>())
    };
    let sets: Vec<Motion> = (0..SETS).map(|_| set(rng)).collect();
    let value = |motion: &Motion| {
        let m = information.of([&motion.q, &motion.dq, &motion.ddq], 1.0, Sign::Exact);
        criterion.value(&m).unwrap_or(f64::INFINITY)
    };
    sets.into_iter().min_by(|a, b| value(a).total_cmp(&value(b))).unwrap()
}

fn behind(first: &Motion, second: &Motion) -> Motion {
    let one = |a: &Series, b: &Series| Series::shaped(3, [a.values(), b.values()].concat());
    Motion { q: one(&first.q, &second.q), dq: one(&first.dq, &second.dq), ddq: one(&first.ddq, &second.ddq) }
}

/// The torques of a motion; with friction that the model does not have.
fn torques(robot: &Robot, motion: &Motion, stribeck: f64) -> Series {
    let model = Model::new(robot);
    let parameters = DynamicParameters::sorted(&model, &robot.a_priori_parameters());
    let (mut tau, mut workspace) = (Series::zeros(motion.q.len(), 3), Workspace::new(&model));
    for k in 0..motion.q.len() {
        let dq = motion.dq.sample(k);
        let state = State::new(motion.q.sample(k), dq);
        model.inverse_dynamics(
            &parameters,
            state,
            motion.ddq.sample(k),
            Sign::Exact,
            &mut workspace,
            tau.sample_mut(k),
        );
        for (tau, v) in tau.sample_mut(k).iter_mut().zip(dq) {
            *tau += stribeck * STRIBECK.0 * v.signum() * (-v.abs() / STRIBECK.1).exp() * f64::from(u8::from(*v != 0.0));
        }
    }
    tau
}

/// Geometric mean of the half widths of the gravity parameters, and the root mean square of what friction that the model does not
/// have changes of their estimates.
fn told(robot: &Robot, settings: &Settings, motion: &Motion, is_gravity: &dyn Fn(&str) -> bool) -> [f64; 2] {
    let [model_only, with_stribeck] = [0.0, 1.0].map(|part| torques(robot, motion, part));
    let record = |tau| ExpectedRecording {
        robot,
        settings,
        sample_rate_hz: RATE_HZ,
        q: &motion.q,
        tau,
        torque_noise: &NOISE,
        torque_spectrum: None,
        position_noise: &[0.0; 3],
    };
    let path = Path::new("design.toml");
    let expected = record(&model_only).predict(path, 1, 2).unwrap();
    let [clean, biased] = [&model_only, &with_stribeck].map(|tau| record(tau).estimate(path, 1, 0).unwrap());
    let places: Vec<usize> =
        (0..expected.parameters.len()).filter(|&i| is_gravity(&expected.parameters[i].name)).collect();
    let count = places.len() as f64;
    let half = places.iter().map(|&i| expected.half_width_95[i].ln()).sum::<f64>() / count;
    let change = places.iter().map(|&i| (biased.fit.theta[i] - clean.fit.theta[i]).powi(2)).sum::<f64>() / count;
    [half.exp(), change.sqrt()]
}

/// In the same time, moves for the gravity parameters tell them nearly as narrowly as postures do, and are changed less by friction that
/// the model does not have; so are sweeps.
#[test]
#[ignore = "long, each night"]
fn gravity_needs_no_static_postures() {
    let alone = design(30.0, "", "");
    let robot = &alone.robot;
    let model = Model::new(robot);
    let base = BaseParameters::of(&model, &[]).unwrap();
    let is_gravity = |name: &str| ["mx", "my", "mz"].iter().any(|first| name.starts_with(first));
    let names: Vec<String> = base.parameters().iter().map(|p| p.name.clone()).collect();
    let gravity: Vec<usize> = (0..names.len()).filter(|&i| is_gravity(&names[i])).collect();
    let listed: Vec<&String> = gravity.iter().map(|&i| &names[i]).collect();
    let passes = best_passes(&model, &base.columns(), &gravity, &mut ChaCha8Rng::seed_from_u64(1));
    let passed_s = passes.q.len() as f64 / RATE_HZ;
    let rest = (30.0 - passed_s).round();
    let sweeps = "sweeps = 4\nsweep_s = 1.0";
    let chosen = format!("[wanted]\ncriterion = 'chosen'\nparameters = {listed:?}");
    println!("{listed:?}; postures take {passed_s:.2} s of 30");
    let all = [
        ("moves", motion_of(&alone)),
        ("moves for gravity", motion_of(&design(30.0, "", &chosen))),
        ("moves and sweeps", motion_of(&design(30.0, sweeps, ""))),
        ("moves and postures", behind(&motion_of(&design(rest, "", "")), &passes)),
    ]
    .map(|(name, motion)| {
        let [half, change] = told(robot, &alone.settings, &motion, &is_gravity);
        println!("{name}: half width {half:.2e}, changed by friction by {change:.2e} kg m");
        [half, change]
    });
    let [moves, for_gravity, swept, postures] = all;
    assert!(for_gravity[0] < 1.2 * postures[0] && for_gravity[1] < 0.7 * postures[1], "{all:?}");
    assert!(swept[0] < 2.5 * postures[0] && swept[1] < 0.8 * postures[1], "{all:?}");
    assert!(moves[1] > for_gravity[1], "{all:?}");
}
