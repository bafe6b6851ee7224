//! The same by rustc: each function as a module that takes nothing from the standard library.

use std::process::Command;

use libtest_mimic::Failed;
use thetahat::symbolic::Language;
use thetahat_symbolic::symbolic::Array;
use thetahat_testing::Folder;

use super::{STATES, Sample, check_printed, output, samples};

pub fn run(file: &str) -> Result<(), Failed> {
    let (samples, folder) = (samples(file), Folder::new());
    let (mut modules, mut calls) = (String::new(), String::new());
    for sample in &samples {
        let code = Language::Rust.code(&sample.function, Some("robot"))?;
        let model = sample.function.model.identifier();
        modules += &format!("mod {model};\n");
        calls += &call(sample, code.contains("_prepare("));
        // Alone without the standard library, and with it in a program that runs.
        let alone = format!("{model}_alone.rs");
        // Functions beside sine and cosine are those of the standard library, and the head says so.
        let no_std = if code.contains("functions of the standard library") { "" } else { "#![no_std]\n" };
        folder.write(&alone, format!("{no_std}{code}"));
        let flags = ["--edition", "2021", "--crate-type", "lib", "--emit", "metadata", "-D", "warnings"];
        output(Command::new("rustc").current_dir(folder.path()).args(flags).arg(&alone))?;
        folder.write(format!("{model}.rs"), code);
    }
    folder.write("main.rs", format!("#![allow(unused)]\n{modules}\nfn main() {{\n{calls}}}\n"));
    output(Command::new("rustc").current_dir(folder.path()).args(["--edition", "2021", "main.rs", "-o", "main"]))?;
    check_printed(&samples, &output(&mut Command::new(folder.at("main")))?)
}

fn call(sample: &Sample, takes_parameters: bool) -> String {
    let (inputs, model) = (sample.function.model.inputs(), sample.function.model.identifier());
    let [rows, columns] = sample.function.shape;
    let (n, entries) = (sample.function.coordinates.len(), rows * columns);
    let mut text = "    {\n".to_owned();
    for (i, array) in inputs.iter().enumerate() {
        text += &format!("        let a{i} = {:?};\n", sample.array(*array));
        text += &format!(
            "        let s{i} = |k: usize| -> [f64; {n}] {{ std::array::from_fn(|j| a{i}[j * {STATES} + k]) }};\n"
        );
    }
    if takes_parameters {
        text += &format!(
            "        let constants = {model}::robot_{model}_prepare(&{:?});\n",
            sample.array(Array::Parameter)
        );
    }
    let constants = if takes_parameters { ", &constants" } else { "" };
    let (singles, all): (String, String) = (
        (0..inputs.len()).map(|i| format!(", &s{i}(k)")).collect(),
        (0..inputs.len()).map(|i| format!(", &a{i}")).collect(),
    );
    text += &format!("        let mut all = vec![0.0; {}];\n", entries * STATES);
    text += &format!("        {model}::robot_{model}_batch(f64::sin_cos, {STATES}{all}{constants}, &mut all);\n");
    text += &format!(
        "        for k in 0..{STATES} {{\n            let one = {model}::robot_{model}(f64::sin_cos{singles}{constants});\n"
    );
    text += "            for (j, entry) in one.iter().enumerate() {\n                println!(\"{entry:?}\");\n";
    text + &format!(
        "                assert!(entry.to_bits() == all[j * {STATES} + k].to_bits() || entry.is_nan());\n            }}\n        }}\n    }}\n"
    )
}
