//! The filter that is chosen from a record comes near the best of a wide grid: three rows of the table of `docs/evidence/filter_choice.md`,
//! and the recorded robots, each as `init` proposes it.

#[path = "../../examples/studies/filter_study/case.rs"]
mod case;
use super::twins;

use case::Case;
use twins::robots::robots;

#[test]
#[ignore = "long, each night"]
fn the_chosen_filter_is_near_the_best() {
    let run = |(number, robot)| {
        let outcome = Case::draw(number).run(robots(robot, None).unwrap().remove(0), false).unwrap();
        println!("{}", outcome.row);
        outcome.ratio
    };
    let ratios = [(7, "two_joint"), (14, "two_joint"), (19, "SCARA")].map(run);
    assert!(ratios.iter().all(|ratio| *ratio < 2.0), "{ratios:?}");
    assert!(ratios.iter().filter(|ratio| **ratio < 1.25).count() >= 2, "{ratios:?}");
}
