//! Families of moves against finite differences, their own moves, and their limits.

use crate::design::{
    limits::joint_limits::JointLimits,
    motions::{moves::MoveFamily, sums::Slopes},
};
use thetahat_ground::series::Series;
use thetahat_model::robot::JointKind;

fn limits(jerk: Option<f64>) -> Vec<JointLimits> {
    let of = |joint: &str, upper: f64, velocity: f64| JointLimits {
        joint: joint.to_owned(),
        kind: JointKind::Revolute,
        start: None,
        lower: -0.5,
        upper,
        velocity,
        acceleration: 20.0,
        jerk,
        torque: None,
        power: None,
    };
    vec![of("a", 1.5, 3.0), of("b", 2.0, 5.0)]
}

fn families() -> Vec<MoveFamily> {
    let of = |jerk, start| MoveFamily {
        limits: limits(jerk),
        start,
        moves: 3,
        duration_s: 4.0,
        smoothing_s: 0.01,
        rest_s: 0.05,
        sweeps: Vec::new(),
    };
    vec![of(None, None), of(Some(200.0), None), of(Some(200.0), Some(vec![0.3, 0.1]))]
}

/// Unknowns of moves at some postures, slower than the limits allow.
fn unknowns(family: &MoveFamily) -> Vec<f64> {
    let postures: Vec<f64> = (0..family.posture_unknowns()).map(|i| (1.7 * i as f64).sin()).collect();
    let mut x = family.through(&postures);
    x[family.posture_unknowns()..].chunks_exact_mut(family.widths()).for_each(|widths| {
        widths[0] += 0.1;
    });
    x
}

/// Of sums of positions, velocities, accelerations and times at the points, each times a number.
#[test]
fn the_chain_is_that_of_finite_differences() {
    for family in families() {
        let (x, points) = (unknowns(&family), family.summed());
        let number = |k: usize, j: usize, order: usize| ((3 * k + 5 * j + 7 * order) as f64).cos();
        let value = |x: &[f64]| {
            let (motion, seconds) = (family.motion(&points, x), family.seconds(&points, x));
            let mut sum: f64 = seconds.iter().enumerate().map(|(k, s)| number(k, 0, 9) * s).sum();
            for (order, series) in motion[..3].iter().enumerate() {
                for k in 0..points.len() {
                    sum += series.sample(k).iter().enumerate().map(|(j, v)| number(k, j, order) * v).sum::<f64>();
                }
            }
            sum
        };
        let by_motion = [0, 1, 2]
            .map(|order| Series::shaped(2, (0..2 * points.len()).map(|i| number(i / 2, i % 2, order)).collect()));
        let by_seconds = (0..points.len()).map(|k| number(k, 0, 9)).collect();
        let exact = family.chain(&points, &x, &Slopes { by_motion, by_seconds });
        for (i, exact) in exact.iter().enumerate() {
            let h = 1e-6;
            let moved =
                |h: f64| value(&x.iter().enumerate().map(|(k, v)| if k == i { v + h } else { *v }).collect::<Vec<_>>());
            let central = (moved(h) - moved(-h)) / (2.0 * h);
            assert!((central - exact).abs() < 1e-6 * exact.abs().max(100.0), "{i}: {central} {exact}");
        }
    }
}

/// The points of the phases lie on the moves, and their times add up to the moves' own.
#[test]
fn points_are_of_the_moves() {
    for family in families() {
        let (x, points) = (unknowns(&family), family.summed());
        let moves = family.moves(&x).unwrap();
        let sum: f64 = family.seconds(&points, &x).iter().sum();
        assert!((sum - (moves.end_s() - 2.0 * family.rest_s)).abs() < 1e-12);
        assert_eq!(moves.start(), moves.moves()[2].end);
        // The middle of the cruise of the second move.
        let law = moves.moves()[1].law;
        let cruise = points.iter().position(|p| p.number == 1 && p.phase == 3 && p.part == 0.5).unwrap();
        let (mut q, mut dq, mut ddq) = ([0.0; 2], [0.0; 2], [0.0; 2]);
        moves.evaluate(law.start_s + 0.5 * (law.t2_s + law.t3_s + law.t1_s), &mut q, &mut dq, &mut ddq);
        let motion = family.motion(&points, &x);
        for (found, expected) in motion.iter().zip([q, dq, ddq]) {
            assert!(found.sample(cruise).iter().zip(expected).all(|(f, e)| (f - e).abs() < 1e-9));
        }
    }
}

/// Moves through postures hold the limits of velocity, acceleration and jerk.
#[test]
fn the_fastest_moves_hold_their_limits() {
    for family in families() {
        let postures: Vec<f64> = (0..family.posture_unknowns()).map(|i| (1.7 * i as f64).sin()).collect();
        let x = family.through(&postures);
        let motion = family.motion(&family.watched(), &x);
        for (j, limits) in family.limits.iter().enumerate() {
            let largest = |order: usize| motion[order].channel(j).into_iter().fold(0.0, |a: f64, v| a.max(v.abs()));
            assert!(largest(1) <= limits.velocity * (1.0 + 1e-9));
            assert!(largest(2) <= limits.acceleration * (1.0 + 1e-9));
            assert!(limits.jerk.is_none_or(|jerk| largest(3) <= jerk * (1.0 + 1e-9)));
        }
        assert!(family.time_s(&x) <= family.duration_s);
    }
}
