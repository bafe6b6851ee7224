//! The thetahat command line.
use std::path::Path;
use thetahat::experiment::Experiment;
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let e = if args[1] == "demo" {
        Experiment::demo().unwrap()
    } else {
        match Experiment::read(Path::new(&args[1])) {
            Ok(e) => e,
            Err(e) => {
                println!("{e}");
                return;
            }
        }
    };
    let t = std::time::Instant::now();
    let r = match e
        .run(Path::new(args.get(2).map_or("", |s| s)), &mut |s| eprintln!("{:.3} {s}", t.elapsed().as_secs_f64()))
    {
        Ok(e) => e,
        Err(e) => {
            println!("{e}");
            return;
        }
    };
    eprintln!("{:.3}", t.elapsed().as_secs_f64());
    println!("{:?} rows {} {:?} {:?}", r.window_s, r.decimated_rows, r.bandwidth, r.reference);
    if let Ok(p) = std::env::var("DUMP") {
        let run = &r.runs[p.parse::<usize>().unwrap()];
        for k in 0..r.plots.time_s.len() {
            print!("{:.3}", r.plots.time_s[k]);
            for j in 0..r.plots.measured.len() {
                print!(" {:.3} {:.3}", r.plots.measured[j][k], r.plots.measured[j][k] - run.plots.predicted[j][k]);
            }
            println!();
        }
        return;
    }
    for run in &r.runs {
        println!(
            "\n== {} {} {:?} {:?} it {} sims {} err {:?} cv {:?} cond {:?} vcond {:?} s {:.3}\n {:?}\n {:?}\n {:?} ftest {:?}",
            run.case,
            run.method.name(),
            run.status,
            run.reason,
            run.iterations,
            run.simulations,
            run.relative_error_percent,
            run.cross_validation_relative_error_percent,
            run.condition_number,
            run.validation_condition_number,
            run.seconds,
            run.joint_relative_error_percent,
            run.simulation_relative_error_percent,
            run.validation_simulation_relative_error_percent,
            run.f_test
        );
        for c in &run.convergence {
            println!("   {:.4} {:?} {:?}", c.relative_error_percent, c.parameter_change, c.error_change);
        }
        for p in run.parameters.iter().filter(|p| p.shown) {
            println!(
                "   {:6} {:10.4} {:10.5} {:8.2}% {:?} z={:?}",
                p.name,
                p.estimate,
                p.standard_deviation.unwrap(),
                p.relative_standard_deviation_percent.unwrap_or(0.0),
                p.true_value,
                p.true_value.map(|t| (p.estimate - t) / p.standard_deviation.unwrap())
            );
        }
    }
}
