//! Studies and tables of the documentation in one program, which links the library once:
//! `cargo run --release -p thetahat --example studies -- NAME [ARGUMENTS]`. Each study says in its first lines what it prints.

mod arrays;
mod benchmark;
mod biased_simulator_power;
mod closed_loop_study;
mod consistent_coverage;
// Shared with the trials, which use other parts of it.
#[allow(dead_code)]
#[path = "../../tests/trials/corruption_suite/mod.rs"]
mod corruption_suite;
mod corruption_table;
mod coverage;
mod defect_table;
mod exports;
mod filter_study;
mod forward_error;
mod gallery;
mod generated_times;
mod long_chain;
mod long_recording;
mod operation_counts;
mod paper_study;
mod reference_study;
mod robustness;
mod simulator_study;
mod stiff_friction;
mod twins;
mod verdict_table;

use std::error::Error;

/// A study by its name.
type Study = (&'static str, fn() -> Result<(), Box<dyn Error>>);

const STUDIES: [Study; 22] = [
    ("arrays", arrays::main),
    ("benchmark", benchmark::main),
    ("biased_simulator_power", biased_simulator_power::main),
    ("closed_loop_study", closed_loop_study::main),
    ("consistent_coverage", consistent_coverage::main),
    ("corruption_table", || {
        corruption_table::main();
        Ok(())
    }),
    ("coverage", coverage::main),
    ("defect_table", || {
        defect_table::main();
        Ok(())
    }),
    ("exports", exports::main),
    ("filter_study", filter_study::main),
    ("forward_error", forward_error::main),
    ("gallery", gallery::main),
    ("generated_times", generated_times::main),
    ("long_chain", long_chain::main),
    ("long_recording", long_recording::main),
    ("operation_counts", || {
        operation_counts::main();
        Ok(())
    }),
    ("paper_study", paper_study::main),
    ("reference_study", reference_study::main),
    ("robustness", robustness::main),
    ("simulator_study", simulator_study::main),
    ("stiff_friction", stiff_friction::main),
    ("verdict_table", verdict_table::main),
];

/// The arguments after the name of the study.
fn arguments() -> impl Iterator<Item = String> {
    std::env::args().skip(2)
}

fn main() -> Result<(), Box<dyn Error>> {
    let name = std::env::args().nth(1).unwrap_or_default();
    let names = || STUDIES.map(|(name, _)| name).join(", ");
    let (_, study) =
        STUDIES.iter().find(|(known, _)| *known == name).ok_or_else(|| format!("name a study: {}", names()))?;
    study()
}
