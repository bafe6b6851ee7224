//! The table of operations in `docs/manual/generated_code.md`: `cargo run --release -p thetahat --example studies -- operation_counts`.

#[path = "../../tests/suite/operation_counts/counted.rs"]
mod counted;

use self::counted::{MODELS, ROBOTS, count};

/// What others take, by robot and model: OpenSYMORO, and CasADi with common subexpressions shared.
const PEERS: [(&str, &str, &str, &str); 9] = [
    ("tx40", "idm", "296/235", "404/318"),
    ("tx40", "mass-matrix", "229/151", "154/140"),
    ("tx40", "ddm", "905/664", ""),
    ("tx40", "regressor", "613/366", "817/530"),
    ("lwr4", "idm", "343/271", ""),
    ("lwr4", "mass-matrix", "269/181", ""),
    ("lwr4", "regressor", "801/456", ""),
    ("rx90", "idm", "287/226", ""),
    ("puma_560", "idm", "301/240", ""),
];

/// Runs the study.
pub fn main() {
    println!("| robot | model | thetahat | OpenSYMORO | CasADi with cse |\n| --- | --- | --- | --- | --- |");
    for (robot, file) in ROBOTS {
        for (name, model) in MODELS {
            let count = count(file, model);
            let divisions = if count.divisions > 0 { format!(" + {} div", count.divisions) } else { String::new() };
            let peers = PEERS.iter().find(|(r, m, ..)| (*r, *m) == (robot, name));
            let (symoro, casadi) = peers.map_or(("", ""), |(_, _, symoro, casadi)| (symoro, casadi));
            let own = format!("{}/{}{divisions}", count.multiplications, count.additions);
            println!("| {robot} | {name} | {own} | {symoro} | {casadi} |");
        }
    }
}
