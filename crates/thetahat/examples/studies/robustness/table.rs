use thetahat::Method;

use super::{cells::Cell, twins::twin::Twin};

/// Largest error in deviations that an honest interval allows.
const WITHIN: f64 = 4.0;

/// A line of the table: a robot and a method.
pub fn robot_row(twin: &Twin, method: Method, cells: &[Cell], factors: &[f64]) -> String {
    let of_method: Vec<&Cell> = cells.iter().filter(|c| c.method == method).collect();
    let at = |factor: f64| {
        let here: Vec<&&Cell> = of_method.iter().filter(|c| c.factor == factor).collect();
        format!("{}/{}", here.iter().filter(|c| c.has_converged()).count(), here.len())
    };
    let converged: Vec<&Cell> = of_method.iter().copied().filter(|c| c.has_converged()).collect();
    let mut errors: Vec<f64> = converged.iter().filter_map(|c| Some(c.largest_error.as_ref()?.0)).collect();
    errors.sort_by(f64::total_cmp);
    let median = errors.get(errors.len() / 2).copied().unwrap_or(f64::NAN);
    let mean = |of: &dyn Fn(&Cell) -> f64| of_method.iter().map(|c| of(c)).sum::<f64>() / of_method.len() as f64;
    format!(
        "| {} | {} | {method} | {} | {}/{} | {median:.2} | {:.1} | {:.2} |",
        twin.name,
        twin.truth.len(),
        factors.iter().map(|f| at(*f)).collect::<Vec<_>>().join(", "),
        errors.iter().filter(|e| **e <= WITHIN).count(),
        converged.len(),
        mean(&|c| c.iterations as f64),
        mean(&|c| c.seconds),
    )
}

/// Shares over all robots.
pub fn totals(methods: &[Method], cells: &[Cell]) -> String {
    let mut out =
        "| method | converged | with the true controller | of those converged within 4 deviations |\n".to_owned();
    out += "| --- | --- | --- | --- |\n";
    for method in methods {
        let of_method: Vec<&Cell> = cells.iter().filter(|c| c.method == *method).collect();
        let converged: Vec<&Cell> = of_method.iter().copied().filter(|c| c.has_converged()).collect();
        let share = |part: usize, of: usize| format!("{part}/{of} = {:.1} %", 100.0 * part as f64 / of as f64);
        let is_true = |c: &&&Cell| c.factor == 1.0;
        let within = |c: &&&Cell| c.largest_error.as_ref().is_some_and(|(e, _)| *e <= WITHIN);
        out += &format!(
            "| {method} | {} | {} | {} |\n",
            share(converged.len(), of_method.len()),
            share(converged.iter().filter(is_true).count(), of_method.iter().filter(is_true).count()),
            share(converged.iter().filter(within).count(), converged.len()),
        );
    }
    out
}

/// Every cell that did not converge, with its reason, and every one whose largest error is beyond the limit.
pub fn failures(cells: &[Cell]) -> String {
    let mut out = String::new();
    for c in cells {
        let place = format!("{} {} x{} {} {}", c.robot, c.method, c.factor, c.start.name(), c.noise);
        let error = c.largest_error.as_ref().map(|(e, name)| format!("{e:.2} deviations at {name}"));
        let error = error.unwrap_or_default();
        if !c.has_converged() {
            out += &format!("- {place}: {:?}, {}; {error}\n", c.status, c.reason);
        } else if c.largest_error.as_ref().is_none_or(|(e, _)| *e > WITHIN) {
            out += &format!("- {place}: converged, {error}\n");
        }
    }
    out
}
