//! A C program that calls each function with single states and with all of them, and prints what it gives.

use std::fmt::Write;
use std::process::Command;

use libtest_mimic::Failed;
use thetahat::symbolic::Language;
use thetahat_symbolic::symbolic::Array;
use thetahat_testing::{Folder, ensure};

use super::{STATES, Sample, WITH_TERMS, check_printed, output, samples};

const FLAGS: [&str; 6] = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-O1"];

pub fn run(file: &str) -> Result<(), Failed> {
    let (samples, folder) = (samples(file), Folder::new());
    let mut program = "#include <stdio.h>\n#include <string.h>\n".to_owned();
    let mut calls = String::new();
    for sample in &samples {
        let (code, name) = (Language::C.code(&sample.function, Some("robot"))?, name(sample));
        writeln!(program, "#include \"{name}.h\"")?;
        calls += &call(sample, &name, code.contains("_prepare("));
        folder.write(format!("{name}.h"), code);
    }
    folder.write("main.c", format!("{program}int main(void) {{\n{calls}    return 0;\n}}\n"));
    output(Command::new("cc").current_dir(folder.path()).args(FLAGS).args(["main.c", "-o", "main", "-lm"]))?;
    let single = ["-DTHETAHAT_REAL=float", "-Dmain=unused", "-fsyntax-only", "main.c"];
    output(Command::new("cc").current_dir(folder.path()).args(FLAGS).args(single))?;
    check_printed(&samples, &output(&mut Command::new(folder.at("main")))?)?;
    // With its own sines it needs no library, unless torque terms take other functions.
    let own = ["-DTHETAHAT_OWN_SINES", "-O0", "main.c", "-o", "own"];
    let library = (file == WITH_TERMS).then_some("-lm");
    output(Command::new("cc").current_dir(folder.path()).args(FLAGS).args(own).args(library))?;
    check_printed(&samples, &output(&mut Command::new(folder.at("own")))?)
}

/// The header's own sines at angles up to a million, in units of the last place of those of long double.
const SINES: &str = r#"
#include <math.h>
#include <stdio.h>
static double units(const double found, const long double right) {
    const double ulp = nextafter(fabs((double)right), INFINITY) - fabs((double)right);
    return (double)(fabsl(found - right) / ulp);
}
int main(void) {
    double worst = 0.0;
    for (int k = -1000000; k <= 1000000; k++) {
        const double x[2] = {k + 0.37 * sin(k), 1e-5 * k};
        for (int i = 0; i < 2; i++) {
            double s, c;
            thetahat_sincos(x[i], &s, &c);
            worst = fmax(worst, fmax(units(s, sinl(x[i])), units(c, cosl(x[i]))));
        }
    }
    printf("%.3f\n", worst);
    return 0;
}
"#;

pub fn own_sines() -> Result<(), Failed> {
    let (samples, folder) = (samples("two_joint.toml"), Folder::new());
    folder.write("model.h", Language::C.code(&samples[0].function, Some("robot"))?);
    folder.write("sines.c", format!("#include \"model.h\"\n{SINES}"));
    let arguments = ["-DTHETAHAT_OWN_SINES", "sines.c", "-o", "sines", "-lm"];
    output(Command::new("cc").current_dir(folder.path()).args(FLAGS).args(arguments))?;
    let worst: f64 = output(&mut Command::new(folder.at("sines")))?.trim().parse()?;
    ensure(worst <= 2.0, format!("{worst} units of the last place"))
}

fn name(sample: &Sample) -> String {
    format!("robot_{}", sample.function.model.identifier())
}

fn listed(name: &str, values: &[f64]) -> String {
    let values: Vec<String> = values.iter().map(|value| format!("(THETAHAT_REAL){value:?}")).collect();
    format!("        static const THETAHAT_REAL {name}[] = {{{}}};\n", values.join(", "))
}

/// Single calls print; a call of all states together must give the same bits.
fn call(sample: &Sample, name: &str, takes_parameters: bool) -> String {
    let inputs = sample.function.model.inputs();
    let [rows, columns] = sample.function.shape;
    let (n, entries) = (sample.function.coordinates.len(), rows * columns);
    let mut text = "    {\n".to_owned();
    let names: Vec<String> = (0..inputs.len()).map(|i| format!("a{i}")).collect();
    for (name, array) in names.iter().zip(inputs) {
        text += &listed(name, sample.array(*array));
    }
    let mut arguments = names.clone();
    if takes_parameters {
        text += &listed("theta", sample.array(Array::Parameter));
        text += &format!("        static THETAHAT_REAL constants[{}_CONSTANTS];\n", name.to_uppercase());
        text += &format!("        {name}_prepare(theta, constants);\n");
        arguments.push("constants".to_owned());
    }
    text += &format!("        static THETAHAT_REAL all[{}], one[{entries}];\n", entries * STATES);
    text += &format!("        {name}_batch({STATES}, {}, all);\n", arguments.join(", "));
    text += &format!(
        "        for (int k = 0; k < {STATES}; k++) {{\n            THETAHAT_REAL b[{}][{n}];\n",
        inputs.len()
    );
    for (i, name) in names.iter().enumerate() {
        text += &format!("            for (int j = 0; j < {n}; j++) b[{i}][j] = {name}[j * {STATES} + k];\n");
    }
    let mut singles: Vec<String> = (0..inputs.len()).map(|i| format!("b[{i}]")).collect();
    singles.extend(arguments[inputs.len()..].iter().cloned());
    text += &format!("            {name}({}, one);\n", singles.join(", "));
    text += &format!("            for (int j = 0; j < {entries}; j++) {{\n");
    text += "                printf(\"%.17g\\n\", (double)one[j]);\n";
    text + &format!(
        "                if (memcmp(&one[j], &all[j * {STATES} + k], sizeof(one[j])) != 0 && one[j] == one[j]) {{\n                    \
         fprintf(stderr, \"{name}: the batch differs\\n\");\n                    return 1;\n                }}\n            }}\n        }}\n    }}\n"
    )
}
