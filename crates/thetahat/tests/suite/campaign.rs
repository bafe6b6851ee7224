//! Campaigns: the same bytes for any number of threads and any order of commands, failures counted, bad files refused.

use std::{fs, path::Path};

use thetahat::{
    Experiment,
    campaign::{
        Bench, Campaign, CampaignError, CampaignRuns, Key, Store, Subset, parameter_summaries, quantiles, summarise,
    },
    identification::Status,
};
use thetahat_report::report;
use thetahat_testing::{Folder, project};

fn small() -> Campaign {
    Campaign::read(&project("campaigns/two_joint.toml")).unwrap()
}

/// The small campaign with one text replaced, and its experiment with another.
fn changed(campaign: (&str, &str), experiment: (&str, &str)) -> Result<Campaign, CampaignError> {
    let change = |file: &str, (from, to): (&str, &str)| {
        let text = fs::read_to_string(project(file)).unwrap();
        assert!(text.contains(from), "{file} holds no {from:?}");
        text.replacen(from, to, 1)
    };
    let text = change("campaigns/two_joint.toml", campaign);
    let experiment_text = change("experiments/two_joint.toml", experiment);
    let robot = fs::read_to_string(project("robots/two_joint.toml")).unwrap();
    let experiment = Experiment::from_texts(Path::new("experiment.toml"), experiment_text, robot)?;
    Campaign::from_text(Path::new("campaign.toml"), text, experiment)
}

fn run(campaign: &Campaign, limits: Subset, threads: usize, store: Option<&Store>) -> CampaignRuns {
    campaign.run(limits, threads, store, &mut |_| {}).unwrap()
}

#[test]
fn bytes_depend_neither_on_threads_nor_on_the_order_of_commands() {
    let folder = Folder::new();
    let campaign = small();
    let all = Subset::default();
    let store = |name: &str| Store::open(&folder.at(name), &campaign).unwrap();
    let one = run(&campaign, all, 1, Some(&store("one")));
    let two = run(&campaign, all, 2, Some(&store("two")));
    // 2 cases, 4 methods, 2 levels, 2 starts, 2 seeds.
    assert_eq!(one.rows.len(), 64);
    assert_eq!(folder.bytes("one/runs.parquet"), folder.bytes("two/runs.parquet"));
    assert_eq!(one.facts, two.facts);
    // First a part of it, then the rest.
    let part = run(&campaign, Subset { starts: Some(1), seeds: Some(1) }, 2, Some(&store("part")));
    assert_eq!(part.rows.len(), 16);
    let mut told = Vec::new();
    campaign.run(all, 2, Some(&store("part")), &mut |p| told.push(p)).unwrap();
    assert_eq!((told[0].before, told[0].to_do, told[told.len() - 1].done), (2, 6, 6));
    assert_eq!(folder.bytes("one/runs.parquet"), folder.bytes("part/runs.parquet"));
    // Nothing is left to do: the same rows are read back, times included.
    let again = run(&campaign, all, 1, Some(&store("one")));
    assert_eq!(again.rows, one.rows);
    assert_eq!(fs::read_dir(folder.at("one/parts")).unwrap().count(), 0);
    assert_eq!(run(&campaign, Subset { starts: Some(1), seeds: Some(1) }, 1, None).rows.len(), 16);
}

/// Records that were run elsewhere, in parts of any size and name, are the store's own.
#[test]
fn parts_made_elsewhere_are_those_of_the_store() {
    let folder = Folder::new();
    let campaign = small();
    let all = Subset::default();
    let store = |name: &str| Store::open(&folder.at(name), &campaign).unwrap();
    run(&campaign, all, 1, Some(&store("here")));
    let bench = Bench::new(&campaign, all).unwrap();
    let keys = campaign.keys(all);
    let parts = store("parts");
    assert_eq!(campaign.missing(&bench, all, &parts).unwrap(), keys);
    for (name, part) in [("a", &keys[5..8]), ("b", &keys[..1]), ("c", &keys[1..5])] {
        fs::write(folder.at(format!("parts/parts/{name}.parquet")), bench.part(part).unwrap()).unwrap();
    }
    assert!(campaign.missing(&bench, all, &parts).unwrap().is_empty());
    assert_eq!(run(&campaign, all, 1, Some(&parts)).rows.len(), 64);
    assert_eq!(folder.bytes("here/runs.parquet"), folder.bytes("parts/runs.parquet"));
    for beyond in [Key { level: 2, ..keys[0] }, Key { start: 2, ..keys[0] }, Key { seed: 2, ..keys[0] }] {
        assert!(matches!(bench.part(&[keys[0], beyond]), Err(CampaignError::NoRecording { key, .. }) if key == beyond));
    }
}

#[test]
fn methods_find_the_truth_and_a_wrong_simulator_leads_didim_astray() {
    let runs = run(&small(), Subset::default(), 2, None);
    // The wrong simulator may keep DIDIM from converging; where nothing is wrong, all do.
    let failed = |r: &&thetahat::campaign::Row| r.case == "nominal" && !r.has_converged();
    assert_eq!(runs.rows.iter().find(failed), None);
    let median = |case: &str, method: &str| {
        let fits =
            |s: &thetahat_report::results::MethodSummary| s.case == case && s.method == method && s.noise == "low";
        summarise(&runs).into_iter().find(fits).unwrap().distance_percent.unwrap().median
    };
    for method in ["idim-ls", "idim-wls", "idim-iv", "didim"] {
        assert!(median("nominal", method) < 5.0, "{method}: {} %", median("nominal", method));
    }
    assert!(median("gear_ratio_0.9", "didim") > 5.0 * median("nominal", "didim"));
    assert!(median("gear_ratio_0.9", "idim-iv") < 2.0 * median("nominal", "idim-iv"));
    // LS does not depend on the simulator; each start has its own noise.
    assert_eq!(median("gear_ratio_0.9", "idim-ls"), median("nominal", "idim-ls"));
    let ls = |start: u32| runs.rows.iter().find(|r| r.method == "idim-ls" && r.start == start).unwrap();
    assert_ne!(ls(1).estimates, ls(2).estimates);
    let of_iv = parameter_summaries(&runs, "nominal", "low", "idim-iv");
    assert_eq!(of_iv.len(), runs.facts.parameters.len());
    assert!(of_iv.iter().all(|p| p.count == 4));
}

#[test]
fn failures_are_counted_and_in_no_figure() {
    let limit = ("[simulation]", "[estimation.convergence]\niterations = 1\n[simulation]");
    let campaign = changed(("", ""), limit).unwrap();
    let runs = run(&campaign, Subset::default(), 2, None);
    for summary in summarise(&runs) {
        let iterates = ["idim-iv", "didim"].contains(&summary.method.as_str());
        assert_eq!(summary.runs, 4);
        assert_eq!(summary.converged, if iterates { 0 } else { 4 });
        assert_eq!(summary.distance_percent.is_none(), iterates);
        assert_eq!(summary.bias.is_none() && summary.seconds.is_none(), iterates);
        let failures = if iterates { vec![("stalled".to_owned(), 4)] } else { Vec::new() };
        assert_eq!(summary.failures, failures);
    }
    let failed = runs.rows.iter().find(|r| r.status == Status::Stalled).unwrap();
    assert!(failed.reason.as_ref().unwrap().contains("1 iterations"));
    let text = report::campaign_text(&campaign.results(&runs), report::TextWidth::DEFAULT);
    assert!(text.contains("0/4") && text.contains("didim: 4 stalled"), "{text}");
}

#[test]
fn the_report_fits_the_terminal_and_the_page_needs_nothing_else() {
    let folder = Folder::new();
    let claim = ("[[noise]]", "[[claim]]\nsource = 'A <b>book</b>'\nsays = 'IV wins.'\n[[noise]]");
    let campaign = changed(claim, ("", "")).unwrap();
    let runs = run(&campaign, Subset::default(), 2, None);
    let text = report::campaign_text(&campaign.results(&runs), report::TextWidth::DEFAULT);
    assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
    assert!(text.contains("IV wins. (A <b>book</b>)"));
    let page = fs::read_to_string(report::write_campaign(&campaign.results(&runs), folder.path()).unwrap()).unwrap();
    assert!(page.contains("class=\"box didim\"") && page.contains("&lt;b&gt;book"), "no boxes or not escaped");
    assert!(!page.contains("src=") && !page.contains("href=\"http"), "refers to something else");
}

#[test]
fn quantiles_interpolate_between_the_order_statistics() {
    let five = quantiles([4.0, 1.0, 3.0, 2.0, f64::NAN]).unwrap();
    assert_eq!([five.smallest, five.lower, five.median, five.upper, five.largest], [1.0, 1.75, 2.5, 3.25, 4.0]);
    assert_eq!(quantiles([]), None);
}

#[test]
fn defects_of_a_campaign_name_the_place() {
    let keep = ("", "");
    let refused = |campaign, experiment| changed(campaign, experiment).unwrap_err().to_string();
    for (from, to, words) in [
        ("seeds = 2", "seed_count = 2", &["line 5", "`seed_count`"][..]),
        ("seeds = 2", "seeds = 0", &["seeds is 0", "from 1"]),
        ("methods = [\"idim-ls\", \"idim-wls\", \"idim-iv\", \"didim\"]", "methods = []", &["methods is empty"]),
        ("\"idim-wls\"", "\"wls\"", &["line 4", "idim-wls"]),
        ("\"idim-wls\"", "\"idim-ls\"", &["methods", "idim-ls, twice"]),
        ("seeds = 2", "seeds = 2\ncases = [\"biased\"]", &["cases is biased", "nominal, gear_ratio_0.9"]),
        ("name = \"high\"", "name = \"low\"", &["[[noise]] name is low, twice"]),
        ("[1e-2, 2e-2]", "[1e-2]", &["[[noise]] high: position_noise", "list of 1", "list of 2"]),
        ("torque_noise = 0.05", "torque_noise = -0.05", &["torque_noise is -0.05", "not below zero"]),
        ("relative_deviation = 0.1", "relative_deviation = 0.0", &["relative_deviation is 0", "the same"]),
        ("[starts]", "[a_priori]\nzz7 = 1\n[starts]", &["[a_priori] zz7"]),
    ] {
        let message = refused((from, to), keep);
        assert!(message.starts_with("campaign.toml: "), "{message}");
        words.iter().for_each(|word| assert!(message.contains(word), "no {word:?} in: {message}"));
    }
    let recorded = "[recording]\nsample_rate_hz = 500\nposition = { file = 'a.csv', columns = ['q'], unit = 'deg' }\n\
                    torque = { file = 'a.csv', columns = ['t'], unit = 'N m' }\n";
    let text = fs::read_to_string(project("experiments/two_joint.toml")).unwrap();
    let (twin, signal) = (text.find("[twin]").unwrap(), text.find("[signal]").unwrap());
    let message = refused(keep, (&text[twin..signal], recorded));
    assert!(message.contains("[twin] is missing"), "{message}");
    let message = refused(keep, ("[controller]", "[parameters]\nestimate = \"essential\"\n[controller]"));
    assert!(message.contains("essential"), "{message}");
}

#[test]
fn starts_that_cannot_be_physical_are_an_error_that_names_the_link() {
    let campaign = changed(("[starts]", "[a_priori]\nxx2 = 1\n[starts]"), ("", "")).unwrap();
    let error = campaign.run(Subset::default(), 1, None, &mut |_| {}).unwrap_err();
    assert!(matches!(error, CampaignError::NoPhysicalStart { .. }));
    assert!(error.to_string().contains("They are not physical themselves: link 2"), "{error}");
}

#[test]
fn a_folder_is_that_of_one_campaign() {
    let folder = Folder::new();
    let campaign = small();
    Store::open(folder.path(), &campaign).unwrap();
    Store::open(folder.path(), &campaign).unwrap();
    let other = Campaign { text: campaign.text.replace("seeds = 2", "seeds = 3"), ..campaign.clone() };
    let error = Store::open(folder.path(), &other).unwrap_err();
    assert!(
        matches!(&error, CampaignError::OtherCampaign { changed, .. } if changed == "the campaign file"),
        "{error}"
    );
    let store = Store::open(folder.path(), &campaign).unwrap();
    fs::write(folder.at("parts/01-00001-00001.parquet"), b"PAR1 and no more").unwrap();
    let error = campaign.run(Subset::default(), 1, Some(&store), &mut |_| {}).unwrap_err();
    assert!(
        matches!(&error, CampaignError::Damaged { path, .. } if path.ends_with("01-00001-00001.parquet")),
        "{error}"
    );
}

/// The small campaign, whose twin follows `motion.csv` of a folder.
fn following(folder: &Folder) -> Campaign {
    let small = small();
    let text = &small.experiment.text;
    let points = text.lines().find(|line| line.starts_with("points")).unwrap();
    let reference = "reference = { file = 'motion.csv', columns = ['a', 'b'], unit = 'rad' }";
    let experiment = text.replace(points, reference);
    let experiment =
        Experiment::from_texts(&folder.at("followed.toml"), experiment, small.experiment.robot_text).unwrap();
    Campaign::from_text(Path::new("campaign.toml"), small.text, experiment).unwrap()
}

/// All three texts are the same, and the motion is in none of them.
#[test]
fn a_folder_is_that_of_one_followed_motion() {
    let folder = Folder::new();
    let motion = |end: f64| format!("a,b\n0,0\n{end},0.1\n");
    folder.write("motion.csv", motion(0.2));
    let (campaign, out) = (following(&folder), folder.at("out"));
    Store::open(&out, &campaign).unwrap();
    Store::open(&out, &campaign).unwrap();
    folder.write("motion.csv", motion(0.3));
    let error = Store::open(&out, &following(&folder)).unwrap_err();
    let expected =
        "holds runs of another campaign: the file of [twin] reference is not what it was when they were made";
    assert!(error.to_string().contains(expected), "{error}");
    fs::remove_file(folder.at("motion.csv")).unwrap();
    let error = Store::open(&out, &campaign).unwrap_err();
    assert!(error.to_string().contains("motion.csv: "), "{error}");
}

#[test]
fn the_campaigns_of_the_project_can_be_read() {
    let birdy = Campaign::read(&project("campaigns/birdy.toml")).unwrap();
    assert_eq!((birdy.file.starts.count, birdy.file.seeds, birdy.file.noise.len()), (25, 52, 5));
}
