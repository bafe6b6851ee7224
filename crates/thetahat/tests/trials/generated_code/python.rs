//! The same by Python with NumPy, all states at once.

use std::process::Command;

use libtest_mimic::Failed;
use thetahat::symbolic::Language;
use thetahat_symbolic::symbolic::Array;
use thetahat_testing::Folder;

use super::{STATES, Sample, check_printed, is_there, output, samples};

/// Names of interpreters; `THETAHAT_PYTHON` comes first.
pub fn interpreter() -> Option<String> {
    let asked = std::env::var("THETAHAT_PYTHON").ok();
    let names = asked.into_iter().chain(["python3".to_owned(), "python".to_owned()]);
    names.into_iter().find(|name| is_there(name, &["-c", "import numpy"]))
}

pub fn run(file: &str) -> Result<(), Failed> {
    let (samples, folder) = (samples(file), Folder::new());
    let mut program = "import numpy as np\n".to_owned();
    for sample in &samples {
        let code = Language::Python.code(&sample.function, Some("robot"))?;
        let model = sample.function.model.identifier();
        program += &format!("import {model}\n");
        program += &call(sample, model, code.contains(", theta):"));
        folder.write(format!("{model}.py"), code);
    }
    folder.write("main.py", program);
    let interpreter = interpreter().ok_or("no Python with NumPy")?;
    let mut command = Command::new(interpreter);
    check_printed(&samples, &output(command.current_dir(folder.path()).args(["-W", "error", "main.py"]))?)
}

fn call(sample: &Sample, model: &str, takes_parameters: bool) -> String {
    let array = |of: &Array| format!("np.array({:?}).reshape(-1, {STATES}).T", sample.array(*of));
    let mut arguments: Vec<String> = sample.function.model.inputs().iter().map(array).collect();
    if takes_parameters {
        arguments.push(format!("{:?}", sample.array(Array::Parameter)));
    }
    format!(
        "with np.errstate(all=\"ignore\"):\n    out = {model}.robot_{model}({})\n\
         assert out.shape[0] == {STATES}\nprint(\"\\n\".join(repr(float(v)) for v in out.ravel()))\n",
        arguments.join(", ")
    )
}
