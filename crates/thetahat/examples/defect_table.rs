//! Prints the table of `docs/checks.md` of what becomes of each kind of defect in each robot, and the margins of the clean
//! records. The recordings are looked for as the tests do (`THETAHAT_SHARED`).
//!
//! ```sh
//! cargo run --release -p thetahat --example defect_table
//! ```

#[path = "../tests/corruption_suite/mod.rs"]
mod corruption_suite;

use corruption_suite::{
    defects::{Outcome, defects},
    pairs::{Pair, pair_defects},
    robots::Specimen,
};

fn main() {
    let detail = std::env::args().nth(1);
    for specimen in Specimen::ALL {
        let record = specimen.record();
        println!("== {}", specimen.name());
        let show = |findings: Vec<thetahat::checks::Finding>| {
            for f in findings.iter().filter(|f| f.severity < thetahat::checks::Severity::Note) {
                println!("        {} [{}] {:?} {}", f.severity, f.code, f.joint, f.message);
            }
        };
        show(record.findings());
        println!("   halves {:?}", Pair::halves(&record).measures());
        for defect in defects() {
            if detail.as_ref().is_some_and(|d| !defect.name.contains(d)) { continue; }
            let mut spoiled = record.clone();
            (defect.apply)(&mut spoiled);
            let findings = spoiled.findings();
            println!("   {}: {}", defect.name, Outcome::of(&findings, defect.codes).cell());
            show(findings);
            if let Some(d) = &detail { if defect.name.contains(d) { println!("     {:?}", spoiled.with_subject(thetahat::checks::measure).iter().filter(|m| defect.codes.contains(&m.code)).map(|m| (m.code, m.joint, m.value)).collect::<Vec<_>>()); } }
        }
        for defect in pair_defects() {
            let mut pair = Pair::halves(&record);
            (defect.apply)(&mut pair);
            println!("   {}: {} {:?}", defect.name, Outcome::of(&pair.findings(), &[defect.code]).cell(), pair.measures());
            show(pair.findings());
        }
    }
}
