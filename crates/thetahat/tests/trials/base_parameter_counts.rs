//! How many base parameters robots have: those that the literature counts, and closed forms.

use std::path::Path;

use libtest_mimic::{Failed, Trial};
use thetahat::{Matrix, Robot, base_parameters::BaseParameters, dynamics::Model};
use thetahat_ground::linear_algebra::PivotedQr;

/// Base parameters of the rigid links alone, and all with motor inertias, friction and offsets.
fn counts(robot: &Robot) -> (Vec<String>, usize) {
    let model = Model::new(robot);
    let others = model.parameter_table().iter().filter(|p| !p.quantity.is_inertial());
    let excluded: Vec<String> = others.map(|p| p.name()).collect();
    let inertial = BaseParameters::of(&model, &excluded).unwrap();
    let formulas = inertial.parameters().iter().map(|p| p.expression.clone()).collect();
    (formulas, BaseParameters::of(&model, &[]).unwrap().len())
}

fn ensure_counts(robot: &Robot, inertial: usize, all: usize) -> Result<(), Failed> {
    let (formulas, found) = counts(robot);
    thetahat_testing::ensure(formulas.len() == inertial, format!("{} inertial: {formulas:?}", formulas.len()))?;
    thetahat_testing::ensure(found == all, format!("{found} in all"))
}

fn parse(text: &str) -> Robot {
    Robot::parse(text, Path::new("robot.toml")).unwrap()
}

fn joint(name: &str, kind: &str, rest: &str) -> String {
    format!("[[joint]]\nname = \"{name}\"\nkind = \"{kind}\"\n{rest}\n")
}

/// 43 inertial ones, as others count; with motor inertias (5 more), friction and offsets (21), 69.
fn kuka_lwr4() -> Result<(), Failed> {
    ensure_counts(&Robot::read(&thetahat_testing::data().join("kuka_lwr4/kuka_lwr4.urdf"))?, 43, 69)
}

fn tx40_from_its_urdf() -> Result<(), Failed> {
    let robot = Robot::read(&thetahat_testing::data().join("tx40/tx40_mdh_modified.urdf"))?;
    ensure_counts(&robot, 36, 58)
}

fn tree8() -> Result<(), Failed> {
    ensure_counts(&Robot::read(&thetahat_testing::shared().join("reference/tree8.urdf"))?, 43, 74)
}

/// Parallel axes: the first link has its zz, each other zz, mx and my; with gravity in the plane the first has mx and my too.
fn planar() -> Result<(), Failed> {
    let arm = |gravity: &str| {
        let link = |name| joint(name, "revolute", "a_m = 0.5");
        let robot = parse(&format!("name = \"planar\"\ngravity = {gravity}\n{}{}{}", link("a"), link("b"), link("c")));
        counts(&robot).0.len()
    };
    thetahat_testing::ensure(arm("[0, 0, -9.81]") == 1 + 3 * 2, "7 across gravity")?;
    thetahat_testing::ensure(arm("[0, -9.81, 0]") == 3 * 3, "9 in the plane of gravity")
}

/// Three axes at right angles that slide: the masses.
fn gantry() -> Result<(), Failed> {
    let slides = joint("x", "prismatic", "alpha_deg = 90")
        + &joint("y", "prismatic", "alpha_deg = 90\ntheta_deg = 90")
        + &joint("z", "prismatic", "alpha_deg = 90");
    let (formulas, _) = counts(&parse(&format!("name = \"gantry\"\n{slides}")));
    thetahat_testing::ensure(formulas == ["m1", "m2", "m3"], format!("{formulas:?}"))
}

/// A second link that turns back as much as the first turns: it moves on a circle without turning, and is a mass on the
/// first; one that turns as much again has its inertia four times.
fn followers() -> Result<(), Failed> {
    let arm = |ratio: i32| {
        let mimic = format!("a_m = 0.5\nmimic = {{ joint = \"a\", ratio = {ratio} }}");
        let joints = joint("a", "revolute", "") + &joint("b", "revolute", &mimic);
        counts(&parse(&format!("name = \"follower\"\n{joints}"))).0
    };
    thetahat_testing::ensure(arm(-1) == ["zz1 + 0.25*m2"], format!("{:?}", arm(-1)))?;
    let expected = ["zz1 + 4*zz2 + 0.25*m2", "mx2", "my2"];
    thetahat_testing::ensure(arm(1) == expected, format!("{:?}", arm(1)))
}

fn ur10() -> Result<(), Failed> {
    ensure_counts(&Robot::read(&thetahat_testing::root().join("robots/ur10.toml"))?, 36, 58)
}

/// The rank of Pinocchio's regressors over its 25 random states.
fn ranks_of_the_reference() -> Result<(), Failed> {
    for (name, expected) in [("kuka_lwr4", 43), ("tx40", 36), ("tree8", 43)] {
        let text = std::fs::read_to_string(thetahat_testing::shared().join(format!("reference/dynamics_{name}.json")))?;
        let reference: serde_json::Value = serde_json::from_str(&text)?;
        let states = reference["states"].as_array().ok_or("states")?.iter();
        let rows: Vec<Vec<f64>> = states
            .map(|state| serde_json::from_value::<Vec<Vec<f64>>>(state["regressor"].clone()))
            .collect::<Result<Vec<_>, _>>()?
            .concat();
        let x = Matrix::from_fn(rows.len(), rows[0].len(), |i, j| rows[i][j]);
        let rank = PivotedQr::new(&x).rank(1e-9);
        thetahat_testing::ensure(rank == expected, format!("{name}: {rank}"))?;
    }
    Ok(())
}

/// The trials of this module.
pub fn all_trials() -> Vec<Trial> {
    thetahat_testing::trials_on_shared_data(
        &["datasets/kuka_lwr4", "datasets/tx40", "reference"],
        vec![
            ("kuka_lwr4_has_43", kuka_lwr4),
            ("tx40_from_its_urdf_has_36", tx40_from_its_urdf),
            ("tree8", tree8),
            ("ur10", ur10),
            ("ranks_of_the_reference", ranks_of_the_reference),
            ("planar", planar),
            ("gantry", gantry),
            ("followers", followers),
        ],
    )
}
