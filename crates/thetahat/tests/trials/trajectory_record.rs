//! The reference of the TX40's record, `shared/datasets/tx40`: 13 moves and ten numbers for each.

use libtest_mimic::{Failed, Trial};
use thetahat::{
    Robot, Series,
    trajectory::{Move, Moves},
};
use thetahat_estimation::trajectory::reconstruct;

const RATE_HZ: f64 = 5000.0;
/// The moving part of the record, in s.
const WINDOW_S: (f64, f64) = (0.06, 7.42);
/// The joints follow their reference to about a milliradian: tracking, not noise, is what is left.
const LARGEST_RMS_RAD: f64 = 1.5e-3;

fn read_motor_positions() -> Result<Series, Failed> {
    let mut reader = csv::Reader::from_path(thetahat_testing::shared().join("datasets/tx40/pos_read_data.csv"))?;
    let mut values = Vec::new();
    for row in reader.records() {
        for cell in &row? {
            values.push(cell.trim().parse()?);
        }
    }
    Ok(Series::shaped(6, values))
}

fn joint_positions() -> Result<Series, Failed> {
    let robot = Robot::read(&thetahat_testing::root().join("robots/tx40.toml"))?;
    Ok(robot.transmission.joint_positions(&read_motor_positions()?))
}

/// The mean over 51 samples about each; at the ends over those there are.
fn smoothed(x: &[f64]) -> Vec<f64> {
    let mean = |s: &[f64]| s.iter().sum::<f64>() / s.len() as f64;
    (0..x.len()).map(|k| mean(&x[k.saturating_sub(25)..(k + 26).min(x.len())])).collect()
}

fn velocity(position: &Series) -> Series {
    let channel = |j: usize| {
        let x = smoothed(&smoothed(&position.channel(j)));
        let last = x.len() - 1;
        (0..x.len()).map(|k| (x[(k + 1).min(last)] - x[k.saturating_sub(1)]) * RATE_HZ / 2.0).collect()
    };
    Series::side_by_side(&(0..position.channels()).map(channel).collect::<Vec<_>>())
}

fn rms_in_window(q: &Series, moves: &Moves) -> Vec<f64> {
    let reference = moves.sample(RATE_HZ, q.len()).q;
    let (first, last) = ((WINDOW_S.0 * RATE_HZ) as usize, (WINDOW_S.1 * RATE_HZ) as usize);
    let square = |k: usize, j: usize| (q.sample(k)[j] - reference.sample(k)[j]).powi(2);
    let mean_square = |j: usize| (first..=last).map(|k| square(k, j)).sum::<f64>() / (last - first + 1) as f64;
    (0..q.channels()).map(|j| mean_square(j).sqrt()).collect()
}

fn thirteen_moves_follow_the_record() -> Result<(), Failed> {
    let q = joint_positions()?;
    let found = reconstruct(&q, &velocity(&q), RATE_HZ)?;
    assert_eq!(found.moves.moves().len(), 13);
    assert!(found.moves.moves().iter().all(|m| numbers(m) <= 10));
    let rms = rms_in_window(&q, &found.moves);
    assert!(rms.iter().all(|r| *r <= LARGEST_RMS_RAD), "rms deviation {rms:?}");
    Ok(())
}

/// Start, T1, T2, T3 and the end point.
fn numbers(motion: &Move) -> usize {
    4 + motion.end.len()
}

/// The trials of this module.
pub fn all_trials() -> Vec<Trial> {
    thetahat_testing::trials_on_shared_data(
        &["datasets/tx40"],
        vec![("thirteen_moves_follow_the_record", thirteen_moves_follow_the_record)],
    )
}
