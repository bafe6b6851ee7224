//! Languages that nothing here runs, by their text; MATLAB by Octave where it is there.

use std::process::Command;

use libtest_mimic::Failed;
use thetahat::symbolic::Language;
use thetahat_symbolic::symbolic::Array;
use thetahat_testing::{Folder, ensure};

use super::{STATES, Sample, check_printed, is_there, output, samples};

pub fn matlab() -> Result<(), Failed> {
    let samples = samples("tx40.toml");
    for sample in &samples {
        let code = Language::Matlab.code(&sample.function, Some("robot"))?;
        let head = format!(" = robot_{}(q", sample.function.model.identifier());
        let first = code.lines().next().unwrap_or_default();
        ensure(first.starts_with("function ") && first.contains(&head), format!("{first:?} has no {head}"))?;
        let statements = code.lines().skip(1).filter(|line| !line.trim_start().starts_with('%'));
        let complete = |line: &str| line.ends_with(';') || line == "end";
        let broken = statements.clone().find(|line| !complete(line));
        ensure(broken.is_none(), format!("{broken:?} is no statement"))?;
        let operations = statements.filter(|line| line.contains(" .* ")).count();
        ensure(operations >= sample.function.program.count().multiplications, "products are missing")?;
    }
    if is_there("octave", &["--version"]) { by_octave(&samples) } else { Ok(()) }
}

fn by_octave(samples: &[Sample]) -> Result<(), Failed> {
    let (folder, mut program) = (Folder::new(), "format long\n".to_owned());
    for sample in samples {
        let name = format!("robot_{}", sample.function.model.identifier());
        let code = Language::Matlab.code(&sample.function, Some("robot"))?;
        let array = |of: &Array| format!("reshape({:?}, {STATES}, [])", sample.array(*of));
        let mut arguments: Vec<String> = sample.function.model.inputs().iter().map(array).collect();
        if code.lines().next().is_some_and(|line| line.contains("theta")) {
            arguments.push(format!("{:?}", sample.array(Array::Parameter)));
        }
        let order = if sample.function.shape[1] == 1 { "out'" } else { "permute(out, [2, 1, 3])" };
        program += &format!("out = {name}({}); printf('%.17g\\n', {order});\n", arguments.join(", "));
        folder.write(format!("{name}.m"), code);
    }
    folder.write("main.m", program);
    check_printed(samples, &output(Command::new("octave").current_dir(folder.path()).args(["--no-gui", "main.m"]))?)
}

pub fn latex() -> Result<(), Failed> {
    for sample in samples("tx40.toml").iter().chain(&samples(super::WITH_TERMS)) {
        let code = Language::Latex.code(&sample.function, None)?;
        let body: String = code.lines().filter(|line| !line.starts_with('%')).collect();
        let count = |text: &str| body.matches(text).count();
        ensure(count("{") == count("}"), "braces")?;
        ensure(count("\\left(") == count("\\right)"), "parentheses")?;
        ensure(count("\\begin{") == count("\\end{"), "environments")?;
        ensure(count(" &= ") == count("\\\\") + 1, "each equation is a row")?;
        ensure(body.is_ascii() && !body.contains("NaN"), "it is ASCII")?;
    }
    Ok(())
}

pub fn same_each_time() -> Result<(), Failed> {
    let [first, second] = [samples("tx40.toml"), samples("tx40.toml")];
    for (a, b) in first.iter().zip(&second) {
        for (_, language) in Language::ALL {
            ensure(language.code(&a.function, None)? == language.code(&b.function, None)?, "the code differs")?;
        }
    }
    Ok(())
}
