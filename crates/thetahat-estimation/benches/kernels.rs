//! The kernels of the TX40, one by one: `cargo bench -p thetahat-estimation`. No data needed.

mod tx40;

use divan::{Bencher, black_box};
use thetahat_estimation::signal::Decimator;
use thetahat_ground::series::Series;
use thetahat_model::dynamics::Sign;
use tx40::{DDQ, Q, SIGN, Tx40, state};

fn main() {
    divan::main();
}

fn tx40() -> Tx40 {
    Tx40::new().expect("robots/tx40.toml")
}

#[divan::bench]
fn inverse_dynamics(bencher: Bencher) {
    let Tx40 { model, parameters, mut workspace, .. } = tx40();
    let mut tau = [0.0; 6];
    bencher.bench_local(|| {
        model.inverse_dynamics(&parameters, state(), &DDQ, SIGN, &mut workspace, &mut tau);
        tau
    });
}

#[divan::bench]
fn mass_matrix(bencher: Bencher) {
    let Tx40 { model, parameters, mut workspace, .. } = tx40();
    let mut m = [0.0; 36];
    bencher.bench_local(|| {
        model.mass_matrix(&parameters, black_box(&Q), &mut workspace, &mut m);
        m
    });
}

#[divan::bench]
fn forward_dynamics(bencher: Bencher) {
    let Tx40 { model, parameters, mut workspace, .. } = tx40();
    let mut ddq = [0.0; 6];
    bencher.bench_local(|| {
        let tau = black_box(&DDQ);
        model.forward_dynamics(&parameters, state(), tau, SIGN, &mut workspace, &mut ddq).map(|()| ddq)
    });
}

/// The 60 base columns of one sample.
#[divan::bench]
fn regressor(bencher: Bencher) {
    let Tx40 { model, mut workspace, regressor, .. } = tx40();
    let mut phi = vec![0.0; regressor.entries().len()];
    bencher.bench_local(|| {
        regressor.evaluate(&model, state(), &DDQ, Sign::Exact, &mut workspace, &mut phi);
        phi[0]
    });
}

/// 160 channels of 7.4 s at 5 kHz, by 100.
#[divan::bench(sample_count = 10)]
fn decimate_160_channels(bencher: Bencher) {
    let series = Series::shaped(160, (0..160 * 36_800).map(|k| f64::from(k % 1009)).collect());
    let decimator = Decimator::new(100, series.len()).expect("a record that is long enough");
    bencher.bench_local(|| decimator.decimate(&series));
}
