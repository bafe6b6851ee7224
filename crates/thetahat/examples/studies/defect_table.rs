//! Prints the table of `docs/evidence/checks.md` of what becomes of each kind of defect in each robot. The recordings are looked for as
//! the tests do (`THETAHAT_SHARED`).
//!
//! ```sh
//! cargo run --release -p thetahat --example studies -- defect_table
//! ```

use super::corruption_suite::{
    defects::{Outcome, defects},
    pairs::{Pair, pair_defects},
    record::Record,
    robots::Specimen,
    table::markdown,
};

/// Runs the study.
pub fn main() {
    let records: Vec<Record> = Specimen::ALL.into_iter().map(Specimen::record).collect();
    let of_one = defects().into_iter().map(|defect| {
        let cell = |record: &Record| {
            let mut spoiled = record.clone();
            (defect.apply)(&mut spoiled);
            Outcome::of(&spoiled.findings(), defect.codes).cell()
        };
        [vec![defect.name.to_owned()], records.iter().map(cell).collect()].concat()
    });
    let of_two = pair_defects().into_iter().map(|defect| {
        let cell = |record: &Record| {
            let mut pair = Pair::halves(record);
            (defect.apply)(&mut pair);
            Outcome::of(&pair.findings(), &[defect.code]).cell()
        };
        [vec![defect.name.to_owned()], records.iter().map(cell).collect()].concat()
    });
    let rows: Vec<Vec<String>> = of_one.chain(of_two).collect();
    let head: Vec<&str> = std::iter::once("defect").chain(Specimen::ALL.map(Specimen::name)).collect();
    print!("{}", markdown(&head, &rows));
}
