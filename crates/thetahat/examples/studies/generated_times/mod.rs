//! Times of generated C and of the library's kernels, on the TX40 in one run: the table of `docs/manual/generated_code.md`.
//!
//! `cargo run --release -p thetahat --example studies -- generated_times [PYTHON]`; it needs `cc`. With a Python that has `pin` and `cmeel-eigen`,
//! Pinocchio in C++ runs in the same run.

mod pinocchio;

use std::{error::Error, fmt::Write, hint::black_box, path::PathBuf, process::Command, time::Instant};

use thetahat::{
    Robot,
    base_parameters::BaseParameters,
    dynamics::{DynamicParameters, Model, Sign, State, Workspace},
    regressor::Regressor,
    symbolic::{Function, Language, ModelKind, ParameterSet, Request},
};

/// A round is short, so that some are not interrupted on a busy machine.
const CALLS: usize = 1_000;
const ROUNDS: usize = 500;
/// States of a batch.
const BATCH: usize = 500;
const JOINTS: usize = 6;
const MODELS: [ModelKind; 4] =
    [ModelKind::InverseDynamics, ModelKind::MassMatrix, ModelKind::ForwardDynamics, ModelKind::Regressor];

const CLOCK: &str = "static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec * 1e9 + t.tv_nsec;
}
";

/// Runs the study.
pub fn main() -> Result<(), Box<dyn Error>> {
    let robot = Robot::read(&PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../robots/tx40.toml"))?;
    let folder = std::env::temp_dir().join(format!("thetahat-times-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    let mut program = "#include <stdio.h>\n#include <time.h>\n".to_owned();
    let mut body = String::new();
    for model in MODELS {
        let function = Function::new(&robot, &Request::new(model, ParameterSet::Base))?;
        let name = format!("tx40_{}", model.identifier());
        std::fs::write(folder.join(format!("{name}.h")), Language::C.code(&function, Some("tx40"))?)?;
        writeln!(program, "#include \"{name}.h\"")?;
        body += &timed(&function, &name);
    }
    program += CLOCK;
    write!(program, "int main(void) {{\n{body}    return 0;\n}}\n")?;
    std::fs::write(folder.join("main.c"), program)?;
    let library = kernels(&robot)?;
    let peer = match super::arguments().next() {
        Some(python) => Some(pinocchio::times(&python, &robot, &folder)?),
        None => {
            eprintln!("without a Python that has pin==4.1.0 and cmeel-eigen, Pinocchio is left out");
            None
        }
    };
    println!(
        "| model, ns | C library's sines | own sines | own sines, batch of {BATCH} | kernel of the library | Pinocchio, C++ | ratio |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- |");
    let [with_library, own] = [&[][..], &["-DTHETAHAT_OWN_SINES"]].map(|flags| run(&folder, flags));
    let (with_library, own) = (with_library?, own?);
    for (i, model) in MODELS.into_iter().enumerate() {
        let (c, own_single, own_batch) = (with_library[2 * i], own[2 * i], own[2 * i + 1]);
        let peer = peer.map_or_else(|| " | ".to_owned(), |peer| format!("{:.0} | {:.1}", peer[i], peer[i] / c));
        println!("| {} | {c:.0} | {own_single:.0} | {own_batch:.0} | {:.0} | {peer} |", model.identifier(), library[i]);
    }
    Ok(std::fs::remove_dir_all(folder)?)
}

/// C that prints the least time of a single call, and of a state in a batch, over several rounds.
const TIMED: &str = r#"
    {
        static double INPUTS[JOINTS * BATCH], theta[PARAMETERS], constants[CONSTANTS], out[ENTRIES * BATCH];
        volatile double sink = 0.0;
        double best = 1e30, best_batch = 1e30;
        for (int k = 0; k < PARAMETERS; k++) theta[k] = 1.0 + 0.01 * k;
        for (int k = 0; k < JOINTS * BATCH; k++) a0[k] = a1[k] = a2[k] = (k * 37 % 101) / 50.0 - 1.0;
        PREPARE;
        for (int round = 0; round < ROUNDS; round++) {
            double start = now();
            for (int k = 0; k < CALLS; k++) {
                NAME(ARGUMENTS, out);
                sink += out[0];
                a0[k % JOINTS] += 1e-9;
            }
            const double single = (now() - start) / CALLS;
            start = now();
            for (int k = 0; k < CALLS / BATCH; k++) {
                NAME_batch(BATCH, ARGUMENTS, out);
                sink += out[0];
            }
            const double batch = (now() - start) / CALLS;
            best = single < best ? single : best;
            best_batch = batch < best_batch ? batch : best_batch;
        }
        (void)theta, (void)constants;
        printf("%g\n%g\n", best, best_batch);
    }
"#;

/// That of a function.
fn timed(function: &Function, name: &str) -> String {
    let arrays: Vec<String> = (0..function.model.inputs().len()).map(|i| format!("a{i}")).collect();
    let takes_parameters = function.model.takes_parameters();
    let arguments = arrays.join(", ") + if takes_parameters { ", constants" } else { "" };
    let constants = if takes_parameters { format!("{}_CONSTANTS", name.to_uppercase()) } else { "1".to_owned() };
    let prepare = if takes_parameters { format!("{name}_prepare(theta, constants)") } else { String::new() };
    let texts = [("INPUTS[JOINTS * BATCH]", "a0[JOINTS * BATCH], a1[JOINTS * BATCH], a2[JOINTS * BATCH]".to_owned())];
    let rest = [("PREPARE", prepare), ("NAME", name.to_owned()), ("ARGUMENTS", arguments)];
    let numbers = [
        ("JOINTS", JOINTS),
        ("BATCH", BATCH),
        ("ROUNDS", ROUNDS),
        ("CALLS", CALLS),
        ("PARAMETERS", function.parameters.len()),
        ("ENTRIES", function.shape[0] * function.shape[1]),
    ]
    .map(|(word, number)| (word, number.to_string()));
    let words = texts.into_iter().chain(rest).chain(numbers).chain([("CONSTANTS]", format!("{constants}]"))]);
    words.fold(TIMED.to_owned(), |text, (word, value)| text.replace(word, &value))
}

fn run(folder: &std::path::Path, flags: &[&str]) -> Result<Vec<f64>, Box<dyn Error>> {
    let usual =
        ["-std=gnu99", "-O3", "-march=native", "-fno-math-errno", "-fno-trapping-math", "main.c", "-o", "main", "-lm"];
    let compiled = Command::new("cc").current_dir(folder).args(flags).args(usual).status()?;
    if !compiled.success() {
        return Err("cc failed".into());
    }
    let output = Command::new(folder.join("main")).output()?;
    Ok(String::from_utf8(output.stdout)?.split_whitespace().map(str::parse).collect::<Result<_, _>>()?)
}

/// The library's kernels, for one state.
fn kernels(robot: &Robot) -> Result<[f64; 4], Box<dyn Error>> {
    let model = Model::new(robot);
    let base = BaseParameters::of(&model, &[])?;
    let parameters = DynamicParameters::sorted(&model, &robot.a_priori_parameters());
    let regressor = Regressor::new(&model, &base.columns());
    let mut workspace = Workspace::new(&model);
    let (q, dq, ddq) = ([0.1, -0.4, 0.7, 1.1, -0.8, 0.3], [0.5; JOINTS], [1.0; JOINTS]);
    let (state, sign) = (State::new(&q, &dq), Sign::Exact);
    let mut tau = [0.0; JOINTS];
    let idm = least(|| {
        model.inverse_dynamics(&parameters, black_box(state), &ddq, sign, &mut workspace, black_box(&mut tau))
    });
    let mut m = [0.0; JOINTS * JOINTS];
    let mass = least(|| model.mass_matrix(&parameters, black_box(&q), &mut workspace, black_box(&mut m)));
    let mut accelerations = [0.0; JOINTS];
    let ddm = least(|| {
        let solved = model.forward_dynamics(
            &parameters,
            black_box(state),
            &tau,
            sign,
            &mut workspace,
            black_box(&mut accelerations),
        );
        assert!(solved.is_ok());
    });
    let mut phi = vec![0.0; regressor.entries().len()];
    let columns =
        least(|| regressor.evaluate(&model, black_box(state), &ddq, sign, &mut workspace, black_box(&mut phi)));
    Ok([idm, mass, ddm, columns])
}

/// The least time of a call over several rounds, ns.
fn least(mut call: impl FnMut()) -> f64 {
    let round = |_: usize| {
        let start = Instant::now();
        (0..CALLS).for_each(|_| call());
        start.elapsed().as_secs_f64() * 1e9 / CALLS as f64
    };
    (0..ROUNDS).map(round).fold(f64::INFINITY, f64::min)
}
