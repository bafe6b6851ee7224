//! The filter that is chosen from a record comes near the best of a wide grid: two rows of the table of `docs/filter_choice.md`,
//! and the recorded robots, each as `init` proposes it.

#[path = "../examples/filter_study/case.rs"]
mod case;
#[expect(dead_code, reason = "the rest of the twins is for the robustness table")]
#[path = "../examples/twins/mod.rs"]
mod twins;

use case::Case;
use twins::robots::robots;

#[test]
fn the_chosen_filter_is_near_the_best() {
    for (number, robot) in [(7, "two_joint"), (19, "SCARA")] {
        let subject = robots(robot, None).unwrap().remove(0);
        let outcome = Case::draw(number).run(subject, false).unwrap();
        assert!(outcome.ratio < 1.25, "{}", outcome.row);
    }
}
