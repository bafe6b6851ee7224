//! Shapes that stay apart.

use thetahat::design::DesignError;

use super::support::{DESIGN, key_of, parse};

/// Capsules of the arm, whose joints are 0.4 m apart or so, and a wall beside it.
pub const COLLISION: &str = "[collision]\nmargin = 20\ncapsules = [{ link = 'shoulder', from = [0, 0, 0], to = [300, 0, 0], radius = 40 },\n\
    { link = 'elbow', from = [0, 0, 0], to = [300, 0, 0], radius = 30 }]\n\
    obstacles = [{ kind = 'plane', name = 'wall', point = [250, 0, 0], normal = [-1, 0, 0] }]\n";

fn with_collision(from: &str, to: &str) -> String {
    assert!(COLLISION.contains(from), "{from}");
    DESIGN.replace("[noise]", &format!("{}\n[noise]", COLLISION.replace(from, to)))
}

/// No sample at 1 kHz is nearer to the wall than the margin, by another way than the design's: points of the segments that
/// are tried.
#[test]
fn shapes_stay_apart() {
    let design = parse(&with_collision("[250, 0, 0]", "[420, 0, 0]")).unwrap();
    let results = design.run(2).unwrap();
    let collision = results.collision.as_ref().unwrap();
    assert!(collision.pairs.iter().all(|pair| pair.distance >= 0.02), "{collision:?}");
    assert!(collision.pairs[0].distance < 0.03, "{collision:?}");
    assert!(!collision.has_way && collision.uncovered.is_empty());
    let least = collision.least.iter().map(|[_, distance]| *distance).fold(f64::INFINITY, f64::min);
    assert!(collision.least.len() == 4001 && least == collision.pairs[0].distance, "{least}");
    assert_eq!(design.run(1).unwrap().q, results.q);
}

#[test]
fn shapes_that_cannot_be_used_are_named() {
    let key = |from: &str, to: &str| match parse(&with_collision(from, to)) {
        Err(error) => key_of(*error),
        Ok(_) => panic!("{to} is taken"),
    };
    assert_eq!(key("margin = 20", "margin = -1"), "[collision] margin");
    assert_eq!(key("margin = 20", "margin = 20\nhome = [0]"), "[collision] home");
    assert_eq!(key("margin = 20", "margin = 20\nignore = [['shoulder', 'floor']]"), "[collision] ignore");
    assert_eq!(key("link = 'elbow'", "link = 'hand'"), "[collision] capsules, the 2. link");
    assert_eq!(key("radius = 30", "radius = 0"), "[collision] capsules, the 2. radius");
    assert_eq!(key("normal = [-1, 0, 0]", "normal = [0, 0, 0]"), "[collision] obstacles, the 1. normal");
    let error = parse(&with_collision("kind = 'plane'", "kind = 'ball'")).unwrap_err();
    assert!(error.to_string().contains("ball"), "{error}");
}

/// A home behind the wall: the way from it is looked at too.
#[test]
fn the_way_from_home_is_covered() {
    let text = with_collision("[250, 0, 0]", "[420, 0, 0]");
    let design = parse(&text.replace("margin = 20", "margin = 20\nhome = [0, 0]")).unwrap();
    let error = design.run(2).unwrap_err();
    assert!(
        matches!(&error, DesignError::TooNear { second, when, .. } if second == "wall" && when.contains("home")),
        "{error}"
    );
}

/// A wall behind which the arm stands wherever it goes is named before anything is searched.
#[test]
fn a_pair_that_no_posture_keeps_apart_is_named() {
    let design = parse(&with_collision("[250, 0, 0]", "[-2000, 0, 0]")).unwrap();
    let error = design.run(2).unwrap_err();
    let DesignError::NeverApart { first, second, furthest_mm, .. } = error else { panic!("{error}") };
    // The shoulder's capsule reaches at most 300 + 40 mm towards the wall from 2 m behind it, and its nearer end stays there.
    assert_eq!((first.as_str(), second.as_str()), ("shoulder", "wall"));
    assert!(furthest_mm < -1700.0, "{furthest_mm}");
}
